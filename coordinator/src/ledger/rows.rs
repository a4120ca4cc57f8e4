//! Rows of the ledger and arguments of its calls: pure data.

use super::clock::LedgerTime;
use super::identity::*;
use crate::chunks::sizing::Sizing;
use crate::chunks::speculation::{Pace, Speculation};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::start_points::Digest;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::work::StageId;
use serde::{Deserialize, Serialize};

/// State of a job, from submission to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JobState {
    /// Submitted; no stage is open yet.
    Queued,
    /// Stages are open or about to be.
    Running,
    /// The job ended with solutions and a summary.
    Solved,
    /// The job ended without a result; its row has the reason.
    Failed,
    /// A client ended the job.
    Cancelled,
}

impl JobState {
    /// All states.
    pub const ALL: [Self; 5] = [
        Self::Queued,
        Self::Running,
        Self::Solved,
        Self::Failed,
        Self::Cancelled,
    ];

    /// The state in one word, as the ledger and the clients write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Running => "running",
            Self::Solved => "solved",
            Self::Failed => "failed",
            Self::Cancelled => "cancelled",
        }
    }

    /// True once nothing more will happen.
    pub fn has_ended(self) -> bool {
        matches!(self, Self::Solved | Self::Failed | Self::Cancelled)
    }
}

/// Job as a client submits it. Large parts are objects, named by their digests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NewJob {
    /// Tenant on whose behalf the job runs.
    pub tenant: Tenant,
    /// Name of the job for people: a file's name, for instance.
    pub label: String,
    /// The checked system, as an object.
    pub problem: Digest,
    /// Options of the solution, as the planner reads them.
    pub options: Vec<u8>,
    /// Only workers of this numerics revision may track its paths.
    pub numerics_revision: u32,
}

/// Outcome of a submission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Submitted {
    /// The job.
    pub job: JobId,
    /// False when an earlier submission with this request id had made the job.
    pub is_new: bool,
}

/// Outcome of a cancellation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cancelled {
    /// The job was going on and is cancelled now.
    Now,
    /// The job had ended before, in this state.
    HadEnded(JobState),
}

/// Outcome of a deletion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deleted {
    /// The job had ended, and its rows are gone now.
    Now {
        /// Number of stages that it had.
        stages: u64,
        /// Number of chunks that it had.
        chunks: u64,
    },
    /// It was deleted before.
    Before,
    /// It has not ended, and nothing was changed.
    GoesOn(JobState),
}

/// A job's row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobRow {
    /// The job.
    pub job: JobId,
    /// Jobs count from 1 in the order of their submission.
    pub number: u64,
    /// The submission that the job carries out.
    pub asked: NewJob,
    /// State of the job.
    pub state: JobState,
    /// Why the job failed or was cancelled; `None` in other states.
    pub reason: Option<String>,
    /// Time of the submission, by the ledger's clock.
    pub submitted: LedgerTime,
    /// Time of the job's first lease; `None` before.
    pub started: Option<LedgerTime>,
    /// Time at which the job ended; `None` before.
    pub ended: Option<LedgerTime>,
    /// Coordinator that drives the job; `None` where there is none.
    pub steward: Option<CoordinatorId>,
    /// Epoch of the last steward; 0 before the first.
    pub steward_epoch: Epoch,
    /// Time until which the steward's right lasts.
    pub steward_until: LedgerTime,
    /// The algorithm's state after the last closed stage, as an object.
    pub snapshot: Option<Digest>,
    /// The solutions, as an object.
    pub solutions: Option<Digest>,
    /// The summary, as an object.
    pub summary: Option<Digest>,
}

/// A stage that is to be opened, already cut into chunks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NewStage {
    /// Number of the stage within the job, from 0.
    pub stage: StageId,
    /// The stage, as an object.
    pub definition: Digest,
    /// Number of items: paths, points or branches.
    pub items: u64,
    /// Chunks of the stage, which make up its items in order. A lease may cut them smaller.
    pub chunks: Vec<ItemRange>,
}

/// One step of a job: what a steward writes in one piece.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Advance {
    /// Stages whose results have all been absorbed.
    pub close: Vec<StageId>,
    /// The stages that the algorithm opened after that.
    pub open: Vec<NewStage>,
    /// The algorithm's state after that, as an object.
    pub snapshot: Option<Digest>,
}

/// The end of a job: with an answer, or with a reason why there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JobEnd {
    /// With solutions and a summary, both objects.
    Solved {
        /// The solutions.
        solutions: Digest,
        /// The summary.
        summary: Digest,
    },
    /// The job ended without a result.
    Failed {
        /// One sentence for the client.
        reason: String,
    },
}

/// Items and chunks of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Count {
    /// Number of items: paths, points or branches.
    pub items: u64,
    /// Number of chunks.
    pub chunks: u64,
}

/// How tracked paths ended, before any verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcomes {
    /// At a regular endpoint.
    pub regular: u64,
    /// At a singular endpoint, or at infinity without one that was settled, or not followed so far.
    pub singular: u64,
    /// Before the end.
    pub failed: u64,
}

impl Outcomes {
    /// Counts the outcomes of some results of a stage; none where the stage tracks no paths.
    pub fn of(results: &[ItemResult]) -> Self {
        let mut outcomes = Self::default();
        for result in results.iter().filter_map(ItemResult::path) {
            match result.outcome {
                PathOutcome::Regular => outcomes.regular += 1,
                PathOutcome::Singular | PathOutcome::Diverging | PathOutcome::PutAside => {
                    outcomes.singular += 1;
                }
                PathOutcome::Failed(_) => outcomes.failed += 1,
            }
        }
        outcomes
    }

    /// Takes another count out of this one, which holds it.
    pub fn take(&mut self, other: Self) {
        self.regular -= other.regular;
        self.singular -= other.singular;
        self.failed -= other.failed;
    }

    /// Adds another count to this one.
    pub fn add(&mut self, other: Self) {
        self.regular += other.regular;
        self.singular += other.singular;
        self.failed += other.failed;
    }
}

/// A stage's row with its counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageRow {
    /// Number of the stage within the job, from 0.
    pub stage: StageId,
    /// The stage, as an object.
    pub definition: Digest,
    /// Number of items: paths, points or branches.
    pub items: u64,
    /// False while its results are still awaited or not yet absorbed.
    pub closed: bool,
    /// Items and chunks that wait for a worker.
    pub ready: Count,
    /// Items and chunks that are leased to workers.
    pub leased: Count,
    /// Items and chunks whose results were accepted.
    pub accepted: Count,
    /// Items and chunks that the coordinator gave up: each has a result that says so.
    pub failed: Count,
    /// CPU time of the accepted items, in microseconds.
    pub cpu_micros: u64,
    /// Outcomes of the accepted and failed paths; none where the stage tracks no paths.
    pub outcomes: Outcomes,
    /// How long the accepted chunks were with the workers that reported them, in milliseconds.
    pub held_ms: u64,
    /// How many chunks were given to a second worker because the first was late.
    pub speculative_leases: u64,
    /// How many of these the second worker reported first.
    pub speculative_won: u64,
}

impl StageRow {
    /// Items and time of the accepted chunks.
    pub fn pace(&self) -> Pace {
        Pace {
            items: self.accepted.items,
            held_ms: self.held_ms,
        }
    }

    /// The sum that must be `items`.
    pub fn accounted(&self) -> u64 {
        self.ready.items + self.leased.items + self.accepted.items + self.failed.items
    }

    /// True when every item has a result.
    pub fn is_complete(&self) -> bool {
        self.accepted.items + self.failed.items == self.items
    }
}

/// Where a chunk is; each state carries its data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChunkState {
    /// The chunk waits for a worker.
    Ready,
    /// The chunk is leased to a worker.
    Leased {
        /// Name of the worker.
        worker: WorkerId,
        /// Time at which the lease expires, unless it is renewed.
        until: LedgerTime,
    },
    /// The chunk's results were accepted from a worker.
    Accepted {
        /// Name of the worker.
        worker: WorkerId,
        /// The object that holds the results.
        result: ResultObject,
    },
    /// Given up by the coordinator, with a result that says so.
    Failed {
        /// The object that holds a failed result for each item.
        result: ResultObject,
    },
}

/// A chunk's row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChunkRow {
    /// The chunk.
    pub chunk: ChunkId,
    /// Range of the stage's items that the chunk holds.
    pub items: ItemRange,
    /// State of the chunk.
    pub state: ChunkState,
    /// Epoch of its last lease; 0 before the first.
    pub epoch: Epoch,
    /// How many of its leases ended with a dead, silent or failing worker.
    pub suspicions: u32,
    /// True when a worker that takes it takes nothing beside it.
    pub alone: bool,
}

impl ChunkRow {
    /// The last lease of the chunk, which lasts until `until`, with the objects that a worker needs to begin.
    pub fn lease(&self, until: LedgerTime, problem: Digest, definition: Digest) -> Lease {
        Lease {
            lease: LeaseId {
                chunk: self.chunk,
                epoch: self.epoch,
            },
            items: self.items,
            until,
            problem,
            definition,
            alone: self.alone,
            speculative: false,
        }
    }
}

/// The object that holds a chunk's results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ResultObject {
    /// Range of the stage's items whose results the object holds.
    pub items: ItemRange,
    /// Address of the object in the result store.
    pub address: String,
    /// Hash over the object's records, equal for every execution.
    pub hash: Digest,
    /// CPU time of the tracking, in microseconds.
    pub cpu_micros: u64,
    /// Outcomes of the paths in the object; none where the stage tracks no paths.
    pub outcomes: Outcomes,
}

/// A piece of a chunk that is split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Range of the stage's items that the chunk holds.
    pub items: ItemRange,
    /// Suspicions that it inherits.
    pub suspicions: u32,
    /// True when a worker that takes it takes nothing beside it.
    pub alone: bool,
}

/// A worker asks for chunks.
#[derive(Clone, Debug, PartialEq)]
pub struct LeaseRequest {
    /// Name of the worker that asks.
    pub worker: WorkerId,
    /// Id of the request; a request that is sent again has the same id and gets the same leases.
    pub request: RequestId,
    /// Revision of the jobs that may be leased.
    pub numerics_revision: u32,
    /// Number of threads with which the worker tracks.
    pub threads: u32,
    /// Number of chunks that the worker wants, at most.
    pub slots: u32,
    /// Duration of the leases without renewal, in milliseconds.
    pub duration_ms: u64,
    /// Rule for the size of chunks.
    pub sizing: Sizing,
    /// Rule by which a chunk that another worker has is given to this one, too.
    pub speculation: Speculation,
    /// Suspicions from which a chunk is left for the steward to split, and not leased.
    pub suspicion_limit: u32,
    /// Chunks of a job that are leased at once, at most.
    pub in_flight_limit: u32,
    /// Jobs whose chunks are not leased, because their stages cannot be fetched now.
    pub without: Vec<JobId>,
}

impl LeaseRequest {
    /// The jobs of which nothing is given out, as one text.
    pub fn without_text(&self) -> String {
        let jobs: Vec<String> = self.without.iter().map(JobId::to_string).collect();
        jobs.join(",")
    }
}

/// A leased chunk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lease {
    /// The lease.
    pub lease: LeaseId,
    /// The chunk's items.
    pub items: ItemRange,
    /// Time at which the lease expires, unless it is renewed.
    pub until: LedgerTime,
    /// The job's problem, as an object.
    pub problem: Digest,
    /// The stage, as an object.
    pub definition: Digest,
    /// True when nothing else should run beside it.
    pub alone: bool,
    /// True when another worker has the chunk, too, and is late. (A request that is sent again is not
    /// told.)
    pub speculative: bool,
}

/// The lease before the last of a chunk that was given to a second worker: it may still report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Elder {
    /// Epoch of the elder lease.
    pub epoch: Epoch,
    /// Worker that has the elder lease.
    pub worker: WorkerId,
    /// Time at which the elder lease began.
    pub leased_at: LedgerTime,
    /// Time until which the elder lease lasts, unless renewed; `None` once the chunk is accepted.
    pub until: Option<LedgerTime>,
}

/// Worker that may report a chunk, under one of its leases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Name of the worker.
    pub worker: WorkerId,
    /// Time at which the lease began, where that is known.
    pub leased_at: Option<LedgerTime>,
    /// The lease is the one before the last.
    pub is_elder: bool,
}

impl Holder {
    /// Time for which the worker has had the chunk, in milliseconds.
    pub fn held_ms(&self, now: LedgerTime) -> u64 {
        self.leased_at.map_or(0, |since| now.since_ms(since))
    }
}

/// Whether a lease stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The lease is valid.
    Held {
        /// Name of the worker that has the chunk.
        worker: WorkerId,
        /// The question that it was leased for, where that is remembered: its session has the lease.
        request: Option<RequestId>,
    },
    /// It has ended. A lease that has ended never stands again.
    Ended,
    /// There was none yet, and there may be one in the next moment, which is somebody else's.
    Never,
}

impl Standing {
    /// Whether the lease stands and is this speaker's.
    pub fn is_of(&self, by: &Speaker) -> bool {
        let Self::Held { worker, request } = self else {
            return false;
        };
        let session = request.as_ref().map(RequestId::speaker_session);
        let same = session.is_none_or(|session| session == by.session);
        *worker == by.worker && same
    }
}

/// Answer to the renewal of a lease.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renewal {
    /// The lease lasts until this time.
    Until(LedgerTime),
    /// The lease has ended: stop working on it.
    Lost,
}

/// Outcome of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completion {
    /// This is the chunk's result now.
    Accepted,
    /// The results were accepted before under this very lease: the first answer was lost.
    AlreadyAccepted,
    /// Another worker had the chunk, too, and its equal result was accepted before: this one's object
    /// is of no use.
    Overtaken,
    /// The chunk is audited: it is ready again, and accepted once another execution agrees.
    Unconfirmed,
    /// The lease had ended: drop the result.
    Stale,
    /// Another result was accepted for the same items: one of two workers computes wrongly.
    HashDiffers,
}

/// Why a chunk comes back without a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GiveBack {
    /// The worker leaves or has too much: no failure.
    Drained,
    /// It tried and could not: counts as a suspicion at once.
    Failed {
        /// Reason of the failure, as the worker gave it.
        reason: String,
    },
}

/// A lease that ended without a word from its worker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expired {
    /// The lease.
    pub lease: LeaseId,
    /// The worker that had the lease.
    pub worker: WorkerId,
    /// Suspicions against the chunk, this one included.
    pub suspicions: u32,
}

/// Description of a worker, as it is sent with its calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkerSeen {
    /// Name of the worker.
    pub worker: WorkerId,
    /// Version of its program.
    pub version: String,
    /// `NUMERICS_REVISION` of the worker's program.
    pub numerics_revision: u32,
    /// The instruction set that it tracks with.
    pub instruction_set: String,
    /// Threads that it tracks with.
    pub threads: u32,
    /// Paths that it tracks in lockstep; 0: it depends on the stage.
    pub lane_width: u32,
    /// The machine that it runs on.
    pub host: String,
    /// How it is connected: `grpc`, for instance.
    pub transport: String,
    /// True when it takes no more chunks.
    pub draining: bool,
    /// By what it is known, whatever its name: not its own word.
    pub credential: Credential,
}

/// A worker's row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkerRow {
    /// Description of the worker from its last call.
    pub says: WorkerSeen,
    /// Time of the worker's first call.
    pub first_seen: LedgerTime,
    /// Time of the worker's last call.
    pub last_seen: LedgerTime,
    /// Items that it finished.
    pub items_done: u64,
    /// Chunks that it finished.
    pub chunks_done: u64,
    /// Chunks that it has now.
    pub leased_chunks: u64,
    /// Two others found something else for a chunk of it: it gets none any more.
    pub evicted: bool,
}

/// Work of one worker for one job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contribution {
    /// Name of the worker.
    pub worker: WorkerId,
    /// How it is connected; empty when it never said.
    pub transport: String,
    /// Items that it finished.
    pub items: u64,
    /// CPU time of the tracking, in microseconds.
    pub cpu_micros: u64,
}

/// Result of one execution of an audited chunk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vote {
    /// Epoch of the lease under which the chunk was executed.
    pub epoch: Epoch,
    /// Worker that executed the chunk.
    pub worker: WorkerId,
    /// Credential of the worker at that time.
    pub credential: Credential,
    /// Hash of the results' records.
    pub hash: Digest,
}

/// Comparison that is made before the results of a chunk are accepted, and its reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Confirmation {
    /// To compare. A worker that is alone is believed.
    Audit,
    /// The coordinator cannot check all results: the chunk is done again by a worker of another credential. Where none
    /// is here, the worker is believed.
    Unchecked,
    /// The chunk is not done again. Where other workers have reported results of the chunk, these are compared with
    /// theirs.
    Compare,
    /// The results cannot be right: the chunk is done again also where only the same worker is there.
    Doubt,
    /// The results are wrong, even if other workers find them, too: the worker is evicted, and the chunk is done
    /// again.
    Wrong,
}

/// A chunk for which executions found different things.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dispute {
    /// The chunk; it is ready, and leased only to workers whose credential has no vote.
    pub chunk: ChunkRow,
    /// Results of each execution.
    pub votes: Vec<Vote>,
}

/// Why a vote is taken away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strike {
    /// It is wrong: its worker is evicted.
    Wrong,
    /// The object that it speaks of is lost, which is no fault of the worker's.
    Lost,
}
