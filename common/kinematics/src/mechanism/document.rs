//! A file of fields and values, JSON or TOML, in which every value knows its line; and the errors of a file.

use super::exact::{Number, ReadAngle, looks_like_radians, read_angle};
use cognate_systems::expression::similar::meant;
use cognate_systems::formats::Source;
use cognate_systems::formats::json_value;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt;
use toml::de::{DeTable, DeValue};

/// Largest file of a mechanism, in bytes.
pub const MOST_BYTES: usize = 16 << 20;

/// A fault in a mechanism's file or in a question about the mechanism, with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MechanismError {
    /// The file's name.
    pub file: String,
    /// The line, from 1; `None` if the fault has no line.
    pub line: Option<usize>,
    /// The field: `joints[2].axis`; empty if the fault is in no field.
    pub field: String,
    /// Description of the fault, and of the input that was expected.
    pub message: String,
}

impl std::error::Error for MechanismError {}

impl fmt::Display for MechanismError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if !self.field.is_empty() {
            write!(f, ": {}", self.field)?;
        }
        write!(f, ": {}", self.message)
    }
}

impl MechanismError {
    /// An error about a whole mechanism.
    pub fn of_file(file: &str, message: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            line: None,
            field: String::new(),
            message: message.into(),
        }
    }
}

/// A value and the byte at which it stands.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Kind of the value.
    pub kind: Kind,
    /// First byte in the file.
    pub at: usize,
}

/// Kinds of values in a mechanism's file.
#[derive(Clone, Debug)]
pub enum Kind {
    /// The value null.
    Null,
    /// A truth value.
    Bool(bool),
    /// A number as it is written.
    Number(String),
    /// A string.
    Text(String),
    /// A list.
    List(Vec<Tree>),
    /// Named values in the order of the file.
    Fields(Vec<(String, usize, Tree)>),
}

impl Kind {
    fn describe(&self) -> String {
        match self {
            Self::Null => "null".into(),
            Self::Bool(b) => b.to_string(),
            Self::Number(text) => format!("the number {}", short(text)),
            Self::Text(text) => format!("the string \"{}\"", short(text)),
            Self::List(items) => format!("a list of {}", items.len()),
            Self::Fields(_) => "an object".into(),
        }
    }
}

fn short(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// A file's text and how its angles are read.
#[derive(Clone, Copy, Debug)]
pub struct Document<'a> {
    /// The file's name, for messages.
    pub file: &'a str,
    /// Text of the file.
    pub text: &'a str,
}

impl<'a> Document<'a> {
    /// The document of a file's bytes.
    pub fn new(file: &'a str, content: &'a [u8]) -> Result<Self, MechanismError> {
        Self::within(MOST_BYTES, file, content)
    }

    /// This document, checked against the size limit of [`Document::new`].
    pub fn within_limit(&self) -> Result<Self, MechanismError> {
        Self::new(self.file, self.text.as_bytes())
    }

    /// The document of a file's bytes, if there are at most `most` bytes.
    pub fn within(most: usize, file: &'a str, content: &'a [u8]) -> Result<Self, MechanismError> {
        if content.len() > most {
            let message = format!("{} bytes; at most {most} are read", content.len());
            return Err(MechanismError::of_file(file, message));
        }
        let text = std::str::from_utf8(content).map_err(|e| {
            let message = format!("byte {} is not UTF-8", e.valid_up_to());
            MechanismError::of_file(file, message)
        })?;
        Ok(Self { file, text })
    }

    /// An error at a byte of the file.
    pub fn error(&self, at: usize, field: &str, message: impl Into<String>) -> MechanismError {
        let at = at.min(self.text.len());
        MechanismError {
            file: self.file.to_owned(),
            line: Some(
                self.text.as_bytes()[..at]
                    .iter()
                    .filter(|b| **b == b'\n')
                    .count()
                    + 1,
            ),
            field: field.to_owned(),
            message: message.into(),
        }
    }

    /// The value of the whole file: JSON where it begins with a bracket, else TOML.
    pub fn tree(&self) -> Result<Tree, MechanismError> {
        match self.text.trim_start().chars().next() {
            // A table's name in brackets is no JSON.
            Some('{') => self.json_tree(),
            Some('[')
                if !self.text.trim_start()[1..]
                    .trim_start()
                    .starts_with(is_bare) =>
            {
                self.json_tree()
            }
            _ => self.toml(),
        }
    }

    /// The value of a file in JSON.
    pub fn json_tree(&self) -> Result<Tree, MechanismError> {
        let value = json_value::parse(self.text, 0, self.text.len()).map_err(|fault| {
            let source = Source {
                name: self.file,
                text: self.text,
            };
            let error = source.error(fault);
            MechanismError {
                file: self.file.to_owned(),
                line: Some(error.place.line),
                field: String::new(),
                message: error.problem.to_string(),
            }
        })?;
        Ok(of_json(&value))
    }

    fn toml(&self) -> Result<Tree, MechanismError> {
        let table = DeTable::parse(self.text).map_err(|e| {
            let at = e.span().map_or(0, |span| span.start);
            self.error(at, "", e.message())
        })?;
        let at = table.span().start;
        let fields = fields_of_toml(table.get_ref());
        Ok(Tree { kind: fields, at })
    }
}

fn is_bare(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '['
}

fn of_json(value: &json_value::Value<'_>) -> Tree {
    use json_value::Kind as Json;
    let kind = match &value.kind {
        Json::Null => Kind::Null,
        Json::Bool(b) => Kind::Bool(*b),
        Json::Number(text) => Kind::Number((*text).to_owned()),
        Json::Text(text) => Kind::Text(text.text.to_string()),
        Json::Array(items) => Kind::List(items.iter().map(of_json).collect()),
        Json::Object(fields) => {
            let field = |(name, value): &(json_value::Text<'_>, json_value::Value<'_>)| {
                (name.text.to_string(), name.start, of_json(value))
            };
            Kind::Fields(fields.iter().map(field).collect())
        }
    };
    Tree {
        kind,
        at: value.span.start,
    }
}

fn fields_of_toml(table: &DeTable<'_>) -> Kind {
    let mut fields: Vec<(String, usize, Tree)> = table
        .iter()
        .map(|(name, value)| {
            let tree = Tree {
                kind: of_toml(value.get_ref()),
                at: value.span().start,
            };
            (name.get_ref().to_string(), name.span().start, tree)
        })
        .collect();
    fields.sort_by_key(|(_, at, _)| *at);
    Kind::Fields(fields)
}

fn of_toml(value: &DeValue<'_>) -> Kind {
    match value {
        DeValue::String(text) => Kind::Text(text.to_string()),
        DeValue::Integer(number) => Kind::Number(number.as_str().to_owned()),
        DeValue::Float(number) => Kind::Number(number.as_str().to_owned()),
        DeValue::Boolean(b) => Kind::Bool(*b),
        DeValue::Datetime(time) => Kind::Text(time.to_string()),
        DeValue::Array(items) => {
            let item = |item: &toml::Spanned<DeValue<'_>>| Tree {
                kind: of_toml(item.get_ref()),
                at: item.span().start,
            };
            Kind::List(items.iter().map(item).collect())
        }
        DeValue::Table(table) => fields_of_toml(table),
    }
}

/// A value with the way to it from the file's top.
#[derive(Clone, Debug)]
pub struct Entry<'a> {
    /// The file.
    pub document: Document<'a>,
    /// The value.
    pub tree: &'a Tree,
    /// The way to it: `joints[2].axis`.
    pub path: String,
}

impl<'a> Entry<'a> {
    /// An error here.
    pub fn error(&self, message: impl Into<String>) -> MechanismError {
        self.document.error(self.tree.at, &self.path, message)
    }

    fn wrong(&self, expected: &str) -> MechanismError {
        self.error(format!(
            "expected {expected}, found {}",
            self.tree.kind.describe()
        ))
    }

    /// The value as it is written, with its kind.
    pub fn describe(&self) -> String {
        self.tree.kind.describe()
    }

    /// A string.
    pub fn text(&self, expected: &str) -> Result<&'a str, MechanismError> {
        match &self.tree.kind {
            Kind::Text(text) => Ok(text),
            _ => Err(self.wrong(expected)),
        }
    }

    /// The items of a list.
    pub fn items(&self, expected: &str) -> Result<Vec<Entry<'a>>, MechanismError> {
        let Kind::List(items) = &self.tree.kind else {
            return Err(self.wrong(expected));
        };
        let item = |(i, tree)| Entry {
            document: self.document,
            tree,
            path: format!("{}[{i}]", self.path),
        };
        Ok(items.iter().enumerate().map(item).collect())
    }

    /// The fields of an object.
    pub fn fields(&self, expected: &str) -> Result<Fields<'a>, MechanismError> {
        match &self.tree.kind {
            Kind::Fields(_) => Ok(Fields {
                entry: self.clone(),
                used: RefCell::default(),
            }),
            _ => Err(self.wrong(expected)),
        }
    }

    /// Whether it is an object.
    pub fn is_object(&self) -> bool {
        matches!(self.tree.kind, Kind::Fields(_))
    }

    /// Whether it is a list.
    pub fn is_list(&self) -> bool {
        matches!(self.tree.kind, Kind::List(_))
    }

    /// A number: decimal, fraction, root.
    pub fn number(&self) -> Result<Number, MechanismError> {
        let expected = "a number, or a string such as \"3/5\" or \"sqrt(3)/2\"";
        match &self.tree.kind {
            Kind::Number(text) | Kind::Text(text) => {
                Number::read(text).ok_or_else(|| self.wrong(expected))
            }
            _ => Err(self.wrong(expected)),
        }
    }

    /// A finite double.
    pub fn double(&self) -> Result<f64, MechanismError> {
        let double = self.number()?.to_f64();
        if double.is_finite() {
            Ok(double)
        } else {
            Err(self.wrong("a number that a double can hold"))
        }
    }

    /// Whether it is a number without a unit that is a right angle in radians.
    pub fn looks_like_radians(&self) -> bool {
        match &self.tree.kind {
            Kind::Number(text) | Kind::Text(text) => looks_like_radians(text),
            _ => false,
        }
    }

    /// An angle: a number in the unit of the file, a string with its unit, or `[cos, sin]`.
    pub fn angle(&self, degrees: bool, snap: bool) -> Result<ReadAngle, MechanismError> {
        let expected = "an angle: a number, a string such as \"90 deg\" or \"pi/2\", or [cos, sin]";
        match &self.tree.kind {
            Kind::Number(text) | Kind::Text(text) => {
                read_angle(text, degrees, snap).ok_or_else(|| self.wrong(expected))
            }
            Kind::List(_) => {
                let [c, s] = self.doubles::<2>(expected)?;
                let length = c * c + s * s;
                if (length - 1.0).abs() > 1e-6 {
                    return Err(self.error(format!(
                        "cosine and sine have squares that add up to {length}, not to 1"
                    )));
                }
                let angle = super::exact::Angle::of_direction(num_complex::Complex64::new(c, s));
                Ok(ReadAngle {
                    angle,
                    snapped: None,
                })
            }
            _ => Err(self.wrong(expected)),
        }
    }

    /// The entry as a list of `N` numbers.
    pub fn numbers<const N: usize>(&self, expected: &str) -> Result<[Number; N], MechanismError> {
        let items = self.items(expected)?;
        if items.len() != N {
            return Err(self.wrong(expected));
        }
        let numbers: Result<Vec<Number>, MechanismError> =
            items.iter().map(Entry::number).collect();
        numbers?.try_into().map_err(|_| self.wrong(expected))
    }

    /// The entry as a list of `N` finite doubles.
    pub fn doubles<const N: usize>(&self, expected: &str) -> Result<[f64; N], MechanismError> {
        let items = self.items(expected)?;
        if items.len() != N {
            return Err(self.wrong(expected));
        }
        let doubles: Result<Vec<f64>, MechanismError> = items.iter().map(Entry::double).collect();
        doubles?.try_into().map_err(|_| self.wrong(expected))
    }
}

/// The fields of an object; `finish` refuses those that nobody asked for.
#[derive(Debug)]
pub struct Fields<'a> {
    entry: Entry<'a>,
    used: RefCell<BTreeSet<String>>,
}

impl<'a> Fields<'a> {
    fn list(&self) -> &'a [(String, usize, Tree)] {
        match &self.entry.tree.kind {
            Kind::Fields(fields) => fields,
            _ => &[],
        }
    }

    fn child(&self, name: &str, tree: &'a Tree) -> Entry<'a> {
        let path = match self.entry.path.as_str() {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        Entry {
            document: self.entry.document,
            tree,
            path,
        }
    }

    /// A field that may be missing.
    pub fn optional(&self, name: &str) -> Option<Entry<'a>> {
        self.used.borrow_mut().insert(name.to_owned());
        let (_, _, tree) = self.list().iter().find(|(n, _, _)| n == name)?;
        Some(self.child(name, tree))
    }

    /// A field that must be there.
    pub fn required(&self, name: &str, what: &str) -> Result<Entry<'a>, MechanismError> {
        self.optional(name).ok_or_else(|| {
            self.entry
                .error(format!("the field \"{name}\" is missing: {what}"))
        })
    }

    /// All fields with their names; none is unknown then.
    pub fn all(&self) -> Vec<(&'a str, Entry<'a>)> {
        let named =
            |(name, _, tree): &'a (String, usize, Tree)| (name.as_str(), self.child(name, tree));
        let entries: Vec<_> = self.list().iter().map(named).collect();
        self.used
            .borrow_mut()
            .extend(entries.iter().map(|(n, _)| (*n).to_owned()));
        entries
    }

    /// An error about the object.
    pub fn error(&self, message: impl Into<String>) -> MechanismError {
        self.entry.error(message)
    }

    /// An error at the first field that nobody asked for.
    pub fn finish(&self) -> Result<(), MechanismError> {
        let used = self.used.borrow();
        for (name, at, _) in self.list() {
            if !used.contains(name) {
                let field_names: Vec<&str> = used.iter().map(String::as_str).collect();
                let perhaps = meant(name, field_names.iter().copied());
                let perhaps = perhaps.map_or(String::new(), |field| format!(", perhaps {field}"));
                let message = format!(
                    "unknown field \"{}\"{perhaps}; known here: {}",
                    short(name),
                    field_names.join(", ")
                );
                return Err(self.entry.document.error(*at, &self.entry.path, message));
            }
        }
        Ok(())
    }
}
