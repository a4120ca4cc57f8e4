//! Recorded: the classes of paths as a stored answer counted them.
//!
//! The classes that were counted are shown, whatever a later version would say of the results: a path that a record
//! of the answer names has the record's class, and only the other paths are classified again.

use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_solutions::classification::{Tolerances, Verdict, classify};
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::SolutionSet;
use num_complex::Complex64;
use std::collections::HashMap;

/// Size of a homogenising coordinate relative to the largest, up to which a regular end was at infinity before
/// NUMERICS_REVISION 20, when rounding errors stood for 0. Later ends have it below [`UNRESOLVED`] or above this
/// size, unless data are exact.
const ROUNDING: f64 = 1e-13;
/// Relative size of a homogenising coordinate up to which no digits told it from 0.
const UNRESOLVED: f64 = 1e-300;

/// The classes of the paths that an answer names.
pub(super) struct Recorded {
    verdicts: HashMap<u64, Verdict>,
    /// Every path that was counted as finite is named.
    all_finite: bool,
}

impl Recorded {
    /// Of an answer's solution sets, one for each target.
    pub fn new(sets: &[SolutionSet]) -> Self {
        let mut verdicts = HashMap::new();
        let (mut named, mut counted) = (0, 0);
        for set in sets {
            counted += set.paths.finite;
            verdicts.extend(set.failed.iter().map(|f| (f.path, Verdict::Failed)));
            let others = set.at_no_solution.iter();
            verdicts.extend(others.map(|&path| (path, Verdict::AtInfinity)));
            let removed = set.removed.iter();
            verdicts.extend(removed.map(|&path| (path, Verdict::Removed)));
            let on_sets = set.on_positive_dimensional_sets.iter();
            verdicts.extend(on_sets.map(|&path| (path, Verdict::PositiveDimensional)));
            for solution in set.points() {
                let verdict = match (solution.undecided, solution.singular) {
                    (true, _) => Verdict::Undecided,
                    (false, true) => Verdict::Singular,
                    (false, false) => Verdict::Finite,
                };
                if verdict == Verdict::Finite {
                    named += solution.paths.len() as u64;
                }
                verdicts.extend(solution.paths.iter().map(|&path| (path, verdict)));
            }
        }
        Self {
            verdicts,
            all_finite: named == counted,
        }
    }

    /// The class of a path, from its last result.
    pub fn verdict(&self, result: &PathResult, shape: &PointShape) -> Verdict {
        if let Some(&verdict) = self.verdicts.get(&result.origin.0) {
            return verdict;
        }
        match classify(result, shape, &Tolerances::default()).verdict {
            Verdict::Finite if self.all_finite => Verdict::AtInfinity,
            verdict => verdict,
        }
    }
}

/// Whether the result is of an earlier revision, at infinity then. Not to be asked where data are exact: there small
/// coordinates have digits of their own.
pub(super) fn was_at_infinity(result: &PathResult, shape: &PointShape) -> bool {
    let point = result.endpoint.to_double();
    if result.outcome != PathOutcome::Regular || !shape.holds(point) {
        return false;
    }
    let size = |z: &Complex64| z.norm_sqr().sqrt();
    shape
        .spans()
        .filter(|span| !span.group.homogeneous)
        .any(|span| {
            let group = &point[span.range];
            let coordinate = size(&group[0]) / group.iter().map(size).fold(0.0, f64::max);
            coordinate > UNRESOLVED && coordinate <= ROUNDING
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_solutions::solution::Solution;
    use cognate_solutions::summary::PathCounts;
    use cognate_systems::formats::read;

    /// The shape of points of one unknown: `[1 : x]`.
    fn shape() -> PointShape {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x; function f; f = x^3 - x;\nEND;\n";
        PointShape::of(&read("test", text.as_bytes()).unwrap().system)
    }

    fn regular(path: u64, homogenizing: f64) -> PathResult {
        let point = [homogenizing, 1.0].map(|z| Complex64::new(z, 0.0));
        PathResult {
            residual: 1e-16,
            condition: 1.0,
            accuracy: 1e-15,
            ..PathResult::untracked(path, 0, PathOutcome::Regular, point.to_vec())
        }
    }

    fn solution(path: u64) -> Solution {
        Solution {
            multiplicity: 1,
            cycles: vec![1],
            condition: 1.0,
            precision_bits: 53,
            paths: vec![path],
            ..Solution::default()
        }
    }

    /// Path 0 ends at a solution, path 1 at infinity.
    fn answer(listed: bool) -> SolutionSet {
        SolutionSet {
            paths: PathCounts {
                total: 2,
                finite: 1,
                at_infinity: 1,
                ..PathCounts::default()
            },
            solutions: listed.then(|| solution(0)).into_iter().collect(),
            ..SolutionSet::default()
        }
    }

    #[test]
    fn ends_are_shown_as_they_were_counted() {
        let (shape, old) = (shape(), regular(1, 1e-17));
        let verdict = classify(&old, &shape, &Tolerances::default()).verdict;
        assert_eq!(verdict, Verdict::Finite, "or there is nothing to guard");
        let recorded = Recorded::new(&[answer(true)]);
        assert_eq!(recorded.verdict(&old, &shape), Verdict::AtInfinity);
        let solved = |y| recorded.verdict(&regular(0, y), &shape);
        assert_eq!([0.5, 1e-17, 0.0].map(solved), [Verdict::Finite; 3]);
        // Where solutions are not listed nothing is known of who is missing.
        let streamed = Recorded::new(&[answer(false)]);
        assert_eq!(streamed.verdict(&regular(0, 0.5), &shape), Verdict::Finite);
    }

    #[test]
    fn a_record_goes_before_todays_classification() {
        let mut set = answer(true);
        set.solutions[0].singular = true;
        set.undecided = vec![Solution {
            undecided: true,
            ..solution(2)
        }];
        set.on_positive_dimensional_sets = vec![3];
        let recorded = Recorded::new(&[set]);
        let shown = [0, 2, 3].map(|path| recorded.verdict(&regular(path, 0.5), &shape()));
        let counted = [
            Verdict::Singular,
            Verdict::Undecided,
            Verdict::PositiveDimensional,
        ];
        assert_eq!(shown, counted);
    }

    #[test]
    fn rounding_error_was_infinity() {
        let was = |y| was_at_infinity(&regular(0, y), &shape());
        assert!(was(1e-17) && was(1e-14));
        assert!(!was(1e-12) && !was(0.0) && !was(1e-301) && !was(1.0));
    }
}
