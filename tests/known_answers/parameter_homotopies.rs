//! Given starts: parameter homotopies to many targets, and homotopies of the user's own.

use crate::check::{Answer, SEEDS, complaints, solve};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::GivenStart;
use cognate_algorithms::plan::{KnownSolutions, SolveMethod};
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_systems::system::System;
use cognate_tests::systems::written;
use num_complex::Complex64;
use std::sync::Arc;

fn number(re: f64, im: f64) -> Complex64 {
    Complex64::new(re, im)
}

/// Solves from given points; all are found under one name.
pub fn solve_from(
    system: &System,
    points: Vec<Complex64>,
    options: SolveOptions,
) -> Vec<cognate_solutions::solution_set::SolutionSet> {
    let dimension = system.variables.len();
    let stored = Arc::new(StoredPoints {
        dimension,
        coordinates: points,
    });
    let object = Digest([7; 32]);
    let given = GivenStart {
        object,
        count: stored.len() as u64,
        dimension,
    };
    let options = SolveOptions {
        method: options.method.with_points(given),
        ..options
    };
    let find = move |digest| (digest == object).then(|| stored.clone());
    solve(system, &options, &find).1
}

/// x^2 = p, x y = 1: 2 solutions for every p but 0, real for positive p.
#[test]
fn many_targets_are_solved_from_one_start() {
    let system =
        written("variable_group x, y; parameter p; function f, g; f = x^2 - p; g = x*y - 1;");
    let starts: Vec<Complex64> = [2.0, -2.0]
        .iter()
        .flat_map(|&x| [number(x, 0.0), number(1.0 / x, 0.0)])
        .collect();
    let targets = [
        number(9.0, 0.0),
        number(-1.0, 0.0),
        number(0.0, 2.0),
        number(1e6, 0.0),
    ];
    let real = [Some(2), Some(0), None, Some(2)];
    for seed in SEEDS {
        let options = SolveOptions {
            method: SolveMethod::Given(KnownSolutions {
                points: None,
                parameters: Some(vec![number(4.0, 0.0)]),
            }),
            seed,
            target_parameters: targets.iter().map(|&p| vec![p]).collect(),
            ..SolveOptions::default()
        };
        let sets = solve_from(&system, starts.clone(), options);
        assert_eq!(sets.len(), targets.len());
        for ((set, target), real) in sets.iter().zip(targets).zip(real) {
            let answer = Answer {
                paths: 2,
                nonsingular: 2,
                real: Some(real),
                ..Answer::default()
            };
            let wrong = complaints(set, &answer);
            assert!(wrong.is_empty(), "p = {target}, seed {seed}:{wrong}");
            for solution in &set.solutions {
                let x = solution.variables.0[0].value;
                let error = (x * x - target).norm_sqr().sqrt() / target.norm_sqr().sqrt();
                assert!(error < 1e-12, "p = {target}, seed {seed}: x = {x}");
            }
        }
    }
}

/// At p = 0 the two solutions of x^2 = p meet: one singular point of multiplicity 2.
#[test]
fn a_special_target_has_a_multiple_solution() {
    let system = written("variable_group x; parameter p; function f; f = x^2 - p;");
    for seed in SEEDS {
        let options = SolveOptions {
            method: SolveMethod::Given(KnownSolutions {
                points: None,
                parameters: Some(vec![number(1.0, 0.0)]),
            }),
            seed,
            target_parameters: vec![vec![number(0.0, 0.0)]],
            ..SolveOptions::default()
        };
        let sets = solve_from(&system, vec![number(1.0, 0.0), number(-1.0, 0.0)], options);
        let answer = Answer {
            paths: 2,
            singular_paths: 2,
            singular: Some(1),
            real: Some(Some(1)),
            ..Answer::default()
        };
        let wrong = complaints(&sets[0], &answer);
        assert!(wrong.is_empty(), "seed {seed}:{wrong}");
        assert_eq!(sets[0].solutions[0].cycles, [2], "seed {seed}");
    }
}

/// From x^3 = 1 to x^3 = 8 with a gamma of the user's own.
#[test]
fn a_homotopy_of_the_users_own_is_followed() {
    let system = written(
        "variable x; pathvariable t; function f; \
         f = (3/5 + 4*I/5)*t*(x^3 - 1) + (1 - t)*(x^3 - 8);",
    );
    let root = number(-0.5, 0.75f64.sqrt());
    let sets = solve_from(
        &system,
        vec![number(1.0, 0.0), root, root.conj()],
        SolveOptions::default(),
    );
    let answer = Answer {
        paths: 3,
        nonsingular: 3,
        real: Some(Some(1)),
        ..Answer::default()
    };
    let wrong = complaints(&sets[0], &answer);
    assert!(wrong.is_empty(), "{wrong}");
}

/// A point that solves nothing at the start is named, not tracked.
#[test]
fn a_wrong_start_solution_is_a_failed_path() {
    let system = written("variable_group x; parameter p; function f; f = x^2 - p;");
    let options = SolveOptions {
        method: SolveMethod::Given(KnownSolutions {
            points: None,
            parameters: Some(vec![number(1.0, 0.0)]),
        }),
        target_parameters: vec![vec![number(2.0, 0.0)]],
        ..SolveOptions::default()
    };
    let sets = solve_from(&system, vec![number(1.0, 0.0), number(0.3, 0.0)], options);
    assert_eq!((sets[0].paths.finite, sets[0].paths.failed), (1, 1));
    assert_eq!(sets[0].failed[0].path, 1);
    assert_eq!(sets[0].paths.retracked, 0, "no care helps a wrong start");
}
