//! Conditions in text: `x > 0`, `0 <= y < 2*x and not (x = 1 or y != k)`.
//!
//! A condition is cut at its relations and at the words `and`, `or` and `not`; what stands between them is read as
//! every other expression.

use super::limits;
use crate::condition::{Condition, Conditions, Relation};
use crate::expression::build::{Builder, Use};
use crate::expression::fault::{Fault, Span};
use crate::expression::parse::{self, Dialect, Names, Parsed, Totals};
use crate::expression::token::{Token, TokenKind, Tokens};
use crate::expression::{Expressions, NodeId};

/// A condition of which no name has a meaning yet.
#[derive(Clone, Debug)]
pub(crate) struct ParsedCondition {
    /// The text between its ends.
    text: String,
    /// Indices are those of `differences`.
    condition: Condition,
    differences: Vec<Parsed>,
}

impl ParsedCondition {
    /// The expressions that are compared.
    pub(crate) fn expressions(&self) -> impl Iterator<Item = &Parsed> {
        self.differences.iter()
    }
}

/// A word between conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    And,
    Or,
    Not,
}

fn word(kind: TokenKind<'_>) -> Option<Word> {
    match kind {
        TokenKind::Name("and") => Some(Word::And),
        TokenKind::Name("or") => Some(Word::Or),
        TokenKind::Name("not") => Some(Word::Not),
        _ => None,
    }
}

/// The relation that begins with the first of these tokens, and how many tokens it has.
fn relation(tokens: &[Token<'_>]) -> Option<(Relation, usize)> {
    let is_equals =
        |token: Option<&Token<'_>>| token.is_some_and(|token| token.kind == TokenKind::Symbol('='));
    let then_equals = is_equals(tokens.get(1));
    let first = tokens.first()?;
    // In `x! = 2` a factorial is meant.
    let touches = tokens
        .get(1)
        .is_some_and(|next| next.span.start == first.span.end);
    Some(match first.kind {
        TokenKind::Unknown('<') if then_equals => (Relation::AtMost, 2),
        TokenKind::Unknown('<') => (Relation::Less, 1),
        TokenKind::Unknown('>') if then_equals => (Relation::AtLeast, 2),
        TokenKind::Unknown('>') => (Relation::Greater, 1),
        TokenKind::Unknown('!') if then_equals && touches => (Relation::NotEqual, 2),
        TokenKind::Symbol('/') if then_equals && touches => (Relation::NotEqual, 2),
        TokenKind::Unknown('≤') => (Relation::AtMost, 1),
        TokenKind::Unknown('≥') => (Relation::AtLeast, 1),
        TokenKind::Unknown('≠') => (Relation::NotEqual, 1),
        TokenKind::Symbol('=') => (Relation::Equal, if then_equals { 2 } else { 1 }),
        _ => return None,
    })
}

/// Whether a part of a text has a relation other than `=`, so that it is no equation.
pub(crate) fn is_condition(text: &str, part: Span) -> bool {
    let tokens = tokens(text, part);
    let is_inequality =
        |at: usize| relation(&tokens[at..]).is_some_and(|(r, _)| r != Relation::Equal);
    (0..tokens.len()).any(is_inequality)
}

/// The tokens of a part of a text.
fn tokens(text: &str, part: Span) -> Vec<Token<'_>> {
    let mut tokens = Tokens::starting_at(&text[..part.end], part.start, None);
    std::iter::from_fn(|| Some(tokens.take()).filter(|t| t.kind != TokenKind::End)).collect()
}

/// The parts of a statement between its commas, the empty ones left out.
pub(crate) fn parts(text: &str, statement: Span) -> impl Iterator<Item = Span> {
    let mut start = statement.start;
    let parts = text[statement.start..statement.end].split(',');
    let places = parts.map(move |part| {
        let place = Span {
            start,
            end: start + part.len(),
        };
        start = place.end + 1;
        (place, part)
    });
    places
        .filter(|(_, part)| !part.trim().is_empty())
        .map(|(place, _)| place)
}

/// Reads a part of a text as one condition.
pub(crate) fn parse(
    text: &str,
    part: Span,
    names: &mut Names,
    totals: &mut Totals,
) -> Result<ParsedCondition, Fault> {
    let mut reader = Reader {
        text,
        end: part.end,
        tokens: tokens(text, part),
        next: 0,
        depth: 0,
        differences: Vec::new(),
        names,
        totals,
    };
    let condition = reader.alternatives()?;
    if let Some(token) = reader.tokens.get(reader.next) {
        let expected = "`and`, `or`, or the end of the condition";
        return Err(Fault::expected(token.span, expected, token.describe()));
    }
    Ok(ParsedCondition {
        text: text[part.start..part.end].trim().to_owned(),
        condition,
        differences: reader.differences,
    })
}

struct Reader<'a> {
    text: &'a str,
    end: usize,
    tokens: Vec<Token<'a>>,
    /// Index of the next token.
    next: usize,
    /// Brackets and `not` that are open.
    depth: u64,
    differences: Vec<Parsed>,
    names: &'a mut Names,
    totals: &'a mut Totals,
}

impl Reader<'_> {
    fn take_word(&mut self, wanted: Word) -> bool {
        let token = self.tokens.get(self.next);
        let is_wanted = token.is_some_and(|token| word(token.kind) == Some(wanted));
        self.next += usize::from(is_wanted);
        is_wanted
    }

    /// The place of the next token, or of the end.
    fn place(&self) -> Span {
        let end = Span {
            start: self.end,
            end: self.end,
        };
        self.tokens.get(self.next).map_or(end, |token| token.span)
    }

    fn alternatives(&mut self) -> Result<Condition, Fault> {
        let mut list = vec![self.conjunction()?];
        while self.take_word(Word::Or) {
            list.push(self.conjunction()?);
        }
        Ok(one_or(list, Condition::Any))
    }

    fn conjunction(&mut self) -> Result<Condition, Fault> {
        let mut list = vec![self.negation()?];
        while self.take_word(Word::And) {
            list.push(self.negation()?);
        }
        Ok(one_or(list, Condition::Every))
    }

    fn negation(&mut self) -> Result<Condition, Fault> {
        let place = self.place();
        self.depth += 1;
        if self.depth > limits::NESTING.value {
            return Err(Fault::limit(place, limits::NESTING, self.depth));
        }
        let condition = match self.take_word(Word::Not) {
            true => Condition::Not(Box::new(self.negation()?)),
            false => self.group_or_comparison()?,
        };
        self.depth -= 1;
        Ok(condition)
    }

    fn group_or_comparison(&mut self) -> Result<Condition, Fault> {
        let Some(closing) = self.group()? else {
            return self.comparisons();
        };
        self.next += 1;
        let condition = self.alternatives()?;
        if self.next != closing {
            let token = self.tokens[self.next.min(closing)];
            return Err(Fault::expected(
                token.span,
                "`and`, `or` or `)`",
                token.describe(),
            ));
        }
        self.next += 1;
        Ok(condition)
    }

    /// The index of the bracket that closes the next one, where conditions and not an expression stand between them.
    fn group(&self) -> Result<Option<usize>, Fault> {
        let mut depth = 0u64;
        let mut has_conditions = false;
        for (at, token) in self.tokens.iter().enumerate().skip(self.next) {
            match token.kind {
                TokenKind::Symbol('(') => depth += 1,
                TokenKind::Symbol(')') if depth == 0 => return Ok(None),
                TokenKind::Symbol(')') => depth -= 1,
                kind => {
                    has_conditions |=
                        word(kind).is_some() || relation(&self.tokens[at..]).is_some();
                }
            }
            if depth == 0 {
                return Ok(Some(at).filter(|_| has_conditions));
            }
        }
        if depth == 0 {
            return Ok(None);
        }
        let end = Span {
            start: self.end,
            end: self.end,
        };
        Err(Fault::expected(end, "`)`", "the end of the condition"))
    }

    /// A comparison, or a chain of them: `0 < x <= 1`.
    fn comparisons(&mut self) -> Result<Condition, Fault> {
        let mut left = self.expression()?;
        let mut list = Vec::new();
        while let Some((relation, length)) = relation(&self.tokens[self.next..]) {
            self.next += length;
            let right = self.expression()?;
            list.push(Condition::Comparison {
                difference: self.differences.len(),
                relation,
            });
            self.differences.push(left.minus(right.clone()));
            left = right;
        }
        if list.is_empty() {
            let token = self.tokens.get(self.next);
            let stands = token.map_or("the end of the condition".to_owned(), Token::describe);
            let expected = "one of `<`, `<=`, `>`, `>=`, `=`, `!=`";
            return Err(Fault::expected(self.place(), expected, stands));
        }
        Ok(one_or(list, Condition::Every))
    }

    /// The expression up to the next relation, word or closing bracket of a group.
    fn expression(&mut self) -> Result<Parsed, Fault> {
        let start = self.place().start;
        let mut depth = 0u64;
        while let Some(token) = self.tokens.get(self.next) {
            match token.kind {
                TokenKind::Symbol('(') => depth += 1,
                TokenKind::Symbol(')') if depth == 0 => break,
                TokenKind::Symbol(')') => depth -= 1,
                kind if word(kind).is_some() || relation(&self.tokens[self.next..]).is_some() => {
                    break;
                }
                _ => {}
            }
            self.next += 1;
        }
        let end = self.place().start;
        if end == start {
            let token = self.tokens.get(self.next);
            let stands = token.map_or("the end of the condition".to_owned(), Token::describe);
            return Err(Fault::expected(self.place(), "an expression", stands));
        }
        let mut tokens = Tokens::starting_at(&self.text[..end], start, None);
        let after = "a comparison such as `> 0`";
        let dialect = Dialect::PLAIN;
        let parsed = parse::expression(&mut tokens, self.names, dialect, after, self.totals)?;
        let token = tokens.peek();
        match token.kind {
            TokenKind::End => Ok(parsed),
            _ => {
                let expected = format!("an operator or {after}");
                Err(Fault::expected(token.span, expected, token.describe()))
            }
        }
    }
}

/// The only condition of a list, or the whole list as one condition.
fn one_or(mut list: Vec<Condition>, whole: fn(Vec<Condition>) -> Condition) -> Condition {
    match list.len() {
        1 => list.remove(0),
        _ => whole(list),
    }
}

/// The condition with its differences counted from `first`.
fn moved(condition: Condition, first: usize) -> Condition {
    let list = |list: Vec<Condition>| list.into_iter().map(|c| moved(c, first)).collect();
    match condition {
        Condition::Comparison {
            difference,
            relation,
        } => Condition::Comparison {
            difference: first + difference,
            relation,
        },
        Condition::Every(conditions) => Condition::Every(list(conditions)),
        Condition::Any(conditions) => Condition::Any(list(conditions)),
        Condition::Not(condition) => Condition::Not(Box::new(moved(*condition, first))),
        Condition::Complementary { differences } => Condition::Complementary {
            differences: differences.map(|difference| first + difference),
        },
    }
}

impl Conditions {
    /// Adds a condition, of which `resolve` says what the names stand for. The graph of the builder is to become
    /// `self.expressions`.
    pub(crate) fn add(
        &mut self,
        parsed: ParsedCondition,
        builder: &mut Builder,
        resolve: &mut dyn FnMut(&mut Expressions, u32, Span) -> Result<NodeId, Fault>,
    ) -> Result<(), Fault> {
        let first = self.differences.len();
        builder.keep_functions();
        for difference in &parsed.differences {
            let node = builder.build(difference, Use::Rational, resolve)?;
            self.differences.push(node);
        }
        self.texts.push(parsed.text);
        self.conditions.push(moved(parsed.condition, first));
        Ok(())
    }
}
