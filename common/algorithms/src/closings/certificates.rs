//! Certificates: after the paths the nonsingular solutions are certified, each alone, by workers.
//!
//! A solution is found to be one only when a box shows that it is; two that overlap are one. What a
//! certificate proves of several together, that they are distinct or real, is said once all are here.

use super::stage::ClosingStage;
use crate::finite_endpoints::FiniteEndpoints;
use crate::progress::Progress;
use crate::solve::{Next, StageNumbers};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::points_at_targets::parameters_at_targets;
use cognate_continuation::work::{StageId, Work};
use cognate_numeric::counted::counted;
use cognate_solutions::certificates::{Attempt, certify};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// The certificates of a solve's regular endpoints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Certificates {
    /// `None` before the solve is done.
    stage: Option<ClosingStage<Attempt>>,
}

impl Certificates {
    /// Opens the stage for these endpoints.
    pub fn open(&mut self, mut endpoints: FiniteEndpoints, numbers: &mut StageNumbers) -> Next {
        let points = std::mem::take(&mut endpoints.regular);
        let (stage, next) = ClosingStage::open(endpoints, points, Work::Certify, numbers);
        self.stage = Some(stage);
        next
    }

    /// Next step once the stage is open; `None` before.
    pub fn next(&self) -> Option<Next> {
        self.stage.as_ref().map(ClosingStage::next)
    }

    /// Takes the results of the stage.
    pub fn absorb(&mut self, id: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        let stage = self.stage.as_mut();
        let stage = stage.expect("only an open stage is absorbed");
        stage.absorb(id, results, |result| match result {
            ItemResult::Certify(point) => point.into_fact(),
            other => unreachable!("a stage that certifies has no {other:?}"),
        });
    }

    /// Progress of a solve with this closing.
    pub fn progress(&self, before: Progress) -> Progress {
        ClosingStage::progress(self.stage.as_ref(), before, |items| {
            format!("certifying {}", counted(items, "solution"))
        })
    }

    /// Writes the certificates to the solutions, target by target.
    pub fn apply(&self, sets: &mut [SolutionSet], system: &System) {
        let Some(stage) = &self.stage else {
            return;
        };
        let attempts = stage.facts();
        let targets = parameters_at_targets(stage.homotopy(), system);
        for ((target, set), parameters) in (0u64..).zip(sets).zip(&targets) {
            let attempt = |path: u64| attempts.get(&(target, path)).copied();
            certify(set, system, parameters, &attempt, stage.seed());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::any_algorithm::AnyAlgorithm;
    use crate::opening::Opening;
    use crate::plan::GivenStart;
    use crate::plan::{ClosingOptions, KnownSolutions, SolveMethod};
    use crate::run_locally::{drive, run_locally};
    use crate::solve::PathAlgorithm;
    use crate::{SolveOptions, plan};
    use cognate_continuation::prepared_work::PreparedWork;
    use cognate_continuation::start_points::StoredPoints;
    use cognate_systems::named::katsura;
    use num_complex::Complex64;
    use std::sync::Arc;

    fn certified(set: &SolutionSet) -> (Option<u64>, Option<u64>, u64) {
        let counts = &set.counts;
        (counts.certified, counts.certified_real, counts.distinct)
    }

    fn with_certificates() -> SolveOptions {
        SolveOptions {
            seed: 7,
            closings: ClosingOptions {
                certify: true,
                ..ClosingOptions::default()
            },
            ..SolveOptions::default()
        }
    }

    #[test]
    fn every_solution_of_katsura_is_certified_also_after_a_restart() {
        let system = katsura(4).system;
        let mut planned = plan(&system, &with_certificates()).unwrap();
        let mut works = Vec::new();
        let mut lived_through = planned.algorithm.clone();
        let done: Result<(), std::convert::Infallible> =
            drive(&mut lived_through, &mut |opening| {
                works.push(opening.stage.work);
                let find = |wanted| opening.object(wanted);
                let prepared = PreparedWork::new(&planned.system, &opening.stage, &find).unwrap();
                Ok(prepared.run(0..prepared.items(), 8))
            });
        assert_eq!(done, Ok(()));
        assert_eq!(works, [Work::Track, Work::Certify]);
        assert!(lived_through.progress().done);
        let sets = lived_through.solution_sets(&planned.system);
        assert_eq!(sets[0].counts.certified, Some(16));
        assert!(sets[0].counts.certified_real.is_some_and(|n| n >= 2));
        // Written down and read back after every step.
        let mut open: Option<Box<Opening>> = None;
        loop {
            let bytes = planned.algorithm.snapshot();
            planned.algorithm = AnyAlgorithm::restore(&bytes).unwrap();
            match planned.algorithm.next() {
                Next::Open(opening) => open = Some(opening),
                Next::Wait => {
                    let opening = open.take().unwrap();
                    let find = |wanted| opening.object(wanted);
                    let prepared =
                        PreparedWork::new(&planned.system, &opening.stage, &find).unwrap();
                    let mut results = prepared.run(0..prepared.items(), 1).into_iter();
                    planned.algorithm.absorb(opening.stage.id, &mut results);
                }
                Next::Done => break,
            }
        }
        assert_eq!(planned.algorithm.solution_sets(&planned.system), sets);
    }

    #[test]
    fn many_targets_are_certified_in_one_stage() {
        let text =
            "CONFIG\nEND;\nINPUT\nvariable_group x; parameter p; function f; f = x^3 - p;\nEND;\n";
        let system = cognate_systems::formats::read("test", text.as_bytes())
            .unwrap()
            .system;
        let real = |v: f64| Complex64::new(v, 0.0);
        let half = Complex64::new(-0.5, f64::sqrt(0.75));
        let points = Arc::new(StoredPoints {
            dimension: 1,
            coordinates: vec![real(1.0), half, half.conj()],
        });
        let options = SolveOptions {
            method: SolveMethod::Given(KnownSolutions {
                points: Some(GivenStart {
                    object: points.digest(),
                    count: 3,
                    dimension: 1,
                }),
                parameters: Some(vec![real(1.0)]),
            }),
            target_parameters: vec![vec![real(8.0)], vec![real(-0.1)], vec![real(0.0)]],
            ..with_certificates()
        };
        let mut planned = plan(&system, &options).unwrap();
        let find = |_| Some(points.clone());
        let sets = run_locally(&planned.system, &mut planned.algorithm, &find, 8).unwrap();
        assert_eq!(certified(&sets[0]), (Some(3), Some(1), 3));
        assert_eq!(certified(&sets[1]), (Some(3), Some(1), 3));
        // x^3 = 0: one singular solution, which no box can show.
        assert_eq!(certified(&sets[2]), (Some(0), Some(0), 1));
        let refused = sets[2].solutions[0].certificate.as_ref().unwrap();
        assert!(refused.reason.as_deref().unwrap().contains("singular"));
    }

    #[test]
    fn certificates_of_combinations_say_so() {
        // Survey, system (35): three equations in two unknowns, three solutions.
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y; function f1, f2, f3; \
                    f1 = x*y; f2 = x*(x - y - 1); f3 = y*(x - y - 1);\nEND;\n";
        let system = cognate_systems::formats::read("35", text.as_bytes())
            .unwrap()
            .system;
        let mut planned = plan(&system, &with_certificates()).unwrap();
        let sets = run_locally(&planned.system, &mut planned.algorithm, &|_| None, 8).unwrap();
        assert_eq!(certified(&sets[0]), (Some(3), Some(3), 3));
        assert!(sets[0].warnings.iter().any(|w| w.contains("squared-up")));
        let certified_system = sets[0].certified_system.as_ref().unwrap();
        assert!(certified_system.squared_up);
        // Exchanging p and P exchanges the first two equations, but not their combinations with
        // the third: all three solutions are real, and the combinations do not prove it.
        let text = "CONFIG\nEND;\nINPUT\nvariable_group p, P; function f1, f2, f3; \
                    f1 = p^2 - P; f2 = P^2 - p; f3 = p*P - 1;\nEND;\n";
        let mut system = cognate_systems::formats::read("pairs", text.as_bytes())
            .unwrap()
            .system;
        system.conjugates = vec![(0, 1)];
        let mut planned = plan(&system, &with_certificates()).unwrap();
        let sets = run_locally(&planned.system, &mut planned.algorithm, &|_| None, 8).unwrap();
        assert_eq!(certified(&sets[0]), (Some(3), None, 3));
        assert_eq!(sets[0].counts.real, Some(3));
    }
}
