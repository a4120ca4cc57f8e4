//! Solves from mixed cells: as many paths as the mixed volume, the known answers, and nothing lost.

use crate::check::{Answer, check, solve};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::{SolveMethod, plan};
use cognate_algorithms::start_costs::StartKind;
use cognate_systems::named::{Named, caprasse, cyclic, eco, katsura, noon, reimer};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::ZERO_DENOMINATOR;
use cognate_tests::systems::{shared, with_conjugates, written};

fn check_polyhedral(name: &str, system: &System, answer: Answer) {
    let options = SolveOptions {
        method: SolveMethod::Polyhedral,
        ..SolveOptions::default()
    };
    check(&format!("{name}, polyhedral"), system, &options, answer);
}

/// As many paths as the mixed volume, all to regular solutions but those at infinity.
fn check_named(name: &str, named: &Named, volume: u64) {
    let finite = named.finite_solutions.unwrap_or(volume);
    let answer = Answer {
        paths: volume,
        nonsingular: finite,
        at_infinity: volume - finite,
        ..Answer::default()
    };
    check_polyhedral(name, &named.system, answer);
}

#[test]
fn cyclic_5_and_6_and_7() {
    check_named("cyclic-5", &cyclic(5), 70);
    check_named("cyclic-6", &cyclic(6), 156);
    check_named("cyclic-7", &cyclic(7), 924);
}

/// Workers count the mixed cells, branch by branch, and the answers are the known ones.
#[test]
fn cyclic_6_and_7_counted_by_workers() {
    for (n, volume) in [(6, 156), (7, 924)] {
        let options = SolveOptions {
            method: SolveMethod::Polyhedral,
            counting_operations: 1000,
            ..SolveOptions::default()
        };
        let system = cyclic(n).system;
        let planned = plan(&system, &options).map(|plan| plan.paths);
        assert_eq!(planned, Ok(None));
        let answer = Answer {
            paths: volume,
            nonsingular: volume,
            ..Answer::default()
        };
        let name = format!("cyclic-{n}, counted by workers");
        check(&name, &system, &options, answer);
    }
}

#[test]
fn eco_8_and_noon_5_and_katsura_6() {
    check_named("eco-8", &eco(8), 64);
    check_named("noon-5", &noon(5), 233);
    check_named("katsura-6", &katsura(6), 64);
}

#[test]
fn reimer_4_and_5() {
    check_named("reimer-4", &reimer(4), 120);
    check_named("reimer-5", &reimer(5), 720);
}

#[test]
fn caprasse_keeps_its_multiplicities() {
    let answer = Answer {
        paths: 56,
        nonsingular: 24,
        singular_paths: 32,
        singular: Some(8),
        ..Answer::default()
    };
    check_polyhedral("caprasse", &caprasse().system, answer);
}

#[test]
fn mechanisms() {
    let answer = |paths: u64, nonsingular: u64, real: Option<u64>| Answer {
        paths,
        nonsingular,
        at_infinity: paths - nonsingular,
        real: Some(real),
        ..Answer::default()
    };
    let six_revolute = shared("six_revolute_manseur_doty_tm8");
    check_polyhedral("6R", &six_revolute, answer(64, 32, Some(32)));
    let five_poses = with_conjugates(shared("burmester_five_poses_real4"), "a~A,b~B");
    check_polyhedral("five poses", &five_poses, answer(4, 4, Some(4)));
}

/// x(y - 1) = 0 and y(x - 2) + x = 0: (0, 0) and (1, 1), one of them outside the torus.
#[test]
fn solutions_with_a_coordinate_0_are_found() {
    let system = written("variable_group x, y; function f, g; f = x*(y - 1); g = y*(x - 2) + x;");
    let answer = Answer {
        paths: 2,
        nonsingular: 2,
        real: Some(Some(2)),
        ..Answer::default()
    };
    check_polyhedral("zeros", &system, answer);
}

/// Exponents far apart, and with them the weights of the toric homotopy.
#[test]
fn sparse_polynomials_of_high_degree() {
    let system = written(
        "variable_group x, y; function f, g; \
         f = x^40*y - 3*y^2 + x*y^17 - 7*x + 2; g = x^3*y^30 + 5*x^2 - 11*y^9 + 1/2;",
    );
    let options = SolveOptions {
        method: SolveMethod::Polyhedral,
        ..SolveOptions::default()
    };
    let volume = plan(&system, &options).ok().and_then(|plan| plan.paths);
    let volume = volume.unwrap_or_default();
    // 1392 by total degree.
    assert!((600..1392).contains(&volume), "{volume}");
    let answer = Answer {
        paths: volume,
        nonsingular: volume,
        ..Answer::default()
    };
    check_polyhedral("sparse", &system, answer);
}

#[test]
fn auto_takes_it_where_it_saves_paths() {
    let chosen = |system: &System| {
        let plan = plan(system, &SolveOptions::default());
        plan.map(|plan| (plan.start, plan.paths, plan.why))
    };
    let (start, paths, why) = chosen(&cyclic(7).system).expect("it can be solved");
    assert_eq!((start, paths), (StartKind::Polyhedral, Some(924)), "{why}");
    assert!(why.contains("924") && why.contains("5040"), "{why}");
    let (start, paths, why) = chosen(&katsura(6).system).expect("it can be solved");
    assert_eq!((start, paths), (StartKind::TotalDegree, Some(64)), "{why}");
    let homogeneous = written("hom_variable_group x, y; function f; f = x^2 - 2*y^2;");
    let asked = SolveOptions {
        method: SolveMethod::Polyhedral,
        ..SolveOptions::default()
    };
    let refusal = plan(&homogeneous, &asked)
        .err()
        .map(|error| error.to_string());
    assert!(refusal.is_some_and(|r| r.contains("homogeneous groups")));
}

/// Triangles with the corners (1, 0), (0, 1) and (-1, -1): normalised area 3 (Bernstein 1975).
#[test]
fn laurent_polynomials_have_the_mixed_volume_of_their_own_exponents() {
    let system = written(
        "variable_group x, y; function f, g; \
         f = 2*x - 3*y + 5/(x*y) - 7; g = x + 4*y - 3*x^-1*y^-1 + 1;",
    );
    let answer = Answer {
        paths: 3,
        nonsingular: 3,
        ..Answer::default()
    };
    check_polyhedral("Laurent", &system, answer);
}

/// x = 2y - y^2 and y = x^2 - 3x meet in (0, 0) too, which is no solution of the quotients that
/// are asked: mixed cells do not look for it, and another start counts it by name.
#[test]
fn a_zero_below_the_line_is_no_solution() {
    let system = written("variable_group x, y; function f, g; f = x/y - 2 + y; g = y/x + 3 - x;");
    let answer = Answer {
        paths: 3,
        nonsingular: 3,
        ..Answer::default()
    };
    check_polyhedral("quotients", &system, answer);
    let options = SolveOptions {
        method: SolveMethod::TotalDegree,
        ..SolveOptions::default()
    };
    let (paths, sets) = solve(&system, &options, &|_| None);
    assert_eq!((paths, sets[0].counts.nonsingular), (4, 3));
    let at_zero = sets[0].counts.removed.get(ZERO_DENOMINATOR);
    assert_eq!(at_zero.copied(), Some(1));
}
