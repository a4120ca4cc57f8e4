//! Accusations in memory: which workers died of a chunk, or could not do it, and who gets it next.

use super::tables::{Chunk, Tables, Worker};
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::PRESENT_MS;

impl Worker {
    fn is_here(&self, now: LedgerTime, numerics_revision: u32) -> bool {
        !self.says.draining
            && !self.evicted
            && self.says.numerics_revision == numerics_revision
            && self.last_seen.0 > now.0.saturating_sub_unsigned(PRESENT_MS)
    }

    fn is_proven(&self, now: LedgerTime, duration_ms: u64) -> bool {
        self.first_seen.0 <= now.0.saturating_sub_unsigned(duration_ms)
    }
}

impl Tables {
    /// Remembers that a worker accuses a chunk. One worker counts once, while others are here that have
    /// not tried.
    pub fn accuse(&mut self, now: LedgerTime, id: ChunkId, who: &WorkerId) {
        let Some(job) = self.jobs.get(&id.job) else {
            return;
        };
        let revision = job.row.asked.numerics_revision;
        let stage = job.stages.get(&id.stage);
        let Some(chunk) = stage.and_then(|stage| stage.chunks.get(&id.first)) else {
            return;
        };
        let other_could = self.workers.values().any(|other| {
            other.is_here(now, revision)
                && other.says.worker != *who
                && !chunk.accusers.contains(&other.says.worker)
        });
        if let Some(chunk) = self.chunk(id) {
            if !chunk.accusers.insert(who.clone()) && other_could {
                return;
            }
            chunk.row.suspicions += 1;
        }
    }

    /// Whether a worker may have a chunk by what is suspected of it: a suspect is for those that have
    /// been here for a lease's time and have not tried it, where there are some.
    pub fn may_try(&self, now: LedgerTime, chunk: &Chunk, request: &LeaseRequest) -> bool {
        if chunk.row.suspicions == 0 {
            return true;
        }
        let tried = |worker: &WorkerId| chunk.accusers.contains(worker);
        let requester = self.workers.get(&request.worker);
        let is_proven = requester.is_some_and(|worker| worker.is_proven(now, request.duration_ms));
        if is_proven && !tried(&request.worker) {
            return true;
        }
        !self.workers.values().any(|other| {
            other.is_here(now, request.numerics_revision)
                && other.is_proven(now, request.duration_ms)
                && other.says.worker != request.worker
                && !tried(&other.says.worker)
        })
    }
}
