//! Solutions in all unknowns of the equations: represented by the values of a linear form, and computed from the
//! representation.

use super::exact_point::{ExactPoint, PointClass};
use super::image::{Images, LinearForm, Seen};
use super::lifted::Lifted;
use super::points;
use super::rational_equations::RationalEquations;
use crate::polynomial::primes::PrimesBelow;
use crate::polynomial::solution_count::NotCounted;
use crate::polynomial::solution_count::groebner::Budget;
use crate::polynomial::solution_count::prime_field::PrimeField;
use cognate_numeric::rational::{ComplexRational, Rational};

/// Primes begin below this: products of residues fit in 64 bits.
const PRIMES_BELOW: u64 = 1 << 31;
/// Linear forms that are tried: unknowns by themselves, whose polynomials have the smallest coefficients, and random ones.
const MOST_FORMS: usize = 6;
/// Primes one after another that show other solutions than the first did: it was the one that misleads.
const MOST_UNLUCKY: usize = 3;

/// All solutions, those of square roots of numbers with either sign.
pub(super) fn exact_points_in_all_unknowns(
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

/// Result of representing the solutions by the values of a linear form.
enum Represented {
    /// The solutions are infinitely many.
    Infinite,
    /// The form has one value at several solutions, or is too special at a multiple one.
    ByOtherForm,
    /// The polynomials that represent the solutions, by multiplicity.
    By(Vec<PointClass>),
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
