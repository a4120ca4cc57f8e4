//! CertificationStage: the points of a stage, each with the attempt to certify it.

use super::{Candidate, Certification, Krawczyk, Uncertified};
use crate::item_result::{ItemResult, PointResult};
use crate::points_at_targets::{Item, PointsAtTargets};
use crate::prepared_items::PreparedItems;
use crate::stage::PrepareError;
use crate::start_points::{Digest, StoredPoints};
use crate::work::Stage;
use cognate_systems::polynomial::degrees;
use cognate_systems::system::System;
use cognate_systems::transform::randomize;
use num_complex::Complex64;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// A stage of `Work::Certify`, ready for any of its items in any order.
///
/// The start points of the stage are stored points: values of the variables near solutions. The parameters are those at
/// the end of the homotopy, for the target of each item.
#[derive(Debug)]
pub struct CertificationStage {
    test: Arc<Krawczyk>,
    points: PointsAtTargets,
}

/// The square system whose solutions are certified: the system itself, or the same combinations
/// of its equations that a stage with this seed tracks; up to a factor of each equation.
pub fn certified_system(system: &System, seed: u64) -> Result<Cow<'_, System>, PrepareError> {
    if system.equation_count() == system.dimension() {
        return Ok(Cow::Borrowed(system));
    }
    let combined = combined(&system.in_unknowns(), seed)?;
    Ok(Cow::Owned(combined.in_variables(&system.scaling)))
}

/// The system, or combinations of its equations.
fn combined(system: &System, seed: u64) -> Result<System, PrepareError> {
    if system.equation_count() == system.dimension() {
        return Ok(system.clone());
    }
    let equation_degrees =
        degrees(system).map_err(|error| PrepareError::Degrees(error.to_string()))?;
    Ok(randomize(system, &equation_degrees, seed))
}

impl CertificationStage {
    /// Checks that stage and system fit, and compiles.
    pub fn new(
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        // A stage that does not fit the system is refused before anything is compiled.
        let points = PointsAtTargets::new(system, stage, objects)?;
        let square = combined(&system.in_unknowns(), stage.seed)?;
        let test = Arc::new(Krawczyk::new(&square));
        Ok(Self { test, points })
    }

    /// Another stage of this system whose seed is the same, without compiling again.
    pub fn with_stage(
        &self,
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<Self, PrepareError> {
        Ok(Self {
            test: Arc::clone(&self.test),
            points: PointsAtTargets::new(system, stage, objects)?,
        })
    }

    /// Number of items.
    pub fn items(&self) -> u64 {
        self.points.items()
    }

    /// Tries to certify these items, in the unknowns that are tracked; results in item order. Pure, as tracking is.
    ///
    /// # Panics
    /// When `items` reaches beyond the stage.
    pub fn run(&self, items: Range<u64>) -> Vec<PointResult<Certification>> {
        assert!(items.end <= self.items(), "a chunk lies within its stage");
        let scaling = self.points.scaling();
        let points: Vec<(usize, Vec<Complex64>)> = items
            .clone()
            .map(|item| {
                let Item { target, point, .. } = self.points.item(item);
                (target, scaling.to_unknowns(point))
            })
            .collect();
        let candidates: Vec<Candidate<'_>> = points
            .iter()
            .map(|(target, point)| Candidate {
                parameters: self.points.parameters(*target),
                point,
            })
            .collect();
        let certifications = self.test.certify_all(&candidates).into_iter();
        items
            .zip(certifications)
            .map(|(item, certification)| self.result(item, certification))
            .collect()
    }

    /// Builds the result of an item: converts a certificate in the unknowns that are tracked to one in the variables.
    fn result(&self, item: u64, certification: Certification) -> PointResult<Certification> {
        let certification = match certification {
            Certification::Certified(certificate) => {
                match certificate.in_variables(self.points.scaling(), self.test.homogeneous()) {
                    Some(certificate) => Certification::Certified(Box::new(certificate)),
                    None => Certification::Uncertified(Uncertified::NoEnclosure),
                }
            }
            refused => refused,
        };
        let bits = certification
            .certificate()
            .map(|certificate| certificate.precision_bits);
        PointResult {
            precision_bits: bits.unwrap_or(super::MOST_BITS),
            ..self.points.result(item, Some(certification))
        }
    }
}

impl PreparedItems for CertificationStage {
    fn items(&self) -> u64 {
        self.items()
    }

    fn run(&self, items: Range<u64>, _: usize) -> Vec<ItemResult> {
        let results = self.run(items).into_iter();
        results.map(ItemResult::Certify).collect()
    }

    fn doubtful(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        self.different(first, results)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certification::{Certification, Uncertified};
    use crate::homotopies::HomotopyKind;
    use crate::start_points::StartPoints;
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
            system: None,
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
        let results = prepared.run(0..prepared.items());
        let mut split = Vec::new();
        for item in 0..4 {
            split.extend(prepared.run(item..item + 1));
        }
        assert_eq!(results, split);
        let origins: Vec<u64> = results.iter().map(|r| r.origin.0).collect();
        assert_eq!(origins, [0, 1, 6, 7]);
        let certifications: Vec<_> = results.iter().map(|r| r.fact().cloned().unwrap()).collect();
        for certified in &certifications[..3] {
            assert!(certified.certificate().is_some(), "{certified:?}");
        }
        let leaves = Certification::Uncertified(Uncertified::NewtonLeaves);
        assert_eq!(certifications[3], leaves, "5 is no root of 9");
        let mut wrong = stage.clone();
        wrong.start_points = StartPoints::TotalDegree { degrees: vec![2] };
        let error = CertificationStage::new(&system, &wrong, &|_| None).unwrap_err();
        assert!(matches!(error, PrepareError::StartPoints(_)));
    }
}
