//! Whole solves, as plans that ask for paths and learn from results.
//!
//! A [`PathAlgorithm`] is a state machine: it opens stages, is fed their
//! results in index order, and knows at any moment how far it is. The service
//! feeds it from leases, a test from a loop ([`run_locally`]). [`plan`] makes
//! one from a system and options; [`any_algorithm`] writes its state down and
//! reads it back in another process.
//!
//! # Which method for what
//!
//! | method | finds | file |
//! |---|---|---|
//! | a start system | all isolated solutions of one system | [`zero_dimensional_solve`] |
//! | mixed cells | the same, from a generic system with the same monomials | [`polyhedral_solve`] |
//! | regeneration | all regular solutions, equation by equation; singular ones may be missed | [`regeneration_solve`] |
//! | parameters | solutions of other members of a family, from those of one | [`parameter_solve`] |
//! | monodromy | solutions of a generic member, from one of them, by loops | [`monodromy`] |
//! | decomposition | components of every dimension, by witness sets | [`decomposition`] |
//!
//! Around any of these: [`sharpened_solve`] brings solutions to more digits, [`certified_solve`] proves
//! them. Inside all of them: [`retried_stage`] tracks again what failed or met. Paths meet that end at one
//! regular point, or that entered the endgame at one point; a jump also shows where turns around an end are no
//! permutation.
//!
//! Loops of a monodromy solve end when many in a row bring nothing new, when an estimate says that none is missing
//! ([`monodromy::estimate`]), or when a trace test says so ([`monodromy::trace`]): the points of a curve on parallel
//! slices have a sum that moves on a line, and a part of them has not.
#![forbid(unsafe_code)]

pub mod any_algorithm;
pub mod certified_solve;
pub mod closing_stage;
mod coefficient_family;
pub mod completeness;
pub mod decomposition;
mod given_start;
pub mod monodromy;
pub mod opening;
pub mod parameter_solve;
pub mod plan;
pub mod plan_error;
pub mod polyhedral_solve;
pub mod progress;
pub mod regeneration_solve;
pub mod retried_stage;
pub mod run_locally;
mod set_structures;
pub mod sharpened_solve;
pub mod start_costs;
pub mod start_pair;
pub mod zero_dimensional_solve;

pub use any_algorithm::{AnyAlgorithm, RestoreError};
pub use certified_solve::CertifiedSolve;
pub use closing_stage::{FiniteEndpoint, FiniteEndpoints};
pub use completeness::{Complete, Completeness};
pub use opening::Opening;
pub use plan::{Plan, PlanOptions, plan};
pub use plan_error::PlanError;
pub use progress::{Progress, StageProgress, VerdictCounts};

use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::StageId;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;

/// What an algorithm wants next.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Open this stage; several may be open.
    Open(Box<Opening>),
    /// Nothing until an open stage has been absorbed.
    Wait,
    /// All is known.
    Done,
}

/// A whole solve.
pub trait PathAlgorithm: Send {
    /// What is wanted next. Called until it says `Wait` or `Done`, and again after each absorption.
    fn next(&mut self) -> Next;
    /// Takes the results of one stage, complete and in item order.
    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>);
    /// Why it has no answer, when `next` has said `Done`; `None` where it has one.
    fn failure(&self) -> Option<String> {
        None
    }
    /// How far it is.
    fn progress(&self) -> Progress;
    /// The whole state, to be restored where another process goes on
    /// (see [`AnyAlgorithm::restore`]).
    fn snapshot(&self) -> Vec<u8>;
    /// What was found, one set for each target; meant for when `next` has said `Done`.
    /// `system` is the one that was planned for.
    fn solution_sets(&self, system: &System) -> Vec<SolutionSet>;
    /// Whether it says that no isolated solution is missing; `None` where its paths and their verdicts
    /// say all that is known of that.
    fn completeness(&self) -> Option<Completeness> {
        None
    }
    /// Its finite endpoints when it is done; `None` where it does not say.
    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        None
    }
}

#[cfg(test)]
mod synthetic;
