//! PointsAtTargets: the stored points of a stage, each at the parameters of its target, for work that
//! looks at points instead of tracking paths.

use crate::homotopies::HomotopyKind;
use crate::item_result::PointResult;
use crate::path_result::PathIndex;
use crate::stage::PrepareError;
use crate::start_points::{Digest, StartPoints, StoredPoints};
use crate::work::Stage;
use cognate_systems::scaling::Scaling;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::borrow::Cow;
use std::sync::Arc;

/// The points of a stage: its start points are values of the variables near solutions, and the
/// homotopy says at which parameters, those at its end for the item's target.
#[derive(Debug)]
pub struct PointsAtTargets {
    stage: Stage,
    /// Values of all parameters, for each target.
    targets: Vec<Vec<Complex64>>,
    points: Arc<StoredPoints>,
    /// The units in which the system is tracked.
    scaling: Scaling,
    items: u64,
}

/// One point at one target.
#[derive(Clone, Copy, Debug)]
pub struct Item<'a> {
    /// Index of the item among all targets and points.
    pub origin: u64,
    /// Index of the target.
    pub target: usize,
    /// Values of the variables.
    pub point: &'a [Complex64],
}

/// The parameters at the end of a homotopy, target by target; zeros where it ends at a system without them.
pub fn parameters_at_targets(homotopy: &HomotopyKind, system: &System) -> Vec<Vec<Complex64>> {
    let zeros = || vec![Complex64::default(); system.parameters.len()];
    (0..homotopy.parameter_sets())
        .map(|target| {
            let values = homotopy.end_parameters(target, system.path_variable);
            values.map_or_else(zeros, Cow::into_owned)
        })
        .collect()
}

impl PointsAtTargets {
    /// Checks that stage and system fit.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        system.check()?;
        let dimension = system.dimension();
        if system.equation_count() < dimension || dimension == 0 {
            return Err(PrepareError::Underdetermined {
                equations: system.equation_count(),
                dimension,
            });
        }
        let targets = parameters_at_targets(&stage.homotopy, system);
        for target in &targets {
            if target.len() != system.parameters.len() {
                return Err(PrepareError::Parameters {
                    what: "parameters",
                    found: target.len(),
                    expected: system.parameters.len(),
                });
            }
        }
        let base = match &stage.start_points {
            StartPoints::Selected { base, .. } => base,
            other => other,
        };
        let StartPoints::Stored { object, count } = base else {
            return Err(PrepareError::StartPoints(
                "points to look at are stored".into(),
            ));
        };
        let points = objects(*object).ok_or(PrepareError::MissingObject(*object))?;
        if points.len() as u64 != *count || points.dimension != system.variable_count() {
            return Err(PrepareError::StartPoints(format!(
                "{} points of {} coordinates for {} variables",
                points.len(),
                points.dimension,
                system.variable_count()
            )));
        }
        let items = stage
            .items()
            .ok_or_else(|| PrepareError::StartPoints("they are more than fit in 64 bits".into()))?;
        if let StartPoints::Selected { indices, .. } = &stage.start_points {
            let end = count.saturating_mul(targets.len() as u64);
            if indices.iter().any(|&index| index >= end) {
                return Err(PrepareError::StartPoints(
                    "a selected index is too large".into(),
                ));
            }
        }
        Ok(Self {
            stage: stage.clone(),
            targets,
            points,
            scaling: system.scaling.clone(),
            items,
        })
    }

    /// Number of points.
    pub fn items(&self) -> u64 {
        self.items
    }

    /// The point and the target of an item.
    pub fn item(&self, item: u64) -> Item<'_> {
        let count = self.points.len().max(1) as u64;
        let origin = self.stage.origin(item);
        let place = |n: u64| usize::try_from(n).expect("what is in memory");
        Item {
            origin,
            target: place(origin / count),
            point: self.points.point(place(origin % count)),
        }
    }

    /// The units in which the system is tracked.
    pub fn scaling(&self) -> &Scaling {
        &self.scaling
    }

    /// The parameters of one target.
    pub fn parameters(&self, target: usize) -> &[Complex64] {
        &self.targets[target]
    }

    /// The result of one item with this fact, and nothing else known of its point, which is the one that was
    /// given, in the values of the variables.
    pub fn result<Fact>(&self, item: u64, fact: Option<Fact>) -> PointResult<Fact> {
        let Item { origin, point, .. } = self.item(item);
        PointResult::new(PathIndex(origin), self.stage.attempt, point.to_vec(), fact)
    }
}
