//! Nine points: every four-bar linkage whose coupler point passes nine given points (Alt 1923;
//! Wampler, Morgan, Sommese 1992).
//!
//! Solutions are in the variables of `cognate_systems::named::nine_point`: x, X, a, A, y, Y, b, B.

pub mod class_record;
pub mod cognates;
pub mod family;
pub mod mechanisms;
pub mod path_points;
pub mod realization;
pub mod search;

pub use class_record::{ClassEnd, ClassRecord};
pub use mechanisms::{Curve, Mechanism};
pub use path_points::{PathPoints, PointFault};
pub use search::Search;

use num_complex::Complex64;

/// A solution: x, X, a, A, y, Y, b, B, in the scale of its [`PathPoints`].
pub type Point = [Complex64; 8];
