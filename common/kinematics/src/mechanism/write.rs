//! Mechanisms as files again: our JSON, and tables of Denavit and Hartenberg.

use super::chain::Chain;
use super::document::{Document, Kind, MechanismError, Tree};
use super::exact::Angle;
use super::pose::Pose;
use super::{Body, Mechanism};
use std::fmt::Write as _;

/// The mechanism as `mechanism.json`. A file in JSON or TOML keeps its numbers as they are written; a chain
/// of another notation is written by its rows, angles in radians.
pub fn json(mechanism: &Mechanism, content: &[u8]) -> Result<String, MechanismError> {
    let document = Document::new(&mechanism.file, content)?;
    match &mechanism.body {
        Body::Chain(chain) if document.tree().is_err() || is_table(&document) => {
            Ok(chain_json(mechanism, chain))
        }
        _ => {
            let mut text = String::new();
            write_tree(&document.tree()?, 0, &mut text);
            text.push('\n');
            Ok(text)
        }
    }
}

fn is_table(document: &Document<'_>) -> bool {
    crate::import::dh::is_table(document.text)
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            c if (c as u32) < 0x20 => {
                let _ = write!(quoted, "\\u{:04x}", c as u32);
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A number of TOML or JSON as JSON has it.
fn json_number(text: &str) -> String {
    let plain = text.trim_start_matches('+').replace('_', "");
    match plain.parse::<f64>() {
        Ok(x) if x.is_finite() && !plain.ends_with('.') => plain,
        _ => quoted(text),
    }
}

fn write_tree(tree: &Tree, depth: usize, text: &mut String) {
    let indent = |depth: usize| "  ".repeat(depth);
    match &tree.kind {
        Kind::Null => text.push_str("null"),
        Kind::Bool(b) => text.push_str(&b.to_string()),
        Kind::Number(number) => text.push_str(&json_number(number)),
        Kind::Text(word) => text.push_str(&quoted(word)),
        Kind::List(items) => {
            let nested = items.iter().any(|i| matches!(i.kind, Kind::Fields(_)));
            text.push('[');
            for (i, item) in items.iter().enumerate() {
                text.push_str(if i == 0 { "" } else { "," });
                if nested {
                    let _ = write!(text, "\n{}", indent(depth + 1));
                } else if i > 0 {
                    text.push(' ');
                }
                write_tree(item, depth + 1, text);
            }
            if nested {
                let _ = write!(text, "\n{}", indent(depth));
            }
            text.push(']');
        }
        Kind::Fields(fields) => {
            text.push('{');
            for (i, (name, _, value)) in fields.iter().enumerate() {
                let comma = if i == 0 { "" } else { "," };
                let _ = write!(text, "{comma}\n{}{}: ", indent(depth + 1), quoted(name));
                write_tree(value, depth + 1, text);
            }
            let _ = write!(text, "\n{}}}", indent(depth));
        }
    }
}

/// An angle: exact multiples of 90 degrees as such, others in radians.
fn angle_text(angle: &Angle, unit: bool) -> String {
    let quarters = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, -1.0]];
    match quarters.iter().position(|half| *half == angle.half) {
        Some(0) => "0".into(),
        Some(k) => format!("{} deg", [0, 90, 180, -90][k]),
        None if unit => format!("{:?} rad", angle.radians),
        None => format!("{:?}", angle.radians),
    }
}

fn json_angle(angle: &Angle) -> String {
    let text = angle_text(angle, false);
    if text.ends_with("deg") {
        quoted(&text)
    } else {
        text
    }
}

fn pose_json(pose: &Pose) -> String {
    let [x, y, z] = pose.position.map(|c| c.re);
    let [w, i, j, k] = pose.quaternion();
    format!("{{\"position\": [{x:?}, {y:?}, {z:?}], \"quaternion\": [{w:?}, {i:?}, {j:?}, {k:?}]}}")
}

fn chain_json(mechanism: &Mechanism, chain: &Chain) -> String {
    let rows: Vec<String> = chain
        .joints
        .iter()
        .map(|joint| {
            format!(
                "      {{\"name\": {}, \"type\": \"{}\", \"theta\": {}, \"d\": {:?}, \"a\": {:?}, \"alpha\": {}}}",
                quoted(&joint.name),
                if joint.is_angle { "R" } else { "P" },
                json_angle(&joint.theta),
                joint.d,
                joint.a,
                json_angle(&joint.alpha)
            )
        })
        .collect();
    let limits: Vec<String> = mechanism
        .limits
        .iter()
        .map(|l| format!("{}: [{:?}, {:?}]", quoted(&l.joint), l.range[0], l.range[1]))
        .collect();
    let body = if chain.closed { "loop" } else { "serial" };
    format!(
        "{{\n  \"name\": {},\n  \"space\": \"spatial\",\n  \"angles\": \"rad\",\n  \"{body}\": {{\n    \
         \"convention\": \"standard\",\n    \"base\": {},\n    \"tool\": {},\n    \"joints\": [\n{}\n    ]\n  }},\n  \
         \"limits\": {{{}}}\n}}\n",
        quoted(&mechanism.name),
        pose_json(&chain.base),
        pose_json(&chain.tool),
        rows.join(",\n"),
        limits.join(", ")
    )
}

/// The rows of a chain as CSV; base and tool have no place there, so they must be the identity up to rounding.
pub fn dh_csv(mechanism: &Mechanism) -> Result<String, MechanismError> {
    let Body::Chain(chain) = &mechanism.body else {
        return Err(mechanism.error("only a chain has rows of Denavit and Hartenberg"));
    };
    let has_limits = !mechanism.limits.is_empty();
    let mut text = String::from("name,type,theta,d,a,alpha");
    text.push_str(if has_limits { ",min,max\n" } else { "\n" });
    for joint in &chain.joints {
        let _ = write!(
            text,
            "{},{},{},{:?},{:?},{}",
            joint.name,
            if joint.is_angle { "R" } else { "P" },
            angle_text(&joint.theta, true),
            joint.d,
            joint.a,
            angle_text(&joint.alpha, true)
        );
        if has_limits {
            let unit = if joint.is_angle { " rad" } else { "" };
            let _ = match mechanism.limits_of(&joint.name) {
                Some([low, high]) => write!(text, ",{low:?}{unit},{high:?}{unit}"),
                None => write!(text, ",,"),
            };
        }
        text.push('\n');
    }
    Ok(text)
}

/// Whether a table of rows says all of a chain: base and tool are the identity.
pub fn table_is_whole(mechanism: &Mechanism) -> bool {
    match &mechanism.body {
        Body::Chain(chain) => [&chain.base, &chain.tool]
            .iter()
            .all(|pose| pose.distance(&Pose::IDENTITY, 1.0) < 1e-12),
        _ => true,
    }
}
