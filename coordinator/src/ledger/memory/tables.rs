//! Tables of the ledger in memory, and the operations from which its calls are composed.

use crate::chunks::sizing::Situation;
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::*;
use crate::ledger::rows::*;
use crate::ledger::rules::{PRESENT_MS, estimate};
use cognate_continuation::work::StageId;
use std::collections::{BTreeMap, BTreeSet};

#[derive(Default)]
pub struct Tables {
    pub requests: BTreeMap<RequestId, JobId>,
    pub jobs: BTreeMap<JobId, Job>,
    pub deleted: BTreeSet<JobId>,
    /// Virtual time of each tenant: microseconds of CPU that were used or are in use.
    pub tenants: BTreeMap<Tenant, i64>,
    pub workers: BTreeMap<WorkerId, Worker>,
    pub leases: BTreeMap<WorkerId, BTreeSet<ChunkId>>,
    /// Lease before the last of each chunk that was given to a second worker.
    pub elders: BTreeMap<ChunkId, Elder>,
}

pub struct Job {
    pub row: JobRow,
    pub virtual_time: i64,
    pub stages: BTreeMap<StageId, Stage>,
}

pub struct Stage {
    /// The row, with the counts of the chunks.
    pub row: StageRow,
    pub chunks: BTreeMap<u64, Chunk>,
    /// First items of the chunks that are ready.
    pub ready: BTreeSet<u64>,
}

pub struct Chunk {
    pub row: ChunkRow,
    /// Request for which the chunk was leased; for a ready chunk, the request of the worker that fell silent with it.
    pub request: Option<RequestId>,
    /// Time at which the lease ended without a renewal.
    pub silent_since: Option<LedgerTime>,
    /// Time at which the last lease began.
    pub leased_at: Option<LedgerTime>,
    pub charged: i64,
    /// Workers that died of the chunk or could not do it.
    pub accusers: BTreeSet<WorkerId>,
    /// Results of the executions of an audited chunk.
    pub votes: Vec<Vote>,
}

pub struct Worker {
    pub says: WorkerSeen,
    pub first_seen: LedgerTime,
    pub last_seen: LedgerTime,
    pub items_done: u64,
    pub chunks_done: u64,
    pub evicted: bool,
}

impl Stage {
    /// Takes a chunk into the counts.
    pub fn count(&mut self, first: u64) {
        let Some(chunk) = self.chunks.get(&first).map(|c| &c.row) else {
            return;
        };
        if chunk.state == ChunkState::Ready {
            self.ready.insert(first);
        }
        let (count, result) = of_state(&mut self.row, &chunk.state);
        count.items += chunk.items.len();
        count.chunks += 1;
        if let Some(outcomes) = result {
            self.row.outcomes.add(outcomes);
        }
    }

    /// Takes a chunk that has no result out of the counts, before it changes.
    pub fn discount(&mut self, first: u64) {
        let Some(chunk) = self.chunks.get(&first).map(|c| &c.row) else {
            return;
        };
        self.ready.remove(&first);
        let (count, _) = of_state(&mut self.row, &chunk.state);
        count.items -= chunk.items.len();
        count.chunks -= 1;
    }

    /// Puts a new chunk in.
    pub fn insert(&mut self, row: ChunkRow) {
        let first = row.items.first;
        let chunk = Chunk {
            row,
            request: None,
            silent_since: None,
            leased_at: None,
            charged: 0,
            accusers: BTreeSet::new(),
            votes: Vec::new(),
        };
        self.chunks.insert(first, chunk);
        self.count(first);
    }
}

/// The count that a chunk of this state belongs to, and its outcomes where it has a result.
fn of_state<'a>(row: &'a mut StageRow, state: &ChunkState) -> (&'a mut Count, Option<Outcomes>) {
    match state {
        ChunkState::Ready => (&mut row.ready, None),
        ChunkState::Leased { .. } => (&mut row.leased, None),
        ChunkState::Accepted { result, .. } => (&mut row.accepted, Some(result.outcomes)),
        ChunkState::Failed { result } => (&mut row.failed, Some(result.outcomes)),
    }
}

impl Job {
    pub fn leased_chunks(&self) -> u64 {
        self.stages.values().map(|s| s.row.leased.chunks).sum()
    }
}

impl Tables {
    pub fn job(&mut self, job: JobId) -> Result<&mut Job, LedgerError> {
        self.jobs.get_mut(&job).ok_or(LedgerError::UnknownJob(job))
    }

    pub fn fenced(&mut self, job: JobId, epoch: Epoch) -> Result<&mut Job, LedgerError> {
        let driven_job = self.job(job)?;
        if driven_job.row.steward_epoch != epoch || driven_job.row.state.has_ended() {
            return Err(LedgerError::Fenced(job));
        }
        Ok(driven_job)
    }

    pub fn stage(&mut self, id: ChunkId) -> Option<&mut Stage> {
        self.jobs.get_mut(&id.job)?.stages.get_mut(&id.stage)
    }

    /// A chunk whose state and items stay as they are.
    pub fn chunk(&mut self, id: ChunkId) -> Option<&mut Chunk> {
        self.stage(id)?.chunks.get_mut(&id.first)
    }

    /// Puts a chunk into another state; the one that it had.
    pub fn change(&mut self, id: ChunkId, state: ChunkState) -> Option<ChunkState> {
        let stage = self.stage(id)?;
        stage.discount(id.first);
        let chunk = stage.chunks.get_mut(&id.first)?;
        let before = std::mem::replace(&mut chunk.row.state, state);
        stage.count(id.first);
        Some(before)
    }

    /// Adds to the virtual time of a job and its tenant.
    pub fn charge(&mut self, job: JobId, micros: i64) {
        if let Some(job) = self.jobs.get_mut(&job) {
            job.virtual_time += micros;
            *self
                .tenants
                .entry(job.row.asked.tenant.clone())
                .or_default() += micros;
        }
    }

    /// Takes a leased chunk from its worker and puts it into another state.
    pub fn unlease(&mut self, id: ChunkId, state: ChunkState) -> Option<WorkerId> {
        let ChunkState::Leased { worker, .. } = self.change(id, state)? else {
            return None;
        };
        let chunk = self.chunk(id)?;
        chunk.request = None;
        chunk.silent_since = None;
        let charged = std::mem::take(&mut chunk.charged);
        self.charge(id.job, -charged);
        if let Some(held) = self.leases.get_mut(&worker) {
            held.remove(&id);
        }
        Some(worker)
    }

    /// Takes a worker's result for a chunk that it has.
    pub fn accept(&mut self, now: LedgerTime, id: ChunkId, holder: Holder, result: ResultObject) {
        let (items, micros) = (result.items.len(), result.cpu_micros);
        let held_ms = holder.held_ms(now);
        let Holder {
            worker, is_elder, ..
        } = holder;
        let accepted = ChunkState::Accepted {
            worker: worker.clone(),
            result,
        };
        self.unlease(id, accepted);
        if let Some(chunk) = self.chunk(id) {
            // Where the elder reports, the chunk may have been ready after a silent worker.
            (chunk.request, chunk.silent_since) = (None, None);
            if chunk.row.suspicions != 0 {
                chunk.accusers.clear();
            }
        }
        self.charge(id.job, micros as i64);
        let elder = self.elders.get_mut(&id);
        let has_elder = elder.is_some_and(|elder| elder.until.take().is_some());
        if let Some(stage) = self.stage(id) {
            stage.row.cpu_micros += micros;
            stage.row.held_ms += held_ms;
            stage.row.speculative_won += u64::from(has_elder && !is_elder);
        }
        if let Some(worker) = self.workers.get_mut(&worker) {
            worker.items_done += items;
            worker.chunks_done += 1;
        }
    }

    pub fn release_all(&mut self, job: JobId) {
        let held: Vec<ChunkId> = self.leases.values().flatten().copied().collect();
        for id in held.into_iter().filter(|id| id.job == job) {
            self.unlease(id, ChunkState::Ready);
        }
        self.drop_elders(|id, _| id.job == job);
    }

    pub fn present_threads(&self, now: LedgerTime, request: &LeaseRequest) -> u64 {
        let others = self.workers.values().filter(|w| {
            w.says.worker != request.worker
                && !w.says.draining
                && !w.evicted
                && now.since_ms(w.last_seen) < PRESENT_MS
        });
        others.map(|w| u64::from(w.says.threads)).sum::<u64>() + u64::from(request.threads)
    }

    /// The chunk whose turn it is: the tenant's, then the job's least virtual time.
    pub fn choose(&self, now: LedgerTime, request: &LeaseRequest) -> Option<ChunkId> {
        if self.is_evicted(&request.worker) {
            return None;
        }
        let turn = |job: &Job| {
            let tenant = self.tenants.get(&job.row.asked.tenant).copied();
            (tenant.unwrap_or(0), job.virtual_time, job.row.number)
        };
        let mut candidates: Vec<&Job> = self
            .jobs
            .values()
            .filter(|job| {
                job.row.state == JobState::Running
                    && job.row.asked.numerics_revision == request.numerics_revision
                    && job.leased_chunks() < u64::from(request.in_flight_limit)
                    && !request.without.contains(&job.row.job)
            })
            .collect();
        candidates.sort_by_key(|job| turn(job));
        candidates
            .iter()
            .flat_map(|job| job.stages.values())
            .flat_map(|stage| {
                stage
                    .ready
                    .iter()
                    .filter_map(|first| stage.chunks.get(first))
            })
            .filter(|chunk| self.may_vote(now, chunk, request))
            .find(|chunk| {
                chunk.row.suspicions < request.suspicion_limit && self.may_try(now, chunk, request)
            })
            .map(|chunk| chunk.row.chunk)
    }

    pub fn lease_one(&mut self, now: LedgerTime, request: &LeaseRequest) -> Option<Lease> {
        let id = self.choose(now, request)?;
        let all_threads = self.present_threads(now, request);
        let running = |job: &&Job| job.row.state == JobState::Running;
        let jobs = self.jobs.values().filter(running).count() as u64;
        let job = self.jobs.get_mut(&id.job)?;
        let stage = job.stages.get_mut(&id.stage)?;
        let counts = stage.row.clone();
        let wanted = request.sizing.items(&Situation {
            ready_items: counts.ready.items,
            done_items: counts.accepted.items,
            done_micros: counts.cpu_micros,
            threads: u64::from(request.threads),
            all_threads,
            jobs,
        });
        stage.discount(id.first);
        let chunk = stage.chunks.get_mut(&id.first)?;
        let rest = ItemRange {
            first: id.first.saturating_add(wanted),
            last: chunk.row.items.last,
        };
        // Votes and suspicions are about the whole chunk, so it is not cut.
        let is_whole = !chunk.votes.is_empty() || chunk.row.suspicions != 0;
        let cut = (!rest.is_empty() && !is_whole).then(|| {
            let mut row = chunk.row.clone();
            row.chunk.first = rest.first;
            row.items = rest;
            row
        });
        if cut.is_some() {
            chunk.row.items.last = rest.first;
        }
        let charged = estimate(chunk.row.items.len(), &counts);
        let until = now.after_ms(request.duration_ms);
        chunk.row.epoch.0 += 1;
        chunk.row.state = ChunkState::Leased {
            worker: request.worker.clone(),
            until,
        };
        chunk.request = Some(request.request.clone());
        chunk.silent_since = None;
        chunk.leased_at = Some(now);
        chunk.charged = charged;
        let chunk = chunk.row.clone();
        stage.count(id.first);
        if let Some(row) = cut {
            stage.insert(row);
        }
        job.row.started.get_or_insert(now);
        let lease = chunk.lease(until, job.row.asked.problem, counts.definition);
        self.charge(id.job, charged);
        self.leases
            .entry(request.worker.clone())
            .or_default()
            .insert(id);
        Some(lease)
    }

    /// Takes the suspicions back that rest on the silence of a session that speaks.
    pub fn acquit(&mut self, session: &str) {
        for stage in self.jobs.values_mut().flat_map(|j| j.stages.values_mut()) {
            for first in &stage.ready {
                let Some(chunk) = stage.chunks.get_mut(first) else {
                    continue;
                };
                let same = |lost: &RequestId| lost.as_str().starts_with(session);
                if chunk.request.as_ref().is_some_and(same) {
                    chunk.request = None;
                    chunk.silent_since = None;
                    chunk.row.suspicions = chunk.row.suspicions.saturating_sub(1);
                }
            }
        }
    }

    pub fn held(&self, worker: &WorkerId) -> Vec<ChunkId> {
        let held = self.leases.get(worker);
        held.map_or_else(Vec::new, |set| set.iter().copied().collect())
    }
}
