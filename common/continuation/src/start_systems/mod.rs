//! Start systems: a system whose solutions are known, and the solutions, by index.
//!
//! A start system, its points and its homotopy are chosen together, and so they
//! stand together here. Points are made from their index; nothing is stored.

pub mod exchange;
pub mod grouping;
pub mod linear_product;
pub mod multihomogeneous;
pub mod polyhedral;
pub mod slices;
pub mod total_degree;
