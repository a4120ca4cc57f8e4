//! Free numbers: those that a mechanism's file leaves open with "?", named as the bar, or `joint.field`.

use super::read::{described, read_options, wrong};
use crate::error::ClientError;
use crate::mechanism::arguments::MechanismFile;
use crate::problem::read_file;
use cognate_kinematics::mechanism::{self, Mechanism};
use serde_json::Value;
use std::path::Path;

/// Text in a file in the place of a number that is open.
const OPEN: &str = "?";

/// A mechanism's file with open numbers.
pub(super) struct FreeNumbers {
    /// Names of the open numbers, in the order of the file.
    pub names: Vec<String>,
    /// Name of the file.
    pub file: String,
    tree: Value,
}

impl FreeNumbers {
    /// Reads the file.
    pub fn of(file: &Path) -> Result<Self, ClientError> {
        let (name, content) = read_file(file)?;
        let tree: Value = serde_json::from_slice(&content).map_err(|e| {
            let message =
                format!("open numbers are those of a mechanism in JSON, and this is none: {e}");
            wrong(&name, message)
        })?;
        let mut names = Vec::new();
        collect(&tree, "", &mut names);
        if names.is_empty() {
            let message = "no number is open; write \"?\" in its place to leave it open";
            return Err(wrong(&name, message));
        }
        Ok(Self {
            names,
            file: name,
            tree,
        })
    }

    /// The mechanism with these values, which are `what`.
    pub fn mechanism(
        &self,
        given: &serde_json::Map<String, Value>,
        what: &str,
        a: &MechanismFile,
    ) -> Result<Mechanism, ClientError> {
        let mut tree = self.tree.clone();
        fill(&mut tree, "", given);
        let content = tree.to_string().into_bytes();
        let place = format!("{} at {what}", self.file);
        let mechanism = mechanism::read(&place, &content, &read_options(a));
        mechanism.map_err(|e| described(&e))
    }
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

/// The place of numbers below a field: that of a named joint or bar has its name.
fn place_in(object: &serde_json::Map<String, Value>, field: &str, place: &str) -> String {
    let name = object.get("name").and_then(Value::as_str);
    match name.filter(|_| !place.is_empty()) {
        Some(name) => format!("{name}.{field}"),
        None => field.to_owned(),
    }
}

/// Names of all open numbers, in the order of the file; places with one name are one number.
fn collect(tree: &Value, place: &str, names: &mut Vec<String>) {
    match tree {
        Value::Object(object) => {
            for (field, value) in object {
                let name = name_of(object, field, place);
                if value != OPEN {
                    collect(value, &place_in(object, field, place), names);
                } else if !names.contains(&name) {
                    names.push(name);
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
                let inside = place_in(object, &field, place);
                let value = &mut object[&field];
                match given.get(&name).filter(|_| value == OPEN) {
                    Some(number) => *value = number.clone(),
                    None => fill(value, &inside, given),
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
