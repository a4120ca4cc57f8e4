//! Slices: each dimension by itself, from a start system of the degrees of its equations.
//!
//! The solutions of as many combinations of the equations as cut out a set of that dimension, on its slices, hold
//! a witness superset of it; nothing of one dimension rests on what was found in another. (Sommese, Wampler: The
//! Numerical Solution of Systems of Polynomials, 2005, section 13.2.)

use super::deflated::Deflations;
use super::job::{Job, StageSystem};
use super::problem::Problem;
use super::superset::Superset;
use serde::{Deserialize, Serialize};

/// Dimension by dimension.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Slices {
    /// How many rows hold where the open stage ends; 0 before the first.
    rows: usize,
    supersets: Vec<Superset>,
}

impl Slices {
    pub fn new() -> Self {
        Self {
            rows: 0,
            supersets: Vec::new(),
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
        let n = problem.variables();
        if let Some(job) = done {
            let mut superset = Superset::empty(n - self.rows);
            let others = superset.sort(problem, job);
            if self.rows == problem.levels {
                superset.excess = others.len() as u64;
            }
            self.supersets.push(superset);
        }
        if self.rows == problem.asked_levels {
            return None;
        }
        self.rows += 1;
        let dimension = n - self.rows;
        let mut degrees = problem.row_degrees[..self.rows].to_vec();
        degrees.resize(n, 1);
        let system = StageSystem::Tracked {
            ranks: Vec::new(),
            dimension,
        };
        let made = deflations.of_stage(problem, &system);
        let parameters = problem.slices(dimension).concat();
        let job = Job::straight((system, &*made), parameters, degrees, &problem.tracking);
        Some(job.ends_only())
    }
}
