//! How one path is followed: settings, state, steps, outcome.
//!
//! [`lockstep`] follows many paths at once, always in the same phase of a step: it does [`attempt`], [`prediction`],
//! [`corrector`], [`acceptance`] and [`step_length`] with all of them. [`lane`] is the state of one path between steps;
//! [`decisions`], [`turns`], [`handoffs`] and [`ends`] decide how the path goes on; [`iterative_refinement`] gives
//! regular ends their digits.

mod acceptance;
mod attempt;
mod batch;
pub(crate) mod boundary;
mod contexts;
mod corrector;
mod decisions;
mod digits;
mod end_check;
mod ends;
mod far_out;
mod handoffs;
mod iterative_refinement;
pub(crate) mod lane;
mod limits;
pub mod lockstep;
pub mod observer;
pub mod outcome;
mod precise_samples;
mod prediction;
mod scaled_newton;
pub mod settings;
mod step_length;
mod taylor_probe;
mod tracking_context;
mod turns;
