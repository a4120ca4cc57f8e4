//! PreparedWork: all that a worker makes of a stage before it does its items, whatever they are.
//!
//! Here every kind of work is registered, in [`PreparedWork::new`].

use crate::bend::stage::BendStage;
use crate::certification::CertificationStage;
use crate::item_result::ItemResult;
use crate::local_dimension::prepared::PreparedLocalDimension;
use crate::prepared_items::PreparedItems;
use crate::sharpening::SharpeningStage;
use crate::stage::{PrepareError, PreparedStage};
use crate::start_points::{Digest, StoredPoints};
use crate::start_systems::polyhedral::counting::CountingStage;
use crate::work::{Stage, Work};
use cognate_systems::system::System;
use std::ops::Range;
use std::sync::Arc;

/// A stage of any kind of work, ready for its items.
#[derive(Debug)]
pub struct PreparedWork(pub(crate) Box<dyn PreparedItems>);

impl PreparedWork {
    /// Checks that stage and system fit, and compiles. `objects` finds stored points by their
    /// digest.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        Ok(Self(match stage.work {
            Work::Track => Box::new(PreparedStage::new(system, stage, objects)?),
            Work::Certify => Box::new(CertificationStage::new(system, stage, objects)?),
            Work::LocalDimension => Box::new(PreparedLocalDimension::new(system, stage, objects)?),
            Work::Sharpen { digits } => {
                Box::new(SharpeningStage::new(system, stage, digits, objects)?)
            }
            Work::CountMixedCells => Box::new(CountingStage::new(system, stage)?),
            Work::Bend => Box::new(BendStage::new(system, stage, objects)?),
        }))
    }

    /// Whether [`Self::new`] would succeed for a stage that a solve begins with, without what
    /// takes long.
    pub fn check(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<(), PrepareError> {
        match stage.work {
            Work::CountMixedCells => CountingStage::check(system, stage),
            Work::Track
            | Work::Certify
            | Work::LocalDimension
            | Work::Sharpen { .. }
            | Work::Bend => PreparedStage::check(system, stage, objects),
        }
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        self.0.items()
    }

    /// Does these items, where it can `width` at a time; results in item order, the same at
    /// every width and in every split.
    pub fn run(&self, items: Range<u64>, width: usize) -> Vec<ItemResult> {
        self.0.run(items, width)
    }

    /// Number of items that are best done at a time.
    pub fn preferred_width(&self) -> usize {
        self.0.preferred_width()
    }
}

impl From<PreparedStage> for PreparedWork {
    fn from(stage: PreparedStage) -> Self {
        Self(Box::new(stage))
    }
}

impl From<CertificationStage> for PreparedWork {
    fn from(stage: CertificationStage) -> Self {
        Self(Box::new(stage))
    }
}

/// Unknowns up to which sixteen lanes of program and matrix fit in about 64 KB: n (n + 2)
/// complex numbers of 16 bytes for the matrix alone are 31 KB at n = 10.
const SIXTEEN_LANES_UP_TO: usize = 10;

impl PreparedItems for PreparedStage {
    fn items(&self) -> u64 {
        self.items()
    }

    fn run(&self, items: Range<u64>, width: usize) -> Vec<ItemResult> {
        let paths = self.track(items, width).into_iter();
        paths.map(ItemResult::Track).collect()
    }

    fn doubtful(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        self.doubtful_ends(first, results)
    }

    fn preferred_width(&self) -> usize {
        match self.homotopy().dimension() <= SIXTEEN_LANES_UP_TO {
            true => 16,
            false => 8,
        }
    }
}
