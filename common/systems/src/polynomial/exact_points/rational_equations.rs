//! RationalEquations: equations with rational coefficients, real or complex, and their images modulo primes.

use super::exact_point::ExactPoint;
use crate::expression::{Expressions, NodeId};
use crate::polynomial::Polynomial;
use crate::polynomial::solution_count::NotCounted;
use crate::polynomial::solution_count::equations::RationalForm;
use crate::polynomial::solution_count::groebner::Terms;
use crate::polynomial::solution_count::monomial::{MOST_VARIABLES, Monomial};
use crate::polynomial::solution_count::nonsingular::with_inverses;
use crate::polynomial::solution_count::prime_field::PrimeField;
use crate::system::System;
use cognate_numeric::linear_algebra::condition::condition_number;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar as numeric;
use num_complex::Complex64;
use rug::{Complex, Float};
use std::collections::BTreeMap;
use std::ops::Range;

/// An equation holds at a point of at least 64 bits where it is this part of the sum of its terms' absolute values.
const HOLDS: f64 = 1e-12;
/// Bits of residuals and condition numbers.
const BITS: u32 = 256;

/// Exponents of the unknowns, and the coefficient.
pub(super) type RationalTerm = (Vec<u32>, ComplexRational);

/// Equations in some unknowns.
pub(super) struct RationalEquations {
    /// Number of unknowns, those of square roots included.
    pub unknowns: usize,
    /// Unknowns that stand for square roots of numbers.
    pub square_roots: Range<usize>,
    pub equations: Vec<Vec<RationalTerm>>,
    /// Polynomials that are 0 at no solution.
    pub denominators: Vec<Vec<RationalTerm>>,
}

impl RationalEquations {
    /// The equations of a system whose parameters have these values.
    pub fn of(system: &System, parameters: &[Complex64]) -> Result<Self, NotCounted> {
        let is_affine = system.groups.iter().all(|group| !group.homogeneous);
        if !is_affine || parameters.len() != system.parameters.len() {
            return Err(NotCounted::Parameters);
        }
        let exact = |&value: &Complex64| ComplexRational::from_doubles(value);
        let values: Option<Vec<ComplexRational>> = parameters.iter().map(exact).collect();
        let values = values.ok_or(NotCounted::Parameters)?;
        let form = RationalForm::of(system).ok_or(NotCounted::Constants)?;
        let unknowns = system.variable_count() + form.radicands.len();
        if unknowns + form.denominators.len() > MOST_VARIABLES {
            return Err(NotCounted::Unknowns);
        }
        let of_each = |nodes: &[NodeId]| -> Result<Vec<Vec<RationalTerm>>, NotCounted> {
            let nodes = nodes.iter();
            nodes
                .map(|&node| terms(&form.expressions, node, unknowns, &values))
                .collect()
        };
        let mut equations = of_each(&form.equations)?;
        let denominators = of_each(&form.denominators)?;
        for (k, radicand) in form.radicands.iter().enumerate() {
            let mut square = vec![0; unknowns];
            square[system.variable_count() + k] = 2;
            let radicand = ComplexRational::real(radicand.clone()).negate();
            equations.push(vec![
                (square, ComplexRational::real(1)),
                (vec![0; unknowns], radicand),
            ]);
        }
        Ok(Self {
            unknowns,
            square_roots: system.variable_count()..unknowns,
            equations,
            denominators,
        })
    }

    /// Whether each square root is the positive one.
    pub fn has_positive_roots(&self, point: &ExactPoint) -> bool {
        let mut roots = self.square_roots.clone();
        roots.all(|k| point.values[k].re > 0)
    }

    /// Whether all coefficients are real.
    pub fn is_real(&self) -> bool {
        let polynomials = self.equations.iter().chain(&self.denominators);
        polynomials
            .flatten()
            .all(|(_, coefficient)| coefficient.is_real())
    }

    /// Largest degree of an equation or a denominator.
    pub fn degree(&self) -> u32 {
        let polynomials = self.equations.iter().chain(&self.denominators);
        polynomials.map(|p| degree(p)).max().unwrap_or_default()
    }

    /// The product of the degrees of equations and denominators.
    pub fn product_of_degrees(&self) -> u64 {
        let polynomials = self.equations.iter().chain(&self.denominators);
        let degrees = polynomials.map(|p| u64::from(degree(p)).max(1));
        degrees.fold(1, u64::saturating_mul)
    }

    /// Number of variables with those for the inverses of denominators, which come first.
    pub fn variables(&self) -> usize {
        self.unknowns + self.denominators.len()
    }

    /// The equations modulo a prime, those of inverses included; `None` where a coefficient has no residue. `i`: a square
    /// root of -1, of no interest where all coefficients are real.
    pub fn modulo(&self, field: PrimeField, i: u64) -> Option<Vec<Terms>> {
        let of_each = |polynomials: &[Vec<RationalTerm>]| -> Option<Vec<Terms>> {
            polynomials.iter().map(|p| residues(field, i, p)).collect()
        };
        let equations = of_each(&self.equations)?;
        let denominators = of_each(&self.denominators)?;
        let (_, equations) = with_inverses(field.prime(), self.unknowns, equations, &denominators)?;
        Some(equations)
    }

    /// Whether all equations hold at a point as far as its bits show.
    pub fn hold_at(&self, point: &ExactPoint) -> bool {
        let bits = point.precision_bits;
        let values = in_bits(&point.values, bits);
        let mut at = self
            .equations
            .iter()
            .map(|equation| value_at(equation, &values, bits));
        at.all(|at| Float::with_val(bits, at.value.abs_ref()) <= at.size * HOLDS)
    }

    /// Largest residual of an equation at a point of doubles, relative to the sum of its terms' absolute values.
    pub fn residual(&self, rounded: &[Complex64]) -> f64 {
        let complex = |z: &Complex64| Complex::with_val(BITS, (z.re, z.im));
        let values: Vec<Complex> = rounded.iter().map(complex).collect();
        let residuals = self.equations.iter().map(|equation| {
            let at = value_at(equation, &values, BITS);
            match at.size.is_zero() {
                true => 0.0,
                false => (Float::with_val(BITS, at.value.abs_ref()) / at.size).to_f64(),
            }
        });
        residuals.fold(0.0, f64::max)
    }

    /// The condition number of the Jacobian, equations in units of their terms and unknowns in their own; that of the least
    /// squares where there are more equations than unknowns.
    pub fn condition(&self, values: &[ComplexRational]) -> f64 {
        let values = in_bits(values, BITS);
        let rows: Vec<Vec<Complex64>> = self
            .equations
            .iter()
            .map(|equation| scaled_gradient(equation, &values))
            .collect();
        let n = self.unknowns;
        let is_square = rows.len() == n;
        let mut matrix = Matrix::<f64>::zeros((), n, n);
        for i in 0..n {
            for j in 0..n {
                let entry = match is_square {
                    true => rows[i][j],
                    false => rows.iter().map(|row| row[i].conj() * row[j]).sum(),
                };
                *matrix.at_mut(i, j) = numeric::Complex::from_f64((), entry.re, entry.im);
            }
        }
        let condition = condition_number(&matrix);
        match is_square {
            true => condition,
            false => condition.sqrt(),
        }
    }
}

fn in_bits(values: &[ComplexRational], bits: u32) -> Vec<Complex> {
    let float = |part: &Rational| Float::with_val(bits, part);
    let each = values.iter();
    each.map(|value| Complex::with_val(bits, (float(&value.re), float(&value.im))))
        .collect()
}

fn degree(polynomial: &[RationalTerm]) -> u32 {
    let degrees = polynomial.iter().map(|(exponents, _)| {
        let each = exponents.iter();
        each.fold(0u32, |sum, &k| sum.saturating_add(k))
    });
    degrees.max().unwrap_or_default()
}

/// A polynomial at a point.
struct ValueAt {
    value: Complex,
    /// Sum of the absolute values of the terms.
    size: Float,
}

fn value_at(polynomial: &[RationalTerm], values: &[Complex], bits: u32) -> ValueAt {
    let (mut value, mut size) = (Complex::new(bits), Float::new(bits));
    for (exponents, coefficient) in polynomial {
        let term = term_at(coefficient, exponents, values, bits);
        size += Float::with_val(bits, term.abs_ref());
        value += term;
    }
    ValueAt { value, size }
}

fn term_at(
    coefficient: &ComplexRational,
    exponents: &[u32],
    values: &[Complex],
    bits: u32,
) -> Complex {
    let mut term = Complex::with_val(bits, (&coefficient.re, &coefficient.im));
    for (value, &exponent) in values.iter().zip(exponents) {
        if exponent > 0 {
            term *= power(value, exponent.into());
        }
    }
    term
}

/// By repeated squaring: MPC's own powers look whether they are exact, and take the longer for it the larger the exponent.
pub(super) fn power(value: &Complex, exponent: u128) -> Complex {
    let mut power = Complex::with_val(value.prec(), 1);
    for k in (0..u128::BITS - exponent.leading_zeros()).rev() {
        power.square_mut();
        if exponent >> k & 1 == 1 {
            power *= value;
        }
    }
    power
}

/// The derivatives times the unknowns, or 1 where one is 0, over the largest of these.
fn scaled_gradient(polynomial: &[RationalTerm], values: &[Complex]) -> Vec<Complex64> {
    let mut gradient = vec![Complex::new(BITS); values.len()];
    let mut size = Float::new(BITS);
    for (exponents, coefficient) in polynomial {
        for (k, entry) in gradient
            .iter_mut()
            .enumerate()
            .filter(|&(k, _)| exponents[k] > 0)
        {
            let is_zero = values[k].real().is_zero() && values[k].imag().is_zero();
            let mut lower = exponents.clone();
            lower[k] -= u32::from(is_zero);
            let term = term_at(coefficient, &lower, values, BITS) * exponents[k];
            size.max_mut(&Float::with_val(BITS, term.abs_ref()));
            *entry += term;
        }
    }
    let scaled = gradient.into_iter().map(|entry| match size.is_zero() {
        true => Complex64::default(),
        false => {
            let entry = entry / &size;
            Complex64::new(entry.real().to_f64(), entry.imag().to_f64())
        }
    });
    scaled.collect()
}

/// The terms of a polynomial at values of the parameters.
fn terms(
    expressions: &Expressions,
    node: NodeId,
    unknowns: usize,
    parameters: &[ComplexRational],
) -> Result<Vec<RationalTerm>, NotCounted> {
    let expanded = Polynomial::expand(expressions, node, unknowns, parameters.len());
    let mut sums: BTreeMap<Vec<u32>, ComplexRational> = BTreeMap::new();
    for (exponents, coefficient) in &expanded.ok_or(NotCounted::Terms)?.terms {
        let (of_unknowns, of_parameters) = exponents.split_at(unknowns);
        Monomial::new(of_unknowns).ok_or(NotCounted::Degree)?;
        let mut value = coefficient.clone();
        for (parameter, &exponent) in parameters.iter().zip(of_parameters) {
            value = value.multiply(&parameter.power(exponent));
        }
        let sum = sums.entry(of_unknowns.to_vec()).or_default();
        *sum = sum.add(&value);
    }
    Ok(sums.into_iter().filter(|(_, c)| !c.is_zero()).collect())
}

fn residues(field: PrimeField, i: u64, polynomial: &[RationalTerm]) -> Option<Terms> {
    let mut residues = Terms::new();
    for (exponents, coefficient) in polynomial {
        let [re, im] = [
            residue(field, &coefficient.re)?,
            residue(field, &coefficient.im)?,
        ];
        let residue = field.reduce(re + i * im);
        if residue != 0 {
            residues.push((Monomial::new(exponents)?, residue));
        }
    }
    residues.sort_unstable_by_key(|&(monomial, _)| std::cmp::Reverse(monomial));
    Some(residues)
}

/// The residue of a rational number; `None` where the prime divides its denominator.
pub(super) fn residue(field: PrimeField, number: &Rational) -> Option<u64> {
    let prime = field.prime() as u32;
    let part = |part: &rug::Integer| u64::from(part.mod_u(prime));
    let inverse = field.inverse(part(number.denom()))?;
    Some(field.multiply(part(number.numer()), inverse))
}
