//! Real curves with known loops, arcs and points: as they are, along variables, finer, in boxes, and with proofs.

use super::tests::{TWISTED_CUBIC, ask, components, system};
use cognate_solutions::witness::question::CurveWish;
use cognate_solutions::witness::real_curve::RealCurve;
use cognate_solutions::witness::{Answer, Question};

/// Loops, arcs, isolated and singular points, connected parts of one curve.
fn numbers(curve: &RealCurve) -> [u64; 5] {
    let counts = curve.counts();
    [
        counts.closed_loops,
        counts.unbounded_arcs,
        counts.isolated_points,
        counts.singular_points,
        counts.connected_components,
    ]
}

/// Loops, arcs, isolated and singular points, connected parts of all curves of a system together.
fn real_counts(text: &str, seed: u64) -> [u64; 5] {
    let system = system(text);
    let decomposition = components(&system, seed);
    let question = Question::RealCurve(CurveWish {
        samples: 2,
        ..CurveWish::default()
    });
    let (answer, doubts) = ask(&system, &decomposition.components, &question);
    let Answer::RealCurve(curves) = answer else {
        panic!("{answer:?}");
    };
    assert!(doubts.is_empty(), "seed {seed}: {doubts:?}");
    let mut sum = [0; 5];
    for curve in &curves {
        for (sum, number) in sum.iter_mut().zip(numbers(curve)) {
            *sum += number;
        }
        for point in curve.edges.iter().flat_map(|edge| &edge.samples) {
            assert!(point.iter().all(|z| z.im.abs() < 1e-9), "{point:?}");
        }
    }
    sum
}

#[test]
fn real_curves_have_their_loops_arcs_and_points() {
    let curves = [
        (
            "variable_group x, y; function f; f = x^2 + y^2 - 1;",
            [1, 0, 0, 0, 1],
        ),
        (
            "variable_group x, y; function f; f = x^2 - y^2 - 1;",
            [0, 2, 0, 0, 2],
        ),
        (
            "variable_group x, y; function f; f = y^2 - x*(x - 1)*(x + 1);",
            [1, 1, 0, 0, 2],
        ),
        (
            "variable_group x, y; function f; f = y^2 - x^2*(x - 1);",
            [0, 1, 1, 1, 2],
        ),
        (
            "variable_group x, y; function f; f = y^2 - x^2*(x + 1);",
            [0, 0, 0, 1, 1],
        ),
        (
            "variable_group x, y; function f; f = y^2 - x^3;",
            [0, 1, 0, 1, 1],
        ),
        (
            "variable_group x, y; function f; f = x^2 + y^2 + 1;",
            [0, 0, 0, 0, 0],
        ),
        (
            "variable_group x, y; function f; f = x - 2*y + 1;",
            [0, 1, 0, 0, 1],
        ),
        (
            "variable_group x, y; function f; f = (x^2 + y^2 - 1)*(x - 2*y);",
            [1, 1, 0, 0, 2],
        ),
        (TWISTED_CUBIC, [0, 1, 0, 0, 1]),
    ];
    for (text, expected) in curves {
        for seed in 1..=2 {
            assert_eq!(real_counts(text, seed), expected, "seed {seed}: {text}");
        }
    }
}

/// Along x many things are not general: values of critical points are the same, an inflection is critical, branches go
/// to infinity over a value or lie in a fibre. Each is right, or a doubt that says why.
#[test]
fn projections_that_are_not_general_are_right_or_in_doubt() {
    let curves = [
        ("x^2 + y^2 - 1", Ok([1, 0, 0, 0, 1])),
        // Two loops that meet in the origin, with equal highest and lowest points.
        ("(x^2 + y^2)^2 - y^2 + x^2", Ok([0, 0, 0, 1, 1])),
        ("x - y^3", Ok([0, 1, 0, 0, 1])),
        ("x^4 + y^4 - 1", Ok([1, 0, 0, 0, 1])),
        ("x*y - 1", Err("at infinity")),
        ("x - 1", Err("")),
    ];
    for (equation, expected) in curves {
        for seed in 1..=3 {
            let wish = CurveWish {
                samples: 2,
                projection: Some(0),
                ..CurveWish::default()
            };
            let (curve, doubts) = curve_of(equation, seed, wish);
            let counts = numbers(&curve);
            match expected {
                Ok(expected) => {
                    assert!(doubts.is_empty(), "{equation}, seed {seed}: {doubts:?}");
                    assert_eq!(counts, expected, "{equation}, seed {seed}");
                }
                Err(why) => assert!(
                    doubts.iter().any(|doubt| doubt.contains(why)),
                    "{equation}, seed {seed}: {counts:?}, {doubts:?}"
                ),
            }
        }
    }
}

/// Arcs whose points are as dense as a tolerance asks, also where they turn, and no denser than they must be.
#[test]
fn chords_are_as_near_to_their_arcs_as_is_asked() {
    // The distance of a point near the curve from it, from the value and the gradient of its equation.
    type Gap = fn(f64, f64) -> f64;
    let circle: Gap = |x, y| ((x * x + y * y).sqrt() - 1.0).abs();
    let cusp: Gap = |x, y| {
        let gradient = (4.0 * y * y + 9.0 * x * x * x * x).sqrt().max(1e-3);
        (y * y - x * x * x).abs() / gradient
    };
    let curves = [
        ("x^2 + y^2 - 1", circle, 1e-2),
        ("x^2 + y^2 - 1", circle, 1e-4),
        ("y^2 - x^3", cusp, 1e-3),
    ];
    for (equation, gap, tolerance) in curves {
        let wish = CurveWish {
            samples: 1,
            tolerance: Some(tolerance),
            ..CurveWish::default()
        };
        let (curve, doubts) = curve_of(equation, 1, wish);
        assert!(doubts.is_empty(), "{equation}: {doubts:?}");
        let (mut worst, mut count) = (0.0f64, 0);
        for edge in &curve.edges {
            let end = |k: usize| edge.ends[k].map(|v| &curve.vertices[v].point);
            let points: Vec<_> = end(0)
                .into_iter()
                .chain(&edge.samples)
                .chain(end(1))
                .collect();
            for pair in points.windows(2) {
                let [x, y] = [0, 1].map(|v| 0.5 * (pair[0][v].re + pair[1][v].re));
                worst = worst.max(gap(x, y));
                count += 1;
            }
        }
        assert!(worst < 2.0 * tolerance, "{equation}: {worst:e}");
        // A circle takes pi / sqrt(2 * tolerance) chords at least.
        let most = 40.0 + 12.0 / tolerance.sqrt();
        assert!(
            f64::from(count) < most,
            "{equation}: {count} pieces at {tolerance}"
        );
    }
}

/// The curve of one equation in x and y, asked in this way, and what is in doubt.
fn curve_of(equation: &str, seed: u64, wish: CurveWish) -> (RealCurve, Vec<String>) {
    let system = system(&format!("variable_group x, y; function f; f = {equation};"));
    let decomposition = components(&system, seed);
    let (answer, doubts) = ask(
        &system,
        &decomposition.components,
        &Question::RealCurve(wish),
    );
    let Answer::RealCurve(mut curves) = answer else {
        panic!("{answer:?}");
    };
    assert_eq!(curves.len(), 1, "{equation}, seed {seed}");
    (curves.remove(0), doubts)
}

/// Loops, arcs across the box, isolated points, singular points and connected parts of what lies in a box; or a doubt.
#[test]
fn what_lies_in_a_box() {
    let elliptic = "y^2 - x*(x - 1)*(x + 1)";
    type Expected = Result<[u64; 5], &'static str>;
    let cases: [(&str, [[f64; 2]; 2], Expected); 14] = [
        (
            "x^2 + y^2 - 1",
            [[-2.0, 2.0], [-2.0, 2.0]],
            Ok([1, 0, 0, 0, 1]),
        ),
        (
            "x^2 + y^2 - 1",
            [[0.25, 2.0], [-2.0, 2.0]],
            Ok([0, 1, 0, 0, 1]),
        ),
        (
            "x^2 + y^2 - 1",
            [[-2.0, 2.0], [-0.5, 0.5]],
            Ok([0, 2, 0, 0, 2]),
        ),
        ("x^2 + y^2 - 1", [[5.0, 6.0], [5.0, 6.0]], Ok([0; 5])),
        ("x^2 + y^2 - 1", [[-0.5, 0.5], [-0.5, 0.5]], Ok([0; 5])),
        (
            "x^2 - y^2 - 1",
            [[-3.0, 3.0], [-4.0, 4.0]],
            Ok([0, 2, 0, 0, 2]),
        ),
        ("x*y - 1", [[-3.0, 3.0], [-4.0, 4.0]], Ok([0, 2, 0, 0, 2])),
        (elliptic, [[-2.0, 2.0], [-9.0, 9.0]], Ok([1, 1, 0, 0, 2])),
        (elliptic, [[0.5, 2.0], [-9.0, 9.0]], Ok([0, 1, 0, 0, 1])),
        (
            "y^2 - x^2*(x + 1)",
            [[-0.5, 0.5], [-4.0, 4.0]],
            Ok([0, 0, 0, 1, 1]),
        ),
        (
            "y^2 - x^2*(x - 1)",
            [[-0.5, 0.5], [-4.0, 4.0]],
            Ok([0, 0, 1, 1, 1]),
        ),
        (
            "x - 2*y + 1",
            [[-1.0, 1.5], [-9.0, 9.0]],
            Ok([0, 1, 0, 0, 1]),
        ),
        // A face that touches, and a corner.
        (
            "x^2 + y^2 - 1",
            [[-1.0, 2.0], [-2.0, 2.0]],
            Err("not general"),
        ),
        ("x - y", [[0.0, 1.0], [0.0, 1.0]], Err("edge of the box")),
    ];
    for (equation, within, expected) in cases {
        for seed in 1..=3 {
            let wish = CurveWish {
                samples: 2,
                tolerance: Some(1e-2),
                within: within.to_vec(),
                ..CurveWish::default()
            };
            let (curve, doubts) = curve_of(equation, seed, wish);
            let what = format!("{equation} in {within:?}, seed {seed}: {doubts:?}");
            match expected {
                Err(why) => assert!(doubts.iter().any(|d| d.contains(why)), "{what}"),
                Ok(expected) => {
                    assert!(doubts.is_empty(), "{what}");
                    let c = curve.counts();
                    let counts = [
                        c.closed_loops,
                        c.arcs_across_box,
                        c.isolated_points,
                        c.singular_points,
                        c.connected_components,
                    ];
                    assert_eq!(counts, expected, "{what}");
                    assert_eq!(c.unbounded_arcs, 0, "{what}");
                    let samples = curve.edges.iter().flat_map(|edge| &edge.samples);
                    for point in samples.chain(curve.vertices.iter().map(|v| &v.point)) {
                        let inside = |(z, [low, high]): (&num_complex::Complex64, &[f64; 2])| {
                            (low - 1e-9..=high + 1e-9).contains(&z.re)
                        };
                        assert!(point.iter().zip(&within).all(inside), "{what}: {point:?}");
                    }
                }
            }
        }
    }
}

/// A node and a circle far from the origin, the circle multiplied out, are asked about their centre and answered about
/// the origin.
#[test]
fn curves_far_away_come_back_to_their_places() {
    let node = "(y + 20000)^2 - (x - 10000)^2*(x - 9999)";
    let circle = "x^2 - 20000*x + y^2 + 40000*y + 500000000 - 4";
    let near = || CurveWish {
        samples: 2,
        within: vec![[9_999.0, 10_003.0], [-20_010.0, -19_990.0]],
        certify: true,
        ..CurveWish::default()
    };
    for seed in 1..=3 {
        let (curve, doubts) = curve_of(
            node,
            seed,
            CurveWish {
                samples: 1,
                ..CurveWish::default()
            },
        );
        assert!(doubts.is_empty(), "{doubts:?}");
        let singular = curve.vertices.iter().find(|v| v.is_singular()).unwrap();
        let expected = [10_000.0, -20_000.0];
        let at = singular
            .point
            .iter()
            .zip(expected)
            .all(|(z, x)| (z.re - x).abs() < 1e-6);
        assert!(at, "{singular:?}");
        let (curve, doubts) = curve_of(circle, seed, near());
        assert!(doubts.is_empty(), "{doubts:?}");
        let counts = curve.counts();
        assert_eq!(
            (counts.arcs_across_box, counts.closed_loops),
            (1, 0),
            "{curve:?}"
        );
        assert_eq!(curve.proved_slabs(), Some(curve.proofs.len()));
        for point in curve.edges.iter().flat_map(|edge| &edge.samples) {
            let (x, y) = (point[0].re - 10_000.0, point[1].re + 20_000.0);
            assert!((x * x + y * y - 4.0).abs() < 1e-6 && x > -1.0, "{x} {y}");
        }
    }
}

/// The number of real branches over every slab is proved, and is that of the arcs there.
#[test]
fn real_branches_over_slabs_are_proved() {
    let curves = [
        "x^2 + y^2 - 1",
        "x^2 - y^2 - 1",
        "x^2 + y^2 + 1",
        "y^2 - x*(x - 1)*(x + 1)",
        "y^2 - x^2*(x - 1)",
        "y^2 - x^2*(x + 1)",
        "y^2 - x^3",
        "(x^2 + y^2)^3 - 4*x^2*y^2",
    ];
    for equation in curves {
        for seed in 1..=2 {
            let wish = CurveWish {
                samples: 1,
                certify: true,
                ..CurveWish::default()
            };
            let (curve, doubts) = curve_of(equation, seed, wish);
            let what = format!("{equation}, seed {seed}: {doubts:?}, {:?}", curve.proofs);
            assert!(doubts.is_empty(), "{what}");
            assert_eq!(curve.proved_slabs(), Some(curve.proofs.len()), "{what}");
            let real: u64 = curve.proofs.iter().map(|proof| proof.real).sum();
            assert_eq!(real, curve.edges.len() as u64, "{what}");
        }
    }
    // Two lines that conjugation exchanges: their real point is not proved, which is said.
    let system = system("variable_group x, y; function f; f = x^2 + y^2;");
    let decomposition = components(&system, 1);
    let wish = CurveWish {
        certify: true,
        samples: 1,
        ..CurveWish::default()
    };
    let (_, doubts) = ask(
        &system,
        &decomposition.components,
        &Question::RealCurve(wish),
    );
    let unproved = |doubt: &String| doubt.contains("not its own conjugate");
    assert!(
        !doubts.is_empty() && doubts.iter().all(unproved),
        "{doubts:?}"
    );
}
