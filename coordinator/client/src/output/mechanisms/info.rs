//! Description of a mechanism, as a table and as JSON.

use super::view::{digest, snapped_json};
use crate::output::text::{Look, counted, magnitude, real, wrapped};
use cognate_kinematics::compile::Formulation;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::graph::Graph;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Body, Mechanism, MechanismError};
use cognate_mechanism_solver::closed_form::ClosedForm;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Width of the column of names.
const LABEL: usize = 14;

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

/// Description of a mechanism, for people.
pub fn table(mechanism: &Mechanism, asked: &[Asked<'_>], look: Look) -> String {
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

/// Geometric property of an arm that gives its postures a closed form; `None` if they have none.
fn closed_form(formulation: &dyn Formulation) -> Option<&'static str> {
    let arm = formulation.arm()?.six_joint_arm();
    ClosedForm::of(arm).map(|closed_form| closed_form.name())
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
                    "{} in {}",
                    counted(e.equations.len() as u64, "equation"),
                    counted(e.unknowns() as u64, "unknown")
                ),
                None => "closed form".into(),
            };
            let closed_form = closed_form(&**formulation);
            let closed_form = closed_form.map_or_else(String::new, |kind| {
                format!("; closed form ({kind}) where it is beyond doubt")
            });
            format!(
                "{}; {}; {number}; {size}{closed_form}",
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

/// Description of a mechanism, as one JSON object.
pub fn json(mechanism: &Mechanism, content: &[u8], asked: &[Asked<'_>]) -> String {
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
                "closed_form": closed_form(&**f),
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
