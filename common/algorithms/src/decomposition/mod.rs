//! Decomposition: every irreducible component of every dimension, by witness sets.
//!
//! A cascade finds, for each dimension, points on general slices: a witness superset ([`cascade`]).
//! What lies on sets of higher dimension is junk ([`junk`]); points of multiple sets get equations that
//! are regular there ([`deflated`]); derivatives of the witness points along a moving slice, and loops of
//! the slice, tell components apart ([`split`]). (Hauenstein, Sommese, Wampler: Regenerative cascade
//! homotopies, 2011; Brake, Hauenstein, Liddell: Decomposing solution sets using derivatives, 2016.)
//!
//! Stages differ in their systems: [`DecompositionSolve::system`] says which one a stage is tracked on.

mod cascade;
mod deflated;
mod job;
mod junk;
mod options;
mod problem;
mod split;

use crate::{Next, Opening};
use cascade::Cascade;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::StageId;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::{
    ComponentId, Decomposition, Dimension, Doubt, TrackedPaths, WitnessSet,
};
use cognate_systems::system::System;
use deflated::PureSet;
use job::{Job, Tracking};
use junk::Sieve;
pub use options::DecompositionOptions;
use problem::Problem;
pub use problem::ProblemError;
use split::Split;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// Where a decomposition is.
#[derive(Debug)]
enum Step {
    /// Equation by equation: points of all dimensions.
    Cascade(Cascade),
    /// Dimension by dimension, highest first: what is junk and what is multiple.
    Sieve(Sieve),
    /// Set by set: components.
    Split(Split),
    /// All is known.
    Done(Box<Decomposition>),
}

/// A whole decomposition, as a plan that asks for paths and learns from results.
#[derive(Debug)]
pub struct DecompositionSolve {
    problem: Problem,
    step: Step,
    job: Option<Job>,
    /// The system of each stage.
    systems: Vec<Arc<System>>,
    /// What is known of each dimension, highest first.
    dimensions: Vec<Dimension>,
    /// Sets of one dimension and multiplicity, not yet told apart, and components made of them.
    sets: Vec<PureSet>,
    components: Vec<WitnessSet>,
    paths: TrackedPaths,
    paths_of_loops: TrackedPaths,
}

impl DecompositionSolve {
    /// The decomposition of a system that has been checked.
    pub fn new(system: &System, options: &DecompositionOptions) -> Result<Self, ProblemError> {
        let tracking = Tracking {
            settings: options.settings.clone(),
            tolerances: options.tolerances.clone(),
            max_retries: options.max_retries,
            seed: options.seed,
        };
        let problem = Problem::new(system, tracking, options)?;
        Ok(Self {
            step: Step::Cascade(Cascade::new(&problem)),
            problem,
            job: None,
            systems: Vec::new(),
            dimensions: Vec::new(),
            sets: Vec::new(),
            components: Vec::new(),
            paths: TrackedPaths::default(),
            paths_of_loops: TrackedPaths::default(),
        })
    }

    /// What is wanted next. Called until it says `Wait` or `Done`, and again after each absorption.
    pub fn next_stage(&mut self) -> Next {
        loop {
            if let Some(job) = &mut self.job {
                match job.next() {
                    Next::Open(opening) => {
                        let system = Arc::clone(&job.system);
                        self.systems.push(system);
                        return Next::Open(opening);
                    }
                    Next::Wait => return Next::Wait,
                    Next::Done => {}
                }
            }
            let done = self.job.take();
            let paths = done.as_ref().map_or_else(TrackedPaths::default, Job::paths);
            let id = StageId(self.systems.len() as u32);
            self.job = match &mut self.step {
                Step::Done(_) => return Next::Done,
                Step::Cascade(cascade) => {
                    self.paths.add(&paths);
                    cascade.advance(&self.problem, done.as_ref(), id)
                }
                Step::Sieve(sieve) => {
                    self.paths.add(&paths);
                    sieve.advance(&self.problem, done.as_ref(), id, &mut self.sets)
                }
                Step::Split(split) => {
                    self.paths_of_loops.add(&paths);
                    split.advance(&self.problem, done.as_ref(), id)
                }
            };
            if self.job.is_none() {
                self.next_step();
            }
        }
    }

    /// Goes on where a step has no more work.
    fn next_step(&mut self) {
        match &mut self.step {
            Step::Cascade(cascade) => {
                self.step = Step::Sieve(Sieve::new(cascade.supersets(&self.problem)));
                return;
            }
            Step::Sieve(sieve) => {
                let asked = |number: usize| self.problem.asked.contains(&(number as u32));
                self.dimensions = sieve.dimensions();
                self.dimensions.retain(|d| asked(d.number as usize));
                self.sets.retain(|set| asked(set.dimension));
            }
            Step::Split(split) => {
                let (found, dimension) = split.components(&self.problem);
                self.components.extend(found);
                let of = self.dimensions.iter_mut();
                if let Some(known) = of.into_iter().find(|d| d.number == dimension.number) {
                    known.doubts.extend(dimension.doubts);
                }
            }
            Step::Done(_) => {}
        }
        self.step = match self.sets.is_empty() {
            false => Step::Split(Split::new(&self.problem, self.sets.remove(0))),
            true => Step::Done(Box::new(self.summary())),
        };
    }

    fn summary(&mut self) -> Decomposition {
        let mut components = std::mem::take(&mut self.components);
        let key = |set: &WitnessSet| {
            let mut points: Vec<Vec<i64>> = set.points.iter().map(|p| grid(p)).collect();
            points.sort();
            points
        };
        components.sort_by_cached_key(|set| {
            let by = std::cmp::Reverse((set.dimension(), set.degree, set.multiplicity.scheme));
            (by, key(set))
        });
        let mut dimensions = std::mem::take(&mut self.dimensions);
        for dimension in &mut dimensions {
            let own = components.iter_mut();
            let own = own.filter(|set| set.dimension() == dimension.number);
            for (number, set) in (1..).zip(own) {
                set.id = ComponentId {
                    dimension: dimension.number,
                    number,
                };
                dimension.degree += set.degree;
            }
            let missing = dimension.doubts.contains(&Doubt::PointsMissing);
            dimension.complete = match dimension.doubts.is_empty() {
                true => Completeness::Yes,
                false if missing => Completeness::No,
                false => Completeness::NotKnown,
            };
        }
        Decomposition {
            ambient: self.problem.variables() as u32,
            asked: [*self.problem.asked.start(), *self.problem.asked.end()],
            components,
            dimensions,
            paths: self.paths,
            paths_of_loops: self.paths_of_loops,
        }
    }

    /// Takes the results of one stage, complete and in item order.
    pub fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = PathResult>) {
        let job = self.job.as_mut().expect("only an open stage is absorbed");
        job.absorb(stage, results);
    }

    /// The system that an opened stage is tracked on.
    pub fn system(&self, stage: StageId) -> Option<&Arc<System>> {
        self.systems.get(stage.0 as usize)
    }

    /// What was found, when `next_stage` has said `Done`.
    pub fn decomposition(&self) -> Option<&Decomposition> {
        match &self.step {
            Step::Done(found) => Some(found),
            _ => None,
        }
    }
}

/// Coordinates on a grid of 10^-6: an order of points that rounding errors do not change, unless on a border.
fn grid(point: &[num_complex::Complex64]) -> Vec<i64> {
    let place = |x: f64| (x * 1e6).round() as i64;
    point
        .iter()
        .flat_map(|z| [place(z.re), place(z.im)])
        .collect()
}

/// Drives a decomposition until it is done. `track` does all items of a stage on its system, in item order;
/// its first error ends the run.
pub fn drive<E>(
    solve: &mut DecompositionSolve,
    mut track: impl FnMut(&System, &Opening) -> Result<Vec<PathResult>, E>,
) -> Result<(), E> {
    let mut open: VecDeque<Box<Opening>> = VecDeque::new();
    loop {
        match solve.next_stage() {
            Next::Open(opening) => open.push_back(opening),
            Next::Wait => {
                let opening = open.pop_front();
                let opening = opening.expect("it waits only for a stage that it opened");
                let system = solve.system(opening.stage.id);
                let results = track(system.expect("an opened stage has one"), &opening)?;
                solve.absorb(opening.stage.id, &mut results.into_iter());
            }
            Next::Done => return Ok(()),
        }
    }
}

/// Decomposes in one thread, with lanes of this width.
///
/// ```
/// use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve, run_locally};
///
/// let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y; function f; f = (x - y)*(x^2 + y^2 - 1);\nEND;\n";
/// let system = cognate_systems::formats::read("example", text)?.system;
/// let solve = DecompositionSolve::new(&system, &DecompositionOptions::default())?;
/// let found = run_locally(solve, 8)?;
/// let degrees: Vec<u64> = found.components.iter().map(|set| set.degree).collect();
/// assert_eq!(degrees, [2, 1]);
/// assert!(found.settled());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_locally(
    mut solve: DecompositionSolve,
    width: usize,
) -> Result<Decomposition, PrepareError> {
    let mut objects: HashMap<Digest, Arc<StoredPoints>> = HashMap::new();
    drive(&mut solve, |system, opening| {
        let made = opening.objects.iter();
        objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
        let find = |digest: Digest| objects.get(&digest).cloned();
        let prepared = PreparedWork::new(system, &opening.stage, &find)?;
        Ok::<_, PrepareError>(prepared.run(0..prepared.items(), width))
    })?;
    let found = solve.decomposition().cloned();
    Ok(found.expect("it says what it found when it is done"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
    use cognate_systems::formats;

    /// Decomposes with a tracker that spoils the results of each stage of the cascade.
    fn decompose(text: &str, spoil: impl Fn(&mut Vec<PathResult>)) -> Decomposition {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        let system = formats::read("test", text.as_bytes()).unwrap().system;
        let options = DecompositionOptions {
            // What is spoilt stays spoilt.
            max_retries: 0,
            ..DecompositionOptions::default()
        };
        let mut solve = DecompositionSolve::new(&system, &options).unwrap();
        let mut objects = HashMap::new();
        let done: Result<(), PrepareError> = drive(&mut solve, |system, opening| {
            let made = opening.objects.iter();
            objects.extend(made.map(|points| (points.digest(), Arc::clone(points))));
            let find = |digest: Digest| objects.get(&digest).cloned();
            let prepared = PreparedWork::new(system, &opening.stage, &find)?;
            let mut results = prepared.run(0..prepared.items(), 8);
            spoil(&mut results);
            Ok(results)
        });
        assert_eq!(done, Ok(()));
        solve.decomposition().unwrap().clone()
    }

    /// A parabola and a circle.
    const CURVES: &str = "variable_group x, y; function f; f = (y - x^2)*(x^2 + y^2 - 3);";

    #[test]
    fn two_curves_are_told_apart() {
        let found = decompose(CURVES, |_| {});
        let degrees: Vec<u64> = found.components.iter().map(|set| set.degree).collect();
        assert_eq!(degrees, [2, 2]);
        assert!(found.settled() && found.adds_up(), "{found:?}");
        for set in &found.components {
            for point in &set.points {
                let (x, y) = (point[0], point[1]);
                let value = (y - x * x) * (x * x + y * y - 3.0);
                assert!(value.norm_sqr() < 1e-24);
                let slice = &set.slice[0];
                let on_slice = slice[0] + slice[1] * x + slice[2] * y;
                assert!(on_slice.norm_sqr() < 1e-24);
            }
        }
    }

    #[test]
    fn a_lost_path_leaves_nothing_settled() {
        // Four paths end at the four witness points: the last of them is lost, however often it is tracked.
        let lost = |results: &mut Vec<PathResult>| {
            for result in results.iter_mut().filter(|r| r.origin.0 == 3) {
                result.outcome = PathOutcome::Failed(Failure::TooManySteps);
            }
        };
        let found = decompose(CURVES, lost);
        assert!(!found.settled());
        let [dimension] = found.dimensions.as_slice() else {
            panic!("one equation in two unknowns has curves: {found:?}");
        };
        assert_eq!(dimension.complete, Completeness::No);
        assert!(dimension.doubts.contains(&Doubt::PointsMissing));
        // What is whole is still a component.
        assert!(
            found.components.iter().any(|set| set.settled()),
            "{found:?}"
        );
    }

    #[test]
    fn a_point_that_is_no_solution_is_not_taken() {
        // The first path's end is moved away.
        let moved = |results: &mut Vec<PathResult>| {
            let cognate_continuation::path_result::Coordinates::Double(end) =
                &mut results[0].endpoint;
            end[1] += 0.3;
        };
        let found = decompose(CURVES, moved);
        assert!(!found.settled(), "{found:?}");
    }
}
