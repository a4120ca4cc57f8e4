//! CertifiedSolve: any solve, and then the proof of what it found.
//!
//! When the solve is done, its finite nonsingular endpoints become the points
//! of one more stage, which certifies them; its facts are judged together when
//! the solution sets are made (`cognate_solutions::certificates`).

use crate::any_algorithm::AnyAlgorithm;
use crate::closing_stage::{ClosingStage, FiniteEndpoints};
use crate::{Completeness, Next, PathAlgorithm, Progress};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::points_at_targets::parameters_at_targets;
use cognate_continuation::work::{StageId, Work};
use cognate_solutions::certificates::{Attempt, certify};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// A solve with its certificates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CertifiedSolve {
    solve: AnyAlgorithm,
    certification: Option<ClosingStage<Attempt>>,
}

impl CertifiedSolve {
    /// The solve that begins with this one.
    pub fn new(solve: AnyAlgorithm) -> Self {
        Self {
            solve,
            certification: None,
        }
    }

    /// The solve whose solutions are certified.
    pub fn solve(&self) -> &AnyAlgorithm {
        &self.solve
    }

    /// The same with another limit of repetitions.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.solve = self.solve.with_max_retries(max_retries);
        self
    }

    /// The last stage, now that the solve is done.
    fn open(&mut self) -> Next {
        let Some(mut endpoints) = self.solve.finite_endpoints() else {
            return Next::Done;
        };
        let points = std::mem::take(&mut endpoints.regular);
        let before = self.solve.progress().stages;
        let (stage, opening) = ClosingStage::open(endpoints, points, Work::Certify, &before);
        self.certification = Some(stage);
        opening.map_or(Next::Done, Next::Open)
    }
}

impl PathAlgorithm for CertifiedSolve {
    fn next(&mut self) -> Next {
        match (&self.certification, &mut self.solve) {
            (Some(own), _) => own.next(),
            (None, solve) => match solve.next() {
                Next::Done => self.open(),
                other => other,
            },
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        match &mut self.certification {
            Some(own) => own.absorb(stage, results, attempt),
            None => self.solve.absorb(stage, results),
        }
    }

    fn progress(&self) -> Progress {
        let before = self.solve.progress();
        if self.solve.failure().is_some() {
            return before; // nothing is looked at
        }
        ClosingStage::progress(self.certification.as_ref(), before, |items| {
            format!("certifying {items} solutions")
        })
    }

    fn snapshot(&self) -> Vec<u8> {
        AnyAlgorithm::Certified(Box::new(self.clone())).to_bytes()
    }

    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        let mut sets = self.solve.solution_sets(system);
        let Some(own) = &self.certification else {
            return sets;
        };
        let attempts = own.facts();
        let targets = parameters_at_targets(own.homotopy(), system);
        for ((target, set), parameters) in (0u64..).zip(&mut sets).zip(&targets) {
            let attempt = |path: u64| attempts.get(&(target, path)).map(|&found| found.clone());
            certify(set, system, parameters, &attempt, own.seed());
        }
        sets
    }

    fn failure(&self) -> Option<String> {
        self.solve.failure()
    }

    fn completeness(&self) -> Option<Completeness> {
        self.solve.completeness()
    }

    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        self.solve.finite_endpoints()
    }
}

/// What a worker says of one solution.
fn attempt(result: ItemResult) -> Attempt {
    match result {
        ItemResult::Certify(point) => point.into_fact(),
        other => unreachable!("a stage that certifies has no {other:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Opening;
    use crate::plan::GivenStart;
    use crate::run_locally::{drive, run_locally};
    use crate::{PlanOptions, plan};
    use cognate_continuation::prepared_work::PreparedWork;
    use cognate_continuation::start_points::StoredPoints;
    use cognate_systems::named::katsura;
    use num_complex::Complex64;
    use std::sync::Arc;

    fn certified(set: &SolutionSet) -> (Option<u64>, Option<u64>, u64) {
        let counts = &set.counts;
        (counts.certified, counts.certified_real, counts.distinct)
    }

    fn with_certificates() -> PlanOptions {
        PlanOptions {
            certify: true,
            seed: 7,
            ..PlanOptions::default()
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
        let options = PlanOptions {
            start_points: Some(GivenStart {
                object: points.digest(),
                count: 3,
                dimension: 1,
            }),
            start_parameters: Some(vec![real(1.0)]),
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
        let of = sets[0].certified_system.as_ref().unwrap();
        assert!(of.squared_up);
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
