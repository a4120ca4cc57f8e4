//! Polynomial lists: what the notations of computer algebra have in common, a list of polynomials in declared names.
//!
//! Each notation blanks its comments, finds its declarations and the list, and hands these over with their places.

use super::sharing::{self, WriteError};
use super::{FileSettings, Format, FormatError, Problem, Source, Warning, finish};
use crate::condition::Conditions;
use crate::expression::build::{Builder, Use};
use crate::expression::display::Style;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::parse::{self, Dialect, Names};
use crate::expression::token::{TokenKind, Tokens, is_name, shorten};
use crate::expression::{Expressions, Node, NodeId};
use crate::system::{System, VariableGroup};
use std::collections::HashMap;

/// A name at its place.
pub(super) type Placed = (String, Span);

/// The names of a text.
#[derive(Debug, Default)]
pub(super) struct Declared {
    /// The variables in order; `None`: in the order in which they occur.
    pub variables: Option<Vec<Placed>>,
    /// The parameters in order.
    pub parameters: Vec<Placed>,
    /// Whatever is not a variable is a parameter.
    pub others_are_parameters: bool,
}

/// The problem of a text in this notation.
pub(super) fn problem(
    source: &Source<'_>,
    format: Format,
    system: impl FnOnce(&Source<'_>, &mut FileSettings, &mut Vec<Warning>) -> Result<System, Fault>,
) -> Result<Problem, FormatError> {
    let mut settings = FileSettings::default();
    let mut warnings = Vec::new();
    let system = system(source, &mut settings, &mut warnings);
    Ok(Problem {
        system: system.map_err(|fault| source.error(fault))?,
        settings,
        format,
        warnings,
        conditions: Conditions::default(),
        objective: None,
    })
}

/// The place after a text.
pub(super) fn end_of(text: &str) -> Span {
    Span {
        start: text.len(),
        end: text.len(),
    }
}

/// The text with blanks in the place of comments, so that places stay what they are: from a mark to the end of its
/// line, and between the marks of a block.
pub(super) fn without_comments(text: &str, line: &str, block: Option<(&str, &str)>) -> String {
    let mut clean = String::with_capacity(text.len());
    let mut rest = text;
    while !rest.is_empty() {
        let of_line = rest.find(line);
        let of_block = block.and_then(|(open, _)| rest.find(open));
        let (start, length) = match (of_line, of_block, block) {
            (l, Some(b), Some((open, close))) if l.is_none_or(|l| b < l) => {
                let inside = &rest[b + open.len()..];
                let end = inside.find(close).map(|at| at + close.len());
                (b, open.len() + end.unwrap_or(inside.len()))
            }
            (Some(l), ..) => (l, rest[l..].find('\n').unwrap_or(rest.len() - l)),
            _ => break,
        };
        clean.push_str(&rest[..start]);
        let comment = &rest[start..start + length];
        clean.extend(comment.bytes().map(|b| if b == b'\n' { '\n' } else { ' ' }));
        rest = &rest[start + length..];
    }
    clean.push_str(rest);
    clean
}

/// Finds the text between the bracket at byte `open` and the bracket that closes it.
pub(super) fn between(text: &str, open: usize) -> Result<Span, Fault> {
    let mut waiting = Vec::new();
    for (at, c) in text[open..].char_indices() {
        match c {
            '(' => waiting.push(')'),
            '[' => waiting.push(']'),
            '{' => waiting.push('}'),
            ')' | ']' | '}' => {
                let at = open + at;
                let span = Span {
                    start: at,
                    end: at + 1,
                };
                match waiting.pop() {
                    Some(closing) if closing == c => {}
                    Some(closing) => {
                        return Err(Fault::expected(
                            span,
                            format!("`{closing}`"),
                            format!("`{c}`"),
                        ));
                    }
                    None => {}
                }
                if waiting.is_empty() {
                    return Ok(Span {
                        start: open + 1,
                        end: at,
                    });
                }
            }
            _ => {}
        }
    }
    let closing = waiting.pop().unwrap_or(')');
    Err(Fault::expected(
        end_of(text),
        format!("`{closing}`"),
        "the end of the text",
    ))
}

/// The first character at or after a byte that is no blank, with its place.
pub(super) fn next(text: &str, from: usize) -> Option<(usize, char)> {
    let rest = text.get(from..)?;
    let mut characters = rest.char_indices();
    characters
        .find(|(_, c)| !c.is_whitespace())
        .map(|(at, c)| (from + at, c))
}

/// Finds a word that is no part of a longer one.
pub(super) fn word(text: &str, wanted: &str, from: usize) -> Option<usize> {
    let belongs = |c: char| c.is_alphanumeric() || c == '_';
    let mut occurrences = text.get(from..)?.match_indices(wanted);
    let at = occurrences.find(|(at, _)| {
        let at = from + at;
        let before = text[..at].chars().next_back();
        let after = text[at + wanted.len()..].chars().next();
        !before.is_some_and(belongs) && !after.is_some_and(belongs)
    });
    at.map(|(at, _)| from + at)
}

/// The parts of a text between commas, without blanks around them.
pub(super) fn parts(text: &str, span: Span) -> Vec<(&str, Span)> {
    let mut start = span.start;
    let mut placed_parts = Vec::new();
    for part in text[span.start..span.end].split(',') {
        let lead = part.len() - part.trim_start().len();
        let trimmed = part.trim();
        let at = start + lead;
        placed_parts.push((
            trimmed,
            Span {
                start: at,
                end: at + trimmed.len(),
            },
        ));
        start += part.len() + 1;
    }
    placed_parts
}

/// Names between commas.
pub(super) fn names(text: &str, span: Span) -> Result<Vec<Placed>, Fault> {
    let parts = parts(text, span).into_iter();
    let checked = parts.map(|(name, at)| match is_name(name) {
        true => Ok((name.to_owned(), at)),
        false => Err(Fault::expected(
            at,
            "a name",
            format!("`{}`", shorten(name)),
        )),
    });
    checked.collect()
}

/// Declares names: they are new, and mean nothing by themselves.
fn declare(symbols: &mut Names, names: &[Placed], dialect: Dialect) -> Result<(), Fault> {
    for (name, at) in names {
        parse::check_free(name, *at, dialect)?;
        if symbols.find(name).is_some() {
            let problem = What::DuplicateName {
                name: name.clone(),
                first: "is declared already".to_owned(),
            };
            return Err(Fault::new(*at, problem));
        }
        symbols.intern(name);
    }
    Ok(())
}

/// The system of the polynomials in a part of a text, which has brackets no more.
pub(super) fn system(
    text: &str,
    list: Span,
    declared: &Declared,
    dialect: Dialect,
    settings: &mut FileSettings,
) -> Result<System, Fault> {
    let mut symbols = Names::default();
    declare(
        &mut symbols,
        declared.variables.as_deref().unwrap_or(&[]),
        dialect,
    )?;
    let variables = symbols.count();
    declare(&mut symbols, &declared.parameters, dialect)?;
    let declared_count = symbols.count();
    let mut tokens = Tokens::starting_at(&text[..list.end], list.start, None);
    let mut totals = parse::Totals::default();
    let mut builder = Builder::default();
    let mut system = System::default();
    let mut places = Vec::new();
    let open = declared.variables.is_none();
    loop {
        let end = "`,` or the end of the list";
        let mut read = |tokens: &mut Tokens<'_>, symbols: &mut Names| {
            let parsed = parse::expression(tokens, symbols, dialect, end, &mut totals)?;
            let mut resolve = |expressions: &mut Expressions, name: u32, at: Span| {
                let number = name as usize;
                match (open, number < variables, number < declared_count) {
                    (true, ..) | (_, true, _) => Ok(expressions.variable(name)),
                    (_, _, true) => Ok(expressions.parameter(name - variables as u32)),
                    _ if declared.others_are_parameters => {
                        Ok(expressions.parameter(name - variables as u32))
                    }
                    _ => Err(Fault::new(at, What::UnknownName(symbols.name(name).into()))),
                }
            };
            let node = builder.build(&parsed, Use::Rational, &mut resolve)?;
            Ok::<_, Fault>((node, parsed.span))
        };
        let (mut equation, mut place) = read(&mut tokens, &mut symbols)?;
        if tokens.take_symbol('=').is_some() {
            // == is the same.
            tokens.take_symbol('=');
            let (right, at) = read(&mut tokens, &mut symbols)?;
            equation = builder.expressions.subtract(equation, right);
            place = place.to(at);
        }
        system.equations.push(equation);
        places.push(place);
        let token = tokens.peek();
        match token.kind {
            TokenKind::Symbol(',') => {
                tokens.take();
            }
            TokenKind::End => break,
            _ => return Err(Fault::expected(token.span, end, token.describe())),
        }
    }
    settings.data_accuracy = totals.data_accuracy;
    let count = if open { symbols.count() } else { variables };
    let symbol_names = (0..symbols.count() as u32).map(|n| symbols.name(n).to_owned());
    system.variables = symbol_names.collect();
    system.parameters = system.variables.split_off(count);
    system.groups = vec![VariableGroup {
        variables: (0..count).collect(),
        homogeneous: false,
    }];
    system.equation_names = (1..=places.len()).map(|k| format!("f{k}")).collect();
    builder.hand_over(&mut system, &places)?;
    finish(system, &places, list, None)
}

/// Features of a notation of polynomials.
pub(super) struct Words {
    /// The notation.
    pub format: Format,
    /// How numbers are written.
    pub style: Style,
    /// Names with a meaning of their own in the notation.
    pub dialect: Dialect,
    /// Whether the notation has roots and elementary functions.
    pub functions: bool,
    /// Whether names may have brackets, as `x[1]`.
    pub brackets: bool,
}

/// Features of a notation that a system needs.
pub(super) struct Needs {
    /// Some number is not real.
    pub complex: bool,
}

/// Whether a notation has words for all of a system.
pub(super) fn check(system: &System, words: &Words) -> Result<Needs, WriteError> {
    let format = words.format;
    let inexpressible = |what| Err(WriteError::Inexpressible { format, what });
    for name in system.variables.iter().chain(&system.parameters) {
        if let Some(meaning) = words.dialect.reserved(name) {
            return Err(WriteError::ReservedName {
                name: name.clone(),
                format,
                meaning,
            });
        }
        if !words.brackets && name.contains(['[', ']']) || !name.is_ascii() {
            return inexpressible("names with brackets or letters beyond ASCII");
        }
    }
    let mut needs = Needs { complex: false };
    for id in below(system) {
        match system.expressions.node(id) {
            Node::Root(..) if !words.functions => return inexpressible("roots"),
            Node::Function(..) if !words.functions => {
                return inexpressible("elementary functions");
            }
            Node::Constant(c) if !c.is_real() => needs.complex = true,
            _ => {}
        }
    }
    if !sharing::fits_unshared(system, words.style) {
        return Err(WriteError::TooLarge(format));
    }
    Ok(needs)
}

/// All nodes that the equations need.
fn below(system: &System) -> impl Iterator<Item = NodeId> {
    let mut needed = vec![false; system.expressions.nodes().len()];
    for equation in &system.equations {
        needed[equation.0 as usize] = true;
    }
    for id in (0..needed.len()).rev() {
        if needed[id] {
            let children = system.expressions.children(NodeId(id as u32));
            children.for_each(|child| needed[child.0 as usize] = true);
        }
    }
    let needed = needed.into_iter().enumerate();
    needed.filter_map(|(id, needed)| needed.then_some(NodeId(id as u32)))
}

/// The equations as texts.
pub(super) fn texts(system: &System, style: Style) -> Vec<String> {
    let shared = HashMap::new();
    let display = sharing::display(system, style, &shared);
    let equations = system.equations.iter();
    equations.map(|&equation| display.text(equation)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_blank_and_places_stay() {
        let text = "a // b é\nc /* d\n e */ f";
        let clean = without_comments(text, "//", Some(("/*", "*/")));
        assert_eq!(clean, "a        \nc     \n      f");
        assert_eq!(clean.len(), text.len());
        assert_eq!(without_comments("x -- y", "--", None), "x     ");
        assert_eq!(
            without_comments("x /* y", "//", Some(("/*", "*/"))),
            "x     "
        );
    }

    #[test]
    fn brackets_are_matched() {
        let span = between("f(a, [b, {c}], d) e", 1).unwrap();
        assert_eq!((span.start, span.end), (2, 16));
        assert!(between("(a]", 0).is_err());
        assert!(between("(a", 0).is_err());
    }

    #[test]
    fn words_are_whole() {
        assert_eq!(word("myideal ideal(x)", "ideal", 0), Some(8));
        assert_eq!(word("ideals", "ideal", 0), None);
    }
}
