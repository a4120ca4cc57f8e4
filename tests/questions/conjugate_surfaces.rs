//! Real parts of surfaces that are not their own conjugates: the curves and points where they meet them.
//!
//! `REAL_PARTS=50 cargo test -p cognate-tests --test questions conjugate` takes more planted sums of squares than every run.

use super::{ask, components, options, relative_residual, seeds};
use cognate_algorithms::questions::{QuestionSolve, run_locally};
use cognate_continuation::bend::SlicedEquations;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::witness::question::CurveWish;
use cognate_solutions::witness::real_surface::RealSurface;
use cognate_solutions::witness::{Answer, Question};
use cognate_systems::system::System;
use cognate_tests::systems::written;

/// The real part of a surface: Euler characteristic with compact support, whether it is bounded, connected parts that are
/// curves and points; there are no others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct RealPart {
    euler: i64,
    compact: bool,
    curves: u64,
    points: u64,
}

const NOTHING: RealPart = part(0, true, 0, 0);
const LINE: RealPart = part(-1, false, 1, 0);
const LOOP: RealPart = part(0, true, 1, 0);
const POINT: RealPart = part(1, true, 0, 1);
/// A line and a point: -1 + 1.
const LINE_AND_POINT: RealPart = part(0, false, 1, 1);
/// Two lines that meet: a point and four half-lines.
const CROSS: RealPart = part(-3, false, 1, 0);
const TWO_LINES: RealPart = part(-2, false, 2, 0);

const fn part(euler: i64, compact: bool, curves: u64, points: u64) -> RealPart {
    RealPart {
        euler,
        compact,
        curves,
        points,
    }
}

fn surface(equation: &str) -> System {
    written(&format!(
        "variable_group x, y, z; function f; f = {equation};"
    ))
}

const QUESTION: Question = Question::RealSurface { samples: 3 };

/// The real parts of all components of an equation, highest degree first as they are listed, of which nothing is in doubt.
fn real_surfaces(name: &str, equation: &str, seed: u64) -> Vec<RealSurface> {
    match ask(name, &surface(equation), seed, &QUESTION) {
        Answer::RealSurface(surfaces) => surfaces,
        answer => panic!("{answer:?}"),
    }
}

fn real_part(surface: &RealSurface) -> RealPart {
    let counts = surface.mesh.counts();
    assert_eq!(counts.parts, counts.curve_parts + counts.point_parts);
    part(
        surface.euler,
        surface.compact,
        counts.curve_parts,
        counts.point_parts,
    )
}

/// The largest of the residuals at the vertices of a mesh.
fn residual(equation: &System, surface: &RealSurface) -> f64 {
    let equation = SlicedEquations::new(equation, Vec::new());
    let vertices = surface.mesh.vertices.iter();
    let residuals = vertices.map(|vertex| relative_residual(&equation, vertex));
    residuals.fold(0.0, f64::max)
}

/// All components of the equation are pairs of conjugates, with this real part.
fn check(name: &str, equation: &str, expected: RealPart) {
    for seed in seeds() {
        let surfaces = real_surfaces(name, equation, seed);
        assert_eq!(surfaces.len(), 2, "{name}: a component and its conjugate");
        for surface_part in &surfaces {
            assert_eq!(real_part(surface_part), expected, "{name}, seed {seed}");
            let residual = residual(&surface(equation), surface_part);
            assert!(residual < 1e-9, "{name}, seed {seed}: {residual:e}");
        }
    }
}

macro_rules! conjugate_surfaces {
    ($($name:ident: $equation:expr, $expected:expr;)*) => {$(
        #[test]
        fn $name() {
            check(stringify!($name), $equation, $expected);
        }
    )*};
}

// A sum of two squares of real polynomials is 0 where both are. The first four are those of report 253. Of the cross each
// line is a curve of its own; the isolated point is where two lines meet that are each other's conjugates.
conjugate_surfaces! {
    conjugate_planes: "x^2 + y^2", LINE;
    conjugate_circle: "(x^2 + y^2 - 1)^2 + z^2", LOOP;
    conjugate_loop: "(x^2 + y^2 - 1)^2 + (z^2 - x)^2", LOOP;
    conjugate_arc_and_point: "(y^2 - x^2*(x - 1))^2 + z^2", LINE_AND_POINT;
    conjugate_node: "(y^2 - x^2*(x + 1))^2 + z^2", part(-2, false, 1, 0);
    conjugate_parallel_planes: "x^2 + 1", NOTHING;
    conjugate_cross: "x^2 + y^2*z^2", CROSS;
    conjugate_point: "(x^2 + y^2)^2 + 3*z^2", POINT;
    conjugate_two_points: "(x^2 + y^2 + z^2 - 1)^2 + (z^2 - 1)^2", part(2, true, 0, 2);
    conjugate_double_line: "x^2 + y^4", LINE;
    conjugate_double_circle: "(x^2 + y^2 - 1)^2 + z^4", LOOP;
    conjugate_double_circle_and_parabola: "(x^2 + y^2 - 1)^4 + (z - x*y)^2", LOOP;
    conjugate_circle_expanded: "x^4 + 2*x^2*y^2 + y^4 - 2*x^2 - 2*y^2 + 1 + z^2", LOOP;
    conjugate_double_line_expanded: "4*x^2 + 4*x*z + z^2 + y^4", LINE;
    conjugate_far_away: "((x - 300)^2 + (y + 200)^2 - 1)^2 + (z - 500)^2", LOOP;
}

/// The axis of the planes goes through a sphere, which is its own conjugate.
#[test]
fn conjugate_planes_beside_a_sphere() {
    for seed in seeds() {
        let equation = "(x^2 + y^2)*(x^2 + y^2 + z^2 - 4)";
        let surfaces = real_surfaces("planes and sphere", equation, seed);
        let (planes, spheres): (Vec<_>, Vec<_>) = surfaces.iter().partition(|s| s.degree == 1);
        assert_eq!((planes.len(), spheres.len()), (2, 1), "seed {seed}");
        for plane in planes {
            assert_eq!(real_part(plane), LINE, "seed {seed}");
        }
        let counts = spheres[0].mesh.counts();
        let sphere = (spheres[0].euler, spheres[0].compact, counts.parts);
        assert_eq!(sphere, (2, true, 1), "seed {seed}");
    }
}

/// A plane has no outline: no value of a form is critical on it.
#[test]
fn planes_are_one_part() {
    for equation in ["z", "x + y - 1"] {
        let surfaces = real_surfaces("a plane", equation, 1);
        assert_eq!(surfaces.len(), 1, "{equation}");
        let counts = surfaces[0].mesh.counts();
        let sheet = (surfaces[0].euler, surfaces[0].compact, counts.parts);
        assert_eq!(sheet, (1, false, 1), "{equation}");
    }
}

/// Points of a pair of conjugates that are not told apart are found as those of one surface.
#[test]
fn conjugate_planes_that_are_one_set() {
    let system = surface("x^2 + y^2");
    for seed in seeds() {
        let whole = cognate_algorithms::decomposition::DecompositionOptions {
            split: false,
            ..options(seed)
        };
        let solve = cognate_algorithms::decomposition::DecompositionSolve::new(&system, &whole);
        let set =
            cognate_algorithms::decomposition::run_locally(solve.expect("a system"), 8).unwrap();
        let solve = QuestionSolve::new(&system, &options(seed), &set.components, &QUESTION);
        let (answer, doubts) = run_locally(solve.expect("it can be asked"), 8).unwrap();
        let Answer::RealSurface(surfaces) = answer else {
            panic!("{answer:?}");
        };
        let right = surfaces.len() == 1 && real_part(&surfaces[0]) == LINE;
        assert!(right || !doubts.is_empty(), "seed {seed}: {surfaces:?}");
    }
}

/// Surfaces that are their own conjugates, and of which only a curve is real: right, or in doubt.
#[test]
fn real_parts_that_are_curves() {
    let surfaces = [
        ("(x^2 + y^2 - 1)^2 + z^4 + z^2", LOOP),
        ("x^2 + y^2*(z^2 + 1)", LINE),
    ];
    for (equation, expected) in surfaces {
        for seed in seeds() {
            match real_parts_of(equation, &surface(equation), seed) {
                Ok(surfaces) => {
                    assert_eq!(surfaces.len(), 1, "{equation}");
                    assert_eq!(real_part(&surfaces[0]), expected, "{equation}, seed {seed}");
                }
                Err(doubt) => eprintln!("{equation}, seed {seed}: {doubt}"),
            }
        }
    }
}

/// Conjugate lines in the plane and in space: the real part consists of the points where they meet.
#[test]
fn conjugate_lines_meet_in_a_point() {
    let systems = [
        ("variable_group x, y; function f; f = x^2 + y^2;", 1),
        (
            "variable_group x, y; function f; f = (x - 3)^2 + 2*(y + 1)^2;",
            1,
        ),
        ("variable_group x, y; function f; f = x^2 + 1;", 0),
        (
            "variable_group x, y; function f; f = (x^2 - 1)^2 + (y^2 - 4)^2;",
            4,
        ),
        (
            "variable_group x, y, z; function f, g; f = x^2 + y^2; g = x - z;",
            1,
        ),
    ];
    let question = Question::RealCurve(CurveWish {
        samples: 2,
        ..CurveWish::default()
    });
    for (text, points) in systems {
        for seed in seeds() {
            let Answer::RealCurve(curves) = ask(text, &written(text), seed, &question) else {
                panic!("{text}: no curves");
            };
            for curve in curves {
                let counts = curve.counts();
                let parts = (counts.isolated_points, counts.connected_components);
                assert_eq!(parts, (points, points), "{text}, seed {seed}");
            }
        }
    }
}

/// A polynomial in s and t, and the real part of its zeros in the plane of s and t.
const CURVES: [(&str, RealPart); 12] = [
    ("S - T", LINE),
    ("S^2 + T^2 - 1", LOOP),
    ("S^2 + 3*T^2 - 2", LOOP),
    ("S*T - 1", TWO_LINES),
    ("S^2 - 2*T^2 + 1", TWO_LINES),
    ("T - S^2", LINE),
    ("S*T", CROSS),
    ("S^2 + T^2", POINT),
    ("S^2 + T^2 + 1", NOTHING),
    ("T^2 - S^2*(S - 1)", LINE_AND_POINT),
    ("T^2 - S^2*(S + 1)", part(-2, false, 1, 0)),
    ("T^2 - S^3 + S", part(-1, false, 2, 0)),
];

/// How many sums of squares are planted.
fn planted() -> u64 {
    let wanted = std::env::var("REAL_PARTS");
    wanted.ok().and_then(|n| n.parse().ok()).unwrap_or(12)
}

/// A sum of two squares: of a polynomial in two linear forms, and of a third form, bent along the first two. Its real
/// part is the curve of the polynomial in other coordinates.
fn sum_of_squares(number: u64) -> (String, RealPart) {
    let mut random = RandomStream::new(253, Purpose::Probe, number);
    let mut between = |low: i64, high: i64| low + random.below((high - low + 1) as u64) as i64;
    let (curve, expected) = CURVES[number as usize % CURVES.len()];
    // Unimodular: a lower and an upper triangle, then shifts.
    let [a, b, c, d, e, f] = [(); 6].map(|()| between(-1, 1));
    let [p, q, r] = [(); 3].map(|()| between(-3, 3));
    let w = format!("(z + ({e})*x + ({f})*y + ({r}))");
    let t = format!("(y + ({c})*x + ({d})*{w} + ({q}))");
    let s = format!("(x + ({a})*{t} + ({b})*{w} + ({p}))");
    let curve = curve.replace('S', &s).replace('T', &t);
    let bent = format!(
        "({w} - ({})*{s}^2 - ({})*{t})",
        between(0, 1),
        between(-1, 1)
    );
    let [m, n] = [(); 2].map(|()| between(1, 5));
    let equation = match between(0, 1) {
        0 => format!("{m}*({curve})^2 + {n}*{bent}^2"),
        // Not written as a sum of two squares.
        _ => format!("{m}*({curve})^2 + {n}*{bent}^2 + {bent}*{bent}"),
    };
    (equation, expected)
}

/// The real parts of the components of a system, or the first doubt.
fn real_parts_of(name: &str, system: &System, seed: u64) -> Result<Vec<RealSurface>, String> {
    let set = components(name, system, seed);
    let solve = QuestionSolve::new(system, &options(seed), &set.components, &QUESTION);
    let (answer, doubts) = run_locally(solve.expect("it can be asked"), 8).expect("stages run");
    let Answer::RealSurface(surfaces) = answer else {
        panic!("{answer:?}");
    };
    match doubts.into_iter().next() {
        None => Ok(surfaces),
        Some(doubt) => Err(doubt),
    }
}

/// Right, or now and then a doubt.
#[test]
fn conjugate_sums_of_squares() {
    let mut doubtful = 0;
    for number in 0..planted() {
        let (equation, expected) = sum_of_squares(number);
        let (name, seed) = (format!("planted {number}"), 1 + number % 3);
        let began = std::time::Instant::now();
        let real_parts = real_parts_of(&name, &surface(&equation), seed);
        let seconds = began.elapsed().as_secs_f64();
        eprintln!("{name}, seed {seed}: {seconds:.2} s");
        match real_parts {
            Ok(surfaces) => {
                for surface in surfaces {
                    assert_eq!(real_part(&surface), expected, "{name}: {equation}");
                }
            }
            Err(doubt) => {
                doubtful += 1;
                eprintln!("{name}: {equation}: {doubt}");
            }
        }
    }
    assert!(4 * doubtful <= planted(), "{doubtful} of {}", planted());
}

/// An equation with denominators.
fn rational_surface(equation: &str) -> System {
    let text = format!("{{\"variables\": [\"x\", \"y\", \"z\"], \"equations\": [\"{equation}\"]}}");
    let read = cognate_systems::formats::read("test", text.as_bytes());
    read.expect("a problem of this test").system
}

/// Curves and points of a real part on which a denominator is 0 are none of it; those that only meet its zeros stay.
#[test]
fn real_parts_where_a_denominator_is_0() {
    let conjugates = [
        // On the axis, the only real points, the denominator is 0.
        ("(x^2 + y^2)/x", NOTHING),
        ("(x^2 + y^2)/(z - 1)", LINE),
        ("((x^2 + y^2 - 1)^2 + z^2)/(x^2 + y^2 - 1 + z)", NOTHING),
        // The point at the origin is none; the arc stays.
        ("((y^2 - x^2*(x - 1))^2 + z^2)/x", LINE),
        // One of two lines that meet.
        ("(x^2 + y^2*z^2)/y", LINE),
    ];
    for (equation, expected) in conjugates {
        for seed in seeds() {
            let surfaces =
                real_parts_of(equation, &rational_surface(equation), seed).expect(equation);
            for surface in surfaces {
                assert_eq!(real_part(&surface), expected, "{equation}, seed {seed}");
            }
        }
    }
    let real_parts =
        |equation: &str, seed| real_parts_of(equation, &rational_surface(equation), seed);
    for seed in seeds() {
        // A cone without its point has the same closure; a point alone is none.
        let cone = real_parts("(x^2 + y^2 - z^2)/x", seed).expect("a cone");
        assert_eq!((cone[0].euler, cone[0].compact), (1, false), "seed {seed}");
        let nothing = real_parts("(x^2 + 2*y^2 + 3*z^2)/x", seed).expect("nothing");
        assert_eq!(real_part(&nothing[0]), NOTHING, "seed {seed}");
        // The handle of the umbrella is in doubt.
        let umbrella = real_parts("(x^2 - y^2*z)/y", seed);
        assert!(umbrella.is_err(), "seed {seed}: {umbrella:?}");
    }
}
