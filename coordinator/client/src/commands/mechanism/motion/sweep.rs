//! Sweep: the motion of a mechanism with open numbers at many values of them.

use super::{Asked, answered};
use crate::commands::mechanism::read::{described, read_options, wrong};
use crate::commands::sequence::Sequence;
use crate::common_arguments::Format;
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismMotion;
use crate::output;
use crate::output::mechanisms::motion::{self as shown, SweptAnswer};
use crate::output::text::Look;
use crate::problem::read_file;
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::mechanism::{self, Mechanism};
use serde_json::Value;
use std::path::Path;

/// What stands in a file in the place of a number that is open.
const OPEN: &str = "?";

/// The mechanism at one set of values.
pub(super) struct Member {
    mechanism: Mechanism,
    asked: Asked,
    /// The values, in the order of the file's open numbers.
    values: Vec<(String, f64)>,
}

/// The mechanism of the file at each set of values.
pub(super) fn members(a: &MechanismMotion, values: &Path) -> Result<Vec<Member>, ClientError> {
    let (name, content) = read_file(&a.mechanism.file)?;
    let tree: Value = serde_json::from_slice(&content).map_err(|e| {
        let message = format!("--sweep fills in a mechanism in JSON, and this is none: {e}");
        wrong(&name, message)
    })?;
    let mut names = Vec::new();
    collect(&tree, "", &mut names);
    if names.is_empty() {
        let message = "no number is open; write \"?\" in its place to have it swept";
        return Err(wrong(&name, message));
    }
    let (origin, content) = read_file(values)?;
    let expected = "expected a list of {\"NAME\": VALUE, ..}";
    let list: Value =
        serde_json::from_slice(&content).map_err(|e| wrong(&origin, format!("{expected}: {e}")))?;
    let list = list.as_array().ok_or_else(|| wrong(&origin, expected))?;
    let mut members = Vec::new();
    for (index, given) in list.iter().enumerate() {
        let fault = |message: String| wrong(&origin, format!("values {index}: {message}"));
        let given = given.as_object().ok_or_else(|| fault(expected.into()))?;
        if let Some(strange) = given.keys().find(|key| !names.contains(key)) {
            let message = format!(
                "no number {strange} is open; there are {}",
                names.join(", ")
            );
            return Err(fault(message));
        }
        let mut filled = Vec::new();
        for free in &names {
            let value = given
                .get(free)
                .ok_or_else(|| fault(format!("{free} is missing")))?;
            let text = match value {
                Value::String(text) => text.clone(),
                value => value.to_string(),
            };
            let number = Number::read(&text)
                .ok_or_else(|| fault(format!("{free}: expected a number, found {value}")))?;
            filled.push((free.clone(), number.to_f64()));
        }
        let mut tree = tree.clone();
        fill(&mut tree, "", given);
        let content = tree.to_string().into_bytes();
        let place = format!("{name} at values {index}");
        let mechanism = mechanism::read(&place, &content, &read_options(&a.mechanism));
        let mechanism = mechanism.map_err(|e| described(&e))?;
        members.push(Member {
            asked: Asked::of(&mechanism, None)?,
            mechanism,
            values: filled,
        });
    }
    Ok(members)
}

/// The name of an open number: the bar's, or that of the joint and the field.
fn name_of(object: &serde_json::Map<String, Value>, field: &str, place: &str) -> String {
    match (
        object.get("name").and_then(Value::as_str),
        object.contains_key("between"),
    ) {
        (Some(name), true) => name.to_owned(),
        (Some(name), false) => format!("{name}.{field}"),
        (None, _) if place.is_empty() => field.to_owned(),
        (None, _) => format!("{place}.{field}"),
    }
}

/// Names of all open numbers, in the order of the file.
fn collect(tree: &Value, place: &str, names: &mut Vec<String>) {
    match tree {
        Value::Object(object) => {
            for (field, value) in object {
                let name = name_of(object, field, place);
                if value == OPEN {
                    names.push(name);
                } else {
                    collect(value, field, names);
                }
            }
        }
        Value::Array(list) => {
            for (k, value) in list.iter().enumerate() {
                let inside = format!("{place}.{k}");
                match value == OPEN {
                    true => names.push(inside),
                    false => collect(value, &inside, names),
                }
            }
        }
        _ => {}
    }
}

/// Puts values in the place of open numbers.
fn fill(tree: &mut Value, place: &str, given: &serde_json::Map<String, Value>) {
    match tree {
        Value::Object(object) => {
            let fields: Vec<String> = object.keys().cloned().collect();
            for field in fields {
                let name = name_of(object, &field, place);
                let value = &mut object[&field];
                match given.get(&name).filter(|_| value == OPEN) {
                    Some(number) => *value = number.clone(),
                    None => fill(value, &field, given),
                }
            }
        }
        Value::Array(list) => {
            for (k, value) in list.iter_mut().enumerate() {
                let inside = format!("{place}.{k}");
                match given.get(&inside).filter(|_| value == OPEN) {
                    Some(number) => *value = number.clone(),
                    None => fill(value, &inside, given),
                }
            }
        }
        _ => {}
    }
}

/// An answer for each member, in the order of the values.
pub(super) async fn answers(
    a: &MechanismMotion,
    jobs: Sequence,
    members: Vec<Member>,
) -> Result<Exit, ClientError> {
    let mut swept = Vec::new();
    for (index, member) in members.into_iter().enumerate() {
        let answer = answered(a, &jobs, &member.mechanism, &member.asked).await?;
        for doubt in &answer.doubts {
            eprintln!("warning: values {index}: {doubt}");
        }
        swept.push(SweptAnswer {
            mechanism: member.mechanism,
            values: member.values,
            answer,
        });
    }
    output::print(&match a.format {
        Format::Table => shown::swept_table(&swept, Look::of_standard_output()),
        Format::Json => shown::swept_json(&swept),
    })?;
    Ok(Exit::of_settled(
        swept.iter().all(|each| each.answer.is_settled()),
    ))
}
