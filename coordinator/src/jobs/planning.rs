//! Planning: from a problem and options to the algorithm that a job begins with.
//!
//! Done once, when the job is submitted, so that what cannot be solved is
//! refused with its reason; the algorithm's first state is kept as an object.

use crate::ledger::identity::ItemRange;
use crate::results::store::RecordKind;
use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve, ProblemError};
use cognate_algorithms::monodromy::LoopLimits;
use cognate_algorithms::plan::{GivenStart, Plan, plan};
use cognate_algorithms::questions::{QuestionError, QuestionSolve};
use cognate_algorithms::retried_stage::MAX_RETRIES;
use cognate_algorithms::start_costs::StartKind as PlannedStart;
use cognate_algorithms::{
    AnySolve, ClosingOptions, KnownSolutions, MonodromyOptions, Next, PathAlgorithm, PlanError,
    SolveMethod, SolveOptions, TrackingOptions,
};
use cognate_continuation::prepared_work::PreparedWork;
use cognate_continuation::sharpening::MOST_DIGITS;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::start_points::{DamagedPoints, Digest, StoredPoints};
use cognate_continuation::work::Work;
use cognate_protocol::submission::{
    Asked, Decompose, Options, PrecisionChoice, StartKind, StartSolutions,
};
use cognate_solutions::sharpened::DIGITS_OF_DOUBLES;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How a job was planned: the job's record, which the ledger keeps beside its row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    /// Name of the problem, as people call it.
    pub name: String,
    /// Digest of the system as it was submitted.
    pub problem: Digest,
    /// Number of variables of the system.
    pub variables: u64,
    /// Number of equations of the system.
    pub equations: u64,
    /// Kind of the start of the paths: `total-degree`, for instance.
    pub start: String,
    /// Reason for this start, in words for people.
    pub why: String,
    /// Number of paths of the first stage that tracks some; `None` where workers count them.
    pub paths: Option<u64>,
    /// Seed of everything random.
    pub seed: u64,
    /// The algorithm's first state, as an object.
    pub first_state: Digest,
    /// Warnings about parts of the problem that are ignored.
    pub warnings: Vec<String>,
}

/// Algorithm states as objects.
pub const STATE: RecordKind = RecordKind(b"CGNALG01");

/// A record of a job's row that this program did not write.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the plan of the job cannot be read: {0}")]
pub struct UnreadablePlan(String);

/// Version of the encoding of [`Planned`].
const VERSION: u8 = 2;

impl Planned {
    /// The bytes that the ledger keeps.
    pub fn to_bytes(&self) -> Vec<u8> {
        postcard::to_extend(self, vec![VERSION]).expect("memory takes every byte")
    }

    /// Reads what [`Self::to_bytes`] wrote.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, UnreadablePlan> {
        match bytes.split_first() {
            Some((&VERSION, rest)) => {
                postcard::from_bytes(rest).map_err(|error| UnreadablePlan(error.to_string()))
            }
            _ => Err(UnreadablePlan("it is of another version".into())),
        }
    }
}

/// Why a problem cannot be planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanningError {
    /// The algorithms refuse it.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// No worker could track its paths.
    #[error("its paths cannot be tracked: {0}")]
    Untrackable(#[from] PrepareError),
    /// The system cannot be decomposed.
    #[error(transparent)]
    Decomposition(#[from] ProblemError),
    /// Components are closures of what polynomials say, and hold false branches.
    #[error(
        "not in this version: components of equations with functions of unknowns: an unknown with an equation in the place of each \
         function has them (`s^2 = x` for `s = sqrt(x)`, `c^2 + s^2 = 1` for cosine and sine); `cognate solve` finds \
         isolated solutions"
    )]
    ComponentsOfFunctions,
    /// The question cannot be asked.
    #[error("question: {0}")]
    Question(#[from] QuestionError),
    /// The object of start solutions is none.
    #[error("the start solutions cannot be used: {0}")]
    StartSolutions(#[from] DamagedPoints),
}

/// The options as the algorithms know them. `start_solutions` is the object that they name.
pub fn solve_options(
    options: &Options,
    start_solutions: Option<&[u8]>,
) -> Result<SolveOptions, PlanningError> {
    let points = match (&options.start_solutions, start_solutions) {
        (Some(StartSolutions::Object(object)), Some(bytes)) => {
            let points = StoredPoints::from_bytes(bytes)?;
            Some(GivenStart {
                object: *object,
                count: points.len() as u64,
                dimension: points.dimension,
            })
        }
        _ => None,
    };
    let settings = options.settings.resolve();
    Ok(SolveOptions {
        method: method(options, points)?,
        target_parameters: options.target_parameters.clone(),
        seed: options.seed.unwrap_or_default(),
        numbers_are_exact: settings.exact_data,
        tracking: TrackingOptions {
            settings,
            max_retries: match options.precision {
                // From the second time on a path is tracked again in double-doubles.
                PrecisionChoice::Double => 1,
                PrecisionChoice::Adaptive | PrecisionChoice::Bits(_) => MAX_RETRIES,
            },
            ..TrackingOptions::default()
        },
        closings: ClosingOptions {
            digits: options.closings.digits.or(match options.precision {
                PrecisionChoice::Bits(bits) => Some(digits_of(bits)),
                PrecisionChoice::Double | PrecisionChoice::Adaptive => None,
            }),
            ..options.closings
        },
        ..SolveOptions::default()
    })
}

/// How paths begin, from these points where there are some. Start solutions make the automatic start one of
/// known solutions, sets make it a linear-product start.
fn method(options: &Options, points: Option<GivenStart>) -> Result<SolveMethod, PlanError> {
    let parameters = points.is_some() && !options.start_parameters.is_empty();
    let known_solutions = KnownSolutions {
        points,
        parameters: parameters.then(|| options.start_parameters.clone()),
    };
    let is_known = known_solutions.points.is_some();
    let method = match options.start {
        StartKind::Auto if is_known => SolveMethod::Given(known_solutions),
        StartKind::Given => SolveMethod::Given(known_solutions),
        StartKind::Monodromy => {
            let default = MonodromyOptions::default().limits;
            SolveMethod::Monodromy(MonodromyOptions {
                known: known_solutions,
                limits: LoopLimits {
                    idle_loops: options.idle_loops.unwrap_or(default.idle_loops),
                    count: options.expected_solutions,
                    trace_test: options.trace_test,
                    confidence: options.confidence,
                    ..default
                },
            })
        }
        StartKind::Auto if options.sets.is_some() => {
            SolveMethod::LinearProduct(options.sets.clone())
        }
        StartKind::LinearProduct => SolveMethod::LinearProduct(options.sets.clone()),
        StartKind::Auto => SolveMethod::Auto,
        StartKind::TotalDegree => SolveMethod::TotalDegree,
        StartKind::Multihomogeneous => SolveMethod::Multihomogeneous,
        StartKind::Polyhedral => SolveMethod::Polyhedral,
        StartKind::Regeneration => SolveMethod::Regeneration,
    };
    match method {
        SolveMethod::LinearProduct(_) => Ok(method),
        _ if options.sets.is_some() => Err(PlanError::SetsWithoutLinearProduct),
        _ => Ok(method),
    }
}

/// Decimal digits that a number of this many bits has for certain.
fn digits_of(bits: u32) -> u32 {
    let digits = (f64::from(bits) / std::f64::consts::LOG2_10) as u32;
    digits.clamp(DIGITS_OF_DOUBLES, MOST_DIGITS)
}

/// Plan of a system whose first stage a worker can prepare. Mixed cells that are not counted in `counting_operations`
/// operations are left to workers.
pub fn plan_job(
    system: &System,
    options: &Options,
    start_solutions: Option<&[u8]>,
    counting_operations: u64,
) -> Result<Plan, PlanningError> {
    let decompose = options.decompose.clone();
    let asked = options.question.clone();
    if (decompose.is_some() || asked.is_some()) && !system.helpers.is_empty() {
        return Err(PlanningError::ComponentsOfFunctions);
    }
    let options = SolveOptions {
        counting_operations,
        ..solve_options(options, start_solutions)?
    };
    let plan = match (decompose, asked) {
        (_, Some(asked)) => plan_question(system, &asked, options.clone())?,
        (Some(wanted), None) => plan_decomposition(system, wanted, options.clone())?,
        (None, None) => plan(system, &options)?,
    };
    let points = start_solutions.map(StoredPoints::from_bytes).transpose()?;
    let known_solutions = options.method.known_solutions();
    let given = known_solutions.and_then(|solutions| solutions.points);
    let given = given.map(|start| start.object).zip(points);
    let given = given.map(|(object, points)| (object, Arc::new(points)));
    let find = |wanted: Digest| {
        let start_points = given.as_ref().filter(|(object, _)| *object == wanted);
        start_points.map(|(_, points)| Arc::clone(points))
    };
    if let Next::Open(opening) = plan.algorithm.clone().next()
        && matches!(opening.stage.work, Work::Track | Work::CountMixedCells)
    {
        let find = |wanted: Digest| opening.object(wanted).or_else(|| find(wanted));
        let system = opening.system.as_deref().unwrap_or(&plan.system);
        PreparedWork::check(system, &opening.stage, &find)?;
    }
    Ok(plan)
}

/// How paths on components are tracked, and at which values of the parameters.
fn tracking_of_components(options: SolveOptions) -> Result<DecompositionOptions, PlanningError> {
    let mut targets = options.target_parameters;
    let parameters = match targets.len() {
        0 | 1 => targets.pop().unwrap_or_default(),
        several => return Err(PlanError::SeveralTargets(several).into()),
    };
    Ok(DecompositionOptions {
        seed: options.seed,
        parameters,
        settings: options.tracking.settings,
        tolerances: options.tracking.tolerances,
        max_retries: options.tracking.max_retries,
        ..DecompositionOptions::default()
    })
}

/// The plan that answers a question to components.
fn plan_question(
    system: &System,
    asked: &Asked,
    options: SolveOptions,
) -> Result<Plan, PlanningError> {
    let options = tracking_of_components(options)?;
    let solve = QuestionSolve::new(system, &options, &asked.components, &asked.question)?;
    Ok(Plan {
        system: system.clone(),
        algorithm: AnySolve::Question(Box::new(solve)).into(),
        start: PlannedStart::Cascade,
        paths: None,
        why: "components are asked that are known: their slices move".into(),
    })
}

/// The plan that finds all components.
fn plan_decomposition(
    system: &System,
    wanted: Decompose,
    options: SolveOptions,
) -> Result<Plan, PlanningError> {
    let default = DecompositionOptions::default();
    let options = DecompositionOptions {
        dimensions: wanted.dimensions.map(|[lowest, highest]| lowest..=highest),
        idle_loops: wanted.idle_loops.unwrap_or(default.idle_loops),
        method: wanted.method,
        verify: wanted.verify,
        split: !wanted.without_split,
        certify: options.closings.certify,
        known: wanted.known,
        ..tracking_of_components(options)?
    };
    let solve = DecompositionSolve::new(system, &options)?;
    Ok(Plan {
        system: system.clone(),
        algorithm: AnySolve::Decomposition(Box::new(solve)).into(),
        start: PlannedStart::Cascade,
        paths: None,
        why: "all components are asked for: equation by equation the sets that they have in common are cut, or \
              combination by combination in a cascade"
            .into(),
    })
}

/// The first chunks of a stage: one, from which every lease cuts its size.
pub fn first_chunks(items: u64) -> Vec<ItemRange> {
    let whole = ItemRange {
        first: 0,
        last: items,
    };
    if whole.is_empty() {
        Vec::new()
    } else {
        vec![whole]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::planning_queue::PlanningLimits;
    use cognate_algorithms::plan::PLANNING_OPERATIONS;
    use cognate_numeric::interruption::Interruption;
    use cognate_systems::formats;
    use cognate_systems::named::{caprasse, cyclic, katsura, noon};

    /// Work that is counted while a system is planned, under a sign that is set after `most` operations.
    fn work_of_planning(system: &System, most: u64) -> u64 {
        let sign = Interruption::after(most);
        let options = Options::default();
        let plan = || plan_job(system, &options, None, PLANNING_OPERATIONS);
        drop(sign.run(plan));
        sign.counted()
    }

    #[test]
    fn small_systems_are_planned_within_the_share_of_the_short_lane() {
        let share = PlanningLimits::default().short_work;
        let circles = formats::read("circles", b"x^2 + y^2 = 5\nx*y = 2\n");
        let circles = circles.expect("it can be read").system;
        let named = [cyclic(5), katsura(6), noon(4), caprasse()];
        for system in named.into_iter().map(|named| named.system).chain([circles]) {
            let work = work_of_planning(&system, share);
            let n = system.variable_count();
            assert!(work <= share, "{n} unknowns: {work} operations");
        }
    }

    /// Dense quadrics, and powers of sums, which are multiplied out.
    fn powers(n: usize, power: u32) -> System {
        let equations: String = (0..n)
            .map(|k| {
                let sum: Vec<String> = (0..n)
                    .map(|j| format!("{}*x{j}", 1 + (k * j) % 7))
                    .collect();
                format!("({})^{power} = {}\n", sum.join("+"), k + 1)
            })
            .collect();
        let read = formats::read("powers", equations.as_bytes());
        read.expect("it can be read").system
    }

    /// A plan whose share is over ends at the next look, a few milliseconds of work later. Plans of these systems went on
    /// for up to 1.8 s (third attack, O).
    #[test]
    fn long_plans_end_soon_after_their_share() {
        let share = 100_000;
        let named = [cyclic(11), cyclic(15), katsura(20)].map(|named| named.system);
        for system in named
            .into_iter()
            .chain([powers(20, 2), powers(20, 5), powers(6, 200)])
        {
            let beyond = work_of_planning(&system, share).saturating_sub(share);
            let n = system.variable_count();
            println!("{n} unknowns: {beyond} operations more");
            assert!(
                (1..MOST_BEYOND).contains(&beyond),
                "{n} unknowns: {beyond} operations more"
            );
        }
    }

    /// Operations that an interrupted plan may still count. Nearly all are those of work that is estimated, refused and not
    /// begun: one path of a sample takes 17,640,000 in 21 unknowns (`sampled_ends`).
    const MOST_BEYOND: u64 = 20_000_000;

    /// A job that runs while the program is replaced by one of another version fails with this reason.
    #[test]
    fn a_plan_of_another_version_is_refused_by_its_name() {
        for bytes in [&[VERSION + 1, 0][..], &[VERSION - 1, 0], &[]] {
            let refused = Planned::from_bytes(bytes).err();
            let reason = refused.map(|error| error.to_string());
            let expected = "the plan of the job cannot be read: it is of another version";
            assert_eq!(reason.as_deref(), Some(expected), "{bytes:?}");
        }
    }
}
