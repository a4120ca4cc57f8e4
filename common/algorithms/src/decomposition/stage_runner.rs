//! Stage runner: the driver of decompositions and questions, which do one job after another.
//!
//! A solve says which job comes next; stages of the job are opened, named their system, and written down here.

use super::job::{Job, StageSystem};
use crate::progress::{self, Progress, StageProgress, VerdictCounts};
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::StageId;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The job that a solve waits for, and the progress of all stages that the solve has opened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StageRunner {
    job: Option<Job>,
    stages: Vec<StageProgress>,
}

impl StageRunner {
    /// Progress of a solve with this description of its present step.
    pub fn progress(&self, description: String, done: bool) -> Progress {
        Progress {
            description,
            stages: self.stages.clone(),
            paths: VerdictCounts::default(),
            done,
        }
    }
}

/// A solve that does one job after another.
pub(crate) trait StagedSolve {
    /// The runner of the solve's stages.
    fn runner(&mut self) -> &mut StageRunner;

    /// Whether the answer is there.
    fn is_done(&self) -> bool;

    /// The system of the open job's stages.
    fn system_of(&mut self, wanted: &StageSystem) -> Arc<System>;

    /// Learns from the job that is done, and makes the next one. `None`: an inner solve begins, the solve is done, or
    /// it is to be called once more.
    fn advance(&mut self, done: Option<Job>) -> Option<Job>;

    /// A solve inside, which comes before the next job; `None` if there is none.
    fn inner(&mut self) -> Option<&mut dyn Solve> {
        None
    }

    /// Next step of the solve: a stage of the job or of the inner solve, of the next job when these are done.
    fn next_stage(&mut self, numbers: &mut StageNumbers) -> Next {
        while !self.is_done() {
            let mut next = Next::Done;
            if let Some(solve) = self.inner() {
                next = solve.next(numbers);
            } else if let Some(job) = &mut self.runner().job {
                next = job.next(numbers);
                if let Next::Open(opening) = &mut next {
                    let wanted = job.system.clone();
                    opening.system = Some(self.system_of(&wanted));
                }
            }
            match &next {
                Next::Open(opening) => {
                    let stage_progress = StageProgress::of(&opening.stage);
                    self.runner().stages.push(stage_progress);
                    return next;
                }
                Next::Wait => return next,
                Next::Done => {
                    let done = self.runner().job.take();
                    self.runner().job = self.advance(done);
                }
            }
        }
        Next::Done
    }

    /// Takes the results of an open stage.
    fn absorb_stage(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        if let Some(solve) = self.inner() {
            solve.absorb(stage, results);
        } else {
            let job = self.runner().job.as_mut();
            job.expect("only an open stage is absorbed")
                .absorb(stage, results);
        }
        progress::absorb(&mut self.runner().stages, stage);
    }
}
