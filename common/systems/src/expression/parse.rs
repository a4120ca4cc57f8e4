//! Parse: from the text of an expression to its steps in postfix order.
//!
//! One loop with a stack of open operators, so that no nesting can exhaust the
//! machine's stack. Names are only collected here; what they stand for may be
//! written later in the file, and is asked when the graph is built (`build.rs`).

use super::constant_accuracy::Accuracy;
use super::fault::{Fault, Problem, Span};
use super::function_name::{FunctionName, instead_of_function};
pub use super::step::{Operation, Step};
use super::token::{PRINTED_PI, TokenKind, Tokens, fraction, lowered, shorten};
use crate::formats::limits;
use cognate_numeric::rational::Rational;
use rug::Integer;
use rug::ops::Pow;
use std::collections::HashMap;

/// An expression in postfix order.
#[derive(Clone, Debug, Default)]
pub struct Parsed {
    /// The steps.
    pub steps: Vec<Step>,
    /// The numbers that occur, exactly.
    pub numbers: Vec<Rational>,
    /// The place of the whole expression.
    pub span: Span,
}

impl Parsed {
    /// The difference of this expression and another.
    #[must_use]
    pub fn minus(mut self, other: Self) -> Self {
        let before = self.numbers.len() as u32;
        let span = self.span.to(other.span);
        self.numbers.extend(other.numbers);
        self.steps
            .extend(other.steps.into_iter().map(|step| match step.operation {
                Operation::Number(n) => Step {
                    operation: Operation::Number(before + n),
                    ..step
                },
                _ => step,
            }));
        let operation = Operation::Subtract;
        self.steps.push(Step { operation, span });
        Self { span, ..self }
    }

    /// The numbers of the names that occur, with their places, as often as they do.
    pub fn names(&self) -> impl Iterator<Item = (u32, Span)> {
        self.steps.iter().filter_map(|step| match step.operation {
            Operation::Name(name) => Some((name, step.span)),
            _ => None,
        })
    }
}

/// Names of one file, each with a small number.
#[derive(Clone, Debug, Default)]
pub struct Names {
    list: Vec<String>,
    index: HashMap<String, u32>,
}

impl Names {
    /// The number of a name, new if it must be.
    pub fn intern(&mut self, name: &str) -> u32 {
        if let Some(&number) = self.index.get(name) {
            return number;
        }
        let number = u32::try_from(self.list.len()).expect("fewer names than bytes in a file");
        self.list.push(name.into());
        self.index.insert(name.into(), number);
        number
    }

    /// The number of a name that occurred already.
    pub fn find(&self, name: &str) -> Option<u32> {
        self.index.get(name).copied()
    }

    /// The name with a number.
    pub fn name(&self, number: u32) -> &str {
        &self.list[number as usize]
    }

    /// Number of names.
    pub fn count(&self) -> usize {
        self.list.len()
    }
}

/// Differences between the text formats.
#[derive(Clone, Copy, Debug)]
pub struct Dialect {
    /// Names of the imaginary unit.
    pub imaginary: &'static [&'static str],
    /// Whether `Pi` is the circle constant.
    pub pi: bool,
    /// Whether `2i`, `%i` and `%pi` are numbers.
    pub foreign_constants: bool,
    /// Whether `2x` and `(x + 1)(x - 1)` are products.
    pub implicit_products: bool,
}

impl Dialect {
    /// Bertini-classic.
    pub const BERTINI: Dialect = Dialect {
        imaginary: &["I"],
        pi: true,
        foreign_constants: false,
        implicit_products: false,
    };
    /// Equations one a line, and the expressions of our JSON.
    pub const PLAIN: Dialect = Dialect {
        foreign_constants: true,
        implicit_products: true,
        ..Self::BERTINI
    };
    /// PHCpack.
    pub const PHCPACK: Dialect = Dialect {
        imaginary: &["i", "I"],
        pi: false,
        foreign_constants: false,
        implicit_products: false,
    };

    /// Meaning of a reserved name, which nothing else may have; `None` for every other name.
    pub fn reserved(&self, name: &str) -> Option<&'static str> {
        if self.imaginary.contains(&name) {
            Some("the imaginary unit")
        } else if self.pi && name == "Pi" {
            Some("the circle constant")
        } else if FunctionName::of(name).is_some_and(FunctionName::is_reserved) {
            Some("an elementary function")
        } else {
            None
        }
    }
}

/// Describes the text that is expected where a token cannot follow an operand; `end` names other texts that may follow
/// an expression.
fn expected_after(operand: TokenKind<'_>, token: TokenKind<'_>, end: &str) -> String {
    match (operand, token) {
        (TokenKind::Name(name), TokenKind::Symbol('(')) => instead_of_function(name)
            .unwrap_or_else(|| {
                let name = shorten(name);
                format!("an operator (such as `*(`, since `{name}` is no function) or {end}")
            }),
        (
            TokenKind::Name(name),
            TokenKind::Name(_) | TokenKind::Number(_) | TokenKind::Raised(_),
        ) if FunctionName::of(name).is_some_and(FunctionName::is_reserved) => {
            format!("`(` after the function `{name}`")
        }
        (TokenKind::Name(name), TokenKind::Name(_))
            if let Some(instead) = instead_of_function(name) =>
        {
            instead
        }
        (_, TokenKind::Symbol('(')) => format!("an operator (such as `*(`) or {end}"),
        (_, TokenKind::Name(name)) if is_degree(name) => {
            format!("an operator (such as `*pi/180` for degrees) or {end}")
        }
        (TokenKind::Number(number), TokenKind::Unknown('√')) => {
            format!(
                "`{}*sqrt(...)` for a product, or `cbrt(...)`",
                shorten(number)
            )
        }
        (TokenKind::Number(_), TokenKind::Name(name)) => {
            format!("an operator (such as `*{}`) or {end}", shorten(name))
        }
        _ => format!("an operator or {end}"),
    }
}

/// Describes the call that `Sin[x]` is in other programs; `None` for every other name. `sec[1]` is an unknown.
fn function_in_square_brackets(name: &str) -> Option<String> {
    let (function, argument) = name.strip_suffix(']')?.split_once('[')?;
    let function = FunctionName::called(&function.to_lowercase())?;
    let is_index = argument.bytes().all(|b| b.is_ascii_digit()) && !function.is_reserved();
    let call = format!("`{}({})`", function.text(), shorten(argument));
    (!is_index).then_some(call)
}

/// Describes a mixed number such as `3½` and `3 1/2`, or the one number of grouped digits; the tokens behind `whole` come next.
fn number_in_parts(whole: &str, mut tokens: Tokens<'_>) -> Option<String> {
    let is_whole = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
    let next = tokens.take();
    let TokenKind::Number(part) = next.kind else {
        return None;
    };
    if !is_whole(whole) {
        return None;
    }
    if let Some(value) = fraction(part) {
        return Some(format!("`({whole}+{value})` for a mixed number"));
    }
    if is_whole(part) && tokens.take_symbol('/').is_some() {
        return match tokens.peek().kind {
            TokenKind::Number(denominator) if is_whole(denominator) => Some(format!(
                "`({}+{}/{})` for a mixed number",
                shorten(whole),
                shorten(part),
                shorten(denominator)
            )),
            _ => None,
        };
    }
    (is_whole(part) && part.len() == 3 && whole.len() <= 3)
        .then(|| format!("`{whole}{part}` for one number"))
}

/// Describes the two meanings of `√2x` and `√x²`, where the tokens of one come next.
fn meanings_of_root(mut tokens: Tokens<'_>) -> Option<String> {
    let function = match tokens.take().kind {
        TokenKind::Unknown('√') => FunctionName::SquareRoot.text(),
        TokenKind::Unknown('∛') => FunctionName::CubeRoot.text(),
        _ => return None,
    };
    let mut after = tokens.clone();
    let [number, name] = [after.take(), after.take()].map(|token| token.kind);
    if let (TokenKind::Number(number), TokenKind::Name(name)) = (number, name) {
        let [number, name] = [number, name].map(shorten);
        return Some(format!(
            "`{function}({number}*{name})` or `{function}({number})*{name}`"
        ));
    }
    meanings_of_power(function, tokens)
}

/// Describes the two meanings of `sin x^2`, where the tokens behind `sin` come next.
fn meanings_of_power(function: &str, mut tokens: Tokens<'_>) -> Option<String> {
    let argument = tokens.take().span;
    let sign = tokens.take();
    match sign.kind {
        TokenKind::Symbol('^') => _ = tokens.take(),
        TokenKind::Raised(_) => {}
        _ => return None,
    }
    let argument = shorten(&tokens.text()[argument.start..argument.end]);
    let power = shorten(&tokens.text()[sign.span.start..tokens.position()]);
    Some(format!(
        "`{function}({argument}{power})` or `{function}({argument}){power}`"
    ))
}

/// Whether a name behind a number is a unit of angles.
fn is_degree(name: &str) -> bool {
    matches!(name, "deg" | "degree" | "degrees")
}

/// Entry of the stack of operators.
#[derive(Clone, Copy)]
enum Open {
    Bracket,
    Operator(Operation),
}

/// Strength with which an operator binds: `-x^2` is `-(x^2)`, `-a*b` is `(-a)*b`.
fn precedence(operation: Operation) -> u8 {
    match operation {
        Operation::Add | Operation::Subtract => 1,
        Operation::Multiply | Operation::Divide => 2,
        Operation::Negate => 3,
        Operation::Power => 4,
        _ => 5,
    }
}

fn binary(symbol: char) -> Option<Operation> {
    Some(match symbol {
        '+' => Operation::Add,
        '-' => Operation::Subtract,
        '*' => Operation::Multiply,
        '/' => Operation::Divide,
        '^' => Operation::Power,
        _ => return None,
    })
}

/// Totals over the expressions of one file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Number of steps, for the limit on steps.
    pub steps: u64,
    /// Largest relative accuracy of a rounded decimal, or of a constant computed from some; 0 where all are exact.
    pub data_accuracy: f64,
    /// Place where a constant is computed that may be 0 within the errors of its decimals.
    pub may_be_zero: Option<Span>,
}

/// A decimal with fewer significant digits is what somebody chose; with as many it was computed or
/// measured, and is known to half a unit of its last digit.
const ROUNDED_DIGITS: usize = 8;

/// Most significant digits of a decimal that a double was printed as: one with more was computed to more digits.
const DIGITS_OF_PRINTED_DOUBLES: usize = 18;

/// Relative accuracy of a decimal number: half a unit of its last digit where it is rounded, else 0.
pub(crate) fn relative_accuracy(text: &str) -> f64 {
    let mantissa = text.split(['e', 'E']).next().unwrap_or_default();
    let digits: String = mantissa.chars().filter(|&c| c != '.').collect();
    let significant = digits.trim_start_matches('0');
    if significant.len() < ROUNDED_DIGITS || !text.contains(['.', 'e', 'E']) {
        return 0.0;
    }
    // Past 300 digits a double holds neither the number nor its accuracy.
    let value = significant.parse().unwrap_or(f64::INFINITY);
    let half_unit: f64 = 0.5 / value;
    if significant.len() > DIGITS_OF_PRINTED_DOUBLES {
        return half_unit;
    }
    // A double was rounded before it was printed: sixteen and seventeen digits say more than is known of the number.
    half_unit.max(f64::EPSILON / 2.0)
}

/// Largest relative accuracy of a rounded decimal in a text of numbers, names and signs; 0 where all are exact.
pub(crate) fn accuracy_of_decimals(text: &str) -> f64 {
    let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.'));
    let numbers = words.filter(|word| word.starts_with(|c: char| c.is_ascii_digit() || c == '.'));
    // The unit of `2.5I` is no digit.
    let accuracies = numbers.map(|word| relative_accuracy(word.trim_end_matches(['I', 'i', 'j'])));
    accuracies.fold(0.0, f64::max)
}

/// The place of the `i` of a number such as `2i`, whose tokens come next; `None` where they are other ones.
fn imaginary_unit_after(tokens: &Tokens<'_>, dialect: Dialect) -> Option<Span> {
    let mut after = tokens.clone();
    let number = after.take().span;
    let unit = after.peek();
    let is_unit = dialect.foreign_constants
        && unit.kind == TokenKind::Name("i")
        && unit.span.start == number.end;
    is_unit.then_some(unit.span)
}

/// `%pi` or `%i`, where the next tokens are one of these.
fn constant_after_percent(tokens: &Tokens<'_>, dialect: Dialect) -> Option<&'static str> {
    let mut after = tokens.clone();
    let percent = after.take().span;
    let name = after.peek();
    let is_close = dialect.foreign_constants && name.span.start == percent.end;
    match name.kind {
        TokenKind::Name("pi") if is_close => Some("%pi"),
        TokenKind::Name("i") if is_close => Some("%i"),
        _ => None,
    }
}

/// Reads the longest expression at the tokens' place; the token after it stays.
///
/// `end` says in words what may follow the expression. `totals` are those of the whole file so far.
pub fn expression(
    tokens: &mut Tokens<'_>,
    names: &mut Names,
    dialect: Dialect,
    end: &str,
    totals: &mut Totals,
) -> Result<Parsed, Fault> {
    let start = tokens.peek().span.start;
    let mut reader = Reader {
        tokens,
        names,
        dialect,
        totals,
        parsed: Parsed::default(),
        errors: Vec::new(),
        open: Vec::new(),
        operand: TokenKind::End,
    };
    let mut next = Next::Operand;
    while next != Next::End {
        let place = reader.tokens.peek().span;
        next = match next {
            Next::Operand => reader.operand()?,
            _ => reader.operator(end)?,
        };
        reader.check_limits(place)?;
    }
    let Reader {
        mut parsed, errors, ..
    } = reader;
    if errors.iter().any(|&error| error > 0.0) {
        let accuracy = Accuracy::of(&parsed.steps, &parsed.numbers, &errors);
        totals.data_accuracy = totals.data_accuracy.max(accuracy.relative);
        totals.may_be_zero = totals.may_be_zero.or(accuracy.may_be_zero);
    }
    parsed.span = Span {
        start,
        end: tokens.position(),
    };
    Ok(parsed)
}

/// The next part of an expression.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Next {
    /// A number, a name, or symbols that stand before these.
    Operand,
    /// An operator, or a bracket that closes.
    Operator,
    /// Nothing: the next token is no part of the expression.
    End,
}

/// An expression that is being read.
struct Reader<'t, 'a> {
    tokens: &'t mut Tokens<'a>,
    names: &'t mut Names,
    dialect: Dialect,
    totals: &'t mut Totals,
    parsed: Parsed,
    /// Relative errors of its numbers.
    errors: Vec<f64>,
    /// Operators and brackets that wait for what follows them, with their places.
    open: Vec<(Open, Span)>,
    /// The last operand, or the bracket that ended it.
    operand: TokenKind<'a>,
}

impl Reader<'_, '_> {
    fn put(&mut self, operation: Operation, span: Span) {
        self.totals.steps += 1;
        self.parsed.steps.push(Step { operation, span });
    }

    /// Puts a number that is known to this relative accuracy.
    fn put_number(&mut self, value: Rational, accuracy: f64, span: Span) {
        let number = Operation::Number(self.parsed.numbers.len() as u32);
        self.put(number, span);
        self.parsed.numbers.push(value);
        self.errors.push(accuracy);
    }

    fn put_name(&mut self, name: &str, span: Span) {
        let name = self.names.intern(name);
        self.put(Operation::Name(name), span);
    }

    fn check_limits(&self, place: Span) -> Result<(), Fault> {
        if self.open.len() as u64 > limits::NESTING.value {
            return Err(Fault::limit(place, limits::NESTING, self.open.len()));
        }
        if self.parsed.steps.len() as u64 > limits::EXPRESSION_OPERATIONS.value {
            return Err(Fault::limit(place, limits::EXPRESSION_OPERATIONS, "more"));
        }
        if self.totals.steps > limits::OPERATIONS.value {
            return Err(Fault::limit(place, limits::OPERATIONS, "more"));
        }
        Ok(())
    }

    /// Takes a token where an operand is due.
    fn operand(&mut self) -> Result<Next, Fault> {
        let token = self.tokens.peek();
        self.operand = token.kind;
        let mut next = Next::Operator;
        match token.kind {
            TokenKind::Number(text) => self.number(text, token.span)?,
            TokenKind::Unknown('%')
                if let Some(name) = constant_after_percent(self.tokens, self.dialect) =>
            {
                self.put_name(name, token.span);
                self.tokens.take();
            }
            TokenKind::Unknown(_) if let Some(function) = self.root_sign() => {
                let call = Open::Operator(Operation::Call(function));
                self.open.push((call, token.span));
                next = Next::Operand;
            }
            TokenKind::Name(text) => {
                if let Some(meant) = function_in_square_brackets(text)
                    && self.dialect.foreign_constants
                {
                    return Err(Fault::expected(token.span, meant, token.describe()));
                }
                next = self.name(text, token.span);
            }
            TokenKind::Symbol(symbol @ ('(' | '-' | '+')) => {
                next = Next::Operand;
                match symbol {
                    '(' => self.open.push((Open::Bracket, token.span)),
                    '-' => {
                        let negate = Open::Operator(Operation::Negate);
                        self.open.push((negate, token.span));
                    }
                    _ => {}
                }
            }
            _ => {
                let expected = match self.open.last() {
                    Some((Open::Operator(Operation::Power), _)) => {
                        "an exponent: a number, a name or `(`"
                    }
                    _ => "a number, a name or `(`",
                };
                let expected = meanings_of_root(self.tokens.clone()).unwrap_or(expected.to_owned());
                return Err(Fault::expected(token.span, expected, token.describe()));
            }
        }
        self.tokens.take();
        Ok(next)
    }

    /// The function of a root sign with one meaning: before a bracket, or before a name or a number that no power and no
    /// factor touches.
    fn root_sign(&self) -> Option<FunctionName> {
        let mut after = self.tokens.clone();
        let function = match after.take().kind {
            TokenKind::Unknown('√') => FunctionName::SquareRoot,
            TokenKind::Unknown('∛') => FunctionName::CubeRoot,
            _ => return None,
        };
        let argument = after.take();
        let next = after.peek();
        let touches = next.span.start == argument.span.end;
        let is_clear = match (argument.kind, next.kind) {
            (TokenKind::Symbol('('), _) => true,
            (_, TokenKind::Symbol('^') | TokenKind::Raised(_)) => false,
            (_, TokenKind::Name(_) | TokenKind::Symbol('(')) if touches => false,
            (kind, _) => matches!(kind, TokenKind::Name(_) | TokenKind::Number(_)),
        };
        (is_clear && self.dialect.foreign_constants).then_some(function)
    }

    /// Describes the place of a number in brackets behind an equation, or before it, that may be the number of the equation;
    /// `None` where the next token is elsewhere.
    fn number_of_equation(&self) -> Option<String> {
        let mut after = self.tokens.clone();
        let [open, number, close] = [after.take(), after.take(), after.take()];
        let is_number = matches!(number.kind, TokenKind::Number(_));
        let is_behind = open.kind == TokenKind::Symbol('(')
            && self.tokens.position() < open.span.start
            && is_number
            && close.kind == TokenKind::Symbol(')')
            && matches!(after.peek().kind, TokenKind::End | TokenKind::Symbol(','));
        let is_first = matches!(&self.parsed.steps[..], [step] if matches!(step.operation, Operation::Number(_)));
        let is_before = is_first
            && self.operand == TokenKind::Symbol(')')
            && matches!(open.kind, TokenKind::Name(_) | TokenKind::Symbol('('));
        (is_behind || is_before)
            .then(|| "an operator (such as `*`); the number of an equation is left out".to_owned())
    }

    /// Describes the text that is expected in the place of a token that cannot follow an operand.
    fn expected(&self, token: TokenKind<'_>, end: &str) -> String {
        let meanings = match self.operand {
            TokenKind::Number(whole) => number_in_parts(whole, self.tokens.clone()),
            TokenKind::Name(name)
                if FunctionName::of(name).is_some_and(FunctionName::is_reserved) =>
            {
                meanings_of_power(name, self.tokens.clone())
            }
            _ => None,
        };
        if let Some(meanings) = meanings.or_else(|| self.number_of_equation()) {
            return meanings;
        }
        let [.., base, _, power] = &self.parsed.steps[..] else {
            return expected_after(self.operand, token, end);
        };
        let name = match (base.operation, power.operation) {
            (Operation::Name(name), Operation::Power) => self.names.name(name),
            _ => "",
        };
        let is_argument = matches!(token, TokenKind::Symbol('(') | TokenKind::Name(_));
        match FunctionName::of(name).filter(|_| is_argument) {
            Some(_) => format!("`{name}(...)^` for a power of `{name}`"),
            None => expected_after(self.operand, token, end),
        }
    }

    /// A number; one such as `2i` with its unit.
    fn number(&mut self, text: &str, place: Span) -> Result<(), Fault> {
        let value = number(text, place)?;
        let accuracy = relative_accuracy(text);
        self.totals.data_accuracy = self.totals.data_accuracy.max(accuracy);
        self.put_number(value, accuracy, place);
        if let Some(unit) = imaginary_unit_after(self.tokens, self.dialect) {
            self.put_name("1i", unit);
            self.put(Operation::Multiply, place.to(unit));
            self.tokens.take();
        }
        Ok(())
    }

    /// A name: a function where a bracket follows, else a constant or what the file says.
    fn name(&mut self, text: &str, place: Span) -> Next {
        let mut after = self.tokens.clone();
        after.take();
        let is_called = after.peek().kind == TokenKind::Symbol('(');
        if let Some(function) = FunctionName::called(text).filter(|_| is_called) {
            let call = Open::Operator(Operation::Call(function));
            self.open.push((call, place));
            return Next::Operand;
        }
        if self.dialect.imaginary.contains(&text) {
            self.put(Operation::ImaginaryUnit, place);
        } else if self.dialect.pi && text == "Pi" {
            self.put(Operation::Pi, place);
        } else {
            self.put_name(text, place);
        }
        Next::Operator
    }

    /// Takes a token where an operator is due; `end` says in words what may follow the expression.
    fn operator(&mut self, end: &str) -> Result<Next, Fault> {
        let token = self.tokens.peek();
        if let TokenKind::Raised(text) = token.kind {
            self.raised(text, token.span)?;
            self.tokens.take();
            return Ok(Next::Operator);
        }
        if let Some(expected) = self.repeating_decimal() {
            return Err(Fault::expected(token.span, expected, token.describe()));
        }
        if self.is_implicit_product() {
            let multiply = Operation::Multiply;
            self.complete(Some(multiply));
            self.open.push((Open::Operator(multiply), token.span));
            return Ok(Next::Operand);
        }
        if let Some(meanings) = self.meanings_of_quotient() {
            return Err(Fault::expected(token.span, meanings, token.describe()));
        }
        let operator = match token.kind {
            TokenKind::Symbol(symbol) => binary(symbol),
            _ => None,
        };
        self.complete(operator);
        let next = match (operator, token.kind, self.open.last()) {
            (Some(operation), ..) => {
                self.open.push((Open::Operator(operation), token.span));
                Next::Operand
            }
            (None, TokenKind::Symbol(')'), Some(_)) => {
                self.open.pop();
                self.operand = token.kind;
                Next::Operator
            }
            (None, _, Some(_)) => {
                let expected = self.expected(token.kind, "`)`");
                return Err(Fault::expected(token.span, expected, token.describe()));
            }
            (None, TokenKind::Symbol(')' | '('), None)
            | (None, TokenKind::Number(_) | TokenKind::Name(_) | TokenKind::Unknown(_), None) => {
                let expected = self.expected(token.kind, end);
                return Err(Fault::expected(token.span, expected, token.describe()));
            }
            (None, _, None) => return Ok(Next::End),
        };
        self.tokens.take();
        Ok(next)
    }

    /// Describes the text that is expected instead of a decimal number before digits in brackets: `0.(3)` may be 1/3 or a
    /// product.
    fn repeating_decimal(&self) -> Option<String> {
        let TokenKind::Number(decimal) = self.operand else {
            return None;
        };
        let mut after = self.tokens.clone();
        let [open, digits, close] = [after.take(), after.take(), after.take()];
        let TokenKind::Number(period) = digits.kind else {
            return None;
        };
        let is_bracket = self.tokens.position() == open.span.start
            && open.kind == TokenKind::Symbol('(')
            && close.kind == TokenKind::Symbol(')');
        let (_, fraction) = decimal.split_once('.').filter(|_| is_bracket)?;
        let is_digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
        if !is_digits(fraction) || !is_digits(period) {
            return None;
        }
        let [start, repeated] = [decimal.to_owned(), format!("{decimal}{period}")]
            .map(|text| number(&text, digits.span));
        let nines = Integer::from(10).pow(u32::try_from(period.len()).ok()?);
        let difference = repeated.ok()? * Rational::from(nines.clone()) - start.ok()?;
        let value = difference / Rational::from(nines - 1u32);
        Some(format!(
            "`{value}` for a repeating decimal, or `*(` for a product"
        ))
    }

    /// Describes the two meanings of a quotient such as `1/2x`, where the next token is the `x` of one.
    fn meanings_of_quotient(&self) -> Option<String> {
        let divides = matches!(
            self.open.last(),
            Some((Open::Operator(Operation::Divide), _))
        );
        let (TokenKind::Number(divisor) | TokenKind::Name(divisor @ PRINTED_PI)) = self.operand
        else {
            return None;
        };
        let mut after = self.tokens.clone();
        let first = after.take();
        let second = after.peek();
        if first.kind == TokenKind::Name(PRINTED_PI)
            && matches!(second.kind, TokenKind::Name(_))
            && second.span.start == first.span.end
        {
            after.take();
        }
        let mut end = after.position();
        let is_factor = match first.kind {
            TokenKind::Name(name) => !is_degree(name),
            kind => kind == TokenKind::Symbol('('),
        };
        let touches = self.tokens.position() == first.span.start;
        if !(divides && is_factor && touches && self.dialect.implicit_products) {
            return None;
        }
        let mut depth = u32::from(first.kind == TokenKind::Symbol('('));
        if depth == 0 && after.take_symbol('(').is_some() {
            depth = 1;
        }
        while depth > 0 {
            match after.take().kind {
                TokenKind::Symbol('(') => depth += 1,
                TokenKind::Symbol(')') => depth -= 1,
                TokenKind::End => return None,
                _ => {}
            }
            end = after.position();
        }
        let factor = &self.tokens.text()[first.span.start..end];
        Some(format!(
            "`/({divisor}*{factor})` or `/{divisor}*{factor}`, which are the two meanings of `/{divisor}{factor}`"
        ))
    }

    /// Whether the next token is a factor that touches the number, the `π` or the bracket before it, as in `2x`, `πr` and
    /// `(x + 1)(x - 1)`.
    /// Behind `/` and `^` it is none: `1/2x` may be `x/2` or `1/(2x)`. `0x10` is a hexadecimal number elsewhere.
    fn is_implicit_product(&mut self) -> bool {
        let next = self.tokens.peek();
        let is_factor = match next.kind {
            TokenKind::Name(name) => !is_degree(name),
            kind => kind == TokenKind::Symbol('('),
        };
        let is_operand = match self.operand {
            TokenKind::Number(text) => text != "0",
            kind => matches!(kind, TokenKind::Symbol(')') | TokenKind::Name(PRINTED_PI)),
        };
        let operators = self.open.iter().rev().map_while(|(open, _)| match open {
            Open::Operator(operation) => Some(*operation),
            Open::Bracket => None,
        });
        let mut binary = operators.filter(|o| !matches!(o, Operation::Negate | Operation::Call(_)));
        let is_clear = !matches!(binary.next(), Some(Operation::Divide | Operation::Power));
        let touches = self.tokens.position() == next.span.start;
        self.dialect.implicit_products && is_factor && is_operand && touches && is_clear
    }

    /// Raised digits: a power of what stands before them, as printed; a function is raised with its argument.
    fn raised(&mut self, text: &str, place: Span) -> Result<(), Fault> {
        while let Some(&(Open::Operator(call @ Operation::Call(_)), span)) = self.open.last() {
            self.put(call, span);
            self.open.pop();
        }
        self.put_number(number(&lowered(text), place)?, 0.0, place);
        self.put(Operation::Power, place);
        Ok(())
    }

    /// Completes the operators that bind at least as strongly as the next one; all of a bracket where none follows.
    fn complete(&mut self, next: Option<Operation>) {
        while let Some(&(Open::Operator(top), span)) = self.open.last() {
            let is_complete = next.is_none_or(|next| {
                precedence(top) > precedence(next)
                    || precedence(top) == precedence(next) && next != Operation::Power
            });
            if !is_complete {
                return;
            }
            self.put(top, span);
            self.open.pop();
        }
    }
}

/// The exact value of a decimal number: `1.5e-3` is 3/2000.
pub fn number(text: &str, span: Span) -> Result<Rational, Fault> {
    if let Some(value) = fraction(text) {
        return Ok(value);
    }
    let (mantissa, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], &text[at + 1..]),
        None => (text, "0"),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = (whole.len() + fraction.len()) as u64;
    if digits > limits::NUMBER_DIGITS.value {
        return Err(Fault::limit(span, limits::NUMBER_DIGITS, digits));
    }
    let refused = || {
        Fault::limit(
            span,
            limits::NUMBER_EXPONENT,
            exponent.trim_start_matches('+'),
        )
    };
    let power: i64 = exponent.parse().map_err(|_| refused())?;
    if power.unsigned_abs() > limits::NUMBER_EXPONENT.value {
        return Err(refused());
    }
    let power = power - fraction.len() as i64;
    let digits = format!("{whole}{fraction}");
    let integer: Integer = digits
        .parse()
        .map_err(|_| Fault::expected(span, "a decimal number", format!("`{}`", shorten(text))))?;
    let scale = Integer::from(10).pow(u32::try_from(power.unsigned_abs()).expect("limited above"));
    Ok(if power < 0 {
        Rational::from((integer, scale))
    } else {
        Rational::from(integer * scale)
    })
}

/// Refuses a name that means something by itself.
pub fn check_free(name: &str, span: Span, dialect: Dialect) -> Result<(), Fault> {
    match dialect.reserved(name) {
        Some(meaning) => Err(Fault::new(
            span,
            Problem::ReservedName {
                name: name.into(),
                meaning,
            },
        )),
        None => Ok(()),
    }
}
