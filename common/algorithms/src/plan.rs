//! From a system and options to an algorithm that solves it, or to a clear reason why not.

use crate::any_algorithm::{AnyAlgorithm, AnySolve};
use crate::closings::Closing;
use crate::closings::certificates::Certificates;
use crate::closings::digits::Digits;
use crate::coefficient_family::coefficient_family;
use crate::coefficients::Coefficients;
pub use crate::given_start::GivenStart;
use crate::given_start::check_given;
use crate::limits::CHOOSING_OPERATIONS;
pub use crate::limits::{MAX_PATHS, MAX_STREAMED_PATHS, PLANNING_OPERATIONS};
use crate::monodromy::{LoopStart, MonodromySolve};
use crate::parameter_solve::ParameterSolve;
use crate::plan_error::{PlanError, checked_volume};
use crate::polyhedral_solve::PolyhedralSolve;
use crate::regeneration_solve::{Levels, RegenerationSolve};
use crate::sampled_ends::SampledEnds;
use crate::set_structures::set_names;
pub use crate::solve_options::{
    ClosingOptions, KnownSolutions, MonodromyOptions, SolveMethod, SolveOptions, TrackingOptions,
};
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
use cognate_continuation::work::{Stage, StageId, Work};
use cognate_solutions::sharpened::DIGITS_OF_DOUBLES;
use cognate_solutions::streamed::PathFilter;
use cognate_systems::expression::Dependence;
use cognate_systems::system::System;
use num_complex::Complex64;

/// How a system will be solved.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The system as it is tracked: a total-degree start makes one group of all,
    /// another may make several of one.
    /// Workers, results and solution sets all go by this one.
    pub system: System,
    /// What solves it.
    pub algorithm: AnyAlgorithm,
    /// How its paths begin.
    pub start: StartKind,
    /// Number of paths of the first stage that tracks some; `None` where workers count them.
    pub paths: Option<u64>,
    /// Why this start.
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
    let known = options.method.known_solutions();
    let ends = known
        .and_then(|known| known.parameters.as_ref())
        .into_iter();
    let coefficients = Coefficients::of(system, ends.chain(options.target_parameters.first()));
    let in_units = coefficients.in_units(system);
    let system = &*in_units;
    let resolved = coefficients.resolved(&options.tracking.settings);
    let resolved = resolved.map(|settings| SolveOptions {
        tracking: TrackingOptions {
            settings,
            ..options.tracking.clone()
        },
        ..options.clone()
    });
    let options = resolved.as_ref().unwrap_or(options);
    let mut plan = match &options.method {
        SolveMethod::Monodromy(loops) => plan_monodromy(system, loops, options),
        SolveMethod::Given(known) => plan_given(system, known, options),
        _ if system.path_variable.is_some() => Err(PlanError::HomotopyWithoutStart),
        start => plan_start_system(system, start, options),
    }?;
    let closings = options.closings;
    let digits = closings.digits.unwrap_or(DIGITS_OF_DOUBLES);
    let more_digits = digits > DIGITS_OF_DOUBLES || closings.deflate;
    if (more_digits || closings.certify) && plan.paths.is_some_and(|paths| paths > MAX_PATHS) {
        // What closes a solve takes all endpoints at once.
        return Err(PlanError::TooManyPaths {
            start: plan.start,
            number: plan.paths,
            instead: String::new(),
        });
    }
    if more_digits {
        let digits = Digits::new(digits, closings.deflate);
        plan.algorithm.close_with(Closing::Digits(digits));
    }
    if closings.certify {
        let certificates = Certificates::default();
        plan.algorithm
            .close_with(Closing::Certificates(certificates));
    }
    Ok(plan)
}

fn check_parameters(system: &System, options: &SolveOptions) -> Result<(), PlanError> {
    let expected = system.parameters.len();
    // A path variable's own value is not asked for where it is the only parameter.
    let only_path_variable = system.path_variable.is_some() && expected == 1;
    let known = options.method.known_solutions();
    let starts = known.and_then(|known| known.parameters.as_ref());
    let targets = options.target_parameters.iter();
    let sets = starts.map(|set| ("the start parameters", set)).into_iter();
    let sets = sets.chain(targets.map(|set| ("the target parameters", set)));
    for (what, set) in sets {
        let found = set.len();
        if found != expected && !(only_path_variable && found == 0) {
            return Err(PlanError::ParameterCount {
                what,
                found,
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
            // Its own value is not asked for; where solutions are wanted it is 0.
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
    if *method == SolveMethod::Polyhedral {
        return plan_polyhedral(system, parameters, "asked for".to_string(), options);
    }
    let mut starts = Starts::of(system, options.seed)?;
    if *method == SolveMethod::Regeneration {
        return plan_regeneration(starts, parameters, None, options);
    }
    let named = |error: PlanError, starts: &Starts| match error {
        PlanError::TooManyPaths { start, number, .. } => PlanError::TooManyPaths {
            start,
            number,
            instead: starts.that_would_do(system),
        },
        other => other,
    };
    if *method == SolveMethod::Auto {
        starts = starts.with_mixed_volume(system, CHOOSING_OPERATIONS);
    }
    starts = match method {
        SolveMethod::LinearProduct(Some(sets)) => starts.with_sets(system, sets),
        SolveMethod::Auto | SolveMethod::LinearProduct(None) => starts.with_linear_product(system),
        _ => starts,
    };
    let (kind, why) = match method {
        SolveMethod::TotalDegree => (StartKind::TotalDegree, "asked for".to_string()),
        SolveMethod::Multihomogeneous => {
            let why = match starts.halved() {
                true => format!("asked for; {HALVED}"),
                false => "asked for".to_string(),
            };
            (StartKind::Multihomogeneous, why)
        }
        SolveMethod::LinearProduct(given) => {
            let sets = starts.linear_product.as_ref();
            let sets = sets.and_then(|start| start.as_ref().ok());
            let sets = sets.map_or(String::new(), |(tracked, start, _)| {
                set_names(tracked, start)
            });
            let asked = match given {
                Some(_) => SETS_ARE_GIVEN,
                None => "asked for",
            };
            (StartKind::LinearProduct, format!("{asked}; {sets}"))
        }
        _ => starts.choose().map_err(|error| named(error, &starts))?,
    };
    if kind == StartKind::Polyhedral {
        return plan_polyhedral(system, parameters, why, options);
    }
    let (tracked, start_points) = match kind {
        StartKind::TotalDegree => {
            let start = starts.total_degree.clone();
            let (tracked, start, _) = start.map_err(|error| named(error, &starts))?;
            (tracked, start)
        }
        StartKind::LinearProduct => {
            let start = starts.linear_product.take();
            let none = || Err("it was not asked for".to_string());
            let (tracked, start, count) = start
                .unwrap_or_else(none)
                .map_err(PlanError::NoLinearProduct)?;
            if count > MAX_PATHS {
                let (start, number) = (StartKind::LinearProduct, Some(count));
                let instead = String::new();
                return Err(PlanError::TooManyPaths {
                    start,
                    number,
                    instead,
                });
            }
            (tracked, start)
        }
        _ => {
            let start = starts.multihomogeneous.clone();
            let (tracked, start, _) = start.map_err(|error| named(error, &starts))?;
            (tracked, start)
        }
    };
    let homotopy = HomotopyKind::StraightLine {
        parameters: parameters.clone(),
    };
    let first = first_stage(homotopy, start_points, options);
    if *method == SolveMethod::Auto
        && let Some(wasted) = SampledEnds::of_wasted(&tracked, &first, &options.tracking.tolerances)
    {
        let why = format!("{wasted} by the {kind} start");
        return plan_regeneration(starts, parameters, Some(why), options);
    }
    Ok(finish(tracked, first, kind, why, options))
}

/// From the mixed cells of a system with as many equations as unknowns.
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
        Ok(found) => Some(checked_volume(found.mixed_volume)?),
        // Workers take wider liftings, which have no ties.
        Err(MixedCellsError::TooLong | MixedCellsError::NoLifting) => None,
        Err(error) => return Err(PlanError::NoMixedCells(error.to_string())),
    };
    let first = Stage {
        id: StageId(0),
        system: None,
        work: Work::Track,
        homotopy: HomotopyKind::Toric,
        start_points: StartPoints::MixedCells {
            count: volume.unwrap_or_default(),
            branches: volume.is_none().then(|| CellBranches::uncounted(0)),
        },
        settings: options.tracking.settings.clone(),
        seed: options.seed,
        attempt: 0,
    };
    let tolerances = options.tracking.tolerances.clone();
    let solve = PolyhedralSolve::new(first, system, parameters, tolerances);
    Ok(Plan {
        system: system.clone(),
        algorithm: AnyAlgorithm::from(AnySolve::Polyhedral(Box::new(solve)))
            .with_max_retries(options.tracking.max_retries),
        start: StartKind::Polyhedral,
        paths: volume,
        why: match volume {
            Some(_) => why,
            None => format!("{why}; the mixed cells are counted by workers"),
        },
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
        algorithm: AnyAlgorithm::from(AnySolve::Regeneration(Box::new(solve)))
            .with_max_retries(options.tracking.max_retries),
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
    known: &KnownSolutions,
    options: &SolveOptions,
) -> Result<Plan, PlanError> {
    let start = known.points.ok_or(PlanError::NoStartPoints)?;
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
        let from = known.parameters.clone();
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
    let number = start.count.checked_mul(match &homotopy {
        HomotopyKind::Parameter { targets, .. } => targets.len() as u64,
        _ => 1,
    });
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
                found: None,
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
                coordinates: point.clone(),
            };
            let start = LoopStart {
                parameters,
                points: points.as_start(),
                count: 1,
                found: Some(point),
            };
            let why = "asked for; the system is linear in its parameters, so that a random point \
                       solves it for some of them";
            (start, why.to_string())
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
    let (family, values) = family.map_err(PlanError::NoCoefficientFamily)?;
    let count = values.len();
    let options = SolveOptions {
        target_parameters: vec![values],
        ..options.clone()
    };
    let plan = plan_monodromy(&family, loops, &options)?;
    Ok(Plan {
        why: format!(
            "asked for; the {count} coefficients are the parameters, so that a random point solves the \
             system for some of them"
        ),
        ..plan
    })
}

fn first_stage(homotopy: HomotopyKind, start_points: StartPoints, options: &SolveOptions) -> Stage {
    Stage {
        id: StageId(0),
        system: None,
        work: Work::Track,
        homotopy,
        start_points,
        settings: options.tracking.settings.clone(),
        seed: options.seed,
        attempt: 0,
    }
}

fn finish(
    system: System,
    first: Stage,
    start: StartKind,
    why: String,
    options: &SolveOptions,
) -> Plan {
    let several = matches!(first.homotopy, HomotopyKind::Parameter { .. });
    let paths = first.items();
    assert!(paths.is_some(), "the number of paths is under the limit");
    let tolerances = options.tracking.tolerances.clone();
    let algorithm = if several {
        AnyAlgorithm::from(AnySolve::Parameter(ParameterSolve::new(
            first, &system, tolerances,
        )))
    } else {
        AnyAlgorithm::from(AnySolve::ZeroDimensional(ZeroDimensionalSolve::new(
            first, &system, tolerances,
        )))
    };
    Plan {
        system,
        algorithm: algorithm.with_max_retries(options.tracking.max_retries),
        start,
        paths,
        why,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PathAlgorithm;
    use crate::start_costs::StartCosts;
    use cognate_systems::polynomial::PolynomialError;

    fn system(text: &str) -> System {
        match cognate_systems::formats::read("test", text.as_bytes()) {
            Ok(problem) => problem.system,
            Err(error) => panic!("{error}"),
        }
    }

    fn bertini(input: &str) -> System {
        system(&format!("CONFIG\nEND;\nINPUT\n{input}\nEND;\n"))
    }

    /// Two bilinear equations in two groups: 4 paths by total degree, 2 by the groups.
    fn bilinear() -> System {
        bertini("variable_group x; variable_group y; function f, g; f = x*y - 1; g = x*y + x - y;")
    }

    fn with_parameter() -> System {
        bertini("variable_group x; parameter p; function f; f = x^3 - p;")
    }

    fn given(dimension: usize, parameters: Option<Vec<Complex64>>) -> SolveOptions {
        let points = Some(GivenStart {
            object: cognate_continuation::start_points::Digest([1; 32]),
            count: 3,
            dimension,
        });
        with_method(SolveMethod::Given(KnownSolutions { points, parameters }))
    }

    fn number(re: f64) -> Vec<Complex64> {
        vec![Complex64::new(re, 0.0)]
    }

    fn refusal(system: &System, options: &SolveOptions) -> PlanError {
        match plan(system, options) {
            Err(error) => error,
            Ok(plan) => panic!("there should be no plan: {plan:?}"),
        }
    }

    fn with_method(method: SolveMethod) -> SolveOptions {
        SolveOptions {
            method,
            ..SolveOptions::default()
        }
    }

    #[test]
    fn the_start_with_fewest_paths_is_chosen() {
        let chosen = plan(&bilinear(), &SolveOptions::default()).unwrap();
        assert_eq!(
            (chosen.start, chosen.paths),
            (StartKind::Multihomogeneous, Some(2))
        );
        assert_eq!(chosen.system.groups.len(), 2);
        let total = plan(&bilinear(), &with_method(SolveMethod::TotalDegree)).unwrap();
        assert_eq!(
            (total.start, total.paths),
            (StartKind::TotalDegree, Some(4))
        );
        assert_eq!(total.system.groups.len(), 1, "groups are merged");
        assert_eq!(total.algorithm.progress().stages, []);
        let tie =
            bertini("variable_group x; variable_group y; function f, g; f = x - 5*y; g = y^2 - 3;");
        let chosen = plan(&tie, &SolveOptions::default()).unwrap();
        assert_eq!(
            (chosen.start, chosen.paths),
            (StartKind::Multihomogeneous, Some(2))
        );
        let one = bertini("variable_group x, y; function f, g; f = x*y - 1; g = x^3 + y;");
        let chosen = plan(&one, &SolveOptions::default()).unwrap();
        assert_eq!(
            (chosen.start, chosen.paths),
            (StartKind::Multihomogeneous, Some(4))
        );
        assert_eq!(chosen.system.groups.len(), 2, "groups were found");
        let dense =
            bertini("variable_group x, y; function f, g; f = x^2 + y^2 - 1; g = x^3 + y^3;");
        let chosen = plan(&dense, &SolveOptions::default()).unwrap();
        assert_eq!(
            (chosen.start, chosen.paths),
            (StartKind::TotalDegree, Some(6))
        );
    }

    #[test]
    fn costs_are_as_the_contract_has_them() {
        let costs = StartCosts::of(&bilinear()).unwrap();
        assert_eq!(
            serde_json::to_string(&costs).unwrap(),
            "{\"variables\":2,\"equations\":2,\"degrees\":[2,2],\"total_degree\":4,\
             \"multihomogeneous\":{\"groups\":[[\"x\"],[\"y\"]],\"number\":2},\
             \"linear_product\":2,\"mixed_volume\":2,\"choice\":\"multihomogeneous\",\
             \"why\":\"2 paths by the variable groups, 4 by total degree\",\
             \"notes\":{\"linear_product\":\"the sets 2 times {x} {y}\"}}"
        );
        let more = bertini("variable_group x; function f, g; f = x - 1; g = x^2 - 1;");
        let costs = StartCosts::of(&more).unwrap();
        let found = (costs.choice, costs.total_degree);
        assert_eq!(found, (Some(StartKind::TotalDegree), Some(2)));
        assert!(costs.why.ends_with("of 1 combination of the 2 equations"));
        assert_eq!(costs.degrees, [1, 2], "as they are given");
        let fewer = bertini("variable_group x, y, z; function f; f = x*y - z;");
        let costs = StartCosts::of(&fewer).unwrap();
        assert_eq!((costs.choice, costs.total_degree), (None, None));
        assert!(costs.why.contains("Add 2 equations"), "{}", costs.why);
    }

    #[test]
    fn homogeneous_groups_lose_one_unknown() {
        let conics = "function f, g; f = x^2 + y^2 - z^2; g = x*y - z^2;";
        let projective = bertini(&format!("hom_variable_group x, y, z; {conics}"));
        assert_eq!(
            plan(&projective, &SolveOptions::default()).unwrap().paths,
            Some(4)
        );
        let affine = bertini(&format!("variable_group x, y, z; {conics}"));
        assert!(matches!(
            refusal(&affine, &SolveOptions::default()),
            PlanError::FewerEquations {
                equations: 2,
                unknowns: 3
            }
        ));
        let skew = bertini("hom_variable_group x, y; function f; f = x^2 - y;");
        assert!(matches!(
            refusal(&skew, &SolveOptions::default()),
            PlanError::Polynomial(PolynomialError::NotHomogeneous { .. })
        ));
        let mixed = bertini(
            "hom_variable_group x, y; variable_group z; function f, g; f = x*z - y; g = x + y*z;",
        );
        assert_eq!(
            plan(&mixed, &SolveOptions::default()).unwrap().start,
            StartKind::Multihomogeneous
        );
        assert_eq!(
            refusal(&mixed, &with_method(SolveMethod::TotalDegree)),
            PlanError::TotalDegreeNeedsOneGroup
        );
    }

    #[test]
    fn what_is_too_large_is_named() {
        let large = bertini("variable_group x, y; function f, g; f = x^9000 - 1; g = y^9000 - 1;");
        let error = refusal(&large, &SolveOptions::default());
        assert!(error.to_string().contains("81000000 paths"), "{error}");
        assert!(
            error.to_string().starts_with("not in this version"),
            "{error}"
        );
        // Pairs of bilinear equations: 4^13 by total degree, 2^13 by mixed cells.
        let names = |letter: &str| -> Vec<String> {
            let all = 0..13;
            all.map(|k| format!("{letter}{k}")).collect()
        };
        let mut pairs = format!(
            "variable_group {}, {};",
            names("x").join(", "),
            names("y").join(", ")
        );
        pairs += &format!(
            "function {}, {};",
            names("f").join(", "),
            names("g").join(", ")
        );
        for k in 0..13 {
            pairs += &format!("f{k} = x{k}*y{k} - 1; g{k} = x{k}*y{k} + x{k} - 3*y{k};");
        }
        let error = refusal(&bertini(&pairs), &with_method(SolveMethod::TotalDegree));
        assert!(error.to_string().contains("67108864 paths"), "{error}");
        assert!(
            error.to_string().contains("these starts would do: "),
            "{error}"
        );
        assert!(
            error.to_string().contains("polyhedral with 8192"),
            "{error}"
        );
        let names: Vec<String> = (0..70).map(|k| format!("x{k}")).collect();
        let functions: Vec<String> = (0..70).map(|k| format!("f{k}")).collect();
        let equations: Vec<String> = (0..70).map(|k| format!("f{k} = x{k}^2 - 1;")).collect();
        let huge = bertini(&format!(
            "variable_group {}; function {}; {}",
            names.join(", "),
            functions.join(", "),
            equations.join(" ")
        ));
        let error = refusal(&huge, &SolveOptions::default());
        assert!(error.to_string().contains("2^64 or more"), "{error}");
        let groups: Vec<String> = names
            .iter()
            .map(|n| format!("variable_group {n};"))
            .collect();
        let many = bertini(&format!(
            "{} function {}; {}",
            groups.join(" "),
            functions.join(", "),
            equations.join(" ")
        ));
        assert_eq!(
            refusal(&many, &with_method(SolveMethod::Multihomogeneous)),
            PlanError::TooManyGroups { groups: 70 }
        );
    }

    #[test]
    fn given_sets_are_followed_or_refused() {
        // {x} {x, y} | {x, y}^2: 4 paths, where the groups that are found have 2.
        let system = bilinear();
        let sets = vec![vec![vec![0], vec![0, 1]], vec![vec![0, 1], vec![0, 1]]];
        let with_sets = |sets| with_method(SolveMethod::LinearProduct(Some(sets)));
        let chosen = plan(&system, &with_sets(sets)).unwrap();
        assert_eq!(
            (chosen.start, chosen.paths),
            (StartKind::LinearProduct, Some(4))
        );
        assert!(chosen.why.starts_with("the sets are given"));
        let sets = vec![vec![vec![0], vec![0]], vec![vec![0, 1], vec![1]]];
        let error = refusal(&system, &with_sets(sets.clone())).to_string();
        assert!(error.contains("monomial x*y"), "{error}");
        assert_eq!(
            StartCosts::with_sets(&system, Some(&sets))
                .unwrap_err()
                .to_string(),
            error
        );
    }

    #[test]
    fn groups_that_admit_no_solution_are_refused() {
        // Both equations in x alone: 4 by total degree, 0 by the groups.
        let system =
            bertini("variable_group x; variable_group y; function f, g; f = x^2 - 1; g = x^2 - x;");
        assert_eq!(
            refusal(&system, &with_method(SolveMethod::Multihomogeneous)),
            PlanError::NoPaths
        );
        assert_eq!(
            StartCosts::of(&system).unwrap().multihomogeneous.number,
            Some(0)
        );
    }

    #[test]
    fn parameters_need_values_or_a_solved_start() {
        let system = with_parameter();
        let error = refusal(&system, &SolveOptions::default());
        assert!(error.to_string().contains("(p)"), "{error}");
        let mut options = SolveOptions {
            target_parameters: vec![number(2.0)],
            ..SolveOptions::default()
        };
        assert_eq!(plan(&system, &options).unwrap().paths, Some(3));
        options.target_parameters.push(number(3.0));
        assert_eq!(refusal(&system, &options), PlanError::SeveralTargets(2));
        options.method = given(1, Some(number(1.0))).method;
        let chosen = plan(&system, &options).unwrap();
        assert_eq!((chosen.start, chosen.paths), (StartKind::Given, Some(6)));
        options.target_parameters[1].push(Complex64::new(0.0, 0.0));
        assert!(matches!(
            refusal(&system, &options),
            PlanError::ParameterCount {
                found: 2,
                expected: 1,
                ..
            }
        ));
        options.target_parameters[1] = number(f64::NAN);
        assert!(matches!(
            refusal(&system, &options),
            PlanError::NotFinite { .. }
        ));
    }

    #[test]
    fn given_starts_must_fit() {
        let system = with_parameter();
        assert_eq!(
            refusal(&system, &given(1, None)),
            PlanError::NoStartParameters
        );
        assert_eq!(
            refusal(&system, &given(2, None)),
            PlanError::StartDimension {
                found: 2,
                expected: 1
            }
        );
        assert_eq!(
            refusal(
                &system,
                &with_method(SolveMethod::Given(KnownSolutions::default()))
            ),
            PlanError::NoStartPoints
        );
        assert_eq!(
            refusal(&bilinear(), &given(2, None)),
            PlanError::NothingToDeform
        );
        let alone = KnownSolutions {
            points: None,
            parameters: Some(number(1.0)),
        };
        let loops = MonodromyOptions {
            known: alone,
            ..MonodromyOptions::default()
        };
        assert_eq!(
            refusal(&system, &with_method(SolveMethod::Monodromy(loops))),
            PlanError::StartParametersAlone
        );
    }

    #[test]
    fn a_homotopy_of_the_users_own_starts_where_it_says() {
        let system =
            bertini("variable x; pathvariable t; function f; f = t*(x^2 - 1) + (1 - t)*(x^2 - 4);");
        assert!(system.path_variable.is_some());
        assert_eq!(
            refusal(&system, &SolveOptions::default()),
            PlanError::HomotopyWithoutStart
        );
        let chosen = plan(&system, &given(1, None)).unwrap();
        assert_eq!((chosen.start, chosen.paths), (StartKind::Given, Some(3)));
    }

    #[test]
    fn what_needs_every_endpoint_has_a_lower_limit() {
        // 2^23 paths: more than are held, fewer than are streamed.
        let names: Vec<String> = (0..23).map(|i| format!("x{i}")).collect();
        let squares: Vec<String> = (0..23)
            .map(|i| format!("f{i} = x{i}^2 - {};", i + 2))
            .collect();
        let functions: Vec<String> = (0..23).map(|i| format!("f{i}")).collect();
        let system = bertini(&format!(
            "variable_group {};\nfunction {};\n{}",
            names.join(", "),
            functions.join(", "),
            squares.join("\n")
        ));
        let alone = with_method(SolveMethod::TotalDegree);
        assert_eq!(plan(&system, &alone).unwrap().paths, Some(1 << 23));
        let none = ClosingOptions::default();
        let closings = [
            ClosingOptions {
                certify: true,
                ..none
            },
            ClosingOptions {
                digits: Some(50),
                ..none
            },
            ClosingOptions {
                deflate: true,
                ..none
            },
        ];
        for closings in closings {
            let options = SolveOptions {
                closings,
                ..alone.clone()
            };
            let refused = refusal(&system, &options);
            assert!(
                matches!(refused, PlanError::TooManyPaths { .. }),
                "{refused}"
            );
        }
    }
}
