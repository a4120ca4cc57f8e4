//! Small linear algebra for any scalar and any width.
//!
//! Systems of mechanisms have some tens of unknowns; at that size general
//! libraries spend their time on blocking and dispatch.

pub mod condition;
pub mod inverse;
pub mod least_squares;
pub mod lu;
pub mod matrix;
pub mod orthogonal;
pub mod sparse;
pub mod svd;
pub mod symmetric_eigenvalues;
pub mod vector;
