//! Arbitration: an item on which executions of a chunk differ, or whose result cannot be right, is done by the
//! coordinator itself.
//!
//! Items are pure, so a worker with another result computed wrongly, however many names it has. Input: the disputes
//! that the ledger knows, and results in doubt. Output: votes that are struck, workers that are evicted.

use super::{Coordinator, CoordinatorError};
use crate::chunks::plausibility::Doubt;
use crate::ledger::identity::{ChunkId, JobId, LeaseId, WorkerId};
use crate::ledger::rows::{ChunkState, Dispute, Strike, Vote};
use crate::measures::ChunkEvent;
use crate::results::store::Store;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::Stage;
use cognate_protocol::records;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::sleep;
use tokio_util::sync::CancellationToken;

/// Interval at which the ledger is asked for disputes.
const LOOK: Duration = Duration::from_secs(1);

/// Outcome of the check of results in doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ruling {
    /// The coordinator found the same.
    Right,
    /// The coordinator found something else.
    Wrong,
    /// The coordinator could not find out.
    Undecided,
}

/// The ruling on the results of a chunk.
pub struct Judgement {
    /// The ruling.
    pub ruling: Ruling,
    /// The doubt that decided it, where results are wrong or nobody could find out.
    pub doubt: Option<Doubt>,
}

/// A vote, and what it found for each item.
type Statement = (Vote, Vec<ItemResult>);

/// Most results in doubt of one chunk that the coordinator does itself, drawn by the ledger's secret: one that is wrong
/// is enough.
pub const MOST_RULED: usize = 4;

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

    /// Rules on results in doubt by doing some of their items, which no worker can foresee.
    pub(super) async fn judge_doubts(
        &self,
        lease: LeaseId,
        stage: &Arc<Stage>,
        mut doubts: Vec<Doubt>,
        results: &[ItemResult],
    ) -> Result<Judgement, CoordinatorError> {
        let key = self.audit_key().await?;
        doubts.sort_by_key(|doubt| key.rank(lease.chunk, doubt.place));
        for doubt in doubts.into_iter().take(MOST_RULED) {
            let ruling = self.ruling(lease, stage, &doubt, results).await;
            if ruling != Ruling::Right {
                let doubt = Some(doubt);
                return Ok(Judgement { ruling, doubt });
            }
        }
        Ok(Judgement {
            ruling: Ruling::Right,
            doubt: None,
        })
    }

    /// Whether a result that cannot be right is what its item gives.
    async fn ruling(
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

    /// Rules on results that came late and differ from the accepted ones: the coordinator does the first item
    /// in which they differ, and each worker that was wrong is evicted.
    pub(super) async fn settle_late(
        &self,
        lease: LeaseId,
        by: &WorkerId,
        late: Vec<ItemResult>,
    ) -> Result<(), CoordinatorError> {
        let ChunkId { job, stage, first } = lease.chunk;
        let rows = self.ledger.finished_chunks(job, stage, first, 1).await?;
        let accepted = rows.into_iter().find(|row| row.chunk == lease.chunk);
        let Some(ChunkState::Accepted { worker, result }) = accepted.map(|row| row.state) else {
            return Ok(());
        };
        let definition = self.stage(job, stage).await?;
        let earlier = self.store.results(&result, definition.work).await?;
        let record = |results: &[ItemResult], place: usize| records::encode([&results[place]]);
        let shared = earlier.len().min(late.len());
        let Some(place) =
            (0..shared).find(|&place| record(&earlier, place) != record(&late, place))
        else {
            return Ok(());
        };
        let item = first + place as u64;
        let truth = records::encode([&self.compute(job, definition, item).await?]);
        for (worker, results) in [(&worker, &earlier), (by, &late)] {
            if record(results, place) == truth {
                continue;
            }
            tracing::error!(%lease, %worker, item,
                "a worker computes wrongly, which a late report has shown: it gets no more work");
            self.events.count(ChunkEvent::Struck, 1);
            self.ledger.evict(worker).await?;
        }
        self.work.notify_waiters();
        self.wake_steward(job);
        self.changed(job);
        Ok(())
    }

    /// One item of a stage, done here; one at a time.
    async fn compute(
        &self,
        job: JobId,
        stage: Arc<Stage>,
        item: u64,
    ) -> Result<ItemResult, CoordinatorError> {
        let _turn = self.arbitration.lock().await;
        let prepared = self.prepared(job, &stage).await?;
        let compute = move || {
            let mut results = prepared.run(item..item + 1, 1);
            results.pop().expect("one result for one item")
        };
        match tokio::task::spawn_blocking(compute).await {
            Ok(done) => Ok(done),
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
