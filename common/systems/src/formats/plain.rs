//! Plain equations: one a line, as people write them. Unknowns are the names that are nothing else.
//!
//! `lhs = rhs`, or an expression that is to be 0; several on a line between `;` or `,`; `#` begins a comment. A line goes on
//! where a bracket is open or an operator ends it. `name := expression` defines a name; `unknowns:`, `parameters:` and
//! `groups:` begin lines of names. A comparison such as `x > 0` is a condition on the solutions that are wanted, also
//! behind `where:`.

use super::constants::is_constant;
use super::definitions::Definitions;
use super::parsed_condition::{self, ParsedCondition};
use super::plain_text::WORDS;
pub use super::plain_text::write;
use super::polynomial_list as list;
use super::{
    FileSettings, Format, FormatError, Problem, Source, Warning, bertini, finish, hand_over,
    say_identities, warn,
};
use crate::condition::Conditions;
use crate::expression::build::{Builder, Use};
use crate::expression::exact;
use crate::expression::fault::{Fault, Problem as What, Span};
use crate::expression::parse::{self, Names, Parsed};
use crate::expression::similar::meant;
use crate::expression::token::{TokenKind, Tokens};
use crate::expression::{Expressions, NodeId};
use crate::objective::{Goal, Objective};
use crate::system::{System, VariableGroup};
use std::collections::{HashMap, HashSet};

/// Words that begin a line of names, synonyms included.
const HEADINGS: [(&str, Heading); 6] = [
    ("unknowns", Heading::Unknowns),
    ("variables", Heading::Unknowns),
    ("unknown", Heading::Unknowns),
    ("parameters", Heading::Parameters),
    ("parameter", Heading::Parameters),
    ("groups", Heading::Groups),
];

/// Word that begins a line of conditions.
const WHERE: &str = "where";

/// Unknowns of which each is compared with every other, at most.
const MOST_COMPARED: usize = 1000;

/// Names with a meaning in other programs, and the notation for this meaning here.
const ELSEWHERE: [(&str, &str); 2] = [
    ("i", "`I` for the imaginary unit"),
    ("j", "`I` for the imaginary unit"),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Heading {
    Unknowns,
    Parameters,
    Groups,
}

fn clean(text: &str) -> String {
    list::without_comments(text, "#", None)
}

/// The places of statements in a text without comments: lines that go on are one, and those with `;` are several.
fn statements(text: &str) -> impl Iterator<Item = Span> {
    let mut start = 0;
    std::iter::from_fn(move || {
        while start < text.len() {
            let rest = &text[start..];
            let part = &rest[..statement_length(rest)];
            let at = start + part.len() - part.trim_start().len();
            // The character that ends a statement is one byte.
            start += part.len() + 1;
            let length = part.trim().len();
            if length > 0 {
                return Some(Span {
                    start: at,
                    end: at + length,
                });
            }
        }
        None
    })
}

/// The length of the first statement of a text.
fn statement_length(text: &str) -> usize {
    let (mut depth, mut goes_on) = (0u32, false);
    for (at, c) in text.char_indices() {
        match c {
            ';' => return at,
            '\n' if depth == 0 && !goes_on => return at,
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if !c.is_whitespace() {
            goes_on = "+-*/^=<>×·⋅∙∗−–÷∕⁄".contains(c);
        }
    }
    text.len()
}

fn tokens(text: &str, at: Span) -> Tokens<'_> {
    Tokens::starting_at(&text[..at.end], at.start, None)
}

/// Whether a comma stands between the digits of a number: behind it a number is alone.
fn is_decimal_comma(after: &Tokens<'_>, comma: Span) -> bool {
    let mut after = after.clone();
    let number = after.take();
    let before = after.text()[..comma.start].bytes().next_back();
    let is_alone = matches!(after.peek().kind, TokenKind::End | TokenKind::Symbol(','));
    matches!(number.kind, TokenKind::Number(_))
        && number.span.start == comma.end
        && before.is_some_and(|b| b.is_ascii_digit())
        && is_alone
}

/// Kind of a statement, by its first tokens.
enum Begin<'a> {
    /// A word and a colon.
    Heading(&'a str, Span),
    /// A name and `:=`.
    Definition(&'a str, Span),
    Equations,
}

fn begin<'a>(tokens: &mut Tokens<'a>) -> Begin<'a> {
    let mut ahead = tokens.clone();
    let first = ahead.take();
    let TokenKind::Name(word) = first.kind else {
        return Begin::Equations;
    };
    if ahead.take_symbol(':').is_none() {
        return Begin::Equations;
    }
    let is_definition = ahead.take_symbol('=').is_some();
    *tokens = ahead;
    match is_definition {
        true => Begin::Definition(word, first.span),
        false => Begin::Heading(word, first.span),
    }
}

/// Goal that a heading sets for the expression behind it; `None` where the word is no heading of an objective.
fn goal(word: &str) -> Option<Goal> {
    Goal::ALL.into_iter().find(|goal| goal.name() == word)
}

/// Whether a statement is one name: the equation that it is 0, or a word of another notation.
fn is_name(text: &str, statement: Span) -> bool {
    let mut tokens = tokens(text, statement);
    let first = tokens.take().kind;
    matches!(first, TokenKind::Name(_)) && tokens.peek().kind == TokenKind::End
}

/// Whether a text is in this notation: its first statement that is more than a name is an equation, an expression with an
/// operator, a definition or a line of names; and the text does not begin as Bertini's notation or PHCpack's.
pub fn is(text: &str) -> bool {
    let text = &clean(text);
    let begins_otherwise = |statement: &Span| {
        let word = tokens(text, *statement).take().kind;
        matches!(word, TokenKind::Name(word) if bertini::begins_with(word))
    };
    if statements(text)
        .next()
        .as_ref()
        .is_some_and(begins_otherwise)
    {
        return false;
    }
    let Some(first) = statements(text).find(|statement| !is_name(text, *statement)) else {
        return false;
    };
    let mut tokens = tokens(text, first);
    let word = tokens.peek();
    match word.kind {
        TokenKind::Name(word) if bertini::begins_with(word) => return false,
        // PHCpack begins with the number of equations, and that of unknowns; a polynomial may stand behind them on the line,
        // and ends with `;`.
        TokenKind::Number(_) => {
            tokens.take();
            let next = tokens.peek();
            return match next.kind {
                TokenKind::Symbol('*' | '/' | '^' | '=') | TokenKind::Raised(_) => true,
                TokenKind::Name(_) | TokenKind::Symbol('(') if next.span.start == word.span.end => {
                    true
                }
                TokenKind::Symbol('+' | '-' | '(') | TokenKind::Name(_) => {
                    text[first.start..first.end].contains('=') || !text.contains(';')
                }
                _ => false,
            };
        }
        TokenKind::Name(_) | TokenKind::Symbol('(' | '-' | '+') | TokenKind::Unknown('√' | '∛') =>
            {}
        _ => return false,
    }
    match begin(&mut tokens) {
        Begin::Definition(..) => true,
        Begin::Heading(word, _) => {
            word == WHERE
                || goal(word).is_some()
                || HEADINGS.iter().any(|(heading, _)| *heading == word)
        }
        Begin::Equations if parsed_condition::is_condition(text, first) => true,
        Begin::Equations => {
            let is_operator =
                |kind| matches!(kind, TokenKind::Symbol('+' | '-' | '*' | '/' | '^' | '='));
            std::iter::from_fn(|| match tokens.take().kind {
                TokenKind::End => None,
                kind => Some(kind),
            })
            .any(is_operator)
        }
    }
}

/// An equation: two sides, or one that is to be 0.
struct Equation {
    left: Parsed,
    right: Option<Parsed>,
}

impl Equation {
    /// The expression that the equation sets to 0.
    fn difference(self) -> Parsed {
        match self.right {
            Some(right) => self.left.minus(right),
            None => self.left,
        }
    }
}

/// Statements of a text, before any name has a meaning.
#[derive(Default)]
struct Statements {
    names: Names,
    /// Names of lines that declare them, with what they are, in words.
    declared: HashMap<u32, &'static str>,
    unknowns: Option<Vec<u32>>,
    parameters: Vec<u32>,
    groups: Vec<Vec<(u32, Span)>>,
    definitions: Vec<(u32, Parsed)>,
    equations: Vec<Equation>,
    conditions: Vec<ParsedCondition>,
    objective: Option<(Goal, String, Parsed)>,
    totals: parse::Totals,
}

/// Conditions and objective for the wanted solutions, and the equations that are left out.
#[derive(Default)]
struct Wanted {
    conditions: Conditions,
    objective: Option<Objective>,
    /// Places of equations that hold for all values, such as `1 = 1` and `x/x = 1`.
    always_hold: Vec<Span>,
}

/// Reads a system, and the conditions and the objective for its solutions.
pub fn read(source: &Source<'_>) -> Result<Problem, FormatError> {
    let mut wanted = Wanted::default();
    let problem = list::problem(source, Format::Plain, |source, settings, warnings| {
        system(source, settings, warnings, &mut wanted)
    })?;
    Ok(Problem {
        conditions: wanted.conditions,
        objective: wanted.objective,
        ..problem
    })
}

/// Reads equations that are in this notation whatever they begin with.
pub fn typed(name: &str, text: &str) -> Result<Problem, FormatError> {
    let source = Source { name, text };
    let mut problem = read(&source)?;
    super::say_denominators(&mut problem, &source);
    Ok(problem)
}

/// Characters of a name that may be a product at most.
const LONGEST_PRODUCT: usize = 12;

/// The product that a name may be: of `names`, of pi and one of these or a letter, or behind a number of letters of which one
/// is a name.
fn product_without_sign(
    text: &str,
    names: &HashSet<&str>,
    is_behind_number: bool,
) -> Option<String> {
    let is_letter = |part: &str| part.chars().count() == 1 && part.chars().all(char::is_alphabetic);
    let is_name = |part: &str| part != text && names.contains(part);
    if text.len() > LONGEST_PRODUCT {
        return None;
    }
    for pi in ["pi", "Pi", "PI"] {
        let rest = text.strip_prefix(pi);
        if let Some(rest) = rest.filter(|rest| is_letter(rest) || is_name(rest)) {
            return Some(format!("{pi}*{rest}"));
        }
    }
    let letters: Vec<String> = text.chars().map(String::from).collect();
    if is_behind_number
        && matches!(letters.len(), 2 | 3)
        && letters.iter().all(|part| is_letter(part))
        && letters.iter().any(|part| is_name(part))
    {
        return Some(letters.join("*"));
    }
    // The products of names that end at each byte.
    let mut products: Vec<Option<String>> = vec![Some(String::new())];
    for end in 1..=text.len() {
        let product = (0..end).find_map(|start| {
            let before = products[start].as_ref()?;
            let part = text.get(start..end).filter(|part| is_name(part))?;
            let sign = if before.is_empty() { "" } else { "*" };
            Some(format!("{before}{sign}{part}"))
        });
        products.push(product);
    }
    products.pop().flatten()
}

/// The fault of a name that has no value where others have one.
fn unknown_name(names: &Names, values: &[Option<NodeId>], name: u32) -> What {
    let declared = (0..names.count()).filter(|&n| values.get(n).is_some_and(Option::is_some));
    let declared = declared.map(|n| names.name(n as u32));
    What::unknown(names.name(name), declared)
}

fn system(
    source: &Source<'_>,
    settings: &mut FileSettings,
    warnings: &mut Vec<Warning>,
    wanted: &mut Wanted,
) -> Result<System, Fault> {
    let text = &clean(source.text);
    let mut said = Statements::default();
    for (number, at) in statements(text).enumerate() {
        let mut tokens = tokens(text, at);
        // A sum on two lines would be two equations.
        if number > 0 && tokens.peek().kind == TokenKind::Symbol('+') {
            let expected = "an equation; a sum goes on where the line before ends with `+`";
            return Err(Fault::expected(tokens.peek().span, expected, "`+`"));
        }
        if let Some(place) = text[at.start..at.end].find("->") {
            let start = at.start + place;
            let end = start + "->".len();
            return Err(Fault::expected(Span { start, end }, "`=`", "`->`"));
        }
        match begin(&mut tokens) {
            Begin::Heading(WHERE, _) => {
                let start = tokens.position();
                said.conditions(text, Span { start, end: at.end })?;
            }
            Begin::Heading(word, place) if goal(word).is_some() => {
                let start = tokens.position();
                let text = text[start..at.end].trim();
                said.objective(word, place, text, &mut tokens)?;
            }
            Begin::Heading(word, at) => said.line_of_names(word, at, &mut tokens)?,
            Begin::Definition(word, at) => said.definition(word, at, &mut tokens)?,
            Begin::Equations if parsed_condition::is_condition(text, at) => said.mixed(text, at)?,
            Begin::Equations => said.equations(&mut tokens)?,
        }
    }
    settings.data_accuracy = said.totals.data_accuracy;
    if let Some(place) = said.totals.may_be_zero {
        let (_, column) = source.line_and_column(place.start);
        let message = format!(
            "column {column}: this constant is no larger than the error of its rounded decimals, and may be 0"
        );
        warn(warnings, source, place.start, message);
    }
    said.doubts(source, warnings);
    let system = said.into_system(list::end_of(text), wanted);
    wanted.always_hold.sort_by_key(|place| place.start);
    say_identities(source, &wanted.always_hold, warnings);
    system
}

impl Statements {
    /// Declares a name, which must be new and have no meaning of its own.
    fn declare(&mut self, name: &str, at: Span, kind: &'static str) -> Result<u32, Fault> {
        parse::check_free(name, at, WORDS.dialect)?;
        let number = self.names.intern(name);
        match self.declared.insert(number, kind) {
            None => Ok(number),
            Some(earlier) => Err(Fault::new(
                at,
                What::DuplicateName {
                    name: name.into(),
                    first: format!("is {earlier} already"),
                },
            )),
        }
    }

    fn line_of_names(
        &mut self,
        word: &str,
        at: Span,
        tokens: &mut Tokens<'_>,
    ) -> Result<(), Fault> {
        let heading = HEADINGS.iter().find(|(heading, _)| *heading == word);
        let Some((_, heading)) = heading else {
            let expected = "`unknowns:`, `parameters:`, `groups:`, `where:`, `minimize:`, or `name := expression`";
            return Err(Fault::expected(at, expected, format!("`{word}:`")));
        };
        let mut group = Vec::new();
        loop {
            let token = tokens.take();
            match (heading, token.kind) {
                (_, TokenKind::Symbol(',')) => {}
                (Heading::Groups, TokenKind::Unknown('|')) => {
                    self.groups.push(std::mem::take(&mut group));
                }
                (Heading::Groups, TokenKind::Name(name)) => {
                    group.push((self.names.intern(name), token.span));
                }
                (Heading::Groups, TokenKind::End) => {
                    self.groups.push(group);
                    return Ok(());
                }
                (Heading::Unknowns, TokenKind::Name(name)) => {
                    let number = self.declare(name, token.span, "an unknown")?;
                    self.unknowns.get_or_insert_default().push(number);
                }
                (Heading::Parameters, TokenKind::Name(name)) => {
                    let number = self.declare(name, token.span, "a parameter")?;
                    self.parameters.push(number);
                }
                (_, TokenKind::End) => return Ok(()),
                _ => return Err(Fault::expected(token.span, "a name", token.describe())),
            }
        }
    }

    fn expression(&mut self, tokens: &mut Tokens<'_>) -> Result<Parsed, Fault> {
        let end = "the end of the line";
        let dialect = WORDS.dialect;
        parse::expression(tokens, &mut self.names, dialect, end, &mut self.totals)
    }

    fn definition(&mut self, name: &str, at: Span, tokens: &mut Tokens<'_>) -> Result<(), Fault> {
        let number = self.declare(name, at, "a definition")?;
        let parsed = self.expression(tokens)?;
        let token = tokens.peek();
        if token.kind != TokenKind::End {
            let expected = "an operator or the end of the line";
            return Err(Fault::expected(token.span, expected, token.describe()));
        }
        self.definitions.push((number, parsed));
        Ok(())
    }

    /// The expression of which the least value is asked, or another one.
    fn objective(
        &mut self,
        word: &str,
        place: Span,
        text: &str,
        tokens: &mut Tokens<'_>,
    ) -> Result<(), Fault> {
        let parsed = self.expression(tokens)?;
        let token = tokens.peek();
        if token.kind != TokenKind::End {
            let expected = "an operator or the end of the line";
            return Err(Fault::expected(token.span, expected, token.describe()));
        }
        let goal = goal(word).unwrap_or(Goal::Critical);
        match self.objective.replace((goal, text.to_owned(), parsed)) {
            None => Ok(()),
            Some(_) => Err(Fault::expected(place, "one objective", "another one")),
        }
    }

    /// The expression behind `=` or `==`, where one of these comes next.
    fn right_side(&mut self, tokens: &mut Tokens<'_>) -> Result<Option<Parsed>, Fault> {
        if tokens.take_symbol('=').is_none() {
            return Ok(None);
        }
        tokens.take_symbol('=');
        self.expression(tokens).map(Some)
    }

    /// The equations of a statement, between commas.
    fn equations(&mut self, tokens: &mut Tokens<'_>) -> Result<(), Fault> {
        loop {
            let mut left = self.expression(tokens)?;
            let mut right = self.right_side(tokens)?;
            // `x = y = z` is `x = y` and `y = z`.
            while let Some(middle) = right.clone()
                && tokens.peek().kind == TokenKind::Symbol('=')
            {
                self.equations.push(Equation { left, right });
                left = middle;
                right = self.right_side(tokens)?;
            }
            self.equations.push(Equation { left, right });
            let token = tokens.take();
            if token.kind == TokenKind::Symbol(',') && is_decimal_comma(tokens, token.span) {
                let expected = "a point, as in `1.5` (a comma stands between equations)";
                return Err(Fault::expected(token.span, expected, token.describe()));
            }
            match (token.kind, tokens.peek().kind) {
                (TokenKind::End, _) | (TokenKind::Symbol(','), TokenKind::End) => return Ok(()),
                (TokenKind::Symbol(','), _) => {}
                _ => {
                    let expected = "an operator, `=`, or the end of the equation";
                    return Err(Fault::expected(token.span, expected, token.describe()));
                }
            }
        }
    }

    /// The conditions of a statement, between commas.
    fn conditions(&mut self, text: &str, statement: Span) -> Result<(), Fault> {
        for part in parsed_condition::parts(text, statement) {
            let parsed = parsed_condition::parse(
                text,
                part,
                &mut self.names,
                &mut parse::Totals::default(),
            )?;
            self.conditions.push(parsed);
        }
        Ok(())
    }

    /// The equations and conditions of a statement, between commas.
    fn mixed(&mut self, text: &str, statement: Span) -> Result<(), Fault> {
        for part in parsed_condition::parts(text, statement) {
            match parsed_condition::is_condition(text, part) {
                true => self.conditions(text, part)?,
                false => self.equations(&mut tokens(text, part))?,
            }
        }
        Ok(())
    }

    /// Warnings of what may be meant in another way.
    fn doubts(&self, source: &Source<'_>, warnings: &mut Vec<Warning>) {
        let is_whole = |equation: &&Equation| equation.right.is_some();
        let whole = self.equations.iter().filter(is_whole).count();
        if whole > 0 {
            for equation in self.equations.iter().filter(|e| e.right.is_none()) {
                let message = "there is no `=`: the expression is taken to be 0";
                warn(
                    warnings,
                    source,
                    equation.left.span.start,
                    message.to_owned(),
                );
            }
        }
        let unknowns = self.unknowns().unwrap_or_default();
        let is_square = unknowns.len() <= self.equations.len();
        // Names of a line of names are meant.
        if !is_square || self.unknowns.is_none() {
            self.products_without_sign(&unknowns, source, warnings);
        }
        if is_square {
            return;
        }
        // f = x^2 - 1 defines f elsewhere; here that is an unknown for which there is no equation.
        let mut uses = vec![0u32; self.names.count()];
        let conditions = self.conditions.iter();
        let conditions = conditions.flat_map(ParsedCondition::expressions);
        for parsed in self.all_expressions().chain(conditions) {
            for (name, _) in parsed.names() {
                uses[name as usize] += 1;
            }
        }
        self.slips(&unknowns, &uses, source, warnings);
        for equation in self.equations.iter().filter(is_whole) {
            let mut left = equation.left.names();
            let Some((name, _)) = left.next().filter(|_| equation.left.steps.len() == 1) else {
                continue;
            };
            if uses[name as usize] == 1 && !self.declared.contains_key(&name) {
                let name = self.names.name(name);
                let message = format!(
                    "`{name}` occurs only here: it is taken for an unknown; `{name} := ...` defines a name, and an equation \
                     without it has the expression alone"
                );
                warn(warnings, source, equation.left.span.start, message);
            }
        }
    }

    /// Warns of an unknown whose name may be a slip for another: in other letters, or where it occurs once.
    fn slips(
        &self,
        unknowns: &[u32],
        uses: &[u32],
        source: &Source<'_>,
        warnings: &mut Vec<Warning>,
    ) {
        // Indices are no slips.
        let letters = |text: &str| text.replace(|c: char| c.is_ascii_digit(), "");
        let digits = |text: &str| text.replace(|c: char| !c.is_ascii_digit(), "");
        let is_like = |a: &str, b: &str| {
            digits(a) == digits(b) && meant(&letters(a), [&letters(b)[..]]).is_some()
        };
        let mut said = HashSet::new();
        for (name, place) in self.all_expressions().flat_map(Parsed::names) {
            let is_new = said.insert(name) && !self.declared.contains_key(&name);
            if !is_new || !unknowns.contains(&name) || unknowns.len() > MOST_COMPARED {
                continue;
            }
            let text = self.names.name(name);
            let count = uses[name as usize];
            let is_before = |other: u32| (uses[other as usize], name) > (count, other);
            let others = unknowns.iter().filter(|other| is_before(**other));
            let mut others = others.map(|other| self.names.name(*other));
            let Some(other) = others.find(|other| is_like(text, other)) else {
                continue;
            };
            if count == 1 || other.to_lowercase() == text.to_lowercase() {
                let message = format!("`{text}` is another unknown than `{other}`");
                warn(warnings, source, place.start, message);
            }
        }
    }

    /// Warns of unknowns such as `xy` beside `x` and `y`, `pix`, and the `gt` of `½gt²` beside `g`: a product, perhaps.
    fn products_without_sign(
        &self,
        unknowns: &[u32],
        source: &Source<'_>,
        warnings: &mut Vec<Warning>,
    ) {
        let declared = (0..self.names.count() as u32).filter(|n| self.declared.contains_key(n));
        let names = unknowns.iter().copied().chain(declared);
        let names: HashSet<&str> = names.map(|name| self.names.name(name)).collect();
        let mut said = HashSet::new();
        for (name, place) in self.all_expressions().flat_map(Parsed::names) {
            let text = self.names.name(name);
            if self.declared.contains_key(&name) && self.unknowns.is_none() {
                continue;
            }
            let before = source.text[..place.start].chars().next_back();
            let is_behind_number = before.is_some_and(char::is_numeric);
            if let Some(product) = product_without_sign(text, &names, is_behind_number)
                && names.contains(text)
                && said.insert(name)
            {
                let message = format!("`{text}` is one name; a product is `{product}`");
                warn(warnings, source, place.start, message);
            }
        }
    }

    fn all_expressions(&self) -> impl Iterator<Item = &Parsed> {
        let equations = self.equations.iter();
        let sides = equations.flat_map(|e| std::iter::once(&e.left).chain(&e.right));
        let objective = self.objective.iter().map(|(_, _, parsed)| parsed);
        sides
            .chain(self.definitions.iter().map(|(_, parsed)| parsed))
            .chain(objective)
    }

    /// The unknowns in their order: as declared, or as they occur. Conditions name some of their own only beside an objective.
    fn unknowns(&self) -> Result<Vec<u32>, Fault> {
        if let Some(declared) = &self.unknowns {
            return Ok(declared.clone());
        }
        let mut used = vec![None; self.names.count()];
        let conditions = self.objective.iter().flat_map(|_| &self.conditions);
        let conditions = conditions.flat_map(ParsedCondition::expressions);
        for parsed in self.all_expressions().chain(conditions) {
            for (name, at) in parsed.names() {
                used[name as usize].get_or_insert(at);
            }
        }
        let mut unknowns = Vec::new();
        for (name, at) in (0..).zip(used) {
            let is_free = !self.declared.contains_key(&name) && !is_constant(&self.names, name);
            let Some(at) = at.filter(|_| is_free) else {
                continue;
            };
            let text = self.names.name(name);
            if let Some((_, instead)) = ELSEWHERE.iter().find(|(other, _)| *other == text) {
                let expected = format!("{instead}, or a line `unknowns:` with this name");
                return Err(Fault::expected(at, expected, format!("`{text}`")));
            }
            unknowns.push(name);
        }
        Ok(unknowns)
    }

    fn into_system(mut self, end: Span, wanted: &mut Wanted) -> Result<System, Fault> {
        if self.equations.is_empty() && self.objective.is_none() {
            return Err(match self.conditions.is_empty() {
                true => Fault::new(end, What::NoEquations),
                false => {
                    let expected = "an equation beside the conditions, such as `x^2 = 4`";
                    Fault::expected(end, expected, "conditions alone")
                }
            });
        }
        let unknowns = self.unknowns()?;
        let equations = std::mem::take(&mut self.equations);
        let mut builder = Builder::default();
        let mut system = System::default();
        let mut values: Vec<Option<NodeId>> = vec![None; self.names.count()];
        for (index, name) in (0..).zip(&unknowns) {
            values[*name as usize] = Some(builder.expressions.variable(index));
            system.variables.push(self.names.name(*name).into());
        }
        for (index, name) in (0..).zip(&self.parameters) {
            values[*name as usize] = Some(builder.expressions.parameter(index));
            system.parameters.push(self.names.name(*name).into());
        }
        let definitions = Definitions {
            names: &self.names,
            list: self.definitions.iter().map(|(n, p)| (*n, p)).collect(),
        };
        definitions.build(&mut builder, &mut values, Use::Rational, &mut |_, fault| {
            fault
        })?;
        let mut places = Vec::new();
        for (number, equation) in (1..).zip(equations) {
            let mut resolve = |_: &mut Expressions, name: u32, at: Span| {
                let unknown = || Fault::new(at, unknown_name(&self.names, &values, name));
                values[name as usize].ok_or_else(unknown)
            };
            let difference = equation.difference();
            let node = builder.build(&difference, Use::Rational, &mut resolve)?;
            let constant = exact::value(&builder.expressions, node, &[], &[]);
            if constant.is_some_and(|value| value.is_zero()) {
                wanted.always_hold.push(difference.span);
                continue;
            }
            system.equations.push(node);
            system.equation_names.push(format!("f{number}"));
            places.push(difference.span);
        }
        system.groups = self.variable_groups(&unknowns)?;
        if let Some((goal, text, parsed)) = self.objective.take() {
            let mut resolve = |_: &mut Expressions, name: u32, at: Span| {
                let unknown = || Fault::new(at, unknown_name(&self.names, &values, name));
                values[name as usize].ok_or_else(unknown)
            };
            wanted.objective = Some(Objective {
                goal,
                text,
                node: builder.build(&parsed, Use::Rational, &mut resolve)?,
                is_free: false,
            });
            places.push(parsed.span);
        }
        hand_over(
            &mut builder,
            &mut system,
            &places,
            wanted.objective.as_mut(),
        )?;
        let is_free = wanted.objective.as_ref().is_some_and(|one| one.is_free);
        let identities = (!is_free).then_some(&mut wanted.always_hold);
        let system = finish(system, &places, end, identities)?;
        if !self.conditions.is_empty() {
            self.build_conditions(&system.typed_system(), &mut wanted.conditions)?;
        }
        Ok(system)
    }

    /// The conditions, in a graph of their own.
    fn build_conditions(
        &mut self,
        typed: &System,
        conditions: &mut Conditions,
    ) -> Result<(), Fault> {
        let mut builder = Builder::of(typed);
        let mut values: Vec<Option<NodeId>> = vec![None; self.names.count()];
        let mut enter = |name: &str, node: NodeId| {
            if let Some(number) = self.names.find(name) {
                values[number as usize] = Some(node);
            }
        };
        for (index, name) in (0..).zip(&typed.variables) {
            enter(name, builder.expressions.variable(index));
        }
        for (index, name) in (0..).zip(&typed.parameters) {
            enter(name, builder.expressions.parameter(index));
        }
        let definitions = Definitions {
            names: &self.names,
            list: self.definitions.iter().map(|(n, p)| (*n, p)).collect(),
        };
        definitions.build(&mut builder, &mut values, Use::Rational, &mut |_, fault| {
            fault
        })?;
        for condition in std::mem::take(&mut self.conditions) {
            conditions.add(condition, &mut builder, &mut |_, name, at| {
                let unknown = || Fault::new(at, unknown_name(&self.names, &values, name));
                values[name as usize].ok_or_else(unknown)
            })?;
        }
        conditions.expressions = builder.expressions;
        Ok(())
    }

    /// The groups: a partition of the unknowns.
    fn variable_groups(&self, unknowns: &[u32]) -> Result<Vec<VariableGroup>, Fault> {
        if self.groups.is_empty() {
            return Ok(vec![VariableGroup {
                variables: (0..unknowns.len()).collect(),
                homogeneous: false,
            }]);
        }
        let mut seen = vec![false; unknowns.len()];
        let mut groups = Vec::new();
        let mut last = Span::default();
        for group in &self.groups {
            let mut members = Vec::new();
            for (name, at) in group {
                last = *at;
                let index = unknowns.iter().position(|unknown| unknown == name);
                let text = || self.names.name(*name).to_owned();
                let index = index.ok_or_else(|| Fault::new(*at, What::UnknownName(text())))?;
                if std::mem::replace(&mut seen[index], true) {
                    let problem = What::DuplicateName {
                        name: text(),
                        first: "is in a group already".into(),
                    };
                    return Err(Fault::new(*at, problem));
                }
                members.push(index);
            }
            if members.is_empty() {
                return Err(Fault::expected(
                    last,
                    "at least one unknown in every group",
                    "none",
                ));
            }
            groups.push(VariableGroup {
                variables: members,
                homogeneous: false,
            });
        }
        match seen.iter().position(|seen| !seen) {
            None => Ok(groups),
            Some(missing) => {
                let nowhere = format!("`{}` in none", self.names.name(unknowns[missing]));
                Err(Fault::expected(last, "every unknown in a group", nowhere))
            }
        }
    }
}
