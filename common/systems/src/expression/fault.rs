//! Faults: what can be wrong in a text, and where; the formats add file, line and column.

use super::similar::meant;
use crate::formats::limits::Limit;
use std::fmt;

/// A range of bytes of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The span from the start of this one to the end of another.
    pub fn to(self, other: Span) -> Span {
        Span {
            start: self.start,
            end: other.end,
        }
    }
}

/// Something wrong at a place of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The part of the text that is wrong.
    pub span: Span,
    /// The fault at this place.
    pub problem: Problem,
}

impl Fault {
    /// A fault at a place.
    pub fn new(span: Span, problem: Problem) -> Self {
        Self { span, problem }
    }

    /// A fault where one text was expected and another was found.
    pub fn expected(
        span: Span,
        expected: impl Into<String>,
        actual_input: impl Into<String>,
    ) -> Self {
        Self::new(
            span,
            Problem::Expected {
                expected: expected.into(),
                found: actual_input.into(),
            },
        )
    }

    /// A fault where a limit was passed.
    pub fn limit(span: Span, limit: Limit, actual_size: impl ToString) -> Self {
        Self::new(
            span,
            Problem::Limit {
                limit,
                found: actual_size.to_string(),
            },
        )
    }
}

/// A problem in an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// The text does not follow its grammar.
    Expected {
        /// Description of the text that would have been right here.
        expected: String,
        /// The text that stands in this place.
        found: String,
    },
    /// A name that was never declared.
    UnknownName(String),
    /// A name that was never declared, and that is like a declared one.
    Misspelt {
        /// The name.
        name: String,
        /// The declared name that is like it.
        meant: String,
    },
    /// A name that is declared a second time.
    DuplicateName {
        /// The name.
        name: String,
        /// Description of the place where the name was declared first.
        first: String,
    },
    /// A name that has a meaning of its own.
    ReservedName {
        /// The name.
        name: String,
        /// Meaning of the reserved name.
        meaning: &'static str,
    },
    /// A function that is declared but never defined.
    Undefined(String),
    /// Definitions that depend on themselves: each name needs the next, the last the first.
    Cycle(Vec<String>),
    /// The system has no variables.
    NoVariables,
    /// The system has no equations.
    NoEquations,
    /// An equation that holds always or never.
    ConstantEquation(String),
    /// A definition that depends on more than its kind allows.
    TooDependent {
        /// The name that is defined.
        name: String,
        /// Kind of the name, as it was declared.
        kind: &'static str,
        /// Kind of quantity that the definition must not contain.
        without: &'static str,
    },
    /// A denominator, or the base of a negative power, that contains a variable.
    DivisionByVariables,
    /// A denominator that is exactly 0.
    DivisionByZero,
    /// A limit was passed.
    Limit {
        /// The limit that is exceeded.
        limit: Limit,
        /// Size of the input.
        found: String,
    },
    /// Something that a later version may read.
    NotInThisVersion(String),
}

impl Problem {
    /// A name that is none of the declared ones.
    pub fn unknown<'a>(name: &str, declared: impl IntoIterator<Item = &'a str>) -> Self {
        let name = name.to_owned();
        match meant(&name, declared) {
            Some(meant) => {
                let meant = meant.to_owned();
                Self::Misspelt { name, meant }
            }
            None => Self::UnknownName(name),
        }
    }

    /// Description of the text that would have been right.
    pub fn expected(&self) -> String {
        match self {
            Problem::Expected { expected, .. } => expected.clone(),
            Problem::UnknownName(_) => "a declared name".into(),
            Problem::Misspelt { meant, .. } => format!("a declared name, perhaps `{meant}`"),
            Problem::DuplicateName { .. } => "a new name".into(),
            Problem::ReservedName { .. } => "a name without a meaning of its own".into(),
            Problem::Undefined(name) => format!("a definition `{name} = ...`"),
            Problem::Cycle(_) => "definitions that do not depend on themselves".into(),
            Problem::NoVariables => "at least one variable".into(),
            Problem::NoEquations => "at least one equation".into(),
            Problem::ConstantEquation(_) => "an equation that contains a variable".into(),
            Problem::TooDependent { kind, without, .. } => format!("a {kind} without {without}"),
            Problem::DivisionByVariables => "a denominator without variables".into(),
            Problem::DivisionByZero => "a denominator that is not 0".into(),
            Problem::Limit { limit, .. } => format!("at most {} {}", limit.value, limit.what),
            Problem::NotInThisVersion(_) => "something that this version reads".into(),
        }
    }

    /// Description of the text that stands there instead.
    pub fn found(&self) -> String {
        match self {
            Problem::Expected {
                found: actual_input,
                ..
            } => actual_input.clone(),
            Problem::UnknownName(name) | Problem::Misspelt { name, .. } => {
                format!("the unknown name `{name}`")
            }
            Problem::DuplicateName { name, first } => format!("`{name}`, which {first}"),
            Problem::ReservedName { name, meaning } => format!("`{name}`, which is {meaning}"),
            Problem::Undefined(name) => format!("none for `{name}`"),
            Problem::Cycle(names) => format!("the cycle {}", names.join(" -> ")),
            Problem::NoVariables | Problem::NoEquations => "none".into(),
            Problem::ConstantEquation(name) => format!("`{name}`, which contains none"),
            Problem::TooDependent { name, .. } => format!("`{name}`, which contains some"),
            Problem::DivisionByVariables => "one with variables".into(),
            Problem::DivisionByZero => "0".into(),
            Problem::Limit {
                limit,
                found: actual_size,
            } => {
                format!("{actual_size} (not in this version: limit {})", limit.name)
            }
            Problem::NotInThisVersion(what) => what.clone(),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::DivisionByVariables => f.write_str(
                "not in this version: division by an expression with variables; \
                 multiply the denominator out",
            ),
            Problem::NotInThisVersion(what) => write!(f, "not in this version: {what}"),
            _ => write!(f, "expected {}, found {}", self.expected(), self.found()),
        }
    }
}
