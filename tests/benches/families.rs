//! Families: a general member solved once, then many members from its solutions.
//!
//! `cargo bench -p cognate-tests --bench families [-- MEMBERS]`, in tests/. CPU seconds of one
//! thread. Every member must have all solutions of a general one, or it is named. Results: `families.md`.

use cognate_algorithms::plan::GivenStart;
use cognate_algorithms::plan::{KnownSolutions, SolveMethod};
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::start_points::StoredPoints;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::symmetry::SymmetryGroup;
use cognate_tests::families::{Family, octahedral, six_revolute, stewart_gough};
use cognate_tests::measures::cpu_seconds;
use num_complex::Complex64;
use std::process::ExitCode;
use std::sync::Arc;

type Failure = Box<dyn std::error::Error>;

/// Members of each family, where nothing else is said.
const MEMBERS: usize = 100;
/// Seed of the general member; members have the numbers after it.
const GENERAL: u64 = 1000;
/// Lanes side by side.
const WIDTH: usize = 16;
/// Two solutions are the same below this distance, relative to their largest coordinate.
const SAME: f64 = 1e-8;

/// Solves; CPU seconds with it, all that planning and classifying takes among them.
fn solved(
    family: &Family,
    options: &SolveOptions,
    starts: Option<&Arc<StoredPoints>>,
) -> Result<(u64, Vec<SolutionSet>, f64), Failure> {
    let before = cpu_seconds()?;
    let mut planned = plan(&family.system, options)?;
    let find = |wanted| starts.filter(|s| s.digest() == wanted).cloned();
    let sets = run_locally(&planned.system, &mut planned.algorithm, &find, WIDTH)?;
    Ok((
        planned.paths.unwrap_or_default(),
        sets,
        cpu_seconds()? - before,
    ))
}

/// The regular solutions of a set, coordinates in the order of the variables.
fn points(set: &SolutionSet) -> Vec<Vec<Complex64>> {
    let regular = set.solutions.iter().filter(|s| !s.singular);
    regular.map(|s| s.variables.values().collect()).collect()
}

/// One of each orbit of the family's symmetry; all where it has none.
fn representatives(
    family: &Family,
    solutions: &[Vec<Complex64>],
) -> Result<Vec<Vec<Complex64>>, Failure> {
    let mut group = SymmetryGroup::of(&family.system)?;
    if group.is_trivial() {
        return Ok(solutions.to_vec());
    }
    let shape = PointShape::of(&family.system);
    group.close(&solutions[0], &shape)?;
    let listed: Vec<(&[Complex64], f64)> = solutions.iter().map(|p| (&p[..], SAME)).collect();
    let orbits = group.orbits(&listed, &shape, 1);
    Ok(orbits
        .iter()
        .map(|orbit| solutions[orbit[0]].clone())
        .collect())
}

/// A general member, then the others; false where one is not complete.
fn measure(family: &Family, members: usize) -> Result<bool, Failure> {
    let mut random = RandomStream::new(GENERAL, Purpose::Test, 0);
    let general: Vec<Complex64> = family
        .system
        .parameters
        .iter()
        .map(|_| random.unit())
        .collect();
    let first = SolveOptions {
        target_parameters: vec![general.clone()],
        seed: GENERAL,
        ..SolveOptions::default()
    };
    let (paths, sets, seconds) = solved(family, &first, None)?;
    let solutions = points(&sets[0]);
    println!(
        "{}: {} of {} solutions of a general member by {paths} paths in {seconds:.3} s",
        family.name,
        solutions.len(),
        family.solutions
    );
    if solutions.len() as u64 != family.solutions || sets[0].paths.failed > 0 {
        return Ok(false);
    }
    let starts = representatives(family, &solutions)?;
    let stored = Arc::new(StoredPoints {
        dimension: solutions[0].len(),
        coordinates: starts.concat(),
    });
    let real = |number: usize| -> Vec<Complex64> {
        let mut random = RandomStream::new(GENERAL + 1 + number as u64, Purpose::Test, 0);
        // 52 bits: multiples of 2^-52, as exact as a double can be.
        let mut draw = || random.below(1 << 52) as f64 / (1u64 << 52) as f64;
        let values = (family.member)(&mut draw);
        values.iter().map(|&v| Complex64::new(v, 0.0)).collect()
    };
    let others = SolveOptions {
        method: SolveMethod::Given(KnownSolutions {
            points: Some(GivenStart::of(&stored)),
            parameters: Some(general),
        }),
        target_parameters: (0..members).map(real).collect(),
        seed: GENERAL,
        ..SolveOptions::default()
    };
    let (paths, sets, seconds) = solved(family, &others, Some(&stored))?;
    let mut complete = 0;
    let (mut retracked, mut higher, mut assemblies) = (0, 0, Vec::new());
    for (number, set) in sets.iter().enumerate() {
        let is_complete = set.counts.nonsingular == starts.len() as u64
            && set.paths.finite == starts.len() as u64
            && representatives(family, &points(set))?.len() == starts.len()
            && set.settled();
        complete += usize::from(is_complete);
        retracked += set.paths.retracked;
        higher += set.paths.total - set.paths.by_precision.get(&53).copied().unwrap_or(0);
        assemblies.extend(set.counts.real);
        if !is_complete {
            println!("  member {number}: {:?} {:?}", set.paths, set.failed);
        }
    }
    assemblies.sort_unstable();
    println!(
        "  {complete} of {members} members complete, {} paths each; {:.1} members a second, {:.0} \
         paths a second; {retracked} paths tracked again, {higher} above doubles",
        starts.len(),
        members as f64 / seconds,
        paths as f64 / seconds
    );
    if let (Some(least), Some(most)) = (assemblies.first(), assemblies.last()) {
        println!("  real: from {least} to {most} of the solutions that paths lead to");
    }
    Ok(complete == members)
}

fn main() -> Result<ExitCode, Failure> {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let members = arguments.next().map_or(Ok(MEMBERS), |n| n.parse())?;
    let mut good = true;
    for family in [stewart_gough(), octahedral(), six_revolute()] {
        good &= measure(&family, members)?;
    }
    Ok(match good {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    })
}
