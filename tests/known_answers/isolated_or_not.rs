//! Singular endpoints: isolated with their multiplicity, or on a positive-dimensional set.

use crate::check::{Answer, SEEDS, check, complaints, solve};
use crate::singular_endpoints::multiplicities;
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_systems::named::{cyclic, hyperbola_in_a_plane, kss, ojika_1};
use cognate_systems::system::System;
use cognate_tests::systems::written;

/// By total degree, so that the number of paths does not depend on groups that are found.
fn check_default(name: &str, system: &System, answer: Answer) {
    let options = SolveOptions {
        method: SolveMethod::TotalDegree,
        ..SolveOptions::default()
    };
    check(name, system, &options, answer);
}

/// Ten seeds; multiplicities of all solutions, ascending, and no doubt about them.
fn check_multiplicities(name: &str, system: &System, answer: Answer, expected: &[u64]) {
    for seed in SEEDS {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(system, &options, &|_| None);
        let wrong = complaints(&sets[0], &answer);
        assert!(wrong.is_empty(), "{name}, seed {seed}:{wrong}");
        assert_eq!(multiplicities(&sets[0]), expected, "{name}, seed {seed}");
        // The dual space has as many dimensions as paths end there, and every point is decided.
        for said in &sets[0].warnings {
            let about_them = said.contains("isolated") || said.contains("multiplicit");
            assert!(!about_them, "{name}, seed {seed}: {said}");
        }
    }
}

/// 17 points of 32 paths.
#[test]
fn kss_5_has_a_point_of_multiplicity_16() {
    let answer = Answer {
        paths: 32,
        nonsingular: 16,
        singular_paths: 16,
        singular: Some(1),
        ..Answer::default()
    };
    let mut expected = vec![1; 16];
    expected.push(16);
    check_multiplicities("kss-5", &kss(5).system, answer, &expected);
}

#[test]
fn ojika_1_has_a_triple_and_a_simple_point() {
    let answer = Answer {
        paths: 4,
        nonsingular: 1,
        singular_paths: 3,
        singular: Some(1),
        real: Some(Some(2)),
        ..Answer::default()
    };
    check_multiplicities("ojika-1", &ojika_1().system, answer, &[1, 3]);
}

/// Multiplicity and winding number 6.
#[test]
fn a_sixth_power_has_a_point_of_multiplicity_6() {
    let system = written("variable_group x; function f; f = (x - 10)^6;");
    let answer = Answer {
        paths: 6,
        singular_paths: 6,
        singular: Some(1),
        real: Some(Some(1)),
        ..Answer::default()
    };
    check_multiplicities("(x - 10)^6", &system, answer, &[6]);
    let options = SolveOptions::default();
    let (_, sets) = solve(&system, &options, &|_| None);
    assert_eq!(sets[0].solutions[0].cycles, [6]);
}

/// Two curves and no isolated point (Björck and Fröberg 1991): every path ends on a curve, or at
/// infinity.
#[test]
fn cyclic_4_has_no_isolated_solution() {
    let system = cyclic(4).system;
    for seed in SEEDS {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        let actual_counts = (paths.failed, counts.distinct, counts.positive_dimensional);
        assert_eq!(actual_counts, (0, 0, Some(true)), "seed {seed}: {paths:?}");
        assert!(paths.positive_dimensional > Some(0), "seed {seed}");
        assert_eq!(paths.sum(), 24, "seed {seed}");
    }
}

#[test]
fn a_hyperbola_in_a_plane_is_no_isolated_solution() {
    let system = hyperbola_in_a_plane().system;
    for seed in SEEDS {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        let actual_counts = (paths.failed, counts.distinct, counts.positive_dimensional);
        assert_eq!(actual_counts, (0, 0, Some(true)), "seed {seed}: {paths:?}");
        assert_eq!(paths.sum(), 8, "seed {seed}");
    }
}

/// A line, and a point beside it: x (x - 1) = 0, x (y - 2) = 0 holds on x = 0 and at (1, 2).
#[test]
fn a_point_beside_a_line_is_told_from_it() {
    let system = written("variable_group x, y; function f, g; f = x*(x - 1); g = x*(y - 2);");
    check_default(
        "a line and a point",
        &system,
        Answer {
            paths: 4,
            nonsingular: 1,
            positive_dimensional: 2,
            at_infinity: 1,
            real: Some(Some(1)),
            ..Answer::default()
        },
    );
}

/// (x + y + 9) (x + 1)^3 = 0, (x + y + 9) (y - 2x + 5/3)^3 = 0 holds on a line and at (-1, -11/3), with multiplicity 9:
/// there doubles do not tell the null space of the Jacobian, which is 0, from that of a triple line.
#[test]
fn a_point_of_multiplicity_9_beside_a_line_is_told_by_fractions() {
    let system = written(
        "variable_group x, y; function f, g; f = (x + y + 9)*(x + 1)^3; g = (x + y + 9)*(y - 2*x + 5/3)^3;",
    );
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let set = solve(&system, &options, &|_| None).1.remove(0);
        let counts = &set.counts;
        let expected = (1, 9, Some(1), Some(true), true);
        let answer = (
            counts.distinct,
            counts.with_multiplicity,
            counts.real,
            counts.positive_dimensional,
            set.settled(),
        );
        assert_eq!(answer, expected, "seed {seed}: {:?}", set.warnings);
    }
}

/// A line that is counted twice, and a point beside it: x^2 (x - 1) = 0, x^2 (y - 2) = 0 holds on x = 0 and
/// at (1, 2). No slice of a double line has a regular solution.
#[test]
fn a_point_beside_a_double_line_is_told_from_it() {
    let system = written("variable_group x, y; function f, g; f = x^2*(x - 1); g = x^2*(y - 2);");
    for seed in SEEDS {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        let actual_counts = (
            counts.distinct,
            counts.singular,
            counts.positive_dimensional,
        );
        assert_eq!(actual_counts, (1, 0, Some(true)), "seed {seed}: {paths:?}");
        assert!(
            paths.positive_dimensional > Some(0),
            "seed {seed}: {paths:?}"
        );
    }
}

/// 22 points of 64 paths: (1, ..., 1) has multiplicity 42 (Dayton and Zeng 2005, KSS).
#[test]
fn kss_6_has_a_point_of_multiplicity_42() {
    let answer = Answer {
        paths: 64,
        nonsingular: 22,
        singular_paths: 42,
        singular: Some(1),
        ..Answer::default()
    };
    let options = SolveOptions {
        method: SolveMethod::TotalDegree,
        seed: 1,
        ..SolveOptions::default()
    };
    let (_, sets) = solve(&kss(6).system, &options, &|_| None);
    let wrong = complaints(&sets[0], &answer);
    assert!(wrong.is_empty(), "{wrong}");
    assert_eq!(multiplicities(&sets[0]).last(), Some(&42));
}

/// The exact answer of a system without multiple points on curves: points of multiplicity 4 and 8 at which
/// paths end that are not all recognised as one cluster are never taken for points of a curve.
#[test]
fn quadruple_and_eightfold_points_lie_on_no_curve() {
    let text = "variable_group x, y, z; function f, g, h; \
                f = (x - 1)^2*(x + 2); g = (y - 3)^2*(y - x); h = (z + x)^2*(z - 5);";
    let system = written(text);
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let paths = &sets[0].paths;
        assert_eq!(
            paths.positive_dimensional,
            Some(0),
            "seed {seed}: {paths:?}"
        );
        assert!(
            sets[0].counts.with_multiplicity == 27 || !sets[0].settled(),
            "seed {seed}: {:?}",
            sets[0].counts
        );
    }
}

/// A polynomial in one unknown has no set of solutions: (x - 1)^3 (x + 2)^2 has two roots.
#[test]
fn multiple_roots_in_one_unknown_lie_on_no_set() {
    for (text, roots) in [
        ("f = (x - 1)^3;", 1),
        ("f = (x - 1)^3*(x + 2)^2;", 2),
        ("f = x^4 - 4*x^3 + 6*x^2 - 4*x + 1;", 1),
    ] {
        let system = written(&format!("variable_group x; function f; {text}"));
        for seed in SEEDS {
            let options = SolveOptions {
                seed,
                ..SolveOptions::default()
            };
            let (_, sets) = solve(&system, &options, &|_| None);
            let paths = &sets[0].paths;
            assert_eq!(
                paths.positive_dimensional,
                Some(0),
                "{text} {seed}: {paths:?}"
            );
            let right = sets[0].counts.distinct == roots;
            assert!(
                right || !sets[0].settled(),
                "{text} {seed}: {:?}",
                sets[0].counts
            );
        }
    }
}

/// The 40 paths of one cycle end at the origin, whose multiplicity is 40; 23 simple points besides.
/// (`ZeroDim.example_31` of symbolicdata.org; 24 points, 63 with multiplicities, by a Groebner basis.)
#[test]
fn a_cycle_of_40_sheets_closes() {
    let system = written(
        "variable_group x, y; function f, g;
         f = 3*x^2*y^9 + y^9 + 5*x^4;
         g = 9*x^3*y^8 + 11*y^10 + 9*x*y^8;",
    );
    let (_, sets) = solve(&system, &SolveOptions::default(), &|_| None);
    let set = &sets[0];
    let paths = &set.paths;
    assert_eq!((paths.total, paths.finite, paths.failed), (67, 23, 0));
    let counts = &set.counts;
    let actual_counts = (counts.distinct, counts.with_multiplicity);
    assert_eq!(
        (actual_counts, set.settled()),
        ((24, 63), true),
        "{counts:?}"
    );
}

/// x = -y^3 on the first curve, -y^8 = 0 on the second. One circle is closed by a path that does not end at its mean.
#[test]
fn a_point_of_multiplicity_8_is_proved_where_it_is_rational() {
    let system =
        written("variable_group x, y; function f, g; f = x + y^3; g = x*y - x^2*y^2 + y^4;");
    check_multiplicities(
        "two curves that touch",
        &system,
        Answer {
            paths: 12,
            singular_paths: 8,
            singular: Some(1),
            at_infinity: 4,
            real: Some(Some(1)),
            ..Answer::default()
        },
        &[8],
    );
}

/// Dayton, Zeng: Computing the multiplicity structure in solving polynomial systems, ISSAC 2005, DZ1: multiplicity 131,
/// and 125 simple solutions (a = b = c = d is one of those with a^5 = 1 up to roots of unity).
#[test]
fn a_point_of_multiplicity_131_is_decided() {
    let system = written(
        "variable_group a, b, c, d; function f, g, h, k; \
         f = a^4 - b*c*d; g = b^4 - a*c*d; h = c^4 - a*b*d; k = d^4 - a*b*c;",
    );
    for seed in 1..=2 {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let (counts, settled) = (&sets[0].counts, sets[0].settled());
        let actual_counts = (
            counts.nonsingular,
            counts.singular,
            counts.with_multiplicity,
        );
        assert_eq!(
            (actual_counts, settled),
            ((125, 1, 256), true),
            "seed {seed}"
        );
    }
}

/// Gradient of Motzkin's polynomial x^4 y^2 + x^2 y^4 - 3 x^2 y^2 + 1: both axes, on each of which two points and the
/// origin are embedded, and (+-1, +-1).
#[test]
fn embedded_points_lie_on_their_sets() {
    let system = written(
        "variable_group x, y; function f, g; \
         f = 4*x^3*y^2 + 2*x*y^4 - 6*x*y^2; g = 2*x^4*y + 4*x^2*y^3 - 6*x^2*y;",
    );
    check_default(
        "Motzkin's gradient",
        &system,
        Answer {
            paths: 25,
            nonsingular: 4,
            positive_dimensional: 21,
            real: Some(Some(4)),
            ..Answer::default()
        },
    );
}

/// Critical points of Rosenbrock's function in three variables. Around one end at infinity a path closes after one
/// turn at two radii, as often as branch points lie inside both: their mean solves nothing.
#[test]
fn rosenbrocks_critical_points_are_three() {
    let system = written(
        "variable_group x, y, z; function f, g, h; \
         f = -400*x*(y - x^2) - 2*(1 - x); g = 200*(y - x^2) - 400*y*(z - y^2) - 2*(1 - y); \
         h = 200*(z - y^2);",
    );
    check_default(
        "Rosenbrock",
        &system,
        Answer {
            paths: 18,
            nonsingular: 3,
            at_infinity: 15,
            real: Some(Some(1)),
            ..Answer::default()
        },
    );
}
