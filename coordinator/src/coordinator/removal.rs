//! Removal: what a coordinator deletes. Jobs on request or because of their age, then what nothing names.
//!
//! Any number of coordinators may do so at once, beside running jobs, and each may be killed at any point: rows
//! go first, and what is left without a row goes later.

use super::{Coordinator, CoordinatorError};
use crate::jobs::large_stage::object_of;
use crate::jobs::planning::{Planned, STATE};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::JobId;
use crate::ledger::rows::{Deleted, JobRow, ResultObject};
use crate::results::references::Wanted;
use crate::results::store::StoreError;
use crate::results::trash::Amount;
use cognate_continuation::start_points::Digest;
use cognate_continuation::work::StageId;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::sleep;
use tokio_util::sync::CancellationToken;

/// The first look after a start comes no later.
const FIRST_LOOK: Duration = Duration::from_secs(60);
/// A ledger's clock that goes ahead of time by more was set: nothing is old because of that.
const CLOCK_SET: Duration = Duration::from_secs(600);
/// Chunks in one answer of the ledger.
const CHUNKS: u32 = 10_000;

/// Rows and objects that a deletion removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Removed {
    /// Stages of the job.
    pub stages: u64,
    /// Chunks of the job.
    pub chunks: u64,
    /// Results of chunks.
    pub results: Amount,
    /// The job had been deleted before.
    pub before: bool,
}

/// Outcome of one round of removal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Collected {
    /// Jobs that were deleted because of their age.
    pub old_jobs: u64,
    /// Results of chunks that no row names: of deleted jobs, or of leases that came too late.
    pub results: Amount,
    /// Objects that nothing names, put into the trash.
    pub trashed: u64,
    /// Objects that are named after all, taken back from the trash.
    pub taken_back: u64,
    /// Objects whose time in the trash was over, removed for good.
    pub removed: Amount,
}

/// Objects that the rows name.
#[derive(Default)]
struct Named {
    all: BTreeSet<Digest>,
    /// Named objects that may name others, and whether their job goes on.
    naming: Vec<(Digest, bool)>,
    /// Named objects that are states of algorithms, which are compressed. Only coordinators write them.
    states: BTreeSet<Digest>,
}

impl Coordinator {
    /// Deletes a job that has ended, or one that is cancelled for it.
    pub async fn delete(
        &self,
        job: JobId,
        cancel_first: bool,
    ) -> Result<Removed, CoordinatorError> {
        if cancel_first && self.ledger.job(job).await?.is_some() {
            self.cancel(job, "cancelled to be deleted").await?;
        }
        let mut removed = match self.ledger.delete(job).await? {
            Deleted::GoesOn(state) => return Err(CoordinatorError::GoesOn { job, state }),
            Deleted::Before => Removed {
                before: true,
                ..Removed::default()
            },
            Deleted::Now { stages, chunks } => Removed {
                stages,
                chunks,
                ..Removed::default()
            },
        };
        self.changed(job);
        removed.results = self.store.remove_results_of(job).await?;
        tracing::info!(%job, ?removed, "a job is deleted");
        Ok(removed)
    }

    /// Looks at everything again and again, until it is told to stop.
    pub(super) async fn run_removal(self: Arc<Self>, stop: CancellationToken) {
        let every = self.policy.retention.every;
        let mut pause = every.min(FIRST_LOOK);
        let mut seen = None;
        self.clock_has_jumped(&mut seen, CLOCK_SET).await;
        loop {
            tokio::select! {
                () = stop.cancelled() => return,
                () = sleep(pause) => {}
            }
            pause = every;
            if self.clock_has_jumped(&mut seen, CLOCK_SET).await {
                tracing::warn!("the ledger's clock was set: nothing is removed because of its age");
                continue;
            }
            if self.health.is_troubled() {
                continue;
            }
            match self.collect().await {
                Ok(collected) if collected == Collected::default() => {}
                Ok(collected) => tracing::info!(?collected, "what nothing needs was looked for"),
                Err(error) => tracing::warn!(%error, "nothing more is removed now"),
            }
        }
    }

    /// Deletes old jobs, then removes what nothing names. Nothing at all where there are results of jobs that
    /// the ledger never had: it is another one's folder, or the ledger is an older copy of itself.
    pub async fn collect(&self) -> Result<Collected, CoordinatorError> {
        let mut collected = Collected::default();
        let now = self.ledger.now().await?;
        // In this order: what is written meanwhile is named by a row that is read after it was listed.
        let with_results = self.store.jobs_with_results().await?;
        let rows = self.ledger.jobs(u32::MAX).await?;
        let ledger_jobs: BTreeSet<JobId> = rows.iter().map(|row| row.job).collect();
        let (mut deleted, mut unknown) = (Vec::new(), 0);
        for job in with_results.iter().filter(|job| !ledger_jobs.contains(job)) {
            match self.ledger.is_deleted(*job).await? {
                true => deleted.push(*job),
                false => unknown += 1,
            }
        }
        self.claim_results(unknown).await?;
        for job in deleted {
            // The coordinator that deleted the job was killed before it had removed its results.
            collected.results += self.store.remove_results_of(job).await?;
        }
        self.store.remove_left_uploads().await?;
        self.delete_old(&rows, now, &mut collected).await?;
        self.remove_late_results(now, &with_results, &mut collected)
            .await?;
        self.empty_trash(now, &mut collected).await?;
        Ok(collected)
    }

    /// Marks the folder as this ledger's, unless it is marked as another's; fails if it has results of `unknown` jobs
    /// that this ledger never had.
    pub(super) async fn claim_results(&self, unknown: u64) -> Result<(), CoordinatorError> {
        let identity = self.ledger.identity().await?;
        let is_first = self.store.belongs_to(identity.as_deref()).await?;
        if unknown > 0 {
            return Err(CoordinatorError::ForeignResults(unknown));
        }
        if let Some(identity) = identity.filter(|_| is_first) {
            self.store.give_to(&identity).await?;
        }
        Ok(())
    }

    async fn delete_old(
        &self,
        rows: &[JobRow],
        now: LedgerTime,
        collected: &mut Collected,
    ) -> Result<(), CoordinatorError> {
        let keep = self.policy.retention.keep_ms;
        for row in rows {
            let is_old = |ended| now.since_ms(ended) >= keep;
            if keep > 0 && row.ended.is_some_and(is_old) {
                tracing::info!(job = %row.job, "the job is deleted: it ended long ago");
                collected.old_jobs += 1;
                collected.results += self.delete(row.job, false).await?.results;
            }
        }
        Ok(())
    }

    /// Results that came when their job had ended, or that another execution of a chunk had been faster than.
    async fn remove_late_results(
        &self,
        now: LedgerTime,
        with_results: &[JobId],
        collected: &mut Collected,
    ) -> Result<(), CoordinatorError> {
        for &job in with_results {
            let Some(ended) = self.ledger.job(job).await?.and_then(|row| row.ended) else {
                continue;
            };
            let is_settled = now.since_ms(ended) >= self.policy.retention.grace_ms;
            if !is_settled || self.is_tidied(job) {
                continue;
            }
            let late = match self.late_results(job).await {
                // Somebody has deleted it meanwhile.
                Err(CoordinatorError::Ledger(LedgerError::UnknownJob(_))) => continue,
                late => late?,
            };
            for (address, bytes) in late {
                if self.store.remove_results(&address).await? {
                    collected.results += Amount::one(bytes);
                }
            }
            self.tidied(job);
        }
        Ok(())
    }

    /// Addresses of the results of a job that has ended which none of its rows names, and their sizes in bytes.
    pub(super) async fn late_results(
        &self,
        job: JobId,
    ) -> Result<Vec<(String, u64)>, CoordinatorError> {
        let named = self.named_results(job).await?;
        let mut late = self.store.results_of(job).await?;
        late.retain(|(address, _)| !named.contains(address));
        Ok(late)
    }

    /// Addresses of the results that the rows of a job name.
    async fn named_results(&self, job: JobId) -> Result<BTreeSet<String>, LedgerError> {
        let mut named = BTreeSet::new();
        for stage in self.ledger.stages(job).await? {
            let mut from = 0;
            while let Some((next, objects)) = self.named_page(job, stage.stage, from).await? {
                from = next;
                named.extend(objects.into_iter().map(|object| object.address));
            }
        }
        Ok(named)
    }

    /// The next results that the rows of a stage name, of items after this one, and the last of their items; `None`
    /// where there are no more rows.
    pub(super) async fn named_page(
        &self,
        job: JobId,
        stage: StageId,
        from: u64,
    ) -> Result<Option<(u64, Vec<ResultObject>)>, LedgerError> {
        let chunks = self.ledger.finished_chunks(job, stage, from, CHUNKS);
        let chunks = chunks.await?;
        let last = chunks.last().map(|chunk| chunk.items.last);
        Ok(last.map(|last| (last, chunks.into_iter().filter_map(object_of).collect())))
    }

    async fn empty_trash(
        &self,
        now: LedgerTime,
        collected: &mut Collected,
    ) -> Result<(), CoordinatorError> {
        let listed = self.store.objects().await?;
        let trash = self.store.in_trash().await?;
        let are_unseen = self.store.naming().are_unseen(&trash);
        let there = listed.iter().map(|(digest, _)| *digest);
        let there = there.chain(trash.iter().map(|trashed| trashed.digest));
        let unnamed = self.unnamed(there.collect()).await?;
        for (trashed, is_unseen) in trash.iter().zip(are_unseen) {
            let is_old = now.since_ms(trashed.since) >= self.policy.retention.grace_ms;
            if !unnamed.contains(&trashed.digest) {
                collected.taken_back += u64::from(self.store.take_back(trashed, is_old).await?);
            } else if is_old && is_unseen && self.store.remove_from_trash(trashed).await? {
                collected.removed += Amount::one(trashed.bytes);
            }
        }
        for (digest, _) in listed.iter().filter(|(d, _)| unnamed.contains(d)) {
            collected.trashed += u64::from(self.store.trash(*digest, now).await?);
        }
        Ok(())
    }

    /// Objects among `there` that neither a row nor an object of a job names.
    pub(super) async fn unnamed(
        &self,
        there: BTreeSet<Digest>,
    ) -> Result<BTreeSet<Digest>, CoordinatorError> {
        let wanted = Wanted::new(&there);
        let mut unnamed = there;
        let mut named = Named::default();
        for row in self.ledger.jobs(u32::MAX).await? {
            self.name(&row, &wanted, &mut named).await?;
        }
        unnamed.retain(|digest| !named.all.contains(digest));
        while let Some((digest, goes_on)) = named.naming.pop() {
            if unnamed.is_empty() {
                break;
            }
            let bytes = match named.states.contains(&digest) {
                true => self.store.bytes_record(&STATE, digest).await,
                false => self.store.get(digest).await.map(Vec::from),
            };
            match bytes {
                Ok(bytes) => {
                    for named_digest in wanted.named_in(&bytes) {
                        if unnamed.remove(&named_digest) {
                            named.naming.push((named_digest, goes_on));
                        }
                    }
                }
                // Names in a lost object are unknown. The answer of a job that has ended is named by its row.
                Err(StoreError::Missing(_) | StoreError::Damaged { .. }) if !goes_on => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(unnamed)
    }

    /// Adds the objects that the rows of a job name.
    async fn name(
        &self,
        row: &JobRow,
        wanted: &Wanted,
        named: &mut Named,
    ) -> Result<(), CoordinatorError> {
        let goes_on = !row.state.has_ended();
        let Some(stages) = unless_deleted(self.ledger.stages(row.job).await)? else {
            return Ok(());
        };
        let mut naming = BTreeSet::from([row.asked.problem]);
        let planned = Planned::from_bytes(&row.asked.options)?;
        let states = row.snapshot.into_iter().chain([planned.first_state]);
        naming.extend(states.clone());
        named.states.extend(states);
        naming.extend(stages.iter().map(|stage| stage.definition));
        // The plan names the problem as it was submitted.
        naming.extend(wanted.named_in(&row.asked.options));
        // Answers name nothing, and are large.
        named
            .all
            .extend(row.solutions.into_iter().chain(row.summary));
        named.all.extend(&naming);
        named
            .naming
            .extend(naming.into_iter().map(|digest| (digest, goes_on)));
        Ok(())
    }

    /// Whether late results of a job that has ended were looked for already.
    fn is_tidied(&self, job: JobId) -> bool {
        let tidied = self.tidied.lock();
        let tidied = tidied.unwrap_or_else(std::sync::PoisonError::into_inner);
        tidied.contains(&job)
    }

    fn tidied(&self, job: JobId) {
        let tidied = self.tidied.lock();
        let mut tidied = tidied.unwrap_or_else(std::sync::PoisonError::into_inner);
        tidied.insert(job);
    }
}

/// `None` where somebody deleted the job meanwhile.
fn unless_deleted<T>(asked: Result<T, LedgerError>) -> Result<Option<T>, LedgerError> {
    match asked {
        Ok(rows) => Ok(Some(rows)),
        Err(LedgerError::UnknownJob(_)) => Ok(None),
        Err(error) => Err(error),
    }
}
