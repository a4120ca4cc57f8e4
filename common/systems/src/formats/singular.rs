//! Singular: `ring r = 0, (x, y), dp;` and `ideal i = x^2 - y, x*y - 1;`; comments from `//`, and in `/* */`.
//!
//! `ring r = (0, a), (x, y), dp;` has a parameter a; `minpoly = a^2 + 1;` makes it the imaginary unit.

use super::polynomial_list::{self as list, Declared, Needs, Words};
use super::sharing::WriteError;
use super::{FileSettings, Format, FormatError, Problem, Source, Warning, warn};
use crate::expression::display::Style;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::parse::Dialect;
use crate::expression::token::shorten;
use crate::system::System;

const PLAIN: Dialect = Dialect {
    imaginary: &[],
    pi: false,
    foreign_constants: false,
    implicit_products: false,
};
const COMPLEX: Dialect = Dialect {
    imaginary: &["i"],
    pi: false,
    foreign_constants: false,
    implicit_products: false,
};

fn words(dialect: Dialect) -> Words {
    Words {
        format: Format::Singular,
        style: Style {
            imaginary: "i",
            bracketed_constants: false,
        },
        dialect,
        functions: false,
        brackets: false,
    }
}

fn clean(text: &str) -> String {
    list::without_comments(text, "//", Some(("/*", "*/")))
}

/// Finds the word `ring` at the beginning of a statement.
fn ring(text: &str) -> Option<usize> {
    let mut from = 0;
    while let Some(at) = list::word(text, "ring", from) {
        let before = text[..at].trim_end();
        let begins = before.is_empty() || before.ends_with(';');
        let named = list::next(text, at + "ring".len()).is_some_and(|(_, c)| c.is_alphabetic());
        if begins && named {
            return Some(at);
        }
        from = at + 1;
    }
    None
}

/// Whether a text is in this notation.
pub fn is(text: &str) -> bool {
    ring(&clean(text)).is_some()
}

/// Reads the first ideal of a text.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    list::problem(source, Format::Singular, system)
}

fn missing(text: &str, at: usize, expected: &str) -> Fault {
    let (at, actual_input) = match list::next(text, at) {
        Some((at, c)) => (at, format!("`{c}`")),
        None => (text.len(), "none".to_owned()),
    };
    let span = Span { start: at, end: at };
    Fault::expected(span, expected, actual_input)
}

/// Finds the text between the first `=` after a word and the next `;`.
fn value_of(text: &str, word: usize) -> Result<Span, Fault> {
    let rest = &text[word..];
    let equals = rest
        .find(['=', ';'])
        .filter(|&at| rest[at..].starts_with('='));
    let equals = equals.ok_or_else(|| missing(text, word, "a statement with `=`"))?;
    let end = rest[equals..].find(';');
    let end = end.ok_or_else(|| missing(text, text.len(), "`;`"))?;
    Ok(Span {
        start: word + equals + 1,
        end: word + equals + end,
    })
}

fn system(
    source: &Source<'_>,
    settings: &mut FileSettings,
    warnings: &mut Vec<Warning>,
) -> Result<System, Fault> {
    let text = &clean(source.text);
    let at = ring(text).ok_or_else(|| missing(text, text.len(), "a ring"))?;
    let value = value_of(text, at)?;
    let (mut declared, end) = ring_of(text, value)?;
    let mut dialect = PLAIN;
    if let Some(at) = list::word(text, "minpoly", end) {
        let minimal = value_of(text, at)?;
        let written: String = text[minimal.start..minimal.end]
            .split_whitespace()
            .collect();
        let unit = declared.parameters.iter().map(|(name, _)| name.as_str());
        let is_unit = unit.eq(["i"]) && matches!(written.as_str(), "i^2+1" | "i2+1" | "1+i^2");
        if !is_unit {
            let expected = "minpoly = i^2 + 1 for a single parameter i";
            return Err(Fault::expected(
                minimal,
                expected,
                format!("`{}`", shorten(&written)),
            ));
        }
        declared.parameters.clear();
        dialect = COMPLEX;
    }
    let ideal = list::word(text, "ideal", end);
    let ideal =
        ideal.ok_or_else(|| missing(text, text.len(), "an ideal such as `ideal i = x^2 - y;`"))?;
    let list = value_of(text, ideal)?;
    if let Some((at, _)) = list::next(text, list.end + 1) {
        let message = "what follows the ideal is ignored".to_owned();
        warn(warnings, source, at, message);
    }
    list::system(text, list, &declared, dialect, settings)
        .map_err(|fault| short_form(fault, &declared))
}

/// `x2` for `x^2` is told apart from a name that was forgotten.
fn short_form(fault: Fault, declared: &Declared) -> Fault {
    let What::UnknownName(name) = &fault.problem else {
        return fault;
    };
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let mut variables = declared.variables.iter().flatten();
    if letters.len() == name.len() || !variables.any(|(variable, _)| variable == letters) {
        return fault;
    }
    let expected = format!(
        "`{letters}^{}`: Singular's short form is not read",
        &name[letters.len()..]
    );
    Fault::expected(fault.span, expected, format!("`{name}`"))
}

/// The names of a ring, and where it ends.
fn ring_of(text: &str, value: Span) -> Result<(Declared, usize), Fault> {
    let (at, first) = list::next(text, value.start)
        .filter(|(at, _)| *at < value.end)
        .ok_or_else(|| missing(text, value.start, "a characteristic, 0"))?;
    let (field, after) = match first {
        '(' => {
            let inside = list::between(text, at)?;
            (inside, inside.end + 1)
        }
        _ => {
            let end = text[at..value.end].find(',').map_or(value.end, |e| at + e);
            (Span { start: at, end }, end)
        }
    };
    let mut parts = list::parts(text, field).into_iter();
    let (number, place) = parts.next().unwrap_or(("", field));
    let expected = "0 or QQ: over a finite field nothing is followed";
    if !matches!(number, "0" | "QQ") {
        return Err(Fault::expected(
            place,
            expected,
            format!("`{}`", shorten(number)),
        ));
    }
    let parameters = parts.map(|(_, at)| at).collect::<Vec<_>>();
    let parameters = match (parameters.first(), parameters.last()) {
        (Some(first), Some(last)) => list::names(text, first.to(*last))?,
        _ => Vec::new(),
    };
    let comma = list::next(text, after).filter(|(_, c)| *c == ',');
    let (comma, _) = comma.ok_or_else(|| missing(text, after, "`,` and the variables"))?;
    let open = list::next(text, comma + 1).filter(|(_, c)| *c == '(');
    let (open, _) =
        open.ok_or_else(|| missing(text, comma + 1, "the variables in brackets, as (x, y)"))?;
    let variables = list::names(text, list::between(text, open)?)?;
    let declared = Declared {
        variables: Some(variables),
        parameters,
        ..Declared::default()
    };
    Ok((declared, value.end))
}

/// Writes the equations of a system.
pub fn write(system: &System) -> Result<String, WriteError> {
    let mut words = words(PLAIN);
    let Needs { complex } = list::check(system, &words)?;
    if complex {
        words.dialect = COMPLEX;
        list::check(system, &words)?;
        if !system.parameters.is_empty() {
            return Err(WriteError::Inexpressible {
                format: Format::Singular,
                what: "numbers that are not real beside parameters",
            });
        }
    }
    let mut field: Vec<&str> = system.parameters.iter().map(String::as_str).collect();
    field.extend(complex.then_some("i"));
    let field = match field.is_empty() {
        true => "0".to_owned(),
        false => format!("(0, {})", field.join(", ")),
    };
    let minimal = if complex { "minpoly = i^2 + 1;\n" } else { "" };
    let variables = system.variables.join(", ");
    let texts = list::texts(system, words.style).join(",\n  ");
    Ok(format!(
        "ring r = {field}, ({variables}), dp;\n{minimal}ideal I =\n  {texts};\n"
    ))
}
