//! Finished: what the ledger knows of a job that has ended, as its summary tells it.

use crate::jobs::planning::Planned;
use crate::ledger::clock::LedgerTime;
use crate::ledger::rows::{Contribution, JobRow, StageRow};
use cognate_summary::about::{About, TimeBlock, WorkerBlock};

/// Data of a job that has ended, besides its answer.
#[derive(Clone, Copy)]
pub struct Finished<'a> {
    /// The job.
    pub job: &'a JobRow,
    /// The plan that the job was solved by.
    pub planned: &'a Planned,
    /// Stages of the job, in the order in which they were opened.
    pub stages: &'a [StageRow],
    /// Work of each worker for the job.
    pub workers: &'a [Contribution],
    /// Time at which the job ended.
    pub now: LedgerTime,
}

impl Finished<'_> {
    /// Data of the job, as the summary shows them.
    pub fn about(&self) -> About {
        let planned = self.planned;
        let tracking = self.stages.iter().map(|s| s.cpu_micros).sum();
        let items = self.stages.iter().map(|s| s.items).sum();
        let worker = |contribution: &Contribution| WorkerBlock {
            id: contribution.worker.to_string(),
            paths: contribution.items,
            transport: contribution.transport.clone(),
        };
        About {
            job: self.job.job.to_string(),
            name: planned.name.clone(),
            digest: planned.problem.to_string(),
            variables: planned.variables,
            equations: planned.equations,
            start: planned.start.clone(),
            why: planned.why.clone(),
            seed: planned.seed,
            warnings: planned.warnings.clone(),
            time: TimeBlock::new(self.now.since_ms(self.job.submitted), tracking, items),
            workers: self.workers.iter().map(worker).collect(),
        }
    }
}
