//! ConstantAccuracy: how well constants are known that are computed from rounded decimals.
//!
//! Errors are absolute: a difference of decimals that are nearly equal keeps these errors and has a small value. Where
//! it is no larger than its error it may be 0.

use super::fault::Span;
use super::step::{Operation, Step};
use cognate_numeric::rational::Rational;
use rug::ops::Pow;

/// Largest power of a constant that is looked at.
const LARGEST_POWER: i32 = 64;
/// Most bits of a constant's numerator and denominator together.
const MOST_BITS: u32 = 1 << 14;

/// Factor for decimals that were computed from rounded ones and are off by a whole unit of the last digit, as 0.1 + 0.2 in
/// doubles is.
const MARGIN: f64 = 2.0;

/// A constant, its error, and the place where it became so small that it may be 0.
struct Constant {
    value: Rational,
    error: f64,
    may_be_zero: Option<Span>,
}

impl Constant {
    /// A constant that a step makes; `None` where it is too long.
    fn made(value: Rational, error: f64, place: Span) -> Option<Self> {
        let is_within = value != 0 && error > 0.0 && MARGIN * error >= size(&value);
        (bits(&value) <= MOST_BITS).then_some(Self {
            value,
            error,
            may_be_zero: is_within.then_some(place),
        })
    }
}

/// The accuracy of the constants in an expression.
#[derive(Default)]
pub(super) struct Accuracy {
    /// Largest relative error of a constant, at most 1.
    pub relative: f64,
    /// Place where the first constant that may be 0 is computed.
    pub may_be_zero: Option<Span>,
}

impl Accuracy {
    /// The accuracy of the constants in these steps, with numbers that have these relative errors.
    pub fn of(steps: &[Step], numbers: &[Rational], errors: &[f64]) -> Self {
        let mut accuracy = Self::default();
        let mut stack: Vec<Option<Constant>> = Vec::new();
        for step in steps {
            let made = match step.operation {
                Operation::Number(number) => {
                    let value = numbers[number as usize].clone();
                    let relative = errors.get(number as usize).copied().unwrap_or(0.0);
                    let error = relative * size(&value);
                    Constant::made(value, error, step.span)
                }
                Operation::Name(_) | Operation::ImaginaryUnit | Operation::Pi => None,
                Operation::Negate => stack.pop().flatten().map(|constant| Constant {
                    value: -constant.value,
                    ..constant
                }),
                Operation::Call(_) => {
                    accuracy.note(stack.pop().flatten().as_ref());
                    None
                }
                _ => {
                    let (right, left) = (stack.pop().flatten(), stack.pop().flatten());
                    let both = left.as_ref().zip(right.as_ref());
                    let made = both.and_then(|(left, right)| combined(*step, left, right));
                    if made.is_none() {
                        accuracy.note(left.as_ref());
                        accuracy.note(right.as_ref());
                    }
                    made
                }
            };
            stack.push(made);
        }
        for constant in &stack {
            accuracy.note(constant.as_ref());
        }
        accuracy
    }

    /// Takes a constant in that stands beside what is none.
    fn note(&mut self, constant: Option<&Constant>) {
        let Some(constant) = constant.filter(|constant| constant.value != 0) else {
            return;
        };
        let relative = match constant.may_be_zero {
            Some(_) => 1.0,
            None => constant.error / size(&constant.value),
        };
        self.relative = self.relative.max(relative);
        self.may_be_zero = self.may_be_zero.or(constant.may_be_zero);
    }
}

/// The constant that a sum, product, quotient or power makes of two.
fn combined(step: Step, left: &Constant, right: &Constant) -> Option<Constant> {
    let (a, b) = (&left.value, &right.value);
    let (value, error) = match step.operation {
        Operation::Add => (Rational::from(a + b), left.error + right.error),
        Operation::Subtract => (Rational::from(a - b), left.error + right.error),
        Operation::Multiply => {
            let error = size(a) * right.error + size(b) * left.error + left.error * right.error;
            (Rational::from(a * b), error)
        }
        Operation::Divide if *b != 0 => {
            let quotient = Rational::from(a / b);
            let error = (left.error + size(&quotient) * right.error) / size(b);
            (quotient, error)
        }
        Operation::Power if *a != 0 && b.is_integer() && right.error == 0.0 => {
            let exponent = b.numer().to_i32().filter(|n| n.abs() <= LARGEST_POWER)?;
            let times = exponent.unsigned_abs();
            if bits(a) * times.max(1) > MOST_BITS {
                return None;
            }
            let power = Rational::from(a.pow(exponent));
            let error = size(&power) * f64::from(times) * left.error / size(a);
            (power, error)
        }
        _ => return None,
    };
    let made = Constant::made(value, error, step.span)?;
    let before = left.may_be_zero.or(right.may_be_zero);
    Some(Constant {
        may_be_zero: made.may_be_zero.and(before).or(made.may_be_zero),
        ..made
    })
}

/// Absolute value of a number.
fn size(value: &Rational) -> f64 {
    value.to_f64().abs()
}

/// Bits of the numerator and the denominator of a number.
fn bits(value: &Rational) -> u32 {
    value.numer().significant_bits() + value.denom().significant_bits()
}

#[cfg(test)]
mod tests {
    use crate::formats::plain::typed;

    /// Differences keep the errors of their decimals; a constant that vanishes exactly is 0.
    #[test]
    fn constants_are_as_accurate_as_their_values() {
        let accuracy = |text: &str| {
            let problem = typed("t", text).expect(text);
            (problem.settings.data_accuracy, problem.warnings.len())
        };
        for (text, relative, warnings) in [
            ("(1.4142135623730950^2 - 2)*x^3 + x^2 = 4", 1.0, 1),
            ("(0.1 + 0.2 - 0.30000000000000004)*x^2 + x = 1", 1.0, 1),
            ("3*(1.4142135623730950*2/2 - sqrt(2)*x) = 1", 1.11e-16, 0),
            ("d = 1.23456789 - 1.23456788\nx + x*d = 1", 1.0, 1),
            ("(1.23456789 - 1.23456700)*x = 1", 1.0 / 89.0, 0),
            ("x^2*(1.00000000 + 2)/2 = 5", 5e-9, 0),
            ("(0.30000000 - 0.1 - 0.2)*x^2 + x = 1", 1.7e-8, 0),
            ("(0.1 + 0.2 - 0.3000001)*x^2 + x = 1.5", 0.0, 0),
            ("1.23456789^2 + x - 1.52415787 = 0", 8.1e-9, 0),
            ("x^3 + 1.23456789^99 = 2", 4.1e-9, 0),
        ] {
            let (said, count) = accuracy(text);
            assert!((said - relative).abs() <= 0.03 * relative, "{text}: {said}");
            assert_eq!(count, warnings, "{text}");
        }
    }
}
