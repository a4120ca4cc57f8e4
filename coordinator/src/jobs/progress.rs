//! Progress: what of a job is done, running, waiting. The counts add up.

use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::JobId;
use crate::ledger::rows::{JobRow, JobState, Outcomes, StageRow};
use cognate_continuation::work::StageId;

/// Progress of a job, with its open stages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobProgress {
    /// The job.
    pub job: JobId,
    /// State of the job.
    pub state: JobState,
    /// Every stage opened so far, in order.
    pub stages: Vec<StageItems>,
    /// How the paths of finished chunks ended, in all stages together.
    pub outcomes: Outcomes,
    /// Reason why the job failed or was cancelled, else empty.
    pub message: String,
    /// Time from the job's submission until now or until its end, in milliseconds.
    pub elapsed_ms: u64,
}

/// Items of one stage: ready, leased, accepted and failed make up the total.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageItems {
    /// Number of the stage within the job, from 0.
    pub stage: StageId,
    /// Number of all items.
    pub total: u64,
    /// Items that wait for a worker.
    pub ready: u64,
    /// Items that are leased to workers.
    pub leased: u64,
    /// Items whose results were accepted.
    pub accepted: u64,
    /// Items that were given up.
    pub failed: u64,
    /// Purpose of the stage, in words for people.
    pub purpose: String,
    /// Mixed cells of the accepted items, in stages whose items are branches of mixed cells; these are counted before
    /// the number of paths is known.
    pub mixed_cells: Option<u64>,
}

impl JobProgress {
    /// Progress from the ledger's rows; `purpose` gives the purpose of a stage and the mixed cells that it has
    /// counted, if any.
    pub fn new(
        job: &JobRow,
        stages: &[StageRow],
        now: LedgerTime,
        purpose: impl Fn(&StageRow) -> (String, Option<u64>),
    ) -> Self {
        let mut outcomes = Outcomes::default();
        let stages = stages.iter().map(|row| {
            assert_eq!(
                row.accounted(),
                row.items,
                "every item of a stage is in exactly one place"
            );
            outcomes.add(row.outcomes);
            let (purpose, mixed_cells) = purpose(row);
            StageItems {
                stage: row.stage,
                total: row.items,
                ready: row.ready.items,
                leased: row.leased.items,
                accepted: row.accepted.items,
                failed: row.failed.items,
                purpose,
                mixed_cells,
            }
        });
        let stages = stages.collect();
        Self {
            job: job.job,
            state: job.state,
            stages,
            outcomes,
            message: job.reason.clone().unwrap_or_default(),
            elapsed_ms: job.ended.unwrap_or(now).since_ms(job.submitted),
        }
    }
}
