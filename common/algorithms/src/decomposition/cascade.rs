//! The cascade: equation by equation, the solutions of all equations are taken out in each dimension.
//!
//! Level k holds points of the first k combinations of the equations on slices k, k+1, ...; its own slice
//! slides to as many forms as the next combination has degrees, and their product becomes that combination.
//! An end that solves all given equations belongs to the witness superset of dimension n - k - 1 and goes no
//! further; one that does not is regular with probability 1 and begins the next level.

use super::job::{Job, StageSystem};
use super::problem::Problem;
use super::superset::Superset;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::start_systems::slices::common_point;
use cognate_solutions::classification::Verdict;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Level by level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cascade {
    level: usize,
    /// Points that the level began with; with slid ones once it slid.
    points: Vec<Vec<Complex64>>,
    sliding: bool,
    failed: u64,
    supersets: Vec<Superset>,
    started: bool,
}

impl Cascade {
    pub fn new(problem: &Problem) -> Self {
        let start = common_point(problem.seed(), problem.variables());
        Self {
            level: 0,
            points: start.into_iter().collect(),
            sliding: false,
            failed: 0,
            supersets: Vec::new(),
            started: false,
        }
    }

    /// From these points of the first so many combinations, on the slices that are left.
    pub fn from_level(level: usize, points: Vec<Vec<Complex64>>) -> Self {
        Self {
            level,
            points,
            sliding: false,
            failed: 0,
            supersets: Vec::new(),
            started: false,
        }
    }

    /// The supersets that its levels came to, and of those that no path reached.
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

    /// The supersets of all dimensions that are asked and of those above, highest first.
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

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(&mut self, problem: &Problem, done: Option<&Job>) -> Option<Job> {
        match done {
            None if self.started => return None,
            None => self.started = true,
            Some(job) if self.sliding => self.slid(job),
            Some(job) => self.intersected(problem, job),
        }
        if self.points.is_empty() || self.level >= problem.asked_levels {
            return None;
        }
        let degree = problem.row_degrees[self.level];
        self.sliding = !self.sliding && degree > 1;
        let (parameters, level) = (Vec::new(), self.level as u32);
        let order = (0..problem.variables() as u32).collect();
        let homotopy = match self.sliding {
            true => HomotopyKind::MoveSlice {
                parameters,
                order,
                level,
                forms: degree - 1,
            },
            false => HomotopyKind::ProductToEquation {
                parameters,
                order,
                level,
            },
        };
        let system = (StageSystem::Staircase, &*problem.staircase);
        let with = &problem.tracking;
        Some(Job::track(system, homotopy, &self.points, with))
    }

    /// What the level is for, in a few words.
    pub fn description(&self, problem: &Problem) -> String {
        let lowest = problem.variables().saturating_sub(self.level + 1);
        match self.sliding {
            true => format!("moving slices for dimension {lowest}"),
            false => format!("cutting down to dimension {lowest}"),
        }
    }

    fn slid(&mut self, job: &Job) {
        for (_, decision, values) in job.ends() {
            match decision.verdict {
                Verdict::Finite => self.points.push(values),
                // From one general slice to another all solutions are regular.
                _ => self.failed += 1,
            }
        }
        self.failed += job.crossings_left();
    }

    fn intersected(&mut self, problem: &Problem, job: &Job) {
        let dimension = problem.variables() - self.level - 1;
        let mut superset = Superset {
            dimension,
            failed: self.failed,
            ..Superset::default()
        };
        self.points = superset.sort(problem, &problem.level_equations(dimension), job);
        self.level += 1;
        if self.level == problem.levels {
            superset.excess = std::mem::take(&mut self.points).len() as u64;
        }
        // What is not gone on from may lead to sets of lower dimension.
        self.failed = superset.failed + superset.unclear;
        self.supersets.push(superset);
    }
}
