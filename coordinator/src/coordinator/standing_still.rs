//! Why a job that goes on does not get on, in words: storage, workers, suspicion.

use super::{Coordinator, CoordinatorError};
use crate::ledger::clock::LedgerTime;
use crate::ledger::rows::{JobRow, WorkerRow};
use crate::ledger::rules::PRESENT_MS;
use crate::results::store::StoreError;
use std::collections::BTreeSet;
use tokio::time::Instant;

/// Workers that are examined.
const WORKERS: u32 = 10_000;
/// Workers that are listed by name.
const NAMED: usize = 5;

impl Coordinator {
    /// Reasons why a job that has not ended waits, one sentence each.
    pub(super) async fn standing_still(
        &self,
        row: &JobRow,
    ) -> Result<Vec<String>, CoordinatorError> {
        let mut lines: Vec<String> = self.health.troubles();
        for line in &mut lines {
            line.insert_str(0, "trouble: nothing is given out, because ");
        }
        lines.extend(self.lost_objects(row).await?);
        let now = self.ledger.now().await?;
        let wanted = row.asked.numerics_revision;
        let is_here = |worker: &WorkerRow| {
            now.since_ms(worker.last_seen) < PRESENT_MS && !worker.says.draining
        };
        let workers = self.ledger.workers(WORKERS).await?;
        let evicted: Vec<String> = workers
            .iter()
            .filter(|worker| worker.evicted)
            .map(|worker| worker.says.worker.to_string())
            .collect();
        let (fit, others): (Vec<_>, Vec<_>) = workers
            .into_iter()
            .filter(is_here)
            .partition(|worker| worker.says.numerics_revision == wanted && !worker.evicted);
        let aside: Vec<(String, String)> = fit
            .iter()
            .filter_map(|worker| {
                let why = self.conduct.refusal(&worker.says.worker, Instant::now())?;
                Some((worker.says.worker.to_string(), why))
            })
            .collect();
        let busy = fit.iter().filter(|worker| worker.leased_chunks > 0).count();
        lines.push(match (fit.len(), others.len()) {
            (0, 0) => "workers: none is here".to_owned(),
            (0, others) => format!(
                "workers: {others} are here, and none fits: numerics revision {wanted} is needed, and to \
                 have been right at audits"
            ),
            (fit, _) => format!(
                "workers: {fit} fit, {busy} of them have chunks, {} are put aside",
                aside.len()
            ),
        });
        for worker in evicted.iter().take(NAMED) {
            lines.push(format!(
                "worker {worker}: it computed wrongly and gets no more work; what it alone found is done again"
            ));
        }
        let credentials: BTreeSet<_> = fit.iter().map(|worker| &worker.says.credential).collect();
        if self.policy.check_results && fit.len() > 1 && credentials.len() == 1 {
            lines.push(
                "workers: all have one credential, so that no other worker confirms which paths diverge or end at \
                 singular points"
                    .to_owned(),
            );
        }
        for (worker, why) in aside.iter().take(NAMED) {
            lines.push(format!("worker {worker}: {why}"));
        }
        let any = LedgerTime(i64::MAX);
        let suspects = self.ledger.suspects(row.job, 1, any).await?;
        if let Some(first) = suspects.first() {
            let alone = suspects.iter().filter(|chunk| chunk.alone).count();
            lines.push(format!(
                "suspicion: workers died of {} chunks that wait, or could not do them (items {}..{} of stage {} \
                 first; {alone} are tracked alone); a path is given up after {} different workers",
                suspects.len(),
                first.items.first,
                first.items.last,
                first.chunk.stage.0,
                self.policy.suspicion_limit
            ));
        }
        Ok(lines)
    }

    /// Lost objects that workers need for the open stages of a job, one sentence each. No worker can do these stages
    /// until the objects are back.
    async fn lost_objects(&self, row: &JobRow) -> Result<Vec<String>, CoordinatorError> {
        let mut readings = vec![(
            "the problem".to_owned(),
            self.store.is_here(row.asked.problem).await,
        )];
        let stages = self.ledger.stages(row.job).await?;
        for stage in stages.iter().filter(|stage| !stage.closed) {
            let number = stage.stage.0;
            let definition = match self.store.stage(stage.definition).await {
                Ok(definition) => definition,
                Err(error) => {
                    readings.push((format!("the definition of stage {number}"), Err(error)));
                    continue;
                }
            };
            for (what, digest) in [
                ("the system", definition.system),
                ("the start points", definition.start_points.object()),
            ] {
                if let Some(digest) = digest {
                    let read = self.store.is_here(digest).await;
                    readings.push((format!("what has {what} of stage {number}"), read));
                }
            }
        }
        // Storage that cannot be reached is a trouble of its own.
        let lost = readings.into_iter().filter_map(|(what, read)| {
            let error = read.err().filter(StoreError::is_loss)?;
            Some(format!(
                "storage: {what} is lost, and the job waits until it is back from a backup: {error}"
            ))
        });
        Ok(lost.collect())
    }
}
