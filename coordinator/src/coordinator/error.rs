//! CoordinatorError: why a call was not answered.

use crate::jobs::planning::{PlanningError, UnreadablePlan};
use crate::jobs::planning_queue::PlanningRefusal;
use crate::ledger::LedgerError;
use crate::ledger::identity::JobId;
use crate::ledger::rows::JobState;
use crate::results::store::StoreError;
use cognate_continuation::work::StageId;

/// Why a call was not answered.
#[derive(Debug, thiserror::Error)]
pub enum CoordinatorError {
    /// The problem cannot be solved as asked.
    #[error("{0}")]
    Problem(String),
    /// There is no plan for the problem, and why.
    #[error(transparent)]
    Planning(#[from] PlanningError),
    /// The problem is not planned now, or not at all.
    #[error(transparent)]
    NotPlanned(#[from] PlanningRefusal),
    /// There is no such stage.
    #[error("job {job} has no stage {}", stage.0)]
    UnknownStage {
        /// The job.
        job: JobId,
        /// The stage.
        stage: StageId,
    },
    /// The job has not ended, or not with a result.
    #[error("job {job} is {}{}: it has no result", state.name(), because(reason))]
    NoResult {
        /// The job.
        job: JobId,
        /// State of the job.
        state: JobState,
        /// Why it failed or was cancelled.
        reason: Option<String>,
    },
    /// The job has components, not solutions.
    #[error("job {0} is a decomposition: it has witness points, and no list of solutions or paths")]
    Decomposed(JobId),
    /// The job has an answer of components, not solutions.
    #[error("job {0} is a question to components: its answer is its summary")]
    Answered(JobId),
    /// The job has solutions, not components.
    #[error("job {0} is no decomposition: it has no witness points")]
    NotDecomposed(JobId),
    /// A worker's report is no result of its chunk.
    #[error("the report of lease {lease} is no result of its chunk: {what}")]
    Report {
        /// The lease.
        lease: String,
        /// What is wrong with the report.
        what: String,
    },
    /// A job's record cannot be read.
    #[error(transparent)]
    Plan(#[from] UnreadablePlan),
    /// The ledger refused or failed.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
    /// An object is missing, damaged, or could not be written.
    #[error(transparent)]
    Store(#[from] StoreError),
}

fn because(reason: &Option<String>) -> String {
    reason
        .as_ref()
        .map_or_else(String::new, |reason| format!(" ({reason})"))
}
