//! The modes of a mechanism's motion as a table and as JSON.

use super::view::mechanism_json;
use crate::mechanism::motion_answer::{Meeting, MeetingPoint, Mode, MotionAnswer};
use crate::output::text::{Columns, Look, counted};
use cognate_kinematics::compile::motion::Placed;
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::{Mechanism, Space};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// How an answer is shown.
pub struct MotionView<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// The bytes of its file.
    pub content: &'a [u8],
    /// Angles are shown in degrees.
    pub degrees: bool,
}

/// The answer at one set of values of open numbers.
pub struct SweptAnswer {
    /// The mechanism with these values.
    pub mechanism: Mechanism,
    /// The values by name.
    pub values: Vec<(String, f64)>,
    /// The modes.
    pub answer: MotionAnswer,
}

/// Mobility above Gruebler's number, idle freedoms left out.
fn is_overconstrained(mechanism: &Mechanism, answer: &MotionAnswer) -> Option<bool> {
    let expected = mechanism.expected_mobility()?;
    answer.mobility().map(|mobility| mobility > expected)
}

/// The answer for programs.
pub fn json(view: &MotionView<'_>, answer: &MotionAnswer) -> String {
    let mut object = Map::new();
    object.insert(
        "mechanism".into(),
        mechanism_json(view.mechanism, view.content),
    );
    object.extend(numbers(view.mechanism, answer));
    let meets: Vec<Value> = answer.meetings.iter().map(|m| meeting(view, m)).collect();
    object.insert("meets".into(), json!(meets));
    object.insert("kinematotropic".into(), json!(answer.is_kinematotropic));
    if answer.asks_real {
        object.insert("circuits".into(), json!(answer.circuits));
    }
    object.insert("warnings".into(), json!(answer.warnings));
    format!("{:#}\n", Value::Object(object))
}

/// Components that are no positions, by the reason: dimension, degree and number of each.
pub(super) fn removed_json(removed: &BTreeMap<String, Vec<[u64; 3]>>) -> Value {
    let removed = removed.iter().map(|(reason, sets)| {
        let each = sets.iter().map(|[dimension, degree, count]| {
            json!({"dimension": dimension, "degree": degree, "count": count})
        });
        (reason.clone(), Value::Array(each.collect()))
    });
    Value::Object(removed.collect())
}

/// Fields of a mechanism's answer that are shown both for one mechanism and for one of a sweep.
fn numbers(mechanism: &Mechanism, answer: &MotionAnswer) -> Map<String, Value> {
    let mobility = answer.mobility();
    let components: Vec<Value> = answer.modes.iter().map(|m| component(answer, m)).collect();
    let fields = json!({
        "mobility": mobility,
        "assembles": mobility.map(|mobility| mobility >= 0),
        "gruebler": mechanism.gruebler(),
        "idle": mechanism.graph().idle,
        "overconstrained": is_overconstrained(mechanism, answer),
        "components": components,
        "isolated": {"complex": answer.isolated.complex, "real": answer.isolated.real},
        "removed": removed_json(&answer.removed),
        "settled": answer.is_settled(),
        "unsettled": answer.doubts,
    });
    match fields {
        Value::Object(fields) => fields,
        _ => Map::new(),
    }
}

fn component(answer: &MotionAnswer, mode: &Mode) -> Value {
    let mut fields = json!({
        "id": mode.id,
        "dimension": mode.dimension,
        "degree": mode.degree,
        "degree_in": answer.degree_in.name(),
        "multiplicity": mode.multiplicity,
        "home": mode.home,
        "real": mode.real.as_ref().map(|real| real.counts.clone()),
    });
    if answer.asks_real {
        fields["circuits"] = json!(mode.real.as_ref().map(|real| real.circuits));
    }
    if answer.asks_path {
        fields["path_degree"] = json!(mode.path_degree);
    }
    fields
}

fn meeting(view: &MotionView<'_>, meeting: &Meeting) -> Value {
    let points = meeting.points.as_ref().map(|points| {
        let each = points.iter().map(|point| position(view, point));
        each.collect::<Vec<_>>()
    });
    json!([meeting.modes[0], meeting.modes[1], points])
}

/// A common position; coordinates where it is real.
fn position(view: &MotionView<'_>, point: &MeetingPoint) -> Value {
    let mut fields = Map::new();
    fields.insert("real".into(), json!(point.is_real));
    if let Some(placed) = &point.placed {
        fields.extend(placed_fields(view.mechanism, view.degrees, placed));
    }
    Value::Object(fields)
}

/// The value of a joint, in the unit that is wanted.
pub(super) fn joint_value(value: &JointValue, degrees: bool) -> f64 {
    match degrees {
        true => value.real_in_degrees(),
        false => value.real(),
    }
}

/// The configuration under the name of what gives it: `joints`, `points` or `pose`.
pub(super) fn placed_fields(
    mechanism: &Mechanism,
    degrees: bool,
    placed: &Placed,
) -> Map<String, Value> {
    let (name, value) = match placed {
        Placed::Joints(values) => {
            let value = |(name, value): &(String, JointValue)| {
                (name.clone(), json!(joint_value(value, degrees)))
            };
            ("joints", Value::Object(values.iter().map(value).collect()))
        }
        Placed::Points(points) => {
            let place = |(name, place): &(String, [_; 2])| {
                let [x, y]: &[num_complex::Complex64; 2] = place;
                (name.clone(), json!([x.re, y.re]))
            };
            ("points", Value::Object(points.iter().map(place).collect()))
        }
        Placed::Pose(pose) => {
            let position = pose.position.map(|c| c.re);
            let pose = match mechanism.space {
                Space::Planar => json!({"position": position[..2]}),
                _ => json!({"position": position, "quaternion": pose.quaternion()}),
            };
            ("pose", pose)
        }
    };
    Map::from_iter([(name.to_owned(), value)])
}

/// Answers at many values of open numbers, for programs.
pub fn swept_json(swept: &[SweptAnswer]) -> String {
    let names = swept.first().map_or_else(Vec::new, |each| {
        let names = each.values.iter().map(|(name, _)| name.clone());
        names.collect()
    });
    let each = swept.iter().map(|each| {
        let values = each.values.iter().map(|(name, x)| (name.clone(), json!(x)));
        let mut fields = Map::new();
        fields.insert("free".into(), Value::Object(values.collect()));
        fields.extend(numbers(&each.mechanism, &each.answer));
        Value::Object(fields)
    });
    let object = json!({
        "free": names,
        "values": each.collect::<Vec<_>>(),
        "settled": swept.iter().all(|each| each.answer.is_settled()),
    });
    format!("{object:#}\n")
}

/// The answer in a sentence: `moves with 1 freedom in 2 ways (Gruebler 1)`.
fn headline(mechanism: &Mechanism, answer: &MotionAnswer) -> String {
    let ways = answer.modes.len() as u64;
    let text = match answer.mobility() {
        Some(-1) => "cannot be assembled".to_owned(),
        Some(0) => {
            let isolated = answer.isolated.complex.unwrap_or(0);
            let real = answer
                .isolated
                .real
                .map_or_else(|| "?".into(), |n| n.to_string());
            format!(
                "rigid in {}, {real} of them real",
                counted(isolated, "position")
            )
        }
        Some(mobility) => format!(
            "moves with {} in {}",
            counted(mobility.unsigned_abs(), "freedom"),
            counted(ways, "way")
        ),
        None => format!("{} found, not all settled", counted(ways, "way")),
    };
    match mechanism.gruebler() {
        Some(gruebler) => format!("{text} (Gruebler {gruebler})"),
        None => text,
    }
}

/// The word for a dimension.
pub(super) fn shape(dimension: u32) -> String {
    match dimension {
        1 => "curve".into(),
        2 => "surface".into(),
        n => format!("{n} freedoms"),
    }
}

/// The modes, a row each.
fn rows(answer: &MotionAnswer, look: Look) -> String {
    let number = |x: Option<u64>| x.map_or_else(|| "?".to_owned(), |x| x.to_string());
    let mut headings = vec!["mode", "", ">degree", ">multiplicity"];
    if answer.asks_real {
        headings.push(">circuits");
    }
    if answer.asks_path {
        headings.push(">path degree");
    }
    headings.push("");
    let mut columns = Columns::new(&headings);
    for mode in &answer.modes {
        let mut row = vec![
            mode.id.clone(),
            shape(mode.dimension),
            mode.degree.to_string(),
            number(mode.multiplicity),
        ];
        if answer.asks_real {
            row.push(number(mode.real.as_ref().map(|real| real.circuits)));
        }
        if answer.asks_path {
            row.push(number(mode.path_degree));
        }
        row.push(match mode.home {
            Some(true) => "home is here".into(),
            _ => String::new(),
        });
        columns.row(row);
    }
    columns.render(look)
}

/// The answer for people.
pub fn table(view: &MotionView<'_>, answer: &MotionAnswer, look: Look) -> String {
    let headline = headline(view.mechanism, answer);
    let headline = match answer.is_settled() {
        true => look.good(&headline),
        false => look.warn(&headline),
    };
    let mut text = format!("{}: {headline}\n", look.bold(&view.mechanism.name));
    if !answer.modes.is_empty() {
        text.push_str(&rows(answer, look));
        text.push_str(&format!(
            "{}\n",
            look.dim(&format!("degrees in {}", answer.degree_in.name()))
        ));
    }
    for meeting in &answer.meetings {
        let [a, b] = &meeting.modes;
        text.push_str(&match &meeting.points {
            Some(points) => {
                let real = points.iter().filter(|p| p.is_real == Some(true)).count();
                let positions = counted(points.len() as u64, "position");
                format!("{a} and {b} meet in {positions}, {real} of them real\n")
            }
            None => {
                format!("{a} and {b} meet in infinitely many positions, or it is not known where\n")
            }
        });
    }
    if answer.is_kinematotropic == Some(true) {
        text.push_str("kinematotropic: modes of different freedoms meet\n");
    }
    if let (true, Some(circuits)) = (answer.asks_real, answer.circuits) {
        text.push_str(&format!("{} in all\n", counted(circuits, "circuit")));
    }
    if let (Some(alone), false) = (answer.isolated.complex, answer.modes.is_empty())
        && alone > 0
    {
        let real = answer
            .isolated
            .real
            .map_or_else(|| "?".into(), |n| n.to_string());
        text.push_str(&format!(
            "rigid in {}, {real} of them real\n",
            counted(alone, "more position")
        ));
    }
    text
}

/// Answers at many values, for people: a row for each.
pub fn swept_table(swept: &[SweptAnswer], look: Look) -> String {
    let names = swept.iter().take(1).flat_map(|each| &each.values);
    let names: Vec<String> = names.map(|(name, _)| format!(">{name}")).collect();
    let mut headings: Vec<&str> = names.iter().map(String::as_str).collect();
    headings.extend([">mobility", "modes: dimension and degree"]);
    let mut columns = Columns::new(&headings);
    for each in swept {
        let mut row: Vec<String> = each.values.iter().map(|(_, x)| x.to_string()).collect();
        let mobility = each.answer.mobility();
        row.push(mobility.map_or_else(|| "?".into(), |m| m.to_string()));
        let modes = each.answer.modes.iter();
        let modes: Vec<String> = modes
            .map(|m| format!("{}:{}", m.dimension, m.degree))
            .collect();
        row.push(modes.join(" "));
        columns.row(row);
    }
    columns.render(look)
}
