//! Audits in memory: votes on chunks, and what becomes of a worker that was outvoted.

use super::tables::{Chunk, Stage, Tables};
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::{PRESENT_MS, tainted};

impl Chunk {
    /// Whether this worker has executed the chunk for an audit.
    pub fn has_vote_of(&self, worker: &WorkerId) -> bool {
        self.votes.iter().any(|vote| vote.worker == *worker)
    }
}

impl Stage {
    /// Takes the result of a finished chunk back.
    pub fn reopen(&mut self, first: u64) {
        let Some(chunk) = self.chunks.get_mut(&first) else {
            return;
        };
        let (count, result, cpu_micros) = match &chunk.row.state {
            ChunkState::Accepted { result, .. } => {
                (&mut self.row.accepted, result, result.cpu_micros)
            }
            // What the coordinator itself said of a chunk took no time that was counted.
            ChunkState::Failed { result } => (&mut self.row.failed, result, 0),
            ChunkState::Ready | ChunkState::Leased { .. } => return,
        };
        count.items -= chunk.row.items.len();
        count.chunks -= 1;
        self.row.cpu_micros -= cpu_micros;
        self.row.outcomes.take(result.outcomes);
        chunk.row.state = ChunkState::Ready;
        chunk.votes.clear();
        self.count(first);
    }

    /// Chunks of this worker for which nobody else has found the same.
    fn unconfirmed(&self, of: &WorkerId) -> Vec<u64> {
        let chunks = self.chunks.iter().filter(|(_, chunk)| {
            let ChunkState::Accepted { worker, result } = &chunk.row.state else {
                return false;
            };
            let mut votes = chunk.votes.iter();
            worker == of && !votes.any(|v| v.worker != *of && v.hash == result.hash)
        });
        chunks.map(|(first, _)| *first).collect()
    }
}

impl Tables {
    pub fn is_evicted(&self, worker: &WorkerId) -> bool {
        self.workers.get(worker).is_some_and(|known| known.evicted)
    }

    /// Whether no other worker is here that could confirm what this one finds.
    pub fn is_only_worker(&self, now: LedgerTime, request: &LeaseRequest) -> bool {
        !self.workers.values().any(|other| {
            other.says.worker != request.worker
                && other.says.numerics_revision == request.numerics_revision
                && !other.says.draining
                && !other.evicted
                && now.since_ms(other.last_seen) < PRESENT_MS
        })
    }

    /// One execution of an audited chunk; `None` where it is not the chunk's lease that stands, nor
    /// one that voted.
    pub fn confirm(
        &mut self,
        now: LedgerTime,
        lease: LeaseId,
        result: &ResultObject,
    ) -> Option<Completion> {
        let holder = self.holder(lease);
        let chunk = self.chunk(lease.chunk)?;
        if let ChunkState::Accepted { .. } = chunk.row.state {
            return None;
        }
        let Some(holder) = holder.filter(|_| chunk.row.items == result.items) else {
            let vote = chunk.votes.iter().find(|vote| vote.epoch == lease.epoch)?;
            return Some(if vote.hash == result.hash {
                Completion::Unconfirmed
            } else {
                Completion::HashDiffers
            });
        };
        let agreed = chunk.votes.iter().any(|vote| vote.hash == result.hash);
        chunk.votes.push(Vote {
            epoch: lease.epoch,
            worker: holder.worker.clone(),
            hash: result.hash,
        });
        if !agreed {
            // Where two workers had it, neither has it now.
            self.unlease(lease.chunk, ChunkState::Ready);
            self.elders.remove(&lease.chunk);
            self.charge(lease.chunk.job, result.cpu_micros as i64);
            return Some(Completion::Unconfirmed);
        }
        let outvoted = chunk.votes.iter().filter(|vote| vote.hash != result.hash);
        let outvoted: Vec<WorkerId> = outvoted.map(|vote| vote.worker.clone()).collect();
        self.accept(now, lease.chunk, holder, result.clone());
        for worker in &outvoted {
            self.evict(now, worker);
        }
        Some(Completion::Accepted)
    }

    fn evict(&mut self, now: LedgerTime, worker: &WorkerId) {
        if let Some(known) = self.workers.get_mut(worker) {
            known.evicted = true;
        }
        for id in self.held(worker) {
            self.unlease(id, ChunkState::Ready);
        }
        self.drop_elders(|_, elder| elder.worker == *worker);
        let (mut ended, mut reopened) = (Vec::new(), Vec::new());
        for job in self.jobs.values_mut().filter(|j| !j.row.state.has_ended()) {
            let used = |stage: &Stage| stage.row.closed && !stage.unconfirmed(worker).is_empty();
            let is_tainted = job.stages.values().any(used);
            let mut touched = is_tainted;
            if is_tainted {
                job.row.state = JobState::Failed;
                job.row.reason = Some(tainted(worker));
                job.row.ended = Some(now);
                ended.push(job.row.job);
            } else {
                for stage in job.stages.values_mut() {
                    for first in stage.unconfirmed(worker) {
                        stage.reopen(first);
                        reopened.push(ChunkId {
                            job: job.row.job,
                            stage: stage.row.stage,
                            first,
                        });
                        touched = true;
                    }
                }
            }
            if touched {
                // Whoever drives it has read what is not so any more.
                job.row.steward = None;
                job.row.steward_epoch.0 += 1;
                job.row.steward_until = LedgerTime(0);
            }
        }
        for chunk in reopened {
            self.elders.remove(&chunk);
        }
        for job in ended {
            self.release_all(job);
        }
    }
}
