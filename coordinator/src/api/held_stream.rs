//! Held stream: answers that hold memory until they are read, and only so long.
//!
//! A stream that is opened and not read keeps its memory. So the number of open streams is limited, and a stream that
//! nobody reads for a while is dropped; a reader that returns gets the reason as an error.

use futures::Stream;
use futures::stream::BoxStream;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, sleep, timeout};
use tonic::Status;

/// A stream of answers.
type Answers<T> = BoxStream<'static, Result<T, Status>>;

/// Limits of the streams of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamLimits {
    /// Streams that are open at once. Default 16: each holds 50 MB at most.
    pub open: usize,
    /// Time after which a stream that is not read is dropped. Default 60 s.
    pub idle: Duration,
    /// Time that the next stream waits for a free place. Default 20 s.
    pub patience: Duration,
}

impl Default for StreamLimits {
    fn default() -> Self {
        Self {
            open: 16,
            idle: Duration::from_secs(60),
            patience: Duration::from_secs(20),
        }
    }
}

/// The streams that are open.
#[derive(Debug)]
pub struct HeldStreams {
    limits: StreamLimits,
    open: Arc<Semaphore>,
}

/// The right to open one.
pub struct Turn {
    permit: OwnedSemaphorePermit,
    idle: Duration,
}

impl HeldStreams {
    /// None is open.
    pub fn new(limits: StreamLimits) -> Self {
        Self {
            limits,
            open: Arc::new(Semaphore::new(limits.open.max(1))),
        }
    }

    /// Waits until one more may be open: before anything is read for it.
    pub async fn turn(&self) -> Result<Turn, Status> {
        let open = Arc::clone(&self.open);
        match timeout(self.limits.patience, open.acquire_owned()).await {
            Ok(Ok(permit)) => Ok(Turn {
                permit,
                idle: self.limits.idle,
            }),
            _ => Err(Status::unavailable(format!(
                "{} streams of results are open: read them, or ask again later",
                self.limits.open
            ))),
        }
    }
}

impl Turn {
    /// The stream, for as long as it is read.
    pub fn hold<T: Send + 'static>(self, answers: Answers<T>) -> Answers<T> {
        let state = Arc::new(Mutex::new(State {
            held: Some((answers, self.permit)),
            ended: false,
            read: Instant::now(),
            is_awaited: false,
        }));
        tokio::spawn(drop_when_idle(Arc::downgrade(&state), self.idle));
        Box::pin(Held(state))
    }
}

struct State<T> {
    held: Option<(Answers<T>, OwnedSemaphorePermit)>,
    ended: bool,
    read: Instant,
    /// The reader waits for us, and not the other way round.
    is_awaited: bool,
}

struct Held<T>(Arc<Mutex<State<T>>>);

fn lock<T>(state: &Mutex<State<T>>) -> MutexGuard<'_, State<T>> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

async fn drop_when_idle<T>(state: Weak<Mutex<State<T>>>, idle: Duration) {
    loop {
        sleep(idle / 4).await;
        let Some(state) = state.upgrade() else {
            return;
        };
        let mut state = lock(&state);
        if state.held.is_none() {
            return;
        }
        if !state.is_awaited && state.read.elapsed() >= idle {
            tracing::info!("a stream of results that nobody reads is dropped");
            state.held = None;
            return;
        }
    }
}

impl<T> Stream for Held<T> {
    type Item = Result<T, Status>;

    fn poll_next(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        let mut state = lock(&self.0);
        state.read = Instant::now();
        if state.ended {
            return Poll::Ready(None);
        }
        let Some((answers, _)) = &mut state.held else {
            state.ended = true;
            let why = "the stream was not read for too long: ask again";
            return Poll::Ready(Some(Err(Status::aborted(why))));
        };
        let next = answers.as_mut().poll_next(cx);
        state.is_awaited = next.is_pending();
        if let Poll::Ready(None) = next {
            state.ended = true;
            state.held = None;
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures::StreamExt;

    fn numbers() -> Answers<u32> {
        Box::pin(futures::stream::iter((0..3).map(Ok)))
    }

    const LIMITS: StreamLimits = StreamLimits {
        open: 1,
        idle: Duration::from_millis(200),
        patience: Duration::from_millis(50),
    };

    #[tokio::test]
    async fn what_nobody_reads_is_dropped_and_makes_room() {
        let streams = HeldStreams::new(LIMITS);
        let mut unread = streams.turn().await.unwrap().hold(numbers());
        assert_eq!(unread.next().await.unwrap().unwrap(), 0);
        assert!(streams.turn().await.is_err(), "it is open still");
        sleep(Duration::from_millis(300)).await;
        let read = streams.turn().await.unwrap().hold(numbers());
        let read: Vec<u32> = read.map(Result::unwrap).collect().await;
        assert_eq!(read, [0, 1, 2]);
        let end = unread.next().await.unwrap();
        assert_eq!(end.unwrap_err().code(), tonic::Code::Aborted);
        assert!(unread.next().await.is_none());
    }

    #[tokio::test]
    async fn whoever_waits_for_us_is_no_idler() {
        let streams = HeldStreams::new(LIMITS);
        let slow = Box::pin(futures::stream::once(async {
            sleep(Duration::from_millis(500)).await;
            Ok(7u32)
        }));
        let mut slow = streams.turn().await.unwrap().hold(slow as Answers<u32>);
        assert_eq!(slow.next().await.unwrap().unwrap(), 7);
    }
}
