//! What is solved: expressions, systems, straight-line programs and their evaluation.
#![forbid(unsafe_code)]

pub mod expression;
pub mod formats;
pub mod system;
