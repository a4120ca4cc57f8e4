//! Image: the solutions modulo one prime, as polynomials in one unknown: the value of a linear form.

use super::rational_equations::RationalEquations;
use crate::polynomial::solution_count::dimension;
use crate::polynomial::solution_count::groebner::{Budget, groebner_basis};
use crate::polynomial::solution_count::prime_field::PrimeField;
use crate::polynomial::solution_count::quotient::{Multiplication, Quotient};
use crate::polynomial::solution_count::residue_polynomial::{
    common_divisor, derivative, divide, inverse_modulo, product, recurrence,
};
use cognate_numeric::random::{Purpose, RandomStream};

/// Unknowns that are tried by themselves before forms in all of them.
const SINGLE_UNKNOWNS: usize = 3;
/// Coefficients of forms in all unknowns are below this: small ones keep the polynomials small.
const COEFFICIENTS_BELOW: u64 = 100;

/// A sum of unknowns with whole coefficients.
pub(super) struct LinearForm {
    coefficients: Vec<u64>,
    /// Whether the form is one unknown by itself.
    is_single: bool,
}

impl LinearForm {
    /// The form that is tried after this many others.
    pub fn numbered(number: usize, unknowns: usize) -> Self {
        let is_single = number < SINGLE_UNKNOWNS.min(unknowns);
        let mut stream = RandomStream::new(number as u64, Purpose::Probe, unknowns as u64);
        let coefficients = (0..unknowns).map(|k| match is_single {
            true => u64::from(k + number + 1 == unknowns),
            false => 1 + stream.below(COEFFICIENTS_BELOW),
        });
        Self {
            coefficients: coefficients.collect(),
            is_single,
        }
    }
}

/// The solutions of one multiplicity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ClassImage {
    pub multiplicity: u64,
    /// Polynomial whose roots are the values of the form; the leading coefficient is 1.
    pub polynomial: Vec<u64>,
    /// For each unknown, a polynomial: divided by the derivative of `polynomial`, it is the value of the unknown at
    /// each root.
    pub numerators: Vec<Vec<u64>>,
}

/// All solutions modulo one prime.
pub(super) struct Image {
    pub field: PrimeField,
    /// Ascending by multiplicity.
    pub classes: Vec<ClassImage>,
}

/// Result of the computation modulo one prime.
pub(super) enum Seen {
    /// The solutions are infinitely many.
    Infinite,
    /// A coefficient has no residue.
    NoResidue,
    /// The form has one value at several solutions, or is too special at a multiple one.
    NotSeparated,
    /// The solutions modulo the prime.
    Image(Image),
}

/// Equations and linear form from which images are computed.
pub(super) struct Images<'a> {
    pub equations: &'a RationalEquations,
    pub form: &'a LinearForm,
}

impl Images<'_> {
    /// The solutions modulo a prime, with this square root of -1 in the place of i; `is_first`: whether the form tells them
    /// apart is to be checked. `None` where it takes more than the budget.
    pub fn modulo(
        &self,
        field: PrimeField,
        i: u64,
        is_first: bool,
        budget: &mut Budget,
    ) -> Option<Seen> {
        let Some(equations) = self.equations.modulo(field, i) else {
            return Some(Seen::NoResidue);
        };
        let variables = self.equations.variables();
        let basis = groebner_basis(field, equations, budget)?;
        if is_first && dimension(variables, &basis, budget)? > 0 {
            return Some(Seen::Infinite);
        }
        let quotient = Quotient::new(field, variables, &basis, budget)?;
        if quotient.dimension() == 0 {
            let classes = Vec::new();
            return Some(Seen::Image(Image { field, classes }));
        }
        let distinct = match is_first {
            true => Some(quotient.distinct_zeros(budget)?),
            false => None,
        };
        let image = self.image(&quotient, distinct, budget)?;
        Some(image.map_or(Seen::NotSeparated, Seen::Image))
    }

    /// The solutions by the form, modulo the prime of the quotient; `distinct`: how many values of the form there are to be,
    /// where that is known. `None` inside where it has not as many, or is too special.
    fn image(
        &self,
        quotient: &Quotient<'_>,
        distinct: Option<usize>,
        budget: &mut Budget,
    ) -> Option<Option<Image>> {
        let (field, size) = (quotient.field(), quotient.dimension());
        let forms = quotient.normal_forms(budget)?;
        // Variables of inverses come first.
        let variables = self.equations.variables();
        let inverses = variables - self.equations.unknowns;
        let mut coefficients = vec![0; inverses];
        coefficients.extend(&self.form.coefficients);
        let multiplication = forms.linear_form(&coefficients, budget)?;
        let mut stream = RandomStream::new(2, Purpose::Probe, size as u64);
        let functional: Vec<u64> = (0..size).map(|_| stream.below(field.prime())).collect();
        let powers = multiplication.powers(2 * size, budget)?;
        let of_one: Vec<u64> = powers.iter().map(|p| field.dot(p, &functional)).collect();
        let minimal = recurrence(field, &of_one)?;
        let common = common_divisor(field, minimal.clone(), derivative(field, &minimal))?;
        let separated = minimal.len() - common.len();
        let is_simple = separated == size;
        // At a multiple solution the powers of one unknown need not reach the ring's last elements.
        let is_special = !is_simple && self.form.is_single && self.equations.unknowns > 1;
        if is_special || distinct.is_some_and(|distinct| distinct != separated) {
            return Some(None);
        }
        let degree = minimal.len() - 1;
        let of_unknowns = (inverses..variables).map(|k| {
            let mut unknown = vec![0; variables];
            unknown[k] = 1;
            let rows = forms.linear_form(&unknown, budget)?.rows;
            let values: Vec<u64> = rows.iter().map(|row| field.dot(row, &functional)).collect();
            let powers = powers[..degree].iter();
            Some(powers.map(|power| field.dot(power, &values)).collect())
        });
        let of_unknowns: Vec<Vec<u64>> = of_unknowns.collect::<Option<_>>()?;
        let factors = match is_simple {
            true => vec![Factor {
                multiplicity: 1,
                polynomial: minimal.clone(),
            }],
            false => {
                let characteristic = characteristic_polynomial(field, multiplication, budget)?;
                square_free_factors(field, characteristic)?
            }
        };
        let series = Series {
            minimal: &minimal,
            of_one: &of_one[..degree],
            of_unknowns: &of_unknowns,
        };
        let classes = series.classes(field, factors);
        Some(classes.map(|classes| Image { field, classes }))
    }
}

/// The values of the form at solutions of one multiplicity.
struct Factor {
    multiplicity: u64,
    /// Polynomial whose roots are these values; the leading coefficient is 1.
    polynomial: Vec<u64>,
}

/// Values of a functional at powers of the form, and at each unknown times these.
struct Series<'a> {
    /// The minimal polynomial of the form.
    minimal: &'a [u64],
    of_one: &'a [u64],
    of_unknowns: &'a [Vec<u64>],
}

impl Series<'_> {
    /// The unknowns at the roots of each factor; `None` where the functional is 0 at a root.
    ///
    /// The generating series of the values has poles at the roots, whose leading coefficients are in the ratio of the
    /// unknown (A. Bostan, B. Salvy, É. Schost, Fast algorithms for zero-dimensional polynomial systems using duality,
    /// 2003).
    fn classes(&self, field: PrimeField, factors: Vec<Factor>) -> Option<Vec<ClassImage>> {
        let numerator = |series: &[u64]| numerator_of_series(field, self.minimal, series);
        let denominator = numerator(self.of_one);
        let numerators: Vec<Vec<u64>> = self.of_unknowns.iter().map(|s| numerator(s)).collect();
        let of_factor = |factor: Factor| {
            let polynomial = factor.polynomial;
            let inverse = inverse_modulo(field, &denominator, &polynomial)?;
            let slope = derivative(field, &polynomial);
            let (_, scale) = divide(field, product(field, &inverse, &slope), &polynomial)?;
            let numerators = numerators.iter().map(|numerator| {
                let (_, numerator) = divide(field, numerator.clone(), &polynomial)?;
                let (_, mut rest) = divide(field, product(field, &numerator, &scale), &polynomial)?;
                rest.resize(polynomial.len() - 1, 0);
                Some(rest)
            });
            Some(ClassImage {
                multiplicity: factor.multiplicity,
                numerators: numerators.collect::<Option<_>>()?,
                polynomial,
            })
        };
        factors.into_iter().map(of_factor).collect()
    }
}

/// The polynomial part of a series in 1/T times the polynomial whose degree is the number of its terms.
fn numerator_of_series(field: PrimeField, minimal: &[u64], series: &[u64]) -> Vec<u64> {
    let degree = minimal.len() - 1;
    let mut numerator = vec![0; degree];
    for (j, &c) in minimal.iter().enumerate() {
        for (i, &s) in series.iter().enumerate().take(j) {
            let place = &mut numerator[j - 1 - i];
            *place = field.reduce(*place + c * s);
        }
    }
    numerator
}

/// The square-free factors by multiplicity, each with leading coefficient 1 (D. Musser, 1971); the degree is below the
/// prime.
fn square_free_factors(field: PrimeField, polynomial: Vec<u64>) -> Option<Vec<Factor>> {
    let mut rest = common_divisor(field, polynomial.clone(), derivative(field, &polynomial))?;
    let (mut roots, _) = divide(field, polynomial, &rest)?;
    let mut factors = Vec::new();
    let mut multiplicity = 1;
    while roots.len() > 1 {
        let next = common_divisor(field, roots.clone(), rest.clone())?;
        let (factor, _) = divide(field, roots, &next)?;
        if factor.len() > 1 {
            let inverse = field.inverse(*factor.last()?)?;
            let monic = factor.iter().map(|&c| field.multiply(c, inverse));
            factors.push(Factor {
                multiplicity,
                polynomial: monic.collect(),
            });
        }
        (rest, _) = divide(field, rest, &next)?;
        roots = next;
        multiplicity += 1;
    }
    Some(factors)
}

/// The characteristic polynomial, by Hessenberg's form (H. Cohen, A course in computational algebraic number theory,
/// 1993, algorithm 2.2.9).
fn characteristic_polynomial(
    field: PrimeField,
    multiplication: Multiplication,
    budget: &mut Budget,
) -> Option<Vec<u64>> {
    let mut rows = multiplication.rows;
    let size = rows.len();
    budget.take(size.checked_pow(3)?.checked_mul(2)?)?;
    for m in 1..size.saturating_sub(1) {
        let Some(pivot) = (m..size).find(|&i| rows[i][m - 1] != 0) else {
            continue;
        };
        rows.swap(pivot, m);
        rows.iter_mut().for_each(|row| row.swap(pivot, m));
        let inverse = field.inverse(rows[m][m - 1])?;
        for i in m + 1..size {
            let factor = field.multiply(rows[i][m - 1], inverse);
            if factor == 0 {
                continue;
            }
            let (above, below) = rows.split_at_mut(i);
            field.add_multiple(&mut below[0], field.negative(factor), &above[m]);
            for row in &mut rows {
                row[m] = field.reduce(row[m] + factor * row[i]);
            }
        }
    }
    let mut polynomials: Vec<Vec<u64>> = vec![vec![1]];
    for m in 0..size {
        // (T - h_mm) p_m, less products of entries below the diagonal.
        let mut next = vec![0; m + 2];
        next[1..].copy_from_slice(&polynomials[m]);
        field.add_multiple(&mut next, field.negative(rows[m][m]), &polynomials[m]);
        let mut below = 1;
        for i in (0..m).rev() {
            below = field.multiply(below, rows[i + 1][i]);
            let factor = field.multiply(below, rows[i][m]);
            field.add_multiple(&mut next, field.negative(factor), &polynomials[i]);
        }
        polynomials.push(next);
    }
    polynomials.pop()
}

impl Image {
    /// The residues of the real parts and of the imaginary parts of all coefficients, of two images that differ in the
    /// square root of -1; `None` where these show other multiplicities.
    pub fn parts(&self, other: &Self, i: u64) -> Option<[Self; 2]> {
        let field = self.field;
        let half = field.inverse(2)?;
        let half_of_inverse = field.multiply(half, field.inverse(i)?);
        let real = |a: &[u64], b: &[u64]| -> Vec<u64> {
            let pairs = a.iter().zip(b);
            pairs
                .map(|(&x, &y)| field.multiply(field.reduce(x + y), half))
                .collect()
        };
        let imaginary = |a: &[u64], b: &[u64]| -> Vec<u64> {
            let pairs = a.iter().zip(b);
            pairs
                .map(|(&x, &y)| field.multiply(field.subtract(x, y), half_of_inverse))
                .collect()
        };
        let shape = |image: &Self| -> Vec<(u64, usize)> {
            let classes = image.classes.iter();
            classes
                .map(|class| (class.multiplicity, class.polynomial.len()))
                .collect()
        };
        if shape(self) != shape(other) {
            return None;
        }
        Some([
            self.combined(other, &real),
            self.combined(other, &imaginary),
        ])
    }

    /// The polynomials that are made of two of the images, each of one.
    fn combined(&self, other: &Self, of_two: &impl Fn(&[u64], &[u64]) -> Vec<u64>) -> Self {
        let classes = self.classes.iter().zip(&other.classes).map(|(a, b)| {
            let numerators = a.numerators.iter().zip(&b.numerators);
            ClassImage {
                multiplicity: a.multiplicity,
                polynomial: of_two(&a.polynomial, &b.polynomial),
                numerators: numerators.map(|(a, b)| of_two(a, b)).collect(),
            }
        });
        Self {
            field: self.field,
            classes: classes.collect(),
        }
    }
}
