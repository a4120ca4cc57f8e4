//! Start systems: a system whose solutions are known, and the solutions, by index.

pub mod multihomogeneous;
