//! `check`: one system, ten seeds, the numbers that must come out.

use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use std::fmt::Write;
use std::sync::Arc;

/// Expected counts of a solve. `None`: not asked.
#[derive(Clone, Copy, Debug, Default)]
pub struct Answer {
    /// Paths of the first stage.
    pub paths: u64,
    /// Distinct nonsingular solutions.
    pub nonsingular: u64,
    /// Paths to singular finite endpoints.
    pub singular_paths: u64,
    /// Paths to positive-dimensional solution sets.
    pub positive_dimensional: u64,
    /// Paths to infinity.
    pub at_infinity: u64,
    /// Paths to solutions only of the combinations of equations that are tracked.
    pub excess: u64,
    /// Distinct singular solutions.
    pub singular: Option<u64>,
    /// Real solutions; the inner `None` where the system is not invariant.
    pub real: Option<Option<u64>>,
}

/// Seeds that every known answer is checked with.
pub const SEEDS: std::ops::RangeInclusive<u64> = 1..=10;

/// Seeds of answers that take seconds each: two of them, and every one by `tests/run.sh long`.
pub fn seeds_of_slow_answers() -> std::ops::RangeInclusive<u64> {
    if std::env::var_os("COGNATE_LONG").is_some() {
        SEEDS
    } else {
        1..=2
    }
}

/// Lanes side by side; other widths give the same bits.
const WIDTH: usize = 8;

/// Solves with one seed; all sets, one for each target.
pub fn solve(
    system: &System,
    options: &SolveOptions,
    objects: &dyn Fn(Digest) -> Option<Arc<StoredPoints>>,
) -> (u64, Vec<SolutionSet>) {
    let mut plan = match plan(system, options) {
        Ok(plan) => plan,
        Err(error) => panic!("{error}"),
    };
    match run_locally(&plan.system, &mut plan.algorithm, objects, WIDTH) {
        Ok(sets) => {
            let total = || sets.iter().map(|set| set.paths.total).sum();
            (plan.paths.unwrap_or_else(total), sets)
        }
        Err(error) => panic!("{error}"),
    }
}

/// Faults of one set, in words; empty if there is none.
pub fn complaints(set: &SolutionSet, answer: &Answer) -> String {
    let mut text = String::new();
    let mut expect = |what: &str, actual_count: u64, expected: u64| {
        if actual_count != expected {
            let _ = write!(text, " {what} {actual_count} instead of {expected};");
        }
    };
    let (paths, counts) = (&set.paths, &set.counts);
    expect("sum of the classes", paths.sum(), paths.total);
    expect("paths", paths.total, answer.paths);
    expect("failed", paths.failed, 0);
    expect(
        "crossings left",
        paths.crossings_found - paths.crossings_resolved,
        0,
    );
    expect("nonsingular", counts.nonsingular, answer.nonsingular);
    expect("finite paths", paths.finite, answer.nonsingular);
    expect("undecided", paths.undecided, 0);
    expect("singular paths", paths.singular, answer.singular_paths);
    let on_sets = paths.positive_dimensional.unwrap_or(u64::MAX);
    expect("positive-dimensional", on_sets, answer.positive_dimensional);
    let sets = u64::from(counts.positive_dimensional == Some(true));
    expect("sets", sets, u64::from(answer.positive_dimensional > 0));
    expect("at infinity", paths.at_infinity, answer.at_infinity);
    expect("excess", paths.excess.unwrap_or(0), answer.excess);
    if let Some(singular) = answer.singular {
        expect("singular", counts.singular, singular);
    }
    if let Some(real) = answer.real
        && counts.real != real
    {
        let _ = write!(text, " real {:?} instead of {real:?};", counts.real);
    }
    for failed in set.failed.iter().take(5) {
        let _ = write!(
            text,
            " path {} at |t| = {:e}: {};",
            failed.path,
            failed.t,
            failed.reason.describe()
        );
    }
    text
}

/// Ten seeds; one panic with everything that is wrong.
pub fn check(name: &str, system: &System, options: &SolveOptions, answer: Answer) {
    let mut report = String::new();
    for seed in SEEDS {
        let options = SolveOptions {
            seed,
            ..options.clone()
        };
        let (_, sets) = solve(system, &options, &|_| None);
        let wrong = complaints(&sets[0], &answer);
        if !wrong.is_empty() {
            let _ = write!(
                report,
                "\n{name}, seed {seed}:{wrong} {:?}",
                sets[0].warnings
            );
        }
    }
    assert!(report.is_empty(), "{report}");
}
