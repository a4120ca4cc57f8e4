//! Equations in one unknown: all roots, with their multiplicities, proved.
//!
//! The equations are multiplied out ([`expand`]); their common divisor is split into square-free factors, exactly
//! ([`common_divisor`], [`square_free`]); the roots of each are found together ([`simultaneous_iteration`]) until discs
//! hold one each, as small as digits are wanted ([`inclusion_discs`]).

mod common_divisor;
mod evaluation;
mod exact_polynomial;
mod expand;
mod gaussian;
mod inclusion_discs;
mod root;
mod simultaneous_iteration;
mod square_free;
mod square_free_polynomial;
mod start_points;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_kinds;
mod wide;

pub use root::UnivariateRoot;
pub(super) use square_free_polynomial::{SquareFreePolynomial, isolated_roots_of};

use crate::system::System;
use crate::transform::clear_denominators::denominator_factors;
use cognate_numeric::rational::ComplexRational;
use common_divisor::common_divisor;
use exact_polynomial::ExactPolynomial;
use expand::expand;
use inclusion_discs::{Approximation, Wanted};
use root::Equations;
use simultaneous_iteration::{Budget, isolated_roots};
use square_free::{quotient, square_free_factors, symmetric_factors};

/// Bits beyond which a double is rounded the right way, but for numbers within 2^-10 of a unit beside the middle of two.
const BITS_OF_DOUBLES: u32 = 64;
/// Bits beyond those of the decimal digits that are asked for.
const MORE_BITS: u32 = 12;

/// All common roots of the equations.
#[derive(Clone, Debug)]
pub struct UnivariateRoots {
    /// Degree of the greatest common divisor of the equations: the number of roots with their multiplicities.
    pub degree: u32,
    /// Each root once, ascending by real and then by imaginary part.
    pub roots: Vec<UnivariateRoot>,
}

/// Reason why the roots are not found here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotSolved {
    /// The system has several unknowns, or one up to a factor.
    Unknowns,
    /// A coefficient is not rational, or the degree exceeds 4096.
    Coefficients,
    /// The roots take more operations than were allowed.
    TooLong,
}

/// Computes all roots of a system in one unknown, each with at least `digits` decimal digits, at these values of its
/// parameters, within `operations` (about one for each product of 64-bit numbers).
pub fn univariate_roots(
    system: &System,
    parameters: &[ComplexRational],
    digits: u32,
    operations: u64,
) -> Result<UnivariateRoots, NotSolved> {
    if system.variable_count() != 1 || system.groups.iter().any(|group| group.homogeneous) {
        return Err(NotSolved::Unknowns);
    }
    let expanded = |&node| expand(&system.expressions, node, parameters);
    let polynomials: Option<Vec<ExactPolynomial>> = system.equations.iter().map(expanded).collect();
    let factors = denominator_factors(system);
    let denominators: Option<Vec<ExactPolynomial>> = factors.iter().map(expanded).collect();
    let (polynomials, denominators) = polynomials
        .zip(denominators)
        .ok_or(NotSolved::Coefficients)?;
    if polynomials.iter().any(ExactPolynomial::is_zero) {
        return Err(NotSolved::Coefficients);
    }
    let divisor = polynomials[1..]
        .iter()
        .fold(polynomials[0].clone(), |divisor, next| {
            common_divisor(&divisor, next)
        });
    let finder = RootFinder {
        denominators,
        wanted: Wanted {
            // A decimal digit has less than 10/3 bits.
            bits: BITS_OF_DOUBLES.max(digits * 10 / 3 + MORE_BITS),
        },
        budget: Budget(operations),
        equations: Equations::new(&polynomials, &divisor),
        roots: Vec::new(),
    };
    finder.roots_of(&divisor).ok_or(NotSolved::TooLong)
}

struct RootFinder {
    denominators: Vec<ExactPolynomial>,
    wanted: Wanted,
    budget: Budget,
    equations: Equations,
    roots: Vec<UnivariateRoot>,
}

impl RootFinder {
    fn roots_of(mut self, divisor: &ExactPolynomial) -> Option<UnivariateRoots> {
        let (zeros, rest) = divisor.without_zero_root();
        if zeros > 0 {
            let is_removed = self
                .denominators
                .iter()
                .any(|d| d.without_zero_root().0 > 0);
            self.roots.push(UnivariateRoot::zero(zeros, is_removed));
        }
        if rest.degree() > 0 {
            let denominators = self.denominators.clone();
            for factor in square_free_factors(&rest) {
                let mut left = factor.polynomial;
                for denominator in &denominators {
                    let removed = common_divisor(&left, denominator);
                    left = quotient(&left, &removed);
                    self.add_roots(&removed, factor.multiplicity, true)?;
                }
                self.add_roots(&left, factor.multiplicity, false)?;
            }
        }
        let degree = divisor.degree() as u32;
        let with_multiplicity: u32 = self.roots.iter().map(|root| root.multiplicity).sum();
        assert_eq!(
            with_multiplicity, degree,
            "a polynomial has as many roots as its degree"
        );
        self.roots.sort_by(UnivariateRoot::compare);
        Some(UnivariateRoots {
            degree,
            roots: self.roots,
        })
    }

    /// Adds the roots of a square-free polynomial.
    fn add_roots(
        &mut self,
        polynomial: &ExactPolynomial,
        multiplicity: u32,
        is_removed: bool,
    ) -> Option<()> {
        if polynomial.degree() == 0 {
            return Some(());
        }
        for factor in symmetric_factors(polynomial) {
            let mut discs = isolated_roots(&factor, &self.wanted, &mut self.budget)?;
            if factor.is_real {
                discs = with_exact_conjugates(discs);
            }
            for disc in &discs {
                let root = self.equations.root(disc, multiplicity, is_removed);
                self.roots.push(root);
            }
        }
        Some(())
    }
}

/// The discs of a polynomial whose roots are closed under conjugation: those below the real axis are the images of those
/// above.
fn with_exact_conjugates(discs: Vec<Approximation>) -> Vec<Approximation> {
    let count = discs.len();
    let below = discs
        .iter()
        .filter(|disc| disc.centre.imag().is_sign_negative());
    let below = below.filter(|disc| !disc.centre.imag().is_zero()).count();
    let mut closed = Vec::with_capacity(count);
    for disc in discs {
        if disc.centre.imag().is_zero() {
            closed.push(disc);
        } else if disc.centre.imag().is_sign_positive() {
            closed.push(Approximation {
                centre: disc.centre.clone().conj(),
                radius: disc.radius,
            });
            closed.push(disc);
        }
    }
    let real = closed
        .iter()
        .filter(|disc| disc.centre.imag().is_zero())
        .count();
    assert_eq!(
        real + 2 * below,
        closed.len(),
        "each root above the axis has one below"
    );
    assert_eq!(closed.len(), count, "each root is in one disc");
    closed
}
