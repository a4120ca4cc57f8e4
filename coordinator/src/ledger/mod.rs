//! Ledger: jobs, stages, chunks and leases, which the service must not forget.
//!
//! The rule of the ledger: a fact is acknowledged after it is durable. Every write of a worker carries its lease's
//! epoch, every write of a steward its job's epoch, and a write with an old epoch changes nothing. Results are not in
//! here, only the names and hashes of the objects that hold them.

pub mod clock;
#[cfg(test)]
pub(crate) mod conformance;
#[cfg(test)]
pub(crate) mod faulty;
pub mod identity;
pub mod memory;
pub mod rows;
pub mod rules;
pub mod sql;
#[cfg(test)]
mod state_machine;

use self::clock::LedgerTime;
use self::identity::{CoordinatorId, Epoch, JobId, LeaseId, RequestId, WorkerId};
use self::rows::*;
use crate::chunks::audit::AuditKey;
use async_trait::async_trait;
use cognate_continuation::work::StageId;

/// Why a ledger did not do what it was asked.
#[derive(Debug, thiserror::Error)]
pub enum LedgerError {
    /// There is no such job.
    #[error("there is no job {0}")]
    UnknownJob(JobId),
    /// Another steward drives the job, or the job has ended: nothing was changed.
    #[error("the writer is not job {0}'s steward any more")]
    Fenced(JobId),
    /// One request id was used for two different jobs.
    #[error("request id `{0}` was used before, for another problem or other options")]
    RequestReused(RequestId),
    /// One request id was used for a job that was deleted since.
    #[error("request id `{0}` was used before, for a job that is deleted")]
    RequestOfDeleted(RequestId),
    /// The pieces of a split do not make up a chunk that is ready.
    #[error("the pieces do not make up a chunk of job {0} that is ready")]
    NotAPartition(JobId),
    /// A stage was opened twice, or closed while some of its chunks were not finished.
    #[error("stage {1:?} of job {0} cannot be opened or closed now")]
    StageOrder(JobId, StageId),
    /// The worker was outvoted at an audit, or the coordinator found something else itself.
    #[error(
        "worker {0} computed wrongly: others, or the coordinator itself, found something else for a chunk of it"
    )]
    Evicted(WorkerId),
    /// Two workers that are known by different credentials have one name.
    #[error(
        "worker {0} is here already, with another token or certificate: give this one another name"
    )]
    NameTaken(WorkerId),
    /// A number is too large for the ledger.
    #[error("{0} is larger than the ledger can hold")]
    TooLarge(&'static str),
    /// The content of the ledger's file is not what this program writes there.
    #[error("the ledger is damaged or from another program: {0}")]
    Damaged(String),
    /// Pages of the ledger's file are not what the storage engine wrote there.
    #[error(
        "the ledger's file is damaged ({0}): stop all coordinators, keep the file, and go on from the newest copy \
         that `cognate backup` made (deploy/backup.md)"
    )]
    Malformed(String),
    /// The file is from a later version.
    #[error("the ledger has schema version {found}, and this program knows only {known}")]
    TooNew {
        /// Version of the schema in the file.
        found: i64,
        /// Newest version that this program can read.
        known: i64,
    },
    /// The storage engine failed.
    #[error("the ledger's storage failed: {0}")]
    Storage(String),
    /// The database server is not there, or not ready: it may be a moment later.
    #[error("the ledger's database is not reached: {0}")]
    Unreachable(String),
    /// The ledger has been closed.
    #[error("the ledger is closed")]
    Closed,
}

/// Durable record of jobs, stages, chunks and leases.
///
/// After every call, in every stage: ready + leased + accepted + failed items = all items.
#[async_trait]
pub trait Ledger: Send + Sync {
    /// The ledger's own clock: the database's or the simulator's. No other is used for deadlines.
    async fn now(&self) -> Result<LedgerTime, LedgerError>;
    /// Damage that the storage engine has reported since the ledger was opened; `None` while there is none.
    fn damage(&self) -> Option<String> {
        None
    }

    // Clients.

    /// Remembers a job. The same request id with the same content is the same job.
    async fn submit(&self, id: RequestId, job: NewJob) -> Result<Submitted, LedgerError>;
    /// Ends a job that has not ended yet; returns its leased chunks to ready.
    async fn cancel(&self, job: JobId, reason: &str) -> Result<Cancelled, LedgerError>;
    /// Deletes a job that has ended: its rows go, and its id is never used again.
    async fn delete(&self, job: JobId) -> Result<Deleted, LedgerError>;
    /// Whether there was a job of this id that is deleted.
    async fn is_deleted(&self, job: JobId) -> Result<bool, LedgerError>;
    /// Name of this ledger, made with it; `None` where the ledger ends with its process.
    async fn identity(&self) -> Result<Option<String>, LedgerError>;
    /// Secret of this ledger's audits, made with it, or when this version first opened it.
    async fn audit_key(&self) -> Result<AuditKey, LedgerError>;
    /// One job.
    async fn job(&self, job: JobId) -> Result<Option<JobRow>, LedgerError>;
    /// Jobs in the order of their submission, the latest `limit` of them.
    async fn jobs(&self, limit: u32) -> Result<Vec<JobRow>, LedgerError>;
    /// The job's stages with their counts, in order.
    async fn stages(&self, job: JobId) -> Result<Vec<StageRow>, LedgerError>;
    /// Jobs as [`Self::jobs`] gives them, each with its stages as [`Self::stages`] gives them, in few queries.
    async fn overviews(&self, limit: u32) -> Result<Vec<(JobRow, Vec<StageRow>)>, LedgerError>;

    // The steward.

    /// Takes or keeps the right to drive a job for `duration_ms`; `None` while another has it or
    /// once the job has ended. A new steward gets a new epoch.
    async fn steward(
        &self,
        job: JobId,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<Option<Epoch>, LedgerError>;
    /// Prolongs all rights to drive jobs that a coordinator has and that have not ended, as
    /// [`Self::steward`] does one by one.
    async fn renew_stewardships(
        &self,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<(), LedgerError>;
    /// Unfinished jobs that this coordinator should look at, in the order of their submission: jobs without a
    /// steward, and its own jobs with no open stage, with a complete stage, or with a chunk of this number of
    /// suspicions.
    async fn attention(
        &self,
        who: &CoordinatorId,
        suspicions: u32,
    ) -> Result<Vec<JobId>, LedgerError>;
    /// Jobs that have not ended.
    async fn unfinished_jobs(&self) -> Result<Vec<JobId>, LedgerError>;
    /// Closes and opens stages and keeps the snapshot of the algorithm after that: all or nothing.
    async fn advance(&self, job: JobId, epoch: Epoch, step: Advance) -> Result<(), LedgerError>;
    /// Cuts a ready chunk into pieces, which must make it up without gap or overlap.
    async fn split(
        &self,
        chunk: identity::ChunkId,
        epoch: Epoch,
        pieces: &[Piece],
    ) -> Result<(), LedgerError>;
    /// Accepts the coordinator's own verdict on a ready chunk that no worker survives.
    async fn fail_item(
        &self,
        chunk: identity::ChunkId,
        epoch: Epoch,
        result: ResultObject,
    ) -> Result<(), LedgerError>;
    /// Takes the result of a finished chunk of an open stage back, because its object is lost: the chunk
    /// is ready again. One that is not finished is left alone.
    async fn reopen(&self, chunk: identity::ChunkId, epoch: Epoch) -> Result<(), LedgerError>;

    /// Ends a job.
    async fn finish(&self, job: JobId, epoch: Epoch, end: JobEnd) -> Result<(), LedgerError>;
    /// Accepted and failed chunks of a stage from item `from` on, in the order of their items,
    /// at most `limit` of them.
    async fn finished_chunks(
        &self,
        job: JobId,
        stage: StageId,
        from: u64,
        limit: u32,
    ) -> Result<Vec<ChunkRow>, LedgerError>;
    /// Ready chunks that have at least `suspicions` suspicions against them, the last of which is not later than
    /// `until`: the worker that lost the chunk had the time since then to call again.
    async fn suspects(
        &self,
        job: JobId,
        suspicions: u32,
        until: LedgerTime,
    ) -> Result<Vec<ChunkRow>, LedgerError>;
    /// Number of finished items of a job, by worker.
    async fn contributions(&self, job: JobId) -> Result<Vec<Contribution>, LedgerError>;

    // Workers.

    /// Leases up to `slots` chunks. A repeated request of a worker gets the same leases. A worker that asks is alive:
    /// suspicions from silences of its session are taken back.
    async fn lease(&self, request: LeaseRequest) -> Result<Vec<Lease>, LedgerError>;
    /// Prolongs leases by `duration_ms` from now.
    async fn renew(
        &self,
        leases: &[LeaseId],
        duration_ms: u64,
    ) -> Result<Vec<Renewal>, LedgerError>;
    /// Whether a lease stands, and who has it.
    async fn standing(&self, lease: LeaseId) -> Result<Standing, LedgerError>;

    /// Accepts a chunk's result, whose object is already durable.
    async fn complete(
        &self,
        lease: LeaseId,
        result: ResultObject,
    ) -> Result<Completion, LedgerError>;
    /// Votes for the result of a chunk that is executed twice. The chunk is accepted once two executions agree; until
    /// then it is ready again, for a worker of another credential if one is here, else for another worker if one is
    /// here. A worker with a different result is evicted: it gets no more chunks, its leases end, and its unconfirmed
    /// chunks in open stages are queued again. A job that has used a wrong result in a closed stage fails.
    async fn confirm(
        &self,
        lease: LeaseId,
        result: ResultObject,
        why: Confirmation,
    ) -> Result<Completion, LedgerError>;
    /// Chunks of unfinished jobs for which executions found different things, some of them.
    async fn disputes(&self) -> Result<Vec<Dispute>, LedgerError>;
    /// Takes the vote away that was cast under this lease, if it is there; a worker with a wrong vote is evicted, as
    /// in [`Self::confirm`].
    async fn strike(&self, vote: LeaseId, why: Strike) -> Result<(), LedgerError>;
    /// Evicts a worker of which the coordinator itself found that it computes wrongly, as in [`Self::confirm`].
    async fn evict(&self, worker: &WorkerId) -> Result<(), LedgerError>;
    /// Returns a leased chunk to ready. A lease that has ended is left alone.
    async fn give_back(&self, lease: LeaseId, why: GiveBack) -> Result<(), LedgerError>;
    /// Returns chunks whose lease has ended when this is called to ready, each with one more suspicion. Leases that
    /// were renewed before are not among them, however long the writing takes.
    async fn expire(&self) -> Result<Vec<Expired>, LedgerError>;
    /// Remembers that a worker was here. A name belongs to the credential that it came with, while its worker
    /// is here.
    async fn seen(&self, worker: WorkerSeen) -> Result<(), LedgerError>;
    /// All workers that were ever seen, the latest `limit` of them.
    async fn workers(&self, limit: u32) -> Result<Vec<WorkerRow>, LedgerError>;
}
