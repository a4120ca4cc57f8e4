//! All isolated solutions of one system, from a start system, or by a homotopy of the user's own.

use crate::any_algorithm::AnyAlgorithm;
use crate::retried_stage::RetriedStage;
use crate::{Certifiable, Next, PathAlgorithm, Progress};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::{Stage, StageId};
use cognate_solutions::classification::Tolerances;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// One target: track all start points, track again what failed or crossed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ZeroDimensionalSolve {
    paths: RetriedStage,
    /// Values of the system's parameters at t = 0.
    parameters: Vec<Complex64>,
    /// The start points are those of a start system.
    complete_start: bool,
}

impl ZeroDimensionalSolve {
    /// The solve that begins with this stage.
    ///
    /// # Panics
    /// For a parameter homotopy, which has targets of its own, and for a polyhedral one.
    pub fn new(first: Stage, system: &System, tolerances: Tolerances) -> Self {
        let (parameters, complete_start) = match &first.homotopy {
            HomotopyKind::StraightLine { parameters } => (parameters.clone(), true),
            HomotopyKind::PathVariable { parameters } => {
                let mut parameters = parameters.clone();
                if let Some(t) = system.path_variable {
                    parameters[t] = Complex64::new(0.0, 0.0);
                }
                (parameters, false)
            }
            HomotopyKind::Parameter { .. } => {
                panic!("a parameter homotopy is planned as a parameter solve")
            }
            HomotopyKind::Toric | HomotopyKind::Generic { .. } => {
                panic!("a polyhedral homotopy is planned as a polyhedral solve")
            }
            HomotopyKind::Slide { .. } | HomotopyKind::Intersect { .. } => {
                panic!("a regeneration is planned as a regeneration solve")
            }
        };
        Self {
            paths: RetriedStage::new(first, system, tolerances, 1),
            parameters,
            complete_start,
        }
    }

    /// The same with another limit of repetitions.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.paths = self.paths.with_max_retries(max_retries);
        self
    }

    /// The paths and what is known about them.
    pub fn paths(&self) -> &RetriedStage {
        &self.paths
    }
}

impl PathAlgorithm for ZeroDimensionalSolve {
    fn next(&mut self) -> Next {
        self.paths.next_stage()
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = PathResult>) {
        self.paths.absorb(stage, results);
    }

    fn progress(&self) -> Progress {
        self.paths.progress("all isolated solutions")
    }

    fn snapshot(&self) -> Vec<u8> {
        AnyAlgorithm::ZeroDimensional(self.clone()).to_bytes()
    }

    fn certifiable(&self) -> Option<Certifiable> {
        Some(self.paths.certifiable())
    }

    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        vec![
            self.paths
                .solution_set(0, system, &self.parameters, self.complete_start),
        ]
    }
}
