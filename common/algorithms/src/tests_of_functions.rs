//! Equations with roots and angles: textbook cases, and systems that are made from known solutions.

use crate::run_locally::run_locally;
use crate::{SolveOptions, plan};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::formats::plain;
use num_complex::Complex64;

fn solve(equations: &str) -> SolutionSet {
    let problem = plain::typed("test", equations).map_err(|e| e.to_string());
    let system = problem.unwrap().system;
    let mut plan = plan(&system, &SolveOptions::default()).expect("a plan");
    let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
    sets.expect("paths").remove(0)
}

/// The difference of two values, where angles a turn apart are the same.
fn difference(is_angle: bool, a: Complex64, b: Complex64) -> f64 {
    let turn = if is_angle { std::f64::consts::TAU } else { 0.0 };
    let distances = [-turn, 0.0, turn].map(|t| (a - b + t).norm_sqr().sqrt());
    distances.into_iter().fold(f64::INFINITY, f64::min)
}

/// All solutions are the expected ones, each once.
#[track_caller]
fn check(equations: &str, angles: &[&str], removed: Option<u64>, expected: &[&[f64]]) {
    let set = solve(equations);
    assert!(set.settled(), "{equations}: {:?}", set.warnings);
    let points: Vec<Vec<Complex64>> = set
        .solutions
        .iter()
        .map(|solution| solution.variables.values().collect())
        .collect();
    assert_eq!(points.len(), expected.len(), "{equations}: {points:?}");
    for point in expected {
        let is_near = |solution: &cognate_solutions::solution::Solution| {
            let values = solution.variables.0.iter().zip(*point);
            values.into_iter().all(|(variable, &value)| {
                let is_angle = angles.contains(&variable.name.as_str());
                let value = Complex64::new(value, 0.0);
                difference(is_angle, variable.value, value) < 1e-12 * (1.0 + value.re.abs())
            })
        };
        assert_eq!(
            set.solutions.iter().filter(|s| is_near(s)).count(),
            1,
            "{equations}: {point:?} among {points:?}"
        );
    }
    if let Some(removed) = removed {
        let counts = &set.counts.removed;
        assert_eq!(counts["false branch"], removed, "{equations}: {counts:?}");
    }
}

#[test]
fn textbook_cases_have_their_solutions_and_no_others() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};
    check("sqrt(x + 3) = x - 3", &[], Some(1), &[&[6.0]]);
    check(
        "sqrt(x) + sqrt(y) = 5; x - y = 5",
        &[],
        Some(0),
        &[&[9.0, 4.0]],
    );
    check("x^(2/3) = 4", &[], Some(1), &[&[8.0]]);
    check("cbrt(x)^2 = 4", &[], Some(0), &[&[8.0], &[-8.0]]);
    check("x^(-1/2) = 3", &[], Some(0), &[&[1.0 / 9.0]]);
    check("sqrt(1 + sqrt(x)) = 2", &[], Some(0), &[&[9.0]]);
    check("sqrt(x) = -1", &[], Some(1), &[]);
    check("sqrt(x) = x", &[], Some(0), &[&[0.0], &[1.0]]);
    let arm = "cos(a) + cos(a + b) = 1; sin(a) + sin(a + b) = 1";
    check(
        arm,
        &["a", "b"],
        None,
        &[&[0.0, FRAC_PI_2], &[FRAC_PI_2, -FRAC_PI_2]],
    );
    check(
        "sin(a) = 1/2",
        &["a"],
        None,
        &[&[FRAC_PI_6], &[5.0 * FRAC_PI_6]],
    );
    check("exp(I*a) = -1", &["a"], None, &[&[PI]]);
    check(
        "tan(a) = 1",
        &["a"],
        None,
        &[&[PI / 4.0], &[-3.0 * PI / 4.0]],
    );
    check("sqrt(cos(a)) = -1/2", &["a"], Some(2), &[]);
}

/// Points whose roots or sines are simple numbers are real, though helpers are not.
#[test]
fn angles_are_answered_in_the_unit_in_which_they_are_typed() {
    use std::f64::consts::PI;
    check("sin(x*pi/180) = 1/2", &[], None, &[&[30.0], &[150.0]]);
    check(
        "sin(2*x*pi/180) = 1/2",
        &[],
        None,
        &[&[15.0], &[75.0], &[-105.0], &[-165.0]],
    );
    check(
        "tan(x/pi) = 1",
        &[],
        None,
        &[&[PI * PI / 4.0], &[-3.0 * PI * PI / 4.0]],
    );
    // x/2 lies between -pi and pi; sin(x/2) = -1 is a double solution.
    let half = "sin(x/2) = cos(x)";
    check(half, &[], None, &[&[PI / 3.0], &[5.0 * PI / 3.0], &[-PI]]);
    check(
        "cos(x) = sin(x/2)",
        &[],
        None,
        &[&[PI / 3.0], &[5.0 * PI / 3.0], &[-PI]],
    );
    // Angles of Langley's problem (SymPy issue 19803): one is 20 degrees, the other differs by half a turn.
    check(
        "sin(40*pi/180)/sin(30*pi/180) = z/sin(80*pi/180); \
         sin(x*pi/180)/sin(60*pi/180) = sin((x + 10)*pi/180)/z",
        &[],
        None,
        &[
            &[1.266_044_443_118_978, 20.0],
            &[1.266_044_443_118_978, -160.0],
        ],
    );
}

#[test]
fn solutions_are_real_by_their_typed_unknowns() {
    let set = solve("sqrt(x - 4)^2 + y = 0; x = 1");
    assert_eq!((set.counts.distinct, set.counts.real), (1, Some(1)));
    let set = solve("sqrt(x - 4) = y; x = 1");
    assert_eq!((set.counts.distinct, set.counts.real), (1, Some(0)));
    assert_eq!(set.counts.removed["false branch"], 1);
}

/// An exact count counts the points of false branches, too.
#[test]
fn exact_counts_are_compared_before_false_branches_are_removed() {
    let set = solve("sqrt(x) + sqrt(y) = -5; x - y = 5");
    let exact = set.counts.exact_count.as_ref().expect("a count");
    let removed = set.counts.removed["false branch"];
    assert!(set.settled() && removed > 0, "{:?}", set.warnings);
    assert_eq!(exact.distinct, Some(set.counts.distinct + removed));
}

/// A system with two unknowns, roots and angles, and the values that it was made from.
struct Planted {
    equations: String,
    angles: Vec<&'static str>,
    solution: Vec<f64>,
}

/// Equations of random terms whose constants are made so that they hold at random values.
#[expect(
    clippy::disallowed_methods,
    reason = "functions of doubles make and check the systems of a test; no result is made of them"
)]
fn planted(seed: u64) -> Planted {
    let mut random = RandomStream::new(seed, Purpose::Probe, 0);
    let mut number = |least: i64, most: i64| least + random.below((most - least) as u64 + 1) as i64;
    let (x, y) = (number(1, 40), number(1, 40));
    let a = number(-31, 31) as f64 / 10.0;
    let b = number(-31, 31) as f64 / 10.0;
    let (xf, yf) = (x as f64, y as f64);
    let terms = |choice: i64| match choice {
        0 => ("sqrt(x + 2)".to_owned(), (xf + 2.0).sqrt()),
        1 => ("cbrt(x - 50)".to_owned(), (xf - 50.0).cbrt()),
        2 => ("sqrt(y)".to_owned(), yf.sqrt()),
        4 => ("sin(a)".to_owned(), a.sin()),
        5 => ("cos(2*a)".to_owned(), (2.0 * a).cos()),
        6 => ("sin(a + b)".to_owned(), (a + b).sin()),
        _ => ("cos(b)".to_owned(), b.cos()),
    };
    let kind = number(0, 2);
    let (choices, names, angles, solution): ([[i64; 2]; 2], _, Vec<&str>, Vec<f64>) = match kind {
        0 => {
            let pick = [[number(0, 1), 2], [2, number(0, 1)]];
            (pick, "x, y", vec![], vec![xf, yf])
        }
        1 => {
            let pick = [[number(4, 5), 7], [6, number(4, 5)]];
            (pick, "a, b", vec!["a", "b"], vec![a, b])
        }
        _ => {
            let pick = [[number(0, 1), 4], [number(0, 1), 5]];
            (pick, "x, a", vec!["a"], vec![xf, a])
        }
    };
    let mut equations = format!("unknowns: {names}\n");
    for [first, second] in choices {
        let (p, q) = (number(1, 9), number(-9, 9) * 2 + 1);
        let ((first, u), (second, v)) = (terms(first), terms(second));
        let value = p as f64 * u + q as f64 * v;
        equations.push_str(&format!("{p}*{first} + {q}*{second} = {value:?}\n"));
    }
    Planted {
        equations,
        angles,
        solution,
    }
}

fn check_planted(seeds: std::ops::Range<u64>) {
    for seed in seeds {
        let planted = planted(seed);
        let set = solve(&planted.equations);
        let text = &planted.equations;
        let is_planted = |solution: &&cognate_solutions::solution::Solution| {
            let values = solution.variables.0.iter().zip(&planted.solution);
            values.into_iter().all(|(variable, &value)| {
                let is_angle = planted.angles.contains(&variable.name.as_str());
                // The constants of the equations are rounded to doubles, too.
                let bound = 1e-12 * (1.0 + solution.condition) * (1.0 + value.abs());
                difference(is_angle, variable.value, Complex64::new(value, 0.0)) < bound
            })
        };
        let count = set.solutions.iter().filter(is_planted).count();
        assert_eq!(
            count, 1,
            "{text}: {:?} in {:?}",
            planted.solution, set.solutions
        );
        for solution in &set.solutions {
            let residual = residual(text, solution);
            assert!(residual < 1e-9, "{text}: {residual:e} at {solution:?}");
        }
    }
}

/// How far the typed equations are from holding at a solution, by the functions of doubles.
#[expect(
    clippy::disallowed_methods,
    reason = "functions of doubles make and check the systems of a test; no result is made of them"
)]
fn residual(equations: &str, solution: &cognate_solutions::solution::Solution) -> f64 {
    let value = |name: &str| {
        let variables = solution.variables.0.iter();
        let mut named = variables.filter(|variable| variable.name == name);
        named
            .next()
            .map_or(Complex64::default(), |variable| variable.value)
    };
    let (x, y, a, b) = (value("x"), value("y"), value("a"), value("b"));
    let cube_root = |z: Complex64| match z.im.abs() < 1e-9 * z.norm_sqr().sqrt() {
        true => Complex64::new(z.re.cbrt(), 0.0),
        false => z.powf(1.0 / 3.0),
    };
    let term = |text: &str| match text {
        "sqrt(x + 2)" => (x + 2.0).sqrt(),
        "cbrt(x - 50)" => cube_root(x - 50.0),
        "sqrt(y)" => y.sqrt(),
        "sin(a)" => a.sin(),
        "cos(2*a)" => (a * 2.0).cos(),
        "sin(a + b)" => (a + b).sin(),
        "cos(b)" => b.cos(),
        other => unreachable!("{other}"),
    };
    let lines = equations.lines().skip(1).map(|line| {
        let (left, right) = line.split_once(" = ").expect("an equation");
        let parts = left.split(" + ");
        let joined: Vec<String> = parts.fold(Vec::new(), |mut joined: Vec<String>, part| {
            match joined
                .last_mut()
                .filter(|last| last.matches('(').count() > last.matches(')').count())
            {
                Some(last) => last.push_str(&format!(" + {part}")),
                None => joined.push(part.to_owned()),
            }
            joined
        });
        let sum: Complex64 = joined
            .iter()
            .map(|product| {
                let (factor, function) = product.split_once('*').expect("a product");
                term(function) * factor.parse::<f64>().expect("a number")
            })
            .sum();
        let scale = 1.0 + sum.norm_sqr().sqrt();
        (sum - right.parse::<f64>().expect("a number"))
            .norm_sqr()
            .sqrt()
            / scale
    });
    lines.fold(0.0, f64::max)
}

#[test]
fn systems_made_from_known_solutions_have_them_and_no_false_branch() {
    check_planted(0..20);
}

#[test]
#[ignore = "a measurement"]
fn two_hundred_systems_made_from_known_solutions() {
    check_planted(0..200);
}
