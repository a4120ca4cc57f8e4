//! Costs of each start system for a system, and the cheapest start: `cognate info`.

use crate::few_terms_solve;
use crate::limits::{HIGH_DEGREE, MAX_PATHS, MAX_STREAMED_PATHS};
use crate::monomials::not_multiplied_out;
use crate::one_unknown_solve;
use crate::plan_error::PlanError;
use crate::set_structures::{given, guessed, set_names};
pub use crate::start_kind::StartKind;
use cognate_continuation::start_points::StartPoints;
use cognate_continuation::start_systems::exchange::Exchange;
use cognate_continuation::start_systems::grouping::best_grouping;
use cognate_continuation::start_systems::linear_product::SetStructure;
use cognate_continuation::start_systems::polyhedral::affine_supports;
use cognate_continuation::start_systems::polyhedral::mixed_cells::{MixedCellsError, mixed_cells};
use cognate_numeric::counted::counted as with_noun;
use cognate_solutions::streamed::PathFilter;
use cognate_systems::polynomial::{self, Degrees, check_homogeneous, supports};
use cognate_systems::system::{System, VariableGroup};
use cognate_systems::transform::clear_denominators::nonzero_variables;
use cognate_systems::transform::randomize;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A start by the variable groups.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultihomogeneousCost {
    /// Names of the variables, group by group.
    pub groups: Vec<Vec<String>>,
    /// Number of paths.
    pub number: Option<u64>,
}

/// Costs of each start, as `cognate info --format json` prints them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartCosts {
    /// Number of variables.
    pub variables: usize,
    /// Number of equations.
    pub equations: usize,
    /// Degree of each equation.
    pub degrees: Vec<u32>,
    /// Paths of a total-degree start.
    pub total_degree: Option<u64>,
    /// Paths of a start by the groups of the file; where it has one group only,
    /// by the best groups that were found.
    pub multihomogeneous: MultihomogeneousCost,
    /// Paths of a linear-product start.
    pub linear_product: Option<u64>,
    /// Paths of a polyhedral start: the mixed volume, of the supports with the
    /// origin where a solution can have a coordinate 0.
    pub mixed_volume: Option<u64>,
    /// The cheapest that can be used; null where the system cannot be solved.
    pub choice: Option<StartKind>,
    /// Reason for this start, or why none can be used.
    pub why: String,
    /// Reasons why numbers are null, by the names of their fields.
    pub notes: BTreeMap<String, String>,
}

/// Past this many states the table of multihomogeneous choices would take too long.
const MAX_CHOICE_STATES: u64 = 100_000;

/// Reason why a start by groups has half as many paths as its number.
pub(crate) const HALVED: &str = "one of each two that the exchange of groups takes to each other";

/// Reason why a linear-product start is taken: the sets are given.
pub(crate) const SETS_ARE_GIVEN: &str = "the sets are given";

/// Most operations that `cognate info` spends on a mixed volume: a few seconds.
const COUNTING_OPERATIONS: u64 = 2_000_000_000;

/// Most operations that are spent on showing that no groups are worth a search: a tenth of what
/// the search may take.
const LEAST_OPERATIONS: u64 = 10_000_000;

/// The start systems of a system, each with the system as it is tracked by it.
#[derive(Clone, Debug)]
pub struct Starts {
    /// Degrees of the equations that are tracked.
    pub degrees: Degrees,
    /// Numbers of equations before and after they are combined, if they are more than the unknowns.
    pub combined: Option<(usize, usize)>,
    /// Total degree: all affine groups are one.
    pub total_degree: Result<(System, StartPoints, u64), PlanError>,
    /// Start by the groups of the file, or by better ones if it has one affine group.
    pub multihomogeneous: Result<(System, StartPoints, u64), PlanError>,
    /// Whether the groups are not the file's.
    pub found: Option<FoundGroups>,
    /// Start by sets of variables that were found, if it was asked for, or the reason why there are none.
    pub linear_product: Option<Result<(System, StartPoints, u64), String>>,
    /// The mixed volume, where it was asked for, or why it is not known.
    pub mixed_volume: Option<Result<u64, String>>,
    /// Whether an equation of high degree has fewer terms than its degree.
    pub few_terms: bool,
}

/// Certainty about the groups that were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoundGroups {
    /// No other partition of the variables has a smaller number.
    pub exact: bool,
}

impl Starts {
    /// Both starts of a system, or why one does not serve. More equations than unknowns are
    /// combined as the stages of this seed will combine them.
    pub fn of(system: &System, seed: u64) -> Result<Self, PlanError> {
        let degrees = checked_degrees(system)?;
        check_equations(system)?;
        let degrees = tracked_degrees(system, degrees, seed)?;
        let given = |system: &System, degrees: &Degrees| {
            multihomogeneous(system, degrees).map(|(start, count)| (system.clone(), start, count))
        };
        let total_degree = total_degree(system, &degrees);
        // No groups have a smaller number than the mixed volume, which often is counted in a
        // hundredth of the time that the search for them takes (katsura-10).
        let is_least = total_degree.as_ref().is_ok_and(|&(_, _, number)| {
            let operations = LEAST_OPERATIONS.min(number.saturating_mul(50_000));
            system.groups.len() == 1 && mixed_volume(system, operations) == Ok(number)
        });
        let better = match is_least {
            true => None,
            false => grouped(system),
        };
        let (multihomogeneous, found_groups) = match better {
            Some((grouped, exact)) => {
                let degrees = checked_degrees(&grouped)?;
                (given(&grouped, &degrees), Some(FoundGroups { exact }))
            }
            None => (given(system, &degrees), None),
        };
        Ok(Self {
            total_degree,
            multihomogeneous,
            found: found_groups,
            mixed_volume: None,
            linear_product: None,
            few_terms: has_few_terms(system, &degrees),
            combined: (system.equation_count() > system.dimension())
                .then(|| (system.equation_count(), system.dimension())),
            degrees,
        })
    }

    /// Adds the mixed volume, if it might make a difference and that many operations suffice to count it.
    #[must_use]
    pub fn with_mixed_volume(mut self, system: &System, operations: u64) -> Self {
        let few = |count: u64| !polyhedral_is_cheaper(1, count);
        let fewest = [
            self.total_degree.as_ref().map_or(u64::MAX, |t| t.2),
            self.multihomogeneous.as_ref().map_or(u64::MAX, |m| m.2),
        ];
        if !fewest.into_iter().any(few) {
            let paths = fewest.into_iter().min().unwrap_or(u64::MAX);
            // No more than a fraction of what following them would take.
            let operations = operations.min(paths.saturating_mul(50_000));
            self.mixed_volume = Some(mixed_volume(system, operations));
        }
        self
    }

    /// Adds a linear-product start.
    #[must_use]
    pub fn with_linear_product(mut self, system: &System) -> Self {
        let groups = match &self.multihomogeneous {
            Ok((grouped, _, _)) => grouped.groups.as_slice(),
            Err(_) => &[],
        };
        self.linear_product = Some(guessed(system, groups));
        self
    }

    /// Adds a linear-product start by these sets.
    #[must_use]
    pub fn with_sets(mut self, system: &System, sets: &SetStructure) -> Self {
        self.linear_product = Some(given(system, sets));
        self
    }

    /// Whether no point is isolated: there are homogeneous groups, by which the number of paths is 0.
    pub(crate) fn have_no_path(&self) -> bool {
        matches!(
            (&self.total_degree, &self.multihomogeneous),
            (
                Err(PlanError::TotalDegreeNeedsOneGroup),
                Err(PlanError::NoPaths)
            )
        )
    }

    /// Whether the paths by groups are one of each two that a symmetry takes to each other.
    pub(crate) fn halved(&self) -> bool {
        let start = self.multihomogeneous.as_ref();
        start.is_ok_and(|(_, start, _)| start.exchange().is_some())
    }

    fn groups(&self) -> usize {
        self.degrees.by_group.first().map_or(0, Vec::len)
    }

    /// The starts whose paths can be followed, as the end of a sentence that refuses another.
    pub(crate) fn that_would_do(&self, system: &System) -> String {
        let mut names = Vec::new();
        let starts = [
            (StartKind::TotalDegree, &self.total_degree),
            (StartKind::Multihomogeneous, &self.multihomogeneous),
        ];
        for (kind, start) in starts {
            if let Ok((_, _, number)) = start {
                names.push(format!("{kind} with {number}"));
            }
        }
        let product = match &self.linear_product {
            Some(product) => product.clone(),
            None => self
                .clone()
                .with_linear_product(system)
                .linear_product
                .unwrap_or_else(|| Err(String::new())),
        };
        if let Some((_, _, number)) = product.ok().filter(|(.., number)| *number <= MAX_PATHS) {
            names.push(format!("{} with {number}", StartKind::LinearProduct));
        }
        let polyhedral = StartKind::Polyhedral;
        match cell_supports(system).map(|supports| mixed_cells(&supports, 0, COUNTING_OPERATIONS)) {
            Ok(Ok(cells)) if (1..=MAX_PATHS).contains(&cells.mixed_volume) => {
                names.push(format!("{polyhedral} with {}", cells.mixed_volume));
            }
            Ok(Err(MixedCellsError::TooLong)) => {
                names.push(format!("{polyhedral}, whose paths the workers count"));
            }
            _ => {}
        }
        match names.is_empty() {
            true => "; no other start is known to have fewer".to_string(),
            false => format!("; these starts would do: {}", names.join("; ")),
        }
    }

    /// The cheaper one, and why, in words.
    pub fn choose(&self) -> Result<(StartKind, String), PlanError> {
        let bezout = self.cheaper();
        let fewest = match &bezout {
            Ok((StartKind::TotalDegree, _)) => self.total_degree.as_ref().map_or(0, |t| t.2),
            Ok(_) => self.multihomogeneous.as_ref().map_or(0, |m| m.2),
            Err(_) => u64::MAX,
        };
        let polyhedral = match self.mixed_volume {
            // A start by mixed cells has no path where the mixed volume is 0: special coefficients may
            // still have isolated solutions at infinity or sets of solutions, which others meet.
            Some(Ok(volume)) if volume > 0 && polyhedral_is_cheaper(volume, fewest) => Some(volume),
            Some(Ok(volume)) if volume > 0 && volume < fewest && self.has_high_degree() => {
                Some(volume)
            }
            // Coefficients of the same few terms are nearer than products of hundreds of linear forms: 354 paths of two
            // and three terms of degree 192 take 0.06 s by mixed cells, and do not end in 60 s by groups.
            Some(Ok(volume)) if volume > 0 && volume == fewest && self.few_terms => Some(volume),
            _ => None,
        };
        if let Some(Ok((tracked, start, number))) = &self.linear_product
            && *number > 0
            && linear_product_is_cheaper(*number, fewest)
            // Then it has no more paths to infinity than the mixed cells have. Others often end
            // on the sets at infinity where products of forms vanish, and are dear.
            && self.mixed_volume == Some(Ok(*number))
        {
            let sets = set_names(tracked, start);
            let otherwise = match &bezout {
                Ok((kind, _)) => format!("{fewest} by the {kind} start"),
                Err(error) => error.to_string(),
            };
            let why = format!("{} by {sets}; {otherwise}", with_noun(*number, "path"));
            return Ok((StartKind::LinearProduct, why));
        }
        if let Some(volume) = polyhedral {
            let otherwise = match &bezout {
                Ok((kind, _)) => format!("{fewest} by the {kind} start"),
                Err(error) => error.to_string(),
            };
            let why = format!("mixed volume {volume}, each path in two legs; {otherwise}");
            return Ok((StartKind::Polyhedral, why));
        }
        let (kind, why) = bezout?;
        let why = match (kind, self.halved()) {
            (StartKind::Multihomogeneous, true) => format!("{why}; {HALVED}"),
            _ => why,
        };
        let why = match self.combined {
            Some((equations, unknowns)) => {
                let combinations = with_noun(unknowns, "combination");
                format!("{why}, of {combinations} of the {equations} equations")
            }
            None => why,
        };
        Ok((kind, why))
    }

    /// Whether paths to infinity may run there in cycles of very many sheets, which take long and are hard to tell from
    /// solutions.
    fn has_high_degree(&self) -> bool {
        self.degrees
            .total
            .iter()
            .any(|&degree| degree >= HIGH_DEGREE)
    }

    fn cheaper(&self) -> Result<(StartKind, String), PlanError> {
        if let (Some(found_groups), Ok((grouped, _, multi))) = (self.found, &self.multihomogeneous)
        {
            // One group of all was among those that were tried.
            let total = match &self.total_degree {
                Ok((_, _, total)) => total.to_string(),
                Err(_) => "too many".to_string(),
            };
            let groups: Vec<String> = group_names(grouped)
                .iter()
                .map(|names| format!("{{{}}}", names.join(", ")))
                .collect();
            return Ok((
                StartKind::Multihomogeneous,
                format!(
                    "{} by the groups {}, {}; {total} by total degree",
                    with_noun(*multi, "path"),
                    groups.join(" "),
                    if found_groups.exact {
                        "the best of all"
                    } else {
                        "the best that were found"
                    },
                ),
            ));
        }
        match (&self.total_degree, &self.multihomogeneous) {
            (Ok((_, _, total)), Ok((_, _, multi))) if multi < total => Ok((
                StartKind::Multihomogeneous,
                format!(
                    "{} by the variable groups, {total} by total degree",
                    with_noun(*multi, "path")
                ),
            )),
            (Ok((_, _, total)), Ok((_, _, multi))) if multi > total => Ok((
                StartKind::TotalDegree,
                format!(
                    "{} by total degree, {multi} by the variable groups",
                    with_noun(*total, "path")
                ),
            )),
            // Where both cost the same, the groups are the better coordinates: a
            // solution that is large in one of them is not large in all.
            (Ok(_), Ok((_, _, multi))) if self.groups() > 1 => Ok((
                StartKind::Multihomogeneous,
                format!(
                    "{}, by the variable groups as by total degree",
                    with_noun(*multi, "path")
                ),
            )),
            (Ok((_, _, total)), Ok(_)) => Ok((
                StartKind::TotalDegree,
                format!(
                    "{}; the variable groups save none",
                    with_noun(*total, "path")
                ),
            )),
            (Ok((_, _, total)), Err(_)) => Ok((
                StartKind::TotalDegree,
                format!("{} by total degree", with_noun(*total, "path")),
            )),
            (Err(_), Ok((_, _, multi))) => Ok((
                StartKind::Multihomogeneous,
                format!("{} by the variable groups", with_noun(*multi, "path")),
            )),
            (Err(error), Err(_)) => Err(error.clone()),
        }
    }
}

impl StartCosts {
    /// The costs of every start; an error only where the equations are no polynomials.
    pub fn of(system: &System) -> Result<Self, PlanError> {
        Self::with_sets(system, None)
    }

    /// The costs of every start, with the linear-product start by given sets. That start then is the choice, as it is
    /// for a solve. An error also where the sets do not serve.
    pub fn with_sets(system: &System, sets: Option<&SetStructure>) -> Result<Self, PlanError> {
        let degrees = checked_degrees(system)?;
        let mut notes = BTreeMap::new();
        let counted = mixed_volume(system, COUNTING_OPERATIONS);
        if let Err(why) = &counted {
            notes.insert("mixed_volume".into(), why.clone());
        }
        let mixed_volume = counted.clone().ok();
        // Degrees of combinations are the same for almost every seed.
        let starts = Starts::of(system, 0).map(|starts| Starts {
            mixed_volume: Some(counted),
            ..match sets {
                Some(sets) => starts.with_sets(system, sets),
                None => starts.with_linear_product(system),
            }
        });
        let product = starts.as_ref().ok().and_then(|s| s.linear_product.as_ref());
        let (linear_product, note) = match product {
            Some(Ok((tracked, start, number))) => (Some(*number), set_names(tracked, start)),
            Some(Err(why)) if sets.is_some() => {
                return Err(PlanError::NoLinearProduct(why.clone()));
            }
            Some(Err(why)) => (None, why.clone()),
            None => (None, "the system cannot be solved".to_string()),
        };
        notes.insert("linear_product".into(), note);
        let mut number = |name: &str, number: Result<u64, PlanError>| match number {
            Ok(number) => Some(number),
            // A number is a number, even where it is too large or too small to be used.
            Err(PlanError::TooManyPaths {
                number: Some(number),
                ..
            }) => Some(number),
            Err(PlanError::NoPaths) => Some(0),
            Err(error) => {
                notes.insert(name.to_string(), error.to_string());
                None
            }
        };
        let (total, multi) = match &starts {
            Ok(starts) => (
                starts.total_degree.as_ref().map(|t| t.2),
                starts.multihomogeneous.as_ref().map(|m| m.2),
            ),
            Err(error) => (Err(error), Err(error)),
        };
        let total_degree = number("total_degree", total.map_err(Clone::clone));
        let multihomogeneous = number("multihomogeneous", multi.map_err(Clone::clone));
        let tracked = match &starts {
            Ok(Starts {
                multihomogeneous: Ok((tracked, _, _)),
                ..
            }) => tracked,
            _ => system,
        };
        let groups = group_names(tracked);
        if let Ok(Starts {
            found: Some(found_groups),
            ..
        }) = &starts
        {
            let how = match found_groups.exact {
                true => "groups found: the best partition of the variables",
                false => "groups found by a search that is not exhaustive",
            };
            notes.insert("groups".into(), how.into());
        }
        let chosen = match (sets, &linear_product) {
            (None, _) if one_unknown_solve::suits(system) => {
                Ok((StartKind::OneUnknown, one_unknown_solve::WHY.to_string()))
            }
            (None, _) if system.parameters.is_empty() && few_terms_solve::suits(system, &[]) => {
                Ok((StartKind::FewTerms, few_terms_solve::WHY.to_string()))
            }
            (Some(_), Some(_)) => Ok((StartKind::LinearProduct, SETS_ARE_GIVEN.to_string())),
            _ => starts.and_then(|starts| starts.choose()),
        };
        let (choice, why) = match chosen {
            Ok((choice, why)) => (Some(choice), why),
            Err(error) => (None, error.to_string()),
        };
        Ok(Self {
            variables: system.variables.len(),
            equations: system.equations.len(),
            degrees: degrees.total,
            total_degree,
            multihomogeneous: MultihomogeneousCost {
                groups,
                number: multihomogeneous,
            },
            linear_product,
            mixed_volume,
            choice,
            why,
            notes,
        })
    }
}

/// The mixed volume that bounds the isolated solutions in C^n, or why it is not known.
pub(crate) fn mixed_volume(system: &System, operations: u64) -> Result<u64, String> {
    let cells = mixed_cells(&cell_supports(system)?, 0, operations);
    cells
        .map(|cells| cells.mixed_volume)
        .map_err(|error| match error {
            MixedCellsError::TooLong => {
                format!("{error} here; the start `polyhedral` counts on the workers")
            }
            other => other.to_string(),
        })
}

/// Whether an equation of high degree has fewer terms than its degree, where as many equations are tracked as are
/// given.
fn has_few_terms(system: &System, degrees: &Degrees) -> bool {
    let is_high = |degree: &u32| *degree >= HIGH_DEGREE;
    if !degrees.total.iter().any(is_high) || system.equation_count() != degrees.total.len() {
        return false;
    }
    let supports = supports(system).unwrap_or_default();
    let mut pairs = supports.iter().zip(&degrees.total);
    pairs.any(|(terms, degree)| is_high(degree) && terms.len() < *degree as usize)
}

/// The supports whose mixed cells a polyhedral start has, or why there are none.
pub(crate) fn cell_supports(system: &System) -> Result<Vec<Vec<Vec<i64>>>, String> {
    if system.groups.iter().any(|group| group.homogeneous) {
        return Err("not counted for homogeneous groups".into());
    }
    if system.equation_count() > system.dimension() {
        return Err("not counted for combinations of equations".into());
    }
    let supports = supports(system).ok_or_else(|| not_multiplied_out(system))?;
    Ok(affine_supports(&supports, &nonzero_variables(system)))
}

/// Whether two legs for each of `volume` paths cost less than one for each of `count`.
///
/// Paths of a total-degree start that end at infinity are the dear ones, and a polyhedral start
/// has few of them; so the second leg is not counted in full.
pub(crate) fn polyhedral_is_cheaper(volume: u64, count: u64) -> bool {
    count > 16 && volume.saturating_add(volume / 2) < count
}

/// Whether a linear-product start, whose equations are dearer, costs less than another with
/// `count` paths.
fn linear_product_is_cheaper(number: u64, count: u64) -> bool {
    count > 16 && number > 0 && number.saturating_add(number / 8) < count
}

/// Names of the variables, group by group.
fn group_names(system: &System) -> Vec<Vec<String>> {
    let name = |&v: &usize| system.variables[v].clone();
    system
        .groups
        .iter()
        .map(|group| group.variables.iter().map(name).collect())
        .collect()
}

/// The system in the groups that cost least, and whether none cost less, where
/// the file has one affine group and others cost less than it.
fn grouped(system: &System) -> Option<(System, bool)> {
    let [affine_group] = system.groups.as_slice() else {
        return None;
    };
    if affine_group.homogeneous {
        return None;
    }
    let best = best_grouping(&supports(system)?, system.variable_count())?;
    if best.groups.len() < 2 {
        return None;
    }
    let mut grouped = system.clone();
    grouped.groups = best
        .groups
        .into_iter()
        .map(|variables| VariableGroup {
            variables,
            homogeneous: false,
        })
        .collect();
    Some((grouped, best.exact))
}

/// Degrees of a system that is polynomial, and homogeneous where it says so.
pub(crate) fn checked_degrees(system: &System) -> Result<Degrees, PlanError> {
    let degrees = polynomial::degrees(system)?;
    check_homogeneous(system, &degrees)?;
    Ok(degrees)
}

/// At least as many equations as there are unknowns.
pub(crate) fn check_equations(system: &System) -> Result<(), PlanError> {
    let (equations, unknowns) = (system.equation_count(), system.dimension());
    if equations < unknowns {
        return Err(PlanError::FewerEquations {
            equations,
            unknowns,
        });
    }
    Ok(())
}

/// Degrees of the equations that are tracked: the system's own, or those of combinations of them
/// where they are more than the unknowns.
fn tracked_degrees(system: &System, degrees: Degrees, seed: u64) -> Result<Degrees, PlanError> {
    if system.equation_count() == system.dimension() {
        return Ok(degrees);
    }
    Ok(polynomial::degrees(&randomize(system, &degrees, seed))?)
}

fn total_degree(
    system: &System,
    degrees: &Degrees,
) -> Result<(System, StartPoints, u64), PlanError> {
    let mut tracked = system.clone();
    if system.groups.len() > 1 {
        if system.groups.iter().any(|group| group.homogeneous) {
            return Err(PlanError::TotalDegreeNeedsOneGroup);
        }
        tracked.groups = vec![VariableGroup {
            variables: (0..system.variables.len()).collect(),
            homogeneous: false,
        }];
    }
    let start = StartPoints::TotalDegree {
        degrees: degrees.total.clone(),
    };
    let count = counted(system, &start, StartKind::TotalDegree)?;
    Ok((tracked, start, count))
}

fn multihomogeneous(system: &System, degrees: &Degrees) -> Result<(StartPoints, u64), PlanError> {
    let dimensions: Vec<u32> = system
        .groups
        .iter()
        .map(|group| (group.variables.len() - usize::from(group.homogeneous)) as u32)
        .collect();
    let states = dimensions
        .iter()
        .try_fold(1u64, |product, &d| product.checked_mul(u64::from(d) + 1));
    if states.is_none_or(|states| states > MAX_CHOICE_STATES) {
        return Err(PlanError::TooManyGroups {
            groups: dimensions.len(),
        });
    }
    // Random combinations of equations have no symmetry.
    let square = system.equation_count() == system.dimension();
    let start = StartPoints::Multihomogeneous {
        degrees: degrees.by_group.clone(),
        dimensions,
        exchange: square
            .then(|| Exchange::of(system, &degrees.by_group))
            .flatten(),
    };
    let count = counted(system, &start, StartKind::Multihomogeneous)?;
    Ok((start, count))
}

fn counted(system: &System, start: &StartPoints, kind: StartKind) -> Result<u64, PlanError> {
    // Images, orbits and named sets need all results.
    let streamed = PathFilter::suits(system) && start.exchange().is_none();
    let limit = if streamed {
        MAX_STREAMED_PATHS
    } else {
        MAX_PATHS
    };
    match start.count() {
        Some(0) => Err(PlanError::NoPaths),
        Some(number) if number <= limit => Ok(number),
        number => Err(PlanError::TooManyPaths {
            start: kind,
            number,
            instead: String::new(),
        }),
    }
}
