//! PHCpack: the number of polynomials (and of unknowns), then the polynomials.
//!
//! The unknowns are ordered by their first appearance, which `x - x + y - y`
//! at the beginning of the first polynomial decides.

use super::sharing::{self, WriteError};
use super::{FileSettings, Format, FormatError, Problem, Source, Warning, finish, warn};
use crate::condition::Conditions;
use crate::expression::Node;
use crate::expression::build::{Builder, Use};
use crate::expression::display::Style;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::parse::{self, Dialect, Names, Operation};
use crate::expression::token::{TokenKind, Tokens, shorten};
use crate::formats::limits::{self, Limit};
use crate::system::{System, VariableGroup};

/// Reads a system in PHCpack's format; what follows the polynomials (solutions) is not read.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    let mut warnings = Vec::new();
    let mut settings = FileSettings::default();
    let system =
        system(source, &mut settings, &mut warnings).map_err(|fault| source.error(fault))?;
    Ok(Problem {
        system,
        settings,
        format: Format::Phcpack,
        warnings,
        conditions: Conditions::default(),
        objective: None,
    })
}

/// Contents of the first line: numbers of equations and unknowns.
struct Header {
    equations: usize,
    unknowns: usize,
    span: Span,
    /// Byte of the text where the polynomials begin.
    end: usize,
}

fn header(text: &str) -> Result<Header, Fault> {
    let start = text.len() - text.trim_start().len();
    let line = text[start..].lines().next().unwrap_or_default();
    let mut numbers = Vec::new();
    let mut end = start;
    let mut rest = line;
    // At most two whole numbers, each a word of its own.
    while numbers.len() < 2 {
        let lead = rest.len() - rest.trim_start().len();
        let word = rest.split_whitespace().next().unwrap_or_default();
        if word.is_empty() || !word.bytes().all(|b| b.is_ascii_digit()) {
            break;
        }
        let at = end + lead;
        end = at + word.len();
        numbers.push((word, Span { start: at, end }));
        rest = &line[end - start..];
    }
    let count = |(word, span): (&str, Span), limit: Limit| match word.parse::<usize>() {
        Ok(n) if n as u64 <= limit.value => Ok(n),
        _ => Err(Fault::limit(span, limit, shorten(word))),
    };
    let Some(&first) = numbers.first() else {
        let span = Span {
            start,
            end: start + 1,
        };
        return Err(Fault::expected(span, "the number of polynomials", "none"));
    };
    // `2 3*x*y ...` in one line: the second number belongs to a polynomial.
    if numbers.len() == 2 && !rest.trim().is_empty() {
        numbers.pop();
        end = first.1.end;
    }
    let equations = count(first, limits::EQUATIONS)?;
    let unknowns = match numbers.get(1) {
        Some(&second) => count(second, limits::VARIABLES)?,
        None => equations,
    };
    if equations == 0 {
        return Err(Fault::new(first.1, What::NoEquations));
    }
    if unknowns == 0 {
        return Err(Fault::new(first.1, What::NoVariables));
    }
    let span = Span {
        start: first.1.start,
        end,
    };
    Ok(Header {
        equations,
        unknowns,
        span,
        end,
    })
}

fn system(
    source: &Source<'_>,
    settings: &mut FileSettings,
    warnings: &mut Vec<Warning>,
) -> Result<System, Fault> {
    let header = header(source.text)?;
    let mut tokens = Tokens::starting_at(source.text, header.end, None);
    let mut names = Names::default();
    let mut builder = Builder::default();
    let mut totals = parse::Totals::default();
    let mut places = Vec::new();
    let mut system = System::default();
    for number in 1..=header.equations {
        let token = tokens.peek();
        if token.kind == TokenKind::End {
            let expected = format!("polynomial {number} of {}", header.equations);
            return Err(Fault::expected(token.span, expected, token.describe()));
        }
        let dialect = Dialect::PHCPACK;
        let parsed = parse::expression(&mut tokens, &mut names, dialect, "`;`", &mut totals)?;
        tokens.expect_symbol(';', "an operator or `;`")?;
        if names.count() > header.unknowns {
            let extra = header.unknowns as u32;
            let at = parsed
                .steps
                .iter()
                .find(|s| s.operation == Operation::Name(extra));
            let expected = match header.unknowns {
                1 => "1 unknown, as the first line says".into(),
                n => format!("{n} unknowns, as the first line says"),
            };
            return Err(Fault::expected(
                at.map_or(parsed.span, |s| s.span),
                expected,
                format!("another one, `{}`", names.name(extra)),
            ));
        }
        let equation = builder.build(&parsed, Use::Rational, &mut |expressions, name, _| {
            Ok(expressions.variable(name))
        })?;
        system.equations.push(equation);
        system.equation_names.push(format!("f{number}"));
        places.push(parsed.span);
    }
    settings.data_accuracy = totals.data_accuracy;
    if names.count() < header.unknowns {
        return Err(Fault::expected(
            header.span,
            format!("the number of unknowns that occur, {}", names.count()),
            header.unknowns.to_string(),
        ));
    }
    let rest = tokens.peek();
    // Titles and solutions are what PHCpack itself writes below a system.
    let is_phcpack_section = matches!(rest.kind, TokenKind::Name("TITLE" | "THE" | "SOLUTIONS"));
    if !is_phcpack_section && rest.kind != TokenKind::End {
        let message = format!(
            "what follows the {} polynomials is ignored",
            header.equations
        );
        warn(warnings, source, rest.span.start, message);
    }
    system.variables = (0..names.count() as u32)
        .map(|n| names.name(n).into())
        .collect();
    system.groups = vec![VariableGroup {
        variables: (0..system.variables.len()).collect(),
        homogeneous: false,
    }];
    builder.hand_over(&mut system, &places)?;
    finish(system, &places, header.span, None)
}

/// Writes the equations of a system in PHCpack's format.
///
/// It has no groups, parameters, roots or elementary functions; groups are
/// left out, a system with the others is refused.
pub fn write(system: &System) -> Result<String, WriteError> {
    let format = Format::Phcpack;
    let inexpressible = |what| Err(WriteError::Inexpressible { format, what });
    if !system.parameters.is_empty() {
        return inexpressible("parameters");
    }
    for name in &system.variables {
        if let Some(meaning) = Dialect::PHCPACK.reserved(name) {
            return Err(WriteError::ReservedName {
                name: name.clone(),
                format,
                meaning,
            });
        }
    }
    let expressions = &system.expressions;
    let mut needed: Vec<bool> = vec![false; expressions.nodes().len()];
    system
        .equations
        .iter()
        .for_each(|e| needed[e.0 as usize] = true);
    for id in (0..needed.len()).rev() {
        let node = crate::expression::NodeId(id as u32);
        if needed[id] {
            expressions
                .children(node)
                .for_each(|child| needed[child.0 as usize] = true);
            match expressions.node(node) {
                Node::Root(..) => return inexpressible("roots"),
                Node::Function(..) => return inexpressible("elementary functions"),
                _ => {}
            }
        }
    }
    if !sharing::fits_unshared(system, Style::PHCPACK) {
        return Err(WriteError::TooLarge(format));
    }
    let shared = std::collections::HashMap::new();
    let display = sharing::display(system, Style::PHCPACK, &shared);
    let (equations, unknowns) = (system.equations.len(), system.variables.len());
    let mut out = match equations == unknowns {
        true => format!("{equations}\n"),
        false => format!("{equations} {unknowns}\n"),
    };
    // Each variable once, so that the order of appearance is that of the system.
    let order: Vec<String> = system
        .variables
        .iter()
        .map(|v| format!("{v} - {v}"))
        .collect();
    out.push_str(&order.join(" + "));
    for (i, &equation) in system.equations.iter().enumerate() {
        let text = display.text(equation);
        match (i, text.strip_prefix('-')) {
            (0, Some(rest)) => out.push_str(&format!(" - {rest}")),
            (0, None) => out.push_str(&format!(" + {text}")),
            _ => out.push_str(&text),
        }
        out.push_str(";\n");
    }
    Ok(out)
}
