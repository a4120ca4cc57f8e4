//! Systems made from systems.

mod fix_parameters;
mod homogenize;
mod independent;
mod randomize;

pub use fix_parameters::{FixError, fix_parameters};
pub use homogenize::homogenize;
pub use randomize::randomize;
