//! Speculation in memory: late chunks that a second worker gets, and who of the two may report.

use super::tables::Tables;
use crate::chunks::speculation::Pace;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::estimate;

impl Tables {
    /// Worker that may report under this lease; `None` where the lease has ended or the chunk has a result.
    pub fn holder(&mut self, lease: LeaseId) -> Option<Holder> {
        if let Some(elder) = self.elder(lease) {
            return Some(Holder {
                worker: elder.worker.clone(),
                leased_at: Some(elder.leased_at),
                is_elder: true,
            });
        }
        let chunk = self.chunk(lease.chunk)?;
        match &chunk.row.state {
            ChunkState::Leased { worker, .. } if chunk.row.epoch == lease.epoch => Some(Holder {
                worker: worker.clone(),
                leased_at: chunk.leased_at,
                is_elder: false,
            }),
            _ => None,
        }
    }

    /// The lease before the last of a late chunk, if it is this one and still stands.
    pub fn elder(&mut self, lease: LeaseId) -> Option<&mut Elder> {
        let elder = self.elders.get_mut(&lease.chunk)?;
        (elder.epoch == lease.epoch && elder.until.is_some()).then_some(elder)
    }

    /// Whether a chunk that is accepted was leased so, last or before.
    pub fn was_leased(&self, lease: LeaseId, last: Epoch) -> bool {
        let elder = self.elders.get(&lease.chunk);
        lease.epoch == last || elder.is_some_and(|elder| elder.epoch == lease.epoch)
    }

    /// Ends the leases before the last of which this is true.
    pub fn drop_elders(&mut self, which: impl Fn(ChunkId, &Elder) -> bool) {
        self.elders
            .retain(|&chunk, elder| elder.until.is_none() || !which(chunk, elder));
    }

    /// The leases before the last that have ended by now, each a suspicion.
    pub fn expire_elders(&mut self, now: LedgerTime) -> Vec<Expired> {
        let ended = |elder: &Elder| elder.until.is_some_and(|until| until <= now);
        let late = self.elders.iter().filter(|(_, elder)| ended(elder));
        let late: Vec<(ChunkId, Elder)> = late.map(|(id, elder)| (*id, elder.clone())).collect();
        let mut expired = Vec::new();
        for (id, elder) in late {
            self.elders.remove(&id);
            self.accuse(now, id, &elder.worker);
            if let Some(chunk) = self.chunk(id) {
                expired.push(Expired {
                    lease: LeaseId {
                        chunk: id,
                        epoch: elder.epoch,
                    },
                    worker: elder.worker,
                    suspicions: chunk.row.suspicions,
                });
            }
        }
        expired
    }

    /// Oldest late chunk of the job whose turn it is.
    fn overdue(&self, now: LedgerTime, request: &LeaseRequest) -> Option<ChunkId> {
        if self.is_evicted(&request.worker) {
            return None;
        }
        let others = self.leases.iter().filter(|(w, _)| **w != request.worker);
        let late = others.flat_map(|(_, held)| held).filter_map(|id| {
            let job = self.jobs.get(&id.job)?;
            let stage = job.stages.get(&id.stage)?;
            let chunk = stage.chunks.get(&id.first)?;
            let is_open = job.row.state == JobState::Running
                && job.row.asked.numerics_revision == request.numerics_revision
                && stage.row.ready.chunks == 0
                && !request.without.contains(&id.job);
            // A chunk under suspicion gets no second victim, and an audited chunk is done twice anyway.
            let is_sound = chunk.row.suspicions == 0 && !chunk.row.alone && chunk.votes.is_empty();
            let leased_at = chunk.leased_at?;
            let pace = match stage.row.accepted.items {
                0 => job.pace(),
                _ => stage.row.pace(),
            };
            let held_ms = now.since_ms(leased_at);
            let is_late = request
                .speculation
                .is_overdue(held_ms, chunk.row.items.len(), pace);
            let is_free = !self.elders.contains_key(id);
            let tenant = self.tenants.get(&job.row.asked.tenant).copied();
            let turn = (tenant.unwrap_or(0), job.virtual_time, job.row.number);
            (is_open && is_sound && is_late && is_free)
                .then_some(((turn, id.stage, leased_at, id.first), *id))
        });
        late.min().map(|(_, id)| id)
    }

    /// Gives a late chunk to a second worker.
    pub fn speculate(&mut self, now: LedgerTime, request: &LeaseRequest) -> Option<Lease> {
        let id = self.overdue(now, request)?;
        let job = self.jobs.get_mut(&id.job)?;
        let problem = job.row.asked.problem;
        let stage = job.stages.get_mut(&id.stage)?;
        let charged = estimate(stage.chunks.get(&id.first)?.row.items.len(), &stage.row);
        stage.row.speculative_leases += 1;
        let definition = stage.row.definition;
        let chunk = stage.chunks.get_mut(&id.first)?;
        let until = now.after_ms(request.duration_ms);
        let leased = ChunkState::Leased {
            worker: request.worker.clone(),
            until,
        };
        // Both are leased: the counts stay.
        let before = std::mem::replace(&mut chunk.row.state, leased);
        let ChunkState::Leased { worker, until: end } = before else {
            return None;
        };
        let elder = Elder {
            epoch: chunk.row.epoch,
            worker: worker.clone(),
            leased_at: chunk.leased_at.replace(now)?,
            until: Some(end),
        };
        chunk.row.epoch.0 += 1;
        chunk.request = Some(request.request.clone());
        chunk.charged += charged;
        let lease = Lease {
            speculative: true,
            ..chunk.row.lease(until, problem, definition)
        };
        self.charge(id.job, charged);
        self.elders.insert(id, elder);
        if let Some(held) = self.leases.get_mut(&worker) {
            held.remove(&id);
        }
        let held = self.leases.entry(request.worker.clone()).or_default();
        held.insert(id);
        Some(lease)
    }
}

impl super::tables::Job {
    /// Items and time of the accepted chunks of all stages of the job.
    fn pace(&self) -> Pace {
        let stages = self.stages.values().map(|stage| stage.row.pace());
        stages.fold(Pace::default(), |sum, stage| Pace {
            items: sum.items + stage.items,
            held_ms: sum.held_ms + stage.held_ms,
        })
    }
}
