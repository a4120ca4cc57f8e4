//! Stage runner: the driver of decompositions and questions, which do one job after another.
//!
//! A solve says which job comes next; stages of the job are opened, named their system, and written down here.

use super::job::{Job, StageSystem};
use crate::answer::Answer;
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

/// A solve that does one job after another.
pub(crate) trait StagedSolve: Send {
    /// The runner of the solve's stages.
    fn runner(&self) -> &StageRunner;

    /// The runner of the solve's stages.
    fn runner_mut(&mut self) -> &mut StageRunner;

    /// Answer, once all is known. `system` is the one that was planned for.
    fn final_answer(&self, system: &System) -> Option<Answer>;

    /// Whether the answer is there.
    fn is_done(&self) -> bool;

    /// Describes the present work in a few words.
    fn description(&self) -> String;

    /// The system of the open job's stages.
    fn system_of(&mut self, wanted: &StageSystem) -> Arc<System>;

    /// Learns from the job that is done, and makes the next one. `None`: an inner solve begins, the solve is done, or
    /// it is to be called once more.
    fn advance(&mut self, done: Option<Job>) -> Option<Job>;

    /// A solve inside, which comes before the next job; `None` if there is none.
    fn inner(&mut self) -> Option<&mut dyn Solve> {
        None
    }
}

impl<S: StagedSolve> Solve for S {
    /// A stage of the job or of the inner solve, of the next job when these are done.
    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        while !self.is_done() {
            let mut next = Next::Done;
            if let Some(solve) = self.inner() {
                next = solve.next(numbers);
            } else if let Some(job) = &mut self.runner_mut().job {
                next = job.next(numbers);
                if let Next::Open(opening) = &mut next {
                    let wanted = job.system.clone();
                    opening.system = Some(self.system_of(&wanted));
                }
            }
            match &next {
                Next::Open(opening) => {
                    let stage_progress = StageProgress::of(&opening.stage);
                    self.runner_mut().stages.push(stage_progress);
                    return next;
                }
                Next::Wait => return next,
                Next::Done => {
                    let done = self.runner_mut().job.take();
                    self.runner_mut().job = self.advance(done);
                }
            }
        }
        Next::Done
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        if let Some(solve) = self.inner() {
            solve.absorb(stage, results);
        } else {
            let job = self.runner_mut().job.as_mut();
            job.expect("only an open stage is absorbed")
                .absorb(stage, results);
        }
        progress::absorb(&mut self.runner_mut().stages, stage);
    }

    fn progress(&self) -> Progress {
        Progress {
            description: self.description(),
            stages: self.runner().stages.clone(),
            paths: VerdictCounts::default(),
            done: self.is_done(),
        }
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        self.final_answer(system)
    }
}
