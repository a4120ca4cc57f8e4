//! Decompositions that are carried from general values of parameters to others: nothing else is found than without, and
//! what splits, joins, or leaves is said.

use cognate_algorithms::decomposition::{
    DecompositionOptions, DecompositionSolve, ProblemError, run_locally,
};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::witness::{CarriedComponent, Decomposition, KnownComponents};
use cognate_systems::system::System;
use cognate_tests::systems::written;
use num_complex::Complex64;

/// A family, values of its parameters, and the fate of the components there: how many split, how many join, how many
/// points go to infinity, how many to higher sets; `None`: all are found anew.
type Case = (&'static str, &'static str, &'static [f64], Option<[u64; 4]>);

const CASES: [Case; 12] = [
    // A conic becomes two lines.
    ("x, y", "x*y - a", &[0.0], Some([1, 0, 0, 0])),
    ("x, y", "x*y - a", &[3.0], Some([0, 0, 0, 0])),
    // Two conics become a double one.
    ("x, y", "(x^2 + y^2 - 1)^2 - a", &[0.0], Some([0, 1, 0, 0])),
    // Two lines become two others; the conic stays.
    (
        "x, y, z",
        "(x^2 - a)*(x - y*z), x - z - 1",
        &[9.0],
        Some([0, 0, 0, 0]),
    ),
    // A conic becomes a line: one of its points goes to infinity.
    ("x, y", "a*x*y + x - 1", &[0.0], Some([0, 0, 1, 0])),
    // Two of three lines come to lie in a plane.
    (
        "x, y, z",
        "x*(y - a), (x - b)*(z - 1)",
        &[2.0, 0.0],
        Some([0, 0, 0, 2]),
    ),
    // A line leaves a plane, and the plane is found by itself.
    (
        "x, y, z",
        "x*(y - a), x*(z - 1)",
        &[-1.5],
        Some([0, 0, 0, 0]),
    ),
    // Points meet.
    ("x, y", "x^2 - a, y - x", &[0.0], Some([0, 1, 0, 0])),
    // An equation vanishes.
    ("x, y", "x*y - 1, a*(x - y)", &[0.0], None),
    // More equations than cut out points.
    (
        "x, y, z",
        "y - a*x^2, z - x*y, a*x*z - y^2, x*(z - x*y)",
        &[2.0],
        None,
    ),
    // An intersection of quadrics becomes a cubic and a line.
    (
        "x, y, z",
        "x*z - y^2 + a*z, y - x^2 + a*(z + 2)",
        &[0.0],
        Some([1, 0, 0, 0]),
    ),
    // Values of another size.
    ("x, y", "x^2 + a*y^2 - b", &[1e4, 1e-3], Some([0, 0, 0, 0])),
];

fn family(variables: &str, equations: &str, count: usize) -> System {
    let equations: Vec<&str> = equations.split(", ").collect();
    let names: Vec<String> = (1..=equations.len()).map(|k| format!("f{k}")).collect();
    let pairs = names.iter().zip(&equations);
    let lines: Vec<String> = pairs.map(|(name, f)| format!("{name} = {f};")).collect();
    written(&format!(
        "variable_group {variables}; parameter {}; function {}; {}",
        ["a", "b"][..count].join(", "),
        names.join(", "),
        lines.join(" ")
    ))
}

fn decomposed(system: &System, options: &DecompositionOptions) -> Decomposition {
    run_locally(DecompositionSolve::new(system, options).unwrap(), 8).unwrap()
}

/// Dimension, degree and multiplicity of each component.
fn listed(decomposition: &Decomposition) -> Vec<(u32, u64, Option<u64>)> {
    let each = decomposition.components.iter();
    each.map(|set| (set.dimension(), set.degree, set.multiplicity.scheme))
        .collect()
}

/// Options with the components at general values.
fn carrying(system: &System, values: &[f64], seed: u64) -> DecompositionOptions {
    let mut random = RandomStream::new(seed, Purpose::Test, 30);
    let general: Vec<Complex64> = values.iter().map(|_| random.unit()).collect();
    let at = DecompositionOptions {
        seed,
        parameters: general.clone(),
        ..DecompositionOptions::default()
    };
    let general_decomposition = decomposed(system, &at);
    assert!(
        general_decomposition.settled(),
        "{general_decomposition:#?}"
    );
    DecompositionOptions {
        parameters: values.iter().map(|&x| Complex64::new(x, 0.0)).collect(),
        known: Some(KnownComponents {
            equations: system.equations.len() as u32,
            components: general_decomposition.components,
            parameters: general,
        }),
        ..at
    }
}

#[test]
fn nothing_else_is_found_than_without() {
    for (variables, equations, values, expected) in CASES {
        let system = family(variables, equations, values.len());
        for seed in 1..=3 {
            let options = carrying(&system, values, seed);
            let carried_decomposition = decomposed(&system, &options);
            let anew = DecompositionOptions {
                known: None,
                ..options
            };
            let direct = decomposed(&system, &anew);
            let what = format!("{equations} at {values:?}, seed {seed}");
            assert!(
                carried_decomposition.settled() && direct.settled(),
                "{what}: {carried_decomposition:#?}"
            );
            assert_eq!(listed(&carried_decomposition), listed(&direct), "{what}");
            let family = carried_decomposition.family.expect("it was carried");
            let counts = family.dimension.map(|_| {
                let sum = |count: &dyn Fn(&CarriedComponent) -> u64| {
                    family.components.iter().map(count).sum::<u64>()
                };
                let (split, joined) = (family.split().count(), family.joined().len());
                let (infinite, elsewhere) = (sum(&|c| c.at_infinity), sum(&|c| c.elsewhere));
                [split as u64, joined as u64, infinite, elsewhere]
            });
            assert_eq!(counts, expected, "{what}: {}", family.reason);
            assert_eq!(family.reason.is_empty(), expected.is_some());
        }
    }
}

/// Without a point of the cubic nothing is closed, and all is found anew; the line is missing without its only point, as
/// `KnownComponents` says.
#[test]
fn a_lost_witness_point_is_found_unless_it_is_all_of_a_component() {
    let system = family("x, y, z", "x*z - y^2 + a*z, y - x^2 + a*(z + 2)", 1);
    let whole = carrying(&system, &[0.0], 4);
    let mut anew = 0;
    for place in 0..4 {
        let mut options = whole.clone();
        let known_components = options.known.as_mut().unwrap();
        known_components.components[0].points.remove(place);
        known_components.components[0].degree -= 1;
        let decomposition = decomposed(&system, &options);
        assert!(decomposition.settled(), "{decomposition:#?}");
        match listed(&decomposition).as_slice() {
            [(1, 3, Some(1)), (1, 1, Some(1))] => anew += 1,
            [(1, 3, Some(1))] => {}
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(anew, 3);
}

#[test]
fn points_of_another_member_are_refused() {
    let system = family("x, y", "x^2 + a*y^2 - b", 2);
    let mut options = carrying(&system, &[1.0, 2.0], 5);
    let known_components = options.known.as_mut().unwrap();
    known_components.parameters[0] += 0.5;
    let refused = DecompositionSolve::new(&system, &options);
    assert!(
        matches!(refused, Err(ProblemError::Known(_))),
        "{refused:?}"
    );
    let known_components = options.known.as_mut().unwrap();
    known_components.parameters.pop();
    let refused = DecompositionSolve::new(&system, &options);
    assert!(
        matches!(refused, Err(ProblemError::Parameters(_))),
        "{refused:?}"
    );
}
