//! Evaluation: a polynomial and its derivative at a point in some bits, with a bound for what rounding does.

use super::exact_polynomial::ExactPolynomial;
use super::gaussian::GaussianInteger;
use super::wide::Wide;
use rug::ops::Pow;
use rug::{Complex, Float};

/// Bits of sums of absolute values.
const SIZE_BITS: u32 = 64;

/// The terms of a polynomial, rounded once, the highest first.
pub(super) struct RoundedPolynomial {
    bits: u32,
    terms: Vec<Term>,
}

struct Term {
    exponent: u32,
    coefficient: Complex,
    /// Absolute value of the coefficient.
    size: Float,
    /// Coefficient of the derivative.
    slope: Complex,
}

/// Value and derivative of a polynomial at a point, with a bound for the error.
pub(super) struct PolynomialValue {
    pub value: Complex,
    pub derivative: Complex,
    /// Sum of the absolute values of the terms.
    pub size: Wide,
    /// Bound for the error of the value.
    pub error: Wide,
}

impl RoundedPolynomial {
    /// The polynomial in this many bits.
    pub fn new(polynomial: &ExactPolynomial, bits: u32) -> Self {
        let rounded = |c: &GaussianInteger| Complex::with_val(bits, (&c.re, &c.im));
        let each = polynomial.coefficients.iter().enumerate().rev();
        let terms = each.filter(|(_, c)| !c.is_zero()).map(|(exponent, c)| {
            let exponent = exponent as u32;
            let coefficient = rounded(c);
            Term {
                exponent,
                size: Float::with_val(SIZE_BITS, coefficient.abs_ref()),
                slope: rounded(&c.times_integer(exponent)),
                coefficient,
            }
        });
        Self {
            bits,
            terms: terms.collect(),
        }
    }

    /// Number of terms.
    pub fn term_count(&self) -> usize {
        self.terms.len()
    }

    /// Absolute value of the leading coefficient.
    pub fn leading_size(&self) -> Wide {
        Wide::of_complex(&self.terms[0].coefficient)
    }

    /// By Horner's rule. Each term goes through at most two roundings for each term after it, each of a relative
    /// error below 2^(1 - bits), and so does each power between two terms.
    pub fn at(&self, z: &Complex) -> PolynomialValue {
        let bits = self.bits;
        let modulus = Float::with_val(SIZE_BITS, z.abs_ref());
        let (mut value, mut derivative) = (Complex::new(bits), Complex::new(bits));
        let mut size = Float::new(SIZE_BITS);
        let mut exponent = self.terms[0].exponent;
        for term in &self.terms {
            let gap = exponent - term.exponent;
            if gap == 1 {
                value *= z;
                size *= &modulus;
            } else if gap > 1 {
                value *= Complex::with_val(bits, z.pow(gap));
                size *= Float::with_val(SIZE_BITS, (&modulus).pow(gap));
            }
            value += &term.coefficient;
            size += &term.size;
            // The derivative is one power lower.
            if term.exponent > 0 {
                multiply_by_power(&mut derivative, z, gap);
                derivative += &term.slope;
            } else if gap > 1 {
                multiply_by_power(&mut derivative, z, gap - 1);
            }
            exponent = term.exponent;
        }
        multiply_by_power(&mut value, z, exponent);
        multiply_by_power(&mut derivative, z, exponent.saturating_sub(1));
        size *= Float::with_val(SIZE_BITS, (&modulus).pow(exponent));
        let size = Wide::of_float(&size);
        let roundings = Wide::new((8 * self.terms.len() + 16) as f64, -i64::from(bits));
        PolynomialValue {
            value,
            derivative,
            size,
            error: size.times(roundings),
        }
    }
}

fn multiply_by_power(value: &mut Complex, z: &Complex, exponent: u32) {
    match exponent {
        0 => {}
        1 => *value *= z,
        _ => *value *= Complex::with_val(value.prec(), z.pow(exponent)),
    }
}
