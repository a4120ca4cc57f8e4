//! Shell: carries the session's commands out, with a clock, tasks and a transport.
//!
//! Every call is a task of its own on the I/O runtime and every chunk runs on
//! the tracking threads, so that neither can starve a renewal.

use crate::chunk_runner::{Abandonment, ChunkEnd, ChunkRunner, TrackedChunk};
use crate::config::Config;
use crate::machine::{Machine, UnfitMachine};
use crate::problem_cache::{PrepareFailure, ProblemCache};
use crate::retry::{Backoff, Moment};
use crate::session::{Command, Ending, Grant, Input, Limits, Session};
use crate::transport::connect::UnusableAddress;
use crate::transport::grpc::Grpc;
use crate::transport::route::{Route, Services};
use crate::transport::{Announcement, Lease, LeaseId, Receipt, Transport, TransportError};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::mpsc;
use tokio::task::{AbortHandle, JoinSet};
use tokio_util::sync::CancellationToken;

/// Attempts to fetch a chunk's stage after which the chunk goes back: about 12 s.
const MOST_FETCHES: u32 = 10;
/// Longest time between two calls of a worker without free slots.
const HEARTBEAT: Duration = Duration::from_secs(10);

/// Longest wait for work where there are several coordinators: an idle worker may lose this time, and the time for an
/// answer, to a coordinator that stands still.
const POLL_OF_SEVERAL: Duration = Duration::from_secs(2);

/// Why a worker did not begin.
#[derive(Debug, thiserror::Error)]
pub enum WorkerError {
    /// The machine must not track.
    #[error(transparent)]
    UnfitMachine(#[from] UnfitMachine),
    /// The tracking threads could not be started.
    #[error("the tracking threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// An address that nothing can connect to.
    #[error(transparent)]
    Address(#[from] UnusableAddress),
}

/// Works for the coordinators that the configuration names, until something ends it.
///
/// `shutdown` makes it stop pulling, give back what is unfinished and return.
pub async fn run(config: Config, shutdown: CancellationToken) -> Result<Ending, WorkerError> {
    let announcement = announcement(&config);
    announcement.machine.check()?;
    let transport = Arc::new(Grpc::new(&config, &announcement)?);
    run_over(config, announcement, transport, shutdown).await
}

/// Works for a coordinator of this process, until `shutdown` makes it give back what is unfinished and return.
pub async fn run_in_process(
    config: Config,
    services: Services,
    shutdown: CancellationToken,
) -> Result<Ending, WorkerError> {
    let announcement = announcement(&config);
    let routes = vec![Route::in_process(services)];
    let transport = Arc::new(Grpc::over(routes, config.message_bytes, &announcement));
    run_over(config, announcement, transport, shutdown).await
}

/// Description of this process that is sent with its pulls.
fn announcement(config: &Config) -> Announcement {
    let machine = Machine::detect();
    Announcement {
        worker: format!("{}-{}", machine.host, std::process::id()),
        session: uuid::Uuid::new_v4().to_string(),
        machine,
        threads: config.threads,
        lane_width: config.lane_width.map_or(16, |width| width.lanes()),
    }
}

/// [`run`] with a transport that is there already.
pub async fn run_over(
    config: Config,
    announcement: Announcement,
    transport: Arc<dyn Transport>,
    shutdown: CancellationToken,
) -> Result<Ending, WorkerError> {
    announcement.machine.check()?;
    let width = config.lane_width.map(|width| width.lanes());
    let runner = ChunkRunner::new(config.threads, width)?;
    tracing::info!(
        worker = announcement.worker,
        threads = runner.threads(),
        instruction_set = announcement.machine.instruction_set.name(),
        "working"
    );
    let (sender, receiver) = mpsc::unbounded_channel();
    let limits = limits(&config);
    let shell = Shell {
        begin: Instant::now(),
        transport,
        runner: Arc::new(runner),
        cache: Arc::new(ProblemCache::new(config.prepared_stages)),
        backoff: limits.backoff,
        sender,
        calls: JoinSet::new(),
        pull: None,
        leases: HashMap::new(),
    };
    let ending = shell.live(Session::new(limits, Moment::default()), receiver, shutdown);
    let ending = ending.await;
    tracing::info!(worker = announcement.worker, ?ending, "ended");
    Ok(ending)
}

fn limits(config: &Config) -> Limits {
    Limits {
        chunks_at_once: config.chunks_at_once,
        unacknowledged: config.unacknowledged,
        // One of several coordinators that stands still takes the call and says nothing.
        poll: match config.coordinators.len() {
            0 | 1 => config.poll,
            _ => config.poll.min(POLL_OF_SEVERAL),
        },
        heartbeat: HEARTBEAT,
        end: config.wall_time.map(Moment),
        wind_up: config.wind_up,
        idle_timeout: config.idle_timeout,
        give_up_after: config.give_up_after,
        drain_patience: config.drain_patience,
        backoff: Backoff::default(),
    }
}

type SessionInput = Input<TrackedChunk>;

/// A chunk that the session knows, and the means to call it off.
struct Leased {
    lease: Lease,
    abandonment: Abandonment,
}

struct Shell {
    begin: Instant,
    transport: Arc<dyn Transport>,
    runner: Arc<ChunkRunner>,
    cache: Arc<ProblemCache>,
    backoff: Backoff,
    sender: mpsc::UnboundedSender<(SessionInput, Vec<Lease>)>,
    calls: JoinSet<()>,
    pull: Option<AbortHandle>,
    leases: HashMap<LeaseId, Leased>,
}

impl Shell {
    fn now(&self) -> Moment {
        Moment(self.begin.elapsed())
    }

    async fn live(
        mut self,
        mut session: Session<TrackedChunk>,
        mut receiver: mpsc::UnboundedReceiver<(SessionInput, Vec<Lease>)>,
        shutdown: CancellationToken,
    ) -> Ending {
        let mut told_to_stop = false;
        loop {
            for command in session.poll(self.now()) {
                if let Command::Exit(ending) = command {
                    return ending;
                }
                self.carry_out(command);
            }
            let wake = session.wake_at().map(|moment| self.begin + moment.0);
            let sleep = async {
                match wake {
                    Some(instant) => tokio::time::sleep_until(instant.into()).await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                // The clock comes first: a process that was frozen fences itself before it
                // believes an answer from before.
                biased;
                () = sleep => {}
                () = shutdown.cancelled(), if !told_to_stop => {
                    told_to_stop = true;
                    session.handle(Input::Drain, self.now());
                }
                message = receiver.recv() => {
                    let (input, leases) = message.expect("the shell itself keeps a sender");
                    self.take_note(&input, leases);
                    session.handle(input, self.now());
                }
                Some(_) = self.calls.join_next() => {}
            }
        }
    }

    /// Remembers what was leased and forgets what is done with.
    fn take_note(&mut self, input: &SessionInput, leases: Vec<Lease>) {
        for lease in leases {
            let id = lease.id.clone();
            self.leases.entry(id).or_insert_with(|| Leased {
                lease,
                abandonment: Abandonment::default(),
            });
        }
        match input {
            Input::Reported(lease, receipt) => {
                self.leases.remove(lease);
                match receipt {
                    Receipt::Accepted | Receipt::AlreadyAccepted => {
                        tracing::debug!(%lease, "accepted");
                    }
                    Receipt::Stale => tracing::warn!(%lease, "reported too late; dropped"),
                    Receipt::HashDiffers => {
                        tracing::error!(%lease, "other results are there for this lease");
                    }
                    Receipt::Invalid(why) => tracing::error!(%lease, why, "report refused"),
                }
            }
            Input::GaveBack(lease) => {
                self.leases.remove(lease);
            }
            Input::Untrackable(lease, why) => {
                tracing::error!(%lease, why, "cannot be tracked here")
            }
            Input::Unfetched(lease, why) => {
                tracing::warn!(%lease, why, "given back: what it needs cannot be fetched")
            }
            Input::Refused(why) => {
                tracing::error!(why, "the coordinator gives this worker no work")
            }
            Input::Renewed(renewals) => {
                for (lease, renewal) in renewals {
                    if *renewal == crate::transport::Renewal::Lost {
                        tracing::debug!(%lease, "lost");
                    }
                }
            }
            _ => {}
        }
    }

    fn carry_out(&mut self, command: Command<TrackedChunk>) {
        let transport = Arc::clone(&self.transport);
        match command {
            Command::Pull {
                sequence,
                free,
                wait,
            } => {
                let sender = self.sender.clone();
                let handle = self.calls.spawn(async move {
                    let answer = transport.pull(sequence, free, wait).await;
                    // The receiver is gone only when the worker has ended.
                    let _ = sender.send(pulled(answer));
                });
                self.pull = Some(handle);
            }
            Command::CancelPull => {
                if let Some(pull) = self.pull.take() {
                    pull.abort();
                }
            }
            Command::Renew(leases) => self.call(async move {
                match transport.renew(&leases).await {
                    Ok(renewals) => Input::Renewed(leases.into_iter().zip(renewals).collect()),
                    Err(error) => {
                        tracing::warn!(%error, "leases not renewed");
                        Input::RenewFailed
                    }
                }
            }),
            Command::Report(lease, chunk) => self.call(async move {
                match transport.report(&lease, &chunk).await {
                    Ok(receipt) => Input::Reported(lease, receipt),
                    Err(TransportError::Refused(why)) => {
                        Input::Reported(lease, Receipt::Invalid(why))
                    }
                    Err(error) => {
                        tracing::warn!(%lease, %error, "not reported yet");
                        Input::ReportFailed(lease)
                    }
                }
            }),
            Command::GiveBack(lease, why) => self.call(async move {
                let one = std::slice::from_ref(&lease);
                match transport.give_back(one, &why).await {
                    // Refused: it is no longer ours to give.
                    Ok(()) | Err(TransportError::Refused(_)) => Input::GaveBack(lease),
                    Err(error) => {
                        tracing::warn!(%lease, %error, "not given back yet");
                        Input::GiveBackFailed(lease)
                    }
                }
            }),
            Command::Leave => self.call(async move {
                if let Err(error) = transport.leave().await {
                    tracing::debug!(%error, "left without goodbye");
                }
                Input::Left
            }),
            Command::Track(lease) => self.track(&lease),
            Command::Abandon(lease) => {
                tracing::info!(%lease, "left alone");
                if let Some(leased) = self.leases.get(&lease) {
                    leased.abandonment.abandon();
                }
                self.leases.remove(&lease);
            }
            Command::Exit(_) => unreachable!("the loop above ends with it"),
        }
    }

    fn call(&mut self, call: impl Future<Output = SessionInput> + Send + 'static) {
        let sender = self.sender.clone();
        self.calls.spawn(async move {
            let input = call.await;
            // The receiver is gone only when the worker has ended.
            let _ = sender.send((input, Vec::new()));
        });
    }

    fn track(&mut self, id: &LeaseId) {
        let Some(leased) = self.leases.get(id) else {
            return;
        };
        let (lease, abandonment) = (leased.lease.clone(), leased.abandonment.clone());
        let (transport, cache) = (Arc::clone(&self.transport), Arc::clone(&self.cache));
        let (runner, sender) = (Arc::clone(&self.runner), self.sender.clone());
        let backoff = self.backoff;
        self.calls.spawn(async move {
            let mut failures = 0;
            let tracker = loop {
                match cache.tracker(&*transport, &lease).await {
                    Ok(tracker) if lease.items.end <= tracker.items() => break tracker,
                    Ok(tracker) => {
                        let (end, items) = (lease.items.end, tracker.items());
                        let why = format!("the chunk ends at item {end}, the stage has {items}");
                        let _ = sender.send((Input::Untrackable(lease.id, why), Vec::new()));
                        return;
                    }
                    Err(PrepareFailure::Untrackable(why)) => {
                        let _ = sender.send((Input::Untrackable(lease.id, why), Vec::new()));
                        return;
                    }
                    Err(PrepareFailure::Unavailable(error)) => {
                        failures += 1;
                        tracing::warn!(lease = %lease.id, %error, "stage not fetched yet");
                        if failures >= MOST_FETCHES {
                            // Nobody's fault but the storage's; other jobs may fare better.
                            let input = Input::Unfetched(lease.id, error.to_string());
                            let _ = sender.send((input, Vec::new()));
                            return;
                        }
                        tokio::time::sleep(backoff.pause(failures)).await;
                    }
                }
                if abandonment.is_abandoned() {
                    return;
                }
            };
            tracing::debug!(lease = %lease.id, items = ?lease.items, "tracking");
            let id = lease.id;
            runner.start(tracker, lease.items, abandonment, move |end| {
                let input = match end {
                    ChunkEnd::Tracked(chunk) => Input::Tracked(id, chunk),
                    ChunkEnd::Panicked(why) => {
                        Input::Untrackable(id, format!("the tracker panicked: {why}"))
                    }
                    ChunkEnd::Abandoned => return,
                };
                let _ = sender.send((input, Vec::new()));
            });
        });
    }
}

impl Drop for Shell {
    /// An embedded worker's threads stop, too.
    fn drop(&mut self) {
        for leased in self.leases.values() {
            leased.abandonment.abandon();
        }
    }
}

/// Translates the answer to a pull into an input of the session and its leases.
fn pulled(answer: Result<crate::transport::Pulled, TransportError>) -> (SessionInput, Vec<Lease>) {
    match answer {
        Ok(answer) if answer.refused.is_some() => (
            Input::Refused(answer.refused.unwrap_or_default()),
            Vec::new(),
        ),
        // The coordinator is about to stop. The worker soon asks again, this coordinator or another one.
        Ok(answer) if answer.draining && answer.leases.is_empty() => {
            (Input::PullFailed, Vec::new())
        }
        Ok(answer) => {
            let grants = answer.leases.iter().map(|lease| Grant {
                lease: lease.id.clone(),
                lasts: lease.lasts,
                alone: lease.alone,
            });
            (Input::Pulled(grants.collect()), answer.leases)
        }
        Err(error) => {
            tracing::warn!(%error, "no answer from the coordinator");
            (Input::PullFailed, Vec::new())
        }
    }
}

#[cfg(test)]
mod tests;
