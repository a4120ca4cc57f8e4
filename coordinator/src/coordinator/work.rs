//! Calls of workers: pull, renew, report, give back.

use super::arbitration::{Judgement, MOST_RULED, Ruling};
use super::result_check::CheckedResults;
use super::{Coordinator, CoordinatorError};
use crate::chunks::audit::{AuditKey, Draw};
use crate::chunks::plausibility::Doubt;
use crate::ledger::identity::{ChunkId, Epoch, ItemRange, LeaseId, RequestId, Speaker, WorkerId};
use crate::ledger::rows::{
    Completion, Confirmation, GiveBack, Lease, LeaseRequest, Renewal, ResultObject, Standing,
    WorkerSeen,
};
use crate::ledger::rules::{HEARD_MS, MOST_MICROS};
use crate::measures::ChunkEvent;
use crate::results::store::{Store, StoreError};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::{Stage, Work};
use std::time::Duration;
use tokio::time::{Instant, sleep_until, timeout_at};

/// Interval at which an unchanged description of a worker is written again, in milliseconds.
const SEEN_MS: i64 = 5000;
/// Interval at which the ledger is asked again while a worker waits: another coordinator may have opened a stage.
const POLL: Duration = Duration::from_secs(1);
/// Workers whose last description is kept, and workers whose departure is kept.
const MOST_KEPT: usize = 100_000;

/// A worker asks for chunks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pull {
    /// Description of the worker.
    pub worker: WorkerSeen,
    /// Id of the request; a call that is sent again has the same id.
    pub request: RequestId,
    /// Number of chunks that the worker wants, at most.
    pub slots: u32,
    /// Time that the call waits until there is a chunk.
    pub wait: Duration,
}

impl Pull {
    /// The worker in its session.
    fn speaker(&self) -> Speaker {
        Speaker {
            worker: self.worker.worker.clone(),
            session: self.request.speaker_session().to_owned(),
        }
    }
}

/// Results of a chunk, as a worker reports them.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The worker that reports.
    pub by: Speaker,
    /// Lease under which the chunk was done.
    pub lease: LeaseId,
    /// One result for each item, in order.
    pub results: Vec<ItemResult>,
    /// CPU time of the tracking, in microseconds.
    pub cpu_micros: u64,
}

/// A report whose results were checked and are kept.
struct KeptReport {
    by: Speaker,
    lease: LeaseId,
    work: Work,
    object: ResultObject,
    ruling: Ruling,
    /// Comparison that the ledger makes before it accepts the results; `None`: none.
    confirmation: Option<Confirmation>,
}

impl Coordinator {
    /// Leases chunks to a worker; waits for some, if there are none. A worker that wants none is
    /// only written down.
    pub async fn pull(&self, pull: Pull) -> Result<Vec<Lease>, CoordinatorError> {
        let is_here = self.note_pull(&pull).await?;
        if !is_here || pull.slots == 0 || pull.worker.draining {
            return Ok(Vec::new());
        }
        let deadline = Instant::now() + pull.wait;
        let by = pull.speaker();
        let mut request = self.lease_request(&pull);
        if let Some(until) = self
            .conduct
            .aside_until(&pull.worker.worker, Instant::now())
        {
            sleep_until(deadline.min(until)).await;
            return Ok(Vec::new());
        }
        loop {
            // A worker that waits here is present: others may be waiting for its word on a chunk.
            if !self.note_pull(&pull).await? {
                return Ok(Vec::new());
            }
            if self.health.is_troubled() {
                // A chunk that is leased now could be neither fetched nor kept.
                if Instant::now() >= deadline {
                    return Ok(Vec::new());
                }
                sleep_until(deadline.min(Instant::now() + POLL)).await;
                continue;
            }
            // Listening begins before the question, so that no wake-up is lost in between.
            let woken = self.work.notified();
            tokio::pin!(woken);
            woken.as_mut().enable();
            request.without = self.sick_jobs();
            let leases = self.ledger.lease(request.clone()).await?;
            let is_any = !leases.is_empty();
            let leases = self.fetchable(leases, &by).await?;
            if is_any && leases.is_empty() && Instant::now() < deadline {
                // Of other jobs there may be some.
                continue;
            }
            if !leases.is_empty() && self.has_left(&by) {
                // It left while they were made, and does not know of them.
                let unheard: Vec<LeaseId> = leases.iter().map(|lease| lease.lease).collect();
                self.give_back(&unheard, GiveBack::Drained, &by).await?;
                return Ok(Vec::new());
            }
            if !leases.is_empty() {
                self.events.count(ChunkEvent::Leased, leases.len());
                for lease in &leases {
                    if lease.speculative {
                        tracing::info!(lease = %lease.lease, worker = %pull.worker.worker,
                            "a late chunk is given to a second worker");
                    }
                    self.changed(lease.lease.chunk.job);
                }
                return Ok(leases);
            }
            if Instant::now() >= deadline {
                return Ok(leases);
            }
            // Woken, or not: the ledger says what there is.
            let _ = timeout_at(deadline.min(Instant::now() + POLL), woken).await;
        }
    }

    fn lease_request(&self, pull: &Pull) -> LeaseRequest {
        let WorkerSeen {
            worker,
            numerics_revision,
            threads,
            ..
        } = &pull.worker;
        let mut request = self.policy.request(
            worker.clone(),
            pull.request.clone(),
            *numerics_revision,
            *threads,
            pull.slots,
        );
        let sizing = &mut request.sizing;
        sizing.longest_ms = self.longest_ms().max(sizing.shortest_ms);
        request
    }

    /// The most work in a chunk, in milliseconds: less where workers are lost often.
    fn longest_ms(&self) -> u64 {
        let workers = {
            let seen = self
                .seen
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            let latest = seen.values().map(|(_, when)| *when).max().unwrap_or(0);
            let here = seen.values().filter(|(says, when)| {
                !says.draining && latest.saturating_sub(*when) < HEARD_MS as i64
            });
            here.count() as u64
        };
        let mut losses = self
            .losses
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let (percent, longest_ms) = (self.policy.rework_percent, self.policy.sizing.longest_ms);
        losses.longest_ms(Instant::now(), workers, percent, longest_ms)
    }

    /// Remembers that the worker of a pull was here; `false` where its session has left since it asked.
    async fn note_pull(&self, pull: &Pull) -> Result<bool, CoordinatorError> {
        let by = pull.speaker();
        if self.has_left(&by) {
            return Ok(false);
        }
        self.note(&pull.worker).await?;
        self.remember_session(&by);
        if self.has_left(&by) {
            // In this moment: its last word is that it leaves.
            self.worker_leaves(&by).await?;
            return Ok(false);
        }
        Ok(true)
    }

    fn has_left(&self, by: &Speaker) -> bool {
        let left = self
            .left
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        left.get(&by.worker) == Some(&by.session)
    }

    /// Remembers that a worker was here; not every time.
    async fn note(&self, says: &WorkerSeen) -> Result<(), CoordinatorError> {
        let now = self.ledger.now().await?.0;
        {
            let seen = self
                .seen
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            if let Some((said, when)) = seen.get(&says.worker)
                && said == says
                && now - when < SEEN_MS
            {
                return Ok(());
            }
        }
        // Not remembered before the ledger has taken it: the name may be another credential's.
        self.ledger.seen(says.clone()).await?;
        let mut seen = self
            .seen
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        seen.insert(says.worker.clone(), (says.clone(), now));
        if seen.len() > MOST_KEPT {
            seen.retain(|_, (_, when)| now - *when < SEEN_MS);
        }
        Ok(())
    }

    fn remember_session(&self, by: &Speaker) {
        let mut sessions = self
            .sessions
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        if sessions.get(&by.worker) != Some(&by.session) {
            if sessions.len() >= MOST_KEPT {
                sessions.clear();
            }
            sessions.insert(by.worker.clone(), by.session.clone());
        }
    }

    /// Whether a worker of this name asked for work last in this session, at this coordinator.
    fn is_session_of(&self, by: &Speaker) -> bool {
        let sessions = self
            .sessions
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        sessions.get(&by.worker) == Some(&by.session)
    }

    /// A worker that works and asks for nothing is here, too.
    async fn note_again(&self, worker: &WorkerId) -> Result<(), CoordinatorError> {
        let said = {
            let seen = self
                .seen
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            seen.get(worker).map(|(says, _)| says.clone())
        };
        match said {
            Some(says) => self.note(&says).await,
            None => Ok(()),
        }
    }

    /// A worker says that it leaves. What it asked before may still wait, and says nothing any more.
    pub async fn worker_leaves(&self, by: &Speaker) -> Result<(), CoordinatorError> {
        {
            let mut left = self
                .left
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            if left.len() >= MOST_KEPT {
                left.clear();
            }
            left.insert(by.worker.clone(), by.session.clone());
        }
        let said = {
            let mut seen = self
                .seen
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            seen.remove(&by.worker)
        };
        if let Some((mut says, _)) = said {
            says.draining = true;
            self.ledger.seen(says).await?;
        }
        Ok(())
    }

    /// Prolongs leases of this worker; those of others are lost to it.
    pub async fn renew(
        &self,
        leases: &[LeaseId],
        by: &Speaker,
    ) -> Result<Vec<Renewal>, CoordinatorError> {
        self.note_again(&by.worker).await?;
        let mut renewals = vec![Renewal::Lost; leases.len()];
        let (mut places, mut own_leases) = (Vec::new(), Vec::new());
        for (place, &lease) in leases.iter().enumerate() {
            if self.ledger.standing(lease).await?.is_of(by) {
                places.push(place);
                own_leases.push(lease);
            }
        }
        let renewed = self.ledger.renew(&own_leases, self.policy.lease_ms).await?;
        for (place, renewal) in places.into_iter().zip(renewed) {
            renewals[place] = renewal;
        }
        Ok(renewals)
    }

    /// A worker failed: after several times in a row it is put aside.
    pub(super) fn failed(&self, worker: &WorkerId, why: &str) {
        if let Some(time) = self.conduct.failed(worker, why, Instant::now()) {
            tracing::warn!(%worker, why, seconds = time.as_secs(),
                "a worker fails one chunk after the other: it gets none for a while");
        }
    }

    /// Work that is done with the items of a lease.
    pub async fn work_of(&self, lease: LeaseId) -> Result<Work, CoordinatorError> {
        let ChunkId { job, stage, .. } = lease.chunk;
        match self.stage(job, stage).await {
            Ok(stage) => Ok(stage.work),
            // Results of a job that has ended are of no use, whatever storage has lost of it.
            Err(CoordinatorError::Store(error)) if error.is_loss() => {
                let row = self.ledger.job(job).await?;
                match row.is_none_or(|row| row.state.has_ended()) {
                    true => Err(CoordinatorError::UnknownStage { job, stage }),
                    false => Err(error.into()),
                }
            }
            Err(error) => Err(error),
        }
    }

    /// Takes the results of a chunk: the object, then the row, then the answer.
    pub async fn complete(&self, report: Report) -> Result<Completion, CoordinatorError> {
        let Report {
            by,
            lease,
            results,
            cpu_micros,
        } = report;
        let stage = self.stage(lease.chunk.job, lease.chunk.stage).await?;
        let first = lease.chunk.first;
        let items = ItemRange {
            first,
            last: first.saturating_add(results.len() as u64),
        };
        let checked = check_report(&stage, items, &results);
        let cpu_micros = cpu_micros.min(MOST_MICROS);
        // Results are kept only if they are from the worker that holds the chunk.
        match self.ledger.standing(lease).await? {
            standing if standing.is_of(&by) => {}
            Standing::Held { worker: holder, .. } => {
                let worker = &by.worker;
                tracing::warn!(%lease, %worker, %holder, "a worker reports what another one has");
                self.failed(worker, "it reports chunks that others have");
                return Ok(Completion::Stale);
            }
            // Nothing is kept for an invented lease: it may be given to another worker meanwhile.
            Standing::Never => return Ok(Completion::Stale),
            Standing::Ended => {
                if checked.is_err() {
                    return Ok(Completion::Stale);
                }
                return self.compare_ended(lease, &by, items, results).await;
            }
        }
        checked.map_err(|what| {
            self.events.count(ChunkEvent::Refused, 1);
            self.failed(&by.worker, &what);
            CoordinatorError::Report {
                lease: lease.to_string(),
                what,
            }
        })?;
        let CheckedResults {
            results,
            doubts,
            is_complete,
        } = self.check_results(lease, &stage, results).await?;
        let is_checked = is_complete && doubts.len() <= MOST_RULED;
        let Judgement { ruling, doubt } =
            self.judge_doubts(lease, &stage, doubts, &results).await?;
        let object = match self
            .store
            .put_results(lease, items, results, cpu_micros)
            .await
        {
            Ok(object) => object,
            Err(StoreError::Differs(address)) => {
                tracing::error!(%lease, address, "two executions of one lease differ");
                return Ok(Completion::HashDiffers);
            }
            Err(error @ StoreError::Damaged { .. }) => {
                // The place is taken by something broken: the next lease has another place.
                let reason = error.to_string();
                tracing::error!(%lease, reason, "the chunk is tracked again");
                self.give_back(&[lease], GiveBack::Drained, &by).await?;
                return Ok(Completion::Stale);
            }
            Err(error) => return Err(error.into()),
        };
        let confirmation = self.confirmation(lease, ruling, is_checked).await?;
        if let Some(Doubt { why, .. }) = &doubt {
            self.events.count(ChunkEvent::Doubted, 1);
            tracing::warn!(%lease, worker = %by.worker, why,
                "results that cannot be right: the chunk is done again");
            self.failed(&by.worker, why);
        }
        let kept = KeptReport {
            by,
            lease,
            work: stage.work,
            object,
            ruling,
            confirmation,
        };
        let completion = self.write_down(&kept).await?;
        self.follow_up(&kept, completion).await?;
        Ok(completion)
    }

    /// Acts on the ledger's answer to a report: wakes waiting calls and removes useless objects.
    async fn follow_up(
        &self,
        kept: &KeptReport,
        completion: Completion,
    ) -> Result<(), CoordinatorError> {
        let (lease, object) = (kept.lease, &kept.object);
        match completion {
            Completion::Unconfirmed => {
                self.events.count(ChunkEvent::Unconfirmed, 1);
                tracing::debug!(%lease, "a chunk is done again on another worker, to compare");
                self.work.notify_waiters();
                self.changed(lease.chunk.job);
            }
            Completion::Accepted => {
                self.events.count(ChunkEvent::Accepted, 1);
                if kept.ruling == Ruling::Right {
                    self.conduct.did_well(&kept.by.worker);
                }
                tracing::debug!(%lease, items = object.items.len(), "a chunk is accepted");
                self.changed(lease.chunk.job);
                self.wake_steward(lease.chunk.job);
                if kept.confirmation.is_some() {
                    // A worker that was outvoted has lost chunks.
                    self.work.notify_waiters();
                }
            }
            Completion::Overtaken => {
                tracing::debug!(%lease, "another worker was first with the same results");
                self.remove_useless(lease, &object.address).await;
            }
            Completion::Stale => {
                self.events.count(ChunkEvent::Stale, 1);
                tracing::debug!(%lease, "the lease ended while its report was kept");
                self.remove_useless(lease, &object.address).await;
            }
            Completion::HashDiffers => {
                let late = self.store.results(object, kept.work).await?;
                self.remove_useless(lease, &object.address).await;
                self.settle_difference(lease, &kept.by, late).await;
            }
            Completion::AlreadyAccepted => {
                tracing::debug!(%lease, ?completion, "a report changes nothing");
            }
        }
        Ok(())
    }

    /// Secret of the ledger's audits.
    pub(super) async fn audit_key(&self) -> Result<AuditKey, CoordinatorError> {
        let key = self.audit_key.get_or_try_init(|| self.ledger.audit_key());
        Ok(*key.await?)
    }

    /// Whether a reported chunk is drawn, so that it is done twice.
    async fn is_drawn(&self, draw: Draw, chunk: ChunkId) -> Result<bool, CoordinatorError> {
        let percent = match draw {
            Draw::Audit => self.policy.audit_percent,
            Draw::Unchecked => self.policy.unchecked_audit_percent,
        };
        Ok(self.audit_key().await?.draws(draw, chunk, percent))
    }

    /// Comparison that the ledger makes before it accepts the results of a chunk; `None`: none.
    async fn confirmation(
        &self,
        lease: LeaseId,
        ruling: Ruling,
        is_checked: bool,
    ) -> Result<Option<Confirmation>, CoordinatorError> {
        Ok(match ruling {
            Ruling::Wrong => Some(Confirmation::Wrong),
            Ruling::Undecided => Some(Confirmation::Doubt),
            Ruling::Right if self.is_drawn(Draw::Audit, lease.chunk).await? => {
                Some(Confirmation::Audit)
            }
            Ruling::Right if !is_checked && self.is_drawn(Draw::Unchecked, lease.chunk).await? => {
                Some(Confirmation::Unchecked)
            }
            // Other workers may have reported results of the chunk that wait for confirmation.
            Ruling::Right if lease.epoch > Epoch(1) => Some(Confirmation::Compare),
            Ruling::Right => None,
        })
    }

    /// The row of results that are kept: accepted, or compared with what others find.
    async fn write_down(&self, kept: &KeptReport) -> Result<Completion, CoordinatorError> {
        let (lease, object) = (kept.lease, kept.object.clone());
        let Some(why) = kept.confirmation else {
            return Ok(self.ledger.complete(lease, object).await?);
        };
        if why == Confirmation::Wrong {
            tracing::error!(%lease, worker = %kept.by.worker,
                "a worker computes wrongly: it gets no more work");
            self.events.count(ChunkEvent::Struck, 1);
        }
        Ok(self.ledger.confirm(lease, object, why).await?)
    }

    /// Compares the report of a lease that has ended with the results of the chunk: the first answer may have been
    /// lost, or the results may differ. The report is not kept.
    async fn compare_ended(
        &self,
        lease: LeaseId,
        by: &Speaker,
        items: ItemRange,
        results: Vec<ItemResult>,
    ) -> Result<Completion, CoordinatorError> {
        let late = results.clone();
        let (object, _) = Store::describe_results(lease, items, results, 0).await;
        // The ledger compares the results with the lease's vote where it cast one, else with the accepted results.
        let compared = self.ledger.confirm(lease, object, Confirmation::Audit);
        let completion = compared.await?;
        if completion == Completion::HashDiffers {
            self.settle_difference(lease, by, late).await;
        }
        Ok(completion)
    }

    /// A late report differs from the accepted results: finds out which worker computes wrongly.
    ///
    /// Nobody remembers whose a lease was that has ended, so that anybody may report under it. Only a worker that is known
    /// by its session speaks for itself; reports of others are logged, and evict nobody.
    async fn settle_difference(&self, lease: LeaseId, by: &Speaker, late: Vec<ItemResult>) {
        tracing::error!(%lease, worker = %by.worker,
            "a chunk was accepted before with other results: one of two workers computes wrongly");
        if !self.is_session_of(by) {
            tracing::warn!(%lease, worker = %by.worker,
                "the late report is not of the worker's session, and is not looked into");
            return;
        }
        if let Err(error) = self.settle_late(lease, &by.worker, late).await {
            tracing::error!(%lease, %error, "the coordinator could not find out which worker");
        }
    }

    async fn remove_useless(&self, lease: LeaseId, address: &str) {
        // An object that a failure or a kill leaves behind only takes some space.
        if let Err(error) = self.store.remove_results(address).await {
            tracing::debug!(%lease, %error, "an object of no use stays");
        }
    }

    /// Takes chunks of this worker back without results.
    pub async fn give_back(
        &self,
        leases: &[LeaseId],
        why: GiveBack,
        by: &Speaker,
    ) -> Result<(), CoordinatorError> {
        for lease in leases {
            if !self.ledger.standing(*lease).await?.is_of(by) {
                continue;
            }
            if let GiveBack::Failed { reason } = &why {
                self.events.count(ChunkEvent::Failed, 1);
                tracing::warn!(%lease, worker = %by.worker, reason, "a worker could not do a chunk");
                self.failed(&by.worker, reason);
            }
            self.ledger.give_back(*lease, why.clone()).await?;
            self.wake_steward(lease.chunk.job);
            self.changed(lease.chunk.job);
        }
        self.work.notify_waiters();
        Ok(())
    }
}

/// Results must be those of the items: the algorithms rely on it.
fn check_report(stage: &Stage, items: ItemRange, results: &[ItemResult]) -> Result<(), String> {
    if items.is_empty()
        || stage
            .items()
            .is_none_or(|item_count| items.last > item_count)
    {
        return Err(format!("items {}..{}", items.first, items.last));
    }
    for (item, result) in (items.first..items.last).zip(results) {
        let origin = stage.origin(item);
        if result.origin().0 != origin || result.attempt() != stage.attempt {
            return Err(format!(
                "item {item} is path {origin} in attempt {}, the report has path {} in attempt {}",
                stage.attempt,
                result.origin().0,
                result.attempt()
            ));
        }
        if !result.is_of(stage.work) {
            let work = stage.work;
            return Err(format!(
                "item {item} is of {work:?}, the report has {result:?}"
            ));
        }
    }
    Ok(())
}
