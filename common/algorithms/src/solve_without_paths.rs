//! SolveWithoutPaths: solutions that are computed while the solve is planned; no worker has anything to do but for
//! certificates.

use crate::answer::Answer;
use crate::finite_endpoints::{FiniteEndpoint, FiniteEndpoints};
use crate::progress::{Progress, VerdictCounts};
use crate::solve::{Next, Solve, StageNumbers};
use crate::solve_options::SolveOptions;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::StageId;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::polynomial::SolutionCount;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// All solutions of a system, each as often as it counts: for as many as its multiplicity there is a number of a path, and
/// a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolveWithoutPaths {
    set: SolutionSet,
    results: Vec<PathResult>,
    parameters: Vec<Complex64>,
    seed: u64,
    settings: Settings,
}

impl SolveWithoutPaths {
    /// From the solutions and a result for each number of a path.
    pub(crate) fn new(
        set: SolutionSet,
        results: Vec<PathResult>,
        parameters: &[Complex64],
        options: &SolveOptions,
    ) -> Self {
        Self {
            set,
            results,
            parameters: parameters.to_vec(),
            seed: options.seed,
            settings: options.tracking.settings.clone(),
        }
    }

    /// Number of solutions with their multiplicities.
    pub fn paths(&self) -> u64 {
        self.set.paths.total
    }
}

impl Solve for SolveWithoutPaths {
    fn next(&mut self, _: &mut StageNumbers) -> Next {
        Next::Done
    }

    fn absorb(&mut self, stage: StageId, _: &mut dyn Iterator<Item = ItemResult>) {
        unreachable!("no stage {stage:?} was opened");
    }

    fn progress(&self) -> Progress {
        let paths = &self.set.paths;
        Progress {
            description: "all solutions, without paths".to_string(),
            stages: Vec::new(),
            paths: VerdictCounts {
                finite: paths.finite + paths.removed,
                singular: paths.singular,
                ..VerdictCounts::default()
            },
            done: true,
        }
    }

    fn answer(&self, _: &System) -> Option<Answer> {
        Some(vec![self.set.clone()].into())
    }

    fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        Some(self.results.clone())
    }

    fn solution_count(&self) -> Option<SolutionCount> {
        Some(SolutionCount::Finite {
            with_multiplicity: self.set.counts.with_multiplicity,
            distinct: Some(self.set.counts.distinct),
        })
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        let endpoints = |singular: bool| {
            let of_kind = self.set.solutions.iter().filter(|s| s.singular == singular);
            let each = of_kind.map(|solution| FiniteEndpoint {
                target: 0,
                path: solution.paths[0],
                values: solution.variables.values().collect(),
            });
            each.collect()
        };
        Some(FiniteEndpoints {
            homotopy: HomotopyKind::StraightLine {
                parameters: self.parameters.clone(),
            },
            seed: self.seed,
            settings: self.settings.clone(),
            regular: endpoints(false),
            singular: endpoints(true),
        })
    }
}
