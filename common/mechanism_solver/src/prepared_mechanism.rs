//! PreparedMechanism: a question about a mechanism, ready for targets. Work that depends only on the mechanism is done
//! once.
//!
//! Targets are followed from the prepared mechanism in batches, a batch a thread. The answer to a target does not
//! depend on its batch. If an arm has a closed form (`closed_form`), that answers every pose at which it is beyond
//! doubt. If the paths of another target do not all end regularly at the first attempt, the target is solved again
//! alone, or left to the arm's loop (`special_pose`) if the mechanism is an arm.

use super::arm_loop::ArmLoop;
use super::cache::Cache;
use super::closed_form::ClosedForm;
use super::followed_paths::FollowedPaths;
use super::parallel;
use super::postures::{Position, Postures, Route, of_positions, of_set, sort_by_distance};
use super::preparation::{AnswerOptions, Preparation};
use super::special_pose::{self, NEARLY_REAL};
use super::start_positions::{solve_in_family, start_positions};
use cognate_algorithms::SolveOptions;
use cognate_algorithms::plan::{ClosingOptions, KnownSolutions, SolveMethod};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::prepared_family::PreparedFamily;
use cognate_continuation::stage::PrepareError;
use cognate_continuation::start_points::StoredPoints;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_kinematics::compile::closure::Closure;
use cognate_kinematics::compile::pose_parameters;
use cognate_kinematics::compile::six_joint_arm::{FREEDOMS, SixJointArm};
use cognate_kinematics::compile::{Formulation, Question, Target, compile};
use cognate_kinematics::mechanism::chain::{Chain, JointValue};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::task::Task;
use cognate_kinematics::mechanism::{Mechanism, MechanismError};
use cognate_kinematics::real_arm::RealArm;
use cognate_numeric::interruption::is_interrupted;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

/// Least and most targets that are followed side by side, if there are enough targets: the way to plan is short against
/// the paths and lanes are seldom empty, and every thread has some batches.
const BATCH: [usize; 2] = [64, 256];
/// Batches for each thread where that leaves them large enough.
const BATCHES_A_THREAD: usize = 2;
/// Condition numbers of the equations above this are looked at by the arm.
const SPECIAL: f64 = 1e8;
/// Complex postures with imaginary parts below this are looked at: those of a stretched arm whose pose has four digits.
const NEAR_FOLD: f64 = 3e-2;
/// An arm nearly reaches a pose within this: radians, or parts of its size.
const NEARLY_REACHED: f64 = 1e-3;
/// Targets whose answers are held at a time where there may be any number of them.
pub const ROUND: usize = 1024;

/// A question about a mechanism, ready for targets.
pub struct PreparedMechanism<'m> {
    mechanism: Cow<'m, Mechanism>,
    formulation: Box<dyn Formulation>,
    preparation: Preparation,
    /// The equations; `None` where an answer needs none.
    equations: Option<Tracked>,
    /// The closed form of an arm, if there is one; it answers most poses.
    closed_form: Option<ClosedForm>,
    /// The arm's loop, for poses that are special for the equations of the arm; made for the first such pose.
    arm_loop: OnceLock<Result<ArmLoop, String>>,
    certify: bool,
    near: Vec<f64>,
    threads: usize,
}

/// Equations and start solutions from which paths are followed to targets.
struct Tracked {
    /// The equations of this mechanism; their parameters are the target.
    system: System,
    /// How many of the formulation's parameters are numbers in the system.
    own: usize,
    options: SolveOptions,
    /// The solutions from which paths begin; `None` where a start system is wanted.
    start: Option<Arc<StoredPoints>>,
    /// Whether the start solutions are singular: paths begin there in the arm's loop only.
    is_singular: bool,
    /// All parameters of the formulation at the start solutions.
    general: Vec<Complex64>,
    /// The paths of an arm from the start solutions; paths to a special pose are left to the arm's loop.
    paths: Option<FollowedPaths>,
    /// Compiled stages that the paths to all targets share.
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
    formulation: &'a dyn Formulation,
    /// How many of the formulation's first parameters are numbers in the equations.
    own: usize,
    /// The arm whose loop the equations close.
    closure: Option<&'a Closure>,
}

impl PathEquations<'_> {
    /// The parameters of the equations at a target.
    pub fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String> {
        match (self.closure, target) {
            (Some(closure), Target::Pose(pose)) => Ok(closure.parameters(pose)),
            _ => Ok(self.formulation.parameters(target)?.split_off(self.own)),
        }
    }

    /// The unknowns of the equations at a position.
    pub fn point(&self, position: &Position) -> Vec<Complex64> {
        match self.closure {
            Some(closure) => closure.point(&free_values(closure.arm(), position)),
            None => position.point.clone(),
        }
    }
}

/// The values of the joints of a chain at a position, in its order: those that are held are not among them, and those that
/// were added are 0.
fn free_values(chain: &Chain, position: &Position) -> Vec<JointValue> {
    let values = &position.configuration.values;
    let value = |name: &str| values.iter().find(|(other, _)| **other == *name);
    let joints = chain.joints.iter();
    joints
        .map(|joint| match value(&joint.name) {
            Some((_, value)) => *value,
            None => JointValue::of_real(0.0, joint.is_angle),
        })
        .collect()
}

impl PreparedMechanism<'static> {
    /// Compiles and prepares; keeps the mechanism.
    pub fn owning(
        mechanism: Mechanism,
        question: &Question,
        options: &AnswerOptions,
    ) -> Result<Self, MechanismError> {
        Self::prepared(Cow::Owned(mechanism), question, options)
    }
}

impl<'m> PreparedMechanism<'m> {
    /// Compiles and prepares.
    pub fn new(
        mechanism: &'m Mechanism,
        question: &Question,
        options: &AnswerOptions,
    ) -> Result<Self, MechanismError> {
        Self::prepared(Cow::Borrowed(mechanism), question, options)
    }

    fn prepared(
        mechanism: Cow<'m, Mechanism>,
        question: &Question,
        options: &AnswerOptions,
    ) -> Result<Self, MechanismError> {
        let formulation = compile(&mechanism, question)?;
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
        let equations = tracked(&mechanism, &*formulation, options, &mut preparation)?;
        let arm = formulation.arm().map(|arm| arm.six_joint_arm());
        if arm.is_some_and(|arm| arm.task == Task::Position) {
            preparation.reason =
                "of the two solutions that each posture is, the second counts as no position"
                    .into();
        }
        if let Some(at_rest) = arm.map(|arm| arm.at_rest).filter(|n| *n > 0) {
            preparation.reason = format!(
                "it reaches poses of {} freedoms; the postures of these are those in which the added joints stay at 0",
                FREEDOMS - at_rest
            );
        }
        let closed_form = arm.filter(|_| !options.paths_only);
        let closed_form = closed_form.and_then(ClosedForm::of);
        Ok(Self {
            mechanism,
            formulation,
            preparation,
            equations,
            closed_form,
            arm_loop: OnceLock::new(),
            certify: options.certify,
            near: options.near.clone(),
            threads: parallel::threads(options.threads),
        })
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Facts about the mechanism that are known before the targets.
    pub fn preparation(&self) -> &Preparation {
        &self.preparation
    }

    /// Threads side by side.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Equations that are followed along a path of targets; an error if this is not possible.
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
        let mechanism_parameters = tracked.own;
        let blocks = blocks
            .into_iter()
            .filter(|block| block.iter().all(|place| *place >= mechanism_parameters))
            .map(|block| {
                block
                    .into_iter()
                    .map(|place| place - mechanism_parameters)
                    .collect()
            })
            .collect();
        let arm = self.formulation.arm().map(|arm| arm.six_joint_arm());
        if arm.is_some_and(|arm| !arm.is_chain()) {
            return Err(refused(
                "not in this version: a path of a chain with fewer than six joints, which general poses of a path leave; \
                 the postures at each of its poses: cognate mechanism inverse",
            ));
        }
        let of_family = PathEquations {
            system: &tracked.system,
            seed: tracked.options.seed,
            blocks,
            formulation: &*self.formulation,
            own: mechanism_parameters,
            closure: None,
        };
        // The equations of an arm's loop are singular only where the arm is: no branch ends elsewhere.
        Ok(match self.arm_loop(tracked) {
            Ok(arm_loop) => PathEquations {
                system: arm_loop.system(),
                blocks: pose_parameters::homogeneous(),
                closure: Some(arm_loop.closure()),
                ..of_family
            },
            Err(message) if tracked.is_singular => return Err(refused(&message)),
            Err(_) => of_family,
        })
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

    /// Answers targets side by side in this thread; of a task by poses that are completed.
    fn batch(&self, asked: &[Target]) -> Result<Vec<Postures>, MechanismError> {
        let arm = self.formulation.arm().map(|arm| arm.six_joint_arm());
        let Some(task) = arm.map(|arm| arm.task).filter(|task| *task != Task::Pose) else {
            return self.batch_of_completed(asked);
        };
        let completed = asked.iter().map(|target| match target {
            Target::Pose(pose) => task.completed(pose).map(Target::Pose),
            inputs => Ok(inputs.clone()),
        });
        let completed: Result<Vec<Target>, String> = completed.collect();
        let completed = completed.map_err(|message| self.mechanism.error(message))?;
        let mut answers = self.batch_of_completed(&completed)?;
        for (answer, target) in answers.iter_mut().zip(asked) {
            answer.target = target.clone();
        }
        Ok(answers)
    }

    fn batch_of_completed(&self, targets: &[Target]) -> Result<Vec<Postures>, MechanismError> {
        let Some(tracked) = &self.equations else {
            let direct = |target: &Target| {
                of_positions(&self.mechanism, target, self.formulation.direct(target))
            };
            return Ok(targets.iter().map(direct).collect());
        };
        if is_interrupted() {
            return Err(self.mechanism.error(PrepareError::Interrupted.to_string()));
        }
        let mut answers: Vec<Option<Postures>> = targets
            .iter()
            .map(|target| self.by_closed_form(target))
            .collect();
        let mut others = Vec::new();
        for (target, answer) in targets.iter().zip(&answers) {
            others.extend(answer.is_none().then_some(target));
        }
        let mut by_paths = match others.is_empty() {
            true => Vec::new(),
            false => self.by_paths(tracked, &others)?,
        }
        .into_iter();
        for answer in &mut answers {
            if answer.is_none() {
                *answer = by_paths.next();
            }
        }
        let answers = answers.into_iter().zip(targets).map(|(answer, target)| {
            let mut answer = answer.ok_or_else(|| self.mechanism.error(no_set()))?;
            answer.compare(self.preparation.here);
            if !self.near.is_empty() {
                sort_by_distance(&mut answer.positions, &self.near);
            }
            if answer.positions.iter().all(|position| !position.is_real) {
                answer.warnings.extend(self.out_of_reach(target));
            }
            answer.warnings.extend(self.nearly_reached(&answer));
            Ok(answer)
        });
        answers.collect()
    }

    /// The answer of an arm that has a closed form, where that is beyond doubt and no proof is asked for.
    fn by_closed_form(&self, target: &Target) -> Option<Postures> {
        let (closed_form, here) = (self.closed_form.as_ref()?, self.preparation.here?);
        let Target::Pose(pose) = target else {
            return None;
        };
        if self.certify {
            return None;
        }
        closed_form.answer(&self.mechanism, self.formulation.arm()?, pose, here)
    }

    /// The solutions of the equations by the closed form, as ends of paths that need not be followed: proofs begin there.
    fn ends_by_closed_form(
        &self,
        paths: &FollowedPaths,
        target: &Target,
        given: &[Complex64],
    ) -> Option<Followed> {
        // Without proofs the closed form was asked before.
        let closed_form = self.closed_form.as_ref().filter(|_| self.certify)?;
        let (arm, here) = (self.formulation.arm()?, self.preparation.here?);
        let Target::Pose(pose) = target else {
            return None;
        };
        let values = closed_form.values(pose, here)?.into_iter();
        let results = values.map(|(values, condition)| {
            let solution = arm.point(&values)?;
            Some(paths.result_at(&solution, condition))
        });
        Some(Followed {
            given: given.to_vec(),
            results: results.collect::<Option<_>>()?,
            route: Route::ClosedForm(closed_form.name()),
        })
    }

    /// The answers by paths from the prepared mechanism, and of special poses of an arm by its loop.
    fn by_paths(
        &self,
        tracked: &Tracked,
        targets: &[&Target],
    ) -> Result<Vec<Postures>, MechanismError> {
        let failed = |message: String| self.mechanism.error(message);
        if tracked.is_singular {
            let answer = |target: &&Target| match is_interrupted() {
                true => Err(failed(PrepareError::Interrupted.to_string())),
                false => self.by_loop_alone(tracked, target).map_err(failed),
            };
            return targets.iter().map(answer).collect();
        }
        let mut parameters = Vec::new();
        for target in targets {
            parameters.push(self.formulation.parameters(target).map_err(failed)?);
        }
        let mechanism_parameters = tracked.own;
        let given: Vec<Vec<Complex64>> = parameters
            .iter()
            .map(|p| p[mechanism_parameters..].to_vec())
            .collect();
        let (special, others) = self.special(tracked, targets, given).map_err(failed)?;
        let mut sets = tracked.sets(others).map_err(failed)?.into_iter();
        let questions = targets.iter().zip(&parameters).zip(special);
        let answers = questions.map(|((target, parameters), special)| match special {
            Some(answer) => Ok(answer),
            None => {
                let (set, route) = sets.next().ok_or_else(no_set)?;
                Ok(self.of_paths(tracked, (target, parameters), &set, route))
            }
        });
        answers.collect::<Result<_, String>>().map_err(failed)
    }

    /// The answer from the solutions of the equations, or where these are in doubt from the arm's loop.
    fn of_paths(
        &self,
        tracked: &Tracked,
        (target, parameters): (&Target, &[Complex64]),
        set: &SolutionSet,
        route: Route,
    ) -> Postures {
        let arm = self.formulation.arm().map(|arm| arm.six_joint_arm());
        let mut answer = of_set(
            &self.mechanism,
            &*self.formulation,
            &tracked.system,
            (target, parameters),
            set,
            self.certify,
        );
        answer.route = route;
        let is_doubtful = arm.is_some_and(|arm| is_doubtful(&answer, arm));
        // Where the equations are singular and the arm is not, proofs are those of its loop.
        let lacks_proof = |position: &Position| position.certified == Some(false);
        let is_unproved = route != Route::Paths && answer.positions.iter().any(lacks_proof);
        let by_arm = match is_doubtful || is_unproved {
            true => self.at_special_pose(tracked, target),
            false => None,
        };
        if is_doubtful && by_arm.is_none() {
            answer.settled = false;
            answer.warnings.push(
                "the equations do not decide, and the arm's loop could not be followed".into(),
            );
        }
        by_arm.unwrap_or_else(|| self.with_condition_of_arm(answer, parameters))
    }

    /// The answers of targets that are special poses of an arm, `None` for others; and the parameters of these others, with
    /// the results of their paths where they were followed.
    fn special(
        &self,
        tracked: &Tracked,
        targets: &[&Target],
        given: Vec<Vec<Complex64>>,
    ) -> Result<(Vec<Option<Postures>>, Vec<Followed>), String> {
        let Some(paths) = &tracked.paths else {
            let others = given.into_iter().map(Followed::not_yet);
            return Ok((vec![None; targets.len()], others.collect()));
        };
        let closed = targets.iter().zip(&given);
        let closed = closed.map(|(target, given)| self.ends_by_closed_form(paths, target, given));
        let closed: Vec<Option<Followed>> = closed.collect();
        let open = given.iter().zip(&closed);
        let open: Vec<Vec<Complex64>> = open
            .filter(|(_, closed)| closed.is_none())
            .map(|(given, _)| given.clone())
            .collect();
        let mut results = match open.is_empty() {
            true => Vec::new(),
            false => paths.follow(open, &tracked.family)?,
        }
        .into_iter();
        let (mut special, mut others) = (Vec::new(), Vec::new());
        for ((target, given), closed) in targets.iter().zip(given).zip(closed) {
            if is_interrupted() {
                return Err(PrepareError::Interrupted.to_string());
            }
            if let Some(followed) = closed {
                others.push(followed);
                special.push(None);
                continue;
            }
            let results: Vec<PathResult> = results.by_ref().take(paths.count()).collect();
            let is_regular = |result: &PathResult| result.outcome == PathOutcome::Regular;
            let answer = match results.iter().all(is_regular) {
                true => None,
                false => self.at_special_pose(tracked, target),
            };
            if answer.is_none() {
                others.push(Followed {
                    results,
                    ..Followed::not_yet(given)
                });
            }
            special.push(answer);
        }
        Ok((special, others))
    }

    /// How near a chain with fewer than six joints comes to a pose that it does not reach.
    fn out_of_reach(&self, target: &Target) -> Option<String> {
        let arm = self.formulation.arm()?.six_joint_arm();
        let Target::Pose(pose) = target else {
            return None;
        };
        if arm.is_chain() {
            return None;
        }
        let chain = arm.without_joints_at_rest();
        let gap = RealArm::of(&chain).nearest(pose).gap;
        Some(format!(
            "the chain does not reach this pose: the nearest that was found is off by {gap:.1e} (radians, or parts of its size)"
        ))
    }

    /// Warning about postures that a few more digits of a pose may make real: their imaginary parts are smaller than
    /// typed digits.
    fn nearly_reached(&self, answer: &Postures) -> Option<String> {
        let formulation = self.formulation.arm()?.six_joint_arm();
        let Target::Pose(pose) = &answer.target else {
            return None;
        };
        if !formulation.is_chain() {
            return None;
        }
        let is_near = |position: &&Position| !position.is_real && imaginary(position) < NEAR_FOLD;
        let near: Vec<&Position> = answer.positions.iter().filter(is_near).collect();
        let chain = &formulation.arm;
        let arm = RealArm::of(chain);
        let gaps = near
            .iter()
            .map(|position| arm.toward(pose, &free_values(chain, position)).gap);
        let gap = gaps.fold(f64::INFINITY, f64::min);
        (gap < NEARLY_REACHED).then(|| {
            format!(
                "{} postures are nearly real: the arm comes to the pose within {gap:.1e} (radians, or parts of its size), as it would \
                 with other digits of the pose",
                near.len()
            )
        })
    }

    /// Real postures of an arm with the condition number of the arm, instead of that of the equations.
    fn with_condition_of_arm(&self, mut answer: Postures, parameters: &[Complex64]) -> Postures {
        let Some(formulation) = self.formulation.arm() else {
            return answer;
        };
        let six = formulation.six_joint_arm();
        let arm = RealArm::of(&six.arm);
        let joints = six.arm.joints.len() - six.at_rest;
        for position in answer.positions.iter_mut().filter(|p| p.is_real) {
            let values = match six.task {
                Task::Pose => Some(free_values(&six.arm, position)),
                // Joints that give way at the tool have values, too, and the posture does not tell them.
                _ => formulation
                    .posture(parameters, &position.point)
                    .map(|(_, values)| RealArm::real_values(&values)),
            };
            if let Some(values) = values {
                position.condition = arm.condition(&values, joints);
            }
        }
        answer
    }

    /// The answer of an arm at a pose that is special for its equations; `None` for other mechanisms.
    fn at_special_pose(&self, tracked: &Tracked, target: &Target) -> Option<Postures> {
        self.by_loop_alone(tracked, target).ok()
    }

    /// The answer of an arm by the paths of its loop.
    fn by_loop_alone(&self, tracked: &Tracked, target: &Target) -> Result<Postures, String> {
        let pose = target.pose()?;
        let arm = self.formulation.arm().ok_or_else(no_arm)?;
        let arm_loop = self.arm_loop(tracked)?;
        let wanted = (self.certify, &self.near[..]);
        special_pose::answer(&self.mechanism, arm, arm_loop, pose, wanted)
    }

    /// The loop of an arm; an error for other mechanisms.
    fn arm_loop(&self, tracked: &Tracked) -> Result<&ArmLoop, String> {
        let arm = self.formulation.arm().ok_or_else(no_arm)?;
        let start = tracked.start.as_ref().ok_or_else(no_arm)?;
        let made = self.arm_loop.get_or_init(|| {
            let options = (tracked.options.seed, self.certify);
            ArmLoop::new(arm, &tracked.general, start, options)
        });
        made.as_ref().map_err(Clone::clone)
    }
}

/// Paths to a target.
struct Followed {
    /// The parameters of the target.
    given: Vec<Complex64>,
    /// The results of the paths; empty where they were not followed yet.
    results: Vec<PathResult>,
    /// How the results came about.
    route: Route,
}

impl Followed {
    /// Paths that are still to be followed.
    fn not_yet(given: Vec<Complex64>) -> Self {
        Self {
            given,
            results: Vec::new(),
            route: Route::Paths,
        }
    }
}

/// Whether there are positions that are neither clearly real nor clearly complex, or nearly singular ones.
fn is_doubtful(answer: &Postures, arm: &SixJointArm) -> bool {
    // Postures that the arm refuses: joints move that were added to the chain.
    let refused = match arm.is_chain() {
        true => 0,
        false => answer.counts.degenerate,
    };
    let is_doubtful = |position: &Position| match position.is_real {
        true => position.condition > SPECIAL,
        false => imaginary(position) < NEARLY_REAL,
    };
    !answer.settled
        || answer.counts.complex + refused < answer.counts.sum()
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

fn no_arm() -> String {
    "it is no arm with a loop to follow".into()
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
        is_singular: false,
        general: Vec::new(),
        paths: None,
        family: PreparedFamily::default(),
    };
    if tracked.system.parameters.is_empty() {
        return Ok(Some(tracked));
    }
    let cache = options.cache.as_deref().map(Cache::new);
    let starts = start_positions(formulation, &tracked.system, options.seed, cache.as_ref());
    let starts = starts.map_err(|message| mechanism.error(message))?;
    preparation.note(&starts);
    if starts.count == 0 {
        let others = if starts.others.is_empty() {
            "no path".into()
        } else {
            starts.others.clone()
        };
        let reason = match starts.are_singular {
            true => "not in this version: its equations are singular at every target",
            false => "it cannot reach general targets",
        };
        return Err(mechanism.error(format!(
            "of a general target of this mechanism no isolated position is known ({others}): {reason}"
        )));
    }
    tracked.own = formulation.own_parameters();
    if tracked.own > 0 {
        let numbers = starts.parameters.iter().take(tracked.own);
        let numbers: Vec<f64> = numbers.map(|p| p.re).collect();
        tracked.system = equations
            .with_first_parameters(&numbers)
            .system(&mechanism.file)?;
    }
    tracked.options.method = SolveMethod::Given(KnownSolutions {
        points: None,
        parameters: Some(starts.parameters[tracked.own..].to_vec()),
    });
    let start = Arc::new(StoredPoints {
        dimension: tracked.system.variables.len(),
        coordinates: starts.points,
    });
    tracked.is_singular = starts.are_singular;
    if formulation.arm().is_some() && !tracked.is_singular {
        let target = formulation.parameters(&Target::Pose(Pose::IDENTITY));
        let target = target.map(|mut parameters| parameters.split_off(tracked.own));
        let paths = target.and_then(|target| {
            FollowedPaths::new(&tracked.system, &tracked.options, &start, target)
        });
        tracked.paths = Some(paths.map_err(|message| mechanism.error(message))?);
    }
    tracked.general = starts.parameters;
    tracked.start = Some(start);
    Ok(Some(tracked))
}

impl Tracked {
    /// The solution sets at these values of the parameters, with the results of their paths where they were followed, and
    /// their routes. One whose paths do not all end regularly at the first attempt is solved again alone.
    fn sets(&self, followed: Vec<Followed>) -> Result<Vec<(SolutionSet, Route)>, String> {
        if followed.is_empty() {
            return Ok(Vec::new());
        }
        let (mut targets, mut results, mut routes) = (Vec::new(), Vec::new(), Vec::new());
        for paths in followed {
            targets.push(paths.given);
            results.push(paths.results);
            routes.push(paths.route);
        }
        let mut sets = match &self.paths {
            Some(paths) => {
                let results = results.into_iter().flatten().collect();
                paths.solution_sets(&self.system, targets.clone(), results, &self.family)?
            }
            None => self.solved(targets.clone())?,
        };
        if sets.len() != targets.len() {
            return Err(no_set());
        }
        let is_alone = sets.len() == 1;
        for ((set, target), route) in sets.iter_mut().zip(targets).zip(&mut routes) {
            let is_final = is_plain(set) || is_alone && *route == Route::Paths;
            if !is_final {
                *set = self.solved(vec![target])?.pop().ok_or_else(no_set)?;
                *route = Route::Paths;
            }
        }
        Ok(sets.into_iter().zip(routes).collect())
    }

    fn solved(&self, targets: Vec<Vec<Complex64>>) -> Result<Vec<SolutionSet>, String> {
        let mut options = self.options.clone();
        if self.start.is_some() {
            options.target_parameters = targets;
        }
        solve_in_family(&self.system, &options, self.start.as_ref(), &self.family)
    }
}
