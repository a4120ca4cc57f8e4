//! PreparedWork: all that a worker makes of a stage before it does its items, whatever they are.

use crate::bend::stage::BendStage;
use crate::certification::CertificationStage;
use crate::local_dimension::prepared::PreparedLocalDimension;
use crate::path_result::PathResult;
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
pub enum PreparedWork {
    /// Paths to track.
    Track(Box<PreparedStage>),
    /// Points to certify.
    Certify(Box<CertificationStage>),
    /// Endpoints of which it is asked whether they are isolated.
    LocalDimension(Box<PreparedLocalDimension>),
    /// Points to sharpen.
    Sharpen(Box<SharpeningStage>),
    /// Branches whose mixed cells are counted.
    CountMixedCells(Box<CountingStage>),
    /// Witness points that are moved.
    Bend(Box<BendStage>),
}

impl PreparedWork {
    /// Checks that stage and system fit, and compiles. `objects` finds stored points by their
    /// digest.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        Ok(match stage.work {
            Work::Track => Self::Track(Box::new(PreparedStage::new(system, stage, objects)?)),
            Work::Certify => {
                Self::Certify(Box::new(CertificationStage::new(system, stage, objects)?))
            }
            Work::LocalDimension => {
                let prepared = PreparedLocalDimension::new(system, stage, objects)?;
                Self::LocalDimension(Box::new(prepared))
            }
            Work::Sharpen { digits } => Self::Sharpen(Box::new(SharpeningStage::new(
                system, stage, digits, objects,
            )?)),
            Work::CountMixedCells => {
                Self::CountMixedCells(Box::new(CountingStage::new(system, stage)?))
            }
            Work::Bend => Self::Bend(Box::new(BendStage::new(system, stage, objects)?)),
        })
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
            _ => PreparedStage::check(system, stage, objects),
        }
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        match self {
            Self::Track(stage) => stage.items(),
            Self::Certify(stage) => stage.items(),
            Self::LocalDimension(stage) => stage.items(),
            Self::Sharpen(stage) => stage.items(),
            Self::CountMixedCells(stage) => stage.items(),
            Self::Bend(stage) => stage.items(),
        }
    }

    /// Does these items, where it can `width` at a time; results in item order, the same at
    /// every width and in every split.
    pub fn run(&self, items: Range<u64>, width: usize) -> Vec<PathResult> {
        match self {
            Self::Track(stage) => stage.track(items, width),
            Self::Certify(stage) => stage.run(items),
            Self::LocalDimension(stage) => stage.run(items),
            Self::Sharpen(stage) => stage.run(items),
            Self::CountMixedCells(stage) => stage.run(items),
            Self::Bend(stage) => stage.run(items),
        }
    }
}
