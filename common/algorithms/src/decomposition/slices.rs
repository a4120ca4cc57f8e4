//! Slices: each dimension by itself, from the start system that has the fewest paths.
//!
//! The solutions of as many combinations of the equations as cut out a set of that dimension, on its slices, hold
//! a witness superset of it; nothing of one dimension rests on what was found in another. (Sommese, Wampler: The
//! Numerical Solution of Systems of Polynomials, 2005, section 13.2.) Combinations of few terms keep sparse systems
//! sparse, so that their mixed volumes can be far below the products of degrees.

use super::deflated::ProblemContext;
use super::dimension_start::DimensionStart;
use super::job::{DescribedSystem, Job, StageSystem, Tracking};
use super::problem::Problem;
use super::superset::Superset;
use cognate_continuation::bend::SlicedEquations;
use cognate_numeric::random::{Purpose, RandomStream};
use serde::{Deserialize, Serialize};

/// Most starts of a dimension with other combinations and at another generic system, if paths from mixed cells were
/// lost.
const MOST_BEGINNINGS: u32 = 8;

/// Dimension by dimension.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Slices {
    /// Number of rows that hold where the open stage ends; 0 before the first.
    rows: usize,
    /// Number of rows that hold at the end; `None`: down to the lowest dimension that is asked for.
    last: Option<usize>,
    supersets: Vec<Superset>,
    /// Number of earlier starts of the dimension; `best` is their best superset.
    beginnings: u32,
    best: Option<Superset>,
}

impl Slices {
    pub fn new() -> Self {
        Self {
            rows: 0,
            last: None,
            supersets: Vec::new(),
            beginnings: 0,
            best: None,
        }
    }

    /// All dimensions but the lowest; `levels` rows hold in the lowest.
    pub fn above(levels: usize) -> Self {
        Self {
            last: Some(levels - 1),
            ..Self::new()
        }
    }

    /// Supersets of all dimensions that are asked for and of the dimensions above them, highest first.
    pub fn supersets(&mut self) -> Vec<Superset> {
        std::mem::take(&mut self.supersets)
    }

    /// Describes the open stage in a few words.
    pub fn description(&self, problem: &Problem) -> String {
        format!(
            "solving on slices of dimension {}",
            problem.variables() - self.rows
        )
    }

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(&mut self, context: &mut ProblemContext<'_>, done: Option<&Job>) -> Option<Job> {
        let problem = context.problem;
        if let Some(job) = done {
            if job.is_uncounted() {
                return Some(self.job(context, true));
            }
            let superset = self.learn(problem, job);
            if superset.lost() > 0 && job.is_polyhedral() && self.beginnings < MOST_BEGINNINGS {
                self.best = Some(superset);
                return Some(self.job(context, false));
            }
            self.supersets.push(superset);
            self.beginnings = 0;
        }
        if self.rows == self.last.unwrap_or(problem.asked_levels) {
            return None;
        }
        self.rows += 1;
        Some(self.job(context, false))
    }

    /// Superset of this dimension from the paths of the job, or from an earlier start if that lost no more paths.
    fn learn(&mut self, problem: &Problem, job: &Job) -> Superset {
        let dimension = problem.variables() - self.rows;
        let mut superset = Superset::empty(dimension);
        let StageSystem::Combined { seed, keep, .. } = job.system else {
            unreachable!(
                "a dimension by itself is tracked by combinations, not {:?}",
                job.system
            )
        };
        let rows = problem.combined(dimension, seed, keep);
        let combinations = SlicedEquations::new(&rows, problem.slices(dimension));
        let others = superset.sort(problem, &combinations, job);
        if self.rows == problem.levels {
            superset.excess = others.len() as u64;
        }
        self.beginnings += 1;
        let earlier = self.best.take();
        match earlier.filter(|earlier| earlier.lost() <= superset.lost()) {
            Some(earlier) => earlier,
            None => superset,
        }
    }

    /// The paths to the dimension that is next: as many as the degrees say, or from the start with the fewest.
    fn job(&self, context: &mut ProblemContext<'_>, by_degrees: bool) -> Job {
        let problem = context.problem;
        let dimension = problem.variables() - self.rows;
        let seed = self.seed(problem);
        let mut made = |keep: bool| {
            let wanted = StageSystem::Combined {
                dimension,
                seed,
                keep,
            };
            let made = context.deflations.of_stage(problem, &wanted);
            let start = match by_degrees {
                true => DimensionStart::of_degrees(&made),
                false => DimensionStart::of(&made, seed),
            };
            (wanted, made, start)
        };
        let parameters = problem.slices(dimension).concat();
        let (wanted, made, start) = match made(self.keeps()) {
            // By degrees there are fewer paths where linear equations stay as they are.
            (_, _, DimensionStart::TotalDegree { .. }) => made(true),
            cells => cells,
        };
        let system = DescribedSystem {
            description: wanted,
            system: made,
        };
        let with = &problem.tracking;
        match start {
            DimensionStart::TotalDegree { degrees } => {
                Job::straight(system, parameters, degrees, with).ends_only()
            }
            DimensionStart::MixedCells { count } => {
                Job::polyhedral(system, parameters, count, &self.beginning(with, seed))
            }
        }
    }

    /// Seed of the combinations and of the generic system of a beginning.
    fn seed(&self, problem: &Problem) -> u64 {
        let number = u64::MAX - u64::from(self.beginnings);
        match self.beginnings {
            0 => problem.seed(),
            _ => RandomStream::new(problem.seed(), Purpose::StartSystem, number).bits(),
        }
    }

    /// Whether linear equations stay as they are in a beginning: in two of four. Their combinations have other ends
    /// near infinity than those without.
    fn keeps(&self) -> bool {
        self.beginnings / 2 % 2 == 1
    }

    /// The tracking of a beginning: all but the last give paths up, since in another beginning they are others, and a
    /// whole beginning takes less than the hardest of its paths; every other one does that later.
    fn beginning(&self, with: &Tracking, seed: u64) -> Tracking {
        let with = match self.beginnings {
            number if number + 1 == MOST_BEGINNINGS => with.clone(),
            number if number % 2 == 1 => with.given_up_later(),
            _ => with.soon_given_up(),
        };
        Tracking { seed, ..with }
    }
}
