//! A ledger that fails at one chosen write, or at writes by chance: before it is done, or after it,
//! so that the answer is lost. What a coordinator that is killed there leaves behind.

use super::clock::LedgerTime;
use super::identity::*;
use super::rows::*;
use super::{Ledger, LedgerError};
use crate::chunks::audit::AuditKey;
use crate::coordinator::simulation::Dice;
use async_trait::async_trait;
use cognate_continuation::work::StageId;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// On which side of the write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The write is not done.
    Before,
    /// The write is done, and nobody hears of it.
    After,
}

/// Fails at the write of one number, and once only, or at some writes of many.
pub struct FaultyLedger {
    inner: Arc<dyn Ledger>,
    writes: AtomicU64,
    when: When,
}

enum When {
    Once { fail_at: u64, side: Side },
    Often { dice: Mutex<Dice>, one_in: u64 },
}

impl FaultyLedger {
    /// Counts from 0.
    pub fn new(inner: Arc<dyn Ledger>, fail_at: u64, side: Side) -> Self {
        Self {
            inner,
            writes: AtomicU64::new(0),
            when: When::Once { fail_at, side },
        }
    }

    /// Ledger that fails at one write in `one_in`, on either side, by this seed.
    pub fn often(inner: Arc<dyn Ledger>, seed: u64, one_in: u64) -> Self {
        let dice = Mutex::new(Dice(seed));
        Self {
            inner,
            writes: AtomicU64::new(0),
            when: When::Often { dice, one_in },
        }
    }

    /// True once the one write was asked for that fails.
    pub fn has_failed(&self) -> bool {
        match self.when {
            When::Once { fail_at, .. } => self.writes.load(Ordering::Relaxed) > fail_at,
            When::Often { .. } => true,
        }
    }

    /// On which side the write of this number fails, if it does.
    fn fails(&self, number: u64) -> Option<Side> {
        match &self.when {
            When::Once { fail_at, side } => (number == *fail_at).then_some(*side),
            When::Often { dice, one_in } => {
                let mut dice = dice.lock().expect("no roll panics");
                match dice.roll(2 * one_in) {
                    0 => Some(Side::Before),
                    1 => Some(Side::After),
                    _ => None,
                }
            }
        }
    }

    async fn write<T>(
        &self,
        operation: impl Future<Output = Result<T, LedgerError>> + Send,
    ) -> Result<T, LedgerError> {
        let killed = || Err(LedgerError::Storage("killed here".into()));
        let fails = self.fails(self.writes.fetch_add(1, Ordering::Relaxed));
        if fails == Some(Side::Before) {
            return killed();
        }
        let done = operation.await;
        match fails {
            Some(_) => killed(),
            None => done,
        }
    }
}

#[async_trait]
impl Ledger for FaultyLedger {
    async fn now(&self) -> Result<LedgerTime, LedgerError> {
        self.inner.now().await
    }
    async fn submit(&self, id: RequestId, job: NewJob) -> Result<Submitted, LedgerError> {
        self.write(self.inner.submit(id, job)).await
    }
    async fn cancel(&self, job: JobId, reason: &str) -> Result<Cancelled, LedgerError> {
        self.write(self.inner.cancel(job, reason)).await
    }
    async fn delete(&self, job: JobId) -> Result<Deleted, LedgerError> {
        self.write(self.inner.delete(job)).await
    }
    async fn is_deleted(&self, job: JobId) -> Result<bool, LedgerError> {
        self.inner.is_deleted(job).await
    }
    async fn identity(&self) -> Result<Option<String>, LedgerError> {
        self.inner.identity().await
    }
    async fn audit_key(&self) -> Result<AuditKey, LedgerError> {
        self.inner.audit_key().await
    }
    async fn job(&self, job: JobId) -> Result<Option<JobRow>, LedgerError> {
        self.inner.job(job).await
    }
    async fn jobs(&self, limit: u32) -> Result<Vec<JobRow>, LedgerError> {
        self.inner.jobs(limit).await
    }
    async fn stages(&self, job: JobId) -> Result<Vec<StageRow>, LedgerError> {
        self.inner.stages(job).await
    }
    async fn overviews(&self, limit: u32) -> Result<Vec<(JobRow, Vec<StageRow>)>, LedgerError> {
        self.inner.overviews(limit).await
    }
    async fn steward(
        &self,
        job: JobId,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<Option<Epoch>, LedgerError> {
        self.write(self.inner.steward(job, who, duration_ms)).await
    }
    async fn renew_stewardships(
        &self,
        who: &CoordinatorId,
        duration_ms: u64,
    ) -> Result<(), LedgerError> {
        self.write(self.inner.renew_stewardships(who, duration_ms))
            .await
    }
    async fn attention(
        &self,
        who: &CoordinatorId,
        suspicions: u32,
    ) -> Result<Vec<JobId>, LedgerError> {
        self.inner.attention(who, suspicions).await
    }
    async fn unfinished_jobs(&self) -> Result<Vec<JobId>, LedgerError> {
        self.inner.unfinished_jobs().await
    }
    async fn advance(&self, job: JobId, epoch: Epoch, step: Advance) -> Result<(), LedgerError> {
        self.write(self.inner.advance(job, epoch, step)).await
    }
    async fn split(
        &self,
        chunk: ChunkId,
        epoch: Epoch,
        pieces: &[Piece],
    ) -> Result<(), LedgerError> {
        self.write(self.inner.split(chunk, epoch, pieces)).await
    }
    async fn fail_item(
        &self,
        chunk: ChunkId,
        epoch: Epoch,
        result: ResultObject,
    ) -> Result<(), LedgerError> {
        self.write(self.inner.fail_item(chunk, epoch, result)).await
    }
    async fn reopen(&self, chunk: ChunkId, epoch: Epoch) -> Result<(), LedgerError> {
        self.write(self.inner.reopen(chunk, epoch)).await
    }
    async fn standing(&self, lease: LeaseId) -> Result<Standing, LedgerError> {
        self.inner.standing(lease).await
    }
    async fn finish(&self, job: JobId, epoch: Epoch, end: JobEnd) -> Result<(), LedgerError> {
        self.write(self.inner.finish(job, epoch, end)).await
    }
    async fn finished_chunks(
        &self,
        job: JobId,
        stage: StageId,
        from: u64,
        limit: u32,
    ) -> Result<Vec<ChunkRow>, LedgerError> {
        self.inner.finished_chunks(job, stage, from, limit).await
    }
    async fn suspects(
        &self,
        job: JobId,
        suspicions: u32,
        until: LedgerTime,
    ) -> Result<Vec<ChunkRow>, LedgerError> {
        self.inner.suspects(job, suspicions, until).await
    }
    async fn contributions(&self, job: JobId) -> Result<Vec<Contribution>, LedgerError> {
        self.inner.contributions(job).await
    }
    async fn lease(&self, request: LeaseRequest) -> Result<Vec<Lease>, LedgerError> {
        self.write(self.inner.lease(request)).await
    }
    async fn renew(
        &self,
        leases: &[LeaseId],
        duration_ms: u64,
    ) -> Result<Vec<Renewal>, LedgerError> {
        self.write(self.inner.renew(leases, duration_ms)).await
    }
    async fn complete(
        &self,
        lease: LeaseId,
        result: ResultObject,
    ) -> Result<Completion, LedgerError> {
        self.write(self.inner.complete(lease, result)).await
    }
    async fn confirm(
        &self,
        lease: LeaseId,
        result: ResultObject,
        why: Confirmation,
    ) -> Result<Completion, LedgerError> {
        self.write(self.inner.confirm(lease, result, why)).await
    }
    async fn disputes(&self) -> Result<Vec<Dispute>, LedgerError> {
        self.inner.disputes().await
    }
    async fn strike(&self, vote: LeaseId, why: Strike) -> Result<(), LedgerError> {
        self.write(self.inner.strike(vote, why)).await
    }
    async fn evict(&self, worker: &WorkerId) -> Result<(), LedgerError> {
        self.write(self.inner.evict(worker)).await
    }
    async fn give_back(&self, lease: LeaseId, why: GiveBack) -> Result<(), LedgerError> {
        self.write(self.inner.give_back(lease, why)).await
    }
    async fn expire(&self) -> Result<Vec<Expired>, LedgerError> {
        self.write(self.inner.expire()).await
    }
    async fn seen(&self, worker: WorkerSeen) -> Result<(), LedgerError> {
        self.write(self.inner.seen(worker)).await
    }
    async fn workers(&self, limit: u32) -> Result<Vec<WorkerRow>, LedgerError> {
        self.inner.workers(limit).await
    }
}
