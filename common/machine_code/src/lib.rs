//! Straight-line machine code of compiled systems, made at run time.
//!
//! In the order of the flow: `lower` turns a system's assignments into a `routine`'s steps,
//! `registers` finds them registers, [`encoder`] writes bytes, `executable` runs them;
//! [`evaluator`] and [`elimination`] are what trackers use: the same bits as without them, sooner.
#![deny(unsafe_code)]

pub mod elimination;
pub mod encoder;
pub mod evaluator;
#[allow(unsafe_code)]
mod executable;
mod lower;
mod registers;
mod routine;

pub use elimination::Elimination;
pub use evaluator::Evaluator;
