//! Parse: from the text of an expression to its steps in postfix order.
//!
//! One loop with a stack of open operators, so that no nesting can exhaust the
//! machine's stack. Names are only collected here; what they stand for may be
//! written later in the file, and is asked when the graph is built (`build.rs`).

use super::fault::{Fault, Problem, Span};
use super::token::{TokenKind, Tokens, lowered};
use crate::formats::limits;
use cognate_numeric::rational::Rational;
use rug::Integer;
use rug::ops::Pow;
use std::collections::HashMap;

/// One step of a stack machine; operators take their operands from the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Puts a number: index into [`Parsed::numbers`].
    Number(u32),
    /// Puts what a name stands for: index into [`Names`].
    Name(u32),
    /// Puts the imaginary unit.
    ImaginaryUnit,
    /// Puts the circle constant.
    Pi,
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// `a ^ b`.
    Power,
    /// `-a`.
    Negate,
    /// A function.
    Call(FunctionName),
}

/// Functions that may be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FunctionName {
    /// Square root, principal branch.
    SquareRoot,
    /// Cube root: real of a real number, else the principal branch.
    CubeRoot,
    /// Exponential.
    Exponential,
    /// Natural logarithm, principal branch.
    Logarithm,
    /// Sine.
    Sine,
    /// Cosine.
    Cosine,
    /// Tangent.
    Tangent,
    /// Cotangent.
    Cotangent,
    /// Secant.
    Secant,
    /// Cosecant.
    Cosecant,
    /// Absolute value of what is real: the principal square root of the square.
    Absolute,
}

impl FunctionName {
    const ALL: [Self; 11] = [
        Self::SquareRoot,
        Self::CubeRoot,
        Self::Exponential,
        Self::Logarithm,
        Self::Sine,
        Self::Cosine,
        Self::Tangent,
        Self::Cotangent,
        Self::Secant,
        Self::Cosecant,
        Self::Absolute,
    ];

    /// The function as it is written.
    pub fn text(self) -> &'static str {
        match self {
            Self::SquareRoot => "sqrt",
            Self::CubeRoot => "cbrt",
            Self::Exponential => "exp",
            Self::Logarithm => "log",
            Self::Sine => "sin",
            Self::Cosine => "cos",
            Self::Tangent => "tan",
            Self::Cotangent => "cot",
            Self::Secant => "sec",
            Self::Cosecant => "csc",
            Self::Absolute => "abs",
        }
    }

    /// Whether nothing else may have this name. The others are functions only before a bracket: older files may have
    /// unknowns of these names.
    fn is_reserved(self) -> bool {
        !matches!(
            self,
            Self::CubeRoot | Self::Cotangent | Self::Secant | Self::Cosecant | Self::Absolute
        )
    }
}

/// A step and the place of its own sign in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The operation.
    pub operation: Operation,
    /// Place of the operation in the text.
    pub span: Span,
}

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
    /// This expression less another.
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

    /// How many names there are.
    pub fn count(&self) -> usize {
        self.list.len()
    }
}

/// In what the text formats differ.
#[derive(Clone, Copy, Debug)]
pub struct Dialect {
    /// Names of the imaginary unit.
    pub imaginary: &'static [&'static str],
    /// Whether `Pi` is the circle constant.
    pub pi: bool,
    /// Whether `2i`, `%i` and `%pi` are numbers.
    pub foreign_constants: bool,
}

impl Dialect {
    /// Bertini-classic.
    pub const BERTINI: Dialect = Dialect {
        imaginary: &["I"],
        pi: true,
        foreign_constants: false,
    };
    /// Equations one a line, and the expressions of our JSON.
    pub const PLAIN: Dialect = Dialect {
        foreign_constants: true,
        ..Self::BERTINI
    };
    /// PHCpack.
    pub const PHCPACK: Dialect = Dialect {
        imaginary: &["i", "I"],
        pi: false,
        foreign_constants: false,
    };

    /// What a name means by itself, so that nothing else may be called so.
    pub fn reserved(&self, name: &str) -> Option<&'static str> {
        if self.imaginary.contains(&name) {
            Some("the imaginary unit")
        } else if self.pi && name == "Pi" {
            Some("the circle constant")
        } else if function(name).is_some_and(FunctionName::is_reserved) {
            Some("an elementary function")
        } else {
            None
        }
    }
}

/// The function with this name.
pub fn function(name: &str) -> Option<FunctionName> {
    let mut functions = FunctionName::ALL.into_iter();
    functions.find(|function| function.text() == name)
}

/// The function that a name before a bracket calls: by its name, or `ln`.
fn called(name: &str) -> Option<FunctionName> {
    match name {
        "ln" => Some(FunctionName::Logarithm),
        _ => function(name),
    }
}

/// Functions of other programs of which no equation with polynomials can speak.
const WITHOUT_POLYNOMIALS: [&str; 18] = [
    "sinh",
    "cosh",
    "tanh",
    "max",
    "min",
    "floor",
    "ceil",
    "round",
    "sign",
    "sgn",
    "mod",
    "erf",
    "gamma",
    "log10",
    "log2",
    "factorial",
    "conj",
    "arg",
];
/// Inverse functions, and what an equation says in their place.
const INVERSE_FUNCTIONS: [(&str, &str); 6] = [
    ("asin", "sin(a) = x"),
    ("arcsin", "sin(a) = x"),
    ("acos", "cos(a) = x"),
    ("arccos", "cos(a) = x"),
    ("atan", "tan(a) = x"),
    ("arctan", "tan(a) = x"),
];

/// What should stand where a token cannot follow an operand; `end` says what else may follow an expression.
fn expected_after(operand: TokenKind<'_>, token: TokenKind<'_>, end: &str) -> String {
    let shorten = super::token::shorten;
    match (operand, token) {
        (TokenKind::Name(name), TokenKind::Symbol('(')) => {
            let inverse = INVERSE_FUNCTIONS.iter().find(|(other, _)| *other == name);
            if let Some((_, instead)) = inverse {
                return format!("`{instead}` in the place of `a = {name}(x)`");
            }
            if WITHOUT_POLYNOMIALS.contains(&name) {
                return format!("no `{name}` (it has no polynomial form)");
            }
            format!(
                "an operator (such as `*(`, since `{}` is no function) or {end}",
                shorten(name)
            )
        }
        (
            TokenKind::Name(name),
            TokenKind::Name(_) | TokenKind::Number(_) | TokenKind::Raised(_),
        ) if function(name).is_some_and(FunctionName::is_reserved) => {
            format!("`(` after the function `{name}`")
        }
        (_, TokenKind::Symbol('(')) => format!("an operator (such as `*(`) or {end}"),
        (TokenKind::Number(_), TokenKind::Name(name)) => {
            format!("an operator (such as `*{}`) or {end}", shorten(name))
        }
        _ => format!("an operator or {end}"),
    }
}

/// What waits on the stack of operators.
#[derive(Clone, Copy)]
enum Open {
    Bracket,
    Operator(Operation),
}

/// How strongly an operator binds: `-x^2` is `-(x^2)`, `-a*b` is `(-a)*b`.
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

/// What the expressions of one file come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Their steps, for the limit on them.
    pub steps: u64,
    /// Largest relative accuracy of a rounded decimal; 0 where all numbers are exact.
    pub data_accuracy: f64,
}

/// A decimal with fewer significant digits is what somebody chose; with as many it was computed or
/// measured, and is known to half a unit of its last digit.
const ROUNDED_DIGITS: usize = 8;

/// Relative accuracy of a decimal number: half a unit of its last digit where it is rounded, else 0.
fn relative_accuracy(text: &str) -> f64 {
    let mantissa = text.split(['e', 'E']).next().unwrap_or_default();
    let digits: String = mantissa.chars().filter(|&c| c != '.').collect();
    let significant = digits.trim_start_matches('0');
    if significant.len() < ROUNDED_DIGITS || !text.contains(['.', 'e', 'E']) {
        return 0.0;
    }
    // Past 300 digits a double holds neither the number nor its accuracy.
    let value = significant.parse().unwrap_or(f64::INFINITY);
    0.5 / value
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
    let mut parsed = Parsed::default();
    let mut open: Vec<(Open, Span)> = Vec::new();
    let mut operand_next = true;
    // `2x` is no product here: the message says what is.
    let mut operand = TokenKind::End;
    let start = tokens.peek().span;
    let mut steps = totals.steps;
    loop {
        let token = tokens.peek();
        let mut put = |parsed: &mut Parsed, operation, span| {
            steps += 1;
            parsed.steps.push(Step { operation, span });
        };
        if operand_next {
            operand = token.kind;
            match token.kind {
                TokenKind::Number(text) => {
                    let value = number(text, token.span)?;
                    totals.data_accuracy = totals.data_accuracy.max(relative_accuracy(text));
                    let number = Operation::Number(parsed.numbers.len() as u32);
                    put(&mut parsed, number, token.span);
                    parsed.numbers.push(value);
                    operand_next = false;
                    if let Some(unit) = imaginary_unit_after(tokens, dialect) {
                        put(&mut parsed, Operation::Name(names.intern("1i")), unit);
                        put(&mut parsed, Operation::Multiply, token.span.to(unit));
                        tokens.take();
                    }
                }
                TokenKind::Unknown('%') if constant_after_percent(tokens, dialect).is_some() => {
                    let name = constant_after_percent(tokens, dialect).unwrap_or_default();
                    put(&mut parsed, Operation::Name(names.intern(name)), token.span);
                    tokens.take();
                    operand_next = false;
                }
                TokenKind::Name(text) => {
                    let mut after = tokens.clone();
                    after.take();
                    let is_called = after.peek().kind == TokenKind::Symbol('(');
                    match called(text).filter(|_| is_called) {
                        Some(function) => {
                            open.push((Open::Operator(Operation::Call(function)), token.span));
                        }
                        None => {
                            let operation = if dialect.imaginary.contains(&text) {
                                Operation::ImaginaryUnit
                            } else if dialect.pi && text == "Pi" {
                                Operation::Pi
                            } else {
                                Operation::Name(names.intern(text))
                            };
                            put(&mut parsed, operation, token.span);
                            operand_next = false;
                        }
                    }
                }
                TokenKind::Symbol('(') => open.push((Open::Bracket, token.span)),
                TokenKind::Symbol('-') => {
                    open.push((Open::Operator(Operation::Negate), token.span));
                }
                TokenKind::Symbol('+') => {}
                _ => {
                    return Err(Fault::expected(
                        token.span,
                        "a number, a name or `(`",
                        token.describe(),
                    ));
                }
            }
            tokens.take();
        } else {
            if let TokenKind::Raised(text) = token.kind {
                // Binds to what stands before it, as printed: a function of its argument with it.
                while let Some(&(Open::Operator(call @ Operation::Call(_)), span)) = open.last() {
                    put(&mut parsed, call, span);
                    open.pop();
                }
                let power = Operation::Number(parsed.numbers.len() as u32);
                parsed.numbers.push(number(&lowered(text), token.span)?);
                put(&mut parsed, power, token.span);
                put(&mut parsed, Operation::Power, token.span);
                tokens.take();
                continue;
            }
            let operator = match token.kind {
                TokenKind::Symbol(symbol) => binary(symbol),
                _ => None,
            };
            // Operators that bind at least as strongly are complete now.
            while let Some(&(Open::Operator(top), span)) = open.last() {
                let complete = operator.is_none_or(|next| {
                    precedence(top) > precedence(next)
                        || precedence(top) == precedence(next) && next != Operation::Power
                });
                if !complete {
                    break;
                }
                put(&mut parsed, top, span);
                open.pop();
            }
            match (operator, token.kind, open.last()) {
                (Some(operation), ..) => {
                    open.push((Open::Operator(operation), token.span));
                    operand_next = true;
                }
                (None, TokenKind::Symbol(')'), Some(_)) => {
                    open.pop();
                    operand = token.kind;
                }
                (None, _, Some(_)) => {
                    let expected = expected_after(operand, token.kind, "`)`");
                    return Err(Fault::expected(token.span, expected, token.describe()));
                }
                (None, TokenKind::Symbol(')' | '('), None)
                | (None, TokenKind::Number(_) | TokenKind::Name(_) | TokenKind::Unknown(_), None) =>
                {
                    let expected = expected_after(operand, token.kind, end);
                    return Err(Fault::expected(token.span, expected, token.describe()));
                }
                (None, _, None) => break,
            }
            tokens.take();
        }
        if open.len() as u64 > limits::NESTING.value {
            return Err(Fault::limit(token.span, limits::NESTING, open.len()));
        }
        if steps > limits::OPERATIONS.value {
            return Err(Fault::limit(token.span, limits::OPERATIONS, "more"));
        }
    }
    totals.steps = steps;
    parsed.span = Span {
        start: start.start,
        end: tokens.position(),
    };
    Ok(parsed)
}

/// The exact value of a decimal number: `1.5e-3` is 3/2000.
pub fn number(text: &str, span: Span) -> Result<Rational, Fault> {
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
    let integer: Integer = digits.parse().map_err(|_| {
        Fault::expected(
            span,
            "a decimal number",
            format!("`{}`", super::token::shorten(text)),
        )
    })?;
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
