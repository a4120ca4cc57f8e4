//! A mechanism at a general complex target, from which targets are reached: solved once an answer.

use cognate_algorithms::plan::GivenStart;
use cognate_algorithms::plan::{KnownSolutions, SolveMethod, TrackingOptions};
use cognate_algorithms::run_locally::run_locally;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::settings::Preset;
use cognate_kinematics::compile::{CLOSES, Formulation, Lifted, Target};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::sync::Arc;

/// Lanes side by side; other widths give the same bits.
const WIDTH: usize = 8;

/// Where targets start, and how that came about.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Parameters of the member from which targets are followed.
    pub parameters: Vec<Complex64>,
    /// Its solutions that are positions, point after point.
    pub points: Vec<Complex64>,
    /// Number of these solutions.
    pub count: u64,
    /// What became of the other paths to the member, in words; empty where all are positions.
    pub others: String,
    /// Whether every path to the member is accounted for and all positions are regular.
    pub settled: bool,
    /// What a person should know.
    pub warnings: Vec<String>,
}

/// Values of a solution's variables in the system's order.
pub fn in_order(solution: &Solution, system: &System) -> Vec<Complex64> {
    let named = &solution.variables.0;
    let value = |name: &String| named.iter().find(|v| v.name == *name).map(|v| v.value);
    system
        .variables
        .iter()
        .map(|name| value(name).unwrap_or_default())
        .collect()
}

/// Solves in this process.
pub fn solve(
    system: &System,
    options: &SolveOptions,
    start: Option<&Arc<StoredPoints>>,
) -> Result<Vec<SolutionSet>, String> {
    let mut options = options.clone();
    let digest = start.map(|points| points.digest());
    if let (Some(points), Some(object)) = (start, digest) {
        let given = GivenStart {
            object,
            count: points.len() as u64,
            dimension: points.dimension,
        };
        options.method = options.method.with_points(given);
    }
    let mut plan = plan(system, &options).map_err(|e| e.to_string())?;
    let find = |wanted: Digest| start.filter(|_| digest == Some(wanted)).map(Arc::clone);
    run_locally(&plan.system, &mut plan.algorithm, &find, WIDTH).map_err(|e| e.to_string())
}

/// The positions among the regular solutions at these parameters.
fn positions(
    formulation: &dyn Formulation,
    system: &System,
    set: &SolutionSet,
    parameters: &[Complex64],
) -> Vec<Complex64> {
    let mut points = Vec::new();
    for solution in set.solutions.iter().filter(|s| !s.singular) {
        let point = in_order(solution, system);
        if let Lifted::Position(position) = formulation.lift(None, parameters, &point)
            && position.residual < CLOSES
        {
            points.extend(point);
        }
    }
    points
}

/// Prepares a formulation with parameters. A number that is not the family's is believed when two general
/// members have it.
pub fn prepare(
    formulation: &dyn Formulation,
    system: &System,
    seed: u64,
) -> Result<Prepared, String> {
    let mut first = prepare_once(formulation, system, seed, 0)?;
    if Some(first.count) == formulation.family().expected {
        return Ok(first);
    }
    let second = prepare_once(formulation, system, seed, 1)?;
    if second.count == first.count {
        return Ok(first);
    }
    let counts = [first.count, second.count];
    if second.count > first.count {
        first = second;
    }
    first.settled = false;
    first.warnings.push(format!(
        "preparing: two general targets of this mechanism have {} and {} positions; the number is not settled",
        counts[0], counts[1]
    ));
    Ok(first)
}

/// Prepares by the general member of this number.
fn prepare_once(
    formulation: &dyn Formulation,
    system: &System,
    seed: u64,
    member: u64,
) -> Result<Prepared, String> {
    let mut random = RandomStream::new(seed, Purpose::Probe, 0x6d65_6368 + member);
    // Moduli near 1, and no number near 0: lengths and half-tangents of a general member.
    let mut draw = || {
        let z = random.unit();
        z * (0.6 + 0.6 * random.uniform())
    };
    let known = formulation.known_member();
    let member = formulation.generic(&mut draw);
    let dimension = system.variables.len();
    let options = SolveOptions {
        seed,
        ..SolveOptions::default()
    };
    // A known member's paths are few and nothing else says how many there are: cautiously.
    let careful = SolveOptions {
        tracking: TrackingOptions {
            settings: Preset::Careful.settings(),
            ..TrackingOptions::default()
        },
        ..options.clone()
    };
    let (sets, parameters) = match (known, member) {
        (Some(known), None) => {
            return Ok(Prepared {
                count: (known.points.len() / dimension.max(1)) as u64,
                parameters: known.parameters,
                points: known.points,
                others: String::new(),
                settled: true,
                warnings: Vec::new(),
            });
        }
        (Some(known), Some(member)) => {
            let points = Arc::new(StoredPoints {
                dimension,
                coordinates: known.points,
            });
            let options = SolveOptions {
                method: SolveMethod::Given(KnownSolutions {
                    points: None,
                    parameters: Some(known.parameters),
                }),
                target_parameters: vec![member.clone()],
                ..careful
            };
            (solve(system, &options, Some(&points))?, member)
        }
        (None, Some(member)) => {
            let options = SolveOptions {
                target_parameters: vec![member.clone()],
                ..options
            };
            (solve(system, &options, None)?, member)
        }
        (None, None) => return Err("this mechanism has no general member to start from".into()),
    };
    let set = sets.first().ok_or("the general member was not solved")?;
    let points = positions(formulation, system, set, &parameters);
    let count = (points.len() / dimension.max(1)) as u64;
    let mut warnings = Vec::new();
    if !set.settled() {
        warnings.push(format!(
            "preparing: {} of {} paths to a general position of this mechanism are not accounted for; positions may be missing",
            set.paths.failed + set.paths.undecided + set.paths.within_data_accuracy,
            set.paths.total
        ));
    }
    if set.counts.singular > 0 {
        warnings.push(format!(
            "preparing: {} positions of a general target are singular and are not followed",
            set.counts.singular
        ));
    }
    Ok(Prepared {
        parameters,
        points,
        count,
        others: others(set, count),
        settled: set.settled() && set.counts.singular == 0,
        warnings,
    })
}

/// What became of paths that are no positions, in words.
fn others(set: &SolutionSet, positions: u64) -> String {
    let paths = &set.paths;
    let kinds = [
        (paths.at_infinity, "at infinity"),
        (
            paths.positive_dimensional.unwrap_or(0),
            "on sets that are no positions",
        ),
        (paths.finite.saturating_sub(positions), "no positions"),
        (
            paths.excess.unwrap_or(0),
            "no solutions before randomisation",
        ),
        (paths.singular, "singular"),
        (paths.undecided, "undecided"),
        (
            paths.within_data_accuracy,
            "within the accuracy of the data",
        ),
        (paths.failed, "failed"),
    ];
    let words: Vec<String> = kinds
        .iter()
        .filter(|(n, _)| *n > 0)
        .map(|(n, word)| format!("{n} {word}"))
        .collect();
    words.join(", ")
}

/// The targets of a formulation without parameters: one, with nothing given.
pub fn lone_target() -> Target {
    Target::Inputs(Vec::new())
}
