//! SharpeningStage: the points of a stage, each with the attempt to bring it to more digits.

use super::search::sharpen_in_variables;
use super::{MOST_DIGITS, Sharpening};
use crate::item_result::{ItemResult, PointResult};
use crate::points_at_targets::{Item, PointsAtTargets};
use crate::prepared_items::PreparedItems;
use crate::stage::PrepareError;
use crate::start_points::{Digest, StoredPoints};
use crate::work::Stage;
use cognate_systems::system::System;
use std::ops::Range;
use std::sync::Arc;

/// A stage of `Work::Sharpen`, ready for any of its items in any order.
#[derive(Debug)]
pub struct SharpeningStage {
    /// All equations, also where combinations of them were tracked, in the unknowns.
    system: System,
    points: PointsAtTargets,
    digits: u32,
    seed: u64,
}

impl SharpeningStage {
    /// Checks that stage and system fit.
    pub fn new(
        system: &System,
        stage: &Stage,
        digits: u32,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        if !(1..=MOST_DIGITS).contains(&digits) {
            return Err(PrepareError::StartPoints(format!(
                "{digits} digits; expected 1 to {MOST_DIGITS}"
            )));
        }
        Ok(Self {
            points: PointsAtTargets::new(system, stage, objects)?,
            system: system.in_unknowns().into_owned(),
            digits,
            seed: stage.seed,
        })
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        self.points.items()
    }

    /// Sharpens these items; results in item order. Pure, as tracking is.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage.
    pub fn run(&self, items: Range<u64>) -> Vec<PointResult<Sharpening>> {
        assert!(items.end <= self.items(), "a chunk lies within its stage");
        items
            .map(|item| {
                let Item { target, point, .. } = self.points.item(item);
                let parameters = self.points.parameters(target);
                let scaling = self.points.scaling();
                let system = &self.system;
                match sharpen_in_variables(
                    system,
                    scaling,
                    parameters,
                    point,
                    self.digits,
                    self.seed,
                ) {
                    Ok(solution) => PointResult {
                        precision_bits: solution.precision_bits,
                        accuracy: solution.accuracy,
                        ..self
                            .points
                            .result(item, Some(Sharpening::Sharpened(Box::new(solution))))
                    },
                    Err(reason) => self
                        .points
                        .result(item, Some(Sharpening::Unsharpened(reason))),
                }
            })
            .collect()
    }
}

impl PreparedItems for SharpeningStage {
    fn items(&self) -> u64 {
        self.items()
    }

    fn run(&self, items: Range<u64>, _: usize) -> Vec<ItemResult> {
        let results = self.run(items).into_iter();
        results.map(ItemResult::Sharpen).collect()
    }

    fn doubtful(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        self.different(first, results)
    }
}
