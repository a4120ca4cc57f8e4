//! Jobs: from a problem to stages, and from finished stages to the next ones.
//!
//! [`planning`] makes a [`PathAlgorithm`](cognate_algorithms::PathAlgorithm) of
//! a problem, in the order of the [`planning_queue`]; [`steward`] is what one coordinator does with it, as plain code;
//! [`drive`] carries that out on ledger and store; [`progress`] is what clients
//! see of it. How far a job is, is a
//! [`JobState`](crate::ledger::rows::JobState) in the ledger.

pub mod drive;
pub mod large_stage;
pub mod mending;
pub mod planning;
pub mod planning_queue;
pub mod progress;
pub mod steward;
pub mod tools;
