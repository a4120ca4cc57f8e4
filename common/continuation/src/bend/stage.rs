//! BendStage: the witness points of a stage, each with its derivatives along a moving slice.

use super::in_lanes::bends_in_lanes;
use super::{Bend, Number, RefinedPoint, SlicedEquations, exactly};
use crate::homotopies::HomotopyKind;
use crate::item_result::{ItemResult, PointResult};
use crate::points_at_targets::PointsAtTargets;
use crate::prepared_items::PreparedItems;
use crate::stage::PrepareError;
use crate::start_points::{Digest, StoredPoints};
use crate::work::Stage;
use cognate_numeric::lanes::called::WIDTH;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::ops::Range;
use std::sync::Arc;

/// A stage of `Work::Bend`, ready for any of its items in any order.
#[derive(Debug)]
pub struct BendStage {
    points: PointsAtTargets,
    /// All equations, slices among them, in the unknowns.
    equations: SlicedEquations,
    /// Direction in which the parameters move.
    direction: Vec<Complex64>,
}

impl BendStage {
    /// Checks that stage and system fit.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        let points = PointsAtTargets::new(system, stage, objects)?;
        let HomotopyKind::Parameter { start, targets } = &stage.homotopy else {
            return Err(PrepareError::StartPoints(
                "bends are asked along a line of parameters".into(),
            ));
        };
        let expected = system.parameters.len();
        let [target] = targets.as_slice() else {
            return Err(PrepareError::StartPoints(
                "bends are asked along one line of parameters".into(),
            ));
        };
        if start.len() != expected {
            return Err(PrepareError::Parameters {
                what: "start parameters",
                found: start.len(),
                expected,
            });
        }
        Ok(Self {
            points,
            equations: SlicedEquations::at_parameters(&system.in_unknowns(), start),
            direction: target
                .iter()
                .zip(start)
                .map(|(to, from)| to - from)
                .collect(),
        })
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        self.points.items()
    }

    /// How these points move; results in item order. Pure, as tracking is.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage.
    pub fn run(&self, items: Range<u64>) -> Vec<PointResult<Box<Bend>>> {
        assert!(items.end <= self.items(), "a chunk lies within its stage");
        let Some(mut in_lanes) = bends_in_lanes(&self.equations, &self.direction) else {
            return items.map(|item| self.alone(item)).collect();
        };
        let mut results = Vec::with_capacity((items.end - items.start) as usize);
        let mut first = items.start;
        while first < items.end {
            let together = first..items.end.min(first + WIDTH as u64);
            let unknowns: Vec<_> = together.clone().map(|item| self.unknowns(item)).collect();
            let bends = in_lanes.bends(&unknowns);
            first = together.end;
            results.extend(
                together
                    .zip(bends)
                    .map(|(item, lane_bend)| match lane_bend {
                        Some((refined, bend)) => self.result(item, &refined, bend),
                        None => self.alone(item),
                    }),
            );
        }
        results
    }

    fn unknowns(&self, item: u64) -> Vec<Complex64> {
        let point = self.points.item(item).point;
        self.points.scaling().to_unknowns(point)
    }

    fn alone(&self, item: u64) -> PointResult<Box<Bend>> {
        let start: Vec<Number> = self.unknowns(item).into_iter().map(exactly).collect();
        let Some(refined) = self.equations.refine(&start) else {
            return self.points.result(item, None);
        };
        let bend = self.equations.bend(&refined, &self.direction);
        self.result(item, &refined, bend)
    }

    fn result(&self, item: u64, refined: &RefinedPoint, bend: Bend) -> PointResult<Box<Bend>> {
        let fact = bend.is_sound().then(|| Box::new(bend));
        PointResult {
            residual: refined.residual,
            condition: refined.condition,
            accuracy: refined.correction,
            precision_bits: BITS,
            ..self.points.result(item, fact)
        }
    }
}

impl PreparedItems for BendStage {
    fn items(&self) -> u64 {
        self.items()
    }

    fn run(&self, items: Range<u64>, _: usize) -> Vec<ItemResult> {
        let results = self.run(items).into_iter();
        results.map(ItemResult::Bend).collect()
    }
}

/// Precision of double-doubles, in bits.
const BITS: u32 = 106;

impl Bend {
    /// False where a number is none, or the vectors do not belong together.
    pub fn is_sound(&self) -> bool {
        let finite = |v: &[Number]| {
            v.iter()
                .flat_map(|z| [z.re, z.im])
                .flat_map(|x| x.parts())
                .all(f64::is_finite)
        };
        self.velocity.len() == self.acceleration.len()
            && finite(&self.velocity)
            && finite(&self.acceleration)
            && self.error >= 0.0
    }
}
