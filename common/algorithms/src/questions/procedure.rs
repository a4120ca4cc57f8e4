//! Procedure: how one question is answered.

use super::context::Context;
use crate::decomposition::job::{Job, StageSystem};
use crate::solve::Solve;
use cognate_solutions::denominators::Denominators;
use cognate_solutions::witness::question::SecondSet;
use cognate_solutions::witness::{Answer, TrackedPaths};
use cognate_systems::system::System;
use std::sync::Arc;

/// The procedure that answers one question, job after job.
pub(super) trait Procedure {
    /// Learns from the job that is done, and makes the next one. `None`: an inner solve begins, or all is known.
    fn advance(&mut self, context: &mut Context<'_>, done: Option<Job>) -> Option<Job>;

    /// Answer, when `advance` has no more work. Results are moved into it.
    fn answer(&mut self, given: &GivenSystem<'_>) -> Answer;

    /// Describes the present work in a few words.
    fn description(&self) -> &'static str;

    /// The system of the open job's stages.
    fn system_of(&mut self, context: &mut Context<'_>, wanted: &StageSystem) -> Arc<System> {
        context.of_components().system(wanted)
    }

    /// The second set of the question; `None` if it has none.
    fn second_set(&self) -> Option<&SecondSet> {
        None
    }

    /// A solve inside, which comes before the next job; `None` if there is none.
    fn inner(&mut self) -> Option<&mut dyn Solve> {
        None
    }

    /// Paths of the inner solves that are done.
    fn inner_paths(&self) -> TrackedPaths {
        TrackedPaths::default()
    }

    /// Whether paths that met and did not come apart leave a doubt: not where the ends of all paths are compared.
    fn doubts_crossings(&self) -> bool {
        true
    }
}

/// The given system, of which an answer takes names of variables and the points where a denominator is 0.
pub(super) struct GivenSystem<'a> {
    /// The system at the values of its parameters.
    pub system: &'a System,
    /// Denominators of the equations; `None` if there are none.
    pub denominators: Option<Denominators<'a>>,
    /// Seed of everything random.
    pub seed: u64,
}

impl GivenSystem<'_> {
    /// Moves results about components into the answer. `keep_solutions` takes out of each result what is no solution
    /// because a denominator is 0.
    pub fn take_solutions<T>(
        &self,
        results: &mut Vec<T>,
        keep_solutions: fn(&mut T, &Denominators<'_>),
    ) -> Vec<T> {
        let mut results = std::mem::take(results);
        if let Some(denominators) = &self.denominators {
            for result in &mut results {
                keep_solutions(result, denominators);
            }
        }
        results
    }
}
