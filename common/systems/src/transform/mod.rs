//! Systems made from systems.

mod fix_parameters;
mod homogenize;

pub use fix_parameters::{FixError, fix_parameters};
pub use homogenize::homogenize;
