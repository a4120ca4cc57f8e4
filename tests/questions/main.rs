//! Questions to components against known answers, several seeds each: members, images, degrees by groups, real curves.
//!
//! `SEEDS=30 cargo test -p cognate-tests --test questions` takes more seeds than the three of every run.

use cognate_algorithms::decomposition::{self, DecompositionOptions, DecompositionSolve};
use cognate_algorithms::questions::{QuestionSolve, run_locally};
use cognate_solutions::witness::question::GivenPoint;
use cognate_solutions::witness::{Answer, Decomposition, Question};
use cognate_systems::system::System;
use cognate_tests::systems::{shared, written};
use num_complex::Complex64;
use std::time::Instant;

/// The system in `tests/decomposition/systems/NAME`, or among those that other tests solve.
fn instance(name: &str) -> System {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("decomposition/systems");
    match std::fs::read(folder.join(name).join("system.bertini")) {
        Ok(content) => match cognate_systems::formats::read(name, &content) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        },
        Err(_) => shared(name),
    }
}

fn seeds() -> std::ops::RangeInclusive<u64> {
    let seeds = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok());
    1..=seeds.unwrap_or(3)
}

fn options(seed: u64) -> DecompositionOptions {
    DecompositionOptions {
        seed,
        ..DecompositionOptions::default()
    }
}

fn components(name: &str, system: &System, seed: u64) -> Decomposition {
    let solve = match DecompositionSolve::new(system, &options(seed)) {
        Ok(solve) => solve,
        Err(error) => panic!("{name}: {error}"),
    };
    match decomposition::run_locally(solve, 8) {
        Ok(found) => found,
        Err(error) => panic!("{name}: {error}"),
    }
}

/// The answer, where nothing in it is in doubt.
fn ask(name: &str, system: &System, seed: u64, question: &Question) -> Answer {
    let found = components(name, system, seed);
    let began = Instant::now();
    let solve = QuestionSolve::new(system, &options(seed), &found.components, question);
    let solve = match solve {
        Ok(solve) => solve,
        Err(error) => panic!("{name}, seed {seed}: {error}"),
    };
    let (answer, doubts) = match run_locally(solve, 8) {
        Ok(found) => found,
        Err(error) => panic!("{name}, seed {seed}: {error}"),
    };
    let seconds = began.elapsed().as_secs_f64();
    eprintln!("{name}, {}, seed {seed}: {seconds:.2} s", answer.name());
    assert!(doubts.is_empty(), "{name}, seed {seed}: {doubts:?}");
    answer
}

#[test]
fn members_of_nid_illustrative() {
    let system = instance("nid_illustrative");
    let expected: [([f64; 3], &[u32]); 6] = [
        ([0.6, 0.8, 0.0], &[2]),
        ([2.0, 4.0, 8.0], &[1]),
        ([0.5, 0.25, 0.125], &[1, 1]),
        ([0.5, 7.0, 0.125], &[1]),
        ([0.5, 0.5, 0.5], &[0]),
        ([1.0, 1.0, 2.0], &[]),
    ];
    let given = |(values, _): &([f64; 3], &[u32])| GivenPoint {
        values: values.iter().map(|&x| Complex64::new(x, 0.0)).collect(),
        accuracy: f64::EPSILON,
    };
    let points: Vec<GivenPoint> = expected.iter().map(given).collect();
    for seed in seeds() {
        let points = points.clone();
        let answer = ask(
            "nid_illustrative",
            &system,
            seed,
            &Question::Member { points },
        );
        let Answer::Member(found) = answer else {
            panic!("{answer:?}");
        };
        for ((point, dimensions), membership) in expected.iter().zip(found) {
            let on: Vec<u32> = membership.on.iter().map(|id| id.dimension).collect();
            assert_eq!(&on, dimensions, "seed {seed}, {point:?}");
        }
    }
}

/// Every point that was sampled is a member, and the same point moved away is none.
#[test]
fn samples_are_members() {
    let name = "bennett_b";
    let system = instance(name);
    for seed in seeds() {
        let wish = cognate_solutions::witness::question::SampleWish {
            count: 50,
            ..Default::default()
        };
        let answer = ask(name, &system, seed, &Question::Sample(wish));
        let Answer::Sample(found) = answer else {
            panic!("{answer:?}");
        };
        assert_eq!(found[0].points.len(), 50);
        let mut points: Vec<GivenPoint> = Vec::new();
        for values in &found[0].points {
            let mut moved = values.clone();
            moved[0] += 1e-3;
            for values in [values.clone(), moved] {
                let accuracy = 1e-12;
                points.push(GivenPoint { values, accuracy });
            }
        }
        let answer = ask(name, &system, seed, &Question::Member { points });
        let Answer::Member(found) = answer else {
            panic!("{answer:?}");
        };
        for (k, membership) in found.iter().enumerate() {
            assert_eq!(
                membership.on.len(),
                1 - k % 2,
                "seed {seed}: {membership:?}"
            );
        }
    }
}

#[test]
fn projections_of_the_twisted_cubic() {
    let system = instance("twisted_cubic");
    for seed in seeds() {
        for (onto, degree) in [([0, 1], 2), ([1, 2], 3), ([0, 2], 3)] {
            let onto = onto.to_vec();
            let answer = ask("twisted_cubic", &system, seed, &Question::Project { onto });
            let Answer::Project(images) = answer else {
                panic!("{answer:?}");
            };
            let [image] = images.as_slice() else {
                panic!("{images:?}");
            };
            let numbers = (image.dimension, image.degree, image.fiber_degree);
            assert_eq!(numbers, (Some(1), Some(degree), Some(1)), "seed {seed}");
        }
    }
}

#[test]
fn multidegree_of_conic_p1p2() {
    let system = instance("conic_p1p2");
    for seed in seeds() {
        let answer = ask("conic_p1p2", &system, seed, &Question::Multidegree);
        let Answer::Multidegree { components, .. } = answer else {
            panic!("{answer:?}");
        };
        let degrees = components[0].degrees.iter();
        let degrees: Vec<_> = degrees.map(|d| (d.slices.clone(), d.degree)).collect();
        assert_eq!(degrees, [(vec![1, 0], Some(1)), (vec![0, 1], Some(2))]);
    }
}

/// Closed loops, unbounded arcs, isolated points, singular points, connected components.
fn check_real(name: &str, system: &System, expected: [u64; 5]) {
    for seed in seeds() {
        let answer = ask(name, system, seed, &Question::RealCurve { samples: 2 });
        let Answer::RealCurve(curves) = answer else {
            panic!("{answer:?}");
        };
        let mut sum = [0; 5];
        for counts in curves.iter().map(|curve| curve.counts()) {
            sum[0] += counts.closed_loops;
            sum[1] += counts.unbounded_arcs;
            sum[2] += counts.isolated_points;
            sum[3] += counts.singular_points;
            sum[4] += counts.connected_components;
        }
        assert_eq!(sum, expected, "{name}, seed {seed}");
    }
}

macro_rules! real_curves {
    ($($name:ident: $expected:expr;)*) => {$(
        #[test]
        fn $name() {
            check_real(stringify!($name), &instance(stringify!($name)), $expected);
        }
    )*};
}

real_curves! {
    four_bar_loop_grashof: [2, 0, 0, 0, 2];
    real_acnode: [0, 1, 1, 1, 2];
    real_cubic: [1, 1, 0, 0, 2];
    quadrifolium: [0, 0, 0, 1, 1];
    viviani: [0, 0, 0, 1, 1];
}

/// A circle in isotropic coordinates is real where they are conjugates.
#[test]
fn a_circle_in_isotropic_coordinates() {
    let system = written("variable_group p, P; function f; f = p*P - 1;");
    let system = cognate_tests::systems::with_conjugates(system, "p~P");
    check_real("circle", &system, [1, 0, 0, 0, 1]);
}
