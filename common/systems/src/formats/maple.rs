//! Maple: `vars := [x, y];` and `sys := [x^2 - y, x*y = 1];`; comments from `#`, and in `(* *)`.
//!
//! A list of names gives the order of the variables, and all other names are parameters; without one, the
//! variables stand in the order in which they occur.

use super::polynomial_list::{self as list, Declared, Words};
use super::sharing::WriteError;
use super::{FileSettings, Format, FormatError, Problem, Source, Warning};
use crate::expression::display::Style;
use crate::expression::fault::{Fault, Span};
use crate::expression::parse::Dialect;
use crate::expression::token::is_name;
use crate::system::System;

const WORDS: Words = Words {
    format: Format::Maple,
    style: Style::BERTINI,
    dialect: Dialect::BERTINI,
    functions: true,
    brackets: true,
};

fn clean(text: &str) -> String {
    list::without_comments(text, "#", Some(("(*", "*)")))
}

/// Whether a text is in this notation.
pub fn is(text: &str) -> bool {
    let text = &clean(text);
    let mut signs = text.match_indices(":=");
    signs.any(|(at, sign)| {
        let after = list::next(text, at + sign.len());
        after.is_some_and(|(_, c)| matches!(c, '[' | '{'))
    })
}

/// Reads the list of polynomials or equations of a text.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    list::problem(source, Format::Maple, system)
}

fn system(
    source: &Source<'_>,
    settings: &mut FileSettings,
    _: &mut Vec<Warning>,
) -> Result<System, Fault> {
    let text = &clean(source.text);
    let mut declared = Declared::default();
    let mut polynomials: Option<Span> = None;
    let mut from = 0;
    while let Some(at) = text[from..].find(":=") {
        let at = from + at + 2;
        let open = list::next(text, at).filter(|(_, c)| matches!(c, '[' | '{'));
        let Some((open, _)) = open else {
            let span = Span {
                start: at - 2,
                end: at,
            };
            let expected = "a list after `:=`, such as [x^2 - y, x*y = 1]";
            return Err(Fault::expected(span, expected, "something else"));
        };
        let inside = list::between(text, open)?;
        from = inside.end + 1;
        let all_names = list::parts(text, inside)
            .iter()
            .all(|(part, _)| is_name(part));
        match (all_names, polynomials) {
            (true, _) if declared.variables.is_none() => {
                declared.variables = Some(list::names(text, inside)?);
                declared.others_are_parameters = true;
            }
            (_, None) => polynomials = Some(inside),
            (_, Some(_)) => {
                let expected = "one list of polynomials, and one of variables";
                return Err(Fault::expected(inside, expected, "another list"));
            }
        }
    }
    let end = list::end_of(text);
    let list = polynomials.ok_or_else(|| Fault::expected(end, "a list of polynomials", "none"))?;
    list::system(text, list, &declared, WORDS.dialect, settings)
}

/// Writes the equations of a system.
pub fn write(system: &System) -> Result<String, WriteError> {
    list::check(system, &WORDS)?;
    let variables = system.variables.join(", ");
    let texts = list::texts(system, WORDS.style).join(",\n  ");
    Ok(format!("vars := [{variables}]:\nsys := [\n  {texts}]:\n"))
}
