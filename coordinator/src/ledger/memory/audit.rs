//! Audits in memory: votes on chunks, and what becomes of a worker that was outvoted.

use super::tables::{Chunk, Stage, Tables, Worker};
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::{HEARD_MS, tainted};

impl Chunk {
    fn has_vote_of(&self, worker: &WorkerId) -> bool {
        self.votes.iter().any(|vote| vote.worker == *worker)
    }

    fn has_vote_by(&self, credential: &Credential) -> bool {
        self.votes.iter().any(|vote| vote.credential == *credential)
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
            // A result that the coordinator itself gave took no time that was counted.
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
    fn unconfirmed(&self, author: &WorkerId) -> Vec<u64> {
        let chunks = self.chunks.iter().filter(|(_, chunk)| {
            let ChunkState::Accepted { worker, result } = &chunk.row.state else {
                return false;
            };
            let mut votes = chunk.votes.iter();
            worker == author && !votes.any(|v| v.worker != *author && v.hash == result.hash)
        });
        chunks.map(|(first, _)| *first).collect()
    }
}

impl Tables {
    pub fn is_evicted(&self, worker: &WorkerId) -> bool {
        self.workers
            .get(worker)
            .is_some_and(|record| record.evicted)
    }

    /// Workers of this revision that are here.
    fn here(&self, now: LedgerTime, revision: u32) -> impl Iterator<Item = &Worker> {
        self.workers.values().filter(move |worker| {
            worker.says.numerics_revision == revision
                && !worker.says.draining
                && !worker.evicted
                && now.since_ms(worker.last_seen) < HEARD_MS
        })
    }

    /// Whether no other worker is here that could confirm what this one finds.
    fn is_only_worker(&self, now: LedgerTime, who: &WorkerId, revision: u32) -> bool {
        !self
            .here(now, revision)
            .any(|other| other.says.worker != *who)
    }

    /// Whether this worker may vote on a chunk: a worker of another credential, if one is here; else of another name;
    /// else the only worker. Where the votes differ only a worker of another credential may; the coordinator decides
    /// meanwhile.
    pub fn may_vote(&self, now: LedgerTime, chunk: &Chunk, request: &LeaseRequest) -> bool {
        let (who, revision) = (&request.worker, request.numerics_revision);
        let agree = chunk.votes.len() < 2;
        if chunk.votes.is_empty() || (agree && self.is_only_worker(now, who, revision)) {
            return true;
        }
        let is_new = |worker: &Worker| !chunk.has_vote_by(&worker.says.credential);
        let by_credential = self.workers.get(who).is_none_or(is_new);
        let nobody_else = || agree && !self.here(now, revision).any(is_new);
        !chunk.has_vote_of(who) && (by_credential || nobody_else())
    }

    /// Chunks for which executions found different things.
    pub fn disputes(&self) -> Vec<Dispute> {
        let going_on = self.jobs.values().filter(|job| !job.row.state.has_ended());
        let stages = going_on.flat_map(|job| job.stages.values());
        let ready = stages.flat_map(|s| s.ready.iter().filter_map(|first| s.chunks.get(first)));
        let disputed = ready.filter(|chunk| chunk.votes.len() >= 2);
        let dispute = |chunk: &Chunk| Dispute {
            chunk: chunk.row.clone(),
            votes: chunk.votes.clone(),
        };
        disputed.map(dispute).collect()
    }

    /// Takes a vote away.
    pub fn strike(&mut self, now: LedgerTime, vote: LeaseId, why: Strike) {
        let Some(chunk) = self.chunk(vote.chunk) else {
            return;
        };
        if matches!(chunk.row.state, ChunkState::Accepted { .. }) {
            return;
        }
        let place = chunk.votes.iter().position(|cast| cast.epoch == vote.epoch);
        let Some(struck) = place.map(|place| chunk.votes.remove(place)) else {
            return;
        };
        if why == Strike::Wrong {
            self.evict(now, &struck.worker);
        }
    }

    /// One execution of an audited chunk; `None` where it is not the chunk's lease that stands, nor
    /// one that voted.
    pub fn confirm(
        &mut self,
        now: LedgerTime,
        lease: LeaseId,
        result: &ResultObject,
        why: Confirmation,
    ) -> Option<Completion> {
        let holder = self.holder(lease);
        let name = holder.as_ref().map(|holder| holder.worker.clone());
        let reporter = name.and_then(|name| self.workers.get(&name));
        let (credential, is_believed) = match reporter.map(|worker| &worker.says) {
            Some(says) => {
                let is_believed = match why {
                    Confirmation::Audit => {
                        self.is_only_worker(now, &says.worker, says.numerics_revision)
                    }
                    Confirmation::Unchecked => self
                        .here(now, says.numerics_revision)
                        .all(|other| other.says.credential == says.credential),
                    Confirmation::Compare => true,
                    Confirmation::Doubt | Confirmation::Wrong => false,
                };
                (says.credential.clone(), is_believed)
            }
            // It never said what it is: nobody is of its revision.
            None => {
                let is_right = !matches!(why, Confirmation::Doubt | Confirmation::Wrong);
                (Credential::default(), is_right)
            }
        };
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
        if why == Confirmation::Wrong {
            // The leases of the worker end, this one among them.
            self.evict(now, &holder.worker);
            return Some(Completion::Unconfirmed);
        }
        if is_believed && chunk.votes.is_empty() {
            return None;
        }
        let agreed = chunk.votes.iter().any(|vote| vote.hash == result.hash);
        chunk.votes.push(Vote {
            epoch: lease.epoch,
            worker: holder.worker.clone(),
            credential,
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

    /// Takes a worker's leases, its right to others, and what it alone has found.
    pub fn evict(&mut self, now: LedgerTime, worker: &WorkerId) {
        if let Some(record) = self.workers.get_mut(worker) {
            record.evicted = true;
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
                // The steward of the job has read results that were taken back.
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
