//! FormatError: what is wrong with an input, with file, line, column and the line itself.

use crate::expression::fault::{Fault, Problem, Span};
use std::fmt;

/// Place of an error in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file's name, as it was given.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// The field of a JSON file or the name of an option, where there is one: `equations[2]`.
    pub field: Option<String>,
    /// Column within the field's own text, from 1, where that makes sense.
    pub field_column: Option<usize>,
    /// The part of the line around the column, fit to be printed.
    pub excerpt: String,
    /// Place where the marks begin in the excerpt, in characters.
    pub mark: usize,
    /// Number of marks.
    pub width: usize,
}

/// A fault in an input: place and problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormatError {
    /// File, line and column of the fault.
    pub place: Box<Place>,
    /// The problem at this place, and the text that was expected.
    pub problem: Problem,
}

impl FormatError {
    /// Description of the text that would have been right.
    pub fn expected(&self) -> String {
        self.problem.expected()
    }

    /// Description of the text that stands there instead.
    pub fn found(&self) -> String {
        self.problem.found()
    }
}

impl std::error::Error for FormatError {}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place {
            file,
            line,
            column,
            field,
            field_column,
            excerpt,
            mark,
            width,
        } = &*self.place;
        write!(f, "{file}:{line}:{column}: ")?;
        match (field, field_column) {
            (Some(field), Some(at)) => write!(f, "{field}, column {at}: ")?,
            (Some(field), None) => write!(f, "{field}: ")?,
            _ => {}
        }
        write!(f, "{}", self.problem)?;
        if !excerpt.is_empty() {
            let number = line.to_string();
            let gap = " ".repeat(number.len());
            let before = " ".repeat(*mark);
            let marks = "^".repeat(*width);
            write!(
                f,
                "\n {gap} |\n {number} | {excerpt}\n {gap} | {before}{marks}"
            )?;
        }
        Ok(())
    }
}

/// Characters shown before and after the place of an error.
const EXCERPT_BEFORE: usize = 60;
const EXCERPT_AFTER: usize = 40;

/// A named text, which turns places into lines and columns.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The file's name.
    pub name: &'a str,
    /// Text of the line.
    pub text: &'a str,
}

impl<'a> Source<'a> {
    /// Line and column of a byte, both from 1.
    pub fn line_and_column(&self, at: usize) -> (usize, usize) {
        let at = self.boundary(at);
        let line = self.text[..at].matches('\n').count() + 1;
        let column = self.text[self.line_start(at)..at].chars().count() + 1;
        (line, column)
    }

    fn boundary(&self, at: usize) -> usize {
        let mut at = at.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }

    fn line_start(&self, at: usize) -> usize {
        self.text[..at].rfind('\n').map_or(0, |n| n + 1)
    }

    /// The error for a fault in this text.
    pub fn error(&self, fault: Fault) -> FormatError {
        let Fault {
            span: Span { start, end },
            problem,
        } = fault;
        let start = self.boundary(start);
        let (line, column) = self.line_and_column(start);
        let line_start = self.line_start(start);
        let rest = &self.text[line_start..];
        let whole = rest
            .split('\n')
            .next()
            .unwrap_or_default()
            .trim_end_matches('\r');
        let end = self
            .boundary(end.max(start))
            .min(line_start + whole.len())
            .max(start);
        let shown = |c: char| if c.is_control() { ' ' } else { c };
        let first = (column - 1).saturating_sub(EXCERPT_BEFORE);
        let length = (column - 1 - first) + EXCERPT_AFTER;
        let middle: String = whole.chars().skip(first).take(length).map(shown).collect();
        let cut = whole.chars().nth(first + length).is_some();
        let lead = if first > 0 { "..." } else { "" };
        let width = self.text[start..end]
            .chars()
            .count()
            .clamp(1, EXCERPT_AFTER);
        FormatError {
            place: Box::new(Place {
                file: self.name.into(),
                line,
                column,
                field: None,
                field_column: None,
                excerpt: format!("{lead}{}{}", middle, if cut { "..." } else { "" }),
                mark: lead.len() + column - 1 - first,
                width,
            }),
            problem,
        }
    }

    /// Makes an error as [`Self::error`] does, for a fault within a named field whose own text begins at byte `start`.
    pub fn field_error(&self, fault: Fault, field: &str, start: Option<usize>) -> FormatError {
        let at = self.boundary(fault.span.start);
        let field_column = start
            .map(|s| self.boundary(s))
            .filter(|&s| s <= at)
            .map(|s| self.text[s..at].chars().count() + 1);
        let mut error = self.error(fault);
        error.place.field = Some(field.into());
        error.place.field_column = field_column;
        error
    }
}
