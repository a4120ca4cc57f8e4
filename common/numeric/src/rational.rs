//! Exact complex rationals: what the coefficients of a system are before any rounding.
//!
//! Input keeps decimals and fractions exactly in this form; every rung of the
//! precision ladder rounds them afresh (`Real::from_rational`).

use num_complex::Complex64;
pub use rug::Rational;
use serde::{Deserialize, Serialize};

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
