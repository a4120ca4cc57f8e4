//! Directed rounding without switching the processor's mode: doubles by their rounding errors, MPFR by its own.

use super::double::{exact_double, nearest_of_many_digits};
use super::{MultiplePrecision, Real};
use crate::rational::Rational;
use rug::Float;
use rug::float::Round;

/// Side of the exact result on which a rounded result may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Toward {
    /// The rounded result is at most the exact result.
    Below,
    /// The rounded result is at least the exact result.
    Above,
}

/// A scalar whose operations can be rounded to either side; a bound of an interval.
///
/// Results are never on the wrong side. MPFR gives the nearest number on the right side, doubles
/// that one or the next. An operand that is not a number gives a result that is not one.
pub trait Directed: Real<Mask = bool, Control = f64> {
    /// A rational, rounded in this direction.
    fn rounded(context: Self::Context, value: &Rational, toward: Toward) -> Self;
    /// `a + b`.
    fn sum(a: &Self, b: &Self, toward: Toward) -> Self;
    /// `a - b`.
    fn difference(a: &Self, b: &Self, toward: Toward) -> Self;
    /// `a*b`.
    fn product(a: &Self, b: &Self, toward: Toward) -> Self;
    /// `a/b`.
    fn quotient(a: &Self, b: &Self, toward: Toward) -> Self;
    /// `sqrt(a)` for `a >= 0`.
    fn root(a: &Self, toward: Toward) -> Self;
    /// The value as a double, rounded in this direction.
    fn to_double(&self, toward: Toward) -> f64;
    /// Exact value of the number; `None` where it is not finite.
    fn to_rational(&self) -> Option<Rational>;
    /// `self < 0`.
    fn is_negative(&self) -> bool;
    /// `self > 0`.
    fn is_positive(&self) -> bool;
    /// Neither infinite nor NaN.
    fn is_finite(&self) -> bool;
}

/// `rounded` is the double nearest to a number that differs from it by something of the sign of
/// `error`; moves it to the wanted side of that number.
#[inline(always)]
fn to_side(rounded: f64, error: f64, toward: Toward) -> f64 {
    match toward {
        // Not `error >= 0.0`: an error that is not a number (after an overflow) moves it too.
        Toward::Below => {
            if error >= 0.0 {
                rounded
            } else {
                rounded.next_down()
            }
        }
        Toward::Above => {
            if error <= 0.0 {
                rounded
            } else {
                rounded.next_up()
            }
        }
    }
}

/// Moved one double to the wanted side, whatever the error was.
#[inline(always)]
fn beyond(rounded: f64, toward: Toward) -> f64 {
    match toward {
        Toward::Below => rounded.next_down(),
        Toward::Above => rounded.next_up(),
    }
}

impl Directed for f64 {
    fn rounded(_: (), value: &Rational, toward: Toward) -> f64 {
        if let Some(exact) = exact_double(value) {
            return exact;
        }
        let rounded = nearest_of_many_digits(value);
        match Rational::from_f64(rounded) {
            None => beyond(rounded, toward),
            Some(nearest) => match value.cmp(&nearest) {
                std::cmp::Ordering::Equal => rounded,
                std::cmp::Ordering::Less => to_side(rounded, -1.0, toward),
                std::cmp::Ordering::Greater => to_side(rounded, 1.0, toward),
            },
        }
    }
    #[inline(always)]
    fn sum(a: &f64, b: &f64, toward: Toward) -> f64 {
        // Knuth's error-free sum; exact also near underflow.
        let sum = a + b;
        let part = sum - a;
        to_side(sum, (a - (sum - part)) + (b - part), toward)
    }
    #[inline(always)]
    fn difference(a: &f64, b: &f64, toward: Toward) -> f64 {
        Self::sum(a, &-b, toward)
    }
    #[inline(always)]
    fn product(a: &f64, b: &f64, toward: Toward) -> f64 {
        let product = a * b;
        // No fused error term: outside of `dispatch` it would be a call of libm's fma.
        if *a == 0.0 || *b == 0.0 || a.abs() == 1.0 || b.abs() == 1.0 {
            product
        } else {
            beyond(product, toward)
        }
    }
    #[inline(always)]
    fn quotient(a: &f64, b: &f64, toward: Toward) -> f64 {
        let quotient = a / b;
        if b.abs() == 1.0 || (*a == 0.0 && *b != 0.0) {
            quotient
        } else {
            beyond(quotient, toward)
        }
    }
    #[inline(always)]
    fn root(a: &f64, toward: Toward) -> f64 {
        if *a == 0.0 || *a == 1.0 {
            *a
        } else {
            beyond(f64::sqrt(*a), toward).max(0.0)
        }
    }
    #[inline(always)]
    fn to_double(&self, _: Toward) -> f64 {
        *self
    }
    fn to_rational(&self) -> Option<Rational> {
        Rational::from_f64(*self)
    }
    #[inline(always)]
    fn is_negative(&self) -> bool {
        *self < 0.0
    }
    #[inline(always)]
    fn is_positive(&self) -> bool {
        *self > 0.0
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }
}

impl Toward {
    fn round(self) -> Round {
        match self {
            Self::Below => Round::Down,
            Self::Above => Round::Up,
        }
    }
}

impl Directed for MultiplePrecision {
    fn rounded(bits: u32, value: &Rational, toward: Toward) -> Self {
        Self(Float::with_val_round(bits, value, toward.round()).0)
    }
    fn sum(a: &Self, b: &Self, toward: Toward) -> Self {
        Self(Float::with_val_round(a.0.prec(), &a.0 + &b.0, toward.round()).0)
    }
    fn difference(a: &Self, b: &Self, toward: Toward) -> Self {
        Self(Float::with_val_round(a.0.prec(), &a.0 - &b.0, toward.round()).0)
    }
    fn product(a: &Self, b: &Self, toward: Toward) -> Self {
        Self(Float::with_val_round(a.0.prec(), &a.0 * &b.0, toward.round()).0)
    }
    fn quotient(a: &Self, b: &Self, toward: Toward) -> Self {
        Self(Float::with_val_round(a.0.prec(), &a.0 / &b.0, toward.round()).0)
    }
    fn root(a: &Self, toward: Toward) -> Self {
        Self(Float::with_val_round(a.0.prec(), a.0.sqrt_ref(), toward.round()).0)
    }
    fn to_double(&self, toward: Toward) -> f64 {
        self.0.to_f64_round(toward.round())
    }
    fn to_rational(&self) -> Option<Rational> {
        self.0.to_rational()
    }
    fn is_negative(&self) -> bool {
        self.0 < 0
    }
    fn is_positive(&self) -> bool {
        self.0 > 0
    }
    fn is_finite(&self) -> bool {
        self.0.is_finite()
    }
}
