//! Result check: what a coordinator finds out about reported results by itself, before it accepts them.
//!
//! The results of a chunk come in. Doubts go out: results that are not what their items give, or may not be. The stage is
//! compiled once for all reports of its chunks.

use super::{Coordinator, CoordinatorError, job_row};
use crate::chunks::audit::AuditKey;
use crate::chunks::plausibility::{Doubt, EndCheck, is_nonregular_end};
use crate::ledger::identity::{ChunkId, JobId, LeaseId};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_check::PreparedCheck;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::Stage;
use cognate_numeric::NUMERICS_REVISION;
use cognate_systems::system::System;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::OnceCell;

/// Results that are checked between two looks at the clock.
const PIECE: usize = 64;
/// A chunk is checked for at most this time. Less than the two minutes that a worker waits for the answer to a report; more
/// than a chunk of a worker with four threads takes (`Sizing::longest_ms`), where results are checked by doing the items again.
const LONGEST_CHECK: Duration = Duration::from_secs(12);

/// Compiles a stage of a system, with a function that finds stored points.
type Compile<P> =
    fn(&System, &Stage, &dyn Fn(Digest) -> Option<Arc<StoredPoints>>) -> Result<P, PrepareError>;

/// Results of a chunk after they were checked.
pub(super) struct CheckedResults {
    /// The results, as they were reported.
    pub results: Vec<ItemResult>,
    /// Results that cannot be right, or may not be, in the order of the items.
    pub doubts: Vec<Doubt>,
    /// True where nothing but the doubts can be wrong, as far as a coordinator can tell. False where results are of a
    /// kind that is not checked, as ends that are not regular, or where the check took too long.
    pub is_complete: bool,
}

impl Coordinator {
    /// Checks the results that are reported for a chunk.
    pub(super) async fn check_results(
        &self,
        lease: LeaseId,
        stage: &Arc<Stage>,
        results: Vec<ItemResult>,
    ) -> Result<CheckedResults, CoordinatorError> {
        let chunk = lease.chunk;
        let end_check = self.end_check(chunk, stage).await?;
        let mut prepared_check = None;
        let is_wanted = self.policy.check_results;
        if is_wanted && stage.work.has_checkable_results() {
            match self.prepared_check(chunk.job, stage).await {
                Ok(check) => prepared_check = Some(check),
                Err(error) => {
                    tracing::warn!(%lease, %error, "results could not be checked: other workers confirm them");
                }
            }
        }
        let key = self.audit_key().await?;
        let check = move || {
            let mut doubts = match end_check.as_ref() {
                Some(end_check) => end_check.doubts(&results),
                None => Vec::new(),
            };
            let mut is_complete = !is_wanted;
            if let Some(prepared) = prepared_check {
                let places;
                (places, is_complete) = doubtful_places(&prepared, key, chunk, &results);
                for place in places {
                    if !doubts.iter().any(|doubt| doubt.place == place) {
                        doubts.push(Doubt::not_confirmed(place, &results[place]));
                    }
                }
                doubts.sort_by_key(|doubt| doubt.place);
            }
            CheckedResults {
                is_complete: is_complete && !results.iter().any(is_nonregular_end),
                results,
                doubts,
            }
        };
        match tokio::task::spawn_blocking(check).await {
            Ok(checked) => Ok(checked),
            Err(error) => std::panic::resume_unwind(error.into_panic()),
        }
    }

    /// The evaluation of a stage's equations at ends; none where that cannot be done.
    async fn end_check(
        &self,
        chunk: ChunkId,
        stage: &Stage,
    ) -> Result<Arc<Option<EndCheck>>, CoordinatorError> {
        let key = (chunk.job, chunk.stage);
        if let Some(check) = self.end_checks.get(&key) {
            return Ok(check);
        }
        let row = job_row(&*self.ledger, chunk.job).await?;
        let digest = stage.system.unwrap_or(row.asked.problem);
        let system = self.problem(digest).await?;
        let check = Arc::new(EndCheck::of(&system, stage));
        self.end_checks.keep(key, Arc::clone(&check));
        Ok(check)
    }

    /// A stage, ready for results to be checked here. Reports that come meanwhile wait for the same one.
    async fn prepared_check(
        &self,
        job: JobId,
        stage: &Arc<Stage>,
    ) -> Result<Arc<PreparedCheck>, CoordinatorError> {
        let key = (job, stage.id);
        let prepared = self.prepared_checks.get_or_keep(key, OnceCell::new);
        let prepare = || self.prepare(job, Arc::clone(stage), PreparedCheck::new);
        Ok(Arc::clone(prepared.get_or_try_init(prepare).await?))
    }

    /// A stage, ready for its items to be done here.
    pub(super) async fn prepared(
        &self,
        job: JobId,
        stage: &Arc<Stage>,
    ) -> Result<Arc<PreparedWork>, CoordinatorError> {
        let key = (job, stage.id);
        let prepared = self.prepared.get_or_keep(key, OnceCell::new);
        let prepare = || self.prepare(job, Arc::clone(stage), PreparedWork::new);
        Ok(Arc::clone(prepared.get_or_try_init(prepare).await?))
    }

    /// Reads the system and the start points of a stage, and compiles it.
    async fn prepare<P: Send + 'static>(
        &self,
        job: JobId,
        stage: Arc<Stage>,
        compile: Compile<P>,
    ) -> Result<Arc<P>, CoordinatorError> {
        let asked = job_row(&*self.ledger, job).await?.asked;
        if asked.numerics_revision != NUMERICS_REVISION {
            return Err(CoordinatorError::Problem(format!(
                "its results are of numerics revision {}; this coordinator computes by {NUMERICS_REVISION}",
                asked.numerics_revision
            )));
        }
        let system = self.problem(stage.system.unwrap_or(asked.problem)).await?;
        let points = match stage.start_points.object() {
            Some(object) => {
                let bytes = self.store.get(object).await?;
                let read = StoredPoints::from_bytes(&bytes);
                let read = read.map_err(|error| CoordinatorError::Problem(error.to_string()))?;
                Some(Arc::new(read))
            }
            None => None,
        };
        let prepare = move || compile(&system, &stage, &|_| points.clone());
        match tokio::task::spawn_blocking(prepare).await {
            Ok(Ok(prepared)) => Ok(Arc::new(prepared)),
            Ok(Err(error)) => Err(CoordinatorError::Problem(error.to_string())),
            Err(error) => Err(CoordinatorError::Problem(error.to_string())),
        }
    }
}

/// Places of results that the stage does not confirm, in an order that nobody else knows, and whether all were looked at
/// in time.
fn doubtful_places(
    prepared: &PreparedCheck,
    key: AuditKey,
    chunk: ChunkId,
    results: &[ItemResult],
) -> (Vec<usize>, bool) {
    let begun = Instant::now();
    let mut doubtful = Vec::new();
    for (count, piece) in secret_order(key, chunk, results.len())
        .into_iter()
        .enumerate()
    {
        if count > 0 && begun.elapsed() > LONGEST_CHECK {
            return (doubtful, false);
        }
        let first = chunk.first + piece.start as u64;
        let places = prepared.doubtful(first, &results[piece.clone()]);
        doubtful.extend(places.into_iter().map(|place| piece.start + place));
    }
    (doubtful, true)
}

/// Cuts `places` results into pieces and orders the pieces by the ledger's secret.
fn secret_order(key: AuditKey, chunk: ChunkId, places: usize) -> Vec<Range<usize>> {
    let starts = (0..places).step_by(PIECE);
    let mut pieces: Vec<Range<usize>> = starts
        .map(|start| start..places.min(start + PIECE))
        .collect();
    pieces.sort_by_key(|piece| key.rank(chunk, piece.start));
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::work::StageId;

    #[test]
    fn each_place_is_looked_at_once_in_an_order_of_the_key() {
        let chunk = ChunkId {
            job: JobId(5),
            stage: StageId(1),
            first: 7,
        };
        let order = |text| secret_order(AuditKey::from_text(text), chunk, 1000);
        let mut places: Vec<usize> = order("secret").into_iter().flatten().collect();
        places.sort_unstable();
        assert_eq!(places, (0..1000).collect::<Vec<_>>());
        assert_ne!(order("secret"), order("another"));
        assert!(secret_order(AuditKey::from_text("secret"), chunk, 0).is_empty());
    }
}
