//! PreparedMechanism: a question about a mechanism, ready for targets. What belongs to the mechanism is done once.
//!
//! Targets are followed from the prepared mechanism in batches, a batch a thread. What is said of a target does not
//! depend on its batch: one whose paths do not all end regularly at the first attempt is solved again alone.

use super::arm_loop::ArmLoop;
use super::cache::Cache;
use super::parallel;
use super::postures::{Position, Postures, of_positions, of_set};
use super::preparation::{AnswerOptions, Preparation};
use super::special_pose::{self, NEARLY_REAL};
use super::start_positions::{solve_in_family, start_positions};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::{ClosingOptions, KnownSolutions, SolveMethod};
use cognate_continuation::prepared_family::PreparedFamily;
use cognate_continuation::start_points::StoredPoints;
use cognate_kinematics::compile::{Formulation, Question, Target, compile};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Mechanism, MechanismError};
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::sync::{Arc, OnceLock};

/// Least and most targets that are followed side by side, where there are so many: enough that the way to plan is short
/// against the paths and lanes seldom empty, and few enough that every thread has some batches.
const BATCH: [usize; 2] = [64, 256];
/// Batches for each thread where that leaves them large enough.
const BATCHES_A_THREAD: usize = 2;
/// Condition numbers of the equations above this are looked at by the arm.
const SPECIAL: f64 = 1e8;
/// Targets whose answers are held at a time where there may be any number of them.
pub const ROUND: usize = 1024;

/// A question about a mechanism, ready for targets.
pub struct PreparedMechanism<'m> {
    mechanism: &'m Mechanism,
    formulation: Box<dyn Formulation>,
    preparation: Preparation,
    /// The equations; `None` where an answer needs none.
    equations: Option<Tracked>,
    /// What answers poses that are special for the equations of an arm; made for the first of them.
    arm_loop: OnceLock<Result<ArmLoop, String>>,
    certify: bool,
    threads: usize,
}

/// What is followed to targets.
struct Tracked {
    /// The equations of this mechanism; their parameters are the target.
    system: System,
    /// How many of the formulation's parameters are numbers in the system.
    own: usize,
    options: SolveOptions,
    /// The solutions from which paths begin; `None` where a start system is wanted.
    start: Option<Arc<StoredPoints>>,
    /// All parameters of the formulation there.
    general: Vec<Complex64>,
    /// What is compiled for the paths to all targets.
    family: PreparedFamily,
}

/// The equations that are followed along a path of targets.
pub struct PathEquations<'a> {
    /// The equations; their parameters are the target.
    pub system: &'a System,
    /// The seed by which they are combined where there are more than unknowns.
    pub seed: u64,
    /// Places of parameters that count up to a common factor.
    pub blocks: Vec<Vec<usize>>,
}

impl<'m> PreparedMechanism<'m> {
    /// Compiles and prepares.
    pub fn new(
        mechanism: &'m Mechanism,
        question: &Question,
        options: &AnswerOptions,
    ) -> Result<Self, MechanismError> {
        let formulation = compile(mechanism, question)?;
        let mut preparation = Preparation {
            family: formulation.family().clone(),
            inputs: formulation.inputs().to_vec(),
            here: None,
            reason: String::new(),
            from_cache: false,
            warnings: mechanism.snapping_warnings(),
            settled: true,
        };
        preparation
            .warnings
            .extend(mechanism.warnings.iter().cloned());
        let equations = tracked(mechanism, &*formulation, options, &mut preparation)?;
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        Ok(Self {
            mechanism,
            formulation,
            preparation,
            equations,
            arm_loop: OnceLock::new(),
            certify: options.certify,
            threads: if options.threads == 0 {
                cores()
            } else {
                options.threads
            },
        })
    }

    /// What is known before the targets.
    pub fn preparation(&self) -> &Preparation {
        &self.preparation
    }

    /// Threads side by side.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// What is followed along a path of targets; an error where this cannot be.
    pub fn path_equations(&self) -> Result<PathEquations<'_>, MechanismError> {
        let refused = |message: &str| self.mechanism.error(message);
        let Some(tracked) = &self.equations else {
            return Err(refused(
                "its positions have a closed form: there are no branches to follow",
            ));
        };
        let blocks = self.formulation.homogeneous_parameters();
        let Some(blocks) = blocks.filter(|_| tracked.start.is_some()) else {
            return Err(refused(
                "not in this version: a path of this mechanism; nothing is given, or its rows leap between targets",
            ));
        };
        let own = tracked.own;
        let blocks = blocks
            .into_iter()
            .filter(|block| block.iter().all(|place| *place >= own))
            .map(|block| block.into_iter().map(|place| place - own).collect())
            .collect();
        Ok(PathEquations {
            system: &tracked.system,
            seed: tracked.options.seed,
            blocks,
        })
    }

    /// The parameters of the equations at a target.
    pub fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, MechanismError> {
        let own = self.equations.as_ref().map_or(0, |tracked| tracked.own);
        let all = self.formulation.parameters(target);
        let mut all = all.map_err(|message| self.mechanism.error(message))?;
        Ok(all.split_off(own))
    }

    /// All positions of the joints in which the output has each of these poses; one answer a pose, in their order.
    pub fn inverse(&self, poses: &[Pose]) -> Result<Vec<Postures>, MechanismError> {
        let targets: Vec<Target> = poses.iter().copied().map(Target::Pose).collect();
        self.solve(&targets)
    }

    /// All positions in which the inputs have each of these values, in radians or lengths; one answer for each, in their order.
    pub fn forward(&self, inputs: &[Vec<f64>]) -> Result<Vec<Postures>, MechanismError> {
        let targets: Vec<Target> = inputs.iter().cloned().map(Target::Inputs).collect();
        self.solve(&targets)
    }

    /// Answers targets, on as many threads as there are batches; in their order.
    pub fn solve(&self, targets: &[Target]) -> Result<Vec<Postures>, MechanismError> {
        let [least, most] = BATCH;
        let size = targets.len().div_ceil(BATCHES_A_THREAD * self.threads);
        let batches: Vec<&[Target]> = targets.chunks(size.clamp(least, most)).collect();
        let answers = parallel::map(batches.len(), self.threads, |k| self.batch(batches[k]));
        let answers: Vec<Vec<Postures>> = answers.into_iter().collect::<Result<_, _>>()?;
        Ok(answers.into_iter().flatten().collect())
    }

    /// Answers targets side by side in this thread.
    fn batch(&self, targets: &[Target]) -> Result<Vec<Postures>, MechanismError> {
        let Some(tracked) = &self.equations else {
            let direct = |target: &Target| {
                of_positions(self.mechanism, target, self.formulation.direct(target))
            };
            return Ok(targets.iter().map(direct).collect());
        };
        let failed = |message: String| self.mechanism.error(message);
        let mut parameters = Vec::new();
        for target in targets {
            parameters.push(self.formulation.parameters(target).map_err(failed)?);
        }
        let own = tracked.own;
        let given: Vec<Vec<Complex64>> = parameters.iter().map(|p| p[own..].to_vec()).collect();
        let mut sets = tracked.sets(given.clone()).map_err(failed)?;
        if sets.len() > 1 {
            for (set, given) in sets.iter_mut().zip(given) {
                if !is_plain(set) {
                    let alone = tracked.sets(vec![given]).map_err(failed)?;
                    *set = alone
                        .into_iter()
                        .next()
                        .ok_or_else(no_set)
                        .map_err(failed)?;
                }
            }
        }
        if sets.len() != targets.len() {
            return Err(failed(no_set()));
        }
        let all = targets.iter().zip(&parameters).zip(&sets);
        Ok(all
            .map(|((target, parameters), set)| {
                let mut answer = of_set(
                    self.mechanism,
                    &*self.formulation,
                    &tracked.system,
                    (target, parameters),
                    set,
                    self.certify,
                );
                if is_special(&answer)
                    && let Some(special) = self.at_special_pose(tracked, target)
                {
                    answer = special;
                }
                answer.compare(self.preparation.here);
                answer
            })
            .collect())
    }

    /// The answer of an arm at a pose that is special for its equations; `None` for other mechanisms.
    fn at_special_pose(&self, tracked: &Tracked, target: &Target) -> Option<Postures> {
        let (Target::Pose(pose), Some(start)) = (target, &tracked.start) else {
            return None;
        };
        let arm = self.formulation.arm()?;
        let made = self.arm_loop.get_or_init(|| {
            let options = (tracked.options.seed, self.certify);
            ArmLoop::new(arm, &tracked.general, start, options)
        });
        let arm_loop = made.as_ref().ok()?;
        special_pose::answer(self.mechanism, arm, arm_loop, pose, self.certify).ok()
    }
}

/// Whether something other than regular solutions, clearly real or clearly complex, was met.
fn is_special(answer: &Postures) -> bool {
    let is_doubtful = |position: &Position| {
        !position.is_real && imaginary(position) < NEARLY_REAL || position.condition > SPECIAL
    };
    !answer.settled
        || answer.counts.complex < answer.counts.sum()
        || answer.positions.iter().any(is_doubtful)
}

/// The largest imaginary part of the joint values.
fn imaginary(position: &Position) -> f64 {
    let values = position.configuration.values.iter();
    values.map(|(_, v)| v.imaginary()).fold(0.0, f64::max)
}

fn no_set() -> String {
    "a target was not solved".into()
}

/// Whether each path ended at a regular point at the first attempt: then no path's result depends on another's.
fn is_plain(set: &SolutionSet) -> bool {
    set.paths.finite == set.paths.total && set.paths.retracked == 0
}

/// The equations of a mechanism and where paths to targets begin; prepares where that is needed.
fn tracked(
    mechanism: &Mechanism,
    formulation: &dyn Formulation,
    options: &AnswerOptions,
    preparation: &mut Preparation,
) -> Result<Option<Tracked>, MechanismError> {
    let Some(equations) = formulation.equations() else {
        return Ok(None);
    };
    let mut tracked = Tracked {
        system: equations.system(&mechanism.file)?,
        own: 0,
        options: SolveOptions {
            seed: options.seed,
            closings: ClosingOptions {
                certify: options.certify,
                ..ClosingOptions::default()
            },
            ..SolveOptions::default()
        },
        start: None,
        general: Vec::new(),
        family: PreparedFamily::default(),
    };
    if tracked.system.parameters.is_empty() {
        return Ok(Some(tracked));
    }
    let cache = options.cache.as_deref().map(Cache::new);
    let found = start_positions(formulation, &tracked.system, options.seed, cache.as_ref());
    let found = found.map_err(|message| mechanism.error(message))?;
    preparation.note(&found);
    if found.count == 0 {
        let others = if found.others.is_empty() {
            "no path".into()
        } else {
            found.others.clone()
        };
        return Err(mechanism.error(format!(
            "a general target of this mechanism has no isolated position ({others}): it cannot reach general targets"
        )));
    }
    tracked.own = formulation.own_parameters();
    if tracked.own > 0 {
        let numbers = found.parameters.iter().take(tracked.own);
        let numbers: Vec<f64> = numbers.map(|p| p.re).collect();
        tracked.system = equations
            .with_first_parameters(&numbers)
            .system(&mechanism.file)?;
    }
    tracked.options.method = SolveMethod::Given(KnownSolutions {
        points: None,
        parameters: Some(found.parameters[tracked.own..].to_vec()),
    });
    tracked.general = found.parameters;
    tracked.start = Some(Arc::new(StoredPoints {
        dimension: tracked.system.variables.len(),
        coordinates: found.points,
    }));
    Ok(Some(tracked))
}

impl Tracked {
    /// The solution sets at these values of the parameters.
    fn sets(&self, targets: Vec<Vec<Complex64>>) -> Result<Vec<SolutionSet>, String> {
        let mut options = self.options.clone();
        if self.start.is_some() {
            options.target_parameters = targets;
        }
        solve_in_family(&self.system, &options, self.start.as_ref(), &self.family)
    }
}
