//! Mixed cells as they are counted: what clients see of a stage that finds out how many paths there are.

use super::{Coordinator, CoordinatorError};
use crate::jobs::large_stage;
use crate::ledger::identity::JobId;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::start_systems::polyhedral::branches::BranchCount;
use cognate_continuation::work::{StageId, Work};
use std::collections::HashMap;
use std::sync::Arc;

/// The mixed cells of a branch, where they were counted.
fn cells_of(result: &ItemResult) -> u64 {
    match result {
        ItemResult::CountMixedCells(branch) => match branch.fact() {
            Some(BranchCount::Counted(counted)) => counted.cells,
            Some(BranchCount::Tie | BranchCount::TooLarge) | None => 0,
        },
        _ => 0,
    }
}

impl Coordinator {
    /// The mixed cells that were found in the finished chunks of a stage that counts them.
    pub(super) async fn cells_so_far(
        &self,
        job: JobId,
        stage: StageId,
    ) -> Result<u64, CoordinatorError> {
        let kept_counts = self.cells.get(&(job, stage)).unwrap_or_default();
        let mut counts = HashMap::clone(&kept_counts);
        let mut from = 0;
        loop {
            let objects = large_stage::page(&*self.ledger, job, stage, from).await?;
            let Some(last) = objects.last() else { break };
            from = last.items.last;
            for object in objects {
                if counts.contains_key(&object.items.first) {
                    continue;
                }
                let results = self.store.results(&object, Work::CountMixedCells).await?;
                let cells = results.iter().map(cells_of);
                counts.insert(object.items.first, cells.sum());
            }
        }
        let sum = counts
            .values()
            .fold(0, |sum: u64, n| sum.saturating_add(*n));
        if counts.len() > kept_counts.len() {
            self.cells.keep((job, stage), Arc::new(counts));
        }
        Ok(sum)
    }
}
