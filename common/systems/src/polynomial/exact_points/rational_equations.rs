//! RationalEquations: equations with real rational coefficients, and their images modulo primes.

use super::ExactPoint;
use crate::expression::NodeId;
use crate::polynomial::Polynomial;
use crate::polynomial::solution_count::NotCounted;
use crate::polynomial::solution_count::groebner::Terms;
use crate::polynomial::solution_count::monomial::{MOST_VARIABLES, Monomial};
use crate::polynomial::solution_count::nonsingular::with_inverses;
use crate::polynomial::solution_count::prime_field::PrimeField;
use crate::system::System;
use crate::transform::clear_denominators::denominator_factors;
use cognate_numeric::rational::{ComplexRational, Rational};
use num_complex::Complex64;
use rug::ops::Pow;
use rug::{Complex, Float};
use std::collections::BTreeMap;

/// An equation holds at a point where it is this part of the sum of its terms' absolute values: half of the digits of a
/// double, since a point is rounded, and near others.
const HOLDS: f64 = 1e-8;

/// Exponents of the unknowns, and the coefficient.
type RationalTerm = (Vec<u32>, Rational);

/// Equations in some unknowns.
pub(super) struct RationalEquations {
    pub unknowns: usize,
    equations: Vec<Vec<RationalTerm>>,
    /// 0 at no solution.
    denominators: Vec<Vec<RationalTerm>>,
}

impl RationalEquations {
    /// The equations of a system whose parameters have these values.
    pub fn of(system: &System, parameters: &[Complex64]) -> Result<Self, NotCounted> {
        let is_affine = system.groups.iter().all(|group| !group.homogeneous);
        if !is_affine || parameters.len() != system.parameters.len() {
            return Err(NotCounted::Parameters);
        }
        let values: Option<Vec<Rational>> = parameters
            .iter()
            .map(|value| match value.im == 0.0 {
                true => Rational::from_f64(value.re),
                false => None,
            })
            .collect();
        let values = values.ok_or(NotCounted::Parameters)?;
        let denominators = denominator_factors(system);
        if system.variable_count() + denominators.len() > MOST_VARIABLES {
            return Err(NotCounted::Unknowns);
        }
        let of_each = |nodes: &[NodeId]| -> Result<Vec<Vec<RationalTerm>>, NotCounted> {
            let nodes = nodes.iter();
            nodes.map(|&node| terms(system, node, &values)).collect()
        };
        Ok(Self {
            unknowns: system.variable_count(),
            equations: of_each(&system.equations)?,
            denominators: of_each(&denominators)?,
        })
    }

    /// Number of variables with those for the inverses of denominators, which come first.
    pub fn variables(&self) -> usize {
        self.unknowns + self.denominators.len()
    }

    /// The equations modulo a prime, those of inverses included; `None` where a coefficient has no residue.
    pub fn modulo(&self, field: PrimeField) -> Option<Vec<Terms>> {
        let of_each = |polynomials: &[Vec<RationalTerm>]| -> Option<Vec<Terms>> {
            polynomials.iter().map(|p| residues(field, p)).collect()
        };
        let equations = of_each(&self.equations)?;
        let denominators = of_each(&self.denominators)?;
        let (_, equations) = with_inverses(field.prime(), self.unknowns, equations, &denominators)?;
        Some(equations)
    }

    /// Whether all equations hold at a point as far as its bits show.
    pub fn hold(&self, point: &ExactPoint) -> bool {
        let bits = point.precision_bits;
        let float = |part: &Rational| Float::with_val(bits, part);
        let values: Vec<Complex> = point
            .values
            .iter()
            .map(|value| Complex::with_val(bits, (float(&value.re), float(&value.im))))
            .collect();
        self.equations.iter().all(|equation| {
            let (mut sum, mut size) = (Complex::new(bits), Float::new(bits));
            for (exponents, coefficient) in equation {
                let mut term = Complex::with_val(bits, coefficient);
                for (value, &exponent) in values.iter().zip(exponents) {
                    if exponent > 0 {
                        term *= Complex::with_val(bits, value.pow(exponent));
                    }
                }
                size += Float::with_val(bits, term.abs_ref());
                sum += term;
            }
            Float::with_val(bits, sum.abs_ref()) <= size * HOLDS
        })
    }
}

/// The terms of a polynomial at values of the parameters.
fn terms(
    system: &System,
    node: NodeId,
    parameters: &[Rational],
) -> Result<Vec<RationalTerm>, NotCounted> {
    let unknowns = system.variable_count();
    let expanded = Polynomial::expand(&system.expressions, node, unknowns, parameters.len());
    let mut sums: BTreeMap<Vec<u32>, Rational> = BTreeMap::new();
    for (exponents, coefficient) in &expanded.ok_or(NotCounted::Terms)?.terms {
        if !coefficient.is_real() {
            return Err(NotCounted::Constants);
        }
        let (of_unknowns, of_parameters) = exponents.split_at(unknowns);
        Monomial::new(of_unknowns).ok_or(NotCounted::Degree)?;
        let mut value = coefficient.re.clone();
        for (parameter, &exponent) in parameters.iter().zip(of_parameters) {
            value *= ComplexRational::real(parameter.clone()).power(exponent).re;
        }
        *sums.entry(of_unknowns.to_vec()).or_default() += value;
    }
    Ok(sums.into_iter().filter(|(_, c)| *c != 0).collect())
}

fn residues(field: PrimeField, polynomial: &[RationalTerm]) -> Option<Terms> {
    let mut residues = Terms::new();
    for (exponents, coefficient) in polynomial {
        let residue = residue(field, coefficient)?;
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
