//! ExactPoints: all solutions of equations with real rational coefficients, where these are finitely many and few, without
//! paths.
//!
//! The values of a linear form tell the solutions apart: they are the roots of a polynomial, and each unknown is a
//! quotient of two others there (F. Rouillier, Solving zero-dimensional systems through the rational univariate
//! representation, 1999). These polynomials are made modulo primes from Gröbner bases ([`image`]), put together
//! ([`lifted`]), and evaluated at the roots, which are isolated as those of an equation in one unknown are ([`points`]).
//! Solutions of one multiplicity have polynomials of their own.

mod image;
mod lifted;
mod points;
mod rational_equations;
#[cfg(test)]
mod tests;

use super::primes::PrimesBelow;
use super::solution_count::NotCounted;
use super::solution_count::groebner::Budget;
use crate::system::System;
use cognate_numeric::rational::ComplexRational;
use image::{Images, LinearForm};
use lifted::Lifted;
use num_complex::Complex64;
use rational_equations::RationalEquations;

/// Primes begin below this: products of residues fit in 64 bits.
const PRIMES_BELOW: u64 = 1 << 31;
/// Linear forms that are tried: unknowns by themselves, whose polynomials have the smallest coefficients, and random ones.
const MOST_FORMS: usize = 6;
/// Primes one after another that show other solutions than the first did: it was the one that misleads.
const MOST_UNLUCKY: usize = 3;

/// One solution of equations with rational coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactPoint {
    /// The unknowns, to more digits than were asked for; a part is 0 where it is 0 as far as twice as many bits show.
    pub values: Vec<ComplexRational>,
    /// The unknowns, rounded to doubles.
    pub rounded: Vec<Complex64>,
    /// Dimension of the local ring at the point.
    pub multiplicity: u64,
    /// Whether all unknowns are real.
    pub is_real: bool,
    /// Largest residual of an equation at the rounded point, relative to the sum of its terms' absolute values.
    pub residual: f64,
    /// Condition number of the Jacobian, equations in units of their terms and unknowns in their own; infinite at a multiple
    /// solution.
    pub condition: f64,
    /// Bits of the arithmetic in which the unknowns were computed.
    pub precision_bits: u32,
}

/// All solutions of a system at these values of its parameters, each with at least so many decimal digits, in at most so
/// many operations; `None` inside where they are infinitely many.
///
/// A polynomial that is put together from images is right but for primes that mislead, with odds of some 1e-8; the
/// equations hold at the points to half of the digits, which is checked.
pub fn exact_points(
    system: &System,
    parameters: &[Complex64],
    digits: u32,
    operations: u64,
) -> Result<Option<Vec<ExactPoint>>, NotCounted> {
    let equations = RationalEquations::of(system, parameters)?;
    let mut budget = Budget(operations);
    for number in 0..MOST_FORMS {
        let form = LinearForm::numbered(number, equations.unknowns);
        let images = Images {
            equations: &equations,
            form: &form,
        };
        let lifted = match lift(&images, &mut budget).ok_or(NotCounted::Operations)? {
            Represented::Infinite => return Ok(None),
            Represented::ByOtherForm => continue,
            Represented::By(lifted) => lifted,
        };
        let points = points::points(&lifted, &equations, digits, &mut budget)
            .ok_or(NotCounted::Operations)?;
        if points.iter().all(|point| equations.hold_at(point)) {
            return Ok(Some(points));
        }
    }
    Err(NotCounted::Operations)
}

/// What comes of a linear form.
enum Represented {
    /// The solutions are infinitely many.
    Infinite,
    /// The form has one value at several solutions, or is too special at a multiple one.
    ByOtherForm,
    /// The polynomials.
    By(Lifted),
}

/// Puts images together until one more changes nothing; `None` where that takes more than the budget.
fn lift(images: &Images<'_>, budget: &mut Budget) -> Option<Represented> {
    let mut lifted: Option<Lifted> = None;
    let mut unlucky = 0;
    for prime in PrimesBelow::new(PRIMES_BELOW) {
        let image = match images.modulo(prime, lifted.is_none(), budget)? {
            image::Seen::Infinite => return Some(Represented::Infinite),
            image::Seen::NotSeparated if lifted.is_none() => return Some(Represented::ByOtherForm),
            image::Seen::NotSeparated | image::Seen::NoResidue => {
                unlucky += 1;
                if unlucky > MOST_UNLUCKY {
                    return Some(Represented::ByOtherForm);
                }
                continue;
            }
            image::Seen::Image(image) => image,
        };
        match &mut lifted {
            None => lifted = Some(Lifted::new(image)),
            Some(lifted) if !lifted.fits(&image) => {
                unlucky += 1;
                if unlucky > MOST_UNLUCKY {
                    return Some(Represented::ByOtherForm);
                }
            }
            Some(present) => {
                unlucky = 0;
                if present.take(&image, budget)? {
                    return lifted.map(Represented::By);
                }
            }
        }
    }
    None
}
