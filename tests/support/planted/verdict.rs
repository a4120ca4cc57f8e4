//! A planted system, solved in this process and compared with its exact answer.

use super::Planted;
use crate::dice::Dice;
use crate::measures::cpu_seconds;
use cognate_algorithms::plan::{ClosingOptions, SolveMethod, TrackingOptions};
use cognate_algorithms::run_locally::drive;
use cognate_algorithms::{PathAlgorithm, SolveOptions, plan};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_protocol::file_settings::of_file;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::formats::{self, Problem};
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Lanes side by side; other widths give the same bits.
const WIDTH: usize = 8;
/// Largest distance of a simple solution from the exact one, relative to the largest coordinate.
const NEAR: f64 = 1e-5;
/// Largest distance of a multiple solution from the exact one, relative to the largest coordinate: a point of
/// multiplicity m is known to the m-th root of the rounding.
const NEAR_MULTIPLE: f64 = 1e-3;

/// Verdict on a solve of a planted system.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Everything as it was planted, and settled.
    Right,
    /// Everything as it was planted, but the answer says that it is not settled.
    RightInDoubt,
    /// Something is wrong, and the answer says that it is not settled.
    Doubt(String),
    /// Something is wrong, and the answer says that it is settled.
    Silent(String),
    /// No answer came within the time.
    NoEnd,
    /// The system was not accepted; the message.
    Refused(String),
}

/// Faults of a solution set; empty if it is as planted.
pub fn complaints(planted: &Planted, set: &SolutionSet) -> String {
    let mut text = String::new();
    let mut expect = |what: &str, actual_count: u64, expected: u64| {
        if actual_count != expected {
            write!(text, " {what} {actual_count} instead of {expected};").expect("text takes all");
        }
    };
    let counts = &set.counts;
    expect("sum of the classes", set.paths.sum(), set.paths.total);
    expect("distinct", counts.distinct, planted.roots.len() as u64);
    if planted.square {
        expect("nonsingular", counts.nonsingular, planted.nonsingular());
        expect(
            "with multiplicity",
            counts.with_multiplicity,
            planted.with_multiplicity(),
        );
    }
    if let Some(real) = counts.real {
        expect("real", real, planted.real());
    }
    if let Some(on_a_set) = counts.positive_dimensional {
        expect(
            "positive-dimensional",
            u64::from(on_a_set),
            u64::from(planted.on_a_set),
        );
    }
    let solutions: Vec<Vec<Complex64>> = set
        .solutions
        .iter()
        .map(|solution| solution.variables.values().collect())
        .collect();
    expect("missing points", missing(planted, &solutions), 0);
    text
}

/// How many planted solutions have none of those found near them, each coordinate in units of its largest value
/// at any solution.
fn missing(planted: &Planted, solutions: &[Vec<Complex64>]) -> u64 {
    let exact: Vec<Vec<Complex64>> = planted.roots.iter().map(|root| root.rounded()).collect();
    let largest = |k: usize| {
        exact
            .iter()
            .map(|point| point[k].norm_sqr())
            .fold(0.0, f64::max)
    };
    let count = exact.first().map_or(0, Vec::len);
    let units: Vec<f64> = (0..count)
        .map(|k| largest(k).sqrt())
        .map(|unit| if unit > 0.0 { unit } else { 1.0 })
        .collect();
    let size = |point: &mut dyn Iterator<Item = Complex64>| {
        let in_units = point.zip(&units).map(|(z, unit)| (z / unit).norm_sqr());
        in_units.fold(0.0, f64::max).sqrt()
    };
    let both = planted.roots.iter().zip(&exact);
    let is_missing = both.filter(|(root, exact)| {
        let near = if root.multiplicity > 1 {
            NEAR_MULTIPLE
        } else {
            NEAR
        };
        let root_size = size(&mut exact.iter().copied());
        let within = near * if root_size > 0.0 { root_size } else { 1.0 };
        !solutions
            .iter()
            .any(|point| size(&mut point.iter().zip(*exact).map(|(a, b)| a - b)) <= within)
    });
    is_missing.count() as u64
}

/// A start for this throw: mostly the one that is chosen by itself.
pub fn start(dice: &mut Dice) -> SolveMethod {
    match dice.below(10) {
        0..=4 => SolveMethod::Auto,
        5 | 6 => SolveMethod::TotalDegree,
        7 => SolveMethod::Polyhedral,
        8 => SolveMethod::LINEAR_PRODUCT,
        _ => SolveMethod::Multihomogeneous,
    }
}

/// Solves in this process, within this CPU time; the set of the first target.
///
/// # Errors
/// The verdict where there is none: [`Verdict::NoEnd`] or [`Verdict::Refused`].
pub fn solve_within(
    system: &System,
    options: &SolveOptions,
    limit: Duration,
) -> Result<SolutionSet, Verdict> {
    let refused = |error: String| Verdict::Refused(error);
    let mut plan = plan(system, options).map_err(|error| refused(error.to_string()))?;
    let began = Instant::now();
    // CPU time, where the system tells it: what is compared does not depend on what else the machine does.
    let spent = || cpu_seconds().unwrap_or_else(|_| began.elapsed().as_secs_f64());
    let until = spent() + limit.as_secs_f64();
    let mut made = HashMap::<Digest, Arc<StoredPoints>>::new();
    let tracked = plan.system.clone();
    drive::<Verdict, _>(&mut plan.algorithm, &mut |opening| {
        let objects = opening.objects.iter();
        made.extend(objects.map(|points| (points.digest(), Arc::clone(points))));
        let find = |wanted: Digest| made.get(&wanted).cloned();
        let work = PreparedWork::new(&tracked, &opening.stage, &find);
        let work = work.map_err(|error| refused(error.to_string()))?;
        let mut results = Vec::<ItemResult>::new();
        let mut next = 0;
        while next < work.items() {
            let end = (next + WIDTH as u64).min(work.items());
            results.extend(work.run(next..end, WIDTH));
            next = end;
            if spent() > until {
                return Err(Verdict::NoEnd);
            }
        }
        Ok(results)
    })?;
    if let Some(message) = plan.algorithm.failure() {
        return Err(refused(message));
    }
    let sets = plan.algorithm.solution_sets(&tracked);
    let first = sets.into_iter().next();
    first.ok_or_else(|| refused("there is no solution set".into()))
}

/// A solve with one start and seed, with an exact count of the solutions or without.
pub fn options(start: SolveMethod, seed: u64, no_exact_count: bool) -> SolveOptions {
    SolveOptions {
        method: start,
        seed,
        closings: ClosingOptions {
            no_exact_count,
            ..ClosingOptions::default()
        },
        ..SolveOptions::default()
    }
}

/// The options with what the settings of a problem's file mean for a submission.
pub fn as_submitted(problem: &Problem, options: &SolveOptions) -> SolveOptions {
    let base = &options.tracking.settings;
    let settings = of_file(&problem.settings, &problem.system, base).over(base.clone());
    SolveOptions {
        numbers_are_exact: settings.exact_data,
        tracking: TrackingOptions {
            settings,
            ..options.tracking.clone()
        },
        ..options.clone()
    }
}

/// Solves within this CPU time.
pub fn solve(planted: &Planted, options: &SolveOptions, limit: Duration) -> Verdict {
    let text = planted.file("");
    let problem = match formats::read("planted", text.as_bytes()) {
        Ok(problem) => problem,
        Err(error) => return Verdict::Refused(error.to_string()),
    };
    let options = as_submitted(&problem, options);
    let set = match solve_within(&problem.system, &options, limit) {
        Ok(set) => set,
        Err(verdict) => return verdict,
    };
    let wrong = complaints(planted, &set);
    match (wrong.is_empty(), set.settled()) {
        (true, true) => Verdict::Right,
        (true, false) => Verdict::RightInDoubt,
        (false, true) => Verdict::Silent(wrong),
        (false, false) => Verdict::Doubt(wrong),
    }
}
