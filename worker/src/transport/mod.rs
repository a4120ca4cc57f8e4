//! Transport: the calls that a worker makes to a coordinator, by whatever way.
//!
//! One trait in this crate's own types; only the implementations below know
//! what a message looks like, and only `way` knows what carries it.

pub mod address;
pub mod connect;
pub mod grpc;
pub mod route;
pub mod shared_memory;
pub mod tokens;

use crate::chunk_runner::TrackedChunk;
use crate::machine::Machine;
use async_trait::async_trait;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::{Stage, StageId};
use cognate_systems::system::System;
use std::fmt;
use std::ops::Range;
use std::time::Duration;

/// A chunk that was leased, with the epoch of the lease. An older epoch of a chunk is worth nothing.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LeaseId {
    /// The job.
    pub job: String,
    /// The stage within the job.
    pub stage: StageId,
    /// The chunk within the stage.
    pub chunk: u64,
    /// How often the chunk has been leased.
    pub epoch: u64,
}

impl fmt::Display for LeaseId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            job,
            stage,
            chunk,
            epoch,
        } = self;
        write!(f, "{job}/{}/{chunk}/{epoch}", stage.0)
    }
}

/// A chunk to track.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lease {
    /// Chunk and epoch of the lease.
    pub id: LeaseId,
    /// Digest of the system to solve.
    pub problem: Digest,
    /// Digest of the stage: under it, the stage is the same on every day.
    pub stage: Digest,
    /// The items of the stage.
    pub items: Range<u64>,
    /// How long the lease lasts, unless it is renewed.
    pub lasts: Duration,
    /// Suspected to kill its worker: nothing else should run beside it.
    pub alone: bool,
}

/// Answer to a pull.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pulled {
    /// Chunks to track, perhaps none.
    pub leases: Vec<Lease>,
    /// Why this worker gets no work, ever.
    pub refused: Option<String>,
    /// The coordinator is stopping; it may come back.
    pub draining: bool,
}

/// Answer to the renewal of a lease.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renewal {
    /// The lease lasts this long from now.
    Held(Duration),
    /// The lease belongs to another worker by now, or its job has ended.
    Lost,
}

/// Answer of the coordinator to a report. The report is not sent again after any of these answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Receipt {
    /// The results are durable now.
    Accepted,
    /// Equal results were durable already.
    AlreadyAccepted,
    /// The lease was another worker's by then, or the job had ended.
    Stale,
    /// Other results are there for the same lease: one of two executions is wrong.
    HashDiffers,
    /// The coordinator could not make sense of the report.
    Invalid(String),
}

/// Why a chunk goes back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GiveBack {
    /// The worker is stopping; no failure of the chunk.
    Draining,
    /// Objects that the chunk needs cannot be fetched, and why: a failure of storage, not of the chunk.
    Unfetched(String),
    /// The chunk cannot be tracked here, and why.
    Failed(String),
}

/// Description of this worker, sent with its pulls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Announcement {
    /// The worker's name.
    pub worker: String,
    /// Drawn anew by each process.
    pub session: String,
    /// The computer that the worker runs on.
    pub machine: Machine,
    /// Threads that track.
    pub threads: usize,
    /// Most lanes of each thread.
    pub lane_width: usize,
}

/// Why a call has no answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TransportError {
    /// No coordinator answered in time, or it asks to try again.
    #[error("{0}")]
    Unavailable(String),
    /// The coordinator does not have it, or will not do it; asking again changes nothing.
    #[error("{0}")]
    Refused(String),
    /// The answer was none of this protocol.
    #[error("the coordinator's answer makes no sense: {0}")]
    Malformed(String),
}

/// The calls of a worker. Each may be made again after a lost answer.
#[async_trait]
pub trait Transport: Send + Sync {
    /// Asks for up to `free` chunks; the coordinator may wait up to `wait` for some. The same
    /// `sequence` again asks for the same answer.
    async fn pull(
        &self,
        sequence: u64,
        free: usize,
        wait: Duration,
    ) -> Result<Pulled, TransportError>;
    /// Keeps leases; one renewal for each, in order.
    async fn renew(&self, leases: &[LeaseId]) -> Result<Vec<Renewal>, TransportError>;
    /// Hands in a finished chunk.
    async fn report(
        &self,
        lease: &LeaseId,
        chunk: &TrackedChunk,
    ) -> Result<Receipt, TransportError>;
    /// Gives chunks back.
    async fn give_back(&self, leases: &[LeaseId], why: &GiveBack) -> Result<(), TransportError>;
    /// Says goodbye: the session ends, and whatever it still holds is free.
    async fn leave(&self) -> Result<(), TransportError>;
    /// The system of a problem.
    async fn system(&self, problem: Digest) -> Result<System, TransportError>;
    /// A stage of a job.
    async fn stage(&self, job: &str, stage: StageId) -> Result<Stage, TransportError>;
    /// Stored start points.
    async fn points(&self, object: Digest) -> Result<StoredPoints, TransportError>;
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A lease of one job and stage.
    pub(crate) fn lease(chunk: u64) -> LeaseId {
        LeaseId {
            job: "job".to_owned(),
            stage: StageId(0),
            chunk,
            epoch: 1,
        }
    }
}
