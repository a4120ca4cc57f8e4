//! Straight-line programs from the user: subfunctions are shared nodes, and nothing multiplies them out.
//!
//! The determinant of a 7x7 matrix of linear forms in 21 variables has 1,184,040 terms and, by its minors,
//! 448 products. The solutions are compared with an elimination of the matrix, which knows no minors.

use crate::check::{Answer, complaints, seeds_of_slow_answers, solve};
use crate::parameter_homotopies::solve_from;
use cognate_algorithms::plan::KnownSolutions;
use cognate_algorithms::plan::SolveMethod;
use cognate_algorithms::start_costs::{StartCosts, StartKind};
use cognate_algorithms::{SolveOptions, plan};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::expression::NodeId;
use cognate_systems::polynomial::{Polynomial, supports};
use cognate_systems::system::System;
use cognate_tests::systems::written;
use num_complex::Complex64;
use std::fmt::Write;

/// Rows and columns of the matrix.
const SIZE: usize = 7;

/// Tenths, made up once for all: of entry (i, j) those of the variables, and the constant.
fn tenths(form: usize, variables: usize) -> Vec<i64> {
    let at = |k: usize| {
        let mut mixed = (64 * form + k + 1) as u64;
        for factor in [0x9e37_79b9_7f4a_7c15, 0xbf58_476d_1ce4_e5b9] {
            mixed = mixed.wrapping_mul(factor);
            mixed ^= mixed >> 29;
        }
        (mixed % 19) as i64
    };
    (0..=variables)
        .map(|k| at(k) - 9)
        .map(|tenth| if tenth == 0 { 10 } else { tenth })
        .collect()
}

fn linear(form: usize, variables: usize) -> String {
    let tenths = tenths(form, variables);
    let mut text = format!("{}/10", tenths[variables]);
    for (k, tenth) in tenths[..variables].iter().enumerate() {
        let _ = write!(text, " + ({tenth})/10*x{k}");
    }
    text
}

/// `declarations`, the determinant as the subfunction `determinant`, by minors of its first rows, and
/// linear equations g1, g2, ... for all variables but one.
fn determinantal(variables: usize, declarations: &str, f: &str) -> String {
    let names = |letter: &str, range: std::ops::Range<usize>| -> String {
        let variable_names: Vec<String> = range.map(|k| format!("{letter}{k}")).collect();
        variable_names.join(", ")
    };
    let mut text = format!(
        "variable_group {};\n{declarations}\nfunction f, {};\n",
        names("x", 0..variables),
        names("g", 1..variables)
    );
    for form in 0..SIZE * SIZE {
        let _ = writeln!(text, "a{form} = {};", linear(form, variables));
    }
    for columns in 1u32..1 << SIZE {
        let row = columns.count_ones() as usize - 1;
        let _ = write!(text, "m{columns} = 0");
        let minor_columns = (0..SIZE).filter(|c| columns >> c & 1 == 1);
        for (sign, column) in (row..).zip(minor_columns) {
            let rest = columns & !(1 << column);
            let entry = SIZE * row + column;
            let sum = if sign.is_multiple_of(2) { "+" } else { "-" };
            match rest {
                0 => write!(text, " {sum} a{entry}"),
                _ => write!(text, " {sum} a{entry}*m{rest}"),
            }
            .expect("a string takes all");
        }
        text.push_str(";\n");
    }
    let _ = writeln!(text, "determinant = m{};\nf = {f};", (1 << SIZE) - 1);
    for k in 1..variables {
        let _ = writeln!(text, "g{k} = {};", linear(SIZE * SIZE + k, variables));
    }
    text
}

fn values(set: &SolutionSet) -> Vec<Vec<Complex64>> {
    let solutions = set.solutions.iter();
    solutions
        .map(|s| s.variables.0.iter().map(|named| named.value).collect())
        .collect()
}

/// The determinant by elimination, and the product of the largest entries of all rows.
fn by_elimination(point: &[Complex64]) -> (Complex64, f64) {
    let size = |z: &Complex64| z.norm_sqr().sqrt();
    let form = |form: usize| -> Complex64 {
        let tenths = tenths(form, point.len());
        let constant = Complex64::new(tenths[point.len()] as f64 / 10.0, 0.0);
        let terms = point.iter().zip(&tenths);
        terms.fold(constant, |sum, (x, &c)| sum + x * (c as f64 / 10.0))
    };
    let mut rows: Vec<Vec<Complex64>> = (0..SIZE)
        .map(|i| (0..SIZE).map(|j| form(SIZE * i + j)).collect())
        .collect();
    let scale = rows
        .iter()
        .map(|row| row.iter().map(size).fold(0.0, f64::max))
        .product();
    let mut determinant = Complex64::new(1.0, 0.0);
    for k in 0..SIZE {
        let pivot = (k..SIZE)
            .max_by(|&i, &j| size(&rows[i][k]).total_cmp(&size(&rows[j][k])))
            .expect("there is a row");
        if pivot != k {
            rows.swap(pivot, k);
            determinant = -determinant;
        }
        determinant *= rows[k][k];
        for i in k + 1..SIZE {
            let factor = rows[i][k] / rows[k][k];
            for j in k..SIZE {
                let change = factor * rows[k][j];
                rows[i][j] -= change;
            }
        }
    }
    (determinant, scale)
}

fn all_seven() -> Answer {
    Answer {
        paths: 7,
        nonsingular: 7,
        ..Answer::default()
    }
}

#[test]
fn a_determinant_of_a_million_terms_is_solved_without_them() {
    let variables = 21;
    let text = determinantal(variables, "", "determinant");
    let system = written(&text);
    assert_eq!(supports(&system), None, "it is not multiplied out");
    let costs = StartCosts::of(&system).expect("its degrees are found");
    assert_eq!((costs.degrees[0], costs.total_degree), (7, Some(7)));
    assert_eq!((costs.mixed_volume, costs.linear_product), (None, None));
    assert_eq!(costs.choice, Some(StartKind::TotalDegree));
    let why = costs.notes.values().any(|note| {
        note.contains("equation f, of degree 7 in 21 variables, may have up to 1184040 terms")
    });
    assert!(why, "{:?}", costs.notes);
    let polyhedral = SolveOptions {
        method: SolveMethod::Polyhedral,
        ..SolveOptions::default()
    };
    let refused = plan(&system, &polyhedral).expect_err("its monomials are not known");
    assert!(refused.to_string().contains("1184040 terms"), "{refused}");

    let (_, sets) = solve(&system, &SolveOptions::default(), &|_| None);
    let answer = Answer {
        real: Some(sets[0].counts.real),
        ..all_seven()
    };
    let wrong = complaints(&sets[0], &answer);
    assert!(wrong.is_empty(), "{wrong}");
    let solutions = values(&sets[0]);
    for point in &solutions {
        let (determinant, scale) = by_elimination(point);
        assert!(
            determinant.norm_sqr().sqrt() < 1e-11 * scale,
            "{determinant} of {scale}"
        );
    }

    // From there to another level of the determinant, by a parameter.
    let level = Complex64::new(0.5, -0.25);
    let family = written(&determinantal(variables, "parameter p;", "determinant - p"));
    let options = SolveOptions {
        method: SolveMethod::Given(KnownSolutions {
            points: None,
            parameters: Some(vec![Complex64::default()]),
        }),
        target_parameters: vec![vec![level]],
        ..SolveOptions::default()
    };
    let starts: Vec<Complex64> = solutions.iter().flatten().copied().collect();
    let sets = solve_from(&family, starts.clone(), options);
    let there = values(&sets[0]);
    assert_eq!(there.len(), 7, "{:?}", sets[0].paths);
    for point in &there {
        let (determinant, scale) = by_elimination(point);
        assert!(
            (determinant - level).norm_sqr().sqrt() < 1e-11 * scale,
            "{determinant}"
        );
    }

    // A homotopy of the user's own that follows the way above, with a detour.
    let declarations = "pathvariable t;\nparameter s;";
    let f = "determinant - s";
    let user_homotopy = determinantal(variables, declarations, f).replace(
        "f = determinant",
        "s = (1 - t)*(1/2 - I/4 + t*(1 + I)/3);\nf = determinant",
    );
    let sets = solve_from(&written(&user_homotopy), starts, SolveOptions::default());
    let mut by_own = values(&sets[0]);
    for point in &there {
        let near = |other: &Vec<Complex64>| {
            let pairs = point.iter().zip(other);
            pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>() < 1e-16
        };
        let place = by_own.iter().position(near).expect("both ways lead there");
        by_own.swap_remove(place);
    }
    assert!(by_own.is_empty());
}

/// The lines that cut the determinant's hypersurface move: from one point that is found as they are to all.
#[test]
fn a_determinantal_family_is_found_by_loops() {
    let variables = 21;
    let names: Vec<String> = (1..variables).map(|k| format!("p{k}, q{k}")).collect();
    let parameters = format!("parameter {}, r;", names.join(", "));
    let mut text = determinantal(variables, &parameters, "determinant - r");
    for k in 1..variables {
        let head = format!("\ng{k} = ");
        text = text.replace(&head, &format!("{head}-p{k} - q{k}*x0 + "));
    }
    let system = written(&text);
    let options = SolveOptions {
        method: SolveMethod::MONODROMY,
        ..SolveOptions::default()
    };
    let (_, sets) = solve(&system, &options, &|_| None);
    assert_eq!(sets[0].counts.nonsingular, 7, "{:?}", sets[0].warnings);
}

/// Where only the constants of the lines move, the determinant's own level is by far the largest
/// parameter: loops that kept it so found six of the seven solutions for five of six seeds.
#[test]
fn a_family_of_constants_is_found_by_loops() {
    let variables = 21;
    let names: Vec<String> = (1..variables).map(|k| format!("p{k}")).collect();
    let parameters = format!("parameter {}, r;", names.join(", "));
    let mut text = determinantal(variables, &parameters, "determinant - r");
    for k in 1..variables {
        let head = format!("\ng{k} = ");
        text = text.replace(&head, &format!("{head}-p{k} + "));
    }
    let system = written(&text);
    for seed in seeds_of_slow_answers() {
        let options = SolveOptions {
            method: SolveMethod::MONODROMY,
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        assert_eq!(
            sets[0].counts.nonsingular, 7,
            "{seed}: {:?}",
            sets[0].warnings
        );
    }
}

/// In two variables the determinant has 36 terms: they and the subfunctions have the same zeros.
#[test]
fn multiplied_out_it_is_the_same_system() {
    let shared = written(&determinantal(2, "", "determinant"));
    let mut plain = System {
        expressions: Default::default(),
        ..shared.clone()
    };
    let (mut equations, mut largest) = (Vec::<NodeId>::new(), 0);
    for &equation in &shared.equations {
        let f = Polynomial::expand(&shared.expressions, equation, 2, 0).expect("it is small");
        largest = largest.max(f.terms.len());
        let out = &mut plain.expressions;
        let mut sum = out.integer(0);
        for (exponents, coefficient) in &f.terms {
            let mut term = out.constant(coefficient.clone());
            for (k, &exponent) in exponents.iter().enumerate() {
                let x = out.variable(k as u32);
                let power = out.power(x, exponent);
                term = out.multiply(term, power);
            }
            sum = out.add(sum, term);
        }
        equations.push(sum);
    }
    assert_eq!(largest, 36);
    plain.equations = equations;
    let [mut shared, plain] = [shared, plain].map(|system| {
        let (_, sets) = solve(&system, &SolveOptions::default(), &|_| None);
        assert_eq!(sets[0].counts.nonsingular, 7, "{:?}", sets[0].paths);
        values(&sets[0])
    });
    for point in &plain {
        let near = |other: &Vec<Complex64>| {
            let pairs = point.iter().zip(other);
            let scale: f64 = point.iter().map(|z| z.norm_sqr()).sum();
            pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>() < 1e-16 * scale
        };
        let place = shared
            .iter()
            .position(near)
            .expect("it is among the others");
        shared.swap_remove(place);
    }
    assert!(shared.is_empty());
}
