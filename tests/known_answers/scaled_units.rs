//! A change of units changes nothing: systems with exact answers in units far from 1, and known
//! systems in random units.

use crate::check::solve;
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::ClosingOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::expression::{Imported, Node};
use cognate_systems::named;
use cognate_systems::scaling::{Scaling, exact_times, times_power_of_two};
use cognate_systems::system::System;
use cognate_tests::systems::written;
use num_complex::Complex64;

fn options(seed: u64, start: SolveMethod) -> SolveOptions {
    SolveOptions {
        method: start,
        seed,
        ..SolveOptions::default()
    }
}

fn values(set: &SolutionSet) -> Vec<Vec<Complex64>> {
    let each = set.solutions.iter();
    each.map(|solution| solution.variables.values().collect())
        .collect()
}

/// Solves with several seeds; every solution is simple and real, and the values of the first
/// variable are these, to twelve digits.
fn first_values(text: &str, expected: &[f64]) {
    let system = written(text);
    for seed in 1..=5 {
        let (_, sets) = solve(&system, &options(seed, SolveMethod::Auto), &|_| None);
        let set = &sets[0];
        let mut first_coordinates: Vec<f64> = values(set).iter().map(|point| point[0].re).collect();
        first_coordinates.sort_by(f64::total_cmp);
        let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-12 * b.abs();
        assert!(
            first_coordinates.len() == expected.len()
                && first_coordinates.iter().zip(expected).all(close),
            "{text}, seed {seed}: {first_coordinates:?}, {:?}",
            set.paths
        );
        let counts = (set.counts.nonsingular, set.counts.singular, set.counts.real);
        let number = expected.len() as u64;
        assert_eq!(counts, (number, 0, Some(number)), "{text}, seed {seed}");
    }
}

#[test]
fn numbers_far_from_1_are_no_infinity_and_no_zero() {
    let x = "variable_group x; function f;";
    first_values(
        &format!("{x} f = x + 2^100;"),
        &[-times_power_of_two(1.0, 100)],
    );
    first_values(&format!("{x} f = x^2 - 1e-20;"), &[-1e-10, 1e-10]);
    first_values(&format!("{x} f = x^2 - 1e300;"), &[-1e150, 1e150]);
    let xy = "variable_group x, y; function f, g;";
    let [a, b] = [1e8; 2];
    first_values(
        &format!("{xy} f = x^2 - 1e16; g = y^2 - 3;"),
        &[-a, -b, a, b],
    );
}

/// f and g have one solution with x near 3 and one with x near the constant: y is 2 - 5 / x.
#[test]
fn a_solution_as_far_out_as_a_coefficient_is_none_at_infinity() {
    for exponent in [13, 17, 22, 25, 40, 100] {
        let system = written(&format!(
            "variable_group x, y; function f, g; \
             f = (x - 3)*(x - 10^{exponent}) + y*x; g = x*y - 2*x + 5;"
        ));
        for seed in 1..=3 {
            let (_, sets) = solve(&system, &options(seed, SolveMethod::Auto), &|_| None);
            let set = &sets[0];
            let counts = (set.counts.nonsingular, set.counts.singular, set.counts.real);
            let what = format!("{exponent}, seed {seed}: {:?}", set.paths);
            assert_eq!(counts, (2, 0, Some(2)), "{what}");
            let far = values(set)
                .iter()
                .any(|point| (point[1].re - 2.0).abs() < 1e-9);
            assert!(far, "{what}");
        }
    }
}

/// Planted (kind "monomial map"): x y^3 has two values, y three; with this start turns take the solution near
/// (1/3 10^6, 2), 10^15 out in the units of its system, for one at infinity. It is found, or missed with doubt.
#[test]
fn a_solution_that_turns_take_for_infinite_is_not_lost_in_silence() {
    let system = written(
        "variable_group x, y; function f, g; \
         f = x^2*y^6 - 4000000000003/1500000*x*y^3 + 16/3; \
         g = y^3 - 8*y^2 + 2500000021*y - 5000000018;",
    );
    for seed in [496_851_144, 2, 1, 4] {
        let solve_options = options(seed, SolveMethod::LINEAR_PRODUCT);
        let (_, sets) = solve(&system, &solve_options, &|_| None);
        let set = &sets[0];
        let counts = (set.counts.nonsingular, set.counts.real);
        let is_right = counts == (6, Some(2));
        assert!(is_right || !set.settled(), "seed {seed}: {:?}", set.paths);
    }
}

/// x^2 + y^2 = 5 and x y = 2 have (1, 2), (2, 1) and their negatives.
/// x = -3/5 + 10^-12 and -3/5 + 10^-10, about, beside the pole -3/5 of y: three sheets meet far out, and coefficients
/// have 24 digits, where doubles show infinity to ten. Both solutions are found, or missed with doubt (planted, 335 of
/// seed 9).
#[test]
fn several_solutions_far_out_are_not_lost_in_silence() {
    let text = "variable_group x, y; function f1, f2;
        f1 = x^3 + 899999999949/500000000000*x^2
            + 1079999999877600000000101/1000000000000000000000000*x
            + 1079999999816400000000303/5000000000000000000000000;
        f2 = x*y - 8*x + 3/5*y - 524/5;";
    for seed in [1, 2, 3, 1_508_884_010] {
        let options = options(seed, SolveMethod::Auto);
        let (_, sets) = solve(&written(text), &options, &|_| None);
        let both_solutions = sets[0].counts.distinct == 2;
        assert!(both_solutions || !sets[0].settled(), "seed {seed}");
    }
}

#[test]
fn a_circle_and_a_hyperbola_meet_in_any_units() {
    for exponent in [-150, -40, -8, -7, 7, 8, 40, 150] {
        let text = format!(
            "variable_group x, y; function f, g; f = x^2 + y^2 - 5e{}; g = x*y - 2e{};",
            2 * exponent,
            2 * exponent
        );
        let unit: f64 = format!("1e{exponent}").parse().unwrap();
        first_values(&text, &[-2.0, -1.0, 1.0, 2.0].map(|x| x * unit));
    }
}

/// Coefficients of 401 digits, in ordinary units.
#[test]
fn coefficients_of_hundreds_of_digits_are_numbers() {
    let text = "variable_group x, y; function f, g; f = 1e400*x^2 - 4e400; g = 3e-390*(x - y);";
    first_values(text, &[-2.0, 2.0]);
}

/// The system in other units: variable i of the old one is 2^(units[i]) times variable i of the new
/// one, and equation i is multiplied by 2^(factors[i]); as a file would have it.
fn in_other_units(system: &System, units: &[i32], factors: &[i32]) -> System {
    let mut out = cognate_systems::expression::Expressions::new();
    let mut memory = Imported::default();
    let one = cognate_numeric::rational::ComplexRational::real(1);
    let mut equations = Vec::new();
    for (&equation, &factor) in system.equations.iter().zip(factors) {
        let leaf = &mut |to: &mut cognate_systems::expression::Expressions, leaf: &Node| match leaf
        {
            Node::Variable(v) => {
                let unit = to.constant(exact_times(&one, i64::from(units[*v as usize])));
                let variable = to.variable(*v);
                to.multiply(unit, variable)
            }
            other => to.insert(other.clone()),
        };
        let node = out.import(&system.expressions, equation, &mut memory, leaf);
        let factor = out.constant(exact_times(&one, i64::from(factor)));
        equations.push(out.multiply(factor, node));
    }
    System {
        expressions: out,
        equations,
        degenerate: Default::default(),
        symmetry: Vec::new(),
        ..system.clone()
    }
}

/// The system has the same counts in random units, and its solutions are the same points.
#[track_caller]
fn same_in_other_units(name: &str, system: &System, start: SolveMethod, rounds: u64) {
    let (_, plain) = solve(system, &options(1, start.clone()), &|_| None);
    let plain = &plain[0];
    for round in 0..rounds {
        let mut random = RandomStream::new(round, Purpose::Test, 0);
        let mut exponent = |most: u64| random.below(2 * most + 1) as i32 - most as i32;
        let mut units: Vec<i32> = system.variables.iter().map(|_| exponent(40)).collect();
        // Conjugates are in one unit.
        for &(a, b) in &system.conjugates {
            units[b] = units[a];
        }
        let factors: Vec<i32> = system.equations.iter().map(|_| exponent(200)).collect();
        let other = in_other_units(system, &units, &factors);
        let (_, sets) = solve(&other, &options(round + 1, start.clone()), &|_| None);
        let set = &sets[0];
        let context = format!("{name}, round {round}, units {units:?}: {:?}", set.paths);
        let counts = |set: &SolutionSet| {
            let (paths, counts) = (&set.paths, &set.counts);
            (
                (counts.nonsingular, counts.singular, counts.real),
                (
                    paths.finite,
                    paths.singular,
                    paths.at_infinity,
                    paths.positive_dimensional,
                ),
                paths.failed,
            )
        };
        assert_eq!(counts(plain), counts(set), "{context}");
        let scaling = Scaling { exponents: units };
        let back: Vec<Vec<Complex64>> = values(set)
            .iter()
            .map(|point| scaling.to_variables(point))
            .collect();
        for point in values(plain) {
            let size = point.iter().fold(1.0f64, |m, z| m.max(z.norm_sqr().sqrt()));
            let near = |other: &&Vec<Complex64>| {
                let pairs = point.iter().zip(other.iter());
                pairs.fold(0.0f64, |m, (a, b)| m.max((a - b).norm_sqr().sqrt())) < 1e-5 * size
            };
            assert!(
                back.iter().any(|other| near(&other)),
                "{context}: no {point:?}"
            );
        }
    }
}

#[test]
fn known_systems_are_the_same_in_random_units() {
    for (name, system) in [
        ("katsura-5", named::katsura(5).system),
        ("cyclic-5", named::cyclic(5).system),
        ("noon-3", named::noon(3).system),
        ("eco-6", named::eco(6).system),
        ("caprasse", named::caprasse().system),
        ("reimer-3", named::reimer(3).system),
    ] {
        same_in_other_units(name, &system, SolveMethod::Auto, 4);
    }
}

#[test]
fn every_start_is_the_same_in_random_units() {
    let system = named::katsura(4).system;
    for start in [
        SolveMethod::TotalDegree,
        SolveMethod::Multihomogeneous,
        SolveMethod::LINEAR_PRODUCT,
        SolveMethod::Polyhedral,
        SolveMethod::Regeneration,
    ] {
        same_in_other_units(&format!("katsura-4 by {}", start.name()), &system, start, 2);
    }
}

#[test]
fn more_equations_than_unknowns_are_the_same_in_random_units() {
    let text = "variable_group x, y; function f1, f2, f3; f1 = x^2 + y^2 - 5; f2 = x*y - 2; \
                f3 = x^3 - 3*x*y^2 + 5*y + x - 0 - (x^3 - 3*x*y^2 + 5*y + x)*(x*y - 1);";
    same_in_other_units("three conics", &written(text), SolveMethod::Auto, 3);
}

#[test]
fn homogeneous_groups_are_the_same_in_random_units() {
    // A conic and a cubic of the projective plane: points are compared by their counts.
    let text = "hom_variable_group x, y, z; function f, g; f = x^2 + y^2 - 3*z^2; \
                g = x^3 + 2*y^3 - z^3 + x*y*z;";
    let system = written(text);
    for round in 0..3 {
        let mut random = RandomStream::new(round, Purpose::Test, 1);
        let units: Vec<i32> = (0..3).map(|_| random.below(81) as i32 - 40).collect();
        let other = in_other_units(&system, &units, &[150, -150]);
        let (_, sets) = solve(&other, &options(round, SolveMethod::Auto), &|_| None);
        let counts = (sets[0].counts.nonsingular, sets[0].paths.failed);
        assert_eq!(counts, (6, 0), "round {round}: {:?}", sets[0].paths);
    }
}

/// Certificates are boxes around the points in their own units, and digits are those of the points.
#[test]
fn proofs_and_digits_are_in_the_units_of_the_variables() {
    let system = written("variable_group x, y; function f, g; f = x^2 - 2e-20; g = x*y - 1e30;");
    let with = SolveOptions {
        closings: ClosingOptions {
            certify: true,
            digits: Some(40),
            ..ClosingOptions::default()
        },
        ..options(1, SolveMethod::Auto)
    };
    let (_, sets) = solve(&system, &with, &|_| None);
    let set = &sets[0];
    assert_eq!(
        (set.counts.certified, set.counts.certified_real),
        (Some(2), Some(2))
    );
    for solution in &set.solutions {
        let digits: Vec<String> = solution
            .variables
            .0
            .iter()
            .map(|v| format!("{:?}", v.digits))
            .collect();
        assert!(
            digits[0].contains("1.41421356237309504880168872420969807857"),
            "{digits:?}"
        );
        assert!(
            digits[1].contains("7071067811865475244008443621048490392848"),
            "{digits:?}"
        );
    }
}
