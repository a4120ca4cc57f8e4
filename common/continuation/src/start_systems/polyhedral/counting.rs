//! CountingStage: the branches of a subdivision, each counted by the worker that gets it.

use super::branches::{BRANCHES, BranchCount, BranchedCells};
use crate::item_result::{ItemResult, PointResult};
use crate::path_result::PathIndex;
use crate::prepared_items::PreparedItems;
use crate::stage::{PrepareError, generic_system};
use crate::start_points::StartPoints;
use crate::work::Stage;
use cognate_systems::polynomial::{PolynomialError, check_homogeneous, degrees};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::ops::Range;

/// A stage of `Work::CountMixedCells`, ready for any of its items in any order.
#[derive(Debug)]
pub struct CountingStage {
    /// `None` where the lifting has a tie before there are branches.
    branches: Option<BranchedCells>,
    attempt: u16,
}

impl CountingStage {
    /// Checks that stage and system fit, and finds the open cells from which branches come.
    pub fn new(system: &System, stage: &Stage) -> Result<Self, PrepareError> {
        let (supports, lifting) = Self::supports(system, stage)?;
        let branches = BranchedCells::new(&supports, stage.seed, lifting)
            .map_err(|error| PrepareError::StartPoints(error.to_string()))?;
        Ok(Self {
            branches,
            attempt: stage.attempt,
        })
    }

    /// Whether [`Self::new`] would succeed, without what takes long.
    pub fn check(system: &System, stage: &Stage) -> Result<(), PrepareError> {
        Self::supports(system, stage).map(|_| ())
    }

    /// The supports, and how many liftings before this one had ties.
    #[allow(clippy::type_complexity)]
    fn supports(system: &System, stage: &Stage) -> Result<(Vec<Vec<Vec<i64>>>, u32), PrepareError> {
        system.check()?;
        let (equations, dimension) = (system.equation_count(), system.dimension());
        if equations < dimension || dimension == 0 {
            return Err(PrepareError::Underdetermined {
                equations,
                dimension,
            });
        }
        let StartPoints::MixedCells {
            branches: Some(branches),
            ..
        } = &stage.start_points
        else {
            return Err(PrepareError::StartPoints(
                "mixed cells are counted in branches".into(),
            ));
        };
        let wrong = |error: PolynomialError| PrepareError::Degrees(error.to_string());
        let equation_degrees = degrees(system).map_err(wrong)?;
        check_homogeneous(system, &equation_degrees).map_err(wrong)?;
        let generic = generic_system(system, equations > dimension, stage.seed)?;
        Ok((generic.supports().to_vec(), branches.lifting))
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        BRANCHES
    }

    /// Counts the cells of these branches; results in item order. Pure, as tracking is.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage.
    pub fn run(&self, items: Range<u64>) -> Vec<PointResult<BranchCount>> {
        assert!(items.end <= self.items(), "a chunk lies within its stage");
        items.map(|item| self.count(item)).collect()
    }

    fn count(&self, item: u64) -> PointResult<BranchCount> {
        let branches = self.branches.as_ref();
        // Every result that is no failure has a point.
        let nowhere = vec![Complex64::default()];
        let count = branches.map_or(BranchCount::Tie, |branched_cells| {
            branched_cells.count(item)
        });
        PointResult::new(PathIndex(item), self.attempt, nowhere, Some(count))
    }
}

impl PreparedItems for CountingStage {
    fn items(&self) -> u64 {
        self.items()
    }

    fn run(&self, items: Range<u64>, _: usize) -> Vec<ItemResult> {
        let results = self.run(items).into_iter();
        results.map(ItemResult::CountMixedCells).collect()
    }
}
