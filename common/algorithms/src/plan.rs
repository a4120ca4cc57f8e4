//! From a system and options to an algorithm that solves it, or to a clear reason why not.

use crate::any_algorithm::{AnyAlgorithm, AnySolve};
use crate::closings::Closing;
use crate::closings::certificates::Certificates;
use crate::closings::digits::Digits;
use crate::coefficient_family::{CoefficientFamily, coefficient_family};
use crate::coefficients::Coefficients;
use crate::decomposition::{DecompositionOptions, DecompositionSolve};
use crate::exact_count::ExactCounting;
use crate::few_terms_solve::{self, few_terms_solve};
pub use crate::given_start::GivenStart;
use crate::given_start::check_given;
use crate::limits::CHOOSING_OPERATIONS;
pub use crate::limits::{MAX_PATHS, MAX_STREAMED_PATHS, PLANNING_OPERATIONS};
use crate::monodromy::{LoopLimits, LoopStart, MonodromySolve, trace};
use crate::one_unknown_solve::{self, one_unknown_solve};
use crate::overdetermined_solve::OverdeterminedSolve;
use crate::parameter_solve::ParameterSolve;
use crate::plan_error::{PlanError, checked_volume};
use crate::polyhedral_solve::PolyhedralSolve;
use crate::regeneration_solve::{Levels, RegenerationSolve};
use crate::sampled_ends::SampledEnds;
use crate::set_structures::set_names;
pub use crate::solve_options::{
    ClosingOptions, KnownSolutions, MonodromyOptions, SolveMethod, SolveOptions, TrackingOptions,
};
use crate::solve_without_paths::{NO_PATHS, SolveWithoutPaths};
use crate::start_costs::{
    HALVED, SETS_ARE_GIVEN, StartKind, Starts, cell_supports, check_equations, checked_degrees,
};
use crate::start_pair::start_pair;
use crate::zero_dimensional_solve::ZeroDimensionalSolve;
use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::start_systems::polyhedral::branches::CellBranches;
use cognate_continuation::start_systems::polyhedral::mixed_cells::{MixedCellsError, mixed_cells};
use cognate_continuation::start_systems::slices;
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, Work};
use cognate_solutions::sharpened::DIGITS_OF_DOUBLES;
use cognate_solutions::streamed::PathFilter;
use cognate_solutions::witness::Method;
use cognate_systems::expression::Dependence;
use cognate_systems::polynomial::has_rounded_numbers;
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::ZERO_DENOMINATOR;
use num_complex::Complex64;

/// Largest least-squares correction at a regular end, relative to its size, that is rounding where the equations are exact:
/// corrections are computed with the digits of double-doubles, and ends have those of doubles. See
/// [`Tolerances::excess_floor`](cognate_solutions::classification::Tolerances::excess_floor).
const EXACT_EXCESS_FLOOR: f64 = 1e-12;

/// Worst relative accuracy of coefficients that paths reckon with, that of eight digits. One that is worse, because
/// nearly equal decimals were subtracted, is that of single coefficients.
const WORST_TRACKED: f64 = 5e-8;

/// Plan of a solve: the tracked system, the algorithm and the start.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The system as it is tracked: a total-degree start makes one group of all,
    /// another may make several of one.
    /// Workers, results and solution sets all go by this one.
    pub system: System,
    /// Algorithm that solves the system.
    pub algorithm: AnyAlgorithm,
    /// Start of the paths.
    pub start: StartKind,
    /// Number of paths of the first stage that tracks some; `None` where workers count them.
    pub paths: Option<u64>,
    /// Reason for this start.
    pub why: String,
}

/// The plan for a system that has been checked.
pub fn plan(system: &System, options: &SolveOptions) -> Result<Plan, PlanError> {
    check_parameters(system, options)?;
    if let Some(index) = (0..system.equations.len())
        .find(|&i| system.expressions.dependence(system.equations[i]) == Dependence::Parameters)
    {
        let name = system.equation_names.get(index).cloned();
        return Err(PlanError::ConstrainedParameters(
            name.unwrap_or_else(|| format!("equation {}", index + 1)),
        ));
    }
    let start_solutions = options.method.known_solutions();
    let ends = start_solutions
        .and_then(|start_solutions| start_solutions.parameters.as_ref())
        .into_iter();
    let coefficients = Coefficients::of(system, ends.chain(options.target_parameters.first()));
    let in_units = coefficients.in_units(system);
    let system = &*in_units;
    let settings = coefficients.resolved(&options.tracking.settings);
    let resolved = resolved_tracking(&options.tracking, settings).map(|tracking| SolveOptions {
        tracking,
        ..options.clone()
    });
    let options = resolved.as_ref().unwrap_or(options);
    let mut plan = match &options.method {
        SolveMethod::Monodromy(loops) => plan_monodromy(system, loops, options),
        SolveMethod::Given(start_solutions) => plan_given(system, start_solutions, options),
        _ if system.path_variable.is_some() => Err(PlanError::HomotopyWithoutStart),
        start => plan_start_system(system, start, options),
    }?;
    let closings = options.closings;
    let counting = ExactCounting {
        switched_off: closings.no_exact_count,
        // Start points lead to some of the solutions, which need not be all.
        parameters: match (&options.method, options.target_parameters.as_slice()) {
            (SolveMethod::Given(_) | SolveMethod::Monodromy(_), _) => Vec::new(),
            (_, [values]) => values.clone(),
            _ => Vec::new(),
        },
        settles_doubts: settles_doubts(system, options),
        paths_follow_equations: plan.start == StartKind::Regeneration,
    };
    let algorithm = plan.algorithm.with_counting(counting);
    plan.algorithm = algorithm.with_data_accuracy(options.tracking.tolerances.data_accuracy);
    let digits = closings.digits.unwrap_or(DIGITS_OF_DOUBLES);
    let more_digits = digits > DIGITS_OF_DOUBLES || closings.deflate;
    if (more_digits || closings.certify) && plan.paths.is_some_and(|paths| paths > MAX_PATHS) {
        // Closings take all endpoints at once.
        return Err(PlanError::TooManyPaths {
            start: plan.start,
            number: plan.paths,
            instead: String::new(),
        });
    }
    // Solutions that are computed without paths have all digits that are asked for.
    if more_digits && !plan.start.is_without_paths() {
        let digits = Digits::new(digits, closings.deflate);
        plan.algorithm.close_with(Closing::Digits(digits));
    }
    if closings.certify {
        let certificates = Certificates::default();
        plan.algorithm
            .close_with(Closing::Certificates(certificates));
    }
    if closings.approximate {
        plan.algorithm.close_with(Closing::Approximate);
    }
    Ok(plan)
}

/// Whether no path is put aside where all solutions are known without it.
fn follows_all_paths(options: &SolveOptions) -> bool {
    options.closings.no_exact_count || options.closings.approximate
}

/// Whether all solutions of exact equations are asked for, and nothing that is said of paths.
fn asks_for_exact_solutions(system: &System, options: &SolveOptions) -> bool {
    let settings = &options.tracking.settings;
    let is_exact = settings.error_of_data() == 0.0
        && (options.numbers_are_exact || !has_rounded_numbers(system));
    let asks_for_all = !matches!(
        options.method,
        SolveMethod::Given(_) | SolveMethod::Monodromy(_)
    );
    let is_plain = system.path_variable.is_none()
        && system.symmetry.is_empty()
        && system.helpers.is_empty()
        && system
            .degenerate
            .keys()
            .all(|name| name == ZERO_DENOMINATOR);
    is_exact
        && asks_for_all
        && is_plain
        && !options.closings.no_exact_count
        && !options.closings.approximate
        && options.target_parameters.len() <= 1
}

/// Whether the equations may be solved without paths where these leave an answer in doubt: all solutions of exact
/// equations are asked for, and nothing that is said of paths or of the points where they end.
fn settles_doubts(system: &System, options: &SolveOptions) -> bool {
    let closings = &options.closings;
    let closes = closings.certify || closings.deflate || closings.digits.is_some();
    asks_for_exact_solutions(system, options) && !closes
}

/// Options of tracking with these settings, which the coefficients ask for; `None` where none change. Exact equations are
/// solved exactly, or not at all.
fn resolved_tracking(
    tracking: &TrackingOptions,
    settings: Option<Settings>,
) -> Option<TrackingOptions> {
    let resolved_settings = settings.as_ref().unwrap_or(&tracking.settings);
    let is_exact = resolved_settings.exact_data;
    let data_accuracy = resolved_settings.error_of_data();
    if settings.is_none() && !is_exact && data_accuracy == 0.0 {
        return None;
    }
    let mut resolved = tracking.clone();
    resolved.settings = settings.unwrap_or(resolved.settings);
    resolved.tolerances.data_accuracy = data_accuracy;
    if is_exact {
        resolved.tolerances.excess_floor = EXACT_EXCESS_FLOOR;
    } else {
        resolved.settings.data_accuracy = data_accuracy.min(WORST_TRACKED);
    }
    Some(resolved)
}

fn check_parameters(system: &System, options: &SolveOptions) -> Result<(), PlanError> {
    let expected = system.parameters.len();
    // A path variable's own value is not asked for where it is the only parameter.
    let only_path_variable = system.path_variable.is_some() && expected == 1;
    let start_solutions = options.method.known_solutions();
    let starts = start_solutions.and_then(|start_solutions| start_solutions.parameters.as_ref());
    let targets = options.target_parameters.iter();
    let sets = starts.map(|set| ("the start parameters", set)).into_iter();
    let sets = sets.chain(targets.map(|set| ("the target parameters", set)));
    for (what, set) in sets {
        let length = set.len();
        if length != expected && !(only_path_variable && length == 0) {
            return Err(PlanError::ParameterCount {
                what,
                found: length,
                expected,
            });
        }
        if set.iter().any(|z| !z.re.is_finite() || !z.im.is_finite()) {
            return Err(PlanError::NotFinite { what });
        }
    }
    Ok(())
}

/// Values of the parameters where there is one set of them.
fn one_target(system: &System, options: &SolveOptions) -> Result<Vec<Complex64>, PlanError> {
    let zero = Complex64::new(0.0, 0.0);
    match options.target_parameters.as_slice() {
        [set] if set.len() == system.parameters.len() => {
            let mut values = set.clone();
            // The path variable's own value is not asked for; solutions are wanted where it is 0.
            if let Some(t) = system.path_variable {
                values[t] = zero;
            }
            Ok(values)
        }
        [] | [_] => {
            let free: Vec<&str> = (0..system.parameters.len())
                .filter(|&k| system.path_variable != Some(k))
                .map(|k| system.parameters[k].as_str())
                .collect();
            if free.is_empty() {
                Ok(vec![zero; system.parameters.len()])
            } else {
                Err(PlanError::ParametersWithoutValues {
                    names: free.join(", "),
                })
            }
        }
        several => Err(PlanError::SeveralTargets(several.len())),
    }
}

fn plan_start_system(
    system: &System,
    method: &SolveMethod,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    let parameters = one_target(system, options)?;
    if *method == SolveMethod::Auto
        && let Some(plan) = plan_without_paths(system, &parameters, options)
    {
        return Ok(plan);
    }
    if *method == SolveMethod::Polyhedral {
        return plan_polyhedral(system, parameters, "asked for".to_string(), options);
    }
    let mut starts = Starts::of(system, options.seed)?;
    if *method == SolveMethod::Regeneration {
        return plan_regeneration(starts, parameters, None, options);
    }
    if *method == SolveMethod::Auto {
        starts = starts.with_mixed_volume(system, CHOOSING_OPERATIONS);
    }
    starts = match method {
        SolveMethod::LinearProduct(Some(sets)) => starts.with_sets(system, sets),
        SolveMethod::Auto | SolveMethod::LinearProduct(None) => starts.with_linear_product(system),
        _ => starts,
    };
    if *method == SolveMethod::Auto && starts.have_no_path() {
        let solve = SolveWithoutPaths::without_solutions(system, &parameters, options);
        return solve
            .map(|solve| of_no_paths(system, solve, StartKind::Multihomogeneous, NO_PATHS));
    }
    let (kind, why) = start_kind(system, method, &starts)?;
    if kind == StartKind::Polyhedral {
        return plan_polyhedral(system, parameters, why, options);
    }
    let (tracked, start_points) = tracked_start(system, kind, &mut starts)?;
    let homotopy = HomotopyKind::StraightLine {
        parameters: parameters.clone(),
    };
    let first = first_stage(homotopy, start_points, options);
    if *method == SolveMethod::Auto
        && !options.closings.approximate
        && let Some(few) = SampledEnds::of_few(&tracked, &first, &options.tracking.tolerances)
    {
        let few_ends = format!("{few} by the {kind} start");
        if let Some(plan) = plan_overdetermined(system, (&tracked, &first), &few_ends, options) {
            return Ok(plan);
        }
        if let Some(plan) = plan_tied_loops(system, &few_ends, options) {
            return plan;
        }
        // Levels are of one group.
        if !few.are_singular() && starts.total_degree.is_ok() {
            return plan_regeneration(starts, parameters, Some(few_ends), options);
        }
    }
    Ok(finish(tracked, first, kind, why, options))
}

/// The start that was asked for, or the one with the fewest paths, and the reason for it.
fn start_kind(
    system: &System,
    method: &SolveMethod,
    starts: &Starts,
) -> Result<(StartKind, String), PlanError> {
    match method {
        SolveMethod::TotalDegree => Ok((StartKind::TotalDegree, "asked for".to_string())),
        SolveMethod::Multihomogeneous => {
            let why = if starts.halved() {
                format!("asked for; {HALVED}")
            } else {
                "asked for".to_string()
            };
            Ok((StartKind::Multihomogeneous, why))
        }
        SolveMethod::LinearProduct(given_sets) => {
            let sets = starts.linear_product.as_ref();
            let sets = sets.and_then(|start| start.as_ref().ok());
            let sets = sets.map_or(String::new(), |(tracked, start, _)| {
                set_names(tracked, start)
            });
            let asked = match given_sets {
                Some(_) => SETS_ARE_GIVEN,
                None => "asked for",
            };
            Ok((StartKind::LinearProduct, format!("{asked}; {sets}")))
        }
        _ => starts
            .choose()
            .map_err(|error| with_other_starts(error, system, starts)),
    }
}

/// The system as the start tracks it, and the start points.
fn tracked_start(
    system: &System,
    kind: StartKind,
    starts: &mut Starts,
) -> Result<(System, StartPoints), PlanError> {
    let start = match kind {
        StartKind::TotalDegree => starts.total_degree.clone(),
        StartKind::LinearProduct => {
            let start = starts.linear_product.take();
            return linear_product_start(start);
        }
        _ => starts.multihomogeneous.clone(),
    };
    let (tracked, start, _) = start.map_err(|error| with_other_starts(error, system, starts))?;
    Ok((tracked, start))
}

/// The system and the start points of a linear-product start, where it has paths, and not too many.
fn linear_product_start(
    start: Option<Result<(System, StartPoints, u64), String>>,
) -> Result<(System, StartPoints), PlanError> {
    let none = || Err("it was not asked for".to_string());
    let (tracked, start, count) = start
        .unwrap_or_else(none)
        .map_err(PlanError::NoLinearProduct)?;
    if count == 0 {
        let why = "it has no path: a system with these sets has no isolated solution unless its \
                   coefficients are special";
        return Err(PlanError::NoLinearProduct(why.into()));
    }
    if count > MAX_PATHS {
        return Err(PlanError::TooManyPaths {
            start: StartKind::LinearProduct,
            number: Some(count),
            instead: String::new(),
        });
    }
    Ok((tracked, start))
}

/// The error of a start with too many paths names the starts that would do.
fn with_other_starts(error: PlanError, system: &System, starts: &Starts) -> PlanError {
    match error {
        PlanError::TooManyPaths { start, number, .. } => PlanError::TooManyPaths {
            start,
            number,
            instead: starts.that_would_do(system),
        },
        other => other,
    }
}

/// The solutions of a system that needs no paths; `None` where it is left to them.
fn plan_without_paths(
    system: &System,
    parameters: &[Complex64],
    options: &SolveOptions,
) -> Option<Plan> {
    let of_one_unknown = one_unknown_solve(system, parameters, options)
        .map(|solve| (solve, StartKind::OneUnknown, one_unknown_solve::WHY));
    let (solve, start, why) = of_one_unknown.or_else(|| {
        let may_be_solved = asks_for_exact_solutions(system, options);
        let solve = may_be_solved.then(|| few_terms_solve(system, parameters, options))?;
        Some((solve?, StartKind::FewTerms, few_terms_solve::WHY))
    })?;
    Some(of_no_paths(system, solve, start, why))
}

fn of_no_paths(system: &System, solve: SolveWithoutPaths, start: StartKind, why: &str) -> Plan {
    Plan {
        system: system.clone(),
        paths: Some(solve.paths()),
        algorithm: AnyAlgorithm::from(AnySolve::WithoutPaths(Box::new(solve))),
        start,
        why: why.to_string(),
    }
}

/// Plan by the mixed cells of a system with as many equations as unknowns.
fn plan_polyhedral(
    system: &System,
    parameters: Vec<Complex64>,
    why: String,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    checked_degrees(system)?;
    check_equations(system)?;
    let supports = cell_supports(system).map_err(PlanError::NoMixedCells)?;
    // As workers enumerate them: with this lifting it can be done.
    let volume = match mixed_cells(&supports, options.seed, options.counting_operations) {
        Ok(cells) => Some(checked_volume(cells.mixed_volume)?),
        // Workers take wider liftings, which have no ties.
        Err(MixedCellsError::TooLong | MixedCellsError::NoLifting) => None,
        Err(error) => return Err(PlanError::NoMixedCells(error.to_string())),
    };
    let first = Stage::new(
        Work::Track,
        HomotopyKind::Toric,
        StartPoints::MixedCells {
            count: volume.unwrap_or_default(),
            branches: volume.is_none().then(|| CellBranches::uncounted(0)),
        },
        options.tracking.settings.clone(),
        options.seed,
    );
    let tolerances = options.tracking.tolerances.clone();
    let solve = PolyhedralSolve::new(first, system, parameters, tolerances);
    let solve = match follows_all_paths(options) {
        true => solve,
        false => solve.regular_ends_first(system, settles_doubts(system, options)),
    };
    Ok(Plan {
        system: system.clone(),
        algorithm: AnySolve::Polyhedral(Box::new(
            solve.with_max_retries(options.tracking.max_retries),
        ))
        .into(),
        start: StartKind::Polyhedral,
        paths: volume,
        why: match volume {
            Some(_) => why,
            None => format!("{why}; the mixed cells are counted by workers"),
        },
    })
}

/// Plan for more equations than unknowns, by the solutions of the first equations that each further equation keeps. It
/// is given the first stage of another start, with the combinations that the stage tracks, and the reason against it.
fn plan_overdetermined(
    system: &System,
    (tracked, first): (&System, &Stage),
    why: &str,
    options: &SolveOptions,
) -> Option<Plan> {
    let homogeneous = system.groups.iter().any(|group| group.homogeneous);
    if homogeneous || system.equation_count() <= system.dimension() {
        return None;
    }
    let tracking = &options.tracking;
    let parameters = first.homotopy.end_parameters(0, system.path_variable)?;
    let isolated = DecompositionOptions {
        seed: options.seed,
        parameters: parameters.into_owned(),
        dimensions: Some(0..=0),
        method: Some(Method::Equations),
        settings: tracking.settings.clone(),
        tolerances: tracking.tolerances.clone(),
        max_retries: tracking.max_retries,
        ..DecompositionOptions::default()
    };
    let decomposition = DecompositionSolve::new(system, &isolated).ok()?;
    let tolerances = tracking.tolerances.clone();
    let solve = OverdeterminedSolve::new(decomposition, first.clone(), tracked, tolerances);
    Some(Plan {
        system: tracked.clone(),
        algorithm: AnySolve::Overdetermined(Box::new(solve)).into(),
        start: StartKind::Regeneration,
        paths: None,
        why: format!("{why}; what each equation leaves of the sets of those before"),
    })
}

/// Equation by equation, the lower degrees first. `chosen`: why, where it was not asked for.
fn plan_regeneration(
    starts: Starts,
    parameters: Vec<Complex64>,
    chosen: Option<String>,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    // A bound of the paths on every level.
    let (tracked, _, bound) = starts.total_degree?;
    let degrees = starts.degrees.total;
    let mut order: Vec<u32> = (0..degrees.len() as u32).collect();
    order.sort_by_key(|&i| degrees[i as usize]);
    let levels = Levels {
        degrees: order.iter().map(|&i| degrees[i as usize]).collect(),
        order,
        parameters,
        settings: options.tracking.settings.clone(),
        seed: options.seed,
        asked_for: chosen.is_none(),
    };
    let point =
        slices::common_point(options.seed, tracked.variables.len()).ok_or(PlanError::NoPaths)?;
    // The forms are those of the unknowns that are tracked.
    let point = tracked.scaling.to_variables(&point);
    let paths = u64::from(levels.degrees[0].saturating_sub(1).max(1));
    let tolerances = options.tracking.tolerances.clone();
    let solve = RegenerationSolve::new(levels, point, &tracked, tolerances);
    Ok(Plan {
        system: tracked,
        algorithm: AnySolve::Regeneration(Box::new(
            solve.with_max_retries(options.tracking.max_retries),
        ))
        .into(),
        start: StartKind::Regeneration,
        paths: Some(paths),
        why: format!(
            "{}; equation by equation, at most {bound} paths on a level; solutions that \
             are singular, or become so on the way, may be missed",
            chosen.as_deref().unwrap_or("asked for")
        ),
    })
}

fn plan_given(
    system: &System,
    start_solutions: &KnownSolutions,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    let start = start_solutions.points.ok_or(PlanError::NoStartPoints)?;
    check_given(system, &start)?;
    checked_degrees(system)?;
    check_equations(system)?;
    let homotopy = if system.path_variable.is_some() {
        HomotopyKind::PathVariable {
            parameters: one_target(system, options)?,
        }
    } else if system.parameters.is_empty() {
        return Err(PlanError::NothingToDeform);
    } else {
        let from = start_solutions.parameters.clone();
        let from = from.ok_or(PlanError::NoStartParameters)?;
        if options.target_parameters.is_empty() {
            return Err(PlanError::ParametersWithoutValues {
                names: system.parameters.join(", "),
            });
        }
        HomotopyKind::Parameter {
            start: from,
            targets: options.target_parameters.clone(),
        }
    };
    let number = start.count.checked_mul(homotopy.targets());
    // Orbits and named sets need all results.
    let limit = match PathFilter::suits(system) {
        true => MAX_STREAMED_PATHS,
        false => MAX_PATHS,
    };
    if number.is_none_or(|number| number > limit) {
        return Err(PlanError::TooManyPaths {
            start: StartKind::Given,
            number,
            instead: String::new(),
        });
    }
    let start_points = StartPoints::Stored {
        object: start.object,
        count: start.count,
    };
    let why = "start solutions are given".to_string();
    let first = first_stage(homotopy, start_points, options);
    Ok(finish(
        system.clone(),
        first,
        StartKind::Given,
        why,
        options,
    ))
}

fn plan_monodromy(
    system: &System,
    loops: &MonodromyOptions,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    if system.path_variable.is_some() {
        return Err(PlanError::MonodromyOfHomotopy);
    }
    if system.parameters.is_empty() {
        return plan_coefficient_loops(system, loops, options);
    }
    checked_degrees(system)?;
    check_equations(system)?;
    let (start, why) = match (loops.known.points, &loops.known.parameters) {
        (Some(given), Some(parameters)) => {
            check_given(system, &given)?;
            let start = LoopStart {
                parameters: parameters.clone(),
                points: StartPoints::Stored {
                    object: given.object,
                    count: given.count,
                },
                count: given.count,
                object: None,
            };
            let s = if given.count == 1 { "" } else { "s" };
            (
                start,
                format!("asked for; from {} given solution{s}", given.count),
            )
        }
        (Some(_), None) => return Err(PlanError::NoStartParameters),
        (None, Some(_)) => return Err(PlanError::StartParametersAlone),
        (None, None) => {
            let (point, parameters) = start_pair(system, options.seed)?;
            let points = StoredPoints {
                dimension: point.len(),
                coordinates: point,
            };
            let why = "asked for; the system is linear in its parameters, so that a random point \
                       solves it for some of them";
            (LoopStart::new(parameters, points), why.to_string())
        }
    };
    let targets = if options.target_parameters.is_empty() {
        vec![start.parameters.clone()]
    } else {
        options.target_parameters.clone()
    };
    let paths = Some(start.count);
    let solve = MonodromySolve::new(
        system,
        start,
        targets,
        loops.limits,
        options.tracking.settings.clone(),
        options.tracking.tolerances.clone(),
        options.seed,
    )?;
    Ok(Plan {
        system: system.clone(),
        algorithm: AnySolve::Monodromy(Box::new(
            solve.with_max_retries(options.tracking.max_retries),
        ))
        .into(),
        start: StartKind::Monodromy,
        paths,
        why,
    })
}

/// Loops through the systems with the same monomials, for a system without parameters.
fn plan_coefficient_loops(
    system: &System,
    loops: &MonodromyOptions,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    if loops.known.points.is_some() {
        return Err(PlanError::NothingToDeform);
    }
    checked_degrees(system)?;
    check_equations(system)?;
    let supports = cell_supports(system).map_err(PlanError::NoCoefficientFamily)?;
    let family = coefficient_family(system, &supports);
    let family = family.map_err(PlanError::NoCoefficientFamily)?;
    plan_loops_of(family, "asked for", loops, options)
}

/// Loops through a family from a random point. `why`: how it came to them.
fn plan_loops_of(
    family: CoefficientFamily,
    why: &str,
    loops: &MonodromyOptions,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    let (count, tied) = (family.values.len(), family.tied);
    let options = SolveOptions {
        target_parameters: vec![family.values],
        ..options.clone()
    };
    let plan = plan_monodromy(&family.system, loops, &options)?;
    let keep = match tied {
        0 => String::new(),
        tied => format!("; coefficients of {tied} monomials keep their ratios"),
    };
    Ok(Plan {
        why: format!(
            "{why}; the {count} coefficients are the parameters, so that a random point solves the \
             system for some of them{keep}"
        ),
        ..plan
    })
}

/// Loops through the family of a system, where coefficients keep their ratios in it and a trace test decides
/// whether all is found.
fn plan_tied_loops(
    tracked: &System,
    wasted: &str,
    options: &SolveOptions,
) -> Option<Result<Plan, PlanError>> {
    let family = coefficient_family(tracked, &cell_supports(tracked).ok()?).ok()?;
    if family.tied == 0 || !trace::has_pencil(&family.system) {
        return None;
    }
    let loops = MonodromyOptions {
        limits: LoopLimits {
            trace_test: true,
            only_complete: true,
            ..LoopLimits::DEFAULT
        },
        ..MonodromyOptions::default()
    };
    Some(plan_loops_of(family, wasted, &loops, options))
}

fn first_stage(homotopy: HomotopyKind, start_points: StartPoints, options: &SolveOptions) -> Stage {
    Stage::new(
        Work::Track,
        homotopy,
        start_points,
        options.tracking.settings.clone(),
        options.seed,
    )
}

fn finish(
    system: System,
    first: Stage,
    start: StartKind,
    why: String,
    options: &SolveOptions,
) -> Plan {
    let several = first.homotopy.target_parameters().is_some();
    let paths = first.items();
    assert!(paths.is_some(), "the number of paths is under the limit");
    let tracking = &options.tracking;
    let tolerances = tracking.tolerances.clone();
    let solve = if several {
        let solve = ParameterSolve::new(first, &system, tolerances);
        AnySolve::Parameter(solve.with_max_retries(tracking.max_retries))
    } else {
        let solve = ZeroDimensionalSolve::new(first, &system, tolerances);
        let solve = solve.with_max_retries(tracking.max_retries);
        AnySolve::ZeroDimensional(if follows_all_paths(options) {
            solve
        } else {
            let settles_doubts = settles_doubts(&system, options);
            solve.regular_ends_first(&system, settles_doubts)
        })
    };
    Plan {
        system,
        algorithm: solve.into(),
        start,
        paths,
        why,
    }
}

#[cfg(test)]
mod tests;
