//! Macaulay2: `R = QQ[x, y]` and `I = ideal(x^2 - y, x*y - 1)`; comments from `--`, and in `-* *-`.
//!
//! `QQ[a][x, y]` and `frac(QQ[a])[x, y]` have a parameter a. A number that is not real needs `ii`, which is in `CC`.

use super::polynomial_list::{self as list, Declared, Needs, Placed, Words};
use super::sharing::WriteError;
use super::{FileSettings, Format, FormatError, Problem, Source, Warning, warn};
use crate::expression::display::Style;
use crate::expression::fault::{Fault, Span};
use crate::expression::parse::Dialect;
use crate::expression::token::{is_name, shorten};
use crate::system::System;

const WORDS: Words = Words {
    format: Format::Macaulay2,
    style: Style {
        imaginary: "ii",
        bracketed_constants: false,
    },
    dialect: Dialect {
        imaginary: &["ii"],
        pi: false,
        foreign_constants: false,
        implicit_products: false,
    },
    functions: false,
    brackets: false,
};

/// Most names that a range such as `x_1..x_9` stands for.
const MOST_NAMES: u64 = 100_000;

/// Numbers whose polynomials can be solved.
const FIELDS: [&str; 4] = ["QQ", "RR", "CC", "ZZ"];

fn clean(text: &str) -> String {
    list::without_comments(text, "--", Some(("-*", "*-")))
}

/// The ring before a bracket: its text and place.
fn ring_before(text: &str, open: usize) -> (&str, Span) {
    let before = text[..open].trim_end();
    let belongs = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '/');
    let start = before.trim_end_matches(belongs).len();
    let span = Span {
        start,
        end: before.len(),
    };
    (&before[start..], span)
}

/// Finds the first bracket of a ring.
fn ring(text: &str) -> Option<usize> {
    let mut brackets = text.match_indices('[').map(|(at, _)| at);
    brackets.find(|&at| {
        let (name, _) = ring_before(text, at);
        let field = name.split(['_', '/']).next().unwrap_or_default();
        FIELDS.contains(&field)
    })
}

/// Whether a text is in this notation.
pub fn is(text: &str) -> bool {
    let clean = clean(text);
    ring(&clean).is_some() && list::word(&clean, "function", 0).is_none()
}

/// Reads the first ideal, or the first list in braces, of a text.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    list::problem(source, Format::Macaulay2, system)
}

fn system(
    source: &Source<'_>,
    settings: &mut FileSettings,
    warnings: &mut Vec<Warning>,
) -> Result<System, Fault> {
    let text = &clean(source.text);
    let open = ring(text).ok_or_else(|| missing(text, "a ring such as QQ[x, y]"))?;
    let (name, at) = ring_before(text, open);
    if name.contains('/') {
        let expected = "a ring over QQ, RR or CC: over a finite field nothing is followed";
        return Err(Fault::expected(
            at,
            expected,
            format!("`{}`", shorten(name)),
        ));
    }
    let first = list::between(text, open)?;
    let mut end = first.end + 1;
    if let Some((at, ')')) = list::next(text, end) {
        end = at + 1;
    }
    let declared = match list::next(text, end) {
        Some((second, '[')) => {
            let variables = list::between(text, second)?;
            end = variables.end + 1;
            Declared {
                variables: Some(generators(text, variables)?),
                parameters: generators(text, first)?,
                ..Declared::default()
            }
        }
        _ => Declared {
            variables: Some(generators(text, first)?),
            ..Declared::default()
        },
    };
    let bracket = match list::word(text, "ideal", end) {
        Some(at) => list::next(text, at + "ideal".len()),
        None => text[end..].find('{').map(|at| (end + at, '{')),
    };
    let bracket = bracket.filter(|(_, c)| matches!(c, '(' | '{'));
    let (bracket, _) = bracket.ok_or_else(|| missing(text, "an ideal such as ideal(x^2 - y)"))?;
    let mut polynomials = list::between(text, bracket)?;
    let after = polynomials.end + 1;
    // ideal({...}) is the same.
    if let Some((inner, '{')) = list::next(text, polynomials.start)
        && inner < polynomials.end
    {
        polynomials = list::between(text, inner)?;
    }
    let is_end = |c: char| c.is_whitespace() || c == ';';
    if let Some(at) = text[after..].find(|c| !is_end(c)) {
        let message = "what follows the ideal is ignored".to_owned();
        warn(warnings, source, after + at, message);
    }
    list::system(text, polynomials, &declared, WORDS.dialect, settings)
}

fn missing(text: &str, expected: &str) -> Fault {
    Fault::expected(list::end_of(text), expected, "none")
}

/// Names, and ranges of them such as `x_1..x_4` or `a..d`; options such as `MonomialOrder => Lex` are left out.
fn generators(text: &str, span: Span) -> Result<Vec<Placed>, Fault> {
    let mut names = Vec::new();
    for (part, at) in list::parts(text, span) {
        let wrong = || Fault::expected(at, "a name", format!("`{}`", shorten(part)));
        if part.contains("=>") {
            continue;
        }
        match part.split_once("..") {
            None if is_name(part) => names.push((part.to_owned(), at)),
            None => return Err(wrong()),
            Some((first, last)) => {
                let (first, last) = (first.trim(), last.trim());
                let range = range(first, last).ok_or_else(|| {
                    let expected = "a range such as x_1..x_4 or a..d";
                    Fault::expected(at, expected, format!("`{}`", shorten(part)))
                })?;
                names.extend(range.into_iter().map(|name| (name, at)));
            }
        }
    }
    Ok(names)
}

fn range(first: &str, last: &str) -> Option<Vec<String>> {
    let letter = |text: &str| {
        let mut characters = text.chars();
        let letter = characters.next().filter(char::is_ascii_alphabetic);
        letter.filter(|_| characters.next().is_none())
    };
    if let (Some(a), Some(b)) = (letter(first), letter(last)) {
        return (a <= b).then(|| (a..=b).map(String::from).collect());
    }
    let numbered = |text: &str| {
        let (name, number) = text.rsplit_once('_')?;
        let number: u64 = number.parse().ok()?;
        is_name(name).then(|| (name.to_owned(), number))
    };
    let ((name, low), (other, high)) = (numbered(first)?, numbered(last)?);
    let fits = name == other && low <= high && high - low < MOST_NAMES;
    fits.then(|| (low..=high).map(|k| format!("{name}_{k}")).collect())
}

/// Writes the equations of a system.
pub fn write(system: &System) -> Result<String, WriteError> {
    let Needs { complex } = list::check(system, &WORDS)?;
    let field = if complex { "CC" } else { "QQ" };
    let field = match system.parameters.is_empty() {
        true => field.to_owned(),
        // A parameter may stand in a denominator.
        false => format!("frac({field}[{}])", system.parameters.join(", ")),
    };
    let variables = system.variables.join(", ");
    let texts = list::texts(system, WORDS.style).join(",\n  ");
    Ok(format!(
        "R = {field}[{variables}]\nI = ideal(\n  {texts})\n"
    ))
}
