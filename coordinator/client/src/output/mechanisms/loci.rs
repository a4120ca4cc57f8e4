//! All singular positions of a mechanism as a table and as JSON.

use super::motion::{joint_value, placed_fields, removed_json, shape};
use super::view::mechanism_json;
use crate::mechanism::locus_answer::{DrawnCurve, LocusAnswer, LocusComponent, SingularPosition};
use crate::output::text::{Columns, Look, counted};
use cognate_kinematics::compile::motion::Placed;
use cognate_kinematics::compile::singular_positions::SingularKind;
use cognate_kinematics::mechanism::Mechanism;
use serde_json::{Map, Value, json};

/// How an answer is shown.
pub struct LocusView<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// The bytes of its file.
    pub content: &'a [u8],
    /// Angles of joints are shown in degrees; those of inputs are radians in JSON.
    pub degrees: bool,
}

/// The answer for programs.
pub fn json(view: &LocusView<'_>, answer: &LocusAnswer) -> String {
    let components: Vec<Value> = answer
        .components
        .iter()
        .map(|c| component(answer, c))
        .collect();
    let positions = answer.positions.iter();
    let positions: Vec<Value> = positions.map(|p| position(view, answer, p)).collect();
    let curves = answer.curves.as_ref();
    let curves = curves.map(|curves| curves.iter().map(curve).collect::<Vec<Value>>());
    let object = json!({
        "mechanism": mechanism_json(view.mechanism, view.content),
        "kind": answer.kind.name(),
        "inputs": answer.kind.inputs(),
        "dimension": answer.dimension(),
        "components": components,
        "isolated": {"complex": answer.isolated.complex, "real": answer.isolated.real},
        "solutions": positions,
        "angles": {"inputs": "rad", "joints": if view.degrees { "deg" } else { "rad" }},
        "curves": curves,
        "cuspidal": null,
        "cusps": null,
        "removed": removed_json(&answer.removed),
        "settled": answer.is_settled(),
        "unsettled": answer.doubts,
        "warnings": answer.warnings,
    });
    format!("{object:#}\n")
}

fn component(answer: &LocusAnswer, component: &LocusComponent) -> Value {
    json!({
        "id": component.id,
        "dimension": component.dimension,
        "degree": component.degree,
        "degree_in": answer.degree_in.name(),
        "whole_mode": component.is_whole_mode,
    })
}

fn curve(curve: &DrawnCurve) -> Value {
    json!({"id": curve.id, "of": "outputs", "degree": curve.degree, "samples": curve.samples})
}

/// A position that is alone; values where it is real.
fn position(view: &LocusView<'_>, answer: &LocusAnswer, position: &SingularPosition) -> Value {
    let mut fields = Map::new();
    fields.insert("real".into(), json!(position.is_real));
    if let Some(Placed::Joints(values)) = &position.placed {
        let inputs = values.iter().filter(|(name, _)| answer.kind.is_input(name));
        let inputs = inputs.map(|(name, value)| (name.clone(), json!(value.real())));
        fields.insert("inputs".into(), Value::Object(inputs.collect()));
    }
    if let Some(placed) = &position.placed {
        fields.extend(placed_fields(view.mechanism, view.degrees, placed));
    }
    Value::Object(fields)
}

/// The answer in a sentence: `singular for its inputs B0 in 4 positions, 4 of them real`.
fn headline(answer: &LocusAnswer) -> String {
    let what = match &answer.kind {
        SingularKind::Inputs(names) => format!("for its inputs {}", names.join(", ")),
        SingularKind::Outputs => "for its output".into(),
    };
    let alone = answer.isolated.complex.map(|complex| {
        let real = answer.isolated.real;
        let real = real.map_or_else(|| "?".into(), |n| n.to_string());
        format!("{}, {real} of them real", counted(complex, "position"))
    });
    let components = answer.components.len() as u64;
    match (answer.dimension(), alone) {
        (Some(-1), _) => format!("nowhere singular {what}"),
        (Some(0), Some(alone)) => format!("singular {what} in {alone}"),
        (Some(_), Some(alone)) if answer.isolated.complex != Some(0) => format!(
            "singular {what} in {} and {alone}",
            counted(components, "component")
        ),
        (Some(_), _) => format!("singular {what} in {}", counted(components, "component")),
        (None, _) => format!(
            "singular {what} in {} and {}, not all settled",
            counted(components, "component"),
            counted(answer.positions.len() as u64, "position")
        ),
    }
}

/// The answer for people.
pub fn table(view: &LocusView<'_>, answer: &LocusAnswer, look: Look) -> String {
    let headline = headline(answer);
    let headline = match answer.is_settled() {
        true => look.good(&headline),
        false => look.warn(&headline),
    };
    let mut text = format!("{}: {headline}\n", look.bold(&view.mechanism.name));
    if !answer.components.is_empty() {
        text.push_str(&component_rows(answer, look));
        let unit = format!("degrees in {}", answer.degree_in.name());
        text.push_str(&format!("{}\n", look.dim(&unit)));
    }
    let real = answer.positions.iter().filter_map(|p| match &p.placed {
        Some(Placed::Joints(values)) => Some(values),
        _ => None,
    });
    let mut columns: Option<Columns> = None;
    for values in real {
        let columns = columns.get_or_insert_with(|| {
            let names: Vec<String> = values.iter().map(|(name, _)| format!(">{name}")).collect();
            Columns::new(&names.iter().map(String::as_str).collect::<Vec<_>>())
        });
        let values = values
            .iter()
            .map(|(_, value)| joint_value(value, view.degrees));
        columns.row(values.map(|x| format!("{x:.9}")).collect());
    }
    if let Some(columns) = columns {
        text.push_str(&columns.render(look));
    }
    for curve in answer.curves.iter().flatten() {
        let points = counted(curve.samples.len() as u64, "real point");
        text.push_str(&format!(
            "{} is drawn by {points}: --format json\n",
            curve.id
        ));
    }
    text
}

/// The components, a row each.
fn component_rows(answer: &LocusAnswer, look: Look) -> String {
    let mut columns = Columns::new(&["component", "", ">degree", ""]);
    for component in &answer.components {
        columns.row(vec![
            component.id.clone(),
            shape(component.dimension),
            component.degree.to_string(),
            match component.is_whole_mode {
                Some(true) => "a whole mode of the motion".into(),
                Some(false) => String::new(),
                None => "may be a whole mode of the motion".into(),
            },
        ]);
    }
    columns.render(look)
}
