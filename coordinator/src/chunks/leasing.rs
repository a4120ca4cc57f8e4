//! Policy: the numbers by which chunks are leased, renewed and taken back.

use super::sizing::Sizing;
use super::speculation::Speculation;
use crate::coordinator::conduct::ConductRules;
use crate::jobs::planning_queue::PlanningLimits;
use crate::ledger::identity::{RequestId, WorkerId};
use crate::ledger::rows::LeaseRequest;
use crate::results::retention::Retention;
use cognate_algorithms::plan::PLANNING_OPERATIONS;

/// The numbers by which chunks are leased, renewed and taken back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Policy {
    /// How long a worker keeps a chunk without renewal, in milliseconds. Default 10,000: a worker
    /// renews every third of it, so that two lost renewals are survived; a killed worker's chunks
    /// wait no longer than this.
    pub lease_ms: u64,
    /// How long a coordinator keeps the right to drive a job without renewal, in milliseconds.
    /// Default 5000: so long a job waits for another steward when its own is killed.
    pub steward_ms: u64,
    /// How often expired leases are looked for, in milliseconds. Default 1000.
    pub expiry_ms: u64,
    /// So many suspicions on different leases isolate a chunk. Default 3: one is a machine that
    /// was switched off, two a bad day.
    pub suspicion_limit: u32,
    /// Into how many pieces an isolated chunk is split. Default 8: a chunk of 512 paths is down to
    /// one path after three rounds.
    pub split_into: u64,
    /// A job has at most this many chunks with workers. Default 20,000.
    pub in_flight_limit: u32,
    /// So many of a hundred chunks are accepted only once two workers found the same; a worker that is alone
    /// is believed. Default 1, which costs a hundredth of the work again: of a worker that
    /// computes wrongly every hundredth chunk shows it, and what it alone found is done again.
    pub audit_percent: u32,
    /// So many of a hundred chunks with results that the coordinator cannot check are accepted only once workers of two
    /// credentials found the same, where there are two: ends that are no regular finite points, counts of mixed
    /// cells, local dimensions, second derivatives. Such an end takes a solution away where it is wrong.
    /// Default 100: where most paths diverge that doubles the work; where all workers have one credential it
    /// costs nothing.
    pub unchecked_audit_percent: u32,
    /// Checks regular ends by Newton's method, and certificates and digits by making them again, before they are
    /// accepted. Default true; false where all workers are this program's own.
    pub check_results: bool,
    /// Chunks are cut so small that about so many of a hundred paths are tracked again at most, however often
    /// workers are lost. Default 1; 0: chunks are as large as `sizing` says.
    pub rework_percent: u32,
    /// Of a stage of more paths than these only the ends are held in memory that matter to others (see
    /// `solutions::streamed`). Default 100,000, which take about 100 MB.
    pub held_paths: u64,
    /// Planning a polyhedral start counts mixed cells in at most so many operations, about one for each
    /// multiplication; what takes more is counted by workers. Default 2,000,000,000: a few seconds.
    pub counting_operations: u64,
    /// When a worker that fails is put aside.
    pub conduct: ConductRules,
    /// How many problems are planned at once, and for how long.
    pub planning: PlanningLimits,
    /// Rule for the size of chunks.
    pub sizing: Sizing,
    /// When the last chunks of a stage are given to a second worker.
    pub speculation: Speculation,
    /// How long what has ended is kept.
    pub retention: Retention,
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            lease_ms: 10_000,
            steward_ms: 5000,
            expiry_ms: 1000,
            suspicion_limit: 3,
            split_into: 8,
            in_flight_limit: 20_000,
            audit_percent: 1,
            unchecked_audit_percent: 100,
            check_results: true,
            rework_percent: 1,
            held_paths: 100_000,
            counting_operations: PLANNING_OPERATIONS,
            conduct: ConductRules::default(),
            planning: PlanningLimits::default(),
            sizing: Sizing::default(),
            speculation: Speculation::default(),
            retention: Retention::default(),
        }
    }
}

impl Policy {
    /// What a worker's question asks of the ledger.
    pub fn request(
        &self,
        worker: WorkerId,
        request: RequestId,
        numerics_revision: u32,
        threads: u32,
        slots: u32,
    ) -> LeaseRequest {
        LeaseRequest {
            worker,
            request,
            numerics_revision,
            threads,
            slots,
            duration_ms: self.lease_ms,
            sizing: self.sizing,
            speculation: self.speculation,
            suspicion_limit: self.suspicion_limit,
            in_flight_limit: self.in_flight_limit,
            without: Vec::new(),
        }
    }
}
