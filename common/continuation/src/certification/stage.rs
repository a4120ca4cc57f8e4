//! CertificationStage: the points of a stage, each with the attempt to certify it.

use super::{Certification, Krawczyk};
use crate::homotopies::HomotopyKind;
use crate::path_result::{Coordinates, Counts, PathIndex, PathResult};
use crate::stage::PrepareError;
use crate::start_points::{Digest, StartPoints, StoredPoints};
use crate::tracker::outcome::PathOutcome;
use crate::work::Stage;
use cognate_systems::evaluation::Interpreter;
use cognate_systems::polynomial::degrees;
use cognate_systems::system::System;
use cognate_systems::transform::randomize;
use num_complex::Complex64;
use std::ops::Range;
use std::sync::Arc;

/// A stage of `Work::Certify`, ready for any of its items in any order.
///
/// Its start points are stored points: values of the variables near solutions. The homotopy
/// says at which parameters: those at its end, for the item's target.
#[derive(Debug)]
pub struct CertificationStage {
    stage: Stage,
    program: Interpreter,
    homogeneous: Vec<Vec<usize>>,
    /// Values of all parameters, for each target.
    targets: Vec<Vec<Complex64>>,
    points: Arc<StoredPoints>,
    items: u64,
}

/// The square system whose solutions are certified: the system itself, or the same combinations
/// of its equations that a stage with this seed tracks.
pub fn certified_system(system: &System, seed: u64) -> Result<System, PrepareError> {
    if system.equation_count() == system.dimension() {
        return Ok(system.clone());
    }
    let found = degrees(system).map_err(|error| PrepareError::Degrees(error.to_string()))?;
    Ok(randomize(system, &found, seed))
}

/// The parameters at the end of a homotopy, target by target.
pub fn parameters_at_targets(homotopy: &HomotopyKind, system: &System) -> Vec<Vec<Complex64>> {
    match homotopy {
        HomotopyKind::StraightLine { parameters }
        | HomotopyKind::Generic { parameters }
        | HomotopyKind::Slide { parameters, .. }
        | HomotopyKind::Intersect { parameters, .. } => {
            vec![parameters.clone()]
        }
        // They end at another system.
        HomotopyKind::Toric | HomotopyKind::Sections { .. } => {
            vec![vec![Complex64::new(0.0, 0.0); system.parameters.len()]]
        }
        HomotopyKind::Parameter { targets, .. } => targets.clone(),
        HomotopyKind::PathVariable { parameters } => {
            let mut parameters = parameters.clone();
            if let Some(value) = system.path_variable.and_then(|t| parameters.get_mut(t)) {
                *value = Complex64::new(0.0, 0.0);
            }
            vec![parameters]
        }
    }
}

impl CertificationStage {
    /// Checks that stage and system fit, and compiles.
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
                "only stored points are certified".into(),
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
        let square = certified_system(system, stage.seed)?;
        Ok(Self {
            program: Krawczyk::program(&square),
            homogeneous: Krawczyk::homogeneous(&square),
            stage: stage.clone(),
            targets,
            points,
            items,
        })
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        self.items
    }

    /// Tries to certify these items; results in item order. Pure, as tracking is.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage.
    pub fn run(&self, items: Range<u64>) -> Vec<PathResult> {
        assert!(items.end <= self.items, "a chunk lies within its stage");
        let count = self.points.len().max(1) as u64;
        let mut test: Option<(u64, Krawczyk)> = None;
        items
            .map(|item| {
                let origin = self.stage.origin(item);
                let target = origin / count;
                let point = usize::try_from(origin % count).expect("a point that is in memory");
                let known = test.take().filter(|(of, _)| *of == target);
                let (_, krawczyk) = test.insert(known.unwrap_or_else(|| {
                    let place = usize::try_from(target).expect("a target that is in memory");
                    let krawczyk = Krawczyk::with_program(
                        self.program.clone(),
                        self.homogeneous.clone(),
                        &self.targets[place],
                    );
                    (target, krawczyk)
                }));
                let point = self.points.point(point);
                self.result(origin, point, krawczyk.certify(point))
            })
            .collect()
    }

    fn result(&self, origin: u64, point: &[Complex64], certification: Certification) -> PathResult {
        PathResult {
            origin: PathIndex(origin),
            attempt: self.stage.attempt,
            outcome: PathOutcome::Regular,
            // No path was followed: the point is the one that was given, in the values of the
            // variables, and all that is known of it is in the certification.
            endpoint: Coordinates::Double(point.to_vec()),
            t: Complex64::new(0.0, 0.0),
            residual: f64::INFINITY,
            condition: f64::INFINITY,
            accuracy: f64::INFINITY,
            winding_number: None,
            infinity_turns: Vec::new(),
            precision_bits: certification
                .certificate()
                .map_or(super::MOST_BITS, |found| found.precision_bits),
            counts: Counts::default(),
            asked: None,
            certification: Some(certification),
            local_dimension: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certification::Uncertified;
    use crate::work::{StageId, Work};
    use cognate_systems::formats::read;

    fn real(values: &[f64]) -> Vec<Complex64> {
        values.iter().map(|&v| Complex64::new(v, 0.0)).collect()
    }

    #[test]
    fn items_are_points_at_their_targets_in_any_split() {
        let text =
            "CONFIG\nEND;\nINPUT\nvariable_group x; parameter p; function f; f = x^2 - p;\nEND;\n";
        let system = read("test", text.as_bytes()).unwrap().system;
        let points = Arc::new(StoredPoints {
            dimension: 1,
            coordinates: real(&[2.0, -2.0, 3.0, 5.0]),
        });
        let stage = Stage {
            id: StageId(4),
            work: Work::Certify,
            homotopy: HomotopyKind::Parameter {
                start: real(&[1.0]),
                targets: vec![real(&[4.0]), real(&[9.0])],
            },
            // 2 and -2 at the first target; 3 and 5 at the second.
            start_points: StartPoints::Selected {
                base: Box::new(points.as_start()),
                indices: vec![0, 1, 4 + 2, 4 + 3],
            },
            settings: crate::tracker::settings::Settings::default(),
            seed: 1,
            attempt: 0,
        };
        let prepared = CertificationStage::new(&system, &stage, &|_| Some(points.clone())).unwrap();
        let all = prepared.run(0..prepared.items());
        let mut split = Vec::new();
        for item in 0..4 {
            split.extend(prepared.run(item..item + 1));
        }
        assert_eq!(all, split);
        let origins: Vec<u64> = all.iter().map(|r| r.origin.0).collect();
        assert_eq!(origins, [0, 1, 6, 7]);
        let found: Vec<_> = all
            .iter()
            .map(|r| r.certification.clone().unwrap())
            .collect();
        for certified in &found[..3] {
            assert!(certified.certificate().is_some(), "{certified:?}");
        }
        let leaves = Certification::Uncertified(Uncertified::NewtonLeaves);
        assert_eq!(found[3], leaves, "5 is no root of 9");
        let mut wrong = stage.clone();
        wrong.start_points = StartPoints::TotalDegree { degrees: vec![2] };
        let error = CertificationStage::new(&system, &wrong, &|_| None).unwrap_err();
        assert!(matches!(error, PrepareError::StartPoints(_)));
    }
}
