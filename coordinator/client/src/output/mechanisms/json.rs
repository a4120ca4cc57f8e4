//! Positions of a mechanism as JSON; angles in radians.

use super::shown::{Shown, View, digest, snapped_json};
use crate::mechanism::target_answer::{Position, TargetAnswer};
use cognate_kinematics::compile::{Problem, Target};
use cognate_kinematics::mechanism::Space;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use serde_json::{Map, Value, json};

fn pose_json(pose: &Pose, planar: bool) -> Value {
    let [x, y, z] = pose.position.map(|c| c.re);
    if planar {
        let turn = JointValue::Turn(pose.rotation[0][0], pose.rotation[1][0]);
        return json!({"position": [x, y], "angle": turn.real()});
    }
    json!({"position": [x, y, z], "quaternion": pose.quaternion()})
}

fn complex_pose_json(pose: &Pose) -> Value {
    let pair = |c: &num_complex::Complex64| json!([c.re, c.im]);
    let rows: Vec<Vec<Value>> = pose
        .rotation
        .iter()
        .map(|row| row.iter().map(pair).collect())
        .collect();
    json!({"position": pose.position.iter().map(pair).collect::<Vec<Value>>(), "rotation": rows})
}

fn value_json(value: &JointValue, is_real: bool) -> Value {
    let pair = |c: &num_complex::Complex64| json!([c.re, c.im]);
    match value {
        _ if is_real => json!(value.real()),
        JointValue::Turn(c, s) => json!({"cos": pair(c), "sin": pair(s)}),
        JointValue::Shift(d) => json!({"shift": pair(d)}),
    }
}

/// A position.
pub(super) fn position_json(view: &View<'_>, position: &Position) -> Value {
    let planar = view.mechanism.space == Space::Planar;
    let inverse = view.problem == Problem::Inverse;
    let pose = |pose: &Pose| match position.is_real {
        true => pose_json(pose, planar),
        false => complex_pose_json(pose),
    };
    let (mut inputs, mut joints) = (Map::new(), Map::new());
    for (name, value) in &position.configuration.values {
        let value = value_json(value, position.is_real);
        // Inverse: every joint is an input. Forward: what was given, and the others.
        if inverse || view.preparation.inputs.contains(name) {
            inputs.insert(name.clone(), value);
        } else {
            joints.insert(name.clone(), value);
        }
    }
    let bodies = position.configuration.bodies.iter();
    let links: Map<String, Value> = bodies.map(|(name, p)| (name.clone(), pose(p))).collect();
    json!({
        "inputs": inputs,
        "joints": joints,
        "output": position.configuration.output.as_ref().map(pose),
        "links": links,
        "real": position.is_real,
        "singular": position.is_singular,
        "certified": position.certified,
        "within_limits": position.within_limits(),
        "violated": position.violated,
        "residual": position.configuration.residual,
        "condition": position.condition.is_finite().then_some(position.condition),
    })
}

/// A target's answer.
pub fn target(view: &View<'_>, index: usize, target: &TargetAnswer) -> Value {
    let listed = target.positions.iter().filter(|p| view.lists(p));
    let solutions: Vec<Value> = listed.map(|p| position_json(view, p)).collect();
    let mut value = target_counts(view, index, target);
    value["solutions"] = Value::Array(solutions);
    value
}

/// A target's answer on a line of a stream, whose number it has.
pub fn line(view: &View<'_>, number: u64, answer: &TargetAnswer) -> Value {
    let mut value = target(view, 0, answer);
    if let Some(fields) = value.as_object_mut() {
        fields.remove("index");
        fields.insert("line".into(), json!(number));
    }
    value
}

/// A target's answer without its positions.
pub(super) fn target_counts(view: &View<'_>, index: usize, target: &TargetAnswer) -> Value {
    let counts = &target.counts;
    let given = match &target.target {
        Target::Pose(pose) => pose_json(pose, view.mechanism.space == Space::Planar),
        Target::Inputs(values) => {
            let names = view.preparation.inputs.iter().cloned();
            let pairs = names.zip(values.iter().map(|v| json!(v)));
            Value::Object(pairs.collect())
        }
    };
    json!({
        "index": index,
        "given": given,
        "configurations": {
            "complex": counts.complex,
            "real": counts.real,
            "certified_real": counts.certified_real,
            "within_limits": counts.within_limits,
            "singular": counts.singular,
            "at_infinity": counts.at_infinity,
            "positive_dimensional": counts.positive_dimensional,
            "degenerate": counts.degenerate,
            "failed": counts.failed,
        },
        "settled": target.settled,
        "warnings": target.warnings,
    })
}

/// What is known of a mechanism, as it stands at the head of its answers.
pub fn mechanism(view: &View<'_>, content: &[u8]) -> Value {
    let (mechanism, prepared) = (view.mechanism, view.preparation);
    let from = if prepared.from_cache { "cache" } else { "now" };
    json!({
        "name": mechanism.name,
        "digest": digest(content),
        "space": mechanism.space.name(),
        "family": {
            "name": prepared.family.name,
            "expected": prepared.family.expected,
            "here": prepared.here,
            "reason": (!prepared.reason.is_empty()).then_some(&prepared.reason),
            "prepared": prepared.here.map(|_| from),
            "source": prepared.family.source,
        },
        "representation": prepared.family.representation,
        "symmetry": 1,
        "snapped": snapped_json(mechanism),
    })
}

/// The answer as one JSON object.
pub fn answer(shown: &Shown<'_>) -> String {
    whole(shown, target)
}

/// The answer as one JSON object, without positions.
pub fn summary(shown: &Shown<'_>) -> String {
    whole(shown, target_counts)
}

fn whole(shown: &Shown<'_>, of_target: fn(&View<'_>, usize, &TargetAnswer) -> Value) -> String {
    let (answer, view) = (shown.answer, &shown.view);
    let targets = answer.targets.iter().enumerate();
    let value = json!({
        "mechanism": mechanism(view, shown.content),
        "problem": match view.problem {
            Problem::Forward => "forward",
            Problem::Inverse => "inverse",
            Problem::Motion => "motion",
        },
        "angles": "rad",
        "targets": targets.map(|(i, t)| of_target(view, i, t)).collect::<Vec<Value>>(),
        "settled": answer.settled,
        "time": {"wall_seconds": shown.wall_seconds, "cpu_seconds": shown.cpu_seconds},
        "warnings": answer.warnings,
    });
    let text = serde_json::to_string_pretty(&value);
    format!(
        "{}\n",
        text.expect("numbers and names can be written as JSON")
    )
}
