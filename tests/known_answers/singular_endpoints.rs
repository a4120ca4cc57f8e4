//! Multiple roots: multiplicities, cycles, and nothing lost.

use crate::check::{Answer, SEEDS, check, complaints, solve};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::ClosingOptions;
use cognate_algorithms::plan::SolveMethod;
use cognate_systems::named::{caprasse, griewank_osborne};
use cognate_tests::systems::written;

/// Multiplicity of each solution, ascending.
pub fn multiplicities(set: &cognate_solutions::solution_set::SolutionSet) -> Vec<u64> {
    let mut multiplicities: Vec<u64> = set.solutions.iter().map(|s| s.multiplicity).collect();
    multiplicities.sort_unstable();
    multiplicities
}

/// (x - 3/2)^3 (x + 2): a triple root and a simple one.
#[test]
fn a_triple_root_takes_three_paths() {
    let system = written("variable_group x; function f; f = (x - 3/2)^3*(x + 2);");
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..SolveOptions::default()
        };
        let (_, sets) = solve(&system, &options, &|_| None);
        let answer = Answer {
            paths: 4,
            nonsingular: 1,
            singular_paths: 3,
            singular: Some(1),
            real: Some(Some(2)),
            ..Answer::default()
        };
        let wrong = complaints(&sets[0], &answer);
        assert!(wrong.is_empty(), "seed {seed}:{wrong}");
        assert_eq!(multiplicities(&sets[0]), [1, 3]);
        let triple = sets[0].solutions.iter().find(|s| s.singular);
        assert_eq!(
            triple.map(|s| s.cycles.as_slice()),
            Some(&[3][..]),
            "seed {seed}"
        );
    }
}

/// Griewank and Osborne: three of the five paths (by the best groups) end at the origin.
#[test]
fn griewank_and_osbornes_root_is_triple() {
    check(
        "griewank_osborne",
        &griewank_osborne().system,
        &SolveOptions::default(),
        Answer {
            paths: 5,
            singular_paths: 3,
            singular: Some(1),
            at_infinity: 2,
            real: Some(Some(1)),
            ..Answer::default()
        },
    );
}

/// 24 simple and 8 fourfold solutions.
#[test]
fn caprasse_has_8_fourfold_solutions() {
    check(
        "caprasse",
        &caprasse().system,
        &SolveOptions::default(),
        Answer {
            paths: 62,
            nonsingular: 24,
            singular_paths: 32,
            singular: Some(8),
            at_infinity: 6,
            ..Answer::default()
        },
    );
}

/// Solutions of norm 10^4, 10^6 and 10^8 are solutions.
#[test]
fn far_solutions_are_finite() {
    for exponent in [4, 6, 8] {
        let system = written(&format!(
            "variable_group x; variable_group y; function f, g; \
             f = x - 10^{exponent}*y; g = y^2 - 3;"
        ));
        check(
            &format!("norm 10^{exponent}"),
            &system,
            &SolveOptions::default(),
            Answer {
                paths: 2,
                nonsingular: 2,
                real: Some(Some(2)),
                ..Answer::default()
            },
        );
    }
}

/// x y = 1, y = 10^-8: one solution of norm 10^8 and one at infinity, 10^-8 apart in the patch. In
/// doubles both are one double point.
#[test]
fn a_solution_beside_infinity_is_told_from_it() {
    for exponent in [4, 6, 8] {
        let system = written(&format!(
            "variable_group x, y; function f, g; f = x*y - 1; g = 10^{exponent}*y - 1;"
        ));
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            ..SolveOptions::default()
        };
        check(
            &format!("x y = 1, y = 10^-{exponent}"),
            &system,
            &options,
            Answer {
                paths: 2,
                nonsingular: 1,
                at_infinity: 1,
                real: Some(Some(1)),
                ..Answer::default()
            },
        );
    }
}

/// Deflation brings every multiple root to its digits, fewer times than its multiplicity.
#[test]
fn multiple_roots_get_their_digits_by_deflation() {
    let deflating = SolveOptions {
        closings: ClosingOptions {
            digits: Some(40),
            deflate: true,
            ..ClosingOptions::default()
        },
        ..SolveOptions::default()
    };
    let written_roots = [
        written("variable_group x; function f; f = (x - 3/2)^3*(x + 2);"),
        griewank_osborne().system,
        caprasse().system,
    ];
    let deflations = [2, 2, 1];
    for (system, most) in written_roots.iter().zip(deflations) {
        let (_, sets) = solve(system, &deflating, &|_| None);
        let set = &sets[0];
        let counts = set
            .counts
            .sharpened
            .as_ref()
            .expect("counts of what was asked");
        assert_eq!(counts.solutions, set.counts.distinct, "{:?}", set.warnings);
        assert_eq!(counts.by_deflation, set.counts.singular);
        for solution in &set.solutions {
            let deflated = solution.deflations.expect("it was sharpened");
            assert_eq!(deflated > 0, solution.singular);
            assert!(deflated <= most, "{deflated} of {most}");
            assert!(solution.accuracy < 1e-39);
            assert!(solution.variables.0.iter().all(|v| v.digits.is_some()));
        }
    }
}
