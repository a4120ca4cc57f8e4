//! Slices: each dimension by itself, from the start system that has the fewest paths.
//!
//! The solutions of as many combinations of the equations as cut out a set of that dimension, on its slices, hold
//! a witness superset of it; nothing of one dimension rests on what was found in another. (Sommese, Wampler: The
//! Numerical Solution of Systems of Polynomials, 2005, section 13.2.) Combinations of few terms keep sparse systems
//! sparse, so that their mixed volumes can be far below the products of degrees.

use super::deflated::Deflations;
use super::dimension_start::DimensionStart;
use super::job::{Job, StageSystem, Tracking};
use super::problem::Problem;
use super::superset::Superset;
use cognate_numeric::random::{Purpose, RandomStream};
use serde::{Deserialize, Serialize};

/// How often a dimension is begun at another generic system, where paths from mixed cells were lost.
const MOST_BEGINNINGS: u32 = 4;

/// Dimension by dimension.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Slices {
    /// How many rows hold where the open stage ends; 0 before the first.
    rows: usize,
    supersets: Vec<Superset>,
    /// How often the dimension was begun before, and the best that was found then.
    beginnings: u32,
    best: Option<Superset>,
}

impl Slices {
    pub fn new() -> Self {
        Self {
            rows: 0,
            supersets: Vec::new(),
            beginnings: 0,
            best: None,
        }
    }

    /// The supersets of all dimensions that are asked and of those above, highest first.
    pub fn supersets(&mut self) -> Vec<Superset> {
        std::mem::take(&mut self.supersets)
    }

    /// What it does, in a few words.
    pub fn description(&self, problem: &Problem) -> String {
        format!(
            "solving on slices of dimension {}",
            problem.variables() - self.rows
        )
    }

    /// Learns from the stage that is done, and says which comes next.
    pub fn advance(
        &mut self,
        (problem, deflations): (&Problem, &mut Deflations),
        done: Option<&Job>,
    ) -> Option<Job> {
        if let Some(job) = done {
            if job.is_uncounted() {
                let start = DimensionStart::of_degrees(problem, self.rows);
                return Some(self.job(problem, deflations, Some(start)));
            }
            let superset = self.learn(problem, job);
            if superset.lost() > 0 && job.is_polyhedral() && self.beginnings < MOST_BEGINNINGS {
                self.best = Some(superset);
                return Some(self.job(problem, deflations, None));
            }
            self.supersets.push(superset);
            self.beginnings = 0;
        }
        if self.rows == problem.asked_levels {
            return None;
        }
        self.rows += 1;
        Some(self.job(problem, deflations, None))
    }

    /// What the paths of the dimension found; where those of an earlier beginning lost less, what they found.
    fn learn(&mut self, problem: &Problem, job: &Job) -> Superset {
        let dimension = problem.variables() - self.rows;
        let mut superset = Superset::empty(dimension);
        let others = superset.sort(problem, &problem.tracked_equations(dimension), job);
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

    /// The paths to the dimension that is next, from this start or from the one with the fewest paths.
    fn job(
        &self,
        problem: &Problem,
        deflations: &mut Deflations,
        start: Option<DimensionStart>,
    ) -> Job {
        let dimension = problem.variables() - self.rows;
        let wanted = StageSystem::Tracked {
            ranks: Vec::new(),
            dimension,
        };
        let made = deflations.of_stage(problem, &wanted);
        let parameters = problem.slices(dimension).concat();
        let with = self.beginning(&problem.tracking);
        let seed = with.seed;
        let start = start.unwrap_or_else(|| DimensionStart::of(problem, self.rows, &made, seed));
        let system = (wanted, &*made);
        match start {
            DimensionStart::TotalDegree { degrees } => {
                Job::straight(system, parameters, degrees, &problem.tracking).ends_only()
            }
            DimensionStart::MixedCells { count } => {
                Job::polyhedral(system, parameters, count, &with)
            }
        }
    }

    /// The tracking of one beginning: a path that is lost twice is not tracked a third time, since another
    /// beginning has other paths.
    fn beginning(&self, with: &Tracking) -> Tracking {
        let number = u64::MAX - u64::from(self.beginnings);
        let mut random = RandomStream::new(with.seed, Purpose::StartSystem, number);
        Tracking {
            seed: match self.beginnings {
                0 => with.seed,
                _ => random.bits(),
            },
            max_retries: with.max_retries.min(1),
            ..with.clone()
        }
    }
}
