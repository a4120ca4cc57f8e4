//! One target on a line of JSON, as they come in a stream, with an "id" that the answer takes back.

use super::document::{Document, Entry, Kind, MechanismError, Tree};
use super::pose::ReadPose;
use super::targets::{PoseForm, inputs_of_entry, pose_of_entry};

/// Identifier that tells a target from other targets in a stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LineId {
    /// A number as it is written.
    Number(String),
    /// A string.
    Text(String),
}

/// A line that is an object in JSON.
#[derive(Clone, Debug)]
pub struct Line<'a> {
    document: Document<'a>,
    tree: Tree,
    /// Identifier that is repeated in the answer.
    pub id: Option<LineId>,
}

impl<'a> Line<'a> {
    /// Reads a line; where it stands is for the caller to say, who counts lines.
    pub fn read(file: &'a str, content: &'a [u8]) -> Result<Self, MechanismError> {
        let document = Document::new(file, content)?;
        let mut tree = document.json_tree()?;
        let id = match &mut tree.kind {
            Kind::Fields(fields) => {
                let place = fields.iter().position(|(name, _, _)| name == "id");
                place.map(|place| fields.remove(place).2)
            }
            _ => return Err(document.error(tree.at, "", "expected an object")),
        };
        let id = match id.map(|tree| (tree.at, tree.kind)) {
            None => None,
            Some((_, Kind::Number(text))) => Some(LineId::Number(text)),
            Some((_, Kind::Text(text))) => Some(LineId::Text(text)),
            Some((at, _)) => {
                return Err(document.error(at, "id", "expected a number or a string"));
            }
        };
        Ok(Self { document, tree, id })
    }

    fn entry(&self) -> Entry<'_> {
        Entry {
            document: self.document,
            tree: &self.tree,
            path: String::new(),
        }
    }

    /// The pose that the line is.
    pub fn pose(&self, form: PoseForm) -> Result<ReadPose, MechanismError> {
        pose_of_entry(&self.entry(), form)
    }

    /// The values of the inputs `names`, each with whether it is an angle, that the line is.
    pub fn inputs(
        &self,
        names: &[(String, bool)],
        degrees: bool,
    ) -> Result<Vec<f64>, MechanismError> {
        inputs_of_entry(&self.entry(), names, degrees)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_target_and_an_id() {
        let line = Line::read("line", br#"{"id": "a\u0062", "x": 2, "turn": "90 deg"}"#).unwrap();
        assert_eq!(line.id, Some(LineId::Text("ab".into())));
        let names = [("x".to_owned(), false), ("turn".to_owned(), true)];
        let values = line.inputs(&names, false).unwrap();
        assert!(values[0] == 2.0 && (values[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let wrong = line.inputs(&names[..1], false).unwrap_err();
        assert!(wrong.message.contains("\"turn\""), "{wrong}");
        let number = Line::read("line", br#"{"id": 17}"#).unwrap();
        assert_eq!(number.id, Some(LineId::Number("17".into())));
    }

    #[test]
    fn what_is_no_object_or_has_no_plain_id_is_refused() {
        for (text, expected) in [
            ("[1, 2]", "object"),
            ("{\"id\": [1]}", "number or a string"),
            ("{\"id\": 1", "expected"),
            ("", "expected"),
        ] {
            let error = Line::read("line", text.as_bytes()).unwrap_err();
            assert!(error.message.contains(expected), "{text}: {error}");
        }
    }
}
