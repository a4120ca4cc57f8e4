//! Options of the command line that name variables: groups and conjugates.

use super::{FormatError, Source, limits};
use crate::expression::fault::{Fault, Problem, Span};
use crate::expression::token::{Token, TokenKind, Tokens};
use crate::helper_unknown::Helper;
use crate::system::{System, VariableGroup};

/// Variable groups as in `--groups "x,y;z,w"`, instead of those that the system has.
///
/// A new group is homogeneous when its variables were in homogeneous groups.
pub fn groups(text: &str, system: &mut System) -> Result<(), FormatError> {
    let source = Source {
        name: "--groups",
        text,
    };
    let groups = read_groups(text, system).map_err(|fault| source.error(fault))?;
    system.groups = groups;
    Ok(())
}

/// Pairs of conjugate variables as in `--conjugates "p~P,t1~T1"`, instead of those that the system has.
pub fn conjugates(text: &str, system: &mut System) -> Result<(), FormatError> {
    let source = Source {
        name: "--conjugates",
        text,
    };
    let pairs = read_conjugates(text, system).map_err(|fault| source.error(fault))?;
    system.conjugates = pairs;
    Ok(())
}

fn check_size(text: &str) -> Result<(), Fault> {
    if text.len() as u64 > limits::FILE_BYTES.value {
        return Err(Fault::limit(
            Span::default(),
            limits::FILE_BYTES,
            text.len(),
        ));
    }
    Ok(())
}

/// The next variable, which must not have come before.
fn variable<'a>(
    tokens: &mut Tokens<'a>,
    system: &System,
    seen: &mut [bool],
) -> Result<(usize, Token<'a>), Fault> {
    let token = tokens.take();
    let TokenKind::Name(name) = token.kind else {
        return Err(Fault::expected(token.span, "a variable", token.describe()));
    };
    let variable = system.variables.iter().position(|v| v == name);
    let mut angles = system.angle_unknowns();
    let angle = || angles.find(|angle| angle.name == name).map(|a| a.cosine);
    let index = variable.or_else(angle);
    let unknown = || {
        let names = system.variables.iter().map(String::as_str);
        Fault::new(token.span, Problem::unknown(name, names))
    };
    let index = index.ok_or_else(unknown)?;
    if std::mem::replace(&mut seen[index], true) {
        let first = "is named here already".into();
        return Err(Fault::new(
            token.span,
            Problem::DuplicateName {
                name: name.into(),
                first,
            },
        ));
    }
    Ok((index, token))
}

fn read_groups(text: &str, system: &System) -> Result<Vec<VariableGroup>, Fault> {
    check_size(text)?;
    let was_homogeneous = |v: usize| {
        system
            .groups
            .iter()
            .any(|g| g.homogeneous && g.variables.contains(&v))
    };
    let mut seen = vec![false; system.variables.len()];
    let mut tokens = Tokens::new(text, None);
    let mut groups: Vec<VariableGroup> = Vec::new();
    let mut new_group = true;
    loop {
        let (index, token) = variable(&mut tokens, system, &mut seen)?;
        let homogeneous = was_homogeneous(index);
        match groups.last_mut() {
            Some(group) if !new_group => {
                if group.homogeneous != homogeneous {
                    return Err(Fault::expected(
                        token.span,
                        "a group whose variables are all homogeneous or all affine",
                        format!(
                            "`{}`, which is not like the one before",
                            system.variables[index]
                        ),
                    ));
                }
                group.variables.push(index);
            }
            _ => groups.push(VariableGroup {
                variables: vec![index],
                homogeneous,
            }),
        }
        let token = tokens.take();
        match token.kind {
            TokenKind::Symbol(',') => new_group = false,
            TokenKind::Symbol(';') if tokens.peek().kind == TokenKind::End => break,
            TokenKind::Symbol(';') => new_group = true,
            TokenKind::End => break,
            _ => return Err(Fault::expected(token.span, "`,` or `;`", token.describe())),
        }
    }
    add_helpers(system, &mut groups, &mut seen);
    if let Some(missing) = seen.iter().position(|s| !s) {
        let end = Span {
            start: text.len(),
            end: text.len(),
        };
        let actual_input = format!("`{}` in none", system.variables[missing]);
        return Err(Fault::expected(
            end,
            "every variable in a group",
            actual_input,
        ));
    }
    Ok(groups)
}

/// Puts helper unknowns that are not named into groups: a sine into that of its cosine, a root into the last.
fn add_helpers(system: &System, groups: &mut [VariableGroup], seen: &mut [bool]) {
    for helper in &system.helpers {
        let (variable, beside) = match helper {
            Helper::Root(root) => (root.variable, None),
            Helper::Angle(angle) => (angle.sine, Some(angle.cosine)),
        };
        let holds = |group: &VariableGroup| beside.is_some_and(|v| group.variables.contains(&v));
        let place = groups.iter().position(holds);
        let place = place.or_else(|| groups.len().checked_sub(1));
        if let (Some(place), false) = (place, seen[variable]) {
            seen[variable] = true;
            groups[place].variables.push(variable);
        }
    }
}

fn read_conjugates(text: &str, system: &System) -> Result<Vec<(usize, usize)>, Fault> {
    check_size(text)?;
    let mut seen = vec![false; system.variables.len()];
    let mut tokens = Tokens::new(text, None);
    let mut pairs = Vec::new();
    loop {
        let (first, _) = variable(&mut tokens, system, &mut seen)?;
        let token = tokens.take();
        if token.kind != TokenKind::Unknown('~') {
            return Err(Fault::expected(token.span, "`~`", token.describe()));
        }
        let (second, _) = variable(&mut tokens, system, &mut seen)?;
        pairs.push((first, second));
        let token = tokens.take();
        match token.kind {
            TokenKind::Symbol(',') => {}
            TokenKind::End => return Ok(pairs),
            _ => return Err(Fault::expected(token.span, "`,`", token.describe())),
        }
    }
}
