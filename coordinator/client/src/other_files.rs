//! Other files: what a file is that was given to a command that takes another kind, and the line that takes it.
//!
//! Looked at only where a reader has refused the file; then the message names its kind instead of the first strange character.

use super::error::ClientError;
use super::remedy::quoted;
use cognate_kinematics::mechanism::{self, Body, ReadOptions};
use cognate_systems::formats;
use serde_json::Value;
use std::path::Path;

/// The kinds of files that are taken for another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A mechanism; of an open chain the postures are asked, of others the positions.
    Mechanism { is_open_chain: bool },
    /// Equations.
    System,
    /// Poses of a tool.
    Poses,
    /// Points of a path in the plane.
    PathPoints,
    /// Solutions that were found before.
    Solutions,
    /// The components of a system.
    Components,
    /// A program for HomotopyContinuation.jl.
    Julia,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Mechanism { .. } => "a mechanism",
            Self::System => "a system of equations",
            Self::Poses => "poses of a tool",
            Self::PathPoints => "points of a path",
            Self::Solutions => "solutions",
            Self::Components => "components that were found before",
            Self::Julia => "a program for HomotopyContinuation.jl",
        }
    }

    /// The line that takes a file of this kind.
    fn line(self, file: &str) -> String {
        match self {
            Self::Mechanism {
                is_open_chain: true,
            } => {
                format!("cognate mechanism inverse {file} --pose \"x y z qw qx qy qz\"")
            }
            Self::Mechanism {
                is_open_chain: false,
            } => {
                format!("cognate mechanism motion {file}")
            }
            Self::System => format!("cognate solve {file}"),
            Self::Poses => format!("cognate mechanism inverse arm.json --poses {file}"),
            Self::PathPoints => format!("cognate synthesize nine-point {file}"),
            Self::Solutions => format!(
                "cognate solve family.txt --start-solutions {file} --start-parameters start.json --targets \"p=1\""
            ),
            Self::Components => {
                let folder = Path::new(file)
                    .parent()
                    .filter(|f| !f.as_os_str().is_empty());
                let folder = folder.map_or(".".into(), |f| f.display().to_string());
                format!("cognate sample {folder} --count 10")
            }
            Self::Julia => format!(
                "python -c 'import cognate; print(cognate.System.from_homotopy_continuation(open(\"{file}\").read()).solve())'"
            ),
        }
    }
}

/// The kind of a file, where it is one of those that are taken for another.
fn kind(name: &str, content: &[u8]) -> Option<Kind> {
    let text = std::str::from_utf8(content).ok()?;
    if let Ok(mechanism) = mechanism::read(name, content, &ReadOptions::default()) {
        let is_open_chain = matches!(&mechanism.body, Body::Chain(chain) if !chain.closed);
        return Some(Kind::Mechanism { is_open_chain });
    }
    if text.contains("<robot") {
        return Some(Kind::Mechanism {
            is_open_chain: true,
        });
    }
    let first = text
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#'))?;
    if let Ok(Value::Object(fields)) = serde_json::from_str(text.trim_start_matches('\u{feff}')) {
        return of_fields(&|name| fields.contains_key(name));
    }
    if let Ok(Value::Object(fields)) = serde_json::from_str(first) {
        return of_fields(&|name| fields.contains_key(name));
    }
    if text.contains("@var ") || text.contains("@polyvar ") {
        return Some(Kind::Julia);
    }
    let names: Vec<&str> = first.split([',', ';']).map(str::trim).collect();
    match names[..] {
        ["x", "y"] => Some(Kind::PathPoints),
        ["x", "y", "z", "qw", ..] | ["x", "y", "z", "roll", ..] => Some(Kind::Poses),
        _ => formats::read(name, content).is_ok().then_some(Kind::System),
    }
}

/// The kind of an object with these fields.
fn of_fields(has: &dyn Fn(&str) -> bool) -> Option<Kind> {
    if has("equations") {
        return Some(Kind::System);
    }
    if has("variables") && has("multiplicity") {
        return Some(Kind::Solutions);
    }
    if has("components") && has("dimensions") {
        return Some(Kind::Components);
    }
    if has("serial") {
        return Some(Kind::Mechanism {
            is_open_chain: true,
        });
    }
    let bodies = ["loop", "platform", "framework", "joints"];
    bodies
        .iter()
        .any(|body| has(body))
        .then_some(Kind::Mechanism {
            is_open_chain: false,
        })
}

/// The refusal of a file in the place of a system; `None` where it is no file of another kind.
pub fn instead_of_system(name: &str, content: &[u8]) -> Option<ClientError> {
    let kind = kind(name, content).filter(|kind| *kind != Kind::System)?;
    Some(refusal(name, kind, "a system of equations"))
}

/// The refusal of a file in the place of a mechanism; `None` where it is no file of another kind.
pub fn instead_of_mechanism(name: &str, content: &[u8]) -> Option<ClientError> {
    let kind = kind(name, content).filter(|kind| !matches!(kind, Kind::Mechanism { .. }))?;
    Some(refusal(name, kind, "a mechanism"))
}

/// The refusal of a file in the place of components; `None` where it is no file of another kind.
pub fn instead_of_components(name: &str, content: &[u8]) -> Option<ClientError> {
    let kind = kind(name, content).filter(|kind| *kind != Kind::Components)?;
    let wanted = "components; expected the folder of `cognate decompose --output`";
    match kind {
        Kind::System => Some(ClientError::Input {
            origin: name.to_owned(),
            message: format!(
                "holds equations, not {wanted}\n  try: cognate decompose {} --output FOLDER",
                quoted(name)
            ),
        }),
        other => Some(refusal(name, other, wanted)),
    }
}

fn refusal(name: &str, kind: Kind, wanted: &str) -> ClientError {
    ClientError::Input {
        origin: name.to_owned(),
        message: format!(
            "holds {}, not {wanted}\n  try: {}",
            kind.name(),
            kind.line(&quoted(name))
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_kinds_are_named_with_the_line_that_takes_them() {
        let check = |content: &str, words: &[&str]| {
            let refusal = instead_of_system("f", content.as_bytes());
            let text = refusal.map(|e| e.to_string()).unwrap_or_default();
            assert!(
                words.iter().all(|word| text.contains(word)),
                "{content}: {text}"
            );
        };
        check(
            "{\"serial\": [{\"d\": 1}], \"angles\": 3}",
            &["a mechanism", "cognate mechanism inverse f --pose"],
        );
        check(
            "{\"joints\": []}",
            &["a mechanism", "cognate mechanism motion f"],
        );
        check("<robot name=\"a\">", &["a mechanism"]);
        check(
            "x,y\n1,2\n",
            &["points of a path", "synthesize nine-point f"],
        );
        check("x,y,z,qw,qx,qy,qz\n", &["poses", "--poses f"]);
        check(
            "{\"variables\": {\"x\": [1, 0]}, \"multiplicity\": 1}\n",
            &["solutions", "--start-solutions f"],
        );
        check(
            "using HomotopyContinuation\n@var x\n",
            &["from_homotopy_continuation"],
        );
        assert!(instead_of_system("f", b"x^2 = ").is_none());
        let system = instead_of_mechanism("f", b"x^2 = 1\n").expect("another kind");
        assert!(
            system.to_string().ends_with("try: cognate solve f"),
            "{system}"
        );
        let system = instead_of_components("f", b"x*y = 0\n").expect("another kind");
        assert!(
            system
                .to_string()
                .ends_with("cognate decompose f --output FOLDER"),
            "{system}"
        );
    }
}
