//! Background work of a coordinator: it drives jobs and takes back the leases of silent workers.

use super::{Coordinator, CoordinatorError};
use crate::jobs::drive::{Drive, Driven};
use crate::jobs::tools::{DriveError, Tools};
use crate::ledger::LedgerError;
use crate::ledger::clock::LedgerTime;
use crate::ledger::identity::JobId;
use crate::ledger::rows::JobEnd;
use crate::measures::ChunkEvent;
use futures::FutureExt;
use std::any::Any;
use std::collections::BTreeSet;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Notify;
use tokio::time::{Instant, sleep, sleep_until, timeout};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

/// Shortest interval at which the ledger is asked which jobs need attention; other coordinators may have changed
/// them.
const LOOK: Duration = Duration::from_secs(1);
/// Smallest ratio of the interval between two queries for jobs that need attention to the time of a query, unless a job
/// without a steward would wait too long (see [`pause_between_looks`]).
const LOOK_SHARE: u32 = 20;
/// Time after which a driven job is looked at even if nobody wakes it.
const LATEST_LOOK: Duration = Duration::from_secs(60);
/// Longest pause before a waiting job is looked at again; below it, the pause is the time that the last look took.
/// Chunks that end meanwhile are absorbed together, and looking takes at most half of the time.
const LONGEST_PAUSE: Duration = Duration::from_millis(5);
/// Pause before a job is tried again after a failure of ledger or store.
const RETRY: Duration = Duration::from_secs(1);

impl Coordinator {
    fn tools(&self) -> Tools<'_> {
        Tools {
            ledger: &*self.ledger,
            store: &self.store,
            who: &self.who,
            policy: &self.policy,
        }
    }

    /// Works until it is told to stop; then ends what it has begun.
    pub async fn run(self: Arc<Self>, stop: CancellationToken) {
        let tasks = TaskTracker::new();
        tasks.spawn(Arc::clone(&self).run_examination(stop.clone()));
        tasks.spawn(Arc::clone(&self).run_removal(stop.clone()));
        tasks.spawn(Arc::clone(&self).run_arbitration(stop.clone()));
        let expiry = tasks.track_future(Arc::clone(&self).run_expiry(stop.clone()));
        let stewards = Arc::clone(&self).run_stewards(stop.clone(), tasks.clone());
        tokio::join!(expiry, stewards);
        tasks.close();
        tasks.wait().await;
    }

    /// Looks after ledger and store.
    async fn run_examination(self: Arc<Self>, stop: CancellationToken) {
        loop {
            self.examine().await;
            tokio::select! {
                () = stop.cancelled() => return,
                () = sleep(LOOK) => {}
            }
        }
    }

    /// Takes back expired leases.
    ///
    /// Begins after the time of one lease: while no coordinator was there, no worker could renew, and its silence was
    /// not its fault. It pauses again after this coordinator or its ledger stood still.
    async fn run_expiry(self: Arc<Self>, stop: CancellationToken) {
        let grace = Duration::from_millis(self.policy.lease_ms);
        let every = Duration::from_millis(self.policy.expiry_ms.max(1));
        // Time between two looks above which calls of workers may have waited, too.
        let held_up = every + grace / 4;
        let mut pause = grace;
        let mut seen = None;
        self.clock_has_jumped(&mut seen, held_up).await;
        loop {
            let begin = Instant::now();
            tokio::select! {
                () = stop.cancelled() => return,
                () = sleep(pause) => {}
            }
            if begin.elapsed() > pause + held_up {
                tracing::warn!("this coordinator stood still: nobody's silence counts for a lease");
                pause = grace;
                continue;
            }
            let begin = Instant::now();
            if self.clock_has_jumped(&mut seen, held_up).await {
                tracing::warn!("the ledger's clock was set: nobody's silence counts for a lease");
                pause = grace;
                continue;
            }
            if begin.elapsed() > held_up {
                // It was away: no worker could renew meanwhile, and none has had the time to since.
                tracing::warn!("the ledger was away: nobody's silence counts for a lease");
                pause = grace;
                continue;
            }
            let begin = Instant::now();
            if let Err(error) = self.expire().await {
                tracing::warn!(%error, "expired leases could not be taken back");
            }
            pause = every;
            if begin.elapsed() > held_up {
                tracing::warn!("the ledger is slow: nobody's silence counts for a lease");
                pause = grace;
            }
        }
    }

    /// Whether the ledger's clock has gone further since it was `seen` than time has, by more than this:
    /// somebody has set a database server's clock.
    pub(super) async fn clock_has_jumped(
        &self,
        seen: &mut Option<(Instant, LedgerTime)>,
        allowed: Duration,
    ) -> bool {
        let before = Instant::now();
        // Where the ledger does not answer, nothing expires either.
        let Ok(now) = self.ledger.now().await else {
            *seen = None;
            return false;
        };
        let last = seen.replace((before, now));
        last.is_some_and(|(then, said)| {
            let passed = Duration::from_millis(now.since_ms(said));
            passed > then.elapsed() + allowed
        })
    }

    /// Takes back the leases that have expired by now.
    pub async fn expire(&self) -> Result<(), CoordinatorError> {
        let expired = self.ledger.expire().await?;
        self.events.count(ChunkEvent::Expired, expired.len());
        let mut silent = BTreeSet::new();
        for gone in &expired {
            tracing::warn!(lease = %gone.lease, worker = %gone.worker,
                suspicions = gone.suspicions, "a worker fell silent: its chunk goes to another");
            silent.insert(gone.worker.clone());
            self.wake_steward(gone.lease.chunk.job);
            self.changed(gone.lease.chunk.job);
        }
        self.losses
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .add(silent.len(), Instant::now());
        for worker in &silent {
            self.failed(worker, "it fell silent");
        }
        if !expired.is_empty() {
            self.work.notify_waiters();
        }
        Ok(())
    }

    /// Finds jobs without a steward, and wakes the stewards of jobs that need attention. One query serves all jobs: a
    /// job that only waits costs nothing.
    async fn run_stewards(self: Arc<Self>, stop: CancellationToken, tasks: TaskTracker) {
        tasks.spawn(Arc::clone(&self).run_renewal(stop.clone()));
        let right = Duration::from_millis(self.policy.steward_ms);
        let mut last = Duration::ZERO;
        loop {
            let begin = Instant::now();
            let limit = self.policy.suspicion_limit;
            match self.ledger.attention(&self.who, limit).await {
                Ok(jobs) => {
                    for job in jobs {
                        self.attend(job, &stop, &tasks);
                        self.wake_steward(job);
                    }
                }
                Err(error) => tracing::warn!(%error, "the jobs could not be listed"),
            }
            let took = begin.elapsed();
            let pause = pause_between_looks(last, took, right);
            last = took;
            tokio::select! {
                () = stop.cancelled() => return,
                () = self.unattended.notified() => {}
                () = sleep(pause) => {}
            }
        }
    }

    /// Keeps the right to drive all jobs that this coordinator drives.
    async fn run_renewal(self: Arc<Self>, stop: CancellationToken) {
        let every = Duration::from_millis(self.policy.steward_ms / 3);
        loop {
            tokio::select! {
                () = stop.cancelled() => return,
                () = sleep(every) => {}
            }
            let duration = self.policy.steward_ms;
            if let Err(error) = self.ledger.renew_stewardships(&self.who, duration).await {
                tracing::warn!(%error, "the rights to drive are not renewed");
            }
        }
    }

    fn attend(self: &Arc<Self>, job: JobId, stop: &CancellationToken, tasks: &TaskTracker) {
        let wake = Arc::new(Notify::new());
        {
            let mut drives = self.drives();
            if drives.contains_key(&job) {
                return;
            }
            drives.insert(job, Arc::clone(&wake));
        }
        let (coordinator, stop) = (Arc::clone(self), stop.clone());
        tasks.spawn(async move {
            let _attended = Attended {
                coordinator: Arc::clone(&coordinator),
                job,
            };
            let driven = AssertUnwindSafe(coordinator.drive(job, &wake, &stop));
            match driven.catch_unwind().await {
                Ok(Ok(())) => {}
                Ok(Err(error)) if error.is_fenced() => {
                    tracing::info!(%job, "another coordinator drives the job");
                }
                Ok(Err(error)) => {
                    tracing::warn!(%job, %error, "the job is tried again");
                    sleep(RETRY).await;
                }
                // A broken invariant breaks again on every try: the job ends, the service stays.
                Err(panic) => {
                    let reason = format!("internal error: {}", message(&*panic));
                    tracing::error!(%job, reason, "the job has failed");
                    if let Err(error) = coordinator.fail(job, reason).await {
                        tracing::warn!(%job, %error, "the failure could not be written");
                        sleep(RETRY).await;
                    }
                }
            }
        });
    }

    /// Ends a job without a result, if this coordinator has the right to.
    async fn fail(&self, job: JobId, reason: String) -> Result<(), LedgerError> {
        let right = self
            .ledger
            .steward(job, &self.who, self.policy.steward_ms)
            .await?;
        if let Some(epoch) = right {
            let end = JobEnd::Failed { reason };
            self.ledger.finish(job, epoch, end).await?;
        }
        self.changed(job);
        Ok(())
    }

    /// One step of a job. Absorbing millions of results takes longer than the right to drive lasts, so it
    /// is kept meanwhile; `None` once it is lost.
    async fn step(
        &self,
        drive: &mut Drive,
        every: Duration,
        renewed: &mut Instant,
    ) -> Result<Option<Driven>, DriveError> {
        let (job, epoch) = (drive.job(), drive.epoch());
        let tools = self.tools();
        let mut stepping = std::pin::pin!(drive.step(&tools));
        loop {
            tokio::select! {
                driven = &mut stepping => return driven.map(Some),
                () = sleep_until(*renewed + every) => {}
            }
            match tools.renew_right(job, epoch).await {
                Ok(true) => {}
                Ok(false) => {
                    self.changed(job);
                    return Ok(None);
                }
                // Writes of the step are fenced by the epoch in any case.
                Err(error) => tracing::warn!(%job, %error, "the right to drive is not renewed"),
            }
            *renewed = Instant::now();
        }
    }

    /// Drives one job until it ends, another coordinator has it, or this one stops.
    async fn drive(
        &self,
        job: JobId,
        wake: &Notify,
        stop: &CancellationToken,
    ) -> Result<(), DriveError> {
        let tools = self.tools();
        let Some(mut drive) = Drive::take(&tools, job).await? else {
            return Ok(());
        };
        let renewal = Duration::from_millis(self.policy.steward_ms / 3);
        let mut renewed = Instant::now();
        // Another coordinator may have found that workers cannot fetch what they need.
        let mut is_long_silent = false;
        while !stop.is_cancelled() {
            if renewed.elapsed() >= renewal {
                if !tools.renew_right(job, drive.epoch()).await? {
                    return Ok(());
                }
                renewed = Instant::now();
            }
            let begin = Instant::now();
            if self.is_sick(job) || is_long_silent {
                is_long_silent = false;
                let mended = drive.mend(&tools).await?;
                self.recovers(job);
                self.changed(job);
                if mended == Driven::Ended {
                    return Ok(());
                }
            }
            let Some(driven) = self.step(&mut drive, renewal, &mut renewed).await? else {
                return Ok(());
            };
            match driven {
                Driven::Went => {
                    self.work.notify_waiters();
                    self.changed(job);
                }
                Driven::Ended => {
                    self.changed(job);
                    return Ok(());
                }
                Driven::Waits => {
                    pause_after(begin.elapsed()).await;
                    tokio::select! {
                        () = stop.cancelled() => {}
                        // Woken, or not: the ledger says what there is.
                        woken = timeout(LATEST_LOOK, wake.notified()) => is_long_silent = woken.is_err(),
                    }
                }
            }
        }
        // The next coordinator need not wait.
        drive.give_up(&tools).await
    }
}

/// The pause after a look that `took` so long. The clock of sleeps has milliseconds: a shorter pause is none.
async fn pause_after(took: Duration) {
    let pause = took.min(LONGEST_PAUSE);
    if pause.as_millis() > 0 {
        sleep(pause).await;
    }
}

/// Pause after the question which jobs need attention.
///
/// One answer that came late says nothing: the database was away, or started again. Only where two in turn
/// came late (`last` and `took`) is asking a load. A coordinator that died is missed after its `right` to
/// drive a job has ended; the job that it drove does not wait as long once more.
fn pause_between_looks(last: Duration, took: Duration, right: Duration) -> Duration {
    let load = last.min(took).saturating_mul(LOOK_SHARE);
    load.min(right / 2).max(LOOK)
}

/// Message of a panic.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("a panic without a message")
}

/// While it lives, this coordinator drives the job or waits to try again.
struct Attended {
    coordinator: Arc<Coordinator>,
    job: JobId,
}

impl Drop for Attended {
    fn drop(&mut self) {
        self.coordinator.drives().remove(&self.job);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_database_that_was_away_does_not_put_off_the_next_look() {
        let seconds = Duration::from_secs;
        let right = seconds(5);
        let pause = |last, took| pause_between_looks(last, took, right);
        assert_eq!(pause(Duration::ZERO, Duration::ZERO), LOOK);
        // Away for two seconds: the next look is not forty seconds later.
        assert_eq!(pause(Duration::ZERO, seconds(2)), LOOK);
        assert_eq!(pause(seconds(2), Duration::from_millis(3)), LOOK);
        // Asking takes a tenth of a second each time: every two seconds.
        let tenth = Duration::from_millis(100);
        assert_eq!(pause(tenth, tenth), seconds(2));
        // However slow it is, jobs of a coordinator that died are taken over.
        assert_eq!(pause(seconds(40), seconds(30)), right / 2);
        assert_eq!(pause(Duration::MAX, Duration::MAX), right / 2);
    }
}
