//! Sharpening: an endpoint brought to as many digits as are asked for, also a multiple one.
//!
//! [`Sharpened`] is the point, [`sharpen`](search::sharpen) finds it by Newton's method in MPFR on all
//! equations, and where that does not converge quadratically on deflated ones; [`SharpeningStage`]
//! is that as the work of a stage.

pub mod missed_slice;
mod newton;
pub mod search;
mod sharpened;
mod stage;

pub use sharpened::{MOST_DIGITS, Sharpened, Sharpening, Unsharpened};
pub use stage::SharpeningStage;
