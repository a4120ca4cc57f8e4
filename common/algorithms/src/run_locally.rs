//! Any algorithm from beginning to end in one thread: for examples, tests and tools.

use crate::{Next, Opening, PathAlgorithm};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_family::PreparedFamily;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::Stage;
use cognate_numeric::interruption::{can_be_interrupted, is_interrupted};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// Items between two looks at whether anybody still waits: less than a second's work.
const PIECE: usize = 256;

/// Solves with lanes of this width; one solution set for each target.
///
/// `system` is the plan's, not the one that was planned for. `objects` finds
/// start points that were stored before the solve began; those that it makes
/// itself are kept here.
///
/// ```
/// use cognate_algorithms::{SolveOptions, plan, run_locally::run_locally};
///
/// let text = b"CONFIG\nEND;\nINPUT\nvariable_group x; function f; f = x^2 - 2;\nEND;\n";
/// let system = cognate_systems::formats::read("example", text)?.system;
/// let mut plan = plan(&system, &SolveOptions::default())?;
/// let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 1)?;
/// assert_eq!((sets[0].paths.total, sets[0].counts.real), (2, Some(2)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_locally(
    system: &System,
    algorithm: &mut dyn PathAlgorithm,
    objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    width: usize,
) -> Result<Vec<SolutionSet>, PrepareError> {
    run(system, algorithm, objects, &mut |system, stage, find| {
        let prepared = PreparedWork::new(system, stage, find)?;
        Ok(prepared.run(0..prepared.items(), width))
    })
}

/// Runs one of many solves in a family, with the best number of lanes: data of the family are taken over from the
/// solves before, and kept for the next. The bits are those of [`run_locally`]. An observer gets the results of each
/// stage before the algorithm does. Ends with `Interrupted` if this thread is told to stop.
pub fn run_in_family(
    system: &System,
    algorithm: &mut dyn PathAlgorithm,
    objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
    family: &PreparedFamily,
    observer: &mut dyn FnMut(&[ItemResult]),
) -> Result<Vec<SolutionSet>, PrepareError> {
    run(system, algorithm, objects, &mut |system, stage, find| {
        let prepared = family.prepare(system, stage, find)?;
        let (items, width) = (prepared.items(), prepared.preferred_width());
        let piece = if can_be_interrupted() {
            PIECE as u64
        } else {
            u64::MAX
        };
        let (mut results, mut from) = (Vec::new(), 0);
        while from < items {
            if is_interrupted() {
                return Err(PrepareError::Interrupted);
            }
            let to = items.min(from.saturating_add(piece));
            results.extend(prepared.run(from..to, width));
            from = to;
        }
        if is_interrupted() {
            return Err(PrepareError::Interrupted);
        }
        observer(&results);
        Ok(results)
    })
}

/// Finds stored points by their digest.
type Objects<'a> = &'a dyn Fn(Digest) -> Option<Arc<StoredPoints>>;
/// Results of all items of a stage.
type Results = Result<Vec<ItemResult>, PrepareError>;

/// Solves; `work` does all items of a stage of this system.
fn run(
    system: &System,
    algorithm: &mut dyn PathAlgorithm,
    objects: Objects<'_>,
    work: &mut dyn FnMut(&System, &Stage, Objects<'_>) -> Results,
) -> Result<Vec<SolutionSet>, PrepareError> {
    let mut made: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    drive::<PrepareError, _>(algorithm, &mut |opening| {
        let objects_of_stage = opening.objects.iter();
        made.extend(objects_of_stage.map(|points| (points.digest(), Arc::clone(points))));
        let find = |wanted: Digest| made.get(&wanted).cloned().or_else(|| objects(wanted));
        let system = opening.system.as_deref().unwrap_or(system);
        work(system, &opening.stage, &find)
    })?;
    if let Some(reason) = algorithm.failure() {
        return Err(PrepareError::StartPoints(reason));
    }
    Ok(algorithm.solution_sets(system))
}

/// Drives an algorithm until it is done. `work` does all items of a stage, in
/// their order; its first error ends the run.
pub fn drive<E, R: Into<ItemResult>>(
    algorithm: &mut dyn PathAlgorithm,
    work: &mut dyn FnMut(&Opening) -> Result<Vec<R>, E>,
) -> Result<(), E> {
    let mut open = VecDeque::new();
    loop {
        match algorithm.next() {
            Next::Open(opening) => open.push_back(opening),
            Next::Wait => {
                let opening: Box<Opening> = open
                    .pop_front()
                    .expect("an algorithm waits only for a stage that it opened");
                let results = work(&opening)?;
                algorithm.absorb(opening.stage.id, &mut results.into_iter().map(R::into));
            }
            Next::Done => return Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Progress;
    use crate::synthetic::{first_stage, system};
    use cognate_continuation::homotopies::HomotopyKind;
    use cognate_continuation::path_result::PathResult;
    use cognate_continuation::work::StageId;
    use num_complex::Complex64;

    /// Solves x^4 = 2 from 1, then goes on from what it found: to 3, then to 5 from there.
    #[derive(Default)]
    struct Relay {
        opened: u32,
        points: Option<Arc<StoredPoints>>,
        ends: Vec<PathResult>,
    }

    fn one(re: f64) -> Vec<Complex64> {
        vec![Complex64::new(re, 0.0)]
    }

    impl PathAlgorithm for Relay {
        fn next(&mut self) -> Next {
            let leg = |start, target| HomotopyKind::Parameter {
                start: one(start),
                targets: vec![one(target)],
            };
            let opening = match (self.opened, self.points.take()) {
                (0, _) => first_stage(HomotopyKind::StraightLine {
                    parameters: one(2.0),
                })
                .into(),
                (3, Some(points)) => {
                    self.points = Some(points);
                    return Next::Done;
                }
                (_, None) => return Next::Wait,
                (k, Some(points)) => Opening {
                    stage: Stage {
                        id: StageId(k),
                        start_points: points.as_start(),
                        ..first_stage(if k == 1 { leg(2.0, 3.0) } else { leg(3.0, 5.0) })
                    },
                    system: None,
                    objects: vec![points],
                },
            };
            self.opened += 1;
            Next::Open(Box::new(opening))
        }
        fn absorb(&mut self, _: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
            self.ends = results.map(ItemResult::into_path).collect();
            let values = self.ends.iter().map(|result| {
                let z = result.endpoint.to_double();
                z[1] / z[0]
            });
            self.points = Some(Arc::new(StoredPoints {
                dimension: 1,
                coordinates: values.collect(),
            }));
        }
        fn progress(&self) -> Progress {
            unreachable!("nobody asks")
        }
        fn failure(&self) -> Option<String> {
            None
        }
        fn answer(&self, _: &System) -> Option<crate::Answer> {
            None
        }
    }

    #[test]
    fn a_stage_may_start_at_points_that_an_earlier_one_found() {
        let mut relay = Relay::default();
        run_locally(&system(), &mut relay, &|_| None, 8).unwrap();
        let points = relay.points.unwrap();
        assert_eq!((relay.ends.len(), points.len()), (4, 4));
        for k in 0..4 {
            let x = points.point(k)[0];
            assert!((x * x * x * x - 5.0).norm_sqr() < 1e-24, "{x}");
            let apart = (0..k).all(|j| (points.point(j)[0] - x).norm_sqr() > 1.0);
            assert!(apart, "{points:?}");
        }
    }
}
