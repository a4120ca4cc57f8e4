//! More equations than unknowns: combinations are tracked, and what solves only those is excess.

use crate::check::{Answer, SEEDS, check, complaints, solve};
use cognate_algorithms::plan::SolveMethod;
use cognate_algorithms::{SolveOptions, plan};
use cognate_tests::builders::example;
use cognate_tests::systems::{shared, written};

/// Survey, system (35): exactly (0,0), (1,0) and (0,-1), where the survey prints (0,1).
#[test]
fn system_35_has_exactly_3_solutions() {
    let system = shared("survey_eq35");
    let answer = Answer {
        paths: 4,
        nonsingular: 3,
        excess: 1,
        real: Some(Some(3)),
        ..Answer::default()
    };
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let wrong = complaints(&sets[0], &answer);
        assert!(wrong.is_empty(), "seed {seed}:{wrong}");
        let mut points: Vec<[i64; 2]> = Vec::new();
        for solution in &sets[0].solutions {
            let values: Vec<_> = solution.variables.values().collect();
            let near = [values[0].re.round(), values[1].re.round()];
            let error = (values[0] - near[0]).norm_sqr() + (values[1] - near[1]).norm_sqr();
            assert!(error < 1e-24, "seed {seed}: {values:?}");
            points.push(near.map(|v| v as i64));
        }
        points.sort_unstable();
        assert_eq!(points, [[0, -1], [0, 0], [1, 0]], "seed {seed}");
    }
}

/// Three quadrics in P^2 that share one point of four, written homogeneously.
#[test]
fn a_homogeneous_system_keeps_its_common_points() {
    let system = written(
        "hom_variable_group x, y, z; function f, g, h; \
         f = x^2 - z^2; g = y^2 - z^2; h = x*y^2 + x^2*y - 2*z^3;",
    );
    check(
        "conics and a cubic",
        &system,
        &SolveOptions::default(),
        Answer {
            paths: 6,
            nonsingular: 1,
            excess: 5,
            real: Some(Some(1)),
            ..Answer::default()
        },
    );
}

/// An equation that says the same again makes no solution singular or lost.
#[test]
fn a_repeated_equation_changes_nothing() {
    let system = written(
        "variable_group x, y; function f, g, h; \
         f = x^2 + y^2 - 4; g = x*y - 1; h = 3*x*y - 3;",
    );
    check(
        "repeated",
        &system,
        &SolveOptions::default(),
        Answer {
            paths: 4,
            nonsingular: 4,
            real: Some(Some(4)),
            ..Answer::default()
        },
    );
}

/// Ten cubics, two quadrics and six circles in twelve unknowns: the circles stay, and of the others
/// six combinations are tracked.
#[test]
fn a_loop_of_six_joints_keeps_its_circles() {
    let text = example("six_revolute_loop.bertini");
    let system = match cognate_systems::formats::read("loop", text.as_bytes()) {
        Ok(problem) => problem.system,
        Err(error) => panic!("{error}"),
    };
    assert_eq!((system.equation_count(), system.dimension()), (18, 12));
    for seed in SEEDS.take(3) {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            seed,
            ..SolveOptions::default()
        };
        let paths = plan(&system, &options).map(|plan| plan.paths);
        assert_eq!(paths.ok().flatten(), Some(2_u64.pow(6) * 3_u64.pow(6)));
    }
}
