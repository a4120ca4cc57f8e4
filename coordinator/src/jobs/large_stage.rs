//! LargeStage: a stage of more paths than are held in memory, absorbed from the objects of its results.
//!
//! Twice all results are read, a chunk at a time: once to tell streamed paths from others (see
//! `solutions::streamed`), once to fetch the others, which the algorithm gets. When it tracks some again, the
//! streamed paths that may end where those do now are fetched, too. Results of any other stage are handed on as they
//! are read ([`send_all`], [`Received`]).

use super::steward::{Steward, Wanted};
use super::tools::{DriveError, Tools};
use crate::ledger::LedgerError;
use crate::ledger::identity::{ChunkId, JobId};
use crate::ledger::rows::{ChunkRow, ChunkState, ResultObject};
use crate::results::store::{Store, StoreError};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::{StageId, Work};
use cognate_solutions::streamed_targets::StreamedTargets;
use futures::{Stream, StreamExt};
use tokio::sync::mpsc;

/// Result objects that are read at once.
const READ_AHEAD: usize = 8;
/// Chunk rows that are read at once.
const PAGE: u32 = 1000;

/// Where the results of a finished chunk are.
pub fn object_of(row: ChunkRow) -> Option<ResultObject> {
    match row.state {
        ChunkState::Accepted { result, .. } | ChunkState::Failed { result } => Some(result),
        _ => None,
    }
}

/// The objects of a stage's results from item `from` on, in order, a page of them; empty at the end.
pub async fn page(
    ledger: &dyn crate::ledger::Ledger,
    job: JobId,
    stage: StageId,
    from: u64,
) -> Result<Vec<ResultObject>, LedgerError> {
    let rows = ledger.finished_chunks(job, stage, from, PAGE).await?;
    Ok(rows.into_iter().filter_map(object_of).collect())
}

/// The paths of these objects of stages that track, in their order; some are read ahead.
pub fn read<'a>(
    store: &'a Store,
    objects: Vec<ResultObject>,
) -> impl Stream<Item = Result<Vec<PathResult>, StoreError>> + 'a {
    futures::stream::iter(objects)
        .map(move |object| async move { store.paths(&object).await })
        .buffered(READ_AHEAD)
}

/// Paths of these objects, in their order, for a drive: an error about lost results names the chunk.
fn read_driven<'a>(
    tools: &'a Tools<'_>,
    job: JobId,
    stage: StageId,
    objects: Vec<ResultObject>,
) -> impl Stream<Item = Result<Vec<PathResult>, DriveError>> + 'a {
    futures::stream::iter(objects)
        .map(move |object| async move {
            let paths = tools.store.paths(&object).await;
            paths.map_err(|error| lost(job, stage, &object, error))
        })
        .buffered(READ_AHEAD)
}

fn lost(job: JobId, stage: StageId, object: &ResultObject, error: StoreError) -> DriveError {
    let chunk = ChunkId {
        job,
        stage,
        first: object.items.first,
    };
    match error.is_loss() {
        true => DriveError::LostResults {
            chunk,
            why: error.to_string(),
        },
        false => error.into(),
    }
}

/// The chunks of a stage that does this work whose results are lost.
pub async fn lost_chunks(
    tools: &Tools<'_>,
    job: JobId,
    stage: StageId,
    work: Work,
) -> Result<Vec<(ChunkId, String)>, DriveError> {
    let (mut from, mut losses) = (0, Vec::new());
    loop {
        let objects = page(tools.ledger, job, stage, from).await?;
        let Some(last) = objects.last() else {
            return Ok(losses);
        };
        from = last.items.last;
        for object in &objects {
            if let Err(error) = tools.store.results(object, work).await {
                match lost(job, stage, object, error) {
                    DriveError::LostResults { chunk, why } => losses.push((chunk, why)),
                    other => return Err(other),
                }
            }
        }
    }
}

/// Results of a complete stage, given by its number, items and work, in the order of its items.
async fn all(
    tools: &Tools<'_>,
    job: JobId,
    stage: (StageId, u64, Work),
) -> Result<Vec<ItemResult>, DriveError> {
    let (sender, mut receiver) = mpsc::channel(1);
    let collected = async move {
        let mut results = Vec::new();
        while let Some(chunk) = receiver.recv().await {
            results.extend(chunk);
        }
        results
    };
    let (sent, results) = tokio::join!(send_all(tools, job, stage, sender), collected);
    sent?;
    Ok(results)
}

/// Sends the results of a complete stage, given by its number, items and work, chunk by chunk in the order of its
/// items, until the receiver is gone; an error where results are missing.
pub async fn send_all(
    tools: &Tools<'_>,
    job: JobId,
    (stage, items, work): (StageId, u64, Work),
    to: mpsc::Sender<Vec<ItemResult>>,
) -> Result<(), DriveError> {
    // A worker was outvoted in between, and what it did is done again.
    let done_again = || DriveError::from(LedgerError::Fenced(job));
    let (mut from, mut sent) = (0, 0);
    loop {
        let objects = page(tools.ledger, job, stage, from).await?;
        let Some(last) = objects.last() else { break };
        from = last.items.last;
        let objects = futures::stream::iter(objects);
        let mut chunks = std::pin::pin!(
            objects
                .map(|object| async move {
                    let results = tools.store.results(&object, work).await;
                    results.map_err(|error| lost(job, stage, &object, error))
                })
                .buffered(READ_AHEAD)
        );
        while let Some(chunk) = chunks.next().await {
            let chunk = chunk?;
            sent += chunk.len() as u64;
            if sent > items {
                return Err(done_again());
            }
            if to.send(chunk).await.is_err() {
                return Ok(());
            }
        }
    }
    match sent == items {
        true => Ok(()),
        false => Err(done_again()),
    }
}

/// Marks that the results ended too early for the consumer to go on.
pub struct Interrupted;

/// Iterator over the results of a fixed number of items, as they are sent.
pub struct Received {
    chunks: mpsc::Receiver<Vec<ItemResult>>,
    chunk: std::vec::IntoIter<ItemResult>,
    left: u64,
}

impl Received {
    /// Iterator over the results of `items` items.
    pub fn new(chunks: mpsc::Receiver<Vec<ItemResult>>, items: u64) -> Self {
        Self {
            chunks,
            chunk: Vec::new().into_iter(),
            left: items,
        }
    }
}

impl Iterator for Received {
    type Item = ItemResult;

    /// # Panics
    /// With [`Interrupted`], and without a message, where the sender gives up: who takes a stage takes all of it or is
    /// abandoned.
    fn next(&mut self) -> Option<ItemResult> {
        while self.left > 0 {
            if let Some(result) = self.chunk.next() {
                self.left -= 1;
                return Some(result);
            }
            match self.chunks.blocking_recv() {
                Some(chunk) => self.chunk = chunk.into_iter(),
                None => std::panic::resume_unwind(Box::new(Interrupted)),
            }
        }
        None
    }
}

/// Results of a stage whose paths are named, ascending.
async fn fetch(
    tools: &Tools<'_>,
    job: JobId,
    stage: StageId,
    paths: &[u64],
) -> Result<Vec<PathResult>, DriveError> {
    let mut path_results = Vec::with_capacity(paths.len());
    let mut from = 0;
    let mut wanted = paths;
    while let Some(&next) = wanted.first() {
        let objects = page(tools.ledger, job, stage, from).await?;
        let Some(last) = objects.last() else { break };
        from = last.items.last;
        // Items of a first stage are its paths.
        let touched = objects
            .into_iter()
            .filter(|object| {
                let at = paths.partition_point(|&path| path < object.items.first);
                object.items.last > next && paths.get(at).is_some_and(|&p| p < object.items.last)
            })
            .collect();
        let mut chunks = std::pin::pin!(read_driven(tools, job, stage, touched));
        while let Some(results) = chunks.next().await {
            for result in results? {
                if wanted.first() == Some(&result.origin.0) {
                    wanted = &wanted[1..];
                    path_results.push(result);
                }
            }
        }
    }
    if path_results.len() == paths.len() {
        Ok(path_results)
    } else {
        // A worker was outvoted in between, and what it did is done again.
        Err(LedgerError::Fenced(job).into())
    }
}

/// All paths of a stage, seen one by one.
async fn see_all(
    tools: &Tools<'_>,
    job: JobId,
    stage: StageId,
    mut index: StreamedTargets,
) -> Result<(StreamedTargets, u64), DriveError> {
    let (mut from, mut seen) = (0, 0);
    loop {
        let objects = page(tools.ledger, job, stage, from).await?;
        let Some(last) = objects.last() else {
            return Ok((index, seen));
        };
        from = last.items.last;
        let mut chunks = std::pin::pin!(read_driven(tools, job, stage, objects));
        while let Some(results) = chunks.next().await {
            let results = results?;
            seen += results.len() as u64;
            index = blocking(move || {
                results.iter().for_each(|result| index.see(result));
                index
            })
            .await;
        }
    }
}

/// Runs blocking work off the async executor.
async fn blocking<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    match tokio::task::spawn_blocking(work).await {
        Ok(value) => value,
        Err(error) => std::panic::resume_unwind(error.into_panic()),
    }
}

/// State of a large first stage between two absorptions.
#[derive(Default)]
pub struct LargeStage {
    index: Option<StreamedTargets>,
}

impl LargeStage {
    /// Absorbs a complete stage of a job whose first stage is large; what the algorithm wants then.
    pub async fn absorb(
        &mut self,
        tools: &Tools<'_>,
        job: JobId,
        steward: &mut Option<Steward>,
        (stage, items, work): (StageId, u64, Work),
    ) -> Result<Wanted, DriveError> {
        const HERE: &str = "the steward is back before the step ends";
        let first = steward.as_ref().expect(HERE).first_stage();
        if stage == first {
            let index = steward.as_ref().expect(HERE).index(items);
            let (mut index, seen) = see_all(tools, job, stage, index).await?;
            if seen != items {
                return Err(LedgerError::Fenced(job).into());
            }
            let (settled, held) = blocking(move || {
                let held = index.settle();
                (index, held)
            })
            .await;
            index = settled;
            let held = fetch(tools, job, stage, &held).await?;
            tracing::info!(%job, paths = items, held = held.len(), "most paths need not be held");
            index.take_back(&held);
            let mut taken = steward.take().expect(HERE);
            let streamed = index.counts();
            let (back, wanted) = blocking(move || {
                taken.leave_out(streamed);
                let wanted = taken.absorb(stage, held.into_iter().map(ItemResult::Track));
                (taken, wanted)
            })
            .await;
            *steward = Some(back);
            self.index = Some(index);
            return Ok(wanted);
        }
        let results = all(tools, job, (stage, items, work)).await?;
        let mut index = match self.index.take() {
            Some(index) => index,
            // Another coordinator began: what it remembered is in the objects.
            None => {
                self.recall(tools, job, steward.as_ref().expect(HERE))
                    .await?
            }
        };
        // Other stages say more of ends that are held.
        let paths: Vec<PathResult> = results
            .iter()
            .filter_map(ItemResult::path)
            .cloned()
            .collect();
        let near = index.near(&paths);
        let near = fetch(tools, job, first, &near).await?;
        index.take_back(&near);
        let mut taken = steward.take().expect(HERE);
        let streamed = index.counts();
        let (back, wanted) = blocking(move || {
            taken.take_back(near, streamed);
            let wanted = taken.absorb(stage, results);
            (taken, wanted)
        })
        .await;
        *steward = Some(back);
        self.index = Some(index);
        Ok(wanted)
    }

    /// The index as it was when the algorithm's state was kept.
    async fn recall(
        &self,
        tools: &Tools<'_>,
        job: JobId,
        steward: &Steward,
    ) -> Result<StreamedTargets, DriveError> {
        let first = steward.first_stage();
        let held = steward.held_paths();
        let stages = tools.ledger.stages(job).await?;
        let paths = stages.iter().find(|stage| stage.stage == first);
        let index = steward.index(paths.map_or(0, |stage| stage.items));
        let (index, _) = see_all(tools, job, first, index).await?;
        let mut index = blocking(move || {
            let mut index = index;
            index.settle();
            index
        })
        .await;
        let results = fetch(tools, job, first, &held).await?;
        index.take_back(&results);
        Ok(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::tracker::outcome::PathOutcome;

    fn chunk(first: u64) -> Vec<ItemResult> {
        let path = |k| PathResult::untracked(k, 0, PathOutcome::Regular, Vec::new());
        let chunk = first..first + 3;
        chunk.map(|k| ItemResult::Track(path(k))).collect()
    }

    #[test]
    fn who_takes_results_that_end_too_early_does_not_go_on() {
        let taken = |chunks: u64, items: u64| {
            let (sender, receiver) = mpsc::channel(3);
            for k in 0..chunks {
                sender.try_send(chunk(3 * k)).unwrap();
            }
            drop(sender);
            let received = Received::new(receiver, items);
            std::thread::spawn(move || received.count()).join()
        };
        assert_eq!(taken(2, 6).ok(), Some(6));
        assert_eq!(taken(0, 0).ok(), Some(0));
        for (chunks, items) in [(0, 6), (1, 6), (2, 7)] {
            let cause = taken(chunks, items).unwrap_err();
            assert!(cause.is::<Interrupted>());
        }
    }
}
