//! The fields of a JSON problem, each with its value; a name that is no field is refused.

use crate::expression::fault::{Fault, Span};
use crate::expression::similar::meant;
use crate::expression::token::shorten;
use crate::formats::json_value::{Text, Value};
use crate::formats::scope::{FieldFault, at};
use std::collections::HashMap;

/// Names of the fields that a problem may have.
const NAMES: [&str; 15] = [
    "variables",
    "groups",
    "homogeneous",
    "parameters",
    "path_variable",
    "definitions",
    "equations",
    "conjugates",
    "degenerate",
    "symmetry",
    "where",
    "complementary",
    "minimize",
    "maximize",
    "critical",
];

/// The fields of one problem by their names.
pub(super) struct Fields<'v, 'a> {
    values: HashMap<&'static str, &'v Value<'a>>,
    /// The closing brace of the problem, where a missing field is reported.
    pub(super) end: Span,
}

impl<'v, 'a> Fields<'v, 'a> {
    /// The fields of a JSON object.
    pub(super) fn of(root: &'v Value<'a>) -> Result<Self, FieldFault> {
        let mut values = HashMap::new();
        for (name, value) in root
            .object("a JSON object with a problem")
            .map_err(at(""))?
        {
            let Some(&field) = NAMES.iter().find(|&&field| field == name.text) else {
                return Err(FieldFault::new("", no_field(name)));
            };
            values.insert(field, value);
        }
        let end = Span {
            start: root.span.end.saturating_sub(1),
            end: root.span.end,
        };
        Ok(Self { values, end })
    }

    /// The value of a field, if the problem has it.
    pub(super) fn get(&self, name: &str) -> Option<&'v Value<'a>> {
        self.values.get(name).copied()
    }

    /// Whether the problem has a field.
    pub(super) fn contains(&self, name: &str) -> bool {
        self.values.contains_key(name)
    }

    /// The value of a field that every problem has.
    pub(super) fn required(&self, name: &str) -> Result<&'v Value<'a>, FieldFault> {
        let missing = || {
            Fault::expected(
                self.end,
                format!("the field \"{name}\""),
                "the end of the problem",
            )
        };
        self.get(name).ok_or_else(|| FieldFault::new("", missing()))
    }

    /// The place of a field's value; the end of the problem if the field is missing.
    pub(super) fn span(&self, name: &str) -> Span {
        self.get(name).map_or(self.end, |value| value.span)
    }
}

/// The fault of a name that is no field.
fn no_field(name: &Text<'_>) -> Fault {
    let end = name.start + name.text.len();
    Fault::expected(
        Span {
            start: name.start,
            end,
        },
        match meant(&name.text, NAMES) {
            Some(field) => {
                format!("one of the fields {}; perhaps {field}", NAMES.join(", "))
            }
            None => format!("one of the fields {}", NAMES.join(", ")),
        },
        format!("\"{}\"", shorten(&name.text)),
    )
}
