//! Positions of a mechanism as JSON; angles in radians.

use super::listing::{Finished, Listing, Sink};
use super::view::{View, digest, snapped_json};
use crate::error::ClientError;
use cognate_kinematics::compile::{Problem, Target};
use cognate_kinematics::mechanism::Space;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_mechanism_solver::postures::{Position, PostureSet, Postures};
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
        if inverse
            || view
                .preparation
                .inputs
                .iter()
                .any(|input| **input == **name)
        {
            inputs.insert(name.to_string(), value);
        } else {
            joints.insert(name.to_string(), value);
        }
    }
    let bodies = position.configuration.bodies.iter();
    let links: Map<String, Value> = bodies
        .map(|(name, p)| (name.to_string(), pose(p)))
        .collect();
    json!({
        "inputs": inputs,
        "joints": joints,
        "output": position.configuration.output.as_ref().map(pose),
        "links": links,
        "real": position.is_real,
        "singular": position.is_singular,
        "multiplicity": (position.multiplicity > 0).then_some(position.multiplicity),
        "dependent": position.dependent,
        "certified": position.certified,
        "within_limits": position.within_limits(),
        "violated": position.violated,
        "residual": position.configuration.residual,
        "condition": position.condition.is_finite().then_some(position.condition),
    })
}

/// A target's answer.
fn target(view: &View<'_>, index: u64, target: &Postures) -> Value {
    let listed = target.positions.iter().filter(|p| view.lists(p));
    let solutions: Vec<Value> = listed.map(|p| position_json(view, p)).collect();
    let mut value = target_counts(view, index, target);
    value["solutions"] = Value::Array(solutions);
    let sets = target.sets.iter().map(|set| set_json(view, set));
    value["sets"] = sets.collect();
    value
}

/// A set of postures.
fn set_json(view: &View<'_>, set: &PostureSet) -> Value {
    let spans = set.spans.iter();
    let spans: Map<String, Value> = spans
        .map(|(joint, span)| (joint.clone(), json!(span)))
        .collect();
    json!({
        "dimension": set.dimension,
        "joints": set.joints,
        "spans": spans,
        "closed": set.is_closed,
        "paths": set.paths,
        "posture": position_json(view, &set.posture),
    })
}

/// A target's answer on a line of a stream, whose number it has.
pub fn line(view: &View<'_>, number: u64, answer: &Postures) -> Value {
    let mut value = target(view, 0, answer);
    if let Some(fields) = value.as_object_mut() {
        fields.remove("index");
        fields.insert("line".into(), json!(number));
    }
    value
}

/// A target's answer without its positions.
pub(super) fn target_counts(view: &View<'_>, index: u64, target: &Postures) -> Value {
    let counts = &target.counts;
    let given = match &target.target {
        Target::Pose(pose) => pose_json(pose, view.mechanism.space == Space::Planar),
        Target::Inputs(values) => {
            let names = view.preparation.inputs.iter().cloned();
            let pairs = names.zip(values.iter().map(|v| json!(v)));
            Value::Object(pairs.collect())
        }
    };
    let mut value = json!({
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
    });
    if !target.held.is_empty() {
        let held = target.held.iter();
        value["held"] = held.map(|(joint, x)| (joint.clone(), json!(x))).collect();
    }
    value
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

/// The answer as one JSON object, with a line for each target.
pub struct Object<'a> {
    view: View<'a>,
    sink: Sink,
    with_positions: bool,
    is_first: bool,
}

impl<'a> Object<'a> {
    /// Writes what is known before the targets. `content` are the bytes of the mechanism's file.
    pub fn new(
        view: View<'a>,
        content: &[u8],
        with_positions: bool,
        mut sink: Sink,
    ) -> Result<Self, ClientError> {
        let problem = match view.problem {
            Problem::Forward => "forward",
            Problem::Inverse => "inverse",
            Problem::Motion => "motion",
        };
        sink.write(&format!(
            "{{\n\"mechanism\": {},\n\"problem\": \"{problem}\",\n\"angles\": \"rad\",\n\"targets\": [",
            mechanism(&view, content)
        ))?;
        Ok(Self {
            view,
            sink,
            with_positions,
            is_first: true,
        })
    }
}

impl Listing for Object<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        let comma = if std::mem::take(&mut self.is_first) {
            ""
        } else {
            ","
        };
        let value = match self.with_positions {
            true => target(&self.view, index, answer),
            false => target_counts(&self.view, index, answer),
        };
        self.sink.write(&format!("{comma}\n{value}"))
    }

    fn finish(mut self: Box<Self>, end: &Finished<'_>) -> Result<(), ClientError> {
        let time = json!({"wall_seconds": end.wall_seconds, "cpu_seconds": end.cpu_seconds});
        self.sink.write(&format!(
            "\n],\n\"settled\": {},\n\"time\": {time},\n\"warnings\": {}\n}}\n",
            end.summary.settled,
            json!(end.summary.warnings)
        ))?;
        self.sink.finish()
    }
}

/// A line of JSON for each target, with its positions.
pub struct Lines<'a> {
    view: View<'a>,
    sink: Sink,
}

impl<'a> Lines<'a> {
    /// Nothing stands before the first target.
    pub fn new(view: View<'a>, sink: Sink) -> Self {
        Self { view, sink }
    }
}

impl Listing for Lines<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        self.sink
            .write(&format!("{}\n", target(&self.view, index, answer)))
    }

    fn finish(self: Box<Self>, _: &Finished<'_>) -> Result<(), ClientError> {
        self.sink.finish()
    }
}
