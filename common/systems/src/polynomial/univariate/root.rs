//! UnivariateRoot: one root with what is known of it, and how well the equations hold there.

use super::evaluation::RoundedPolynomial;
use super::exact_polynomial::ExactPolynomial;
use super::inclusion_discs::Approximation;
use super::wide::Wide;
use cognate_numeric::rational::ComplexRational;
use num_complex::Complex64;
use rug::{Complex, Float};
use std::cmp::Ordering;

/// Bits of residuals and condition numbers.
const BITS: u32 = 256;

/// A root of equations in one unknown.
#[derive(Clone, Debug)]
pub struct UnivariateRoot {
    /// The centre of a disc that holds this root and no other; a part is 0 only where the root's is.
    pub value: ComplexRational,
    /// The value rounded to doubles.
    pub rounded: Complex64,
    /// Radius of the disc, relative to the root.
    pub error: f64,
    /// Multiplicity of the root in the greatest common divisor of the equations.
    pub multiplicity: u32,
    /// Whether a denominator of the given equations is 0 there.
    pub is_removed: bool,
    /// Largest residual of an equation at the rounded value, relative to the sum of its terms' absolute values; infinite
    /// where no double is as large as the root.
    pub residual: f64,
    /// Ratio of the relative change of the root to the largest relative change of all coefficients of the greatest
    /// common divisor: sum of |a_k z^k| over |z p'(z)|. Infinite at a multiple root.
    pub condition: f64,
    /// Bits of the arithmetic in which the root was isolated.
    pub precision_bits: u32,
}

impl UnivariateRoot {
    /// The root 0.
    pub(super) fn zero(multiplicity: u32, is_removed: bool) -> Self {
        Self {
            value: ComplexRational::default(),
            rounded: Complex64::default(),
            error: 0.0,
            multiplicity,
            is_removed,
            residual: 0.0,
            condition: match multiplicity {
                1 => 1.0,
                _ => f64::INFINITY,
            },
            precision_bits: 53,
        }
    }

    /// Whether the root is real.
    pub fn is_real(&self) -> bool {
        self.value.is_real()
    }

    /// Compares by real, then by imaginary part.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        let by_real_part = self.value.re.cmp(&other.value.re);
        by_real_part.then_with(|| self.value.im.cmp(&other.value.im))
    }
}

/// The equations and their greatest common divisor, to be evaluated at roots.
pub(super) struct Equations {
    equations: Vec<RoundedPolynomial>,
    divisor: RoundedPolynomial,
}

impl Equations {
    pub fn new(equations: &[ExactPolynomial], divisor: &ExactPolynomial) -> Self {
        let rounded = |p: &ExactPolynomial| RoundedPolynomial::new(p, BITS);
        Self {
            equations: equations.iter().map(rounded).collect(),
            divisor: rounded(divisor),
        }
    }

    /// Describes the root in a disc: value, error, residual and condition number.
    pub fn root(
        &self,
        disc: &Approximation,
        multiplicity: u32,
        is_removed: bool,
    ) -> UnivariateRoot {
        let centre = &disc.centre;
        let exact = |part: &Float| part.to_rational().unwrap_or_default();
        let rounded = Complex64::new(centre.real().to_f64(), centre.imag().to_f64());
        let at_rounded = Complex::with_val(BITS, (rounded.re, rounded.im));
        let residuals = self.equations.iter().map(|equation| {
            if !rounded.is_finite() {
                return f64::INFINITY;
            }
            let at = equation.at(&at_rounded);
            match at.size.is_zero() {
                true => 0.0,
                false => Wide::of_complex(&at.value).over(at.size).to_f64(),
            }
        });
        UnivariateRoot {
            value: ComplexRational::new(exact(centre.real()), exact(centre.imag())),
            rounded,
            error: disc.radius.over(Wide::of_complex(centre)).to_f64(),
            multiplicity,
            is_removed,
            residual: residuals.fold(0.0, f64::max),
            condition: match multiplicity {
                1 => self.condition(centre),
                _ => f64::INFINITY,
            },
            precision_bits: centre.prec().0,
        }
    }

    /// The condition number of a simple root.
    fn condition(&self, centre: &Complex) -> f64 {
        let at = self.divisor.at(&Complex::with_val(BITS, centre));
        let slope = Wide::of_complex(&at.derivative).times(Wide::of_complex(centre));
        match slope.is_zero() {
            true => f64::INFINITY,
            false => at.size.over(slope).to_f64(),
        }
    }
}
