//! Open numbers: what a mechanism's file has "?" in the place of, named as the bar, or `joint.field`.

use crate::error::ClientError;
use serde_json::Value;

/// Text in a file in the place of a number that is open.
pub const OPEN: &str = "?";

/// The refusal of a file with open numbers where all numbers have to be there; `None` where no number is open.
pub fn refusal(name: &str, content: &[u8]) -> Option<ClientError> {
    let names = open_names(&serde_json::from_slice(content).ok()?);
    let open = names.join(", ");
    let message = format!(
        "values are open (\"?\"): {open}; type a number for each, or have special values found\n  try: cognate mechanism \
         exceptional {name}"
    );
    (!names.is_empty()).then(|| ClientError::Input {
        origin: name.to_owned(),
        message,
    })
}

/// Names of all open numbers of a file.
pub fn open_names(tree: &Value) -> Vec<String> {
    let mut names = Vec::new();
    collect(tree, "", &mut names);
    names
}

/// The name of an open number: the bar's, or that of the joint and the field.
pub fn name_of(object: &serde_json::Map<String, Value>, field: &str, place: &str) -> String {
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

/// The place that names what is inside a field: of a joint or a leg its name and the field, else the field.
pub fn place_of(object: &serde_json::Map<String, Value>, field: &str, place: &str) -> String {
    // The outermost name is that of the mechanism.
    match place.is_empty() || !object.contains_key("name") {
        true => field.to_owned(),
        false => name_of(object, field, place),
    }
}

/// Names of all open numbers, in the order of the file; places with one name are one number.
fn collect(tree: &Value, place: &str, names: &mut Vec<String>) {
    match tree {
        Value::Object(object) => {
            for (field, value) in object {
                let name = name_of(object, field, place);
                if value != OPEN {
                    collect(value, &place_of(object, field, place), names);
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

#[cfg(test)]
mod tests {
    use super::open_names;
    use serde_json::json;

    #[test]
    fn open_numbers_of_two_joints_have_two_names() {
        let tree = json!({"name": "m", "joints": [
            {"name": "A", "point": ["?", 1]},
            {"name": "B", "point": [0, "?"]},
            {"d": "?"},
        ], "framework": {"bars": [{"name": "x", "between": ["a", "b"], "length": "?"}]}});
        let names = ["x", "A.point.0", "B.point.1", "joints.2.d"];
        let mut open = open_names(&tree);
        open.sort_by_key(|name| names.iter().position(|n| n == name));
        assert_eq!(open, names);
    }
}
