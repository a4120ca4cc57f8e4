//! Every start that applies gives an equal set of solutions: linear products and regeneration beside the others.

use crate::check::{Answer, SEEDS, check, solve};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::SolveMethod::{
    self, Multihomogeneous, Polyhedral, Regeneration, TotalDegree,
};
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::named::{Named, caprasse, cyclic, eco, katsura, noon, reimer};
use cognate_systems::system::System;
use cognate_tests::systems::{shared, six_revolute_axis_vectors, written};

fn options(start: SolveMethod, seed: u64) -> SolveOptions {
    SolveOptions {
        method: start,
        seed,
        ..SolveOptions::default()
    }
}

fn solved(system: &System, start: SolveMethod, seed: u64) -> SolutionSet {
    let (_, mut sets) = solve(system, &options(start, seed), &|_| None);
    sets.remove(0)
}

/// Every start finds this many nonsingular solutions, the same ones, and no path fails.
fn check_same(name: &str, system: &System, nonsingular: u64, starts: &[SolveMethod]) {
    check_same_with(5, name, system, nonsingular, starts);
}

/// Checks, with the first `seeds` seeds, that every start finds this many nonsingular solutions, equal ones, and that
/// no path fails.
fn check_same_with(
    seeds: usize,
    name: &str,
    system: &System,
    nonsingular: u64,
    starts: &[SolveMethod],
) {
    for seed in SEEDS.take(seeds) {
        let mut first: Option<Vec<Vec<num_complex::Complex64>>> = None;
        for start in starts {
            let set = solved(system, start.clone(), seed);
            let at = format!("{name}, {}, seed {seed}", start.name());
            assert_eq!(set.paths.failed, 0, "{at}: {:?}", set.failed);
            assert_eq!(
                set.counts.nonsingular, nonsingular,
                "{at}: {:?}",
                set.warnings
            );
            // A start that misses singular solutions is not settled where they are counted.
            let is_incomplete = set.counts.complete == Completeness::No;
            assert_eq!(set.settled(), !is_incomplete, "{at}: {:?}", set.warnings);
            let points: Vec<_> = set
                .solutions
                .iter()
                .filter(|solution| !solution.singular)
                .map(|solution| solution.variables.values().collect())
                .collect();
            let Some(expected) = &first else {
                first = Some(points);
                continue;
            };
            for point in &points {
                let near = |other: &Vec<num_complex::Complex64>| {
                    let pairs = other.iter().zip(point);
                    pairs.fold(0.0f64, |m, (a, b)| {
                        m.max((a - b).norm_sqr() / (1.0 + b.norm_sqr()))
                    }) < 1e-12
                };
                assert_eq!(expected.iter().filter(|o| near(o)).count(), 1, "{at}");
            }
        }
    }
}

fn check_named(named: &Named, name: &str, starts: &[SolveMethod]) {
    let count = named.finite_solutions.unwrap_or(0);
    check_same(name, &named.system, count, starts);
}

const ALL: &[SolveMethod] = &[
    TotalDegree,
    SolveMethod::LINEAR_PRODUCT,
    Polyhedral,
    Regeneration,
    SolveMethod::MONODROMY,
];

/// The larger ones, once each.
#[test]
fn larger_classical_systems_by_every_start() {
    let once = |name: &str, named: &Named, starts: &[SolveMethod]| {
        let count = named.finite_solutions.unwrap_or(0);
        check_same_with(1, name, &named.system, count, starts);
    };
    once("katsura-8", &katsura(8), ALL);
    once("noon-5", &noon(5), ALL);
    once("reimer-5", &reimer(5), ALL);
    // By linear products most paths of these end on sets at infinity, and take long.
    let others = [Polyhedral, Regeneration, SolveMethod::MONODROMY];
    once(
        "cyclic-6",
        &cyclic(6),
        &[&[TotalDegree][..], &others].concat(),
    );
    once("cyclic-7", &cyclic(7), &others);
    once("eco-8", &eco(8), &others);
}

/// Regular solutions; the others are where they are looked for.
#[test]
fn caprasse_by_every_start() {
    check_same_with(2, "caprasse", &caprasse().system, 24, ALL);
}

#[test]
fn mechanisms_by_every_start() {
    let by_groups = [&[Multihomogeneous], ALL].concat();
    // The 256 paths from its total degree take minutes: not here.
    let arm = shared("six_revolute_manseur_doty_tm8");
    let starts = [
        Multihomogeneous,
        Polyhedral,
        Regeneration,
        SolveMethod::MONODROMY,
    ];
    check_same_with(1, "6R", &arm, 32, &starts);
    let poses = shared("burmester_five_poses_real4");
    check_same_with(2, "five poses", &poses, 4, &by_groups);
    let platform = shared("stewart_gough_dietmaier");
    check_same_with(
        1,
        "Stewart-Gough",
        &platform,
        40,
        &[TotalDegree, Regeneration],
    );
}

#[test]
fn classical_systems_by_every_start() {
    check_named(&katsura(6), "katsura-6", ALL);
    check_named(&noon(4), "noon-4", ALL);
}

/// Survey: six assemblies. By products of linear forms as by the two groups.
#[test]
fn three_rpr_platform() {
    let starts = [
        TotalDegree,
        SolveMethod::Multihomogeneous,
        SolveMethod::LINEAR_PRODUCT,
        Polyhedral,
        Regeneration,
        SolveMethod::MONODROMY,
    ];
    check_same_with(2, "3-RPR", &shared("three_rpr_real6"), 6, &starts);
}

/// Sixteen postures of a general arm (Tsai and Morgan 1985).
#[test]
fn six_revolute_arm_by_its_axes() {
    let starts = [SolveMethod::Auto, Regeneration];
    check_same("6R by axes", &six_revolute_axis_vectors(), 16, &starts);
}

/// 3^n - 2n paths of a linear-product start, every one to a solution (Verschelde, Cools 1993).
#[test]
fn noon_5_by_linear_products_has_no_path_too_many() {
    let answer = Answer {
        paths: 233,
        nonsingular: 233,
        ..Answer::default()
    };
    let by_products = options(SolveMethod::LINEAR_PRODUCT, 0);
    check(
        "noon-5, linear product",
        &noon(5).system,
        &by_products,
        answer,
    );
}

/// Singular solutions are reached by a linear-product start as by any complete one.
#[test]
fn caprasse_keeps_its_multiplicities_by_linear_products() {
    for seed in [1, 2, 3] {
        let set = solved(&caprasse().system, SolveMethod::LINEAR_PRODUCT, seed);
        assert_eq!(set.paths.failed, 0, "{:?}", set.failed);
        assert_eq!((set.counts.nonsingular, set.counts.singular), (24, 8));
        assert_eq!(set.counts.with_multiplicity, 56);
    }
}

/// More equations than unknowns: combinations are regenerated, and what solves only them is excess.
#[test]
fn an_overdetermined_system_by_regeneration() {
    let system = written(
        "variable_group x, y; function f1, f2, f3; \
         f1 = x*y; f2 = x*(x - y - 1); f3 = y*(x - y - 1);",
    );
    for seed in SEEDS {
        let set = solved(&system, Regeneration, seed);
        assert_eq!((set.counts.nonsingular, set.paths.failed), (3, 0));
        assert_eq!(set.paths.excess, Some(1));
    }
}

/// x^2 + 1 = 0 twice: after the first equation nothing is left that solves the second alone.
#[test]
fn a_system_without_solutions_ends_without_any() {
    let system = written("variable_group x, y; function f, g; f = x*y - 1; g = x*y - 2;");
    let set = solved(&system, Regeneration, 1);
    assert_eq!((set.counts.distinct, set.paths.failed), (0, 0));
    assert!(set.settled());
}

/// Regeneration leaves singular points of the first equations behind: caprasse has 8 fourfold solutions of
/// 32, which it may miss, and says so. Where nothing is left behind nothing is missed.
#[test]
fn regeneration_says_what_it_may_miss() {
    let set = solved(&caprasse().system, Regeneration, 1);
    assert_eq!(set.paths.failed, 0, "{:?}", set.failed);
    if set.counts.distinct < 32 {
        assert_eq!(set.counts.complete, Completeness::No);
        let said = |warning: &String| warning.contains("may be missing");
        assert!(set.warnings.iter().any(said), "{:?}", set.warnings);
    }
    let set = solved(&katsura(4).system, Regeneration, 1);
    assert_eq!(
        (set.counts.distinct, set.counts.complete),
        (16, Completeness::Yes)
    );
    let set = solved(&katsura(4).system, TotalDegree, 1);
    assert_eq!(
        (set.counts.distinct, set.counts.complete),
        (16, Completeness::Yes)
    );
}

/// With a mixed volume of 0 there are no mixed cells to start from: `auto` takes another start. The
/// monomials of x y - 1 alone, twice, and of z.
#[test]
fn auto_never_chooses_a_start_without_paths() {
    let text = "f = x*y - 1; g = x*y - 2; h = x^9*y^9*z - 3;";
    let system = written(&format!("variable_group x, y, z; function f, g, h; {text}"));
    let set = solved(&system, SolveMethod::Auto, 1);
    assert_eq!(set.counts.distinct, 0, "{:?}", set.paths);
}
