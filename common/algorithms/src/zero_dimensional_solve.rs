//! All isolated solutions of one system, from a start system, or by a homotopy of the user's own.

use crate::answer::{Answer, IsolatedSolutions};
use crate::finite_endpoints::FiniteEndpoints;
use crate::progress::Progress;
use crate::retried_stage::RetriedStage;
use crate::solve::{Next, Solve, StageNumbers};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::{Stage, StageId};
use cognate_solutions::classification::Tolerances;
use cognate_solutions::streamed::PathFilter;
use cognate_systems::polynomial::SolutionCount;
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
        let homotopy = &first.homotopy;
        let is_one = matches!(
            homotopy,
            HomotopyKind::StraightLine { .. } | HomotopyKind::PathVariable { .. }
        );
        assert!(is_one, "other homotopies have solves of their own");
        let parameters = homotopy.end_parameters(0, system.path_variable);
        Self {
            parameters: parameters.unwrap_or_default().into_owned(),
            complete_start: homotopy.takes_all_paths(),
            paths: RetriedStage::new(first, system, tolerances, 1),
        }
    }

    /// Puts paths that do not end regularly aside: they are tracked to their ends only if the others leave solutions of
    /// the system to be found. `settles_doubts`: whether the answer may be that of the equations without paths.
    #[must_use]
    pub fn regular_ends_first(mut self, system: &System, settles_doubts: bool) -> Self {
        self.paths = self.paths.regular_ends_first(system, settles_doubts);
        self
    }

    /// Replaces the limit of repetitions of a path.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.paths = self.paths.with_max_retries(max_retries);
        self
    }

    /// The paths and what is known about them.
    pub fn paths(&self) -> &RetriedStage {
        &self.paths
    }

    /// The paths and their results, to be told which results are held.
    pub fn paths_mut(&mut self) -> &mut RetriedStage {
        &mut self.paths
    }

    /// Filter of the solve's streamed paths, for the one target.
    pub fn filters(&self, system: &System) -> Vec<PathFilter> {
        let tolerances = self.paths.tolerances();
        let seed = self.paths.first().seed;
        vec![PathFilter::new(system, &self.parameters, tolerances, seed)]
    }
}

impl Solve for ZeroDimensionalSolve {
    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        self.paths.next_stage(numbers)
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        self.paths.absorb(stage, results);
    }

    fn progress(&self) -> Progress {
        self.paths.progress("all isolated solutions")
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        Some(self.paths.finite_endpoints())
    }

    fn answer(&self, system: &System) -> Option<Answer> {
        let (parameters, complete) = (&self.parameters, self.complete_start);
        let set = self.paths.solution_set(0, system, parameters, complete);
        Some(Answer::Isolated(IsolatedSolutions {
            sets: vec![set],
            loops: None,
            held: self.paths.held(),
        }))
    }

    fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        let confirmed = || self.paths.confirmed_results();
        self.paths.results_with_images().or_else(confirmed)
    }

    fn solution_count(&self) -> Option<SolutionCount> {
        self.paths.solution_count()
    }
}

#[cfg(test)]
mod tests {
    use crate::plan::SolveMethod;
    use crate::run_locally::run_locally;
    use crate::{PathAlgorithm, SolveOptions, plan};
    use cognate_solutions::solution_set::SolutionSet;
    use cognate_systems::formats;
    use num_complex::Complex64;

    fn solve(text: &str, start: SolveMethod) -> (u64, SolutionSet) {
        let problem = formats::read("test", text.as_bytes());
        let system = problem.expect("a problem of this test").system;
        let options = SolveOptions {
            method: start,
            seed: 7,
            ..SolveOptions::default()
        };
        let mut plan = plan(&system, &options).expect("a plan");
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        assert!(plan.algorithm.progress().done);
        let paths = plan.paths.expect("they are counted in planning");
        (paths, sets.expect("paths").remove(0))
    }

    fn values(set: &SolutionSet) -> Vec<Vec<Complex64>> {
        let values_of = |s: &cognate_solutions::solution::Solution| s.variables.values().collect();
        set.solutions.iter().map(values_of).collect()
    }

    #[test]
    fn one_half_and_its_images_are_the_whole() {
        let problem = |symmetry: &str| {
            format!(
                r#"{{"variables": ["x", "u", "y", "v"], "groups": [["x", "u"], ["v", "y"]],
                    "equations": ["x^2 - u*x + 3*u - 2", "x*y + u + v - 5",
                                  "y^2 - v*y + 3*v - 2", "2*u*v + x*v + y*u - 1"]{symmetry}}}"#
            )
        };
        let groups = SolveMethod::Multihomogeneous;
        let (paths, whole) = solve(&problem(""), groups.clone());
        assert_eq!((paths, whole.paths.total, whole.paths.images), (8, 8, 0));
        let swap = r#", "symmetry": [{"permutation": {"x": "y", "y": "x", "u": "v", "v": "u"}}]"#;
        let (paths, half) = solve(&problem(swap), groups);
        assert_eq!((paths, half.paths.total, half.paths.images), (4, 8, 4));
        assert!(half.settled() && whole.settled());
        assert_eq!(half.paths.finite, whole.paths.finite);
        assert_eq!(half.counts.distinct, whole.counts.distinct);
        assert!(half.counts.distinct > 2, "{half:?}");
        let whole_values = values(&whole);
        for half_value in values(&half) {
            let near = |other: &Vec<Complex64>| {
                let pairs = half_value.iter().zip(other);
                pairs.map(|(z, w)| (z - w).norm_sqr()).sum::<f64>() < 1e-18
            };
            assert_eq!(whole_values.iter().filter(|other| near(other)).count(), 1);
        }
        let classes = &half.classes;
        assert_eq!(classes.count, classes.complete, "every orbit is whole");
    }

    #[test]
    fn a_few_endpoints_on_a_named_set_say_what_the_others_are() {
        // The line x = 0, and three points off it.
        let text = r#"{"variables": ["x", "y"],
            "equations": ["x*(x^2 + y - 3)", "x*(x*y - 2*x - y + 5)"],
            "degenerate": {"x = 0": {"equations": ["x"]}, "y = 1": {"equations": ["y - 1"]}}}"#;
        let (paths, set) = solve(text, SolveMethod::TotalDegree);
        assert_eq!((paths, set.paths.finite, set.paths.failed), (9, 3, 0));
        let on_line = set.paths.degenerate["x = 0"];
        assert!(on_line > 3, "more than are asked: {:?}", set.paths);
        assert_eq!(set.paths.positive_dimensional, Some(on_line));
        assert_eq!(set.paths.degenerate["y = 1"], 0);
        assert!(set.warnings.is_empty(), "{:?}", set.warnings);
    }
}
