//! Endgames: how a path ends at t = 0.
//!
//! A regular endpoint is simply reached. All others are settled by turns around
//! t = 0 (`cauchy`), for which the endgame is a plain state machine: it is told
//! where the path is and says where to follow it next.

pub mod cauchy;
pub mod circle;
pub(crate) mod infinity;
pub mod winding;

pub use infinity::LEAST_POWER_SUM;
