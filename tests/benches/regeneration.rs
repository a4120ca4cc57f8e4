//! Regeneration of a 6R arm written as a loop of joints: 18 equations in 12 unknowns.
//!
//! `cargo bench -p cognate-tests --bench regeneration [-- SEED [REPETITIONS]]`, in tests/: paths are
//! tracked again 3 times at most where nothing else is said. CPU seconds of one thread, stage by stage; at the end the
//! joints are turned into axes and compared with the arm's other equations. Results: `regeneration.md`.

use cognate_algorithms::plan::SolveMethod;
use cognate_algorithms::plan::TrackingOptions;
use cognate_algorithms::retried_stage::MAX_RETRIES;
use cognate_algorithms::run_locally::{drive, run_locally};
use cognate_algorithms::{Opening, PathAlgorithm, SolveOptions, plan};
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::{Stage, Work};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use cognate_tests::measures::cpu_seconds;
use cognate_tests::six_revolute::{as_a_loop, axes_of, by_its_axes};
use num_complex::Complex64;
use std::collections::{BTreeMap, HashMap};
use std::process::ExitCode;
use std::sync::Arc;

type Failure = Box<dyn std::error::Error>;

/// Lanes side by side, and items of a chunk.
const WIDTH: usize = 8;
/// A chunk that takes longer is told with its paths.
const LONG: f64 = 2.0;
/// Two solutions are the same below this distance, relative to their largest coordinate.
const SAME: f64 = 1e-7;

/// The regular solutions of a set, coordinates in the order of the variables.
fn points(set: &SolutionSet) -> Vec<Vec<Complex64>> {
    let regular = set.solutions.iter().filter(|s| !s.singular);
    regular.map(|s| s.variables.values().collect()).collect()
}

fn purpose(stage: &Stage) -> String {
    let what = match &stage.homotopy {
        _ if stage.work != Work::Track => "whether singular ends are isolated".to_string(),
        HomotopyKind::MoveSlice { level, forms, .. } => format!("{}: {forms} slices", level + 1),
        HomotopyKind::ProductToEquation { level, .. } => format!("{}: the equation", level + 1),
        other => format!("{other:?}"),
    };
    match stage.attempt {
        0 => what,
        attempt => format!("{what}, again ({attempt})"),
    }
}

/// All items of a stage; one line about them.
fn track(system: &System, opening: &Opening, made: &Objects) -> Result<Vec<ItemResult>, Failure> {
    let stage = &opening.stage;
    let find = |wanted: Digest| made.get(&wanted).cloned();
    let before = cpu_seconds()?;
    let prepared = PreparedWork::new(system, stage, &find)?;
    let (mut results, mut first, mut longest) = (Vec::new(), 0, 0.0f64);
    while first < prepared.items() {
        let last = prepared.items().min(first + WIDTH as u64);
        let begun = cpu_seconds()?;
        let chunk = prepared.run(first..last, WIDTH);
        let seconds = cpu_seconds()? - begun;
        longest = longest.max(seconds);
        if seconds > LONG {
            println!("  {seconds:.1} s for {}:", purpose(stage));
            for r in chunk.iter().filter_map(ItemResult::path) {
                println!(
                    "    path {}: {:?} at |t| = {:.1e}, {} bits, {} evaluations, {} turns",
                    r.origin.0,
                    r.outcome,
                    r.t.norm_sqr().sqrt(),
                    r.precision_bits,
                    r.counts.evaluations,
                    r.counts.turns
                );
            }
        }
        results.extend(chunk);
        first = last;
    }
    let mut bits: BTreeMap<u32, u64> = BTreeMap::new();
    for result in results.iter().filter_map(ItemResult::path) {
        *bits.entry(result.precision_bits).or_default() += 1;
    }
    println!(
        "{}: {} paths, {:.2} s, by bits {bits:?}, longest {WIDTH} paths {longest:.2} s",
        purpose(stage),
        results.len(),
        cpu_seconds()? - before
    );
    Ok(results)
}

type Objects = HashMap<Digest, Arc<StoredPoints>>;

/// Whether all loops that were found are the arm's postures, and no two the same.
fn compare(seed: u64, max_retries: u16) -> Result<bool, Failure> {
    let options = |start| SolveOptions {
        method: start,
        seed,
        tracking: TrackingOptions {
            max_retries,
            ..TrackingOptions::default()
        },
        ..SolveOptions::default()
    };
    let mut planned = plan(&by_its_axes(), &options(SolveMethod::Multihomogeneous))?;
    let other = run_locally(&planned.system, &mut planned.algorithm, &|_| None, WIDTH)?;
    let expected = points(&other[0]);
    println!(
        "by its axes: {} paths, {} regular solutions, {} failed",
        other[0].paths.total,
        expected.len(),
        other[0].paths.failed
    );
    let begun = cpu_seconds()?;
    let mut planned = plan(&as_a_loop(), &options(SolveMethod::Regeneration))?;
    let mut made = Objects::new();
    drive::<Failure, _>(&mut planned.algorithm, &mut |opening| {
        let objects = opening.objects.iter();
        made.extend(objects.map(|points| (points.digest(), Arc::clone(points))));
        track(&planned.system, opening, &made)
    })?;
    let sets = planned.algorithm.solution_sets(&planned.system);
    let loop_points: Vec<_> = points(&sets[0]).iter().map(|p| axes_of(p)).collect();
    println!(
        "as a loop: {} regular solutions, {:.1} s, paths of the last level {:?}, warnings {:?}",
        loop_points.len(),
        cpu_seconds()? - begun,
        sets[0].paths,
        sets[0].warnings
    );
    let near = |a: &[Complex64], b: &[Complex64]| {
        let size = |p: &[Complex64]| p.iter().fold(0.0f64, |m, z| m.max(z.norm_sqr().sqrt()));
        let apart: Vec<Complex64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        size(&apart) <= SAME * size(b)
    };
    let once = |point: &Vec<Complex64>, other_points: &[Vec<Complex64>]| {
        other_points
            .iter()
            .filter(|other| near(point, other))
            .count()
            == 1
    };
    let same = expected.len() == loop_points.len()
        && expected.iter().all(|point| once(point, &loop_points))
        && loop_points.iter().all(|point| once(point, &expected));
    println!("the same: {same}");
    Ok(same && sets[0].paths.failed == 0)
}

fn main() -> Result<ExitCode, Failure> {
    let numbers = std::env::args().skip(1).filter_map(|a| a.parse().ok());
    let numbers: Vec<u16> = numbers.collect();
    let number = |place: usize| numbers.get(place).copied();
    let seed = u64::from(number(0).unwrap_or(1));
    Ok(match compare(seed, number(1).unwrap_or(MAX_RETRIES))? {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    })
}
