//! Systems of equations: expressions, systems, straight-line programs and their evaluation.
#![forbid(unsafe_code)]

pub mod condition;
pub mod evaluation;
pub mod exact_point;
pub mod expression;
pub mod formats;
pub mod helper_unknown;
pub mod named;
pub mod objective;
pub mod polynomial;
pub mod scaling;
pub mod straight_line_program;
pub mod system;
pub mod transform;
pub mod typed_unknowns;
pub mod units;
