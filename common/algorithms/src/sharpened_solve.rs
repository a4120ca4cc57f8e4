//! SharpenedSolve: any solve, and then its solutions with as many digits as are asked for.
//!
//! When the solve is done, one endpoint of each solution becomes a point of one more stage, which
//! brings it to its digits, the singular ones by deflation where that is asked for.

use crate::any_algorithm::AnyAlgorithm;
use crate::closing_stage::{ClosingStage, FiniteEndpoints};
use crate::{Completeness, Next, PathAlgorithm, Progress};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::{StageId, Work};
use cognate_solutions::sharpened::{Attempt, DIGITS_OF_DOUBLES, sharpen};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// A solve whose solutions get more digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SharpenedSolve {
    solve: AnyAlgorithm,
    digits: u32,
    /// Whether isolated singular solutions get theirs.
    deflate: bool,
    sharpening: Option<ClosingStage<Attempt>>,
}

impl SharpenedSolve {
    /// The solve that begins with this one.
    pub fn new(solve: AnyAlgorithm, digits: u32, deflate: bool) -> Self {
        Self {
            solve,
            digits,
            deflate,
            sharpening: None,
        }
    }

    /// The solve whose solutions are sharpened.
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
        let mut points = std::mem::take(&mut endpoints.regular);
        let singular = std::mem::take(&mut endpoints.singular);
        if self.digits <= DIGITS_OF_DOUBLES {
            points.clear(); // they have them
        }
        if self.deflate {
            points.extend(singular);
            points.sort_by_key(|point| (point.target, point.path));
        }
        let before = self.solve.progress().stages;
        let work = Work::Sharpen {
            digits: self.digits,
        };
        let (stage, opening) = ClosingStage::open(endpoints, points, work, &before);
        self.sharpening = Some(stage);
        opening.map_or(Next::Done, Next::Open)
    }
}

impl PathAlgorithm for SharpenedSolve {
    fn next(&mut self) -> Next {
        match (&self.sharpening, &mut self.solve) {
            (Some(own), _) => own.next(),
            (None, solve) => match solve.next() {
                Next::Done => self.open(),
                other => other,
            },
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        match &mut self.sharpening {
            Some(own) => own.absorb(stage, results, attempt),
            None => self.solve.absorb(stage, results),
        }
    }

    fn progress(&self) -> Progress {
        let before = self.solve.progress();
        if self.solve.failure().is_some() {
            return before; // nothing is looked at
        }
        ClosingStage::progress(self.sharpening.as_ref(), before, |items| {
            format!("bringing {items} solutions to {} digits", self.digits)
        })
    }

    fn snapshot(&self) -> Vec<u8> {
        AnyAlgorithm::Sharpened(Box::new(self.clone())).to_bytes()
    }

    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        let mut sets = self.solve.solution_sets(system);
        let Some(own) = &self.sharpening else {
            return sets;
        };
        let attempts = own.facts();
        for (target, set) in (0u64..).zip(&mut sets) {
            let attempt = |path: u64| attempts.get(&(target, path)).map(|&found| found.clone());
            sharpen(set, self.digits, &attempt);
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
        ItemResult::Sharpen(point) => point.into_fact(),
        other => unreachable!("a stage that sharpens has no {other:?}"),
    }
}

#[cfg(test)]
mod tests {
    use crate::plan::StartChoice;
    use crate::run_locally::run_locally;
    use crate::{AnyAlgorithm, PathAlgorithm, PlanOptions, plan};
    use cognate_solutions::solution_set::SolutionSet;
    use cognate_systems::formats;

    fn solve(text: &str, options: PlanOptions) -> SolutionSet {
        let problem = formats::read("test", text.as_bytes());
        let system = problem.expect("a problem of this test").system;
        let mut plan = plan(&system, &options).expect("a plan");
        let restored = AnyAlgorithm::restore(&plan.algorithm.snapshot()).expect("a snapshot");
        assert_eq!(restored, plan.algorithm);
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        assert!(plan.algorithm.progress().done);
        sets.expect("paths").remove(0)
    }

    /// A line touches a circle, another crosses it.
    const TOUCHING: &str = r#"{"variables": ["x", "y"],
        "equations": ["x^2 + y^2 - 25", "(3*x + 4*y - 25)*(x - y - 1)"]}"#;

    #[test]
    fn digits_and_deflation_are_for_whom_they_are_asked() {
        let options = |digits, deflate| PlanOptions {
            start: StartChoice::TotalDegree,
            seed: 5,
            digits,
            deflate,
            ..PlanOptions::default()
        };
        let set = solve(TOUCHING, options(40, true));
        assert_eq!((set.counts.nonsingular, set.counts.singular), (2, 1));
        let counts = set.counts.sharpened.as_ref().expect("counts");
        assert_eq!((counts.solutions, counts.by_deflation), (3, 1));
        let digits = |set: &SolutionSet, k: usize, v: usize| {
            let digits = &set.solutions[k].variables.0[v].digits;
            digits.as_ref().map(|[re, im]| (re.clone(), im.clone()))
        };
        let place = |singular| set.solutions.iter().position(|s| s.singular == singular);
        let (regular, touching) = (place(false).unwrap(), place(true).unwrap());
        let text = |integer: &str| Some((format!("{integer}.{}", "0".repeat(39)), "0".into()));
        assert_eq!(digits(&set, touching, 0), text("3"));
        assert_eq!(digits(&set, touching, 1), text("4"));
        assert!(set.solutions[touching].accuracy < 1e-39);
        // (4, 3) and (-3, -4).
        let found = digits(&set, regular, 0);
        assert!(found == text("4") || found == text("-3"), "{found:?}");
        // Deflation alone: doubles, and the singular one as good as they can be.
        let set = solve(TOUCHING, options(16, true));
        assert_eq!(set.solutions[touching].variables.0[0].value.re, 3.0);
        assert_eq!(set.solutions[touching].deflations, Some(1));
        assert_eq!(set.solutions[regular].deflations, None);
        assert!((0..3).all(|k| digits(&set, k, 0).is_none()));
        // Digits alone: the singular one has those of its path.
        let set = solve(TOUCHING, options(40, false));
        assert_eq!(set.counts.sharpened.as_ref().unwrap().solutions, 2);
        assert_eq!(digits(&set, touching, 0), None);
        // And with proofs.
        let with_proofs = PlanOptions {
            certify: true,
            ..options(40, true)
        };
        let set = solve(TOUCHING, with_proofs);
        assert_eq!(set.counts.certified, Some(2));
        assert_eq!(digits(&set, touching, 0), text("3"));
        assert!(set.warnings.is_empty(), "{:?}", set.warnings);
    }
}
