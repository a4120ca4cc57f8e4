//! Fleets: as many workers in a batch system as the backlog asks for.
//!
//! The number of workers is read from the coordinator and from the batch system at each look; no state that matters is
//! kept, so that this process may end and another may continue.

pub mod arguments;
pub mod scaling;
pub mod slurm;

use super::connection::{Connection, Target};
use super::error::ClientError;
use cognate_protocol::v1;
use scaling::{Backlog, Look, Meter, Patience, Step, Wishes};
use slurm::Slurm;
use std::time::{Duration, Instant};

/// A fleet with its target and its wishes.
pub struct Fleet {
    /// Where the backlog is asked for.
    pub target: Target,
    /// The cluster in which workers run.
    pub slurm: Slurm,
    /// Least and largest number of workers, and the time in which the backlog is to be done.
    pub wishes: Wishes,
    /// Pause between two looks at the coordinator and the batch system.
    pub pause: Duration,
}

impl Fleet {
    /// Looks and acts until it is dropped.
    pub async fn keep(&self) -> ! {
        let mut state = State::default();
        loop {
            // A coordinator or a controller that is away: what runs goes on, and so do we.
            if let Err(error) = self.look(&mut state).await {
                tracing::warn!(%error, "the fleet is left as it is");
            }
            tokio::time::sleep(self.pause).await;
        }
    }

    /// Looks once at the backlog and the workers, and takes the step that follows.
    pub async fn once(&self) -> Result<(), ClientError> {
        self.look(&mut State::default()).await
    }

    async fn look(&self, state: &mut State) -> Result<(), ClientError> {
        let mut connection = Connection::open(&self.target).await?;
        let (jobs, workers) = (connection.jobs().await?, connection.workers().await?);
        let tasks = self.slurm.tasks().await?;
        let backlog = backlog(&jobs);
        state.meter.take(&workers, Instant::now());
        let look = Look {
            backlog,
            rate: state.meter.rate(),
            tasks: &tasks,
        };
        let wanted = scaling::wanted(&look, &self.wishes);
        let step = scaling::step(wanted, &tasks);
        let Backlog { jobs, items } = backlog;
        match step {
            Step::Submit(count) => {
                let now = Instant::now();
                let accepted = state.meter.accepted();
                if !state.patience.may_submit(now, tasks.len(), accepted) {
                    tracing::warn!(
                        "workers end before they have done anything: see their logs; the next try \
                         comes later"
                    );
                    return Ok(());
                }
                let id = self.slurm.submit(count).await?;
                state
                    .patience
                    .submitted(tasks.len() + count as usize, accepted);
                tracing::info!(
                    jobs,
                    items,
                    wanted,
                    array = id,
                    count,
                    "workers are submitted"
                );
            }
            Step::Withdraw(ids) => {
                self.slurm.withdraw(&ids).await?;
                tracing::info!(
                    jobs,
                    items,
                    wanted,
                    count = ids.len(),
                    "workers that have not begun are withdrawn"
                );
            }
            Step::Nothing => tracing::debug!(jobs, items, wanted, "the fleet is as it should be"),
        }
        Ok(())
    }
}

/// State that is carried from look to look; without it the fleet only learns more slowly.
#[derive(Default)]
struct State {
    meter: Meter,
    patience: Patience,
}

/// Work that is left: unfinished jobs, and their items without a result.
fn backlog(jobs: &[v1::JobOverview]) -> Backlog {
    let unfinished = |job: &&v1::JobOverview| {
        matches!(job.state(), v1::JobState::Queued | v1::JobState::Running)
    };
    let jobs: Vec<&v1::JobOverview> = jobs.iter().filter(unfinished).collect();
    Backlog {
        jobs: jobs.len() as u64,
        items: jobs
            .iter()
            .map(|job| job.items_total.saturating_sub(job.items_accepted))
            .sum(),
    }
}
