//! Arbitration: an item on which executions of a chunk differ, or whose result cannot be right, is done by the
//! coordinator itself.
//!
//! Items are pure, so that whoever found something else computed wrongly, however many names it has. Comes
//! in: the disputes that the ledger knows, and results in doubt. Goes out: votes that are struck, workers that
//! are evicted.

use super::{Coordinator, CoordinatorError, job_row};
use crate::chunks::plausibility::Doubt;
use crate::ledger::identity::{JobId, LeaseId};
use crate::ledger::rows::{Dispute, Strike, Vote};
use crate::measures::ChunkEvent;
use crate::results::store::Store;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::work::Stage;
use cognate_protocol::records;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::sleep;
use tokio_util::sync::CancellationToken;

/// So often is asked whether there are disputes.
const LOOK: Duration = Duration::from_secs(1);

/// What became of results in doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ruling {
    /// The coordinator found the same.
    Right,
    /// The coordinator found something else.
    Wrong,
    /// The coordinator could not find out.
    Undecided,
}

/// A vote, and what it found for each item.
type Statement = (Vote, Vec<ItemResult>);

impl Coordinator {
    /// Settles disputes until it is told to stop.
    pub(super) async fn run_arbitration(self: Arc<Self>, stop: CancellationToken) {
        loop {
            if let Err(error) = self.settle_disputes().await {
                tracing::warn!(%error, "disputes could not be looked at");
            }
            tokio::select! {
                () = stop.cancelled() => return,
                () = sleep(LOOK) => {}
            }
        }
    }

    /// Looks at the disputes that there are now; how many votes were struck.
    pub async fn settle_disputes(&self) -> Result<usize, CoordinatorError> {
        let mut struck = 0;
        for dispute in self.ledger.disputes().await? {
            let chunk = dispute.chunk.chunk;
            match self.settle(dispute).await {
                Ok(votes) => struck += votes,
                Err(error) => tracing::warn!(job = %chunk.job, first = chunk.first, %error,
                    "workers found different things for a chunk, and nobody could decide yet"),
            }
        }
        Ok(struck)
    }

    async fn settle(&self, dispute: Dispute) -> Result<usize, CoordinatorError> {
        let (chunk, items) = (dispute.chunk.chunk, dispute.chunk.items);
        let stage = self.stage(chunk.job, chunk.stage).await?;
        let mut struck = 0;
        let mut statements: Vec<Statement> = Vec::new();
        for vote in dispute.votes {
            let lease = LeaseId {
                chunk,
                epoch: vote.epoch,
            };
            let object = Store::voted_results(lease, items, vote.hash);
            match self.store.results(&object, stage.work).await {
                Ok(results) => statements.push((vote, results)),
                Err(error) if error.is_loss() => {
                    tracing::warn!(%lease, %error, "what a worker found is lost: the chunk is done again");
                    self.ledger.strike(lease, Strike::Lost).await?;
                    struck += 1;
                }
                Err(error) => return Err(error.into()),
            }
        }
        if let Some(place) = first_difference(&statements) {
            let item = items.first + place as u64;
            let truth = self.compute(chunk.job, Arc::clone(&stage), item).await?;
            let truth = records::encode([&truth]);
            for (vote, results) in &statements {
                if records::encode([&results[place]]) == truth {
                    continue;
                }
                let lease = LeaseId {
                    chunk,
                    epoch: vote.epoch,
                };
                tracing::error!(%lease, worker = %vote.worker, credential = %vote.credential, item,
                    "a worker computes wrongly: it gets no more work");
                self.events.count(ChunkEvent::Struck, 1);
                self.ledger.strike(lease, Strike::Wrong).await?;
                struck += 1;
            }
        }
        if struck > 0 {
            self.work.notify_waiters();
            self.wake_steward(chunk.job);
            self.changed(chunk.job);
        }
        Ok(struck)
    }

    /// Whether a result that cannot be right is what its item gives.
    pub(super) async fn ruling(
        &self,
        lease: LeaseId,
        stage: &Arc<Stage>,
        doubt: &Doubt,
        results: &[ItemResult],
    ) -> Ruling {
        let item = lease.chunk.first + doubt.place as u64;
        let truth = self.compute(lease.chunk.job, Arc::clone(stage), item);
        match truth.await {
            Ok(truth) => {
                let said = records::encode([&results[doubt.place]]);
                match said == records::encode([&truth]) {
                    true => Ruling::Right,
                    false => Ruling::Wrong,
                }
            }
            Err(error) => {
                tracing::warn!(%lease, item, %error, "the coordinator could not do an item itself");
                Ruling::Undecided
            }
        }
    }

    /// One item of a stage, done here; one at a time.
    async fn compute(
        &self,
        job: JobId,
        stage: Arc<Stage>,
        item: u64,
    ) -> Result<ItemResult, CoordinatorError> {
        let _turn = self.arbitration.lock().await;
        let digest = match stage.system {
            Some(digest) => digest,
            None => job_row(&*self.ledger, job).await?.asked.problem,
        };
        let system = self.problem(digest).await?;
        let points = match stage.start_points.object() {
            Some(object) => {
                let bytes = self.store.get(object).await?;
                let read = StoredPoints::from_bytes(&bytes);
                let read = read.map_err(|error| CoordinatorError::Problem(error.to_string()))?;
                Some(Arc::new(read))
            }
            None => None,
        };
        let compute = move || {
            let prepared = PreparedWork::new(&system, &stage, &|_| points.clone())
                .map_err(|error| CoordinatorError::Problem(error.to_string()))?;
            let mut results = prepared.run(item..item + 1, 1);
            Ok(results.pop().expect("one result for one item"))
        };
        match tokio::task::spawn_blocking(compute).await {
            Ok(done) => done,
            Err(error) => Err(CoordinatorError::Problem(error.to_string())),
        }
    }
}

/// The first item for which not all found the same.
fn first_difference(statements: &[Statement]) -> Option<usize> {
    let ((_, first), others) = statements.split_first()?;
    (0..first.len()).find(|&place| {
        let expected = records::encode([&first[place]]);
        let differs = |(_, results): &Statement| records::encode([&results[place]]) != expected;
        others.iter().any(differs)
    })
}
