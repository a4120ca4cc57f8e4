//! Questions to components that are known by their witness sets: membership, samples, images, degrees by groups,
//! mobility, real points, curves and surfaces, intersections, singular loci.
//!
//! Witness points move to other slices by a parameter homotopy, tracked in stages like any other. (Sommese, Wampler:
//! The Numerical Solution of Systems of Polynomials, 2005, chapters 13 to 16.)

mod centred;
mod certify;
mod check;
mod denominators;
mod levels;
mod locus;
mod member;
mod mirror;
mod mobility;
mod multidegree;
mod project;
mod real_box;
mod real_curve;
mod real_points;
mod real_surface;
mod sample;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_loci;
#[cfg(test)]
mod tests_of_real_curves;

use crate::answer::AnsweredQuestion;
use crate::decomposition::deflated::Deflations;
use crate::decomposition::job::{Job, StageSystem};
use crate::decomposition::operand::{self, Operand, TrackedSet};
pub use crate::decomposition::operand::{MOST_WITNESS_POINTS, OperandError};
use crate::decomposition::problem::{Problem, with_values};
use crate::decomposition::{DecompositionOptions, ProblemError};
use crate::progress::{Progress, StageProgress, VerdictCounts};
use crate::run_locally;
use crate::solve::{Next, Root, Solve, StageNumbers};
use centred::{back, centred};
use certify::Certify;
use check::Check;
use cognate_continuation::item_result::ItemResult;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::work::StageId;
use cognate_solutions::witness::question::SecondSet;
use cognate_solutions::witness::{Answer, Question, TrackedPaths, WitnessSet};
use cognate_systems::system::System;
use cognate_systems::transform::MOST_CRITICAL_VARIABLES;
use denominators::without_zero_denominators;
use locus::{Locus, Wanted};
use member::Member;
use mobility::Mobility;
use multidegree::Multidegree;
use num_complex::Complex64;
use project::Project;
use real_curve::RealCurves;
use real_points::RealPoints;
use real_surface::RealSurfaces;
use sample::Sample;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Most points in one question.
pub const MOST_POINTS: usize = 100_000;
/// Most samples of a component.
pub const MOST_SAMPLES: u64 = 1_000_000;
/// Highest order of functionals at a point.
pub const MOST_DEPTH: u32 = 20;
/// Most samples on either side of the middle of an arc.
pub const MOST_ARC_SAMPLES: u32 = 1000;

/// Most samples on either side of the middle of a slab of a surface.
pub const MOST_SURFACE_SAMPLES: u32 = 50;

/// Reason why a question cannot be asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuestionError {
    /// The system cannot be one of components.
    #[error("{0}")]
    Problem(#[from] ProblemError),
    /// A witness set is not one of the system.
    #[error("{0}")]
    Operand(#[from] OperandError),
    /// A part of the question has a value that makes no sense.
    #[error("{field}: {found}; expected {expected}")]
    Wish {
        /// The part of the question.
        field: &'static str,
        /// Value of the part in the question.
        found: String,
        /// Values that the part may have.
        expected: String,
    },
}

/// State of the question, with the results so far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Asking {
    Check(Check),
    Certify(Certify),
    Member(Member),
    Sample(Sample),
    Project(Project),
    Multidegree(Multidegree),
    Mobility(Mobility),
    RealCurve(Box<RealCurves>),
    Locus(Box<Locus>),
    RealPoints(Box<RealPoints>),
    RealSurface(Box<RealSurfaces>),
    Done(Box<Answer>),
}

/// Components of a second set, of all equations from the first of them on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Others {
    from: u32,
    components: Vec<WitnessSet>,
}

/// State of a question, as it is stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    system: Arc<System>,
    options: DecompositionOptions,
    components: Vec<WitnessSet>,
    /// The point that was moved to the origin; empty where none was.
    centre: Vec<Complex64>,
    /// Number of first equations that the components belong to, if that is not all.
    own: Option<u32>,
    /// Components of a second set.
    others: Option<Others>,
    asking: Asking,
    job: Option<Job>,
    /// Whether something that the jobs met leaves a doubt: paths that met and did not come apart.
    crossings_left: u64,
    stages: Vec<StageProgress>,
    paths: TrackedPaths,
}

impl State {
    /// A question to components of all equations, of which nothing is known yet.
    fn new(
        system: &System,
        options: &DecompositionOptions,
        components: &[WitnessSet],
        asking: Asking,
    ) -> Self {
        Self {
            system: Arc::new(system.clone()),
            options: options.clone(),
            components: components.to_vec(),
            centre: Vec::new(),
            own: None,
            others: None,
            asking,
            job: None,
            crossings_left: 0,
            stages: Vec::new(),
            paths: TrackedPaths::default(),
        }
    }
}

/// A question as a plan that asks for paths and learns from results.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "State", try_from = "State")]
pub struct QuestionSolve {
    state: State,
    sets: Sets,
}

/// Problems derived from the state; they are made again when the state is read back.
#[derive(Clone, Debug)]
struct Sets {
    /// The components, with the equations that they are of.
    first: TrackedSet,
    /// All equations.
    whole: Arc<Problem>,
    whole_deflations: Deflations,
    second: Option<TrackedSet>,
}

impl Sets {
    fn context(&mut self) -> Context<'_> {
        Context {
            problem: &self.first.problem,
            operands: &self.first.operands,
            deflations: &mut self.first.deflations,
            whole: &self.whole,
            whole_deflations: &mut self.whole_deflations,
            other: self.second.as_mut(),
        }
    }
}

impl PartialEq for QuestionSolve {
    fn eq(&self, other: &Self) -> bool {
        self.state == other.state
    }
}

impl From<QuestionSolve> for State {
    fn from(solve: QuestionSolve) -> Self {
        solve.state
    }
}

impl TryFrom<State> for QuestionSolve {
    type Error = QuestionError;

    fn try_from(state: State) -> Result<Self, QuestionError> {
        let whole = Arc::new(Problem::of_options(&state.system, &state.options)?);
        let problem = match state.own {
            None => Arc::clone(&whole),
            Some(equation_count) => Arc::new(whole.part(|i| i < equation_count as usize)?),
        };
        let first = TrackedSet::new(problem, &state.components)?;
        let second = match &state.others {
            None => None,
            Some(others) if others.from == 0 => {
                Some(TrackedSet::new(Arc::clone(&whole), &others.components)?)
            }
            Some(others) => {
                let part = whole.part(|i| i >= others.from as usize)?;
                Some(TrackedSet::new(Arc::new(part), &others.components)?)
            }
        };
        let sets = Sets {
            first,
            whole,
            whole_deflations: Deflations::default(),
            second,
        };
        Ok(Self { state, sets })
    }
}

/// All that the parts of a question need.
struct Context<'a> {
    problem: &'a Problem,
    operands: &'a [Operand],
    deflations: &'a mut Deflations,
    /// Problem of all equations, if the components are not of all.
    whole: &'a Problem,
    whole_deflations: &'a mut Deflations,
    /// A second set.
    other: Option<&'a mut TrackedSet>,
}

impl QuestionSolve {
    /// A question to these components of a system that has been checked. Each point of them is checked.
    pub fn new(
        system: &System,
        options: &DecompositionOptions,
        components: &[WitnessSet],
        question: &Question,
    ) -> Result<Self, QuestionError> {
        if let Some(about) = centred(system, options, components, question) {
            let mut solve = Self::asked(
                &about.system,
                &about.options,
                &about.components,
                &about.question,
            )?;
            solve.state.centre = about.centre;
            return Ok(solve);
        }
        Self::asked(system, options, components, question)
    }

    fn asked(
        system: &System,
        options: &DecompositionOptions,
        components: &[WitnessSet],
        question: &Question,
    ) -> Result<Self, QuestionError> {
        let count = components.len();
        let (mut component_equations, mut others) = (None, None);
        let asking = match question {
            Question::Check => Asking::Check(Check::default()),
            Question::Certify => Asking::Certify(Certify::default()),
            Question::Member { points } => Asking::Member(Member::new(system, points)?),
            Question::Sample(wish) => Asking::Sample(Sample::new(system, wish)?),
            Question::Project { onto } => Asking::Project(Project::new(system, onto)?),
            Question::Multidegree => Asking::Multidegree(Multidegree::new(system)),
            Question::Mobility { points, depth } => {
                Asking::Mobility(Mobility::new(system, points, *depth)?)
            }
            Question::RealCurve(wish) => {
                within("samples", wish.samples, MOST_ARC_SAMPLES)?;
                if let Some(tolerance) = wish.tolerance.filter(|t| !(t.is_finite() && *t > 0.0)) {
                    return Err(QuestionError::Wish {
                        field: "tolerance",
                        found: tolerance.to_string(),
                        expected: "a positive number".to_owned(),
                    });
                }
                let count = system.variables.len();
                let place = wish.projection.map(|variable| variable as usize);
                if let Some(variable) = place.filter(|&place| place >= count) {
                    return Err(QuestionError::Wish {
                        field: "projection",
                        found: variable.to_string(),
                        expected: format!("the place of one of {count} variables"),
                    });
                }
                real_box::checked(&wish.within, count)?;
                Asking::RealCurve(Box::new(RealCurves::wished(wish.clone())))
            }
            Question::Intersect(with) => {
                let equation_count = system.equations.len();
                check_second(with, components, equation_count)?;
                component_equations = ((with.own as usize) < equation_count).then_some(with.own);
                let wanted = match with.components.is_empty() {
                    true => Wanted::Equations { from: with.from },
                    false => Wanted::Others,
                };
                others = (wanted == Wanted::Others).then(|| Others {
                    from: with.from,
                    components: with.components.clone(),
                });
                Asking::Locus(Box::new(Locus::new(wanted, 0..count)))
            }
            Question::SingularLocus => {
                let n = system.variables.len();
                if n > MOST_CRITICAL_VARIABLES && components.iter().any(|c| c.dimension() > 0) {
                    return Err(QuestionError::Wish {
                        field: "singular locus",
                        found: format!("{n} variables"),
                        expected: format!("at most {MOST_CRITICAL_VARIABLES}"),
                    });
                }
                Asking::Locus(Box::new(Locus::new(Wanted::Singular, 0..count)))
            }
            Question::RealPoints => Asking::RealPoints(Box::new(RealPoints::new())),
            Question::RealSurface { samples } => {
                within("samples", *samples, MOST_SURFACE_SAMPLES)?;
                Asking::RealSurface(Box::new(RealSurfaces::new(*samples)))
            }
        };
        let state = State {
            own: component_equations,
            others,
            ..State::new(system, options, components, asking)
        };
        Self::try_from(state)
    }

    /// Real curves, told how to be followed.
    fn of_curves(
        system: &System,
        options: &DecompositionOptions,
        components: &[WitnessSet],
        curves: RealCurves,
    ) -> Result<Self, QuestionError> {
        let asking = Asking::RealCurve(Box::new(curves));
        Self::try_from(State::new(system, options, components, asking))
    }

    /// Replaces the limit of repetitions of a path; to be called while no stage is open.
    #[must_use]
    pub fn with_max_retries(mut self, max_retries: u16) -> Self {
        self.state.options.max_retries = max_retries;
        Self::try_from(self.state.clone()).unwrap_or(self)
    }

    /// The system at the values of its parameters.
    pub fn system(&self) -> Result<System, ProblemError> {
        let values = &self.state.options.parameters;
        with_values(&self.state.system, values).map(std::borrow::Cow::into_owned)
    }

    /// Seed of everything random.
    pub fn seed(&self) -> u64 {
        self.state.options.seed
    }

    /// Answer, when `next` has returned `Done`.
    pub fn answer(&self) -> Option<&Answer> {
        match &self.state.asking {
            Asking::Done(answer) => Some(answer),
            _ => None,
        }
    }

    /// Paths that were tracked, counted without repetitions.
    pub fn paths(&self) -> TrackedPaths {
        self.state.paths
    }

    /// Doubts in words; empty if all is settled.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = self.answer().map_or_else(Vec::new, Answer::doubts);
        if self.state.crossings_left > 0 {
            let left = self.state.crossings_left;
            doubts.push(format!("{left} groups of paths met and did not come apart"));
        }
        doubts
    }

    /// The system of the open job.
    fn system_of(&mut self, wanted: &StageSystem) -> Arc<System> {
        let mut with = self.sets.context();
        match &mut self.state.asking {
            Asking::Locus(asking) => asking.system_of(&mut with, wanted),
            Asking::RealPoints(asking) => asking.system_of(&mut with, wanted),
            _ => with.deflations.of_stage(with.problem, wanted),
        }
    }

    /// The job that comes after the one that is done; `None` where nothing more is asked, and the answer is there.
    fn next_job(&mut self) -> Option<Job> {
        let state = &mut self.state;
        let done = state.job.take();
        if let Some(job) = &done {
            state.paths.add(&job.paths());
            // Of fibres of a surface all points are looked at.
            if !matches!(state.asking, Asking::RealSurface(_)) {
                state.crossings_left += job.crossings_left();
            }
        }
        let mut with = self.sets.context();
        let job = match &mut state.asking {
            Asking::Check(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::Certify(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::Member(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::Sample(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::Project(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::Multidegree(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::Mobility(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::RealCurve(asking) => asking.advance(&mut with, done.as_ref()),
            Asking::Locus(asking) => asking.advance(&mut with, done),
            Asking::RealPoints(asking) => asking.advance(&mut with, done),
            Asking::RealSurface(asking) => {
                let job = asking.advance(&mut with, done.as_ref());
                if asking.has_child() {
                    return None;
                }
                job
            }
            Asking::Done(_) => None,
        };
        if job.is_none() {
            let mut answer = match &mut state.asking {
                Asking::Check(asking) => Answer::Check(asking.take()),
                Asking::Certify(asking) => Answer::Certify(asking.take()),
                Asking::Member(asking) => Answer::Member(asking.take()),
                Asking::Sample(asking) => Answer::Sample(asking.take()),
                Asking::Project(asking) => Answer::Project(asking.take()),
                Asking::Multidegree(asking) => asking.take(&state.system),
                Asking::Mobility(asking) => Answer::Mobility(asking.take()),
                Asking::RealCurve(asking) => Answer::RealCurve(asking.take()),
                Asking::Locus(asking) => {
                    let locus = asking.take(&state.system.variables);
                    Answer::Components(Box::new(locus))
                }
                Asking::RealPoints(asking) => Answer::RealPoints(asking.take()),
                Asking::RealSurface(asking) => {
                    state.paths.add(&asking.paths());
                    Answer::RealSurface(asking.take())
                }
                Asking::Done(_) => return None,
            };
            // A problem was made of the system at these values.
            if let Ok(system) = with_values(&state.system, &state.options.parameters) {
                without_zero_denominators(&mut answer, &system, state.options.seed);
            }
            if !state.centre.is_empty() {
                back(&mut answer, &state.centre, with.problem);
            }
            state.asking = Asking::Done(Box::new(answer));
        }
        job
    }
}

impl Solve for QuestionSolve {
    fn next(&mut self, numbers: &mut StageNumbers) -> Next {
        loop {
            if let Some(job) = &mut self.state.job {
                match job.next(numbers) {
                    Next::Open(mut opening) => {
                        let wanted = job.system.clone();
                        opening.system = Some(self.system_of(&wanted));
                        let stage = &opening.stage;
                        self.state.stages.push(StageProgress {
                            id: stage.id,
                            work: stage.work,
                            attempt: stage.attempt,
                            items: stage.items().unwrap_or_default(),
                            absorbed: false,
                        });
                        return Next::Open(opening);
                    }
                    Next::Wait => return Next::Wait,
                    Next::Done => {}
                }
            }
            if let Asking::Done(_) = self.state.asking {
                return Next::Done;
            }
            if let Asking::RealSurface(asking) = &mut self.state.asking
                && asking.has_child()
            {
                match asking.next(numbers) {
                    Next::Open(opening) => {
                        let stage = real_surface::progress(&opening.stage);
                        self.state.stages.push(stage);
                        return Next::Open(opening);
                    }
                    Next::Wait => return Next::Wait,
                    Next::Done => {}
                }
            }
            self.state.job = self.next_job();
        }
    }

    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = ItemResult>) {
        match (&mut self.state.job, &mut self.state.asking) {
            (Some(job), _) => job.absorb(stage, results),
            (None, Asking::RealSurface(asking)) => asking.absorb(stage, results),
            (None, _) => unreachable!("only an open stage is absorbed"),
        }
        if let Some(stage_progress) = self
            .state
            .stages
            .iter_mut()
            .find(|stage_progress| stage_progress.id == stage)
        {
            stage_progress.absorbed = true;
        }
    }

    fn progress(&self) -> Progress {
        let description = match &self.state.asking {
            Asking::Check(_) => "checking witness points",
            Asking::Certify(_) => "proving witness points",
            Asking::Member(_) => "moving slices through points",
            Asking::Sample(_) => "moving slices to samples",
            Asking::Project(_) => "moving slices to fibres",
            Asking::Multidegree(_) => "moving slices into groups",
            Asking::Mobility(_) => "asking points for their dual spaces",
            Asking::RealCurve(_) => "following real branches between critical points",
            Asking::Locus(asking) => asking.description(),
            Asking::RealPoints(asking) => asking.description(),
            Asking::RealSurface(asking) => asking.description(),
            Asking::Done(_) => "done",
        };
        Progress {
            description: description.into(),
            stages: self.state.stages.clone(),
            paths: VerdictCounts::default(),
            done: matches!(self.state.asking, Asking::Done(_)),
        }
    }

    fn answer(&self, system: &System) -> Option<crate::Answer> {
        if let Some(Answer::Components(decomposition)) = self.answer() {
            return Some(crate::Answer::Decomposition(Arc::new(
                (**decomposition).clone(),
            )));
        }
        Some(crate::Answer::Question(AnsweredQuestion {
            unknowns: system.variables.clone(),
            answer: self.answer().cloned()?,
            doubts: self.doubts(),
            paths: self.paths(),
        }))
    }
}

/// Whether a number is one of these.
fn within(field: &'static str, number: u32, most: u32) -> Result<(), QuestionError> {
    match (1..=most).contains(&number) {
        true => Ok(()),
        false => Err(QuestionError::Wish {
            field,
            found: number.to_string(),
            expected: format!("1 to {most}"),
        }),
    }
}

/// Whether a second set is one, with not too many paths.
fn check_second(
    second: &SecondSet,
    components: &[WitnessSet],
    equations: usize,
) -> Result<(), QuestionError> {
    let wrong = |description: String, expected: String| QuestionError::Wish {
        field: "intersect",
        found: description,
        expected,
    };
    let (component_equations, from) = (second.own as usize, second.from as usize);
    if component_equations == 0
        || component_equations > equations
        || from > component_equations
        || from == equations
    {
        let description = format!(
            "equations 1 to {component_equations} of the components, from {} of the others",
            from + 1
        );
        let expected =
            format!("some of {equations} for each, and all of them for one or the other");
        return Err(wrong(description, expected));
    }
    let points = |sets: &[WitnessSet]| sets.iter().map(|set| set.points.len()).sum::<usize>();
    let paths = points(components).saturating_mul(points(&second.components));
    if paths > MOST_WITNESS_POINTS {
        let expected = format!("at most {MOST_WITNESS_POINTS}");
        return Err(wrong(format!("{paths} pairs of witness points"), expected));
    }
    Ok(())
}

/// Asks in one thread, with lanes of this width: the answer, and what is not clear.
pub fn run_locally(
    solve: QuestionSolve,
    width: usize,
) -> Result<(Answer, Vec<String>), PrepareError> {
    let system = Arc::clone(&solve.state.system);
    let mut root = Root::new(solve);
    run_locally::run_locally(&system, &mut root, &|_| None, width)?;
    let doubts = root.solve.doubts();
    let answer = root.solve.answer().cloned();
    Ok((
        answer.expect("it says what it found when it is done"),
        doubts,
    ))
}

/// The deflations after which the equations of a system are regular at a point of a slice, of which only the place is
/// known; `None` where there are none.
pub fn deflation_at(
    system: &System,
    options: &DecompositionOptions,
    slice: &[Vec<num_complex::Complex64>],
    point: &[num_complex::Complex64],
) -> Result<Option<Vec<u32>>, QuestionError> {
    let problem = Problem::of_options(system, options)?;
    Ok(operand::ranks_at(&problem, slice, point))
}
