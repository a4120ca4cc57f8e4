//! Bertini-classic input: settings, declarations and definitions in any order.

mod definitions;
mod settings;
mod write;

pub use write::write;

use super::{FileSettings, Format, FormatError, Problem, Source, Warning, finish, limits, warn};
use crate::condition::Conditions;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::parse::{self, Dialect, Names, Parsed};
use crate::expression::similar::meant;
use crate::expression::token::{Token, TokenKind, Tokens};
use std::collections::HashMap;

/// Kind of a name, as it was declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Kind {
    Variable,
    Function,
    Constant,
    Parameter,
    PathVariable,
    /// A constant that the seed decides: complex of modulus 1, or real between -1 and 1.
    Random {
        real: bool,
    },
}

impl Kind {
    fn describe(self) -> &'static str {
        match self {
            Kind::Variable => "variable",
            Kind::Function => "function",
            Kind::Constant => "constant",
            Kind::Parameter => "parameter",
            Kind::PathVariable => "path variable",
            Kind::Random { .. } => "random constant",
        }
    }
}

/// Kind of a line that declares names, by its first word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Declaration {
    Group { homogeneous: bool },
    Plain(Kind),
}

fn declaration(word: &str) -> Option<Declaration> {
    Some(match word {
        "variable_group" => Declaration::Group { homogeneous: false },
        "hom_variable_group" => Declaration::Group { homogeneous: true },
        "variable" => Declaration::Plain(Kind::Variable),
        "function" => Declaration::Plain(Kind::Function),
        "constant" => Declaration::Plain(Kind::Constant),
        "parameter" => Declaration::Plain(Kind::Parameter),
        "pathvariable" => Declaration::Plain(Kind::PathVariable),
        "random" => Declaration::Plain(Kind::Random { real: false }),
        "random_real" => Declaration::Plain(Kind::Random { real: true }),
        _ => return None,
    })
}

/// Whether a text in this notation may begin with this word.
pub(super) fn begins_with(word: &str) -> bool {
    ["CONFIG", "INPUT", "END"].contains(&word) || declaration(word).is_some()
}

/// Everything that a file says, before any name has a meaning.
#[derive(Debug, Default)]
struct Statements {
    names: Names,
    /// Names in the order of their declaration.
    declared: Vec<(u32, Kind, Span)>,
    kinds: HashMap<u32, Kind>,
    /// Number of names of each kind.
    counts: HashMap<Kind, u64>,
    /// Place where each name was declared.
    places: HashMap<u32, Span>,
    /// Groups of variables: homogeneous or not, and the names.
    groups: Vec<(bool, Vec<u32>)>,
    /// Names of `variable`, which form no group of their own.
    ungrouped: Vec<u32>,
    /// Definitions in the order of the file: name, place and expression.
    definitions: Vec<(u32, Span, Parsed)>,
    defined: HashMap<u32, usize>,
    end: Span,
}

/// Reads a Bertini-classic file.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    let mut settings = FileSettings::default();
    let mut warnings = Vec::new();
    let system = statements(source, &mut settings, &mut warnings)
        .and_then(|s| s.into_system(settings.seed.unwrap_or(0)))
        .and_then(|(system, places, end)| finish(system, &places, end, None))
        .map_err(|fault| source.error(fault))?;
    if settings.user_homotopy && system.path_variable.is_none() {
        let message = "UserHomotopy is set, but no pathvariable is declared; solved without it";
        warn(&mut warnings, source, 0, message.into());
        settings.user_homotopy = false;
    }
    settings.user_homotopy |= system.path_variable.is_some();
    Ok(Problem {
        system,
        settings,
        format: Format::Bertini,
        warnings,
        conditions: Conditions::default(),
        objective: None,
    })
}

const FIRST: &str = "a Bertini-classic input (`CONFIG`, `INPUT` or a declaration such as \
     `variable_group`), a PHCpack system (the number of equations), a JSON problem (`{`) or \
     equations, one a line";
/// Words with which a text in this notation, or in that of plain equations, begins.
const FIRST_WORDS: [&str; 12] = [
    "CONFIG",
    "INPUT",
    "variable_group",
    "hom_variable_group",
    "variable",
    "function",
    "constant",
    "parameter",
    "pathvariable",
    "unknowns",
    "parameters",
    "groups",
];
const STATEMENT: &str = "a declaration, a definition `name = expression;` or `END;`";

/// Finds `CONFIG` at the beginning of a line where something comes before it and `INPUT` begins a line after it;
/// comments do not count.
pub(super) fn later_config(text: &str) -> Option<usize> {
    let (mut at, mut before, mut config) = (0, false, None);
    for line in text.split_inclusive('\n') {
        let content = line.split('%').next().unwrap_or_default();
        let word = content.trim_start();
        let begins = |with: &str| {
            let rest = word.strip_prefix(with);
            rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        };
        if config.is_none() && begins("CONFIG") {
            config = Some(at + content.len() - word.len()).filter(|_| before);
            config?;
        } else if config.is_some() && begins("INPUT") {
            return config;
        }
        before |= !word.is_empty();
        at += line.len();
    }
    None
}

fn statements(
    source: &Source<'_>,
    settings: &mut FileSettings,
    warnings: &mut Vec<Warning>,
) -> Result<Statements, Fault> {
    let mut tokens = Tokens::new(source.text, Some('%'));
    if let Some(at) = later_config(source.text) {
        let message = "what stands before `CONFIG` is ignored".into();
        warn(warnings, source, 0, message);
        tokens = Tokens::starting_at(source.text, at, Some('%'));
    }
    let first = tokens.peek();
    if first.kind == TokenKind::End {
        return Err(Fault::expected(first.span, FIRST, "an empty file"));
    }
    if first.kind == TokenKind::Name("CONFIG") {
        tokens.take();
        settings::read(source, &mut tokens, settings, warnings)?;
        let token = tokens.peek();
        if token.kind != TokenKind::Name("INPUT") {
            return Err(Fault::expected(token.span, "`INPUT`", token.describe()));
        }
    }
    let bracketed = tokens.peek().kind == TokenKind::Name("INPUT");
    if bracketed {
        tokens.take();
    }
    let mut statements = Statements::default();
    let mut totals = parse::Totals::default();
    loop {
        let token = tokens.take();
        let word = match token.kind {
            TokenKind::Name(word) => word,
            TokenKind::End if !statements.declared.is_empty() => {
                if bracketed {
                    let message = "the `END;` of the input is missing: it ends with the file";
                    warn(warnings, source, token.span.start, message.into());
                }
                statements.end = token.span;
                break;
            }
            _ => {
                let expected = if token == first { FIRST } else { STATEMENT };
                return Err(Fault::expected(token.span, expected, token.describe()));
            }
        };
        let declared = declaration(word).filter(|declared| match declared {
            // As other names these two may be defined.
            Declaration::Plain(Kind::Random { .. }) => {
                matches!(tokens.peek().kind, TokenKind::Name(_))
            }
            _ => true,
        });
        if let Some(declaration) = declared {
            statements.declare(&mut tokens, declaration, source)?;
            if let Declaration::Plain(Kind::Random { .. }) = declaration {
                let seed = settings.seed.unwrap_or(0);
                let message = format!(
                    "random constants are those of RandomSeed {seed}, whatever seed the solve has"
                );
                warn(warnings, source, token.span.start, message);
            }
        } else if word == "END" {
            tokens.take_symbol(';');
            statements.end = token.span;
            let rest = tokens.peek();
            if rest.kind != TokenKind::End {
                let message = "what follows the `END;` of the input is ignored".into();
                warn(warnings, source, rest.span.start, message);
            }
            break;
        } else {
            let next = tokens.peek();
            if next.kind != TokenKind::Symbol('=') {
                return Err(if token == first {
                    no_beginning(token, word)
                } else {
                    no_statement(word, next)
                });
            }
            tokens.take();
            statements.define(token, word, &mut tokens, &mut totals, source)?;
        }
    }
    settings.data_accuracy = totals.data_accuracy;
    Ok(statements)
}

/// The fault of a text whose first word begins no statement.
fn no_beginning(token: Token<'_>, word: &str) -> Fault {
    let expected = match meant(word, FIRST_WORDS) {
        Some(meant) => format!("{FIRST}; perhaps `{meant}`"),
        None => FIRST.to_owned(),
    };
    Fault::expected(token.span, expected, token.describe())
}

/// The fault of a later word that begins no statement, at the token behind the word.
fn no_statement(word: &str, next: Token<'_>) -> Fault {
    let actual_input = format!("{} after `{word}`", next.describe());
    let expected = match meant(word, FIRST_WORDS) {
        Some(meant) => format!("`=` or a declaration, perhaps `{meant}`"),
        None => "`=` or a declaration".to_owned(),
    };
    Fault::expected(next.span, expected, actual_input)
}

impl Statements {
    /// Reads a definition from behind its `=` to the semicolon.
    fn define(
        &mut self,
        token: Token<'_>,
        word: &str,
        tokens: &mut Tokens<'_>,
        totals: &mut parse::Totals,
        source: &Source<'_>,
    ) -> Result<(), Fault> {
        parse::check_free(word, token.span, Dialect::BERTINI)?;
        let name = self.names.intern(word);
        let parsed = parse::expression(tokens, &mut self.names, Dialect::BERTINI, "`;`", totals)?;
        tokens.expect_symbol(';', "an operator or `;`")?;
        if let Some(&earlier) = self.defined.get(&name) {
            let line = source.line_and_column(self.definitions[earlier].1.start).0;
            let first = format!("is defined in line {line} already");
            return Err(Fault::new(
                token.span,
                What::DuplicateName {
                    name: word.into(),
                    first,
                },
            ));
        }
        self.defined.insert(name, self.definitions.len());
        self.definitions.push((name, token.span, parsed));
        Ok(())
    }

    /// Reads the names of a declaration to the semicolon.
    fn declare(
        &mut self,
        tokens: &mut Tokens<'_>,
        declaration: Declaration,
        source: &Source<'_>,
    ) -> Result<(), Fault> {
        let mut members = Vec::new();
        loop {
            let token = tokens.take();
            let TokenKind::Name(word) = token.kind else {
                return Err(Fault::expected(token.span, "a name", token.describe()));
            };
            parse::check_free(word, token.span, Dialect::BERTINI)?;
            let name = self.names.intern(word);
            let kind = match declaration {
                Declaration::Group { .. } => Kind::Variable,
                Declaration::Plain(kind) => kind,
            };
            if let Some(earlier) = self.places.get(&name) {
                let line = source.line_and_column(earlier.start).0;
                let first = format!(
                    "is declared as a {} in line {line}",
                    self.kinds[&name].describe()
                );
                let problem = What::DuplicateName {
                    name: word.into(),
                    first,
                };
                return Err(Fault::new(token.span, problem));
            }
            if kind == Kind::PathVariable && self.counts.contains_key(&kind) {
                return Err(Fault::expected(
                    token.span,
                    "one path variable",
                    format!("a second one, `{word}`"),
                ));
            }
            let grouped = matches!(declaration, Declaration::Group { .. });
            let mixed = if grouped {
                !self.ungrouped.is_empty()
            } else {
                !self.groups.is_empty()
            };
            if kind == Kind::Variable && mixed {
                return Err(Fault::expected(
                    token.span,
                    "variables either in groups or in `variable` lists",
                    format!("`{word}` after the other kind"),
                ));
            }
            let limit = match kind {
                Kind::Variable => limits::VARIABLES,
                Kind::Function => limits::EQUATIONS,
                _ => limits::OPERATIONS,
            };
            let count = self.counts.entry(kind).or_default();
            *count += 1;
            if *count > limit.value {
                return Err(Fault::limit(token.span, limit, "more"));
            }
            self.declared.push((name, kind, token.span));
            self.kinds.insert(name, kind);
            self.places.insert(name, token.span);
            members.push(name);
            let token = tokens.take();
            match token.kind {
                TokenKind::Symbol(',') => {}
                TokenKind::Symbol(';') => break,
                _ => return Err(Fault::expected(token.span, "`,` or `;`", token.describe())),
            }
        }
        match declaration {
            Declaration::Group { homogeneous } => self.groups.push((homogeneous, members)),
            Declaration::Plain(Kind::Variable) => self.ungrouped.extend(members),
            Declaration::Plain(_) => {}
        }
        Ok(())
    }
}
