//! Systems made from systems.

pub mod clear_denominators;
mod deflate;
mod fix_parameters;
mod homogenize;
mod independent;
mod randomize;
mod rescale;

pub use deflate::deflate;
pub use fix_parameters::{FixError, fix_parameters};
pub use homogenize::homogenize;
pub use randomize::randomize;
