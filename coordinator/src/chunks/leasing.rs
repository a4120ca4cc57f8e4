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
    /// Suspicions on different leases after which a chunk is isolated. Default 3: one is a machine that was switched
    /// off, two may be chance.
    pub suspicion_limit: u32,
    /// Pieces into which an isolated chunk is split. Default 8: a chunk of 512 paths is down to one path after three
    /// rounds.
    pub split_into: u64,
    /// Chunks of a job that are leased at once, at most. Default 20,000.
    pub in_flight_limit: u32,
    /// Percentage of chunks that are accepted only after two workers found the same result; the only worker of a
    /// service is believed. Default 1, which repeats a hundredth of the work: if a worker computes wrongly, every
    /// hundredth chunk reveals it, and its unconfirmed results are computed again.
    pub audit_percent: u32,
    /// Percentage of chunks with results that the coordinator cannot check (ends that are no regular finite points,
    /// counts of mixed cells, local dimensions, second derivatives) that are accepted only after workers of two
    /// credentials found the same result, where there are two. A wrong end of this kind takes a solution away.
    /// Default 100: this doubles the work where most paths diverge, and costs nothing where all workers have one
    /// credential.
    pub unchecked_audit_percent: u32,
    /// Checks regular ends by Newton's method, and certificates and digits by making them again, before they are
    /// accepted. Default true; false where all workers are this program's own.
    pub check_results: bool,
    /// Percentage of paths that may be tracked again because workers are lost: chunks are cut small enough for that.
    /// Default 1; 0: chunks are as large as `sizing` says.
    pub rework_percent: u32,
    /// Paths of a stage above which only the ends that matter to other paths are held in memory (see
    /// `solutions::streamed`). Default 100,000, which take about 100 MB.
    pub held_paths: u64,
    /// Operations, about one for each multiplication, that planning a polyhedral start may use to count mixed cells;
    /// larger counts are left to workers. Default 2,000,000,000: a few seconds.
    pub counting_operations: u64,
    /// Rules by which a worker that fails is put aside.
    pub conduct: ConductRules,
    /// Number of problems that are planned at once, and time limits of planning.
    pub planning: PlanningLimits,
    /// Rule for the size of chunks.
    pub sizing: Sizing,
    /// Rule by which the last chunks of a stage are given to a second worker.
    pub speculation: Speculation,
    /// Time for which jobs that have ended are kept.
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
    /// Request to the ledger for chunks that this worker asks for.
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
