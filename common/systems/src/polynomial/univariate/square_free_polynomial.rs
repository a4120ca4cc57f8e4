//! SquareFreePolynomial: a polynomial with rational coefficients and simple roots, whose roots another computation needs.

use super::common_divisor::common_divisor;
use super::exact_polynomial::ExactPolynomial;
use super::inclusion_discs::Wanted;
use super::simultaneous_iteration::{Budget, isolated_roots};
use super::square_free::{quotient, symmetric_factors};
use super::with_exact_conjugates;
use cognate_numeric::rational::ComplexRational;
use rug::Complex;

/// A polynomial up to a constant factor.
pub(in crate::polynomial) struct SquareFreePolynomial(ExactPolynomial);

impl SquareFreePolynomial {
    /// The polynomial with these coefficients, that of 1 first.
    pub fn new(coefficients: &[ComplexRational]) -> Self {
        Self(ExactPolynomial::from_rationals(coefficients))
    }

    /// The degree; 0 of the zero polynomial, too.
    pub fn degree(&self) -> usize {
        self.0.degree()
    }

    /// The greatest common divisor with another polynomial, and what is left without it.
    pub fn split_by(&self, other: &Self) -> (Self, Self) {
        let common = common_divisor(&self.0, &other.0);
        let rest = quotient(&self.0, &common);
        (Self(common), Self(rest))
    }
}

/// The roots of a square-free polynomial, each part that is not 0 to `bits` bits; those that are not real in exact
/// pairs of conjugates. `None` where it takes more operations than are left.
pub(in crate::polynomial) fn isolated_roots_of(
    polynomial: &SquareFreePolynomial,
    bits: u32,
    operations: &mut u64,
) -> Option<Vec<Complex>> {
    let mut budget = Budget(*operations);
    let (zeros, rest) = polynomial.0.without_zero_root();
    let mut roots = vec![Complex::new(bits); zeros as usize];
    if rest.degree() > 0 {
        for factor in symmetric_factors(&rest) {
            let discs = isolated_roots(&factor, &Wanted { bits }, &mut budget)?;
            let discs = match factor.is_real {
                true => with_exact_conjugates(discs),
                false => discs,
            };
            roots.extend(discs.into_iter().map(|disc| disc.centre));
        }
    }
    *operations = budget.0;
    Some(roots)
}
