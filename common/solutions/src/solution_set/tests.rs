//! Solution sets of results that are written by hand.

use super::*;
use crate::test_results::{failed, isolated, regular, roots_of_unity, singular};
use cognate_continuation::tracker::outcome::Failure;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_systems::system::DegenerateSet;

/// x^5 = x: a real equation in one variable; x must not vanish.
fn system() -> System {
    let mut system = roots_of_unity(5);
    let x = system.expressions.variable(0);
    system
        .degenerate
        .insert("zero".into(), DegenerateSet::Nonzero(x));
    system
}

fn set_of(results: &[PathResult], history: &History) -> SolutionSet {
    SolutionSet::new(&system(), &[], results, history, &Tolerances::default(), 42)
}

fn complete() -> History {
    History {
        complete_start: true,
        ..History::default()
    }
}

/// Which of inaccurate ends coincide depends on which ends are compared; a path is of one class in any case.
#[test]
fn regular_ends_that_nearly_coincide_are_counted_once() {
    let mut random = RandomStream::new(3, Purpose::Test, 1);
    let mut met = 0;
    for _ in 0..400 {
        let results: Vec<PathResult> = (0..5)
            .map(|path| {
                let z = random.disc() * 2e-6;
                let accuracy = 1e-7 * (0.5 + random.uniform());
                PathResult {
                    accuracy,
                    ..regular(path, &[(0.5, 0.0), (0.5 + z.re, z.im)])
                }
            })
            .collect();
        let set = set_of(&results, &complete());
        assert_eq!(set.paths.finite + set.paths.failed, 5);
        assert_eq!(set.counts.nonsingular, set.paths.finite);
        let failed = |place: usize| set.failed.iter().any(|f| f.path == place as u64);
        let shape = PointShape::of(&system());
        let kept = |place: usize| !failed(place);
        let points = coincidences(&results, &shape, &Tolerances::default(), 42, kept);
        assert!(points.iter().all(|members| members.len() == 1));
        met += set.paths.failed;
    }
    assert!((200..1800).contains(&met), "{met}");
}

#[test]
fn all_regular_is_all_decided() {
    let results = [
        regular(0, &[(0.5, 0.0), (0.5, 0.0)]),
        regular(1, &[(0.0, 0.5), (0.0, -0.5)]),
        regular(2, &[(0.5, 0.0), (0.0, 0.5)]),
        regular(3, &[(0.5, 0.0), (0.0, -0.5)]),
        regular(4, &[(1.0, 0.0), (1e-17, 1e-18)]),
    ];
    let set = set_of(&results, &complete());
    assert_eq!((set.paths.total, set.paths.finite), (5, 5));
    assert_eq!(set.paths.positive_dimensional, Some(0));
    assert_eq!(set.counts.real, Some(3));
    assert_eq!(set.counts.positive_dimensional, Some(false));
    assert_eq!(set.counts.complete, Completeness::Yes);
    let may_miss = History {
        may_miss: Some("a level was left out".into()),
        ..complete()
    };
    let counts = set_of(&results, &may_miss).counts;
    assert_eq!(counts.complete, Completeness::NotKnown);
    assert_eq!(
        counts.complete_reason.as_deref(),
        Some("a level was left out")
    );
    assert_eq!(set.counts.degenerate["zero"], 1);
    assert!(
        set.settled() && set.warnings.is_empty(),
        "{:?}",
        set.warnings
    );
    assert_eq!(set.solutions[1].real, Some(true));
    assert_eq!(set.solutions[2].real, Some(false));
    assert_eq!(
        set.solutions[0].variables.0[0].value,
        Complex64::new(1.0, 0.0)
    );
}

#[test]
fn singular_endpoints_are_merged_with_their_cycles() {
    let double = [(1.0, 0.0), (0.5, 0.0)];
    let near = [(1.0, 0.0), (0.5, 3e-10)];
    let results = [
        isolated(0, &double, 2, &[0], 3),
        isolated(1, &[(1.0, 0.0), (-0.5, 0.0)], 1, &[0], 1),
        isolated(2, &near, 2, &[0], 3),
        isolated(3, &near, 1, &[0], 3),
        singular(4, &[(1e-14, 0.0), (1.0, 0.0)], 1, &[1]),
    ];
    let set = set_of(&results, &complete());
    let paths = &set.paths;
    assert_eq!((paths.finite, paths.singular, paths.at_infinity), (1, 3, 1));
    assert_eq!(set.paths.positive_dimensional, Some(0));
    assert_eq!(set.counts.positive_dimensional, None);
    assert_eq!((set.counts.distinct, set.counts.with_multiplicity), (2, 4));
    assert_eq!(set.solutions[0].paths, [0, 2, 3]);
    assert_eq!(set.solutions[0].cycles, [1, 2]);
    assert_eq!(set.solutions[0].real, Some(true));
    assert!(set.settled() && set.warnings.is_empty());
    let set = set_of(&results[..2], &complete());
    let half = |warning: &String| warning.contains("winding numbers");
    assert!(set.warnings.iter().any(half), "half a cycle is missing");
}

/// A singular point that may lie on a curve is in no count of solutions, and keeps the answer open.
#[test]
fn a_point_that_may_not_be_isolated_is_no_solution() {
    let mut plane = system();
    plane.variables.push("y".into());
    plane.groups[0].variables.push(1);
    let (zero, tolerances) = ((0.0, 0.0), Tolerances::default());
    let results = [
        regular(0, &[(0.5, 0.0), (0.5, 0.0), zero]),
        singular(1, &[(1.0, 0.0), (0.5, 0.0), zero], 2, &[0]),
        singular(2, &[(1.0, 0.0), (0.5, 3e-10), zero], 2, &[0]),
    ];
    let set = SolutionSet::new(&plane, &[], &results, &complete(), &tolerances, 42);
    let counts = &set.counts;
    assert_eq!(
        (set.paths.finite, set.paths.undecided, set.paths.singular),
        (1, 2, 0)
    );
    assert_eq!(
        (counts.distinct, counts.singular, counts.undecided),
        (1, 0, 1)
    );
    assert_eq!((counts.with_multiplicity, counts.real), (1, Some(1)));
    assert!(!set.settled());
    assert!(
        set.warnings[0].contains("not decided"),
        "{:?}",
        set.warnings
    );
    assert_eq!(set.undecided[0].paths, [1, 2]);
    assert!(set.undecided[0].undecided && set.points().count() == 2);
    assert_eq!(counts.complete, Completeness::NotKnown);
    let reason = counts.complete_reason.as_deref();
    assert!(
        reason.is_some_and(|why| why.contains("isolated")),
        "{reason:?}"
    );
}

/// (x - 1)^3 from the roots of unity: one path does not move, and its end looks regular.
#[test]
fn a_regular_end_at_a_singular_point_is_one_of_its_paths() {
    let results = [
        regular(0, &[(0.5, 0.0), (0.5, 0.0)]),
        isolated(1, &[(0.5, 0.0), (0.5, 1e-12)], 2, &[0], 3),
        isolated(2, &[(0.5, 0.0), (0.5, 1e-12)], 2, &[0], 3),
    ];
    let set = set_of(&results, &complete());
    assert_eq!((set.paths.finite, set.paths.singular), (0, 3));
    assert_eq!((set.counts.distinct, set.counts.with_multiplicity), (1, 3));
    assert_eq!(set.counts.doubtful_multiplicity, 0);
    let set = set_of(&results[1..], &complete());
    assert_eq!(set.counts.doubtful_multiplicity, 1);
    assert!(!set.settled(), "two paths at a triple point");
}

/// Two roots 5e-8 apart: turns in doubles take each for a singular point, with more digits the Jacobian is regular.
#[test]
fn a_singular_end_with_a_regular_jacobian_is_a_simple_root_unless_two_coincide() {
    let near = |path, x| isolated(path, &[(0.5, 0.0), (x, 0.0)], 1, &[0], 1);
    let set = set_of(&[near(0, 0.5), near(1, 0.50000005)], &complete());
    assert_eq!((set.paths.finite, set.paths.singular), (2, 0));
    assert_eq!((set.counts.distinct, set.counts.nonsingular), (2, 2));
    assert!(set.settled());
    let set = set_of(&[near(0, 0.5), near(1, 0.5)], &complete());
    assert_eq!((set.paths.finite, set.paths.singular), (0, 2));
    assert_eq!(set.counts.doubtful_multiplicity, 1);
    assert!(!set.settled());
}

#[test]
fn an_unresolved_crossing_is_a_failed_path_and_said() {
    let point = [(1.0, 0.0), (0.5, 0.0)];
    let results = [regular(0, &point), failed(1), regular(2, &point)];
    let history = History {
        retracked: 6,
        crossings_found: 2,
        crossings_resolved: 1,
        complete_start: true,
        may_miss: None,
        images: 0,
        least_on_sets: 0,
        is_part: false,
    };
    let set = set_of(&results, &history);
    assert_eq!((set.paths.finite, set.paths.failed), (1, 2));
    assert_eq!(set.counts.distinct, 1);
    assert!(!set.settled());
    let reasons: Vec<_> = set.failed.iter().map(|f| (f.path, f.reason)).collect();
    assert_eq!(
        reasons,
        [
            (1, FailureReason::Tracking(Failure::StepTooSmall)),
            (2, FailureReason::Crossing)
        ]
    );
    assert_eq!(set.warnings.len(), 3, "{:?}", set.warnings);
}

#[test]
fn cycles_take_as_many_paths_as_they_turn() {
    assert_eq!(cycles([2, 2, 1, 2, 2, 3, 3, 3].into_iter()), [1, 2, 2, 3]);
    assert_eq!(cycles([3].into_iter()), [3]);
}
