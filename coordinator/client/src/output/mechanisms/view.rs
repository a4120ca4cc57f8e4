//! View: how positions of a mechanism are shown, in whatever form.

use crate::output::text::real;
use cognate_kinematics::compile::Problem;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Mechanism, Space};
use cognate_mechanism_solver::postures::Position;
use cognate_mechanism_solver::preparation::Preparation;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// How positions of a mechanism are listed.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// The question: forward or inverse kinematics, or all positions.
    pub problem: Problem,
    /// Facts about the mechanism that are known before its targets.
    pub preparation: &'a Preparation,
    /// Angles are shown in degrees.
    pub degrees: bool,
    /// Only positions within limits are listed.
    pub only_within_limits: bool,
    /// Complex positions are listed, too.
    pub complex: bool,
}

impl View<'_> {
    /// Whether a position is listed.
    pub(super) fn lists(&self, position: &Position) -> bool {
        (position.is_real || self.complex)
            && (!self.only_within_limits || position.within_limits() == Some(true))
    }

    /// A joint's value in the unit that is shown.
    pub(super) fn value(&self, value: &JointValue) -> f64 {
        match self.degrees {
            true => value.real_in_degrees(),
            false => value.real(),
        }
    }

    /// How far a joint moves along a set of postures, with its unit.
    pub(super) fn span(&self, joint: &str, span: f64) -> String {
        format!("{joint} through {}", self.with_unit(joint, span))
    }

    /// A value of a joint, or a difference of two, with its unit.
    pub(super) fn with_unit(&self, joint: &str, value: f64) -> String {
        let kinds = self.mechanism.values();
        let is_angle = kinds
            .iter()
            .any(|(name, is_angle)| name == joint && *is_angle);
        let (value, unit) = match (is_angle, self.degrees) {
            (true, true) => (value * (180.0 / PI), " deg"),
            (true, false) => (value, " rad"),
            (false, _) => (value, ""),
        };
        format!("{}{unit}", real(value, 4))
    }
}

/// A pose as the numbers of its columns: place and quaternion, in the plane place and angle.
pub(super) fn pose_numbers(view: &View<'_>, pose: &Pose) -> Vec<f64> {
    let position = pose.position.map(|c| c.re);
    if view.mechanism.space == Space::Planar {
        let turn = JointValue::Turn(pose.rotation[0][0], pose.rotation[1][0]);
        return vec![position[0], position[1], view.value(&turn)];
    }
    position.into_iter().chain(pose.quaternion()).collect()
}

/// Fields that identify a mechanism.
pub(super) fn mechanism_json(mechanism: &Mechanism, content: &[u8]) -> Value {
    json!({"name": mechanism.name, "digest": digest(content), "space": mechanism.space.name()})
}

/// A digest of a file.
pub(super) fn digest(content: &[u8]) -> String {
    blake3::hash(content).to_hex().to_string()
}

/// Angles that were taken as exact right angles.
pub(super) fn snapped_json(mechanism: &Mechanism) -> Vec<Value> {
    let snapped = mechanism.snapped.iter();
    snapped
        .map(|s| json!({"place": s.place, "digits": s.digits, "degrees": s.degrees}))
        .collect()
}

/// Names of the columns of [`pose_numbers`].
pub(super) fn pose_columns(view: &View<'_>) -> &'static [&'static str] {
    match view.mechanism.space {
        Space::Planar => &["x", "y", "angle"],
        _ => &["x", "y", "z", "qw", "qx", "qy", "qz"],
    }
}
