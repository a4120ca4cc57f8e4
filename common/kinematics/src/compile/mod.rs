//! From mechanisms to polynomial systems, and from their solutions back to joint values.
//!
//! [`compile`] chooses a formulation by the rules of `kinematics/README.md`. A formulation gives equations with the
//! target as parameters; [`Formulation::lift`] puts a solution back into the mechanism and closes its loops there.

mod framework;
mod invariants;
mod legs;
pub mod linkage_pose;
mod loops;
mod planar;
mod planar_platform;
mod platform;
mod serial;
mod six_revolute;
pub mod text;

use crate::mechanism::chain::JointValue;
use crate::mechanism::pose::Pose;
use crate::mechanism::{Body, Mechanism, MechanismError, Space};
use num_complex::Complex64;
use text::Equations;

/// What is given and what is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Problem {
    /// Inputs are given.
    Forward,
    /// The output's pose is given.
    Inverse,
    /// Nothing is given: all positions.
    Motion,
}

/// A question about a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// What is given.
    pub problem: Problem,
    /// The joints that drive it, instead of the file's.
    pub inputs: Option<Vec<String>>,
    /// Joints that are held at a value, in radians or lengths.
    pub locks: Vec<(String, f64)>,
}

/// One pose or one set of inputs.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A pose of the output.
    Pose(Pose),
    /// Values of the inputs, in radians or lengths, in their order.
    Inputs(Vec<f64>),
}

/// The family that a mechanism belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Its name.
    pub name: String,
    /// Solutions of a general member, where that is known.
    pub expected: Option<u64>,
    /// Who says so.
    pub source: &'static str,
    /// Coordinates of the equations.
    pub representation: &'static str,
}

/// Known solutions of a general member.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownMember {
    /// Its parameters.
    pub parameters: Vec<Complex64>,
    /// Its solutions, point after point.
    pub points: Vec<Complex64>,
}

/// A position of a mechanism: what a solution means.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Values of joints, in the file's order.
    pub values: Vec<(String, JointValue)>,
    /// The output's pose.
    pub output: Option<Pose>,
    /// Poses of bodies or places of points, by name.
    pub bodies: Vec<(String, Pose)>,
    /// The largest gap of a loop, in parts of the mechanism's size and the solution's.
    pub residual: f64,
}

/// What a solution of the equations is.
#[derive(Clone, Debug, PartialEq)]
pub enum Lifted {
    /// A position.
    Position(Box<Configuration>),
    /// No position, by this name.
    Degenerate(&'static str),
    /// A point of a curve of positions, along which this moves.
    Moving(&'static str),
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
    /// Parameters of this mechanism at a general complex target, by random numbers of modulus about 1;
    /// `None` where it has no such member but the targets themselves.
    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>>;
    /// Solutions of a general member of the family, where they are known.
    fn known_member(&self) -> Option<KnownMember> {
        None
    }
    /// What a solution means, at these parameters.
    fn lift(
        &self,
        target: Option<&Target>,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Lifted;
    /// The answer, where no equations are needed.
    fn direct(&self, _target: &Target) -> Vec<Configuration> {
        Vec::new()
    }
}

/// Solutions are positions where loops close to this.
pub const CLOSES: f64 = 1e-6;

/// The formulation of a question.
pub fn compile(
    mechanism: &Mechanism,
    question: &Question,
) -> Result<Box<dyn Formulation>, MechanismError> {
    for (name, _) in &question.locks {
        if !mechanism.values().iter().any(|(n, _)| n == name) {
            return Err(mechanism.error(format!(
                "--lock {name}: there is no such joint; {}",
                joint_names(mechanism)
            )));
        }
    }
    let inputs = inputs(mechanism, question)?;
    match &mechanism.body {
        Body::Chain(chain) => serial::compile(mechanism, chain, question, inputs),
        Body::Platform(platform) => {
            if !question.locks.is_empty() {
                return Err(mechanism
                    .error("--lock is for joints of chains; a leg is held by \"at\": length"));
            }
            match (mechanism.space, question.problem) {
                (_, Problem::Inverse) => legs::compile(mechanism, platform),
                (Space::Planar, _) => {
                    planar_platform::compile(mechanism, platform, question.problem)
                }
                _ => platform::compile(mechanism, platform, question.problem),
            }
        }
        Body::Framework(framework) => framework::compile(mechanism, framework, question.problem),
        Body::Linkage(linkage) => match mechanism.space {
            Space::Planar => planar::compile(mechanism, linkage, question, inputs),
            Space::Spherical | Space::Spatial => {
                loops::compile(mechanism, linkage, question, inputs)
            }
        },
    }
}

fn joint_names(mechanism: &Mechanism) -> String {
    let names: Vec<String> = mechanism.values().into_iter().map(|(n, _)| n).collect();
    match names.len() {
        0 => "no joint of it has a value".into(),
        _ => format!("there are {}", names.join(", ")),
    }
}

/// The inputs that are asked for: the question's, else the file's.
fn inputs(mechanism: &Mechanism, question: &Question) -> Result<Vec<String>, MechanismError> {
    if question.problem != Problem::Forward {
        return Ok(Vec::new());
    }
    let wanted = question.inputs.as_ref().unwrap_or(&mechanism.inputs);
    let known = mechanism.values();
    for (i, name) in wanted.iter().enumerate() {
        if !known.iter().any(|(n, _)| n == name) {
            return Err(mechanism.error(format!(
                "--input {name}: there is no such joint; {}",
                joint_names(mechanism)
            )));
        }
        if wanted[..i].contains(name) {
            return Err(mechanism.error(format!("--input {name} is there twice")));
        }
    }
    Ok(wanted.clone())
}

/// An error where inputs and freedoms do not match, by the numbers of unknowns and equations.
fn unbalanced(
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
fn overdriven(mechanism: &Mechanism, inputs: &[String]) -> Result<(), MechanismError> {
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
fn half_tangent(radians: f64) -> [Complex64; 2] {
    let [w, t] = crate::mechanism::exact::Angle::of_radians(radians).half;
    [t.into(), w.into()]
}

/// Cosine and sine of the angle with these two numbers.
fn turn_of(t: Complex64, w: Complex64) -> (Complex64, Complex64) {
    let over = w * w + t * t;
    ((w * w - t * t) / over, t * w * 2.0 / over)
}
