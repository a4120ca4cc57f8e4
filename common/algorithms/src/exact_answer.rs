//! ExactAnswer: where paths leave an answer in doubt, the solutions of few equations with exact coefficients, without
//! paths.
//!
//! Where the paths ended at as many solutions as the equations have by an exact count, these are all: no other path
//! ends at a solution. Else the equations are solved without paths. The counts still speak of all paths: one that ended
//! near a solution counts there, and all others end at no solution, since all solutions are known. A solution may have
//! no path.

use crate::undecided_ends;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::involution::Involution;
use cognate_solutions::solution::{NamedValues, Solution};
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::summary::{ExactCount, SolutionCounts};
use cognate_solutions::weak_evidence::WeakEvidence;
use cognate_systems::polynomial::exact_points::{ExactPoint, exact_points};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::BTreeSet;

/// Operations of exact solutions, at most: some seconds.
pub(crate) const MOST_OPERATIONS: u64 = 2_000_000_000;
/// A set whose paths are more is not of equations with few solutions.
const MOST_PATHS: u64 = 20_000;
/// An end of a path is near a solution where it differs from it by less than this, relative to the larger of both and
/// 1.
const NEAR: f64 = 1e-3;
/// Real parts differ by less than this, relative to the largest coordinate, from those of the image of a real solution.
const SAME: f64 = 1e-14;
/// Error of a correctly rounded double, relative to the number: half a unit of the last place, and what the last bits
/// of the value before may add.
pub(crate) const ROUNDING: f64 = f64::EPSILON / 2.0 * (1.0 + 1.0 / 512.0);

/// Number of ends of paths at solutions, and at singular points of which it is not known whether they are isolated.
pub(crate) fn with_multiplicity(set: &SolutionSet) -> u64 {
    let undecided = set.undecided.iter().map(|point| point.multiplicity);
    set.counts.with_multiplicity + undecided.sum::<u64>()
}

/// Whether the paths ended at as many points as the equations have isolated solutions by an exact count, and each end in
/// doubt has a solution beside it, so that these are all solutions, and all other paths end at none; they count so then.
pub(crate) fn settle_by_count(
    set: &mut SolutionSet,
    exact: &ExactCount,
    system: &System,
    parameters: &[Complex64],
) -> bool {
    let counts = &set.counts;
    let distinct = counts.distinct + counts.undecided;
    let agrees = exact.with_multiplicity == Some(with_multiplicity(set))
        && exact.distinct == Some(distinct)
        && !exact.is_general;
    let are_certain = counts.doubtful_denominators == 0
        && counts.without_conjugate == 0
        && set.paths.within_data_accuracy == 0
        && counts.distinct == set.solutions.len() as u64
        && counts.undecided == set.undecided.len() as u64;
    if !agrees || !are_certain {
        return false;
    }
    let Some(ends) = undecided_ends::at_solutions(set, system, parameters) else {
        return false;
    };
    // Equations with finitely many solutions have no point that is not isolated.
    set.undecided = ends;
    set.take_undecided_as_isolated(system, parameters);
    end_other_paths(set);
    let reason = "as many solutions as the equations have by an exact count";
    let real_reason = set.counts.real_reason.take();
    count(set, reason, real_reason);
    true
}

/// Replaces the solutions of the paths by the solutions of the equations, if these are finitely many and few; returns
/// whether it did.
pub(crate) fn settle(set: &mut SolutionSet, system: &System, parameters: &[Complex64]) -> bool {
    let counts = &set.counts;
    let is_whole = counts.distinct == set.solutions.len() as u64 && set.paths.total <= MOST_PATHS;
    if !is_whole || set.paths.within_data_accuracy > 0 || counts.doubtful_denominators > 0 {
        return false;
    }
    let points = exact_points(system, parameters, 0, MOST_OPERATIONS);
    let Ok(Some(points)) = points else {
        return false;
    };
    let are_doubles = |point: &ExactPoint| {
        let mut unknowns = point.rounded.iter();
        unknowns.all(|z| z.re.is_finite() && z.im.is_finite())
    };
    if !points.iter().all(are_doubles) {
        return false;
    }
    let Some(ended) = paths_of_each(set, &points) else {
        return false;
    };
    take_points(set, system, parameters, points, ended);
    true
}

/// The paths that ended near one point, and how they close.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathsOfPoint {
    pub paths: Vec<u64>,
    pub cycles: Vec<u32>,
}

/// The paths that ended near each point; `None` where a regular end is near none.
fn paths_of_each(set: &SolutionSet, points: &[ExactPoint]) -> Option<Vec<PathsOfPoint>> {
    let mut ended = vec![PathsOfPoint::default(); points.len()];
    for solution in set.points() {
        let values: Vec<Complex64> = solution.variables.values().collect();
        let distances = points.iter().map(|point| distance(&values, &point.rounded));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        match nearest {
            Some((place, distance)) if distance < NEAR => {
                ended[place].paths.extend(&solution.paths);
                ended[place].cycles.extend(&solution.cycles);
            }
            _ if solution.singular || solution.undecided => {}
            _ => return None,
        }
    }
    for near in &mut ended {
        near.paths.sort_unstable();
        near.cycles.sort_unstable();
    }
    Some(ended)
}

/// Relative to the largest coordinate of both, or 1.
fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let largest = |sum: f64, z: Complex64| sum.max(z.re.abs()).max(z.im.abs());
    let size = a.iter().chain(b).copied().fold(1.0, largest);
    let differences = a.iter().zip(b).map(|(x, y)| x - y);
    differences.fold(0.0, largest) / size
}

fn take_points(
    set: &mut SolutionSet,
    system: &System,
    parameters: &[Complex64],
    points: Vec<ExactPoint>,
    ended: Vec<PathsOfPoint>,
) {
    let involution = Involution::of(system, parameters);
    let mut solutions: Vec<Solution> = points
        .into_iter()
        .zip(ended)
        .map(|(point, ended)| {
            let real = involution.as_ref().ok().map(|i| is_real(&point, i));
            solution(system, point, ended, real)
        })
        .collect();
    // By their first paths, then those without.
    solutions.sort_by_key(Solution::first_path);
    set.solutions = solutions;
    end_other_paths(set);
    let reason = "all solutions of the equations, exactly, where paths left doubts";
    count(
        set,
        reason,
        involution.err().map(|reason| reason.to_string()),
    );
}

/// Paths that are at none of the solutions, which are all there are, end at none.
fn end_other_paths(set: &mut SolutionSet) {
    let paths_to = |singular: bool| {
        let kind = set.solutions.iter().filter(|s| s.singular == singular);
        kind.map(|s| s.paths.len() as u64).sum::<u64>()
    };
    let (finite, singular) = (paths_to(false), paths_to(true));
    let paths = &mut set.paths;
    (paths.finite, paths.singular) = (finite, singular);
    paths.failed = 0;
    paths.undecided = 0;
    paths.positive_dimensional = Some(0);
    paths.crossings_resolved = paths.crossings_found;
    paths.decided_by_precision_limit = 0;
    let others = paths.total - paths.sum();
    paths.at_infinity += others;
    paths.decided_by_exact_count += others;
    let solved = set.solutions.iter().flat_map(|s| s.paths.iter().copied());
    let solved: BTreeSet<u64> = solved.collect();
    let undecided = std::mem::take(&mut set.undecided).into_iter();
    let failed = std::mem::take(&mut set.failed).into_iter();
    let others = undecided
        .flat_map(|point| point.paths)
        .chain(failed.map(|failed| failed.path));
    let others = others.chain(std::mem::take(&mut set.on_positive_dimensional_sets));
    let others: BTreeSet<u64> = others.filter(|path| !solved.contains(path)).collect();
    set.at_no_solution = others.into_iter().collect();
    set.warnings.clear();
    set.weak_evidence = WeakEvidence::default();
    set.no_exact_count = None;
}

/// Counts the solutions, of which nothing is in doubt any more.
pub(crate) fn count(set: &mut SolutionSet, reason: &str, real_reason: Option<String>) {
    let number = |holds: &dyn Fn(&Solution) -> bool| {
        let counted = set.solutions.iter().filter(|s| holds(s));
        counted.count() as u64
    };
    let distinct = number(&|_| true);
    let with_multiplicity = set.solutions.iter().map(|s| s.multiplicity).sum();
    set.counts = SolutionCounts {
        distinct,
        nonsingular: number(&|s| !s.singular),
        singular: number(&|s| s.singular),
        real: real_reason
            .is_none()
            .then(|| number(&|s| s.real == Some(true))),
        real_reason,
        with_multiplicity,
        positive_dimensional: Some(false),
        complete: Completeness::Yes,
        complete_reason: Some(reason.to_string()),
        exact_count: Some(ExactCount {
            dimension: 0,
            with_multiplicity: Some(with_multiplicity),
            distinct: Some(distinct),
            nonsingular: None,
            agrees: true,
            is_general: false,
        }),
        removed: std::mem::take(&mut set.counts.removed),
        without_path: number(&|s| s.paths.is_empty()),
        ..SolutionCounts::default()
    };
}

/// A point as a solution at which these paths ended.
pub(crate) fn solution(
    system: &System,
    point: ExactPoint,
    ended: PathsOfPoint,
    real: Option<bool>,
) -> Solution {
    let variables: NamedValues = system
        .variables
        .iter()
        .cloned()
        .zip(point.rounded)
        .collect();
    Solution {
        variables,
        multiplicity: point.multiplicity,
        cycles: ended.cycles,
        real,
        singular: point.multiplicity > 1,
        residual: point.residual,
        condition: point.condition,
        accuracy: ROUNDING,
        precision_bits: point.precision_bits,
        class: None,
        paths: ended.paths,
        certificate: None,
        deflations: None,
        undecided: false,
    }
}

/// Whether the involution leaves the point as it is.
pub(crate) fn is_real(point: &ExactPoint, involution: &Involution) -> bool {
    let partner = &involution.partner;
    if partner.iter().enumerate().all(|(v, &partner)| v == partner) {
        return point.is_real;
    }
    let image: Vec<Complex64> = partner.iter().map(|&p| point.rounded[p].conj()).collect();
    distance(&image, &point.rounded) <= SAME
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::tracker::outcome::Failure;
    use cognate_solutions::failed_path::{FailedPath, FailureReason};
    use cognate_systems::formats::read;

    fn system(text: &str) -> System {
        read("test", text.as_bytes())
            .expect("equations of this test")
            .system
    }

    fn one_path(path: u64) -> PathsOfPoint {
        PathsOfPoint {
            paths: vec![path],
            cycles: vec![1],
        }
    }

    /// Paths to these points of x and y, and one more that failed.
    fn doubtful(system: &System, ends: &[[f64; 2]]) -> SolutionSet {
        let mut set = SolutionSet::default();
        for (path, end) in (0..).zip(ends) {
            let rounded: Vec<Complex64> = end.iter().map(|&x| Complex64::new(x, 0.0)).collect();
            let point = ExactPoint {
                values: Vec::new(),
                rounded,
                multiplicity: 1,
                is_real: true,
                residual: 0.0,
                condition: 1.0,
                precision_bits: 53,
            };
            set.solutions
                .push(solution(system, point, one_path(path), Some(true)));
        }
        let path = ends.len() as u64;
        set.failed.push(FailedPath {
            path,
            reason: FailureReason::Tracking(Failure::EndgameUnsettled),
            t: 0.0,
        });
        set.counts.distinct = path;
        set.paths.total = path + 1;
        set.paths.finite = path;
        set.paths.failed = 1;
        set
    }

    #[test]
    fn equations_settle_what_paths_leave_open() {
        let system = system("x^2 + y^2 = 5\nx*y = 2");
        let mut set = doubtful(&system, &[[2.0, 1.0], [-1.0, -2.0]]);
        assert!(!set.settled());
        assert!(settle(&mut set, &system, &[]) && set.settled());
        let counts = &set.counts;
        assert_eq!(
            (counts.distinct, counts.with_multiplicity, counts.real),
            (4, 4, Some(4))
        );
        assert_eq!(
            (counts.complete, counts.without_path),
            (Completeness::Yes, 2)
        );
        let paths = &set.paths;
        assert_eq!(
            (
                paths.finite,
                paths.at_infinity,
                paths.decided_by_exact_count
            ),
            (2, 1, 1)
        );
        assert_eq!(paths.sum(), paths.total);
        assert_eq!(set.at_no_solution, [2]);
        let of_each: Vec<&[u64]> = set.solutions.iter().map(|s| &s.paths[..]).collect();
        assert_eq!(of_each, [&[0][..], &[1], &[], &[]]);
    }

    #[test]
    fn as_many_solutions_as_are_counted_are_all() {
        let system = system("x^2 + y^2 = 5\nx*y = 2");
        let ends = [[2.0, 1.0], [-1.0, -2.0], [1.0, 2.0], [-2.0, -1.0]];
        let exact = |distinct| ExactCount {
            dimension: 0,
            with_multiplicity: Some(4),
            distinct: Some(distinct),
            nonsingular: None,
            agrees: true,
            is_general: false,
        };
        let mut set = doubtful(&system, &ends);
        count(&mut set, "", None);
        let mut other = set.clone();
        assert!(
            !set.settled() && settle_by_count(&mut set, &exact(4), &system, &[]) && set.settled()
        );
        assert_eq!((set.paths.finite, set.paths.at_infinity), (4, 1));
        assert_eq!(
            (set.counts.without_path, &set.at_no_solution[..]),
            (0, &[4][..])
        );
        assert!(!settle_by_count(&mut other, &exact(3), &system, &[]) && !other.settled());
    }

    /// (x - 1)^2*(x - 2) = 0, y = x: of the double point it is not known whether it is isolated.
    #[test]
    fn undecided_points_are_solutions_where_the_count_has_as_many() {
        let system = system("(x - 1)^2*(x - 2) = 0\ny = x");
        let mut set = doubtful(&system, &[[2.0, 2.0], [1.0, 1.0]]);
        let double_point = set.solutions.pop().expect("the second end");
        set.undecided.push(Solution {
            paths: vec![1, 3],
            multiplicity: 2,
            real: None,
            singular: true,
            undecided: true,
            ..double_point
        });
        (set.paths.total, set.paths.finite, set.paths.undecided) = (4, 1, 2);
        count(&mut set, "", None);
        set.counts.undecided = 1;
        let exact = |distinct| ExactCount {
            dimension: 0,
            with_multiplicity: Some(3),
            distinct: Some(distinct),
            nonsingular: None,
            agrees: false,
            is_general: false,
        };
        // With three distinct solutions the end would be two points.
        assert!(!settle_by_count(&mut set, &exact(3), &system, &[]) && !set.settled());
        assert!(settle_by_count(&mut set, &exact(2), &system, &[]) && set.settled());
        let counts = &set.counts;
        assert_eq!((counts.distinct, counts.singular), (2, 1));
        assert_eq!((counts.with_multiplicity, counts.real), (3, Some(2)));
        let paths = &set.paths;
        assert_eq!((paths.finite, paths.singular, paths.at_infinity), (1, 2, 1));
        assert!(set.undecided.is_empty());
    }

    /// All terms of the first equation are small where y is 5e-12: paths stopped at other x with residuals of 1e-12.
    #[test]
    fn ends_at_no_solution_are_none_though_they_are_as_many() {
        let system = system("x^2*y^2 - 3*x*y = 0\n(y - 5e-12)*(y - 1) = 0");
        let ends = [[3.0, 1.0], [0.0, 1.0], [0.25, 5e-12], [1.5, 5e-12]];
        let mut set = doubtful(&system, &ends);
        set.undecided = set.solutions.split_off(2);
        set.undecided
            .iter_mut()
            .for_each(|end| end.undecided = true);
        (set.paths.total, set.paths.finite, set.paths.undecided) = (4, 2, 2);
        set.paths.failed = 0;
        set.failed.clear();
        count(&mut set, "", None);
        set.counts.undecided = 2;
        let exact = ExactCount {
            dimension: 0,
            with_multiplicity: Some(4),
            distinct: Some(4),
            nonsingular: None,
            agrees: false,
            is_general: false,
        };
        assert!(!settle_by_count(&mut set, &exact, &system, &[]) && !set.settled());
        assert!(settle(&mut set, &system, &[]) && set.settled());
        let is_far = |solution: &&Solution| solution.variables.values().any(|z| z.re > 5e11);
        assert_eq!(set.solutions.iter().filter(is_far).count(), 1);
        assert_eq!((set.counts.distinct, set.counts.real), (4, Some(4)));
    }

    #[test]
    fn ends_that_contradict_the_equations_stay_in_doubt() {
        let system = system("x^2 + y^2 = 5\nx*y = 2");
        let mut set = doubtful(&system, &[[2.0, 1.0], [7.0, 7.0]]);
        let before = set.clone();
        assert!(!settle(&mut set, &system, &[]));
        assert_eq!(set, before);
    }

    #[test]
    fn sets_of_solutions_stay_in_doubt() {
        let system = system("x*(x - 1)\nx*y");
        let mut set = doubtful(&system, &[[1.0, 0.0]]);
        assert!(!settle(&mut set, &system, &[]));
    }
}
