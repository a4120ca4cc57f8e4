//! From solved generic parameters to the wanted ones, one solution set for each target.

use crate::answer::{Answer, IsolatedSolutions};
use crate::finite_endpoints::FiniteEndpoints;
use crate::opening::Opening;
use crate::progress::Progress;
use crate::retried_stage::RetriedStage;
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::work::{Stage, StageId};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::{Tolerances, Verdict, classify};
use cognate_solutions::path_crossing::radius;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::streamed::PathFilter;
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Message of the panic if the solve of another homotopy is made a parameter solve.
const MOVES: &str = "a parameter solve has a parameter homotopy";

/// Many targets in one stage: item i starts at start point `i % starts` and
/// goes to target `i / starts`. Crossings are looked for within each target.
///
/// With a symmetry group the images of what was found are solutions too. Those
/// that no path arrived at belong to paths that failed: they are followed on
/// the spot in the place of these (Wampler, Morgan, Sommese 1992 switch to
/// another member of the orbit where one runs far out).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterSolve {
    paths: RetriedStage,
    /// The symmetry of the family, where there is any.
    group: SymmetryGroup,
    /// Targets that were looked at for what the symmetry says is missing.
    completed: usize,
}

impl ParameterSolve {
    /// The solve that begins with this stage.
    ///
    /// # Panics
    /// When it is no parameter homotopy, or has no target.
    pub fn new(first: Stage, system: &System, tolerances: Tolerances) -> Self {
        let solve = Self::with_shape(first, &PointShape::of(system), tolerances);
        match SymmetryGroup::of(system) {
            Ok(group) => solve.with_group(group),
            Err(_) => solve,
        }
    }

    /// Makes the solve from the shape of the system's points alone.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn with_shape(
        first: impl Into<Opening>,
        shape: &PointShape,
        tolerances: Tolerances,
    ) -> Self {
        let first = first.into();
        let targets = first.stage.homotopy.target_parameters().expect(MOVES);
        let count = targets.len() as u64;
        Self {
            paths: RetriedStage::with_shape(first, shape.clone(), tolerances, count),
            group: SymmetryGroup::trivial(),
            completed: 0,
        }
    }

    /// Sets the symmetry group of the family.
    #[must_use]
    pub fn with_group(self, group: SymmetryGroup) -> Self {
        Self { group, ..self }
    }

    /// Replaces the limit of repetitions of a path.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.paths = self.paths.with_max_retries(max_retries);
        self
    }

    /// The paths and what is known about them.
    pub fn paths(&self) -> &RetriedStage {
        &self.paths
    }

    /// The paths and their results, to be told which results are held.
    pub fn paths_mut(&mut self) -> &mut RetriedStage {
        &mut self.paths
    }

    /// False where the ends of paths are compared with more than each other, so that all are held.
    pub fn can_leave_out(&self) -> bool {
        self.group.is_trivial() && self.paths.can_leave_out()
    }

    /// Filters of the streamed paths, in the order of the targets.
    pub fn filters(&self, system: &System) -> Vec<PathFilter> {
        let (tolerances, seed) = (self.paths.tolerances(), self.paths.first().seed);
        let filter =
            |parameters: &Vec<Complex64>| PathFilter::new(system, parameters, tolerances, seed);
        self.targets().iter().map(filter).collect()
    }
}

impl ParameterSolve {
    fn targets(&self) -> &[Vec<Complex64>] {
        let homotopy = &self.paths.first().homotopy;
        homotopy.target_parameters().expect(MOVES)
    }

    /// A stage that stays at one target: in the place of paths that failed it starts at what the
    /// symmetry says is missing.
    fn completion(&self, target: usize) -> Option<Opening> {
        if self.group.is_trivial() {
            return None;
        }
        let (shape, tolerances) = (self.paths.shape(), self.paths.tolerances());
        let results = self.paths.results_of(target);
        let mut failed = Vec::new();
        let mut endpoints: Vec<(Vec<Complex64>, f64)> = Vec::new();
        for result in results {
            match classify(result, shape, tolerances).verdict {
                Verdict::Finite => endpoints.push((
                    shape.to_variables(result.endpoint.to_double()),
                    radius(result, tolerances),
                )),
                Verdict::Failed => failed.push(result.origin.0),
                _ => {}
            }
        }
        if failed.is_empty() || endpoints.is_empty() {
            return None;
        }
        let endpoints: Vec<(&[Complex64], f64)> =
            endpoints.iter().map(|(v, r)| (&v[..], *r)).collect();
        let group = self.group.seen_at(&endpoints, shape).ok()?;
        let missing = group.missing(&endpoints, shape, self.paths.first().seed);
        failed.truncate(missing.len());
        if failed.is_empty() {
            return None;
        }
        let dimension = endpoints[0].0.len();
        let mut coordinates = vec![Complex64::default(); results.len() * dimension];
        for (path, point) in failed.iter().zip(missing) {
            let place = *path as usize % results.len() * dimension;
            coordinates[place..place + dimension].copy_from_slice(&point);
        }
        let points = Arc::new(StoredPoints {
            dimension,
            coordinates,
        });
        let stage = Stage {
            homotopy: HomotopyKind::Parameter {
                start: self.targets()[target].clone(),
                targets: self.targets().to_vec(),
            },
            start_points: StartPoints::Selected {
                base: Box::new(points.as_start()),
                indices: failed,
            },
            // Other patches: what lay badly in the first may lie well here.
            seed: RandomStream::new(self.paths.first().seed, Purpose::Loop, target as u64).bits(),
            ..self.paths.first().clone()
        };
        Some(Opening {
            stage,
            system: None,
            objects: vec![points],
        })
    }
}

impl Solve for ParameterSolve {
    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        loop {
            match self.paths.next_stage(numbers) {
                Next::Done if self.completed < self.targets().len() => {
                    let target = self.completed;
                    self.completed += 1;
                    if let Some(opening) = self.completion(target) {
                        return self.paths.open_last(opening, numbers);
                    }
                }
                next => return next,
            }
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        self.paths.absorb(stage, results);
    }

    fn progress(&self) -> Progress {
        self.paths.progress("parameter homotopy")
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        Some(self.paths.finite_endpoints())
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        let targets = self.targets().iter().enumerate();
        let set = |(k, parameters): (usize, &Vec<Complex64>)| {
            self.paths.solution_set(k, system, parameters, false)
        };
        Some(Answer::Isolated(IsolatedSolutions {
            sets: targets.map(set).collect(),
            loops: None,
            held: self.paths.held(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_locally::drive;
    use crate::solve::{PathAlgorithm, Root};
    use cognate_continuation::path_result::PathResult;
    use cognate_continuation::stage::PreparedStage;
    use cognate_continuation::start_points::Digest;
    use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
    use cognate_continuation::tracker::settings::Settings;
    use cognate_continuation::work::Work;
    use cognate_solutions::solution_set::SolutionSet;
    use std::collections::HashMap;

    /// x^4 = p with x and i x alike: from p = 1 to 16 and to i.
    fn solve() -> (System, ParameterSolve, Arc<StoredPoints>) {
        let text = r#"{"variables": ["x"], "parameters": ["p"], "equations": ["x^4 - p"],
            "symmetry": [{"map": {"x": "I*x"}}]}"#;
        let system = match cognate_systems::formats::read("test", text.as_bytes()) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        };
        let number = |re, im| Complex64::new(re, im);
        let points = Arc::new(StoredPoints {
            dimension: 1,
            coordinates: vec![
                number(1.0, 0.0),
                number(0.0, 1.0),
                number(-1.0, 0.0),
                number(0.0, -1.0),
            ],
        });
        let first = Stage::new(
            Work::Track,
            HomotopyKind::Parameter {
                start: vec![number(1.0, 0.0)],
                targets: vec![vec![number(16.0, 0.0)], vec![number(0.0, 1.0)]],
            },
            points.as_start(),
            Settings::default(),
            3,
        );
        let solve = ParameterSolve::new(first, &system, Tolerances::default());
        (system, solve, points)
    }

    /// Runs it with a tracker that loses these paths whenever they are followed from the start.
    fn run(lost: &[u64]) -> (Vec<SolutionSet>, usize) {
        let (system, solve, points) = solve();
        let mut root = Root::new(solve);
        let mut objects = HashMap::from([(points.digest(), Arc::clone(&points))]);
        let mut stages = 0;
        let done: Result<(), std::convert::Infallible> = drive(&mut root, &mut |opening| {
            let made = opening.objects.iter();
            objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
            let find = |digest: Digest| objects.get(&digest).cloned();
            let prepared = PreparedStage::new(&system, &opening.stage, &find).unwrap();
            let mut results: Vec<PathResult> = prepared.track(0..prepared.items(), 8);
            stages += 1;
            if opening.stage.start_points.object() == Some(points.digest()) {
                for result in results.iter_mut().filter(|r| lost.contains(&r.origin.0)) {
                    result.outcome = PathOutcome::Failed(Failure::TooManySteps);
                }
            }
            Ok(results)
        });
        assert_eq!(done, Ok(()));
        (root.solution_sets(&system), stages)
    }

    #[test]
    fn what_the_symmetry_names_takes_the_place_of_paths_that_failed() {
        let (clean, stages) = run(&[]);
        assert_eq!(stages, 1);
        let (completed, stages) = run(&[1, 2, 7]);
        // Three repetitions, then one completion for each target.
        assert_eq!(stages, 1 + 3 + 2);
        for (clean, completed) in clean.iter().zip(&completed) {
            assert!(clean.settled() && completed.settled());
            assert_eq!((completed.paths.total, completed.paths.finite), (4, 4));
            assert_eq!(completed.counts.distinct, 4);
            assert_eq!(completed.classes.complete, Some(1));
        }
        // Nothing is left to go on from.
        let (none, _) = run(&[0, 1, 2, 3]);
        assert_eq!((none[0].paths.failed, none[1].paths.failed), (4, 0));
    }
}
