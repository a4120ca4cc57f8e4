//! CoordinatorError: why a call was not answered.

use crate::jobs::planning::{PlanningError, UnreadablePlan};
use crate::jobs::planning_queue::PlanningRefusal;
use crate::ledger::LedgerError;
use crate::ledger::identity::{JobId, Tenant};
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
    /// The tenant has as much as it may.
    #[error(
        "tenant {tenant} may have {limit} {what}: it has {used}, and this asks for {asked} more"
    )]
    OverLimit {
        /// Tenant of the job.
        tenant: Tenant,
        /// Name of the quantity that is limited.
        what: &'static str,
        /// Limit of the tenant.
        limit: u64,
        /// Amount that the tenant uses now.
        used: u64,
        /// Amount that this job would add.
        asked: u64,
    },
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
    /// The job has not ended, so that it is not deleted.
    #[error("job {job} is {}: only a job that has ended is deleted (or `--cancel-first`)", state.name())]
    GoesOn {
        /// The job.
        job: JobId,
        /// State of the job.
        state: JobState,
    },
    /// The folder of the results has some that are not this ledger's: whose it is must be said first.
    #[error(
        "there are results of {0} jobs that this ledger does not know: nothing is removed (`cognate fsck` lists them)"
    )]
    ForeignResults(u64),
    /// The job has an answer of another kind than the one that was asked for.
    #[error("job {job} is {is}")]
    OtherAnswer {
        /// The job.
        job: JobId,
        /// Kind of the job and of its answer.
        is: &'static str,
    },
    /// A worker's report is no result of its chunk.
    #[error("the report of lease {lease} is no result of its chunk: {what}")]
    Report {
        /// The lease.
        lease: String,
        /// Description of the fault in the report.
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
