//! PreparedCheck: all that a coordinator makes of a stage before it checks the results that workers report.
//!
//! Regular ends are checked by Newton's method (`tracker::end_check`), certificates and digits by making them again. Ends
//! that are not regular are not checked, nor are results of other work.

use crate::item_result::ItemResult;
use crate::prepared_items::PreparedItems;
use crate::prepared_work::PreparedWork;
use crate::stage::{PrepareError, PreparedStage};
use crate::start_points::{Digest, StoredPoints};
use crate::work::{Stage, Work};
use cognate_systems::system::System;
use std::sync::Arc;

/// A stage, ready for the results of its items to be checked.
#[derive(Debug)]
pub struct PreparedCheck(Box<dyn PreparedItems>);

impl PreparedCheck {
    /// As [`PreparedWork::new`], compiled faster where paths are tracked. `objects` finds stored points by their digest.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        Ok(Self(match stage.work {
            Work::Track => Box::new(PreparedStage::for_checks(system, stage, objects)?),
            Work::Certify
            | Work::Sharpen { .. }
            | Work::LocalDimension
            | Work::CountMixedCells
            | Work::Bend => PreparedWork::new(system, stage, objects)?.0,
        }))
    }

    /// Places of results, of the items from `first` on, that are not what their items give, or may not be. Empty for
    /// work whose results cannot be checked (`Work::has_checkable_results`).
    ///
    /// # Panics
    /// When the items from `first` on, as many as there are results, reach beyond the stage.
    pub fn doubtful(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        self.0.doubtful(first, results)
    }
}
