//! Steward: the one coordinator that drives a job, as plain code.
//!
//! It absorbs stages in their order, each in the order of its items, never in
//! the order of arrival. So a state that was replayed from the ledger is the
//! state that lived through it.

use super::planning::STATE;
use crate::ledger::rows::StageRow;
use crate::results::store::packed_record;
use cognate_algorithms::retried_stage::RetriedStage;
use cognate_algorithms::{Answer, AnyAlgorithm, Next, Opening, PathAlgorithm, RestoreError};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::StageId;
use cognate_solutions::streamed::{PathFilter, StreamedCounts};
use cognate_solutions::streamed_targets::StreamedTargets;
use cognate_systems::system::System;
use std::sync::Arc;

const LARGE: &str = "only a job that can leave out paths is asked about them";

/// A job in the hands of its steward.
#[derive(Clone, Debug)]
pub struct Steward {
    system: Arc<System>,
    algorithm: AnyAlgorithm,
}

/// Stages that the algorithm wants to open, or its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Stages to open, with the points that were made for them.
    pub open: Vec<Opening>,
    /// The algorithm has finished.
    pub done: bool,
}

/// The stage that is absorbed next, once it is complete: the first that is not closed.
pub fn next_to_absorb(stages: &[StageRow]) -> Option<&StageRow> {
    let open = stages.iter().filter(|stage| !stage.closed);
    open.min_by_key(|stage| stage.stage)
        .filter(|stage| stage.is_complete())
}

impl Steward {
    /// A job that begins, with its first stages.
    pub fn begin(system: Arc<System>, algorithm: AnyAlgorithm) -> (Self, Wanted) {
        let mut steward = Self { system, algorithm };
        let wanted = steward.ask();
        (steward, wanted)
    }

    /// A job that another steward left in this state.
    pub fn restore(system: Arc<System>, snapshot: &[u8]) -> Result<Self, RestoreError> {
        let algorithm = AnyAlgorithm::restore(snapshot)?;
        Ok(Self { system, algorithm })
    }

    /// The system of the job.
    pub fn system(&self) -> &Arc<System> {
        &self.system
    }

    /// Stages that the algorithm wants to open before it waits or is done.
    pub fn ask(&mut self) -> Wanted {
        let mut wanted = Wanted::default();
        loop {
            match self.algorithm.next() {
                Next::Open(opening) => wanted.open.push(*opening),
                Next::Wait => return wanted,
                Next::Done => {
                    wanted.done = true;
                    return wanted;
                }
            }
        }
    }

    /// Takes the results of a complete stage, in the order of its items.
    pub fn absorb(
        &mut self,
        stage: StageId,
        results: impl IntoIterator<Item = ItemResult>,
    ) -> Wanted {
        self.algorithm.absorb(stage, &mut results.into_iter());
        self.ask()
    }

    /// The stage whose paths are those of the job, where they need not all be held.
    pub fn first_stage(&self) -> StageId {
        let large = self.algorithm.large();
        large.map_or(StageId(0), RetriedStage::first_id)
    }

    /// True where streamed paths need not be held (see `solutions::streamed`).
    pub fn can_leave_out(&self) -> bool {
        self.algorithm.large().is_some() && PathFilter::suits(&self.system)
    }

    /// True where they are not.
    pub fn leaves_out(&self) -> bool {
        let large = self.algorithm.large();
        large.is_some_and(RetriedStage::leaves_out)
    }

    /// An empty index of ends, with capacity for `paths` paths.
    ///
    /// # Panics
    /// Where all paths are held.
    pub fn index(&self, paths: u64) -> StreamedTargets {
        StreamedTargets::new(self.algorithm.filters(&self.system), paths)
    }

    /// The paths that are held, ascending.
    ///
    /// # Panics
    /// Where all paths are held.
    pub fn held_paths(&self) -> Vec<u64> {
        let large = self.algorithm.large().expect(LARGE);
        large.results().iter().map(|r| r.origin.0).collect()
    }

    /// Says which paths of the first stage are not held, before the others are absorbed.
    ///
    /// # Panics
    /// Where all paths are held.
    pub fn leave_out(&mut self, streamed: Vec<StreamedCounts>) {
        let large = self.algorithm.large_mut().expect(LARGE);
        large.leave_out(streamed);
    }

    /// Holds these paths, too.
    ///
    /// # Panics
    /// Where all paths are held.
    pub fn take_back(&mut self, results: Vec<PathResult>, streamed: Vec<StreamedCounts>) {
        let large = self.algorithm.large_mut().expect(LARGE);
        large.take_back(results, streamed);
    }

    /// The state, from which [`Self::restore`] goes on.
    pub fn snapshot(&self) -> Vec<u8> {
        self.algorithm.snapshot()
    }

    /// The record of the state, of which no plain copy is made.
    pub fn packed_state(&self) -> Vec<u8> {
        packed_record(&STATE, &self.algorithm.counted_snapshot())
    }

    /// Answer of the algorithm, once it is done.
    pub fn answer(&self) -> Option<Answer> {
        self.algorithm.answer(&self.system)
    }

    /// Reason why there is no answer, once the algorithm is done; `None` where there is one.
    pub fn failure(&self) -> Option<String> {
        self.algorithm.failure()
    }

    /// Description of the algorithm's current step, in a few words.
    pub fn description(&self) -> String {
        self.algorithm.progress().description
    }
}
