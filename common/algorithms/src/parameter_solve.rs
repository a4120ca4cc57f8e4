//! From solved generic parameters to the wanted ones, one solution set for each target.

use crate::any_algorithm::AnyAlgorithm;
use crate::retried_stage::RetriedStage;
use crate::{Certifiable, Next, PathAlgorithm, Progress};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::{Stage, StageId};
use cognate_solutions::classification::Tolerances;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// Many targets in one stage: item i starts at start point `i % starts` and
/// goes to target `i / starts`. Crossings are looked for within each target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterSolve {
    paths: RetriedStage,
}

impl ParameterSolve {
    /// The solve that begins with this stage.
    ///
    /// # Panics
    /// When it is no parameter homotopy, or has no target.
    pub fn new(first: Stage, system: &System, tolerances: Tolerances) -> Self {
        Self::with_shape(first, &PointShape::of(system), tolerances)
    }

    /// The same, where only the shape of the system's points is at hand.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn with_shape(first: Stage, shape: &PointShape, tolerances: Tolerances) -> Self {
        let HomotopyKind::Parameter { targets, .. } = &first.homotopy else {
            panic!("a parameter solve has a parameter homotopy");
        };
        let count = targets.len() as u64;
        Self {
            paths: RetriedStage::with_shape(first, shape.clone(), tolerances, count),
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

impl PathAlgorithm for ParameterSolve {
    fn next(&mut self) -> Next {
        self.paths.next_stage()
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = PathResult>) {
        self.paths.absorb(stage, results);
    }

    fn progress(&self) -> Progress {
        self.paths.progress("parameter homotopy")
    }

    fn snapshot(&self) -> Vec<u8> {
        AnyAlgorithm::Parameter(self.clone()).to_bytes()
    }

    fn certifiable(&self) -> Option<Certifiable> {
        Some(self.paths.certifiable())
    }

    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        let HomotopyKind::Parameter { targets, .. } = &self.paths.first().homotopy else {
            unreachable!("checked when it was made");
        };
        targets
            .iter()
            .enumerate()
            .map(|(k, parameters)| self.paths.solution_set(k, system, parameters, false))
            .collect()
    }
}
