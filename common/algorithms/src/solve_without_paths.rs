//! SolveWithoutPaths: solutions that are computed while the solve is planned; no worker has anything to do but for
//! certificates.

use crate::answer::Answer;
use crate::exact_count::MOST_OPERATIONS;
use crate::finite_endpoints::{FiniteEndpoint, FiniteEndpoints};
use crate::plan_error::PlanError;
use crate::progress::{Progress, VerdictCounts};
use crate::solve::{Next, Solve, StageNumbers};
use crate::solve_options::SolveOptions;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::StageId;
use cognate_numeric::rational::ComplexRational;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::involution::Involution;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::summary::SolutionCounts;
use cognate_systems::polynomial::{SolutionCount, solution_count};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Reason why there are no paths, and no isolated solution.
pub(crate) const NO_PATHS: &str =
    "no path by the variable groups: their multihomogeneous Bezout number is 0";

/// All solutions of a system, each as often as it counts: for as many as its multiplicity there is a number of a path,
/// and a result.
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

    /// No isolated solution, where the number of paths by the groups is 0; whether there are sets of solutions is counted.
    ///
    /// # Errors
    /// When the count contradicts that.
    pub(crate) fn without_solutions(
        system: &System,
        parameters: &[Complex64],
        options: &SolveOptions,
    ) -> Result<Self, PlanError> {
        let has_sets = match solution_count(system, parameters, MOST_OPERATIONS) {
            Ok(counted) if counted.is_general => None,
            Ok(counted) => match counted.count {
                SolutionCount::Finite {
                    with_multiplicity: 0,
                    ..
                } => Some(false),
                SolutionCount::Finite { .. } => return Err(PlanError::NoPaths),
                SolutionCount::Infinite { .. } => Some(true),
            },
            Err(_) => None,
        };
        let involution = Involution::of(system, parameters);
        let mut set = SolutionSet::default();
        set.paths.positive_dimensional = Some(0);
        set.paths.excess = Some(0);
        set.counts = SolutionCounts {
            real: involution.is_ok().then_some(0),
            real_reason: involution.err().map(|reason| reason.to_string()),
            positive_dimensional: has_sets,
            complete: Completeness::Yes,
            complete_reason: Some(NO_PATHS.to_string()),
            ..SolutionCounts::default()
        };
        Ok(Self::new(set, Vec::new(), parameters, options))
    }

    /// Number of solutions with their multiplicities.
    pub fn paths(&self) -> u64 {
        self.set.paths.total
    }
}

/// A solution as an end of as many paths as its multiplicity.
pub(crate) struct ExactEnd {
    /// The unknowns, rounded to doubles.
    pub values: Vec<Complex64>,
    pub multiplicity: u32,
    /// Largest residual of an equation, relative to the sum of its terms' absolute values.
    pub residual: f64,
    pub condition: f64,
    /// Error of the unknowns, relative to the largest.
    pub accuracy: f64,
    pub precision_bits: u32,
}

/// The solutions as results of paths, each as often as it counts.
pub(crate) fn results(system: &System, ends: impl Iterator<Item = ExactEnd>) -> Vec<PathResult> {
    let shape = PointShape::of(system);
    let mut results = Vec::new();
    for end in ends {
        let outcome = match end.multiplicity {
            1 => PathOutcome::Regular,
            _ => PathOutcome::Singular,
        };
        for _ in 0..end.multiplicity {
            let origin = results.len() as u64;
            let endpoint = shape.to_coordinates(&end.values);
            results.push(PathResult {
                residual: end.residual,
                condition: end.condition,
                accuracy: end.accuracy,
                winding_number: (end.multiplicity > 1).then_some(end.multiplicity),
                precision_bits: end.precision_bits,
                ..PathResult::untracked(origin, 0, outcome, endpoint)
            });
        }
    }
    results
}

/// Whether doubles hold both parts of a number.
pub(crate) fn has_double(exact: &ComplexRational, rounded: Complex64) -> bool {
    let holds = |exact_is_zero: bool, part: f64| exact_is_zero || part.is_normal();
    holds(exact.re == 0, rounded.re) && holds(exact.im == 0, rounded.im)
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
        (self.set.counts.positive_dimensional == Some(false)).then_some(SolutionCount::Finite {
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
