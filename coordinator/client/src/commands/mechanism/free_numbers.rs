//! Free numbers: those that a mechanism's file leaves open with "?", named as the bar, or `joint.field`.

use super::open_numbers::{OPEN, name_of, open_names, place_of};
use super::read::{described, read_options, wrong};
use crate::error::ClientError;
use crate::mechanism::arguments::MechanismFile;
use crate::problem::read_file;
use cognate_kinematics::mechanism::{self, Mechanism};
use serde_json::Value;
use std::path::Path;

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
        let names = open_names(&tree);
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

    /// The refusal of a question that these open numbers do not have, with the line that takes values of them.
    pub fn refusal(&self, what: &str) -> ClientError {
        let values = self.names.iter().map(|name| format!("\"{name}\": 1"));
        let values = values.collect::<Vec<String>>().join(", ");
        let file = &self.file;
        let message = format!(
            "not in this version: open numbers {what}; type values\n  try: echo '[{{{values}}}]' > values.json; cognate \
             mechanism motion {file} --sweep values.json"
        );
        wrong(file, message)
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

/// Puts values in the place of open numbers.
fn fill(tree: &mut Value, place: &str, given: &serde_json::Map<String, Value>) {
    match tree {
        Value::Object(object) => {
            let fields: Vec<String> = object.keys().cloned().collect();
            for field in fields {
                let name = name_of(object, &field, place);
                let inside = place_of(object, &field, place);
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
