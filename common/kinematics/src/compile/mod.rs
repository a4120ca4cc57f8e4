//! From mechanisms to polynomial systems, and from their solutions back to joint values.
//!
//! [`compile`] chooses a formulation by the rules of `kinematics/README.md`. A formulation gives equations with the
//! target as parameters; [`Formulation::lift`] puts a solution back into the mechanism and closes its loops there.

pub mod closure;
mod configurations;
mod constants;
pub mod families;
pub mod formulation;
mod framework;
mod invariants;
mod joint_loops;
mod left_out;
mod legs;
pub mod linkage_pose;
mod loops;
mod minors;
pub mod motion;
pub mod near_number;
mod planar;
mod planar_platform;
mod platform;
mod platform_lines;
pub mod pose_parameters;
mod postures;
mod serial;
mod singular_kind;
pub mod singular_positions;
pub mod six_joint_arm;
mod six_revolute;
pub mod text;
mod three_turns;

pub use formulation::{
    ArmFormulation, CLOSES, Configuration, Family, Formulation, KnownMember, Lifted, Problem,
    Question, Target,
};

use crate::mechanism::task::Task;
use crate::mechanism::{Body, Mechanism, MechanismError, Space};
use formulation::joint_names;

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
    let is_open_chain = matches!(&mechanism.body, Body::Chain(chain) if !chain.closed);
    if question.task != Task::Pose && !(is_open_chain && question.problem == Problem::Inverse) {
        return Err(mechanism.error(format!(
            "--task {} is for the postures of an open chain of joints",
            question.task.name()
        )));
    }
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

/// The inputs that are asked for: the question's, else the file's.
fn inputs(mechanism: &Mechanism, question: &Question) -> Result<Vec<String>, MechanismError> {
    if question.problem != Problem::Forward {
        return Ok(Vec::new());
    }
    let wanted = question.inputs.as_ref().unwrap_or(&mechanism.inputs);
    let joint_values = mechanism.values();
    for (i, name) in wanted.iter().enumerate() {
        if !joint_values.iter().any(|(n, _)| n == name) {
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

/// A length of a mechanism, by which others are large or small.
pub fn size(mechanism: &Mechanism) -> f64 {
    match &mechanism.body {
        Body::Chain(chain) => chain.size(),
        Body::Platform(platform) => platform::size(platform),
        Body::Linkage(linkage) => linkage_pose::size(linkage),
        Body::Framework(framework) => {
            let lengths = framework.bars.iter().map(|bar| bar.length.to_f64());
            lengths.fold(0.0, f64::max)
        }
    }
}
