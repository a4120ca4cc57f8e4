//! How one path is followed: settings, state, steps, outcome.
//!
//! [`lockstep`] follows many paths at once, always in the same phase of a step;
//! [`lane`] is what one of them knows of itself between steps.

mod batch;
pub(crate) mod boundary;
mod contexts;
mod digits;
mod ends;
mod far_out;
pub(crate) mod lane;
mod limits;
pub mod lockstep;
pub mod observer;
pub mod outcome;
mod precise_samples;
mod scaled_newton;
pub mod settings;
mod taylor_probe;
mod tracking_context;
mod turns;
