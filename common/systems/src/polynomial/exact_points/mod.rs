//! ExactPoints: all solutions of equations with rational coefficients, real or complex, where these are finitely many and
//! few, without paths.
//!
//! The values of a linear form tell the solutions apart: they are the roots of a polynomial, and each unknown is a
//! quotient of two others there (F. Rouillier, Solving zero-dimensional systems through the rational univariate
//! representation, 1999). These polynomials are made modulo primes from Gröbner bases ([`image`]), put together ([`lifted`],
//! [`in_all_unknowns`]), and evaluated at the roots, which are isolated as those of an equation in one unknown are
//! ([`points`]). Solutions of one multiplicity have polynomials of their own. Equations of few terms and high degree are solved in
//! monomials of the unknowns ([`monomial_change`]); other constants than rational numbers and their square roots are replaced
//! by rational numbers near them ([`near_constants`]).

mod exact_point;
mod image;
mod in_all_unknowns;
mod lattice;
mod lifted;
mod monomial_change;
mod near_constants;
mod points;
mod rational_equations;
mod rational_solutions;
#[cfg(test)]
mod tests;

pub use exact_point::ExactPoint;

use super::solution_count::{NotCounted, has_rounded_numbers, is_chosen};
use crate::system::System;
use cognate_numeric::rational::ComplexRational;
use monomial_change::MonomialChange;
use num_complex::Complex64;
use rational_equations::RationalEquations;
use rational_solutions::solved;

/// Computes all solutions of a system at these values of its parameters, each with at least `digits` decimal digits,
/// within a budget of operations; `None` inside where they are infinitely many. Numbers count as exact, but with more
/// equations than unknowns those with many digits are refused (see `has_rounded_numbers`): their last digits do not
/// decide which points are near, or whether there are any. Other constants than rational numbers and their square roots
/// are allowed where no digits are asked for.
///
/// A polynomial that is put together from images is right but for primes that mislead, with odds of some 1e-8; the
/// equations hold at the points to half of the digits, which is checked.
pub fn exact_points(
    system: &System,
    parameters: &[Complex64],
    digits: u32,
    operations: u64,
) -> Result<Option<Vec<ExactPoint>>, NotCounted> {
    let is_square = system.equation_count() == system.dimension();
    let is_general = |value: &Complex64| {
        ComplexRational::from_doubles(*value).is_none_or(|value| !is_chosen(&value))
    };
    if !is_square && (has_rounded_numbers(system) || parameters.iter().any(is_general)) {
        return Err(NotCounted::NotExact);
    }
    match RationalEquations::of(system, parameters) {
        Ok(equations) => solved(&equations, digits, operations),
        Err(NotCounted::Constants) if digits == 0 => {
            near_constants::points(system, parameters, operations)
        }
        Err(reason) => Err(reason),
    }
}

/// Degrees of equations that are solved in monomials of the unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DegreesOfFewTerms {
    /// Largest degree of an equation.
    pub largest: u32,
    /// Product of the degrees of the equations in the monomials.
    pub product_in_monomials: u64,
    /// Number of solutions in the unknowns for each in the monomials.
    pub index: u128,
}

/// The degrees of the equations where all their solutions are those of equations of much lower degrees in monomials of the
/// unknowns, at these values of the parameters: few terms whose exponents are large.
pub fn degrees_of_few_terms(
    system: &System,
    parameters: &[Complex64],
) -> Option<DegreesOfFewTerms> {
    let equations = RationalEquations::of(system, parameters).ok()?;
    let change = MonomialChange::of(&equations)?;
    Some(DegreesOfFewTerms {
        largest: equations.degree(),
        product_in_monomials: change.changed(&equations).product_of_degrees(),
        index: change.index()?,
    })
}
