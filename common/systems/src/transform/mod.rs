//! Systems made from systems.

mod affine_chart;
mod bent;
pub mod clear_denominators;
mod combine;
mod critical;
mod critical_points;
mod deflate;
mod factors;
mod fibre_product;
mod fix_parameters;
mod homogenize;
mod import_renumbered;
mod independent;
mod join;
mod polar;
mod product;
mod product_to_equation;
mod randomize;
mod rescale;
mod slice;

pub use affine_chart::affine_chart;
pub use bent::{along_line, bent};
pub use combine::{combine, combine_all, combine_few, equilibrate};
pub use critical::{MOST_CRITICAL_VARIABLES, critical, fibre};
pub use critical_points::critical_points;
pub use deflate::deflate;
pub use factors::factors;
pub use fibre_product::fibre_product;
pub use fix_parameters::{FixError, fix_parameters};
pub use homogenize::homogenize;
pub use join::{JoinError, join};
pub use polar::polar;
pub use product::product;
pub use product_to_equation::{append, product_to_equation};
pub use randomize::randomize;
pub use slice::slice;
