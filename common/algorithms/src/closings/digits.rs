//! Digits: after the paths solutions are brought to more digits, singular ones by deflation.

use super::stage::ClosingStage;
use crate::finite_endpoints::FiniteEndpoints;
use crate::progress::Progress;
use crate::solve::{Next, StageNumbers};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::work::{StageId, Work};
use cognate_numeric::counted::counted;
use cognate_solutions::sharpened::{Attempt, DIGITS_OF_DOUBLES, sharpen};
use cognate_solutions::solution_set::SolutionSet;
use serde::{Deserialize, Serialize};

/// More digits for the solutions of a solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Digits {
    digits: u32,
    /// Whether isolated singular solutions get theirs.
    deflate: bool,
    /// `None` before the solve is done.
    stage: Option<ClosingStage<Attempt>>,
}

impl Digits {
    /// Asks for this number of decimal digits; `deflate`: for singular solutions, too.
    pub fn new(digits: u32, deflate: bool) -> Self {
        Self {
            digits,
            deflate,
            stage: None,
        }
    }

    /// Opens the stage for these endpoints.
    pub fn open(&mut self, mut endpoints: FiniteEndpoints, numbers: &mut StageNumbers) -> Next {
        let mut points = std::mem::take(&mut endpoints.regular);
        let singular = std::mem::take(&mut endpoints.singular);
        if self.digits <= DIGITS_OF_DOUBLES {
            points.clear(); // they have them
        }
        if self.deflate {
            points.extend(singular);
            points.sort_by_key(|point| (point.target, point.path));
        }
        let work = Work::Sharpen {
            digits: self.digits,
        };
        let (stage, next) = ClosingStage::open(endpoints, points, work, numbers);
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
            ItemResult::Sharpen(point) => point.into_fact(),
            other => unreachable!("a stage that sharpens has no {other:?}"),
        });
    }

    /// Progress of a solve with this closing.
    pub fn progress(&self, before: Progress) -> Progress {
        ClosingStage::progress(self.stage.as_ref(), before, |items| {
            let solutions = counted(items, "solution");
            format!("bringing {solutions} to {} digits", self.digits)
        })
    }

    /// Writes the digits to the solutions, target by target.
    pub fn apply(&self, sets: &mut [SolutionSet]) {
        let Some(stage) = &self.stage else {
            return;
        };
        let attempts = stage.facts();
        for (target, set) in (0u64..).zip(sets) {
            let attempt = |path: u64| {
                attempts
                    .get(&(target, path))
                    .map(|&sharpened| sharpened.clone())
            };
            sharpen(set, self.digits, &attempt);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::plan::ClosingOptions;
    use crate::plan::SolveMethod;
    use crate::run_locally::run_locally;
    use crate::{AnyAlgorithm, PathAlgorithm, SolveOptions, plan};
    use cognate_solutions::solution_set::SolutionSet;
    use cognate_systems::formats;

    fn solve(text: &str, options: SolveOptions) -> SolutionSet {
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
        let options = |digits, deflate| SolveOptions {
            method: SolveMethod::TotalDegree,
            seed: 5,
            closings: ClosingOptions {
                digits: Some(digits),
                deflate,
                ..ClosingOptions::default()
            },
            ..SolveOptions::default()
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
        let first_coordinate = digits(&set, regular, 0);
        assert!(
            first_coordinate == text("4") || first_coordinate == text("-3"),
            "{first_coordinate:?}"
        );
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
        let with_proofs = SolveOptions {
            closings: ClosingOptions {
                certify: true,
                ..options(40, true).closings
            },
            ..options(40, true)
        };
        let set = solve(TOUCHING, with_proofs);
        assert_eq!(set.counts.certified, Some(2));
        assert_eq!(digits(&set, touching, 0), text("3"));
        assert!(set.warnings.is_empty(), "{:?}", set.warnings);
    }
}
