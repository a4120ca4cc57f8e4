//! A mechanism at a general complex target, from which targets are reached: solved once, and kept.

use super::cache::{Cache, Entry, Kept, Key};
use cognate_algorithms::plan::{GivenStart, KnownSolutions, SolveMethod, TrackingOptions};
use cognate_algorithms::run_locally::run_in_family;
use cognate_algorithms::{SolveOptions, plan};
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::prepared_family::PreparedFamily;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::tracker::settings::Preset;
use cognate_kinematics::compile::{CLOSES, Formulation, Lifted};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::sync::Arc;

/// Where targets start, and how that came about.
#[derive(Clone, Debug)]
pub struct StartPositions {
    /// Parameters of the member from which targets are followed.
    pub parameters: Vec<Complex64>,
    /// Solutions of the member that are positions, point after point.
    pub points: Vec<Complex64>,
    /// Number of these solutions.
    pub count: u64,
    /// Whether all are singular, as those of an arm are whose equations see its half and the mirrored half as one: paths begin
    /// there in the arm's loop only.
    pub are_singular: bool,
    /// Description of the other paths to the member, in words; empty if all end at positions.
    pub others: String,
    /// Whether every path to the member is accounted for and all positions are regular.
    pub settled: bool,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Whether this was found in the cache.
    pub from_cache: bool,
}

/// Values of a solution's variables in the system's order.
pub fn in_order(solution: &Solution, system: &System) -> Vec<Complex64> {
    let named = &solution.variables.0;
    let value = |(place, name): (usize, &String)| {
        // Most often they are in this order already.
        let here = named.get(place).filter(|v| v.name == *name);
        let variable = here.or_else(|| named.iter().find(|v| v.name == *name));
        variable.map(|v| v.value).unwrap_or_default()
    };
    system.variables.iter().enumerate().map(value).collect()
}

/// Solves in this process.
pub fn solve(
    system: &System,
    options: &SolveOptions,
    start: Option<&Arc<StoredPoints>>,
) -> Result<Vec<SolutionSet>, String> {
    solve_in_family(system, options, start, &PreparedFamily::default())
}

/// Solves a member of a family in this process; the part that belongs to the family is compiled once for all members.
pub fn solve_in_family(
    system: &System,
    options: &SolveOptions,
    start: Option<&Arc<StoredPoints>>,
    family: &PreparedFamily,
) -> Result<Vec<SolutionSet>, String> {
    let sets = observed(system, options, start, family, &mut |_| {});
    sets.map(|(sets, _)| sets)
}

/// Solves in this process and shows the results of each stage to an observer; returns also the system that the paths go
/// by.
pub fn observed(
    system: &System,
    options: &SolveOptions,
    start: Option<&Arc<StoredPoints>>,
    family: &PreparedFamily,
    observer: &mut dyn FnMut(&[ItemResult]),
) -> Result<(Vec<SolutionSet>, System), String> {
    let mut options = options.clone();
    let given = start.map(|points| GivenStart::of(points));
    if let Some(given) = given {
        options.method = options.method.with_points(given);
    }
    let mut plan = plan(system, &options).map_err(|e| e.to_string())?;
    let find = |wanted: Digest| {
        start
            .filter(|_| given.is_some_and(|given| given.object == wanted))
            .map(Arc::clone)
    };
    let sets = run_in_family(&plan.system, &mut plan.algorithm, &find, family, observer);
    Ok((sets.map_err(|e| e.to_string())?, plan.system))
}

/// The positions among the regular solutions at these parameters, or among the singular ones.
fn positions(
    formulation: &dyn Formulation,
    system: &System,
    set: &SolutionSet,
    parameters: &[Complex64],
    are_singular: bool,
) -> Vec<Complex64> {
    let mut points = Vec::new();
    let solutions = set.solutions.iter();
    for solution in solutions.filter(|s| s.singular == are_singular) {
        let point = in_order(solution, system);
        if let Lifted::Position(position) = formulation.lift(None, parameters, &point)
            && position.residual < CLOSES
        {
            points.extend(point);
        }
    }
    points
}

/// A prepared formulation with parameters: from the cache, where it holds one that passes its check, or made now.
pub fn start_positions(
    formulation: &dyn Formulation,
    system: &System,
    seed: u64,
    cache: Option<&Cache>,
) -> Result<StartPositions, String> {
    let (Some(cache), Some(member)) = (cache, general_member(formulation, seed, 0)) else {
        return prepare(formulation, system, seed);
    };
    let key = Key::of(formulation, &member, seed);
    let mut warnings = Vec::new();
    match cache.find(&key) {
        Entry::Absent => {}
        Entry::Unusable(reason) => warnings.push(reason),
        Entry::Found(kept) => {
            let cached_positions = StartPositions {
                parameters: member.clone(),
                count: (kept.points.len() / system.variables.len().max(1)) as u64,
                are_singular: false,
                points: kept.points,
                others: kept.others,
                settled: true,
                warnings: Vec::new(),
                from_cache: true,
            };
            match cached_positions.fault(formulation, system) {
                None => return Ok(cached_positions),
                Some(fault) => warnings.push(cache.unusable(&key, fault)),
            }
        }
    }
    let mut positions = prepare(formulation, system, seed)?;
    if positions.settled && !positions.are_singular && positions.parameters == member {
        let kept = Kept {
            points: positions.points.clone(),
            others: positions.others.clone(),
        };
        warnings.extend(cache.keep(&key, &kept));
    }
    positions.warnings.extend(warnings);
    Ok(positions)
}

impl StartPositions {
    /// Why these are not the positions at the member's parameters; `None` where they are as far as each shows by itself.
    /// That each is a solution is seen again when a path begins there.
    fn fault(&self, formulation: &dyn Formulation, system: &System) -> Option<&'static str> {
        let dimension = system.variables.len();
        if self.points.is_empty() || !self.points.len().is_multiple_of(dimension) {
            return Some("its points are not whole");
        }
        if formulation
            .family()
            .expected
            .is_some_and(|n| self.count > n)
        {
            return Some("it has more positions than the family");
        }
        let points: Vec<&[Complex64]> = self.points.chunks(dimension).collect();
        for (k, point) in points.iter().enumerate() {
            match formulation.lift(None, &self.parameters, point) {
                Lifted::Position(position) if position.residual < CLOSES => {}
                _ => return Some("one of its points is no position"),
            }
            let near = |other: &&[Complex64]| {
                let pairs = point.iter().zip(*other);
                let (apart, size) = pairs.fold((0.0, 0.0), |(apart, size), (a, b)| {
                    (apart + (a - b).norm_sqr(), size + a.norm_sqr())
                });
                apart <= 1e-16 * size
            };
            if points[..k].iter().any(near) {
                return Some("two of its points are one");
            }
        }
        None
    }
}

/// Parameters of a general complex target of this mechanism; each number gives another one.
fn general_member(formulation: &dyn Formulation, seed: u64, number: u64) -> Option<Vec<Complex64>> {
    formulation.generic(&mut draw(seed, number))
}

/// Random numbers with moduli near 1, and none near 0: lengths and half-tangents of a general member.
pub fn draw(seed: u64, number: u64) -> impl FnMut() -> Complex64 {
    let mut random = RandomStream::new(seed, Purpose::Probe, 0x6d65_6368 + number);
    move || {
        let z = random.unit();
        z * (0.6 + 0.6 * random.uniform())
    }
}

/// Prepares a formulation with parameters. A number that is not the family's is believed when two general
/// members have it.
fn prepare(
    formulation: &dyn Formulation,
    system: &System,
    seed: u64,
) -> Result<StartPositions, String> {
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
    number: u64,
) -> Result<StartPositions, String> {
    let known_member = formulation.known_member();
    let member = general_member(formulation, seed, number);
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
    let (sets, parameters) = match (known_member, member) {
        (Some(known_member), None) => {
            return Ok(StartPositions {
                count: (known_member.points.len() / dimension.max(1)) as u64,
                are_singular: false,
                parameters: known_member.parameters,
                points: known_member.points,
                others: String::new(),
                settled: true,
                warnings: Vec::new(),
                from_cache: false,
            });
        }
        (Some(known_member), Some(member)) => {
            let points = Arc::new(StoredPoints {
                dimension,
                coordinates: known_member.points,
            });
            let options = SolveOptions {
                method: SolveMethod::Given(KnownSolutions {
                    points: None,
                    parameters: Some(known_member.parameters),
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
    let mut points = positions(formulation, system, set, &parameters, false);
    let are_singular = points.is_empty() && set.counts.singular > 0;
    if are_singular && formulation.arm().is_some() {
        points = positions(formulation, system, set, &parameters, true);
    }
    let count = (points.len() / dimension.max(1)) as u64;
    let mut warnings = Vec::new();
    if !set.settled() {
        warnings.push(format!(
            "preparing, of {} paths to a general position of this mechanism: {}; positions may be missing",
            set.paths.total,
            set.counts.complete_reason.as_deref().unwrap_or_default()
        ));
    }
    let is_followed = set.counts.singular == 0 || are_singular && set.counts.singular == count;
    if !is_followed {
        warnings.push(format!(
            "preparing: {} positions of a general target are singular and are not followed",
            set.counts.singular
        ));
    }
    Ok(StartPositions {
        parameters,
        points,
        count,
        others: others(set, count),
        are_singular,
        settled: set.settled() && is_followed,
        warnings,
        from_cache: false,
    })
}

/// Description of the paths that do not end at positions, in words.
fn others(set: &SolutionSet, positions: u64) -> String {
    let paths = &set.paths;
    let kinds = [
        (paths.at_infinity, "at infinity"),
        (
            paths.positive_dimensional.unwrap_or(0),
            "on sets that are no positions",
        ),
        (paths.finite.saturating_sub(positions), "no positions"),
        (paths.removed, "where a denominator is 0"),
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
