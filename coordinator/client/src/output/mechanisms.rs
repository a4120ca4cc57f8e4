//! Mechanisms and their positions as tables and JSON.

use crate::mechanism::answer::{Answer, Position, TargetAnswer};
use crate::output::text::{Columns, Look, counted, magnitude, real, seconds, wrapped};
use cognate_kinematics::compile::{Formulation, Problem, Target};
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::graph::Graph;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Body, Mechanism, MechanismError, Space};
use serde_json::{Map, Value, json};
use std::f64::consts::PI;
use std::fmt::Write as _;

/// An answer and how it is shown.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// The bytes of its file.
    pub content: &'a [u8],
    /// The question: forward or inverse kinematics, or all positions.
    pub problem: Problem,
    /// The answer.
    pub answer: &'a Answer,
    /// From reading the file to the answer, in seconds.
    pub wall_seconds: f64,
    /// Angles are shown in degrees.
    pub degrees: bool,
    /// Only positions within limits are listed.
    pub only_within_limits: bool,
    /// Complex positions are listed, too.
    pub complex: bool,
}

/// So many positions are listed in a table at most.
const MOST_LISTED: usize = 64;
/// Width of the column of names.
const LABEL: usize = 14;

impl Shown<'_> {
    fn listed(&self, position: &Position) -> bool {
        (position.is_real || self.complex)
            && (!self.only_within_limits || position.within_limits() == Some(true))
    }

    fn angle(&self, value: &JointValue) -> f64 {
        match value {
            JointValue::Turn(..) if self.degrees => value.real() * (180.0 / PI),
            _ => value.real(),
        }
    }
}

/// What became of targets, and the positions of the first of them.
pub fn answer_table(shown: &Shown<'_>, look: Look) -> String {
    let answer = shown.answer;
    let family = &answer.family;
    let number = match (answer.here, family.expected) {
        (Some(here), Some(expected)) if here == expected => {
            format!("{here} for every target  ({})", family.source)
        }
        (Some(_), Some(_)) if !answer.reason.is_empty() => answer.reason.clone(),
        (Some(here), _) => format!("{here} for a general target"),
        (None, Some(expected)) => format!("at most {expected}  ({})", family.source),
        (None, None) => "no number is known beforehand".into(),
    };
    let mut text = format!(
        "{}: {}: {number}\n\n",
        look.bold(&shown.mechanism.name),
        family.name
    );
    let certified = answer
        .targets
        .iter()
        .any(|t| t.counts.certified_real.is_some());
    let limits = !shown.mechanism.limits.is_empty();
    let mut headings = vec![">target", ">complex", ">real"];
    if certified {
        headings.push(">proved");
    }
    if limits {
        headings.push(">within limits");
    }
    headings.extend([
        ">singular",
        ">at infinity",
        ">on sets",
        ">no position",
        ">failed",
    ]);
    let mut columns = Columns::new(&headings);
    for (i, target) in answer.targets.iter().enumerate() {
        let counts = &target.counts;
        let mut row = vec![i as u64 + 1, counts.complex, counts.real];
        row.extend(counts.certified_real);
        if limits {
            row.push(counts.within_limits);
        }
        row.extend([
            counts.singular,
            counts.at_infinity,
            counts.positive_dimensional,
            counts.degenerate,
            counts.failed,
        ]);
        columns.row(row.iter().map(u64::to_string).collect());
    }
    text.push_str(&columns.render(look));
    let each = shown.wall_seconds / answer.targets.len().max(1) as f64;
    let _ = writeln!(
        text,
        "\n  Time  {} for {}, {} each\n",
        seconds(shown.wall_seconds),
        counted(answer.targets.len() as u64, "target"),
        seconds(each)
    );
    text.push_str(&positions_table(shown, look));
    if !answer.settled {
        let _ = writeln!(
            text,
            "  {}",
            look.warn("not everything is settled: see the counts and warnings")
        );
    }
    text
}

fn positions_table(shown: &Shown<'_>, look: Look) -> String {
    let answer = shown.answer;
    let numbered = answer.targets.iter().enumerate().flat_map(|(i, target)| {
        let listed = target
            .positions
            .iter()
            .filter(|p| shown.listed(p))
            .enumerate();
        listed.map(move |(k, position)| (i, k, position))
    });
    let listed: Vec<(usize, usize, &Position)> = numbered.collect();
    let Some((_, _, first)) = listed.first() else {
        return "  no position to show\n".into();
    };
    let limits = !shown.mechanism.limits.is_empty();
    let forward = shown.problem != Problem::Inverse;
    let mut headings: Vec<String> = vec![">#".into()];
    let values = &first.configuration.values;
    headings.extend(values.iter().map(|(name, _)| format!(">{name}")));
    if forward && first.configuration.output.is_some() {
        let planar = shown.mechanism.space == Space::Planar;
        let pose: &[&str] = if planar {
            &[">x", ">y", ">angle"]
        } else {
            &[">x", ">y", ">z", ">qw", ">qx", ">qy", ">qz"]
        };
        headings.extend(pose.iter().map(|h| (*h).to_owned()));
    }
    if limits {
        headings.push("limits".into());
    }
    headings.push(">condition".into());
    let names: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut columns = Columns::new(&names);
    for (i, k, position) in listed.iter().take(MOST_LISTED) {
        let mut row = vec![format!("{}.{}", i + 1, k + 1)];
        let values = &position.configuration.values;
        row.extend(values.iter().map(|(_, v)| real(shown.angle(v), 6)));
        if forward && let Some(pose) = &position.configuration.output {
            row.extend(pose_numbers(shown, pose).iter().map(|x| real(*x, 6)));
        }
        if limits {
            row.push(match position.violated.is_empty() {
                true => "in".into(),
                false => position.violated.join(" "),
            });
        }
        row.push(magnitude(position.condition));
        columns.row(row);
    }
    let mut text = columns.render(look);
    if listed.len() > MOST_LISTED {
        let _ = writeln!(
            text,
            "  {} more; all of them with --format json",
            listed.len() - MOST_LISTED
        );
    }
    text
}

fn pose_numbers(shown: &Shown<'_>, pose: &Pose) -> Vec<f64> {
    let position = pose.position.map(|c| c.re);
    if shown.mechanism.space == Space::Planar {
        let turn = JointValue::Turn(pose.rotation[0][0], pose.rotation[1][0]);
        return vec![position[0], position[1], shown.angle(&turn)];
    }
    position.into_iter().chain(pose.quaternion()).collect()
}

fn digest(content: &[u8]) -> String {
    blake3::hash(content).to_hex().to_string()
}

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

fn position_json(shown: &Shown<'_>, position: &Position) -> Value {
    let planar = shown.mechanism.space == Space::Planar;
    let answer = shown.answer;
    let inverse = shown.problem == Problem::Inverse;
    let pose = |pose: &Pose| match position.is_real {
        true => pose_json(pose, planar),
        false => complex_pose_json(pose),
    };
    let (mut inputs, mut joints) = (Map::new(), Map::new());
    for (name, value) in &position.configuration.values {
        let value = value_json(value, position.is_real);
        // Inverse: every joint is an input. Forward: what was given, and the others.
        if inverse || answer.inputs.contains(name) {
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

fn target_json(shown: &Shown<'_>, index: usize, target: &TargetAnswer) -> Value {
    let counts = &target.counts;
    let listed = target.positions.iter().filter(|p| shown.listed(p));
    let given = match &target.target {
        Target::Pose(pose) => pose_json(pose, shown.mechanism.space == Space::Planar),
        Target::Inputs(values) => {
            let pairs = shown
                .answer
                .inputs
                .iter()
                .cloned()
                .zip(values.iter().map(|v| json!(v)));
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
        "solutions": listed.map(|p| position_json(shown, p)).collect::<Vec<Value>>(),
    })
}

fn snapped_json(mechanism: &Mechanism) -> Vec<Value> {
    let snapped = mechanism.snapped.iter();
    snapped
        .map(|s| json!({"place": s.place, "digits": s.digits, "degrees": s.degrees}))
        .collect()
}

/// The answer as one JSON object; angles in radians.
pub fn answer_json(shown: &Shown<'_>) -> String {
    let answer = shown.answer;
    let mechanism = shown.mechanism;
    let targets = answer.targets.iter().enumerate();
    let value = json!({
        "mechanism": {
            "name": mechanism.name,
            "digest": digest(shown.content),
            "space": mechanism.space.name(),
            "family": {
                "name": answer.family.name,
                "expected": answer.family.expected,
                "here": answer.here,
                "reason": (!answer.reason.is_empty()).then_some(&answer.reason),
                "prepared": answer.here.map(|_| "now"),
                "source": answer.family.source,
            },
            "representation": answer.family.representation,
            "symmetry": 1,
            "snapped": snapped_json(mechanism),
        },
        "problem": match shown.problem {
            Problem::Forward => "forward",
            Problem::Inverse => "inverse",
            Problem::Motion => "motion",
        },
        "angles": "rad",
        "targets": targets.map(|(i, t)| target_json(shown, i, t)).collect::<Vec<Value>>(),
        "settled": answer.settled,
        "time": {"wall_seconds": shown.wall_seconds},
        "warnings": answer.warnings,
    });
    let text = serde_json::to_string_pretty(&value);
    format!(
        "{}\n",
        text.expect("numbers and names can be written as JSON")
    )
}

/// A question that was compiled, or why it was not.
pub type Asked<'a> = (&'a str, Result<Box<dyn Formulation>, MechanismError>);

/// Number of loops of a position at which all joints are 0, and how far a closed chain is from closing.
fn home_gap(mechanism: &Mechanism) -> Option<f64> {
    match &mechanism.body {
        Body::Linkage(linkage) if linkage.at_home => Some(0.0),
        Body::Chain(chain) if chain.closed => {
            let zero: Vec<JointValue> = chain
                .joints
                .iter()
                .map(|j| JointValue::of_real(0.0, j.is_angle))
                .collect();
            Some(
                chain
                    .tool_pose(&zero)
                    .distance(&Pose::IDENTITY, chain.size()),
            )
        }
        _ => None,
    }
}

/// What a mechanism is, for people.
pub fn info_table(mechanism: &Mechanism, asked: &[Asked<'_>], look: Look) -> String {
    let graph = mechanism.graph();
    let mut text = format!(
        "{}: {}, {}, {}\n\n",
        look.bold(&mechanism.name),
        mechanism.space.name(),
        counted(graph.links.len() as u64, "link"),
        counted(graph.joints.len() as u64, "joint"),
    );
    let mut line = |label: &str, content: &str| {
        for (i, part) in wrapped(content, look.width.saturating_sub(2 + LABEL).max(20))
            .iter()
            .enumerate()
        {
            let label = if i == 0 { label } else { "" };
            let _ = writeln!(text, "  {label:<LABEL$}{part}");
        }
    };
    let names: Vec<String> = graph
        .joints
        .iter()
        .map(|j| format!("{} {}", j.name, j.kind.letter()))
        .collect();
    line("joints", &names.join(", "));
    line("loops", &graph.loops().to_string());
    match (mechanism.gruebler(), mechanism.expected_mobility()) {
        (Some(gruebler), Some(mobility)) => {
            line("gruebler", &gruebler.to_string());
            line(
                "idle",
                &format!("{} (links whose spin moves nothing else)", graph.idle),
            );
            line(
                "mobility",
                &format!("{mobility} by counting; special dimensions may move more"),
            );
        }
        (_, Some(mobility)) => line(
            "mobility",
            &format!("{mobility}; Gruebler's count knows nothing of parallelograms"),
        ),
        _ => {}
    }
    if !mechanism.inputs.is_empty() {
        line("inputs", &mechanism.inputs.join(", "));
    }
    if let Some(output) = &mechanism.output {
        line("output", &output.link);
    }
    for limits in &mechanism.limits {
        let [low, high] = limits.range;
        line(
            "limits",
            &format!("{}: {} to {}", limits.joint, real(low, 6), real(high, 6)),
        );
    }
    if let Some(gap) = home_gap(mechanism) {
        let closes = if gap < 1e-9 {
            "closes"
        } else {
            "does not close"
        };
        line(
            "home",
            &format!("all joints at 0: {closes}, gap {}", magnitude(gap)),
        );
    }
    for (name, formulation) in asked {
        line(name, &asked_line(formulation));
    }
    text.push_str("\n  adjacency\n");
    text.push_str(&adjacency(&graph));
    text
}

fn asked_line(formulation: &Result<Box<dyn Formulation>, MechanismError>) -> String {
    match formulation {
        Ok(formulation) => {
            let family = formulation.family();
            let number = match family.expected {
                Some(n) => format!("at most {n} ({})", family.source),
                None => "number found when solved".into(),
            };
            let size = match formulation.equations() {
                Some(e) => format!(
                    "{} equations in {} unknowns",
                    e.equations.len(),
                    e.unknowns()
                ),
                None => "closed form".into(),
            };
            format!(
                "{}; {}; {number}; {size}",
                family.name, family.representation
            )
        }
        Err(e) => format!("- {}", e.message),
    }
}

/// Most links of which the adjacency matrix is printed.
const MOST_COLUMNS: usize = 20;

fn adjacency(graph: &Graph) -> String {
    if graph.links.len() > MOST_COLUMNS {
        return format!(
            "  {} links; all of it with --format json\n",
            graph.links.len()
        );
    }
    let width = graph
        .links
        .iter()
        .map(|l| l.chars().count())
        .max()
        .unwrap_or(1);
    let mut text = String::new();
    for (name, row) in graph.links.iter().zip(graph.adjacency()) {
        let cells: Vec<String> = row.iter().map(|cell| format!("{cell:>2}")).collect();
        let _ = writeln!(text, "  {name:<width$} {}", cells.join(" "));
    }
    text
}

/// What a mechanism is, as one JSON object.
pub fn info_json(mechanism: &Mechanism, content: &[u8], asked: &[Asked<'_>]) -> String {
    let graph = mechanism.graph();
    let joints: Vec<Value> = graph
        .joints
        .iter()
        .map(|j| {
            let [a, b] = j.links.map(|l| graph.links[l].clone());
            json!({"name": j.name, "type": j.kind.letter(), "links": [a, b]})
        })
        .collect();
    let mut problems = Map::new();
    for (name, formulation) in asked {
        let value = match formulation {
            Ok(f) => json!({
                "family": f.family().name,
                "expected": f.family().expected,
                "source": f.family().source,
                "representation": f.family().representation,
                "inputs": f.inputs(),
                "equations": f.equations().map(|e| e.equations.len()),
                "unknowns": f.equations().map(cognate_kinematics::compile::text::Equations::unknowns),
            }),
            Err(e) => json!({"refused": e.message}),
        };
        problems.insert((*name).to_owned(), value);
    }
    let limits: Map<String, Value> = mechanism
        .limits
        .iter()
        .map(|l| (l.joint.clone(), json!(l.range)))
        .collect();
    let value = json!({
        "name": mechanism.name,
        "digest": digest(content),
        "space": mechanism.space.name(),
        "links": graph.links,
        "joints": joints,
        "adjacency": graph.adjacency(),
        "loops": graph.loops(),
        "gruebler": mechanism.gruebler(),
        "idle": graph.idle,
        "mobility": mechanism.expected_mobility(),
        "inputs": mechanism.inputs,
        "output": mechanism.output.as_ref().map(|o| &o.link),
        "limits": limits,
        "home_gap": home_gap(mechanism),
        "problems": problems,
        "snapped": snapped_json(mechanism),
        "warnings": mechanism.snapping_warnings().into_iter().chain(mechanism.warnings.iter().cloned()).collect::<Vec<String>>(),
    });
    let text = serde_json::to_string_pretty(&value);
    format!(
        "{}\n",
        text.expect("numbers and names can be written as JSON")
    )
}
