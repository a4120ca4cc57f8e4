//! Decomposition: every irreducible component of every dimension, by witness sets.
//!
//! For each dimension points on general slices are found, a witness superset: by a cascade of combinations of the
//! equations ([`cascade`]), by the equations one after the other ([`equations`]), or on the slices of each dimension
//! by itself ([`slices`]). What lies on sets of higher dimension is junk ([`junk`]); points of multiple sets get
//! equations that are regular there ([`deflated`]); derivatives of the witness points along a moving slice, and loops
//! of the slice, tell components apart ([`split`]). (Hauenstein, Sommese, Wampler: Regenerative cascade homotopies,
//! 2011; Brake, Hauenstein, Liddell: Decomposing solution sets using derivatives, 2016.)
//!
//! Stages differ in their systems, which their openings bring.

mod carried;
pub(crate) mod cascade;
mod classes;
mod costs;
pub(crate) mod deflated;
mod dimension_start;
mod equations;
pub(crate) mod job;
pub(crate) mod junk;
pub(crate) mod moved;
pub(crate) mod multiple_cut;
pub(crate) mod operand;
mod options;
mod ordering;
pub(crate) mod problem;
pub(crate) mod proof;
mod removal;
mod resumed;
mod slices;
pub(crate) mod split;
pub(crate) mod stage_runner;
pub(crate) mod superset;
mod symmetry;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_carried;
#[cfg(test)]
mod tests_of_resumed;
mod unions;

use crate::answer::Answer;
use crate::run_locally;
use crate::solve::Root;
use carried::Carried;
use cascade::Cascade;
use cognate_continuation::stage::PrepareError;
use cognate_solutions::witness::{
    ComponentId, Decomposition, Dimension, Doubt, Family, KnownComponents, Method, TrackedPaths,
    WitnessSet, sharing_slices,
};
use cognate_systems::system::System;
pub use costs::DecompositionCosts;
use deflated::{Deflations, ProblemContext, PureSet};
use equations::{Equations, Prefixes};
use job::{Job, StageSystem};
use junk::JunkFilter;
use operand::TrackedSet;
pub use options::DecompositionOptions;
pub(crate) use ordering::ordered;
use problem::Problem;
pub use problem::ProblemError;
use proof::Proving;
pub(crate) use removal::remove_zero_denominators;
use resumed::Resumed;
use serde::{Deserialize, Serialize, Serializer};
use slices::Slices;
use split::Split;
use stage_runner::{StageRunner, StagedSolve};
use std::sync::Arc;

/// Step of a decomposition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Step {
    /// Known components go to the slices on which other equations cut them.
    Resumed(Resumed),
    /// Components of a general member of the family go to the values of the parameters.
    Carried(Carried),
    /// Combination by combination: points of all dimensions.
    Cascade(Cascade),
    /// Equation by equation.
    Equations(Equations),
    /// Dimension by dimension.
    Slices(Slices),
    /// Dimension by dimension, highest first: what is junk and what is multiple.
    JunkFilter(JunkFilter),
    /// Set by set: components.
    Split(Split),
    /// All is found: what of it is proved.
    Prove(Box<Proving>),
    /// All is known.
    Done(Arc<Decomposition>),
}

/// Purpose of a decomposition by one method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Purpose {
    /// The first decomposition.
    First,
    /// The first left something in doubt.
    Again,
    /// A second decomposition, to be compared with the first.
    Verify,
}

/// State of a decomposition, as it is stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    system: Arc<System>,
    options: DecompositionOptions,
    method: Method,
    purpose: Purpose,
    /// Answer of the first method.
    first: Option<Box<Decomposition>>,
    step: Step,
    runner: StageRunner,
    /// Results of each dimension, highest first.
    dimensions: Vec<Dimension>,
    /// Sets of one dimension and multiplicity, not yet told apart, and components made of them.
    sets: Vec<PureSet>,
    /// Whether there are sets of higher dimensions than are asked for.
    has_sets_above: bool,
    #[serde(deserialize_with = "sharing_slices")]
    components: Vec<WitnessSet>,
    paths: TrackedPaths,
    paths_of_loops: TrackedPaths,
    /// Components of a general member of the family, moved to the values of the parameters; `None` if they were not
    /// used. `not_carried` holds the reason.
    carried: Option<Carried>,
    not_carried: String,
}

/// A whole decomposition, as a plan that asks for paths and learns from results.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "State")]
pub struct DecompositionSolve {
    state: State,
    /// Made of the system and the options, and made again where the state is read back.
    problem: Arc<Problem>,
    /// Systems that were made of the problem.
    deflations: Deflations,
    prefixes: Prefixes,
    /// Components of the first equations, while they move.
    known: Option<TrackedSet>,
}

impl PartialEq for DecompositionSolve {
    fn eq(&self, other: &Self) -> bool {
        self.state == other.state
    }
}

impl Serialize for DecompositionSolve {
    /// As its state, which is not copied: it may be a large part of the memory.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.state.serialize(serializer)
    }
}

impl TryFrom<State> for DecompositionSolve {
    type Error = ProblemError;

    fn try_from(state: State) -> Result<Self, ProblemError> {
        state.system.check()?;
        let problem = Problem::of_options(&state.system, &state.options)?;
        Self::of_state(state, problem)
    }
}

impl DecompositionSolve {
    fn of_state(state: State, problem: Problem) -> Result<Self, ProblemError> {
        let tracked_set = match (&state.step, &state.options.known) {
            (Step::Resumed(_), Some(known_components)) => {
                Some(tracked(&problem, known_components)?)
            }
            (Step::Carried(_), _) => {
                Some(carried::tracked(&problem, &state.system, &state.options)?)
            }
            _ => None,
        };
        Ok(Self {
            problem: Arc::new(problem),
            deflations: Deflations::default(),
            prefixes: Prefixes::default(),
            known: tracked_set,
            state,
        })
    }

    /// The decomposition of a system that has been checked.
    pub fn new(system: &System, options: &DecompositionOptions) -> Result<Self, ProblemError> {
        let problem = Problem::of_options(system, options)?;
        let of_family = options.known.as_ref().filter(|k| !k.parameters.is_empty());
        let method = match (&options.known, options.method) {
            (Some(_), _) if of_family.is_some() => Method::Slices,
            (Some(_), _) => Method::Equations,
            (None, Some(method)) => method,
            (None, None) => costs::choose(&problem).0,
        };
        let mut not_carried = String::new();
        let step = match (&options.known, of_family) {
            (_, Some(member_components)) => {
                let general = carried::general(&problem, system, options)?;
                match carried::obstacle(&problem, &general, member_components) {
                    None => Step::Carried(Carried::default()),
                    Some(why) => {
                        not_carried = why;
                        first_step(method, &problem)
                    }
                }
            }
            (Some(_), None) => Step::Resumed(Resumed::default()),
            (None, None) => first_step(method, &problem),
        };
        let state = State {
            system: Arc::new(system.clone()),
            options: options.clone(),
            method,
            purpose: Purpose::First,
            first: None,
            step,
            runner: StageRunner::default(),
            dimensions: Vec::new(),
            sets: Vec::new(),
            has_sets_above: false,
            components: Vec::new(),
            paths: TrackedPaths::default(),
            paths_of_loops: TrackedPaths::default(),
            carried: None,
            not_carried,
        };
        Self::of_state(state, problem)
    }

    /// Most repetitions of a path.
    pub fn max_retries(&self) -> u16 {
        self.state.options.max_retries
    }

    /// The job that comes after the one that is done; `None` where the step has no more work.
    fn next_job(&mut self, done: Option<Job>) -> Option<Job> {
        let (state, problem) = (&mut self.state, &*self.problem);
        let paths = match state.step {
            Step::Split(_) => &mut state.paths_of_loops,
            _ => &mut state.paths,
        };
        if let Some(job) = &done {
            paths.add(&job.paths());
        }
        let mut context = ProblemContext {
            problem,
            deflations: &mut self.deflations,
        };
        match &mut state.step {
            Step::Done(_) => None,
            Step::Resumed(resumed) => {
                let tracked_set = self.known.as_mut()?;
                resumed.advance(problem, tracked_set, done.as_ref())
            }
            Step::Carried(carried) => {
                let tracked_set = self.known.as_mut()?;
                let system_and_options = (&*state.system, &state.options);
                carried.advance(problem, system_and_options, tracked_set, done.as_ref())
            }
            Step::Cascade(cascade) => cascade.advance(problem, None, done.as_ref()),
            Step::Equations(equations) => {
                equations.advance(problem, &mut self.prefixes, done.as_ref())
            }
            Step::Slices(slices) => slices.advance(&mut context, done.as_ref()),
            Step::JunkFilter(filter) => {
                filter.advance(&mut context, done.as_ref(), &mut state.sets)
            }
            Step::Split(split) => split.advance(&mut context, done),
            Step::Prove(proving) => proving.advance(&mut context, done.as_ref()),
        }
    }

    /// Goes on where a step has no more work.
    fn next_step(&mut self) {
        let (state, problem) = (&mut self.state, &*self.problem);
        match &mut state.step {
            Step::Resumed(resumed) => {
                let equations = Equations::from_sets(problem, resumed.take());
                state.step = Step::Equations(equations);
                self.known = None;
                return;
            }
            Step::Cascade(cascade) => {
                state.step = Step::JunkFilter(JunkFilter::new(cascade.supersets(problem), false));
                return;
            }
            Step::Equations(equations) => {
                state.step = Step::JunkFilter(JunkFilter::new(equations.supersets(problem), true));
                return;
            }
            Step::Carried(carried) => {
                state.carried = Some(std::mem::take(carried));
                state.step = Step::Slices(Slices::above(problem.levels));
                self.known = None;
                return;
            }
            Step::Slices(slices) => {
                let mut supersets = slices.supersets();
                if state.purpose == Purpose::First {
                    supersets.extend(state.carried.as_ref().map(Carried::superset));
                }
                state.step = Step::JunkFilter(JunkFilter::new(supersets, false));
                return;
            }
            Step::JunkFilter(filter) => {
                let asked = |number: usize| problem.asked.contains(&(number as u32));
                state.dimensions = filter.dimensions();
                state.dimensions.retain(|d| asked(d.number as usize));
                let highest = *problem.asked.end() as usize;
                state.has_sets_above = state.sets.iter().any(|set| set.dimension > highest);
                state.sets.retain(|set| asked(set.dimension));
            }
            Step::Split(split) => {
                let (witness_sets, dimension) = split.components(&mut ProblemContext {
                    problem,
                    deflations: &mut self.deflations,
                });
                match state.components.is_empty() {
                    // Moved as a whole, where there are many.
                    true => state.components = witness_sets,
                    false => state.components.extend(witness_sets),
                }
                let dimensions = state.dimensions.iter_mut();
                if let Some(earlier_dimension) = dimensions
                    .into_iter()
                    .find(|d| d.number == dimension.number)
                {
                    earlier_dimension.doubts.extend(dimension.doubts);
                    earlier_dimension.found_by_loops += dimension.found_by_loops;
                }
            }
            Step::Prove(proving) => {
                let decomposition = proving.take(problem);
                state.step = Step::Done(Arc::new(decomposition));
                return;
            }
            Step::Done(_) => {}
        }
        self.state.step = match self.state.sets.is_empty() {
            false => {
                let set = self.state.sets.remove(0);
                Step::Split(Split::new(set))
            }
            true => {
                let decomposition = self.summary();
                self.conclude(decomposition)
            }
        };
    }

    /// Next step after one method has its answer: another method, or the end.
    fn conclude(&mut self, mut decomposition: Decomposition) -> Step {
        let second = self.problem.second(self.state.method);
        let verify = self.state.options.verify;
        let (purpose, method) = match (self.state.purpose, self.state.first.take()) {
            (Purpose::First, _) if self.may_go_again() && !decomposition.settled() => {
                (Purpose::Again, Method::Cascade)
            }
            (Purpose::First, _) if self.state.carried.is_some() && !decomposition.settled() => {
                (Purpose::Again, Method::Slices)
            }
            (Purpose::First, _) if verify => (Purpose::Verify, second),
            (Purpose::Verify, Some(first)) => {
                let second = std::mem::replace(&mut decomposition, *first);
                decomposition.verify(&second);
                decomposition.paths = second.paths;
                decomposition.paths_of_loops = second.paths_of_loops;
                return self.last_step(decomposition);
            }
            (Purpose::Again, Some(first))
                if !decomposition.settled() && fewer_doubts(&first, &decomposition) =>
            {
                let second = std::mem::replace(&mut decomposition, *first);
                decomposition.paths = second.paths;
                decomposition.paths_of_loops = second.paths_of_loops;
                return self.last_step(decomposition);
            }
            (Purpose::Again, _) if verify && decomposition.settled() => (Purpose::Verify, second),
            _ => return self.last_step(decomposition),
        };
        self.state.first = Some(Box::new(decomposition));
        self.state.purpose = purpose;
        self.state.method = method;
        first_step(method, &self.problem)
    }

    /// Last step after all methods: proofs if they are asked for.
    fn last_step(&self, decomposition: Decomposition) -> Step {
        match self.state.options.certify {
            true => Step::Prove(Box::new(Proving::new(decomposition))),
            false => Step::Done(Arc::new(decomposition)),
        }
    }

    /// Whether the cascade follows where the first way leaves something in doubt: where a way was not asked for, and
    /// the first was not chosen because the others have far more paths.
    fn may_go_again(&self) -> bool {
        self.state.options.method.is_none() && self.state.method != Method::Slices
    }

    fn summary(&mut self) -> Decomposition {
        if self.state.method == Method::Slices {
            self.state.dimensions.iter_mut().for_each(account_for_lost);
        }
        let mut decomposition = Decomposition {
            variables: self.state.system.variables.clone(),
            method: self.state.method,
            verification: None,
            locus: false,
            asked: [*self.problem.asked.start(), *self.problem.asked.end()],
            components: std::mem::take(&mut self.state.components),
            dimensions: std::mem::take(&mut self.state.dimensions),
            paths: self.state.paths,
            paths_of_loops: self.state.paths_of_loops,
            family: None,
            removed: Vec::new(),
        };
        // A problem was made of the system at these values.
        if let Ok(system) = self.system() {
            remove_zero_denominators(&mut decomposition, &system, self.state.options.seed);
        }
        let mut decomposition = ordered(decomposition);
        decomposition.family = self.family(&decomposition);
        decomposition
    }

    /// Fate of the components of a general member of the family.
    fn family(&self, decomposition: &Decomposition) -> Option<Family> {
        let member_components = self.state.options.known.as_ref();
        let member_components = member_components
            .filter(|member_components| !member_components.parameters.is_empty())?;
        let lowest = (self.problem.variables() - self.problem.levels) as u32;
        let lowest_ids = member_components.components.iter().map(|set| set.id);
        let lowest_ids: Vec<ComponentId> = lowest_ids.filter(|id| id.dimension == lowest).collect();
        Some(match &self.state.carried {
            Some(carried) => carried.family(&self.problem, &lowest_ids, &decomposition.components),
            None => Family {
                reason: self.state.not_carried.clone(),
                ..Family::default()
            },
        })
    }

    /// The system at the values of its parameters.
    pub fn system(&self) -> Result<System, ProblemError> {
        problem::with_values(&self.state.system, &self.state.options.parameters)
            .map(std::borrow::Cow::into_owned)
    }

    /// Seed of everything random.
    pub fn seed(&self) -> u64 {
        self.state.options.seed
    }

    /// Answer, when `next` has returned `Done`.
    pub fn decomposition(&self) -> Option<&Decomposition> {
        match &self.state.step {
            Step::Done(decomposition) => Some(decomposition),
            _ => None,
        }
    }

    /// Whether the equations have sets of solutions of higher dimensions than are asked for, when `next` has returned
    /// `Done`. Sets where a denominator is 0 are among them.
    pub fn has_sets_above(&self) -> bool {
        self.state.has_sets_above
    }
}

/// Takes back the doubt about paths that failed in a dimension that was solved by itself, where loops found points to
/// which as many paths must have led: every other path ended where it is known.
fn account_for_lost(dimension: &mut Dimension) {
    let lost = Doubt::FailedPaths {
        paths: dimension.found_by_loops,
    };
    dimension.doubts.retain(|doubt| *doubt != lost);
}

/// Known components in the units of the problem, of which their equations are a part.
fn tracked(
    problem: &Problem,
    known_components: &KnownComponents,
) -> Result<TrackedSet, ProblemError> {
    let part = problem.part(|i| i < known_components.equations as usize)?;
    let tracked = TrackedSet::new(Arc::new(part), &known_components.components);
    tracked.map_err(|error| ProblemError::Known(error.to_string()))
}

/// First step of a method.
fn first_step(method: Method, problem: &Problem) -> Step {
    match method {
        Method::Cascade => Step::Cascade(Cascade::new(problem)),
        Method::Equations => Step::Equations(Equations::new(problem)),
        Method::Slices => Step::Slices(Slices::new()),
    }
}

/// Whether the first leaves no more in doubt than the second.
fn fewer_doubts(first: &Decomposition, second: &Decomposition) -> bool {
    let doubts = |decomposition: &Decomposition| -> usize {
        let sets = decomposition
            .components
            .iter()
            .map(|set| set.evidence.doubts.len());
        let dimensions = decomposition.dimensions.iter().map(|d| d.doubts.len());
        sets.chain(dimensions).sum()
    };
    doubts(first) <= doubts(second)
}

impl StagedSolve for DecompositionSolve {
    fn runner(&self) -> &StageRunner {
        &self.state.runner
    }

    fn runner_mut(&mut self) -> &mut StageRunner {
        &mut self.state.runner
    }

    fn final_answer(&self, _: &System) -> Option<Answer> {
        match &self.state.step {
            Step::Done(decomposition) => Some(Answer::Decomposition(Arc::clone(decomposition))),
            _ => None,
        }
    }

    fn is_done(&self) -> bool {
        matches!(self.state.step, Step::Done(_))
    }

    fn description(&self) -> String {
        match &self.state.step {
            Step::Resumed(resumed) => resumed.description().into(),
            Step::Carried(carried) => carried.description().into(),
            Step::Cascade(cascade) => cascade.description(&self.problem),
            Step::Equations(equations) => equations.description(&self.problem),
            Step::Slices(slices) => slices.description(&self.problem),
            Step::JunkFilter(_) => "telling junk from witness points".into(),
            Step::Split(_) => "telling components apart".into(),
            Step::Prove(proving) => proving.description(),
            Step::Done(_) => "done".into(),
        }
    }

    fn system_of(&mut self, wanted: &StageSystem) -> Arc<System> {
        match &self.state.step {
            Step::Resumed(_) => {
                let tracked_set = self.known.as_mut();
                let tracked_set = tracked_set.expect("they are known while they move");
                tracked_set.context().system(wanted)
            }
            Step::Carried(carried) => {
                let tracked_set = self.known.as_mut();
                let tracked_set = tracked_set.expect("they are known while they move");
                carried.system_of(&self.problem, &self.state.system, tracked_set, wanted)
            }
            Step::Equations(equations) => {
                equations.system_of(&self.problem, &mut self.prefixes, wanted)
            }
            _ => self.deflations.of_stage(&self.problem, wanted),
        }
    }

    fn advance(&mut self, done: Option<Job>) -> Option<Job> {
        let job = self.next_job(done);
        if job.is_none() {
            self.next_step();
        }
        job
    }
}

/// Lowest and highest dimension that components of a system can have, within the dimensions that are asked for.
pub fn dimensions(
    system: &System,
    options: &DecompositionOptions,
) -> Result<[u32; 2], ProblemError> {
    let asked = Problem::of_options(system, options)?.asked;
    Ok([*asked.start(), *asked.end()])
}

/// Decomposes in one thread, with lanes of this width.
///
/// ```
/// use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve, run_locally};
///
/// let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y; function f; f = (x - y)*(x^2 + y^2 - 1);\nEND;\n";
/// let system = cognate_systems::formats::read("example", text)?.system;
/// let solve = DecompositionSolve::new(&system, &DecompositionOptions::default())?;
/// let decomposition = run_locally(solve, 8)?;
/// let degrees: Vec<u64> = decomposition.components.iter().map(|set| set.degree).collect();
/// assert_eq!(degrees, [2, 1]);
/// assert!(decomposition.settled());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_locally(solve: DecompositionSolve, width: usize) -> Result<Decomposition, PrepareError> {
    let system = Arc::clone(&solve.state.system);
    let mut root = Root::new(solve);
    run_locally::run_locally(&system, &mut root, &|_| None, width)?;
    let decomposition = root.solve.decomposition().cloned();
    Ok(decomposition.expect("it says what it found when it is done"))
}
