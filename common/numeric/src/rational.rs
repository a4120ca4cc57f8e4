//! Exact complex rationals: what the coefficients of a system are before any rounding.
//!
//! Input keeps decimals and fractions exactly in this form; every rung of the
//! precision ladder rounds them afresh (`Real::from_rational`).

use num_complex::Complex64;
use rug::Integer;
pub use rug::Rational;
use serde::{Deserialize, Serialize};

/// Most digits of a decimal that every double keeps.
const SHORT_DIGITS: usize = 15;
/// Part of all doubles of one size that are fractions with the largest denominator or a smaller one, at most.
const FRACTIONS_BY_CHANCE: f64 = 1e-6;

/// The decimal of at most 15 digits that is this double, or else the fraction with a small denominator.
fn short_number(value: f64) -> Option<Rational> {
    let exact = Rational::from_f64(value)?;
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e')?;
    let places = digits.split_once('.').map_or(0, |(_, places)| places.len());
    let integer: String = digits.chars().filter(|c| *c != '.').collect();
    let is_decimal = integer.trim_start_matches('-').len() <= SHORT_DIGITS;
    if !is_decimal {
        return short_fraction(value, &exact);
    }
    let power = exponent.parse::<i32>().ok()? - places as i32;
    let ten = Rational::from(Integer::from(Integer::u_pow_u(10, power.unsigned_abs())));
    let integer = Rational::from(integer.parse::<Integer>().ok()?);
    Some(match power < 0 {
        true => integer / ten,
        false => integer * ten,
    })
}

/// The first convergent of the continued fraction that rounds to this double, if its denominator is small.
fn short_fraction(value: f64, exact: &Rational) -> Option<Rational> {
    let last_place = value.abs() * f64::EPSILON;
    let mut before = [Integer::new(), Integer::from(1)];
    let mut last = [Integer::from(1), Integer::new()];
    let mut rest = exact.clone();
    loop {
        let whole = Integer::from(rest.floor_ref());
        let next = [0, 1].map(|k| Integer::from(&whole * &last[k]) + &before[k]);
        let denominator = next[1].to_f64();
        if denominator * denominator * last_place > FRACTIONS_BY_CHANCE {
            return None;
        }
        let is_exact_quotient = next[0].significant_bits() <= f64::MANTISSA_DIGITS;
        if is_exact_quotient && next[0].to_f64() / denominator == value {
            return Some(Rational::from((next[0].clone(), next[1].clone())));
        }
        let fraction = rest - &whole;
        if fraction == 0 {
            return None;
        }
        rest = fraction.recip();
        (before, last) = (last, next);
    }
}

/// `re + i*im` with both parts exact rationals in lowest terms.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ComplexRational {
    /// Real part.
    pub re: Rational,
    /// Imaginary part.
    pub im: Rational,
}

impl ComplexRational {
    /// `re + i*im`.
    pub fn new(re: impl Into<Rational>, im: impl Into<Rational>) -> Self {
        Self {
            re: re.into(),
            im: im.into(),
        }
    }

    /// A real number.
    pub fn real(re: impl Into<Rational>) -> Self {
        Self::new(re, 0)
    }

    /// Exactly what two doubles say; `None` for an infinity or what is no number.
    pub fn from_doubles(z: Complex64) -> Option<Self> {
        Some(Self {
            re: Rational::from_f64(z.re)?,
            im: Rational::from_f64(z.im)?,
        })
    }

    /// The short numbers that these doubles stand for: decimals of at most 15 digits, which differ from each other as
    /// doubles, or fractions with denominators so small that few doubles are any. `None` where a part is neither.
    pub fn from_short(z: Complex64) -> Option<Self> {
        Some(Self {
            re: short_number(z.re)?,
            im: short_number(z.im)?,
        })
    }

    /// The imaginary unit.
    pub fn i() -> Self {
        Self::new(0, 1)
    }

    /// True for exactly 0.
    pub fn is_zero(&self) -> bool {
        self.re == 0 && self.im == 0
    }

    /// True for exactly 1.
    pub fn is_one(&self) -> bool {
        self.re == 1 && self.im == 0
    }

    /// True when the imaginary part is exactly 0.
    pub fn is_real(&self) -> bool {
        self.im == 0
    }

    /// `re - i*im`.
    pub fn conjugate(&self) -> Self {
        Self::new(self.re.clone(), -self.im.clone())
    }

    /// `self + other`.
    pub fn add(&self, other: &Self) -> Self {
        Self::new(
            Rational::from(&self.re + &other.re),
            Rational::from(&self.im + &other.im),
        )
    }

    /// `self - other`.
    pub fn subtract(&self, other: &Self) -> Self {
        Self::new(
            Rational::from(&self.re - &other.re),
            Rational::from(&self.im - &other.im),
        )
    }

    /// `-self`.
    pub fn negate(&self) -> Self {
        Self::new(Rational::from(-&self.re), Rational::from(-&self.im))
    }

    /// `self * other`.
    pub fn multiply(&self, other: &Self) -> Self {
        Self::new(
            Rational::from(&self.re * &other.re) - Rational::from(&self.im * &other.im),
            Rational::from(&self.re * &other.im) + Rational::from(&self.im * &other.re),
        )
    }

    /// `self / other`, or `None` when `other` is 0.
    pub fn divide(&self, other: &Self) -> Option<Self> {
        if other.is_zero() {
            return None;
        }
        let modulus = Rational::from(&other.re * &other.re) + Rational::from(&other.im * &other.im);
        let product = self.multiply(&other.conjugate());
        Some(Self::new(product.re / &modulus, product.im / &modulus))
    }

    /// `self` to a nonnegative integer power, by repeated squaring.
    pub fn power(&self, exponent: u32) -> Self {
        let mut result = Self::real(1);
        let mut base = self.clone();
        let mut e = exponent;
        while e > 0 {
            if e & 1 == 1 {
                result = result.multiply(&base);
            }
            e >>= 1;
            if e > 0 {
                base = base.multiply(&base);
            }
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_stand_for_short_numbers() {
        let short = |value: f64| ComplexRational::from_short(Complex64::new(value, 0.0));
        let fraction = |p: i64, q: i64| Some(ComplexRational::real(Rational::from((p, q))));
        assert_eq!(short(0.0), fraction(0, 1));
        assert_eq!(short(0.1), fraction(1, 10));
        assert_eq!(short(-2.5e-3), fraction(-1, 400));
        assert_eq!(short(1.0 / 3.0), fraction(1, 3));
        assert_eq!(short(-355.0 / 113.0), fraction(-355, 113));
        assert_eq!(short(123_456_789.0), fraction(123_456_789, 1));
        let tiny = short(1e-300).unwrap().re;
        assert_eq!(*tiny.denom(), Integer::from(Integer::u_pow_u(10, 300)));
        for long in [0.1 + 0.2, 2.0f64.sqrt(), 0.123_456_789_012_345_67, f64::NAN] {
            assert_eq!(short(long), None, "{long}");
        }
    }
}
