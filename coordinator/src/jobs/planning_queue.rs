//! Planning queue: how many problems are read and planned at once, and how long each may take.
//!
//! Each plan is begun in the short lane, where it ends after a small share of counted work: short plans wait
//! a few milliseconds for each plan before them, however long that one takes and however busy the machine is. A plan
//! that takes more is begun again in the quick lane, where it has a moment, and then in the slow lane. The plan is the
//! same in all of them, for no clock decides anything in it. Where the client leaves, or its time is over, counting ends.

use cognate_numeric::interruption::Interruption;
use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// The numbers by which planning is bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanningLimits {
    /// Work of a plan in the short lane, in counted operations, about one for each multiplication. Default
    /// 3,000,000, which take 3 to 10 ms: systems of up to seven unknowns and some tens of paths take less.
    pub short_work: u64,
    /// How long a plan may take in the short and the quick lane. Default 300 ms: most are made in a tenth of it.
    pub moment: Duration,
    /// How long a plan may take at all, once its turn has come. Default 60 s: twice what counting mixed
    /// cells takes at most on a slow machine.
    pub longest: Duration,
    /// How many plans may be made or waited for. Default 256: a client sends the next one again.
    pub most: usize,
    /// How many are made at once in each lane. Default: half of the machine's cores, at least 1.
    pub at_once: usize,
}

impl Default for PlanningLimits {
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
        Self {
            short_work: 3_000_000,
            moment: Duration::from_millis(300),
            longest: Duration::from_secs(60),
            most: 256,
            at_once: (cores / 2).max(1),
        }
    }
}

/// Why a problem is not planned.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanningRefusal {
    /// Too many plans are made or wait for their turn.
    #[error("{0} problems are being planned or wait for it: submit this one again later")]
    Full(usize),
    /// Planning takes longer than the limit.
    #[error(
        "planning takes longer than {} s: name a start (--start total-degree, or polyhedral, which workers \
         count) instead of auto",
        .0.as_secs()
    )]
    TooLong(Duration),
}

/// Queue that limits the planning of all problems of a coordinator.
#[derive(Debug)]
pub struct PlanningQueue {
    limits: PlanningLimits,
    short: Arc<Semaphore>,
    quick: Arc<Semaphore>,
    slow: Arc<Semaphore>,
    there: Arc<AtomicUsize>,
}

/// Place of a plan that is made or waits for its turn.
struct Place(Arc<AtomicUsize>);

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// How one attempt ended.
enum Attempt<T> {
    Done(T),
    Interrupted,
}

impl PlanningQueue {
    /// An empty queue.
    pub fn new(limits: PlanningLimits) -> Self {
        let lane = || Arc::new(Semaphore::new(limits.at_once.max(1)));
        Self {
            limits,
            short: lane(),
            quick: lane(),
            slow: lane(),
            there: Arc::default(),
        }
    }

    /// Does work off the async executor when its turn has come. It is begun up to three times where it takes longer
    /// than a moment, and must answer the same each time.
    ///
    /// # Panics
    /// When `work` panics.
    pub async fn plan<T: Send + 'static>(
        &self,
        work: impl Fn() -> T + Send + Sync + 'static,
    ) -> Result<T, PlanningRefusal> {
        let place = self.place()?;
        let work = Arc::new(work);
        let limits = &self.limits;
        let short = (&self.short, limits.short_work, limits.moment);
        let quick = (&self.quick, u64::MAX, limits.moment);
        let slow = (&self.slow, u64::MAX, limits.longest);
        for (lane, most_work, time) in [short, quick, slow] {
            let permit = Arc::clone(lane).acquire_owned().await;
            let permit = permit.expect("the lanes are never closed");
            let work = Arc::clone(&work);
            let sign = Interruption::after(most_work);
            match attempt(permit, sign, time, move || work()).await {
                Attempt::Done(value) => return Ok(value),
                Attempt::Interrupted => {}
            }
        }
        drop(place);
        Err(PlanningRefusal::TooLong(self.limits.longest))
    }

    /// Does work that cannot be interrupted off the async executor: reading a file, whose size bounds it.
    ///
    /// # Panics
    /// When `work` panics.
    pub async fn read<T: Send + 'static>(
        &self,
        is_large: bool,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, PlanningRefusal> {
        let _place = self.place()?;
        let lane = if is_large { &self.slow } else { &self.short };
        let permit = Arc::clone(lane).acquire_owned().await;
        let permit = permit.expect("the lanes are never closed");
        let working = tokio::task::spawn_blocking(move || {
            let _permit = permit;
            work()
        });
        match working.await {
            Ok(value) => Ok(value),
            Err(error) => std::panic::resume_unwind(panic_of(error)),
        }
    }

    fn place(&self) -> Result<Place, PlanningRefusal> {
        let before = self.there.fetch_add(1, Ordering::Relaxed);
        let place = Place(Arc::clone(&self.there));
        match before < self.limits.most {
            true => Ok(place),
            false => Err(PlanningRefusal::Full(before)),
        }
    }
}

/// Panic of a task that did not end by itself.
fn panic_of(error: tokio::task::JoinError) -> Box<dyn Any + Send> {
    match error.try_into_panic() {
        Ok(panic) => panic,
        Err(error) => Box::new(error.to_string()),
    }
}

/// Does work under an interruption sign, for `time` at most. Work that does not end in time keeps its permit until it
/// does.
async fn attempt<T: Send + 'static>(
    permit: OwnedSemaphorePermit,
    sign: Interruption,
    time: Duration,
    work: impl FnOnce() -> T + Send + 'static,
) -> Attempt<T> {
    let _waits = sign.when_dropped();
    let under = sign.clone();
    let mut working = tokio::task::spawn_blocking(move || {
        let _permit = permit;
        let value = under.run(work);
        // Interrupted work may have answered as if there were more than it could count.
        (!under.is_interrupted()).then_some(value)
    });
    let ended = timeout(time, &mut working).await;
    let ended = match ended {
        Ok(ended) => ended,
        Err(_) => {
            sign.interrupt();
            // Parts that cannot be interrupted are short; the caller waits no longer than as long again.
            match timeout(time, working).await {
                Ok(ended) => ended,
                Err(_) => return Attempt::Interrupted,
            }
        }
    };
    match ended {
        Ok(Some(value)) => Attempt::Done(value),
        Ok(None) => Attempt::Interrupted,
        // Results of interrupted work are incomplete and may make the next step panic.
        Err(_) if sign.is_interrupted() => Attempt::Interrupted,
        Err(error) => std::panic::resume_unwind(panic_of(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::interruption::{count_work, is_interrupted};
    use std::time::Instant;
    use tokio::sync::mpsc;

    /// Longer than any test runs.
    const FOR_EVER: Duration = Duration::from_secs(1_000_000);

    fn queue() -> PlanningQueue {
        PlanningQueue::new(PlanningLimits {
            short_work: u64::MAX,
            moment: Duration::from_millis(50),
            longest: Duration::from_millis(200),
            most: 2,
            at_once: 1,
        })
    }

    /// Counts for as long as nobody interrupts it, or so long.
    fn count(time: Duration) -> u32 {
        let begin = Instant::now();
        while begin.elapsed() < time && !is_interrupted() {
            std::thread::yield_now();
        }
        7
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn what_is_short_is_done_beside_what_is_long() {
        let queue = Arc::new(queue());
        let long = {
            let queue = Arc::clone(&queue);
            tokio::spawn(async move { queue.plan(|| count(Duration::from_secs(60))).await })
        };
        tokio::time::sleep(Duration::from_millis(100)).await;
        assert_eq!(queue.plan(|| count(Duration::ZERO)).await, Ok(7));
        let refused = PlanningRefusal::TooLong(Duration::from_millis(200));
        assert_eq!(long.await.unwrap(), Err(refused));
        // Work that takes longer than a moment is done all the same.
        let some = Duration::from_millis(80);
        assert_eq!(queue.plan(move || count(some)).await, Ok(7));
        assert_eq!(queue.there.load(Ordering::Relaxed), 0);
    }

    /// Work that is interrupted and then finds what it has impossible is begun again, as other interrupted work is.
    #[tokio::test]
    async fn a_panic_of_interrupted_work_is_no_panic() {
        let queue = PlanningQueue::new(PlanningLimits {
            short_work: 10,
            ..PlanningLimits::default()
        });
        let work = || {
            assert!(!count_work(11), "the count was cut short");
            "whole"
        };
        assert_eq!(queue.plan(work).await, Ok("whole"));
    }

    /// Plans that never end unless they are interrupted take their share of the short lane, and then the quick lane for
    /// good: a short plan and a small file are done beside them, whatever a clock says.
    #[tokio::test(flavor = "multi_thread")]
    async fn plans_without_an_end_hold_up_no_short_one() {
        let queue = Arc::new(PlanningQueue::new(PlanningLimits {
            short_work: 1000,
            moment: FOR_EVER,
            longest: FOR_EVER,
            most: 99,
            at_once: 1,
        }));
        let (begins, mut begun) = mpsc::unbounded_channel();
        let calls: Vec<_> = (0..5)
            .map(|call| {
                let (queue, begins) = (Arc::clone(&queue), begins.clone());
                let endless = move || {
                    let _ = begins.send(call);
                    while !count_work(1) {
                        std::thread::yield_now();
                    }
                };
                tokio::spawn(async move { queue.plan(endless).await })
            })
            .collect();
        // Each begins in the short lane, and one of them in the quick lane, too.
        for _ in 0..calls.len() + 1 {
            assert!(begun.recv().await.is_some());
        }
        let short = queue.plan(|| (0..900).filter(|_| count_work(1)).count());
        assert_eq!(short.await, Ok(0), "it was interrupted");
        assert_eq!(queue.read(false, || 7).await, Ok(7));
        assert!(calls.iter().all(|call| !call.is_finished()));
        // Work that takes a little more waits for the quick lane.
        for call in &calls {
            call.abort();
        }
        assert_eq!(
            queue
                .plan(|| (0..1100).filter(|_| count_work(1)).count())
                .await,
            Ok(0)
        );
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn whoever_leaves_ends_what_he_asked_for() {
        let queue = Arc::new(queue());
        let ended = Arc::new(AtomicUsize::new(0));
        let calls: Vec<_> = (0..2)
            .map(|_| {
                let (queue, ended) = (Arc::clone(&queue), Arc::clone(&ended));
                let work = move || {
                    count(Duration::from_secs(60));
                    ended.fetch_add(1, Ordering::Relaxed);
                };
                tokio::spawn(async move { queue.plan(work).await })
            })
            .collect();
        tokio::time::sleep(Duration::from_millis(20)).await;
        let full = queue.plan(|| count(Duration::ZERO)).await;
        assert_eq!(full, Err(PlanningRefusal::Full(2)));
        for call in &calls {
            call.abort();
        }
        for call in calls {
            assert!(call.await.unwrap_err().is_cancelled());
        }
        assert_eq!(queue.plan(|| count(Duration::ZERO)).await, Ok(7));
        assert!(ended.load(Ordering::Relaxed) >= 1);
    }
}
