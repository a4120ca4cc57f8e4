//! ExactPoints: all solutions of equations with rational coefficients, real or complex, where these are finitely many and
//! few, without paths.
//!
//! The values of a linear form tell the solutions apart: they are the roots of a polynomial, and each unknown is a
//! quotient of two others there (F. Rouillier, Solving zero-dimensional systems through the rational univariate
//! representation, 1999). These polynomials are made modulo primes from Gröbner bases ([`image`]), put together
//! ([`lifted`]), and evaluated at the roots, which are isolated as those of an equation in one unknown are ([`points`]).
//! Solutions of one multiplicity have polynomials of their own. Equations of few terms and high degree are solved in
//! monomials of the unknowns ([`monomial_change`]); other constants than rational numbers and their square roots are replaced
//! by rational numbers near them ([`near_constants`]).

mod image;
mod lattice;
mod lifted;
mod monomial_change;
mod near_constants;
mod points;
mod rational_equations;
#[cfg(test)]
mod tests;

use super::primes::PrimesBelow;
use super::solution_count::groebner::Budget;
use super::solution_count::prime_field::PrimeField;
use super::solution_count::{NotCounted, has_rounded_numbers, is_chosen};
use crate::system::System;
use cognate_numeric::rational::{ComplexRational, Rational};
use image::{Images, LinearForm, Seen};
use lifted::Lifted;
use monomial_change::MonomialChange;
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

/// Computes all solutions of equations, each with at least `digits` decimal digits, within the budget.
fn solved(
    equations: &RationalEquations,
    digits: u32,
    operations: u64,
) -> Result<Option<Vec<ExactPoint>>, NotCounted> {
    let mut budget = Budget(operations);
    let points = match MonomialChange::of(equations) {
        Some(change) => change.points(equations, digits, &mut budget)?,
        None => exact_points_in_all_unknowns(equations, digits, &mut budget)?,
    };
    Ok(points.map(|points| with_positive_roots(points, equations)))
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

/// All solutions, those of square roots of numbers with either sign.
fn exact_points_in_all_unknowns(
    equations: &RationalEquations,
    digits: u32,
    budget: &mut Budget,
) -> Result<Option<Vec<ExactPoint>>, NotCounted> {
    for number in 0..MOST_FORMS {
        let form = LinearForm::numbered(number, equations.unknowns);
        let images = Images {
            equations,
            form: &form,
        };
        let classes = match lift(&images, budget).ok_or(NotCounted::Operations)? {
            Represented::Infinite => return Ok(None),
            Represented::ByOtherForm => continue,
            Represented::By(classes) => classes,
        };
        let points =
            points::points(&classes, equations, digits, budget).ok_or(NotCounted::Operations)?;
        if points.iter().all(|point| equations.hold_at(point)) {
            return Ok(Some(points));
        }
    }
    Err(NotCounted::NotSeparated)
}

/// The points where each square root of a number is the positive one, without these unknowns.
fn with_positive_roots(
    mut points: Vec<ExactPoint>,
    equations: &RationalEquations,
) -> Vec<ExactPoint> {
    points.retain(|point| equations.has_positive_roots(point));
    for point in &mut points {
        point.values.truncate(equations.square_roots.start);
        point.rounded.truncate(equations.square_roots.start);
    }
    points
}

/// Result of representing the solutions by the values of a linear form.
enum Represented {
    /// The solutions are infinitely many.
    Infinite,
    /// The form has one value at several solutions, or is too special at a multiple one.
    ByOtherForm,
    /// The polynomials that represent the solutions, by multiplicity.
    By(Vec<PointClass>),
}

/// The solutions of one multiplicity.
struct PointClass {
    multiplicity: u64,
    /// Polynomial whose roots are the values of the linear form; the leading coefficient is 1.
    polynomial: Vec<ComplexRational>,
    /// For each unknown, a polynomial: divided by the derivative of `polynomial`, it is the value of the unknown at
    /// each root.
    numerators: Vec<Vec<ComplexRational>>,
}

/// Puts images together until one more changes nothing; `None` where that takes more than the budget.
fn lift(images: &Images<'_>, budget: &mut Budget) -> Option<Represented> {
    let is_real = images.equations.is_real();
    let mut lifted: Option<Vec<Lifted>> = None;
    let mut unlucky = 0;
    for prime in PrimesBelow::new(PRIMES_BELOW) {
        let field = PrimeField::new(prime);
        let i = match is_real {
            true => 0,
            false => match field.root_of_minus_one() {
                Some(i) => i,
                None => continue,
            },
        };
        let is_first = lifted.is_none();
        let parts = match images.modulo(field, i, is_first, budget)? {
            Seen::Infinite => return Some(Represented::Infinite),
            Seen::NotSeparated if is_first => return Some(Represented::ByOtherForm),
            Seen::NotSeparated | Seen::NoResidue => None,
            Seen::Image(image) if is_real => Some(vec![image]),
            Seen::Image(image) => match images.modulo(field, prime - i, false, budget)? {
                Seen::Image(conjugate) => image.parts(&conjugate, i).map(Vec::from),
                Seen::Infinite | Seen::NotSeparated | Seen::NoResidue => None,
            },
        };
        let fitting = parts.filter(|parts| match &lifted {
            Some(lifted) => lifted
                .iter()
                .zip(parts)
                .all(|(part, image)| part.fits(image)),
            None => true,
        });
        let Some(parts) = fitting else {
            unlucky += 1;
            if unlucky > MOST_UNLUCKY {
                return Some(Represented::ByOtherForm);
            }
            continue;
        };
        unlucky = 0;
        let Some(present) = &mut lifted else {
            lifted = Some(parts.into_iter().map(Lifted::new).collect());
            continue;
        };
        let mut confirmed = true;
        for (part, image) in present.iter_mut().zip(&parts) {
            confirmed &= part.take(image, budget)?;
        }
        if confirmed {
            return Some(Represented::By(point_classes(present)));
        }
    }
    None
}

/// Joins the real and, where there are some, the imaginary parts of all coefficients.
fn point_classes(parts: &[Lifted]) -> Vec<PointClass> {
    let [real, imaginary @ ..] = parts else {
        return Vec::new();
    };
    let complex = |re: &[Rational], im: Option<&Vec<Rational>>| -> Vec<ComplexRational> {
        let imaginary = |k: usize| im.map_or_else(Rational::new, |im| im[k].clone());
        let each = re.iter().enumerate();
        each.map(|(k, re)| ComplexRational::new(re.clone(), imaginary(k)))
            .collect()
    };
    let classes = real.classes().iter().enumerate().map(|(c, re)| {
        let im = imaginary.first().map(|part| &part.classes()[c]);
        let mut polynomial = complex(&re.polynomial, im.map(|im| &im.polynomial));
        polynomial.push(ComplexRational::real(1));
        let numerators = re.numerators.iter().enumerate();
        PointClass {
            multiplicity: re.multiplicity,
            polynomial,
            numerators: numerators
                .map(|(k, re)| complex(re, im.map(|im| &im.numerators[k])))
                .collect(),
        }
    });
    classes.collect()
}
