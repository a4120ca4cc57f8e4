//! msolve: the variables between commas, the characteristic, then polynomials between commas.

use super::polynomial_list::{self as list, Declared, Words};
use super::sharing::WriteError;
use super::{FileSettings, Format, FormatError, Problem, Source, Warning};
use crate::expression::display::Style;
use crate::expression::fault::{Fault, Span};
use crate::expression::parse::Dialect;
use crate::expression::token::{is_name, shorten};
use crate::polynomial::Polynomial;
use crate::system::System;

const WORDS: Words = Words {
    format: Format::Msolve,
    style: Style::BERTINI,
    dialect: Dialect {
        imaginary: &[],
        pi: false,
        foreign_constants: false,
        implicit_products: false,
    },
    functions: false,
    brackets: false,
};

/// The places of the first two lines that are not blank, and where the rest begins.
fn head(text: &str) -> Option<(Span, Span, usize)> {
    let mut lines = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if !line.trim().is_empty() {
            let lead = line.len() - line.trim_start().len();
            lines.push(Span {
                start: start + lead,
                end: start + lead + line.trim().len(),
            });
        }
        start += line.len();
        if let [first, second] = lines[..] {
            return Some((first, second, start));
        }
    }
    None
}

/// Whether a text is in this notation: names between commas, then a whole number.
pub fn is(text: &str) -> bool {
    head(text).is_some_and(|(first, second, _)| {
        let number = &text[second.start..second.end];
        let names = list::parts(text, first);
        names.iter().all(|(name, _)| is_name(name)) && number.bytes().all(|b| b.is_ascii_digit())
    })
}

/// Reads a system.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    list::problem(source, Format::Msolve, system)
}

fn system(
    source: &Source<'_>,
    settings: &mut FileSettings,
    _: &mut Vec<Warning>,
) -> Result<System, Fault> {
    let text = source.text;
    let end = list::end_of(text);
    let lines = head(text);
    let (first, second, start) =
        lines.ok_or_else(|| Fault::expected(end, "the characteristic, 0", "none"))?;
    let number = &text[second.start..second.end];
    if number != "0" {
        let expected = "the characteristic 0: over a finite field nothing is followed";
        return Err(Fault::expected(
            second,
            expected,
            format!("`{}`", shorten(number)),
        ));
    }
    let declared = Declared {
        variables: Some(list::names(text, first)?),
        ..Declared::default()
    };
    let list = Span {
        start,
        end: text.len(),
    };
    list::system(text, list, &declared, WORDS.dialect, settings)
}

/// Writes the equations of a system, multiplied out: msolve knows no brackets.
pub fn write(system: &System) -> Result<String, WriteError> {
    let format = Format::Msolve;
    let inexpressible = |what| WriteError::Inexpressible { format, what };
    if list::check(system, &WORDS)?.complex {
        return Err(inexpressible("numbers that are not real"));
    }
    if !system.parameters.is_empty() {
        return Err(inexpressible("parameters"));
    }
    let mut texts = Vec::new();
    for &equation in &system.equations {
        let expanded = Polynomial::expand(&system.expressions, equation, system.variables.len(), 0);
        let expanded = expanded.ok_or(WriteError::TooLarge(format))?;
        if expanded
            .terms
            .keys()
            .flatten()
            .all(|exponent| *exponent == 0)
        {
            return Err(inexpressible("equations in which all variables cancel"));
        }
        let mut text = String::new();
        for (exponents, coefficient) in &expanded.terms {
            let factors = system.variables.iter().zip(exponents);
            let factors = factors.filter(|(_, exponent)| **exponent > 0);
            let monomial: Vec<String> = factors
                .map(|(name, exponent)| match exponent {
                    1 => name.clone(),
                    exponent => format!("{name}^{exponent}"),
                })
                .collect();
            let sign = match (coefficient.re < 0, text.is_empty()) {
                (true, _) => "-",
                (false, true) => "",
                (false, false) => "+",
            };
            let size = rug::Rational::from(coefficient.re.abs_ref()).to_string();
            text.push_str(sign);
            match (monomial.is_empty(), size.as_str()) {
                (true, _) => text.push_str(&size),
                (false, "1") => text.push_str(&monomial.join("*")),
                (false, _) => text.push_str(&format!("{size}*{}", monomial.join("*"))),
            }
        }
        texts.push(text);
    }
    let variables = system.variables.join(",");
    Ok(format!("{variables}\n0\n{}\n", texts.join(",\n")))
}
