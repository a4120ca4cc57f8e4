//! PreparedFamily: stages that follow the same points of a family to other targets, and prove what was found there, are
//! compiled once.

use crate::certification::CertificationStage;
use crate::prepared_work::PreparedWork;
use crate::stage::{PrepareError, PreparedStage};
use crate::start_points::{Digest, StoredPoints};
use crate::work::{Stage, Work};
use cognate_systems::system::System;
use std::sync::{Arc, Mutex, PoisonError};

/// The stages that were compiled last, for threads that solve members of one family. A prepared stage equals the one
/// that [`PreparedWork::new`] makes, whatever was compiled before.
#[derive(Debug, Default)]
pub struct PreparedFamily {
    paths: Last<PreparedStage>,
    proofs: Last<CertificationStage>,
}

/// The stage of one kind that was compiled last, with its system and seed.
#[derive(Debug)]
struct Last<S>(Mutex<Option<(System, u64, Arc<S>)>>);

impl<S> Default for Last<S> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<S> Last<S> {
    /// The stage, where it is of this system and seed.
    fn of(&self, system: &System, seed: u64) -> Option<Arc<S>> {
        let last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let same = last
            .as_ref()
            .filter(|last| (&last.0, last.1) == (system, seed));
        same.map(|(_, _, stage)| Arc::clone(stage))
    }

    fn keep(&self, system: &System, seed: u64, stage: S) {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *last = Some((system.clone(), seed, Arc::new(stage)));
    }
}

/// Finds stored points by their digest.
type Objects<'a> = &'a dyn Fn(Digest) -> Option<Arc<StoredPoints>>;

impl PreparedFamily {
    /// As [`PreparedWork::new`]; compiles where more than the targets and points is different from the last stage of
    /// the same work.
    pub fn prepare(
        &self,
        system: &System,
        stage: &Stage,
        objects: Objects<'_>,
    ) -> Result<PreparedWork, PrepareError> {
        match stage.work {
            Work::Track => self.paths(system, stage, objects).map(PreparedWork::from),
            Work::Certify => self.proofs(system, stage, objects).map(PreparedWork::from),
            Work::LocalDimension | Work::Sharpen { .. } | Work::CountMixedCells | Work::Bend => {
                PreparedWork::new(system, stage, objects)
            }
        }
    }

    fn paths(
        &self,
        system: &System,
        stage: &Stage,
        objects: Objects<'_>,
    ) -> Result<PreparedStage, PrepareError> {
        let last = self.paths.of(system, stage.seed);
        if let Some(prepared) = last.and_then(|last| last.with_targets(stage)) {
            return Ok(prepared);
        }
        let prepared = PreparedStage::new(system, stage, objects)?;
        if let Some(same) = prepared.with_targets(stage) {
            self.paths.keep(system, stage.seed, same);
        }
        Ok(prepared)
    }

    fn proofs(
        &self,
        system: &System,
        stage: &Stage,
        objects: Objects<'_>,
    ) -> Result<CertificationStage, PrepareError> {
        if let Some(last) = self.proofs.of(system, stage.seed) {
            return last.with_stage(system, stage, objects);
        }
        let prepared = CertificationStage::new(system, stage, objects)?;
        let same = prepared.with_stage(system, stage, objects)?;
        self.proofs.keep(system, stage.seed, same);
        Ok(prepared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::homotopies::HomotopyKind;
    use crate::start_points::StartPoints;
    use crate::tracker::settings::Settings;
    use num_complex::Complex64;

    /// As p goes to 0 the two values of x meet, and one of the two values of y runs to infinity.
    const FAMILY: &str = "CONFIG END; INPUT variable_group x, y; function f, g; parameter p; f = x^2 - p; g = p*y^2 + y - 2; END;";

    fn stage(targets: &[f64], seed: u64) -> Stage {
        let one = |re: f64| vec![Complex64::new(re, 0.0)];
        Stage::new(
            Work::Track,
            HomotopyKind::Parameter {
                start: one(1.0),
                targets: targets.iter().map(|&target| one(target)).collect(),
            },
            StartPoints::Stored {
                object: Digest([0; 32]),
                count: 4,
            },
            Settings::default(),
            seed,
        )
    }

    /// With targets where paths end regularly, run to infinity through projective patches, or meet.
    #[test]
    fn a_family_gives_the_bits_of_each_stage_alone() {
        let system = cognate_systems::formats::read("family", FAMILY.as_bytes());
        let system = system.unwrap().system;
        let c = |re: f64| Complex64::new(re, 0.0);
        let coordinates = [(1.0, 1.0), (1.0, -2.0), (-1.0, 1.0), (-1.0, -2.0)];
        let points = Arc::new(StoredPoints {
            dimension: 2,
            coordinates: coordinates
                .iter()
                .flat_map(|&(x, y)| [c(x), c(y)])
                .collect(),
        });
        let find = |_| Some(Arc::clone(&points));
        let family = PreparedFamily::default();
        for (targets, seed) in [
            (&[4.0, 2.5][..], 3),
            (&[0.0][..], 3),
            (&[-1.0, 0.0, 7.0][..], 3),
            (&[2.5][..], 4),
            (&[4.0][..], 3),
        ] {
            let stage = stage(targets, seed);
            let alone = PreparedWork::new(&system, &stage, &find).unwrap();
            let of_family = family.prepare(&system, &stage, &find).unwrap();
            let items = 4 * targets.len() as u64;
            assert_eq!((alone.items(), of_family.items()), (items, items));
            for width in [1, 8] {
                assert_eq!(alone.run(0..items, width), of_family.run(0..items, width));
            }
            let proofs = Stage {
                work: Work::Certify,
                ..stage
            };
            let alone = PreparedWork::new(&system, &proofs, &find).unwrap();
            let of_family = family.prepare(&system, &proofs, &find).unwrap();
            assert_eq!(alone.run(0..items, 1), of_family.run(0..items, 1));
        }
    }

    #[test]
    fn only_other_targets_are_taken_over() {
        let system = cognate_systems::formats::read("family", FAMILY.as_bytes());
        let system = system.unwrap().system;
        let c = Complex64::new(1.0, 0.0);
        let points = Arc::new(StoredPoints {
            dimension: 2,
            coordinates: vec![c; 8],
        });
        let first = stage(&[4.0], 3);
        let prepared = PreparedStage::new(&system, &first, &|_| Some(Arc::clone(&points))).unwrap();
        let seed = stage(&[4.0], 5);
        let mut longer = stage(&[4.0], 3);
        longer.homotopy = HomotopyKind::Parameter {
            start: vec![c],
            targets: vec![vec![c, c]],
        };
        let precise = Stage {
            settings: Settings {
                precision_bits: 106,
                ..Settings::default()
            },
            ..first.clone()
        };
        let second_attempt = Stage {
            attempt: 1,
            ..first.clone()
        };
        for other in [&seed, &longer, &precise, &second_attempt] {
            assert!(prepared.with_targets(other).is_none(), "{other:?}");
        }
        assert!(prepared.with_targets(&stage(&[4.0, 5.0], 3)).is_some());
    }
}
