//! Whole solves, as plans that ask for paths and learn from results.
//!
//! A [`PathAlgorithm`] is a state machine: it opens stages, is fed their
//! results in index order, and knows at any moment how far it is. It is a [`Solve`], in which others may
//! stand, and at the root the numbers of all stages. The service
//! feeds it from leases, a test from a loop ([`run_locally`]). [`plan`] makes
//! one from a system and options; [`any_algorithm`] writes its state down and
//! reads it back in another process.
//!
//! # Which method for what
//!
//! | method | finds | file |
//! |---|---|---|
//! | one unknown | all roots, without paths | [`one_unknown_solve`] |
//! | a start system | all isolated solutions of one system | [`zero_dimensional_solve`] |
//! | mixed cells | the same, from a generic system with the same monomials | [`polyhedral_solve`] |
//! | regeneration | all regular solutions, equation by equation; singular ones may be missed | [`regeneration_solve`] |
//! | more equations than unknowns | all isolated solutions: each equation cuts the sets of solutions of the equations before it | [`overdetermined_solve`] |
//! | parameters | solutions of other members of a family, from those of one | [`parameter_solve`] |
//! | monodromy | solutions of a generic member, from one of them, by loops | [`monodromy`] |
//! | decomposition | components of every dimension, by witness sets | [`decomposition`] |
//! | questions | members, samples, images, degrees by groups of known components | [`questions`] |
//!
//! After any of these come [`closings`]: solutions get more digits and are proved. Inside all of them:
//! [`retried_stage`] tracks again what failed or met. Paths meet that end at one regular point, or that entered the
//! endgame at one point; a jump also shows where turns around an end are no permutation.
//!
//! Loops of a monodromy solve end when many in a row bring nothing new, when an estimate says that none is missing
//! ([`monodromy::estimate`]), or when a trace test says so ([`monodromy::trace`]): the points of a curve on parallel
//! slices have a sum that moves on a line, and a part of them has not.
#![forbid(unsafe_code)]

pub mod answer;
pub mod any_algorithm;
pub mod closings;
mod coefficient_family;
mod coefficients;
pub mod completeness_claim;
pub mod decomposition;
mod degrees_or_bounds;
mod exact_answer;
mod exact_count;
mod few_terms_solve;
pub mod finite_endpoints;
mod given_start;
pub mod limits;
pub mod monodromy;
mod monomials;
mod one_unknown_solve;
pub mod opening;
pub mod overdetermined_solve;
pub mod parameter_solve;
pub mod plan;
pub mod plan_error;
pub mod polyhedral_solve;
pub mod progress;
pub mod questions;
pub mod regeneration_solve;
pub mod retried_stage;
mod rounded_data;
pub mod run_locally;
mod sampled_ends;
mod set_structures;
pub mod solve;
pub mod solve_options;
mod solve_without_paths;
pub mod start_costs;
pub mod start_kind;
pub mod start_pair;
mod undecided_ends;
pub mod zero_dimensional_solve;

pub use answer::Answer;
pub use any_algorithm::{AnyAlgorithm, AnySolve, RestoreError};
pub use completeness_claim::CompletenessClaim;
pub use finite_endpoints::{FiniteEndpoint, FiniteEndpoints};
pub use opening::Opening;
pub use plan::{Plan, plan};
pub use plan_error::PlanError;
pub use progress::{Progress, StageProgress, VerdictCounts};
pub use solve::{Next, PathAlgorithm, Root, Solve, StageNumbers};
pub use solve_options::{
    ClosingOptions, KnownSolutions, MonodromyOptions, SolveMethod, SolveOptions, TrackingOptions,
};

#[cfg(test)]
mod restarts;
#[cfg(test)]
mod synthetic;
#[cfg(test)]
mod tests_of_functions;
