//! The interface of formulations: equations with the target as parameters, and the meaning of the solutions.

use super::six_joint_arm::SixJointArm;
use super::text::Equations;
use crate::mechanism::chain::JointValue;
use crate::mechanism::pose::Pose;
use crate::mechanism::task::Task;
use crate::mechanism::{Mechanism, MechanismError, Vector};
use num_complex::Complex64;
use std::sync::Arc;

/// The kinematic problem: the values that are given and the values that are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Problem {
    /// Inputs are given.
    Forward,
    /// The output's pose is given.
    Inverse,
    /// No value is given; all positions are asked for.
    Motion,
}

/// A question about a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The kinematic problem.
    pub problem: Problem,
    /// The joints that drive it, instead of the file's.
    pub inputs: Option<Vec<String>>,
    /// Joints that are held at a value, in radians or lengths.
    pub locks: Vec<(String, f64)>,
    /// The part of a pose that is given, where poses are.
    pub task: Task,
}

impl Question {
    /// A question for whole poses, or for inputs, without held joints.
    pub fn of(problem: Problem) -> Self {
        Self {
            problem,
            inputs: None,
            locks: Vec::new(),
            task: Task::Pose,
        }
    }
}

/// Target of a question: one pose or one set of inputs.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A pose of the output.
    Pose(Pose),
    /// Values of the inputs, in radians or lengths, in their order.
    Inputs(Vec<f64>),
}

impl Target {
    /// The pose; an error where it is none.
    pub fn pose(&self) -> Result<&Pose, String> {
        match self {
            Self::Pose(pose) => Ok(pose),
            Self::Inputs(_) => Err("expected a pose".into()),
        }
    }
}

/// The family that a mechanism belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Name of the family.
    pub name: String,
    /// Solutions of a general member, where that is known.
    pub expected: Option<u64>,
    /// Source of the number of solutions.
    pub source: &'static str,
    /// Coordinates of the equations.
    pub representation: &'static str,
}

/// Known solutions of a general member.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownMember {
    /// Parameters of the known member.
    pub parameters: Vec<Complex64>,
    /// Solutions of the known member, point after point.
    pub points: Vec<Complex64>,
}

/// A position of a mechanism: what a solution means.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Values of joints, in the file's order.
    pub values: Vec<(Arc<str>, JointValue)>,
    /// The output's pose.
    pub output: Option<Pose>,
    /// Poses of bodies or places of points, by name.
    pub bodies: Vec<(Arc<str>, Pose)>,
    /// The largest gap of a loop, in parts of the mechanism's size and the solution's.
    pub residual: f64,
}

impl Configuration {
    /// A solution of a member of the family that is no target: how well it closes.
    pub fn of_member(residual: f64) -> Self {
        Self {
            values: Vec::new(),
            output: None,
            bodies: Vec::new(),
            residual,
        }
    }
}

/// Meaning of a solution of the equations.
#[derive(Clone, Debug, PartialEq)]
pub enum Lifted {
    /// A position.
    Position(Box<Configuration>),
    /// A solution that is no position, with the name of the reason.
    Degenerate(&'static str),
    /// A point of a curve of positions, along which this moves.
    Moving(&'static str),
}

/// A point of a link as functions of the unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct PathText {
    /// Numerators of its coordinates; in the plane of x + i y and x - i y.
    pub coordinates: Vec<String>,
    /// The denominator of all coordinates.
    pub denominator: String,
    /// Whether coordinates are polynomials of degree 1.
    pub is_linear: bool,
}

/// A mechanism's equations for one kind of question.
pub trait Formulation: Send + Sync {
    /// The family.
    fn family(&self) -> &Family;
    /// Names of the inputs of a target, in order; empty where it is a pose, or nothing.
    fn inputs(&self) -> &[String];
    /// The equations; `None` where an answer needs none.
    fn equations(&self) -> Option<&Equations>;
    /// The parameters at a target.
    fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String>;
    /// How many of the first parameters belong to the mechanism: they are real, and the same at all its targets.
    fn own_parameters(&self) -> usize {
        0
    }
    /// Places of parameters that count up to a common factor, block by block: the half-tangents of angles, where a
    /// formulation has no others. `None` where parameters do not follow a path of targets: then the way between those of
    /// two neighbours leads through other mechanisms.
    fn homogeneous_parameters(&self) -> Option<Vec<Vec<usize>>> {
        let names = self.equations().map_or(&[][..], |e| &e.parameters);
        let partner = |name: &str| name.strip_prefix("t_").map(|rest| format!("w_{rest}"));
        let pair = |(t, name): (usize, &String)| {
            let partner = partner(name)?;
            let w = names.iter().position(|other| *other == partner)?;
            Some(vec![t, w])
        };
        Some(names.iter().enumerate().filter_map(pair).collect())
    }
    /// Parameters of this mechanism at a general complex target, by random numbers of modulus about 1;
    /// `None` where it has no such member but the targets themselves.
    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>>;
    /// Solutions of a general member of the family, where they are known.
    fn known_member(&self) -> Option<KnownMember> {
        None
    }
    /// Returns the meaning of a solution at these parameters.
    fn lift(
        &self,
        target: Option<&Target>,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Lifted;
    /// The arm whose postures are asked for, where it is one of six free joints.
    fn arm(&self) -> Option<&dyn ArmFormulation> {
        None
    }
    /// The place of a point of a link, in the coordinates of the link; `None` where the unknowns do not tell it.
    fn path(&self, _link: &str, _point: &Vector) -> Option<PathText> {
        None
    }
    /// The answer, where no equations are needed.
    fn direct(&self, _target: &Target) -> Vec<Configuration> {
        Vec::new()
    }
}

/// The part of a formulation that concerns the arm itself, for postures of an arm with six free joints.
pub trait ArmFormulation {
    /// The arm.
    fn six_joint_arm(&self) -> &SixJointArm;
    /// The pose of the tool at general parameters, which may be complex, and the values of the free joints at a solution;
    /// `None` where the solution leaves a joint open.
    fn posture(
        &self,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Option<(Pose, Vec<JointValue>)>;
    /// The solution of the equations at a posture with these values of the free joints; `None` where that is not told.
    fn point(&self, _values: &[JointValue]) -> Option<Vec<Complex64>> {
        None
    }
    /// The position with these values of the free joints, whose tool should be at `pose`.
    fn position(&self, values: &[JointValue], pose: &Pose) -> Configuration;
}

/// Solutions are positions where loops close to this.
pub const CLOSES: f64 = 1e-6;

/// Names of the joints that have a value, in words.
pub fn joint_names(mechanism: &Mechanism) -> String {
    let names: Vec<String> = mechanism.values().into_iter().map(|(n, _)| n).collect();
    match names.len() {
        0 => "no joint of it has a value".into(),
        _ => format!("there are {}", names.join(", ")),
    }
}

/// An error where inputs and freedoms do not match, by the numbers of unknowns and equations.
pub fn unbalanced(
    mechanism: &Mechanism,
    inputs: &[String],
    unknowns: usize,
    equations: usize,
) -> Result<(), MechanismError> {
    if unknowns <= equations {
        return Ok(());
    }
    let mobility = mechanism.expected_mobility();
    let freedoms = mobility.map_or_else(String::new, |m| {
        format!(" of about {m} freedoms (Gruebler's count without idle ones)")
    });
    Err(mechanism.error(format!(
        "too few inputs{freedoms}: {} given ({}), {} more are needed; name them with --input, {}",
        inputs.len(),
        if inputs.is_empty() {
            "none".into()
        } else {
            inputs.join(", ")
        },
        unknowns - equations,
        joint_names(mechanism)
    )))
}

/// An error where more is driven than can move.
pub fn overdriven(mechanism: &Mechanism, inputs: &[String]) -> Result<(), MechanismError> {
    match mechanism.expected_mobility() {
        Some(mobility) if (inputs.len() as i64) > mobility.max(0) => {
            Err(mechanism.error(format!(
                "too many inputs: {} given ({}), and it has {mobility} freedoms (Gruebler's count without idle ones)",
                inputs.len(),
                inputs.join(", ")
            )))
        }
        _ => Ok(()),
    }
}

/// Two numbers on a line through the origin that stand for an angle: tan(angle/2) = t/w.
pub fn half_tangent(radians: f64) -> [Complex64; 2] {
    let [w, t] = crate::mechanism::exact::Angle::of_radians(radians).half;
    [t.into(), w.into()]
}

/// Cosine and sine of the angle with these two numbers.
pub fn turn_of(t: Complex64, w: Complex64) -> (Complex64, Complex64) {
    let over = w * w + t * t;
    ((w * w - t * t) / over, t * w * 2.0 / over)
}
