//! PreparedFamily: stages that follow the same points of a family to other targets are compiled once.

use crate::prepared_work::PreparedWork;
use crate::stage::{PrepareError, PreparedStage};
use crate::start_points::{Digest, StoredPoints};
use crate::work::{Stage, Work};
use cognate_systems::system::System;
use std::sync::{Arc, Mutex, PoisonError};

/// What was compiled last, for threads that solve members of one family. What it makes of a stage is what
/// [`PreparedWork::new`] makes, whatever came before.
#[derive(Debug, Default)]
pub struct PreparedFamily(Mutex<Option<Member>>);

/// A stage of a system, compiled.
#[derive(Debug)]
struct Member {
    system: System,
    stage: Arc<PreparedStage>,
}

impl PreparedFamily {
    /// As [`PreparedWork::new`]; compiles where more than the targets is different from the last stage of paths.
    pub fn prepare(
        &self,
        system: &System,
        stage: &Stage,
        objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    ) -> Result<PreparedWork, PrepareError> {
        if stage.work != Work::Track {
            return PreparedWork::new(system, stage, objects);
        }
        if let Some(last) = self.last(system)
            && let Some(prepared) = last.with_targets(stage)
        {
            return Ok(prepared.into());
        }
        let prepared = PreparedStage::new(system, stage, objects)?;
        if let Some(same) = prepared.with_targets(stage) {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            *kept = Some(Member {
                system: system.clone(),
                stage: Arc::new(same),
            });
        }
        Ok(prepared.into())
    }

    /// The stage that was compiled last, where it is of this system.
    fn last(&self, system: &System) -> Option<Arc<PreparedStage>> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let last = kept.as_ref().filter(|last| last.system == *system);
        last.map(|last| Arc::clone(&last.stage))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::homotopies::HomotopyKind;
    use crate::start_points::StartPoints;
    use crate::tracker::settings::Settings;
    use crate::work::StageId;
    use num_complex::Complex64;

    /// As p goes to 0 the two values of x meet, and one of the two values of y runs to infinity.
    const FAMILY: &str = "CONFIG END; INPUT variable_group x, y; function f, g; parameter p; f = x^2 - p; g = p*y^2 + y - 2; END;";

    fn stage(targets: &[f64], seed: u64) -> Stage {
        let one = |re: f64| vec![Complex64::new(re, 0.0)];
        Stage {
            id: StageId(0),
            system: None,
            work: Work::Track,
            homotopy: HomotopyKind::Parameter {
                start: one(1.0),
                targets: targets.iter().map(|&target| one(target)).collect(),
            },
            start_points: StartPoints::Stored {
                object: Digest([0; 32]),
                count: 4,
            },
            settings: Settings::default(),
            seed,
            attempt: 0,
        }
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
        let again = Stage {
            attempt: 1,
            ..first.clone()
        };
        for other in [&seed, &longer, &precise, &again] {
            assert!(prepared.with_targets(other).is_none(), "{other:?}");
        }
        assert!(prepared.with_targets(&stage(&[4.0, 5.0], 3)).is_some());
    }
}
