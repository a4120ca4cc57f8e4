//! Square-free factors: the roots of one multiplicity, and which of them may be real or imaginary.

use super::common_divisor::common_divisor;
use super::exact_polynomial::ExactPolynomial;

/// A square-free polynomial whose roots are those of one multiplicity.
pub(super) struct SquareFreeFactor {
    pub polynomial: ExactPolynomial,
    pub multiplicity: u32,
}

/// The square-free factors of a polynomial, by multiplicity (D. Musser, Algorithms for polynomial factorization, 1971;
/// Yun's are the same).
pub(super) fn square_free_factors(polynomial: &ExactPolynomial) -> Vec<SquareFreeFactor> {
    let mut factors = Vec::new();
    let mut rest = common_divisor(polynomial, &polynomial.derivative());
    // The product of all factors whose multiplicity is at least the present one.
    let mut product = quotient(polynomial, &rest);
    let mut multiplicity = 1;
    while product.degree() > 0 {
        let next = match rest.degree() {
            0 => rest.clone(),
            _ => common_divisor(&product, &rest),
        };
        let factor = quotient(&product, &next);
        if factor.degree() > 0 {
            factors.push(SquareFreeFactor {
                polynomial: factor,
                multiplicity,
            });
        }
        if next.degree() > 0 {
            rest = quotient(&rest, &next);
        }
        product = next;
        multiplicity += 1;
    }
    factors
}

/// The quotient by a divisor of the polynomial.
pub(super) fn quotient(polynomial: &ExactPolynomial, divisor: &ExactPolynomial) -> ExactPolynomial {
    if divisor.degree() == 0 {
        return polynomial.clone();
    }
    let quotient = polynomial.divided_by(divisor);
    quotient.expect("the divisor was found to divide the polynomial")
}

/// A square-free polynomial whose set of roots has these symmetries, or no root on their axis.
pub(super) struct SymmetricFactor {
    pub polynomial: ExactPolynomial,
    /// The roots are closed under conjugation; otherwise none is real.
    pub is_real: bool,
    /// The roots are closed under z -> -z̄; otherwise none is imaginary.
    pub is_mirrored: bool,
}

/// The factors of a square-free polynomial by the symmetries of their roots.
pub(super) fn symmetric_factors(polynomial: &ExactPolynomial) -> Vec<SymmetricFactor> {
    let real = match polynomial.is_real() {
        true => polynomial.clone(),
        false => common_divisor(polynomial, &polynomial.conjugate()).with_positive_leading(),
    };
    assert!(
        real.is_real(),
        "roots closed under conjugation have a real monic polynomial"
    );
    let rest = quotient(polynomial, &real);
    let mut factors = Vec::new();
    for (factor, is_real) in [(real, true), (rest, false)] {
        if factor.degree() == 0 {
            continue;
        }
        let mirrored = common_divisor(&factor, &factor.mirrored());
        let others = quotient(&factor, &mirrored);
        for (polynomial, is_mirrored) in [(mirrored, true), (others, false)] {
            if polynomial.degree() > 0 {
                factors.push(SymmetricFactor {
                    polynomial,
                    is_real,
                    is_mirrored,
                });
            }
        }
    }
    factors
}
