//! TargetTable: values of parameters as CSV, with a header of names and a line for each target.

use super::limits;
use super::number_list;
use super::scope::FieldFault;
use super::target_block::Block;
use crate::expression::fault::{Fault, Problem, Span};
use crate::expression::token::shorten;
use cognate_numeric::counted::counted;
use num_complex::Complex64;

/// Part of a value that a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// The whole value.
    Whole,
    /// The real part; the column `NAME_im` has the other.
    Real,
    /// The imaginary part.
    Imaginary,
}

/// A column: the part of a parameter, by its index, that it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Column {
    parameter: usize,
    part: Part,
}

/// A line of the text with its place.
struct Line {
    span: Span,
}

impl Line {
    /// The cells without blanks and quotes around them.
    fn cells<'a>(&self, text: &'a str, separator: char) -> impl Iterator<Item = (&'a str, Span)> {
        let mut start = self.span.start;
        let line = &text[self.span.start..self.span.end];
        line.split(separator).map(move |cell| {
            let at = start;
            start += cell.len() + separator.len_utf8();
            let trimmed = cell.trim();
            let unquoted = trimmed.strip_prefix('"').and_then(|c| c.strip_suffix('"'));
            let content = unquoted.unwrap_or(trimmed).trim();
            let lead = content.as_ptr() as usize - cell.as_ptr() as usize;
            let span = Span {
                start: at + lead,
                end: at + lead + content.len(),
            };
            (content, span)
        })
    }
}

/// The lines that are not empty.
fn lines(text: &str) -> impl Iterator<Item = Line> {
    let mut start = 0;
    let lines = text.split_inclusive('\n').map(move |line| {
        let at = start;
        start += line.len();
        let content = line.trim_end();
        let lead = content.len() - content.trim_start().len();
        Line {
            span: Span {
                start: at + lead,
                end: at + content.len(),
            },
        }
    });
    lines.filter(|line| line.span.start < line.span.end)
}

/// The character between cells: that of the header.
fn separator(header: &str) -> char {
    let candidates = [',', ';', '\t'];
    let used = candidates.into_iter().find(|c| header.contains(*c));
    used.unwrap_or(',')
}

/// Reads a table.
pub(super) fn read(text: &str, parameters: &[String]) -> Result<Block, FieldFault> {
    let mut lines = lines(text);
    let header = lines.next().map_or(Span::default(), |line| line.span);
    let separator = separator(&text[header.start..header.end]);
    let header = Line { span: header };
    let names: Vec<(&str, Span)> = header.cells(text, separator).collect();
    let columns = columns(&names, parameters).map_err(|fault| FieldFault::new("", fault))?;
    let mut block = Block {
        parameters: columns.iter().map(|c| c.parameter).collect(),
        rows: Vec::new(),
        span: header.span,
    };
    block.parameters.sort_unstable();
    block.parameters.dedup();
    for line in lines {
        if block.rows.len() as u64 >= limits::TARGETS.value {
            let fault = Fault::limit(line.span, limits::TARGETS, "more");
            return Err(FieldFault::new("", fault));
        }
        let mut row = vec![Complex64::new(0.0, 0.0); block.parameters.len()];
        let mut cells = line.cells(text, separator);
        for (column, (name, _)) in columns.iter().zip(&names) {
            let Some((_, span)) = cells.next() else {
                let expected = format!("{}, as the header has", counted(columns.len(), "value"));
                let fault = Fault::expected(line.span, expected, "fewer");
                return Err(FieldFault::new("", fault));
            };
            let value = number_list::number(text, span);
            let value = value.map_err(|fault| FieldFault::new(*name, fault))?;
            let place = block.parameters.binary_search(&column.parameter);
            if let Some(entry) = place.ok().and_then(|place| row.get_mut(place)) {
                match column.part {
                    Part::Whole => *entry = value,
                    Part::Real => entry.re = value.re,
                    Part::Imaginary => entry.im = value.re,
                }
            }
            if column.part != Part::Whole && value.im != 0.0 {
                let fault = Fault::expected(span, "a real number", "a complex one");
                return Err(FieldFault::new(*name, fault));
            }
        }
        if let Some((cell, span)) = cells.next() {
            let expected = format!(
                "the end of the line after {}",
                counted(columns.len(), "value")
            );
            let fault = Fault::expected(span, expected, format!("`{}`", shorten(cell)));
            return Err(FieldFault::new("", fault));
        }
        block.rows.push(row);
    }
    if block.rows.is_empty() {
        let fault = Fault::expected(header.span, "a line of values below the header", "none");
        return Err(FieldFault::new("", fault));
    }
    Ok(block)
}

/// Finds the parameter, and the part of its value, in each column of this header.
fn columns(names: &[(&str, Span)], parameters: &[String]) -> Result<Vec<Column>, Fault> {
    let index = |name: &str| parameters.iter().position(|parameter| parameter == name);
    let column = |name: &str| {
        let part = |ending: &str, part: Part| {
            let parameter = index(name.strip_suffix(ending)?)?;
            Some(Column { parameter, part })
        };
        let whole = index(name).map(|parameter| Column {
            parameter,
            part: Part::Whole,
        });
        whole
            .or_else(|| part("_re", Part::Real))
            .or_else(|| part("_im", Part::Imaginary))
    };
    let mut columns: Vec<Column> = Vec::new();
    for (name, span) in names {
        let unknown = || {
            let listed = parameters.join(", ");
            let expected = format!("a header with names of parameters ({listed})");
            Fault::expected(*span, expected, format!("`{}`", shorten(name)))
        };
        let next = column(name).ok_or_else(unknown)?;
        let clashes = |other: &&Column| {
            other.parameter == next.parameter
                && (other.part == next.part
                    || other.part == Part::Whole
                    || next.part == Part::Whole)
        };
        if columns.iter().any(|other| clashes(&other)) {
            let problem = Problem::DuplicateName {
                name: (*name).to_owned(),
                first: "has a column already".into(),
            };
            return Err(Fault::new(*span, problem));
        }
        columns.push(next);
    }
    for ((name, span), column) in names.iter().zip(&columns) {
        let other = match column.part {
            Part::Whole => continue,
            Part::Real => (Part::Imaginary, "_im"),
            Part::Imaginary => (Part::Real, "_re"),
        };
        let partner = Column {
            part: other.0,
            ..*column
        };
        if !columns.contains(&partner) {
            let expected = format!("a column `{}{}` too", parameters[column.parameter], other.1);
            return Err(Fault::expected(*span, expected, format!("`{name}` alone")));
        }
    }
    Ok(columns)
}
