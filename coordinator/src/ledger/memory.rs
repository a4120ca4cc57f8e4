//! The ledger in memory: what the others are compared with, and the simulation's ledger.
//!
//! Deterministic but for the secret of its audits: the same calls at the same times give the same answers.

mod accusations;
mod audit;
mod speculation;
mod tables;

use self::tables::{Job, Stage, Tables, Worker};
use super::clock::{Clock, LedgerTime};
use super::identity::*;
use super::rows::*;
use super::rules::{HEARD_MS, check_size, first_virtual_time, make_up};
use super::{Ledger, LedgerError};
use crate::chunks::audit::AuditKey;
use async_trait::async_trait;
use cognate_continuation::work::StageId;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard};

/// A ledger that lives as long as its process.
pub struct MemoryLedger {
    clock: Arc<dyn Clock>,
    audit_key: AuditKey,
    tables: Mutex<Tables>,
}

impl MemoryLedger {
    /// An empty ledger, with a secret of its own for its audits.
    pub fn new(clock: Arc<dyn Clock>) -> Self {
        Self::with_audit_key(clock, AuditKey::from_text(&AuditKey::new_text()))
    }

    /// An empty ledger, with this secret for its audits.
    pub fn with_audit_key(clock: Arc<dyn Clock>, audit_key: AuditKey) -> Self {
        Self {
            clock,
            audit_key,
            tables: Mutex::default(),
        }
    }

    fn tables(&self) -> MutexGuard<'_, Tables> {
        self.tables
            .lock()
            .expect("no call panics while it holds the tables")
    }
}

#[async_trait]
impl Ledger for MemoryLedger {
    async fn now(&self) -> Result<LedgerTime, LedgerError> {
        Ok(self.clock.now())
    }

    async fn submit(&self, id: RequestId, asked: NewJob) -> Result<Submitted, LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        let job = JobId::of_request(&id);
        if let Some(before) = tables.jobs.get(&job) {
            if before.row.asked != asked || tables.requests.get(&id) != Some(&job) {
                return Err(LedgerError::RequestReused(id));
            }
            return Ok(Submitted { job, is_new: false });
        }
        if tables.deleted.contains(&job) {
            return Err(LedgerError::RequestOfDeleted(id));
        }
        // Nobody saves up virtual time while he has no jobs.
        let active = |tables: &Tables| -> Vec<(Tenant, i64)> {
            let unfinished = tables.jobs.values().filter(|j| !j.row.state.has_ended());
            unfinished
                .map(|j| (j.row.asked.tenant.clone(), j.virtual_time))
                .collect()
        };
        let active = active(&tables);
        let floor = active
            .iter()
            .filter_map(|(t, _)| tables.tenants.get(t))
            .min();
        let previous_time = tables.tenants.get(&asked.tenant).copied().unwrap_or(0);
        let tenant_time = floor.map_or(previous_time, |&floor| previous_time.max(floor));
        tables.tenants.insert(asked.tenant.clone(), tenant_time);
        let same_tenant = active.iter().filter(|(t, _)| *t == asked.tenant);
        let least = same_tenant.map(|&(_, v)| v).min();
        let same_tenant = tables.jobs.values().filter(|j| {
            let row = &j.row;
            row.asked.tenant == asked.tenant && !row.state.has_ended() && row.started.is_none()
        });
        let waiting = same_tenant.map(|j| j.virtual_time).max();
        let virtual_time = first_virtual_time(least, waiting);
        let latest = tables.jobs.values().map(|job| job.row.number).max();
        let number = latest.unwrap_or(0) + 1;
        let row = JobRow {
            job,
            number,
            asked,
            state: JobState::Queued,
            reason: None,
            submitted: now,
            started: None,
            ended: None,
            steward: None,
            steward_epoch: Epoch(0),
            steward_until: LedgerTime(0),
            snapshot: None,
            solutions: None,
            summary: None,
        };
        tables.requests.insert(id, job);
        tables.jobs.insert(
            job,
            Job {
                row,
                virtual_time,
                stages: BTreeMap::new(),
            },
        );
        Ok(Submitted { job, is_new: true })
    }

    async fn cancel(&self, job: JobId, reason: &str) -> Result<Cancelled, LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        let row = &mut tables.job(job)?.row;
        if row.state.has_ended() {
            return Ok(Cancelled::HadEnded(row.state));
        }
        row.state = JobState::Cancelled;
        row.reason = Some(reason.to_owned());
        row.ended = Some(now);
        tables.release_all(job);
        Ok(Cancelled::Now)
    }

    async fn delete(&self, job: JobId) -> Result<Deleted, LedgerError> {
        let mut tables = self.tables();
        let Some(job_entry) = tables.jobs.get(&job) else {
            return match tables.deleted.contains(&job) {
                true => Ok(Deleted::Before),
                false => Err(LedgerError::UnknownJob(job)),
            };
        };
        if !job_entry.row.state.has_ended() {
            return Ok(Deleted::GoesOn(job_entry.row.state));
        }
        let stages = job_entry.stages.len() as u64;
        let chunks = job_entry
            .stages
            .values()
            .map(|s| s.chunks.len() as u64)
            .sum();
        tables.jobs.remove(&job);
        tables.requests.retain(|_, made| *made != job);
        tables.elders.retain(|chunk, _| chunk.job != job);
        tables.deleted.insert(job);
        Ok(Deleted::Now { stages, chunks })
    }

    async fn is_deleted(&self, job: JobId) -> Result<bool, LedgerError> {
        Ok(self.tables().deleted.contains(&job))
    }

    async fn identity(&self) -> Result<Option<String>, LedgerError> {
        Ok(None)
    }

    async fn audit_key(&self) -> Result<AuditKey, LedgerError> {
        Ok(self.audit_key)
    }

    async fn job(&self, job: JobId) -> Result<Option<JobRow>, LedgerError> {
        Ok(self.tables().jobs.get(&job).map(|j| j.row.clone()))
    }

    async fn jobs(&self, limit: u32) -> Result<Vec<JobRow>, LedgerError> {
        let overviews = self.overviews(limit).await?.into_iter();
        Ok(overviews.map(|(row, _)| row).collect())
    }

    async fn stages(&self, job: JobId) -> Result<Vec<StageRow>, LedgerError> {
        let mut tables = self.tables();
        let stages = &tables.job(job)?.stages;
        Ok(stages.values().map(|stage| stage.row.clone()).collect())
    }

    async fn overviews(&self, limit: u32) -> Result<Vec<(JobRow, Vec<StageRow>)>, LedgerError> {
        let tables = self.tables();
        let mut jobs: Vec<_> = tables.jobs.values().collect();
        jobs.sort_by_key(|job| job.row.number);
        let latest = jobs.len().saturating_sub(limit as usize);
        let overview = |job: &Job| {
            let stages = job.stages.values();
            (
                job.row.clone(),
                stages.map(|stage| stage.row.clone()).collect(),
            )
        };
        Ok(jobs[latest..].iter().map(|job| overview(job)).collect())
    }

    async fn steward(
        &self,
        job: JobId,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<Option<Epoch>, LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        let row = &mut tables.job(job)?.row;
        let held = row.steward_until > now;
        let mine = row.steward.as_ref() == Some(who);
        if row.state.has_ended() || (held && !mine) {
            return Ok(None);
        }
        if !held || !mine {
            row.steward_epoch.0 += 1;
            row.steward = Some(who.clone());
        }
        row.steward_until = now.after_ms(duration_ms);
        Ok(Some(row.steward_epoch))
    }

    async fn renew_stewardships(
        &self,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<(), LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        let rows = tables.jobs.values_mut().map(|job| &mut job.row);
        for row in rows.filter(|row| row.steward.as_ref() == Some(who)) {
            if !row.state.has_ended() && row.steward_until > now {
                row.steward_until = now.after_ms(duration_ms);
            }
        }
        Ok(())
    }

    async fn attention(
        &self,
        who: &CoordinatorId,
        suspicions: u32,
    ) -> Result<Vec<JobId>, LedgerError> {
        let now = self.clock.now();
        let tables = self.tables();
        let stirs = |job: &Job| {
            let mut open = job.stages.values().filter(|stage| !stage.row.closed);
            let suspected = |stage: &Stage| {
                let mut ready = stage
                    .ready
                    .iter()
                    .filter_map(|first| stage.chunks.get(first));
                ready.any(|chunk| chunk.row.suspicions >= suspicions)
            };
            job.stages.values().all(|stage| stage.row.closed)
                || open.any(|stage| stage.row.is_complete())
                || job.stages.values().any(suspected)
        };
        let mut jobs_to_drive: Vec<(u64, JobId)> = tables
            .jobs
            .values()
            .filter(|job| !job.row.state.has_ended())
            .filter(|job| {
                let is_free = job.row.steward.is_none() || job.row.steward_until <= now;
                is_free || (job.row.steward.as_ref() == Some(who) && stirs(job))
            })
            .map(|job| (job.row.number, job.row.job))
            .collect();
        jobs_to_drive.sort_unstable();
        Ok(jobs_to_drive.into_iter().map(|(_, job)| job).collect())
    }

    async fn unfinished_jobs(&self) -> Result<Vec<JobId>, LedgerError> {
        let tables = self.tables();
        let mut rows: Vec<(u64, JobId)> = tables
            .jobs
            .values()
            .filter(|j| !j.row.state.has_ended())
            .map(|j| (j.row.number, j.row.job))
            .collect();
        rows.sort_unstable();
        Ok(rows.into_iter().map(|(_, job)| job).collect())
    }

    async fn advance(&self, job: JobId, epoch: Epoch, step: Advance) -> Result<(), LedgerError> {
        let mut tables = self.tables();
        let driven_job = tables.fenced(job, epoch)?;
        for &id in &step.close {
            let stage = driven_job.stages.get(&id);
            if !stage.is_some_and(|s| !s.row.closed && s.row.is_complete()) {
                return Err(LedgerError::StageOrder(job, id));
            }
        }
        let mut opened = BTreeSet::new();
        for new in &step.open {
            check_size("the number of items of a stage", new.items)?;
            let whole = ItemRange {
                first: 0,
                last: new.items,
            };
            let is_repeated =
                driven_job.stages.contains_key(&new.stage) || !opened.insert(new.stage);
            if is_repeated || !make_up(new.chunks.iter().copied(), whole) {
                return Err(LedgerError::StageOrder(job, new.stage));
            }
        }
        for id in &step.close {
            if let Some(stage) = driven_job.stages.get_mut(id) {
                stage.row.closed = true;
            }
        }
        for new in step.open {
            let mut stage = Stage {
                row: StageRow {
                    stage: new.stage,
                    definition: new.definition,
                    items: new.items,
                    closed: false,
                    ready: Count::default(),
                    leased: Count::default(),
                    accepted: Count::default(),
                    failed: Count::default(),
                    cpu_micros: 0,
                    outcomes: Outcomes::default(),
                    held_ms: 0,
                    speculative_leases: 0,
                    speculative_won: 0,
                },
                chunks: BTreeMap::new(),
                ready: BTreeSet::new(),
            };
            for items in new.chunks {
                stage.insert(ChunkRow {
                    chunk: ChunkId {
                        job,
                        stage: new.stage,
                        first: items.first,
                    },
                    items,
                    state: ChunkState::Ready,
                    epoch: Epoch(0),
                    suspicions: 0,
                    alone: false,
                });
            }
            driven_job.stages.insert(new.stage, stage);
            driven_job.row.state = JobState::Running;
        }
        if step.snapshot.is_some() {
            driven_job.row.snapshot = step.snapshot;
        }
        Ok(())
    }

    async fn split(
        &self,
        chunk: ChunkId,
        epoch: Epoch,
        pieces: &[Piece],
    ) -> Result<(), LedgerError> {
        let mut tables = self.tables();
        let job = tables.fenced(chunk.job, epoch)?;
        let refused = || LedgerError::NotAPartition(chunk.job);
        let stage = job.stages.get_mut(&chunk.stage).ok_or_else(refused)?;
        let whole = stage.chunks.get(&chunk.first).map(|c| c.row.clone());
        let whole = whole
            .filter(|whole| whole.state == ChunkState::Ready)
            .filter(|whole| make_up(pieces.iter().map(|p| p.items), whole.items))
            .ok_or_else(refused)?;
        stage.discount(chunk.first);
        stage.chunks.remove(&chunk.first);
        for piece in pieces {
            let mut row = whole.clone();
            row.chunk.first = piece.items.first;
            row.items = piece.items;
            row.suspicions = piece.suspicions;
            row.alone = piece.alone;
            stage.insert(row);
        }
        tables.elders.remove(&chunk);
        Ok(())
    }

    async fn fail_item(
        &self,
        chunk: ChunkId,
        epoch: Epoch,
        result: ResultObject,
    ) -> Result<(), LedgerError> {
        let mut tables = self.tables();
        tables.fenced(chunk.job, epoch)?;
        check_size("the CPU time of a chunk", result.cpu_micros)?;
        tables
            .chunk(chunk)
            .filter(|c| c.row.state == ChunkState::Ready && c.row.items == result.items)
            .ok_or(LedgerError::NotAPartition(chunk.job))?;
        tables.change(chunk, ChunkState::Failed { result });
        tables.elders.remove(&chunk);
        Ok(())
    }

    async fn reopen(&self, chunk: ChunkId, epoch: Epoch) -> Result<(), LedgerError> {
        let mut tables = self.tables();
        let job = tables.fenced(chunk.job, epoch)?;
        let Some(stage) = job.stages.get_mut(&chunk.stage) else {
            return Ok(());
        };
        if stage.row.closed {
            return Err(LedgerError::StageOrder(chunk.job, chunk.stage));
        }
        stage.reopen(chunk.first);
        tables.elders.remove(&chunk);
        Ok(())
    }

    async fn standing(&self, lease: LeaseId) -> Result<Standing, LedgerError> {
        let mut tables = self.tables();
        let Some(holder) = tables.holder(lease) else {
            let chunk = tables.chunk(lease.chunk);
            return Ok(
                match chunk.is_some_and(|chunk| chunk.row.epoch >= lease.epoch) {
                    true => Standing::Ended,
                    false => Standing::Never,
                },
            );
        };
        let chunk = tables.chunk(lease.chunk).filter(|_| !holder.is_elder);
        Ok(Standing::Held {
            worker: holder.worker,
            request: chunk.and_then(|chunk| chunk.request.clone()),
        })
    }

    async fn finish(&self, job: JobId, epoch: Epoch, end: JobEnd) -> Result<(), LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        let row = &mut tables.fenced(job, epoch)?.row;
        row.ended = Some(now);
        match end {
            JobEnd::Solved { solutions, summary } => {
                row.state = JobState::Solved;
                row.solutions = Some(solutions);
                row.summary = Some(summary);
            }
            JobEnd::Failed { reason } => {
                row.state = JobState::Failed;
                row.reason = Some(reason);
            }
        }
        tables.release_all(job);
        Ok(())
    }

    async fn finished_chunks(
        &self,
        job: JobId,
        stage: StageId,
        from: u64,
        limit: u32,
    ) -> Result<Vec<ChunkRow>, LedgerError> {
        let mut tables = self.tables();
        let chunks = tables.job(job)?.stages.get(&stage).map(|s| &s.chunks);
        let rows = chunks.into_iter().flat_map(|c| c.range(from..));
        Ok(rows
            .map(|(_, chunk)| &chunk.row)
            .filter(|row| {
                matches!(
                    row.state,
                    ChunkState::Accepted { .. } | ChunkState::Failed { .. }
                )
            })
            .take(limit as usize)
            .cloned()
            .collect())
    }

    async fn suspects(
        &self,
        job: JobId,
        suspicions: u32,
        until: LedgerTime,
    ) -> Result<Vec<ChunkRow>, LedgerError> {
        let mut tables = self.tables();
        let stages = tables.job(job)?.stages.values();
        let ready = stages.flat_map(|s| s.ready.iter().filter_map(|first| s.chunks.get(first)));
        Ok(ready
            .filter(|chunk| chunk.silent_since.is_none_or(|since| since <= until))
            .map(|chunk| &chunk.row)
            .filter(|row| row.suspicions >= suspicions)
            .cloned()
            .collect())
    }

    async fn contributions(&self, job: JobId) -> Result<Vec<Contribution>, LedgerError> {
        let mut tables = self.tables();
        let mut sums: BTreeMap<WorkerId, (u64, u64)> = BTreeMap::new();
        for stage in tables.job(job)?.stages.values() {
            for chunk in stage.chunks.values() {
                if let ChunkState::Accepted { worker, result } = &chunk.row.state {
                    let sum = sums.entry(worker.clone()).or_default();
                    sum.0 += result.items.len();
                    sum.1 += result.cpu_micros;
                }
            }
        }
        let transport = |worker: &WorkerId| {
            let record = tables.workers.get(worker);
            record.map_or_else(String::new, |w| w.says.transport.clone())
        };
        Ok(sums
            .into_iter()
            .map(|(worker, (items, cpu_micros))| Contribution {
                transport: transport(&worker),
                worker,
                items,
                cpu_micros,
            })
            .collect())
    }

    async fn lease(&self, request: LeaseRequest) -> Result<Vec<Lease>, LedgerError> {
        let now = self.clock.now();
        let until = now.after_ms(request.duration_ms);
        let mut tables = self.tables();
        tables.acquit(request.request.session());
        let mut repeated_leases = Vec::new();
        let mut holds_alone = false;
        let held = tables.held(&request.worker);
        let is_idle = held.is_empty();
        for id in held {
            let job = &tables.jobs[&id.job];
            let (problem, definition) =
                (job.row.asked.problem, job.stages[&id.stage].row.definition);
            let Some(chunk) = tables.chunk(id) else {
                continue;
            };
            holds_alone |= chunk.row.alone;
            if chunk.request.as_ref() != Some(&request.request) {
                continue;
            }
            chunk.row.state = ChunkState::Leased {
                worker: request.worker.clone(),
                until,
            };
            repeated_leases.push(chunk.row.lease(until, problem, definition));
        }
        if !repeated_leases.is_empty() || holds_alone {
            return Ok(repeated_leases);
        }
        let mut leases = Vec::new();
        while leases.len() < request.slots as usize {
            let Some(lease) = tables.lease_one(now, &request) else {
                break;
            };
            let alone = lease.alone;
            leases.push(lease);
            if alone {
                break;
            }
        }
        if leases.is_empty() && is_idle && request.slots > 0 {
            leases.extend(tables.speculate(now, &request));
        }
        if leases.is_empty() && request.slots > 0 && tables.is_evicted(&request.worker) {
            return Err(LedgerError::Evicted(request.worker));
        }
        Ok(leases)
    }

    async fn renew(
        &self,
        leases: &[LeaseId],
        duration_ms: u64,
    ) -> Result<Vec<Renewal>, LedgerError> {
        let end = self.clock.now().after_ms(duration_ms);
        let mut tables = self.tables();
        let renewals = leases.iter().map(|lease| {
            if let Some(elder) = tables.elder(*lease) {
                elder.until = Some(end);
                return Renewal::Until(end);
            }
            let chunk = tables.chunk(lease.chunk);
            match chunk.filter(|c| c.row.epoch == lease.epoch) {
                Some(chunk) => match &mut chunk.row.state {
                    ChunkState::Leased { until, .. } => {
                        *until = end;
                        Renewal::Until(end)
                    }
                    _ => Renewal::Lost,
                },
                None => Renewal::Lost,
            }
        });
        Ok(renewals.collect())
    }

    async fn complete(
        &self,
        lease: LeaseId,
        result: ResultObject,
    ) -> Result<Completion, LedgerError> {
        check_size("the CPU time of a chunk", result.cpu_micros)?;
        let now = self.clock.now();
        let mut tables = self.tables();
        let Some(chunk) = tables.chunk(lease.chunk).map(|chunk| chunk.row.clone()) else {
            return Ok(Completion::Stale);
        };
        if chunk.items != result.items {
            return Ok(Completion::Stale);
        }
        if let ChunkState::Accepted { result: first, .. } = &chunk.state {
            return Ok(if first.hash != result.hash {
                Completion::HashDiffers
            } else if !tables.was_leased(lease, chunk.epoch) {
                Completion::Stale
            } else if first.address == result.address {
                Completion::AlreadyAccepted
            } else {
                Completion::Overtaken
            });
        }
        let Some(holder) = tables.holder(lease) else {
            return Ok(Completion::Stale);
        };
        tables.accept(now, lease.chunk, holder, result);
        Ok(Completion::Accepted)
    }

    async fn confirm(
        &self,
        lease: LeaseId,
        result: ResultObject,
        why: Confirmation,
    ) -> Result<Completion, LedgerError> {
        check_size("the CPU time of a chunk", result.cpu_micros)?;
        let now = self.clock.now();
        let vote = self.tables().confirm(now, lease, &result, why);
        match vote {
            Some(completion) => Ok(completion),
            None => self.complete(lease, result).await,
        }
    }

    async fn disputes(&self) -> Result<Vec<Dispute>, LedgerError> {
        Ok(self.tables().disputes())
    }

    async fn strike(&self, vote: LeaseId, why: Strike) -> Result<(), LedgerError> {
        let now = self.clock.now();
        self.tables().strike(now, vote, why);
        Ok(())
    }

    async fn evict(&self, worker: &WorkerId) -> Result<(), LedgerError> {
        let now = self.clock.now();
        self.tables().evict(now, worker);
        Ok(())
    }

    async fn give_back(&self, lease: LeaseId, why: GiveBack) -> Result<(), LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        let Some(holder) = tables.holder(lease) else {
            return Ok(());
        };
        if let GiveBack::Failed { .. } = why {
            tables.accuse(now, lease.chunk, &holder.worker);
        }
        if holder.is_elder {
            tables.elders.remove(&lease.chunk);
        } else {
            tables.unlease(lease.chunk, ChunkState::Ready);
        }
        Ok(())
    }

    async fn expire(&self) -> Result<Vec<Expired>, LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        let mut held: Vec<ChunkId> = tables.leases.values().flatten().copied().collect();
        held.sort_unstable();
        let mut expired = Vec::new();
        for id in held {
            let Some(chunk) = tables.chunk(id) else {
                continue;
            };
            let (ended, holder) = match &chunk.row.state {
                ChunkState::Leased { until, worker } if *until <= now => (*until, worker.clone()),
                _ => continue,
            };
            tables.accuse(now, id, &holder);
            let Some(chunk) = tables.chunk(id) else {
                continue;
            };
            let (epoch, suspicions) = (chunk.row.epoch, chunk.row.suspicions);
            let request = chunk.request.clone();
            if let Some(worker) = tables.unlease(id, ChunkState::Ready) {
                if let Some(chunk) = tables.chunk(id) {
                    (chunk.request, chunk.silent_since) = (request, Some(ended));
                }
                expired.push(Expired {
                    lease: LeaseId { chunk: id, epoch },
                    worker,
                    suspicions,
                });
            }
        }
        expired.extend(tables.expire_elders(now));
        Ok(expired)
    }

    async fn seen(&self, says: WorkerSeen) -> Result<(), LedgerError> {
        let now = self.clock.now();
        let mut tables = self.tables();
        if let Some(namesake) = tables.workers.get(&says.worker)
            && namesake.says.credential != Credential::default()
            && namesake.says.credential != says.credential
            && now.since_ms(namesake.last_seen) < HEARD_MS
        {
            return Err(LedgerError::NameTaken(says.worker));
        }
        let worker = tables
            .workers
            .entry(says.worker.clone())
            .or_insert_with(|| Worker {
                says: says.clone(),
                first_seen: now,
                last_seen: now,
                items_done: 0,
                chunks_done: 0,
                evicted: false,
            });
        worker.says = says;
        worker.last_seen = now;
        Ok(())
    }

    async fn workers(&self, limit: u32) -> Result<Vec<WorkerRow>, LedgerError> {
        let tables = self.tables();
        let mut rows: Vec<WorkerRow> = tables
            .workers
            .values()
            .map(|w| WorkerRow {
                says: w.says.clone(),
                first_seen: w.first_seen,
                last_seen: w.last_seen,
                items_done: w.items_done,
                chunks_done: w.chunks_done,
                leased_chunks: tables.held(&w.says.worker).len() as u64,
                evicted: w.evicted,
            })
            .collect();
        rows.sort_by(|a, b| {
            let key = |row: &WorkerRow| (row.last_seen, row.says.worker.clone());
            key(b).cmp(&key(a))
        });
        rows.truncate(limit as usize);
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::MemoryLedger;
    use crate::ledger::conformance::ledger_conformance;

    async fn open(clock: std::sync::Arc<crate::ledger::clock::ManualClock>) -> (MemoryLedger, ()) {
        (MemoryLedger::new(clock), ())
    }

    ledger_conformance!(memory, open);
}
