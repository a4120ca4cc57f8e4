//! Systems with exact answers whose solutions are hard to tell: far away, or sensitive to every digit.

use crate::check::{Answer, SEEDS, check, seeds_of_slow_answers, solve};
use cognate_algorithms::SolveOptions;
use cognate_tests::systems::written;
use std::fmt::Write as _;

/// Chandrasekhar's H-equation, n = 6, c = 0.51234 (More 1990; Gonzalez-Vega 1996): one of its 32
/// solutions is 1.19e4 away from 0, and solvers that take size for infinity lose it.
#[test]
fn chandra_6_has_32_solutions_one_of_them_far_away() {
    let n = 6;
    let names: Vec<String> = (1..=n).map(|i| format!("H{i}")).collect();
    let functions: Vec<String> = (1..=n).map(|i| format!("f{i}")).collect();
    let mut text = format!(
        "variable_group {}; function {};",
        names.join(", "),
        functions.join(", ")
    );
    for i in 1..=n {
        let _ = write!(text, " f{i} = {}*H{i} - 0.51234*H{i}*(1", 2 * n);
        for j in 1..n {
            let _ = write!(text, " + {i}/{}*H{j}", i + j);
        }
        let _ = write!(text, ") - {};", 2 * n);
    }
    let system = written(&text);
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let (paths, counts) = (&sets[0].paths, &sets[0].counts);
        assert_eq!(
            (counts.nonsingular, counts.singular, paths.failed),
            (32, 0, 0),
            "seed {seed}: {paths:?}"
        );
        let largest = |values: &[num_complex::Complex64]| {
            values
                .iter()
                .map(|z| z.norm_sqr().sqrt())
                .fold(0.0, f64::max)
        };
        let sizes = sets[0].solutions.iter().map(|solution| {
            let values: Vec<_> = solution.variables.values().collect();
            largest(&values)
        });
        let far = sizes.fold(0.0, f64::max);
        assert!((1.18e4..1.20e4).contains(&far), "seed {seed}: {far:e}");
    }
}

/// x = 3, y in {0.1, -1, -7e10}, z in {4006, 6.2}: beside a coordinate of 7e10 the others have their digits as well.
#[test]
fn small_coordinates_beside_a_huge_one_have_their_digits() {
    let system = written(
        "variable_group x, y, z; function f1, f2, f3; f1 = x - 3; \
         f2 = y^3 + 700000000009/10*y^2 + 629999999999/10*y - 7000000000; \
         f3 = 4*x^2 - 4*x*z + 40002/5*x + z^2 - 20001/5*z + 800;",
    );
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        assert_eq!(sets[0].counts.real, Some(6), "seed {seed}");
        for solution in &sets[0].solutions {
            let values: Vec<_> = solution.variables.values().collect();
            let near =
                |z: num_complex::Complex64, exact: f64| ((z - exact) / exact).norm_sqr() < 1e-16;
            assert!(near(values[0], 3.0), "seed {seed}: {values:?}");
            let z = values[2];
            assert!(near(z, 4006.0) || near(z, 6.2), "seed {seed}: {values:?}");
        }
    }
}

/// (x+y-z)^2 = -4e24, y^2 = 1.6e-15, (2x+2y-3z)^2 = -1/15625: eight solutions near 1e12, in pairs that differ by parts of
/// 1e-14. Coefficients that range over 38 orders of magnitude let no solution count as infinite unseen.
#[test]
fn solutions_beyond_every_digit_are_doubted_not_dropped() {
    let system = written(
        "variable_group x, y, z; function f1, f2, f3; \
         f1 = (x + y - z)^2 + 4000000000000000000000000; f2 = y^2 - 1/625000000000000; \
         f3 = 4*x^2 + 8*x*y - 12*x*z + 4*y^2 - 12*y*z + 9*z^2 + 1/15625;",
    );
    for seed in seeds_of_slow_answers() {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let right = sets[0].counts.distinct == 8;
        assert!(
            right || !sets[0].settled(),
            "seed {seed}: {:?}",
            sets[0].paths
        );
    }
}

/// (x-1)(x-2)...(x-12), multiplied out (Wilkinson 1959): a change of a coefficient by 2^-53 of itself
/// moves a root by more than 1e-9.
#[test]
fn wilkinson_12_has_its_roots() {
    let mut coefficients: Vec<i64> = vec![1];
    for root in 1..=12 {
        let mut next = vec![0; coefficients.len() + 1];
        for (k, c) in coefficients.iter().enumerate() {
            next[k + 1] += c;
            next[k] -= c * root;
        }
        coefficients = next;
    }
    let terms = coefficients.iter().enumerate();
    let terms: Vec<String> = terms.map(|(k, c)| format!("({c})*x^{k}")).collect();
    let system = written(&format!(
        "variable_group x; function f; f = {};",
        terms.join(" + ")
    ));
    let answer = Answer {
        paths: 12,
        nonsingular: 12,
        real: Some(Some(12)),
        ..Answer::default()
    };
    check("Wilkinson-12", &system, &SolveOptions::default(), answer);
    let (_, sets) = solve(&system, &SolveOptions::default(), &|_| None);
    let mut roots: Vec<f64> = sets[0]
        .solutions
        .iter()
        .map(|s| s.variables.0[0].value.re)
        .collect();
    roots.sort_by(f64::total_cmp);
    for (root, expected) in roots.iter().zip(1..=12) {
        assert!((root - f64::from(expected)).abs() < 1e-4, "{roots:?}");
    }
}

/// A line that all but touches the circle, bent so that no elimination is linear: x = +-sqrt(2) 1e-8, to 24 digits,
/// are two points that doubles take for one; dual spaces do not confirm it, and more digits tell them apart.
#[test]
fn points_that_doubles_do_not_tell_apart_are_two() {
    let system = written(
        "variable_group x, y; function f, g; f = x^2 + y^2 - 1; \
         g = y - 1 + 1/10000000000000000 + x/3*(y - 1)^2;",
    );
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let counts = &sets[0].counts;
        assert!(sets[0].settled(), "seed {seed}: {:?}", sets[0].warnings);
        assert_eq!((counts.nonsingular, counts.singular), (6, 0), "seed {seed}");
        let near = sets[0].solutions.iter().filter(|solution| {
            let x = solution.variables.values().next().expect("two variables");
            (x.norm_sqr().sqrt() / 1.414_213_562_4e-8 - 1.0).abs() < 1e-8
        });
        assert_eq!(near.count(), 2, "seed {seed}");
    }
}

/// The interval arithmetic benchmark i1 (one of PHCpack's demos, with 66 solutions, 16 of them real): at one of them coordinates go from 4e-11 to 4e11, and the
/// condition number is 5e20. Taken for a point on a set of solutions, it was lost in silence.
#[test]
fn regular_solutions_with_coordinates_of_very_different_sizes_are_regular() {
    let system = written(
        "variable_group x1, x2, x3, x4, x5, x6, x7, x8, x9, x10; \
         function f1, f2, f3, f4, f5, f6, f7, f8, f9, f10; \
         f1 = x1 - 0.25428722 - 0.18324757*x4*x3*x9; \
         f2 = x2 - 0.37842197 - 0.16275449*x1*x10*x6; \
         f3 = x3 - 0.27162577 - 0.16955071*x1*x2*x10; \
         f4 = x4 - 0.19807914 - 0.15585316*x7*x1*x6; \
         f5 = x5 - 0.44166728 - 0.19950920*x7*x6*x3; \
         f6 = x6 - 0.14654113 - 0.18922793*x8*x5*x10; \
         f7 = x7 - 0.42937161 - 0.21180484*x2*x5*x8; \
         f8 = x8 - 0.07056438 - 0.17081208*x1*x7*x6; \
         f9 = x9 - 0.34504906 - 0.19612740*x10*x6*x8; \
         f10 = x10 - 0.42651102 - 0.21466544*x4*x8*x1;",
    );
    for seed in 1..=5 {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let counts = &sets[0].counts;
        assert!(sets[0].settled(), "seed {seed}: {:?}", sets[0].warnings);
        assert_eq!(
            (counts.nonsingular, counts.singular, counts.real),
            (66, 0, Some(16)),
            "seed {seed}"
        );
        let sizes = sets[0].solutions.iter().map(|solution| {
            let values = solution.variables.values();
            values.map(|z| z.norm_sqr().sqrt()).fold(0.0, f64::max)
        });
        let far = sizes.fold(0.0, f64::max);
        assert!(
            (far / 3.760_923_057_506e11 - 1.0).abs() < 1e-9,
            "seed {seed}: {far:e}"
        );
    }
}
