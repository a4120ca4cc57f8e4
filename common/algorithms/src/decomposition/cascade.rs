//! The cascade: equation by equation, the solutions of all equations are taken out in each dimension.
//!
//! Level k holds points of the first k combinations of the equations on slices k, k+1, ...; its own slice
//! slides to as many forms as the next combination has degrees, and their product becomes that combination.
//! An end that solves all given equations belongs to the witness superset of dimension n - k - 1 and goes no
//! further; one that does not is regular with probability 1 and begins the next level.
//!
//! Where it begins on a multiple set, that set's deflated equations stand for the combinations that hold on it.

use super::deflated::ProblemContext;
use super::job::{DescribedSystem, Job, StageSystem};
use super::multiple_cut::{self, DeflatedSet};
use super::problem::Problem;
use super::superset::Superset;
use crate::regeneration_solve::level_homotopy;
use cognate_continuation::start_systems::slices::common_point;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Level by level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cascade {
    level: usize,
    state: State,
    /// Points that the level began with; after its slice moved, also those to which it moved.
    points: Vec<Vec<Complex64>>,
    failed: u64,
    supersets: Vec<Superset>,
    /// The multiple set on which it began; points have its multipliers, too.
    multiple: Option<DeflatedSet>,
}

/// State of a cascade: the stage that is under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum State {
    /// No stage has been asked for.
    Start,
    /// The slice of the level moves.
    MoveSlice,
    /// The product of the forms becomes the combination of the level.
    Cut,
}

impl Cascade {
    pub fn new(problem: &Problem) -> Self {
        let start = common_point(problem.seed(), problem.variables());
        Self::from_level(0, start.into_iter().collect())
    }

    /// Begins with these points of the first `level` combinations, on the slices that are left.
    pub fn from_level(level: usize, points: Vec<Vec<Complex64>>) -> Self {
        Self {
            level,
            state: State::Start,
            points,
            failed: 0,
            supersets: Vec::new(),
            multiple: None,
        }
    }

    /// Begins with these points of a multiple set, whose dimension the first combinations have, on the slices that are
    /// left.
    pub fn on_multiple(problem: &Problem, set: DeflatedSet, points: Vec<Vec<Complex64>>) -> Self {
        Self {
            multiple: Some(set.clone()),
            ..Self::from_level(problem.variables() - set.dimension, points)
        }
    }

    /// Supersets that the levels found, and empty supersets for the levels that no path reached.
    pub fn take_supersets(&mut self, problem: &Problem) -> Vec<Superset> {
        let mut supersets = std::mem::take(&mut self.supersets);
        for level in self.level..problem.asked_levels {
            supersets.push(Superset {
                failed: self.failed,
                ..Superset::empty(problem.variables() - level - 1)
            });
        }
        supersets
    }

    /// Supersets of all dimensions that are asked for and of the dimensions above them, highest first.
    pub fn supersets(&mut self, problem: &Problem) -> Vec<Superset> {
        let mut supersets = std::mem::take(&mut self.supersets);
        // Levels that no path reached have no points, but for those of paths that were lost before.
        for level in supersets.len()..problem.asked_levels {
            supersets.push(Superset {
                dimension: problem.variables() - level - 1,
                failed: self.failed,
                ..Superset::default()
            });
        }
        supersets
    }

    /// Learns from the stage that is done, and says which comes next. `set_problem`: the problem of the multiple set on
    /// which it began.
    pub fn advance(
        &mut self,
        problem: &Problem,
        mut set_problem: Option<&mut ProblemContext<'_>>,
        done: Option<&Job>,
    ) -> Option<Job> {
        match (self.state, done) {
            (State::Start, _) => {}
            (State::MoveSlice | State::Cut, None) => return None,
            (State::MoveSlice, Some(job)) => self.slid(job),
            (State::Cut, Some(job)) => {
                self.intersected(problem, set_problem.as_deref_mut(), job);
            }
        }
        if self.points.is_empty() || self.level >= problem.asked_levels {
            return None;
        }
        let degree = problem.row_degrees[self.level];
        self.state = if degree > 1 && self.state != State::MoveSlice {
            State::MoveSlice
        } else {
            State::Cut
        };
        if let (Some(set), Some(set_problem)) = (&self.multiple, set_problem) {
            let forms = multiple_cut::forms(self.state == State::MoveSlice, degree);
            let description = set.stage([self.before(problem, set) as u32, 0], forms);
            let system = DescribedSystem {
                system: self.system_of(problem, set_problem, &description),
                description,
            };
            let how = (problem.variables() - self.level, degree, forms);
            return Some(multiple_cut::job(problem, system, how, &self.points));
        }
        let order = (0..problem.variables() as u32).collect();
        let other_forms = (self.state == State::MoveSlice).then(|| degree - 1);
        let homotopy = level_homotopy(Vec::new(), order, self.level as u32, other_forms);
        let system = DescribedSystem {
            description: StageSystem::Staircase,
            system: Arc::clone(&problem.staircase),
        };
        let with = &problem.tracking;
        // Singular ends that solve all equations are asked about with these, in `junk`.
        Some(Job::track(system, homotopy, &self.points, with).ends_only())
    }

    /// The system of a stage on a multiple set.
    pub fn system_of(
        &self,
        problem: &Problem,
        set_problem: &mut ProblemContext<'_>,
        wanted: &StageSystem,
    ) -> Arc<System> {
        let by = || match &self.multiple {
            Some(set) => self.further(problem, set, self.before(problem, set) + 1),
            None => unreachable!("it began on a set that is not multiple"),
        };
        multiple_cut::system_of(set_problem, wanted, by)
    }

    /// Number of further combinations that hold already.
    fn before(&self, problem: &Problem, set: &DeflatedSet) -> usize {
        self.level + set.dimension - problem.variables()
    }

    /// The first `count` combinations that cut the multiple set.
    fn further(&self, problem: &Problem, set: &DeflatedSet, count: usize) -> System {
        let mut by = (*problem.staircase).clone();
        let first = problem.variables() - set.dimension;
        by.equations = by.equations[first..first + count].to_vec();
        by.equation_names = by.equation_names[first..first + count].to_vec();
        by
    }

    /// Describes the purpose of the level in a few words.
    pub fn description(&self, problem: &Problem) -> String {
        let lowest = problem.variables().saturating_sub(self.level + 1);
        match self.state {
            State::MoveSlice => format!("moving slices for dimension {lowest}"),
            State::Start | State::Cut => format!("cutting down to dimension {lowest}"),
        }
    }

    fn slid(&mut self, job: &Job) {
        let (points, lost) = job.regular_ends();
        self.points.extend(points);
        self.failed += lost;
    }

    fn intersected(
        &mut self,
        problem: &Problem,
        set_problem: Option<&mut ProblemContext<'_>>,
        job: &Job,
    ) {
        let dimension = problem.variables() - self.level - 1;
        let mut superset = Superset {
            dimension,
            failed: self.failed,
            ..Superset::default()
        };
        let combinations = match (&self.multiple, set_problem) {
            (Some(set), Some(set_problem)) => {
                let by = self.further(problem, set, self.before(problem, set) + 1);
                set.sliced(set_problem, &by)
            }
            _ => problem.level_equations(dimension),
        };
        self.points = superset.sort(problem, &combinations, job);
        self.level += 1;
        if self.level == problem.levels {
            superset.excess = std::mem::take(&mut self.points).len() as u64;
        }
        // A point that no level goes on from may lead to sets of lower dimension.
        self.failed = superset.failed + superset.unclear;
        self.supersets.push(superset);
    }
}
