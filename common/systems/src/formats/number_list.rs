//! NumberList: numbers as they are typed in values of parameters, `0.5, 1/3, 2-0.5*I, sqrt(2), linspace(0, 1, 100)`.
//!
//! Sums, products and quotients of doubles, and expressions that are rounded once: the values are the same on every machine.

use super::json_value::decimal;
use super::limits;
use super::scope::Scope;
use crate::expression::fault::{Fault, Span};
use crate::expression::token::shorten;
use crate::straight_line_program::constant::ConstantPool;
use crate::system::System;
use num_complex::Complex64;

/// Description of the items that a list may hold, for messages.
const ITEM: &str = "a number such as 0.5, 1/3 or 2-0.5*I, or linspace(FIRST, LAST, COUNT)";

/// Description of the numbers that a list may hold, for messages.
const NUMBER: &str = "a number such as 0.5, 1/3 or 2-0.5*I";

/// Numbers between commas, which fill `text[span.start..span.end]`.
pub(super) fn list(text: &str, span: Span) -> Result<Vec<Complex64>, Fault> {
    let mut scanner = Scanner::new(text, span);
    let mut values = Vec::new();
    loop {
        scanner.item(&mut values)?;
        if scanner.is_at_end() {
            return Ok(values);
        }
        if !scanner.take(",") {
            return Err(scanner.unexpected("`,` or the end of the values"));
        }
    }
}

/// One number, which fills `text[span.start..span.end]`.
pub(super) fn number(text: &str, span: Span) -> Result<Complex64, Fault> {
    let mut scanner = Scanner::new(text, span);
    let value = scanner.value(NUMBER)?;
    match scanner.is_at_end() {
        true => Ok(value),
        false => Err(scanner.unexpected("the end of the number")),
    }
}

/// The value of an expression without names other than constants, rounded once; `None` where it is none.
fn constant(text: &str) -> Option<Complex64> {
    let mut scope = Scope::of(&System::default());
    let node = scope.expression(text).ok()?;
    let mut pool = ConstantPool::default();
    let constant = pool.describe(&scope.into_expressions(), node);
    let number = pool.insert(constant);
    let value = pool.round::<f64>(number, ());
    let value = Complex64::new(value.re, value.im);
    value.is_finite().then_some(value)
}

/// How many equal steps lead from one number to another; `None` where no whole number of them does.
fn steps(first: Complex64, step: Complex64, last: Complex64) -> Option<u32> {
    let ratio = (last - first) / step;
    let count = ratio.re.round();
    let is_whole = (ratio - count).norm_sqr() < 1e-18 * count * count;
    (is_whole && count >= 1.0 && count < limits::TARGETS.value as f64).then_some(count as u32)
}

/// Adds values to a list that may have [`limits::TARGETS`] of them.
pub(super) fn extend(
    values: &mut Vec<Complex64>,
    more: impl ExactSizeIterator<Item = Complex64>,
    span: Span,
) -> Result<(), Fault> {
    let count = (values.len() + more.len()) as u64;
    if count > limits::TARGETS.value {
        return Err(Fault::limit(span, limits::TARGETS, count));
    }
    values.extend(more);
    Ok(())
}

/// The value at `k` of `count` values that are equally spaced from `first` to `last`, which are met exactly.
fn spaced(first: Complex64, last: Complex64, k: u64, count: u64) -> Complex64 {
    if k == 0 || first == last {
        return first;
    }
    let intervals = count - 1;
    if k == intervals {
        return last;
    }
    let part = |a: f64, b: f64| {
        // One rounding where the ends are small whole numbers: 0.3 is 3/10.
        let sum = (intervals - k) as f64 * a + k as f64 * b;
        sum / intervals as f64
    };
    Complex64::new(part(first.re, last.re), part(first.im, last.im))
}

/// A part of a text that is read from left to right.
struct Scanner<'a> {
    text: &'a str,
    position: usize,
    end: usize,
}

impl<'a> Scanner<'a> {
    fn new(text: &'a str, span: Span) -> Self {
        Self {
            text,
            position: span.start,
            end: span.end,
        }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.position..self.end]
    }

    fn skip_blanks(&mut self) {
        self.position = self.end - self.rest().trim_start().len();
    }

    fn is_at_end(&mut self) -> bool {
        self.skip_blanks();
        self.rest().is_empty()
    }

    fn take(&mut self, symbol: &str) -> bool {
        self.skip_blanks();
        let is_here = self.rest().starts_with(symbol);
        if is_here {
            self.position += symbol.len();
        }
        is_here
    }

    /// The imaginary unit, which no letter or digit follows.
    fn take_unit(&mut self) -> bool {
        self.skip_blanks();
        let mut letters = self.rest().chars();
        let is_unit = matches!(letters.next(), Some('I' | 'i' | 'j'))
            && !letters
                .next()
                .is_some_and(|c| c.is_alphanumeric() || c == '_');
        if is_unit {
            self.position += 1;
        }
        is_unit
    }

    /// The word that stands here.
    fn word(&self) -> (&'a str, Span) {
        let rest = self.rest();
        let apart = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '(' | ')' | '/' | '*');
        let first = rest.chars().next().map_or(0, char::len_utf8);
        let length = rest.find(apart).unwrap_or(rest.len()).max(first);
        let span = Span {
            start: self.position,
            end: self.position + length,
        };
        (&rest[..length], span)
    }

    fn unexpected(&mut self, expected: &str) -> Fault {
        self.skip_blanks();
        let (word, span) = self.word();
        let actual_input = match word {
            "" => "the end of the text".into(),
            word => format!("`{}`", shorten(word)),
        };
        Fault::expected(span, expected, actual_input)
    }

    /// A number, or several with equal spaces between.
    fn item(&mut self, values: &mut Vec<Complex64>) -> Result<(), Fault> {
        self.skip_blanks();
        let start = self.position;
        if !self.take("linspace") {
            return self.number_or_steps(start, values);
        }
        if !self.take("(") {
            return Err(self.unexpected("`(`, as in linspace(0, 1, 100)"));
        }
        let first = self.value(NUMBER)?;
        self.comma()?;
        let last = self.value(NUMBER)?;
        self.comma()?;
        let count = self.count()?;
        if !self.take(")") {
            return Err(self.unexpected("`)` after linspace(FIRST, LAST, COUNT"));
        }
        let span = self.since(start);
        let size = values.len() as u64 + u64::from(count);
        if size > limits::TARGETS.value {
            return Err(Fault::limit(span, limits::TARGETS, size));
        }
        let spaced = (0..count).map(|k| spaced(first, last, u64::from(k), u64::from(count)));
        extend(values, spaced, span)
    }

    /// A number, or FIRST:STEP:LAST.
    fn number_or_steps(&mut self, start: usize, values: &mut Vec<Complex64>) -> Result<(), Fault> {
        let mut numbers = vec![self.value(ITEM)?];
        while numbers.len() < 3 && self.take(":") {
            numbers.push(self.value(NUMBER)?);
        }
        let span = self.since(start);
        let range = match numbers[..] {
            [first] => return extend(values, std::iter::once(first), span),
            [first, step, last] => steps(first, step, last).map(|steps| (first, last, steps + 1)),
            _ => None,
        };
        let Some((first, last, count)) = range else {
            let expected = "FIRST:STEP:LAST with a whole number of steps, as in 0:0.1:1, or linspace(FIRST, LAST, COUNT)";
            let range = shorten(&self.text[span.start..span.end]);
            return Err(Fault::expected(span, expected, format!("`{range}`")));
        };
        let spaced = (0..count).map(|k| spaced(first, last, u64::from(k), u64::from(count)));
        extend(values, spaced, span)
    }

    fn since(&self, start: usize) -> Span {
        Span {
            start,
            end: self.position,
        }
    }

    fn comma(&mut self) -> Result<(), Fault> {
        match self.take(",") {
            true => Ok(()),
            false => Err(self.unexpected("`,`, as in linspace(0, 1, 100)")),
        }
    }

    /// Reads the number of values that are wanted.
    fn count(&mut self) -> Result<u32, Fault> {
        let expected = "a whole number from 1, as in linspace(0, 1, 100)";
        self.skip_blanks();
        let (word, span) = self.word();
        let is_whole = !word.is_empty() && word.bytes().all(|b| b.is_ascii_digit());
        if is_whole && word.parse().is_ok_and(|n: u64| n <= limits::TARGETS.value) {
            self.position = span.end;
            let count = word.parse().unwrap_or(0);
            return match count {
                0 => Err(Fault::expected(span, expected, "0")),
                count => Ok(count),
            };
        }
        match is_whole {
            true => Err(Fault::limit(span, limits::TARGETS, shorten(word))),
            false => Err(self.unexpected(expected)),
        }
    }

    /// A number, or an expression of constants such as `sqrt(2)` or `pi/4`.
    fn value(&mut self, expected: &str) -> Result<Complex64, Fault> {
        self.skip_blanks();
        let mut depth = 0_usize;
        let length = self.rest().find(|c| {
            match c {
                '(' => depth += 1,
                ')' if depth > 0 => depth -= 1,
                ',' | ':' | ')' if depth == 0 => return true,
                _ => {}
            }
            false
        });
        let text = &self.rest()[..length.unwrap_or(self.rest().len())];
        let end = self.position + text.len();
        let plain = self.number(expected);
        self.skip_blanks();
        if plain.is_ok() && self.position == end {
            return plain;
        }
        let Some(value) = constant(text) else {
            return plain;
        };
        self.position = end;
        Ok(value)
    }

    /// A sum of real and imaginary terms.
    fn number(&mut self, expected: &str) -> Result<Complex64, Fault> {
        self.skip_blanks();
        let start = self.position;
        let mut sum = Complex64::new(0.0, 0.0);
        let mut sign = self.sign().unwrap_or(1.0);
        loop {
            let (size, is_imaginary) = self.term(expected)?;
            match is_imaginary {
                true => sum.im += sign * size,
                false => sum.re += sign * size,
            }
            match self.sign() {
                Some(next) => sign = next,
                None if sum.is_finite() => return Ok(sum),
                None => {
                    let span = self.since(start);
                    return Err(Fault::expected(span, "a finite number", "one that is not"));
                }
            }
        }
    }

    fn sign(&mut self) -> Option<f64> {
        match (self.take("+"), self.take("-")) {
            (true, _) => Some(1.0),
            (_, true) => Some(-1.0),
            _ => None,
        }
    }

    /// The size of a term, and whether the imaginary unit is in it.
    fn term(&mut self, expected: &str) -> Result<(f64, bool), Fault> {
        if self.take_unit() {
            let size = match self.take("*") {
                true => self.quotient(expected)?,
                false => 1.0,
            };
            return Ok((size, true));
        }
        let size = self.quotient(expected)?;
        let before = self.position;
        self.take("*");
        if self.take_unit() {
            return Ok((size, true));
        }
        self.position = before;
        Ok((size, false))
    }

    fn quotient(&mut self, expected: &str) -> Result<f64, Fault> {
        let size = self.decimal(expected)?;
        match self.take("/") {
            true => Ok(size / self.decimal("a number as denominator")?),
            false => Ok(size),
        }
    }

    /// A decimal without sign.
    fn decimal(&mut self, expected: &str) -> Result<f64, Fault> {
        self.skip_blanks();
        let rest = self.rest().as_bytes();
        let digits = |from: usize| {
            let behind = rest.iter().skip(from);
            behind
                .take_while(|b| b.is_ascii_digit() || **b == b'.')
                .count()
        };
        let mut length = digits(0);
        if length > 0 && matches!(rest.get(length), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.get(length + 1), Some(b'+' | b'-')));
            let exponent = digits(length + 1 + sign);
            if exponent > 0 {
                length += 1 + sign + exponent;
            }
        }
        match decimal(&self.rest()[..length]) {
            Some(size) => {
                self.position += length;
                Ok(size)
            }
            None => Err(self.unexpected(expected)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(text: &str) -> Span {
        Span {
            start: 0,
            end: text.len(),
        }
    }

    fn listed(text: &str) -> Result<Vec<Complex64>, String> {
        list(text, whole(text)).map_err(|fault| fault.problem.to_string())
    }

    fn reals(values: &[f64]) -> Vec<Complex64> {
        values.iter().map(|x| Complex64::new(*x, 0.0)).collect()
    }

    #[test]
    fn numbers_and_equal_spaces_are_read() {
        assert_eq!(
            listed(" 0.5, 1 ,2e-3,-1/4"),
            Ok(reals(&[0.5, 1.0, 2e-3, -0.25]))
        );
        assert_eq!(
            listed("linspace(0.5, 2, 4), 7"),
            Ok(reals(&[0.5, 1.0, 1.5, 2.0, 7.0]))
        );
        let tenths = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
        assert_eq!(listed("linspace(0,1,11)"), Ok(reals(&tenths)));
        assert_eq!(listed("linspace(3, 4, 1)"), Ok(reals(&[3.0])));
        assert_eq!(listed("linspace(0.1, 0.1, 3)"), Ok(reals(&[0.1, 0.1, 0.1])));
        let complex = [(0.5, -2.0), (0.0, 1.0), (0.0, -0.5), (3.0, 0.25)];
        let complex: Vec<Complex64> = complex.map(|(re, im)| Complex64::new(re, im)).to_vec();
        assert_eq!(listed("0.5-2*I, I, -0.5i, 3 + I*1/4"), Ok(complex));
    }

    #[test]
    fn expressions_and_steps_are_values() {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, SQRT_2};
        assert_eq!(
            listed("linspace(0, pi, 3), sqrt(2), 2^3 - 1"),
            Ok(reals(&[0.0, FRAC_PI_2, PI, SQRT_2, 7.0]))
        );
        let quarters = [0.0, FRAC_PI_4, FRAC_PI_2, 3.0 * PI / 4.0, PI];
        assert_eq!(listed("0:pi/4:pi"), Ok(reals(&quarters)));
        assert_eq!(listed("1:-1/2:0, 4"), Ok(reals(&[1.0, 0.5, 0.0, 4.0])));
        assert_eq!(
            number("pi/2", whole("pi/2")),
            Ok(Complex64::new(FRAC_PI_2, 0.0))
        );
        for text in ["0:5", "0:10:1", "0:0:1", "1:1:1", "0:-1:3", "0:1e-9:1"] {
            let said = listed(text).expect_err(text);
            assert!(said.contains("expected FIRST:STEP:LAST"), "{text}: {said}");
        }
    }

    #[test]
    fn what_is_no_list_is_named() {
        for (text, expected) in [
            ("", "expected a number such as"),
            ("1,,2", "found `,`"),
            ("1 2", "expected `,` or the end of the values, found `2`"),
            ("1e999", "found `1e999`"),
            ("1/0", "expected a finite number"),
            ("two", "found `two`"),
            ("linspace 0,1", "expected `(`"),
            ("linspace(0,1)", "expected `,`"),
            ("linspace(0,1,0)", "expected a whole number from 1"),
            ("linspace(0,1,2.5)", "expected a whole number from 1"),
            ("linspace(0,1,-2)", "expected a whole number from 1"),
            ("linspace(0,1,5", "expected `)`"),
            ("linspace(0,1,1000001)", "limit TARGETS"),
            ("linspace(0,1,99999999999999999999999)", "limit TARGETS"),
            ("linspace(0,1,1000000), 3", "limit TARGETS"),
        ] {
            let said = listed(text).expect_err(text);
            assert!(said.contains(expected), "{text}: {said}");
        }
        let said = number("1+2", whole("1+2")).map(|z| z.re);
        assert_eq!(said, Ok(3.0));
        assert!(number("1,2", whole("1,2")).is_err());
    }
}
