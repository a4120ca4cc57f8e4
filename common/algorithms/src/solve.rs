//! Solve: a plan that asks for stages and learns from their results. Solves stand inside others, and one of
//! them inside whatever drives it, which numbers the stages.

use crate::answer::Answer;
use crate::completeness_claim::CompletenessClaim;
use crate::finite_endpoints::FiniteEndpoints;
use crate::opening::Opening;
use crate::progress::{Progress, StageProgress};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::{Stage, StageId};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::polynomial::SolutionCount;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// Next step that a solve asks its caller for.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// Open this stage; several may be open.
    Open(Box<Opening>),
    /// Nothing until an open stage has been absorbed.
    Wait,
    /// All is known.
    Done,
}

/// The numbers of a job's stages, in the order in which they are opened: kept once, at the root, and lent to
/// whatever solve opens a stage.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StageNumbers {
    next: u32,
}

impl StageNumbers {
    /// Gives a stage the next number, and writes the stage down among those of the solve that opens it.
    ///
    /// # Panics
    /// When the stage's items cannot be counted: a plan has only stages whose items can be counted.
    pub fn open(&mut self, opening: Opening, stages: &mut Vec<StageProgress>) -> Next {
        let stage = Stage {
            id: StageId(self.next),
            ..opening.stage
        };
        self.next += 1;
        stages.push(StageProgress::of(&stage));
        Next::Open(Box::new(Opening { stage, ..opening }))
    }
}

/// A plan of stages.
pub trait Solve: Send {
    /// Next step of the solve. Called until it returns `Wait` or `Done`, and again after each absorption.
    fn next(&mut self, numbers: &mut StageNumbers) -> Next;
    /// Takes the results of one stage that this solve opened, complete and in item order.
    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>);
    /// Reason why the solve has no answer, when `next` has returned `Done`; `None` if it has one.
    fn failure(&self) -> Option<String> {
        None
    }
    /// Progress of the solve.
    fn progress(&self) -> Progress;
    /// Answer of the solve once `next` has returned `Done`; `None` where nothing can be said before. `system` is the
    /// one that was planned for.
    fn answer(&self, system: &System) -> Option<Answer>;
    /// The isolated solutions that were found, one set for each target; none where something else was asked for.
    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        self.answer(system)
            .map(Answer::into_sets)
            .unwrap_or_default()
    }
    /// The last results of all paths by the numbers that people see, where a stage counts its
    /// paths by others, or not all of them.
    fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        None
    }
    /// The stage whose paths the answer counts; stages before it only prepared it.
    fn counted_stage(&self) -> StageId {
        StageId(0)
    }
    /// Claim of the solve about missing isolated solutions; `None` if its paths and their verdicts are all that is
    /// known.
    fn completeness(&self) -> Option<CompletenessClaim> {
        None
    }
    /// Number of solutions of the system by an exact count, if it was counted on the way.
    fn solution_count(&self) -> Option<SolutionCount> {
        None
    }
    /// Finite endpoints of the solve when it is done; `None` if it does not give them.
    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        None
    }
}

/// An algorithm that runs from a first call of `next` to `Done`: a solve with the numbers of its stages.
pub trait PathAlgorithm: Send {
    /// Next step of the algorithm. Called until it returns `Wait` or `Done`, and again after each absorption.
    fn next(&mut self) -> Next;
    /// Takes the results of one stage, complete and in item order.
    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>);
    /// Reason why the algorithm has no answer, when `next` has returned `Done`; `None` if it has one.
    fn failure(&self) -> Option<String>;
    /// Progress of the algorithm.
    fn progress(&self) -> Progress;
    /// Answer of the algorithm once `next` has returned `Done`; `None` where nothing can be said before. `system` is
    /// the one that was planned for.
    fn answer(&self, system: &System) -> Option<Answer>;
    /// The isolated solutions that were found, one set for each target; none where something else was asked for.
    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        self.answer(system)
            .map(Answer::into_sets)
            .unwrap_or_default()
    }
}

/// One solve alone, for examples, tests and tools; a job also has closings and can be written down (see
/// [`crate::AnyAlgorithm`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Root<S> {
    /// The solve.
    pub solve: S,
    numbers: StageNumbers,
}

impl<S> Root<S> {
    /// A solve that begins.
    pub fn new(solve: S) -> Self {
        let numbers = StageNumbers::default();
        Self { solve, numbers }
    }
}

impl<S: Solve> PathAlgorithm for Root<S> {
    fn next(&mut self) -> Next {
        self.solve.next(&mut self.numbers)
    }
    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        self.solve.absorb(stage, results);
    }
    fn failure(&self) -> Option<String> {
        self.solve.failure()
    }
    fn progress(&self) -> Progress {
        self.solve.progress()
    }
    fn answer(&self, system: &System) -> Option<Answer> {
        self.solve.answer(system)
    }
}
