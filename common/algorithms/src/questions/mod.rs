//! Questions to components that are known by their witness sets: membership, samples, images, degrees by groups,
//! mobility, real points, curves and surfaces, intersections, singular loci.
//!
//! Witness points move to other slices by a parameter homotopy, tracked in stages like any other. (Sommese, Wampler:
//! The Numerical Solution of Systems of Polynomials, 2005, chapters 13 to 16.)

mod centred;
mod certify;
mod check;
mod context;
mod denominators;
mod error;
mod levels;
mod locus;
mod member;
mod mirror;
mod mobility;
mod multidegree;
mod procedure;
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
#[cfg(test)]
mod tests_of_real_surfaces;

use crate::answer::AnsweredQuestion;
use crate::decomposition::job::{Job, StageSystem};
use crate::decomposition::operand;
pub use crate::decomposition::operand::{MOST_WITNESS_POINTS, OperandError};
use crate::decomposition::problem::{Problem, with_values};
use crate::decomposition::stage_runner::{StageRunner, StagedSolve};
use crate::decomposition::{DecompositionOptions, ProblemError};
use crate::run_locally;
use crate::solve::{Root, Solve};
use centred::{back, centred};
use certify::Certify;
use check::Check;
use cognate_continuation::stage::PrepareError;
use cognate_solutions::classification::Tolerances;
use cognate_solutions::denominators::Denominators;
use cognate_solutions::witness::{Answer, Question, TrackedPaths, WitnessSet};
use cognate_systems::system::System;
use context::Problems;
pub use error::QuestionError;
use locus::Locus;
use member::Member;
use mobility::Mobility;
use multidegree::Multidegree;
use num_complex::Complex64;
use procedure::{GivenSystem, Procedure};
use project::Project;
use real_curve::RealCurves;
use real_points::RealPoints;
use real_surface::RealSurfaces;
use sample::Sample;
use serde::{Deserialize, Serialize, Serializer};
use std::sync::Arc;

/// Makes the enum of all procedures. A line for each question: the name and type of its procedure, the question, and
/// how the procedure is made of it.
macro_rules! procedures {
    ($system:ident, $components:ident;
     $($name:ident($procedure:ty): $question:pat => $new:expr;)*) => {
        /// The procedure of any question.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        enum AnyProcedure {
            $($name(Box<$procedure>),)*
        }

        impl AnyProcedure {
            /// The procedure that answers a question to components of a system.
            fn new(
                question: &Question,
                $system: &System,
                $components: &[WitnessSet],
            ) -> Result<Self, QuestionError> {
                Ok(match question {
                    $($question => Self::$name(Box::new($new)),)*
                })
            }

            fn get(&self) -> &dyn Procedure {
                match self {
                    $(Self::$name(procedure) => &**procedure,)*
                }
            }

            fn get_mut(&mut self) -> &mut dyn Procedure {
                match self {
                    $(Self::$name(procedure) => &mut **procedure,)*
                }
            }
        }
    };
}

procedures! { system, components;
    Check(Check): Question::Check => Check::default();
    Certify(Certify): Question::Certify => Certify::default();
    Member(Member): Question::Member { points } => Member::new(system, points)?;
    Sample(Sample): Question::Sample(wish) => Sample::new(system, wish)?;
    Project(Project): Question::Project { onto } => Project::new(system, onto)?;
    Multidegree(Multidegree): Question::Multidegree => Multidegree::new(system);
    Mobility(Mobility): Question::Mobility { points, depth }
        => Mobility::new(system, points, *depth)?;
    RealCurve(RealCurves): Question::RealCurve(wish) => RealCurves::new(system, wish)?;
    Intersect(Locus): Question::Intersect(set) => Locus::intersection(system, components, set)?;
    SingularLocus(Locus): Question::SingularLocus => Locus::singular(system, components)?;
    RealPoints(RealPoints): Question::RealPoints => RealPoints::default();
    RealSurface(RealSurfaces): Question::RealSurface { samples } => RealSurfaces::new(*samples)?;
}

/// State of a question, as it is stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    system: Arc<System>,
    options: DecompositionOptions,
    components: Vec<WitnessSet>,
    /// The point that was moved to the origin; empty where none was.
    centre: Vec<Complex64>,
    procedure: AnyProcedure,
    runner: StageRunner,
    /// Groups of paths that met and did not come apart.
    crossings_left: u64,
    paths: TrackedPaths,
    /// The answer, once all is known.
    answer: Option<Box<Answer>>,
}

/// A question as a plan that asks for paths and learns from results.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "State")]
pub struct QuestionSolve {
    state: State,
    problems: Problems,
}

impl PartialEq for QuestionSolve {
    fn eq(&self, other: &Self) -> bool {
        self.state == other.state
    }
}

impl Serialize for QuestionSolve {
    /// As its state, which is not copied.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.state.serialize(serializer)
    }
}

impl TryFrom<State> for QuestionSolve {
    type Error = QuestionError;

    fn try_from(state: State) -> Result<Self, QuestionError> {
        state.system.check().map_err(ProblemError::from)?;
        let second = state.procedure.get().second_set();
        let problems = Problems::new(&state.system, &state.options, &state.components, second)?;
        Ok(Self { state, problems })
    }
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
            let procedure = AnyProcedure::new(&about.question, &about.system, &about.components)?;
            let mut solve =
                Self::begin(&about.system, &about.options, &about.components, procedure)?;
            solve.state.centre = about.centre;
            return Ok(solve);
        }
        let procedure = AnyProcedure::new(question, system, components)?;
        Self::begin(system, options, components, procedure)
    }

    /// A question that this procedure answers, of which nothing is known yet.
    fn begin(
        system: &System,
        options: &DecompositionOptions,
        components: &[WitnessSet],
        procedure: AnyProcedure,
    ) -> Result<Self, QuestionError> {
        Self::try_from(State {
            system: Arc::new(system.clone()),
            options: options.clone(),
            components: components.to_vec(),
            centre: Vec::new(),
            procedure,
            runner: StageRunner::default(),
            crossings_left: 0,
            paths: TrackedPaths::default(),
            answer: None,
        })
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
        self.state.answer.as_deref()
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

    /// The answer of the procedure, without points where a denominator is 0, in the given coordinates.
    fn conclude(&mut self) -> Answer {
        let state = &mut self.state;
        let options = &state.options;
        let system = with_values(&state.system, &options.parameters);
        let system = system.expect("a problem was made of the system at these values");
        let tolerances = Tolerances::default();
        let given = GivenSystem {
            system: &system,
            denominators: Denominators::of(&system, &[], &tolerances, options.seed),
            seed: options.seed,
        };
        let mut answer = state.procedure.get_mut().answer(&given);
        if !state.centre.is_empty() {
            back(&mut answer, &state.centre, self.problems.context().problem);
        }
        answer
    }
}

impl StagedSolve for QuestionSolve {
    fn runner(&self) -> &StageRunner {
        &self.state.runner
    }

    fn runner_mut(&mut self) -> &mut StageRunner {
        &mut self.state.runner
    }

    fn final_answer(&self, system: &System) -> Option<crate::Answer> {
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

    fn is_done(&self) -> bool {
        self.state.answer.is_some()
    }

    fn description(&self) -> String {
        let description = match &self.state.answer {
            Some(_) => "done",
            None => self.state.procedure.get().description(),
        };
        description.to_owned()
    }

    fn system_of(&mut self, wanted: &StageSystem) -> Arc<System> {
        let procedure = self.state.procedure.get_mut();
        procedure.system_of(&mut self.problems.context(), wanted)
    }

    fn advance(&mut self, done: Option<Job>) -> Option<Job> {
        let state = &mut self.state;
        let procedure = state.procedure.get_mut();
        if let Some(job) = &done {
            state.paths.add(&job.paths());
            if procedure.doubts_crossings() {
                state.crossings_left += job.crossings_left();
            }
        }
        let job = procedure.advance(&mut self.problems.context(), done);
        if job.is_none() && procedure.inner().is_none() {
            state.paths.add(&procedure.inner_paths());
            self.state.answer = Some(Box::new(self.conclude()));
        }
        job
    }

    fn inner(&mut self) -> Option<&mut dyn Solve> {
        self.state.procedure.get_mut().inner()
    }
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
