//! Coefficient family: the systems with the monomials of a given one.
//!
//! A system without parameters can be solved by loops through its family, as Macaulay2's
//! `sparseMonodromySolve` does.

use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::Expressions;
use cognate_systems::polynomial::Polynomial;
use cognate_systems::system::System;
use num_complex::Complex64;

/// A power of 2 within a factor of 2 of the size of a coefficient; 1 for 0.
fn size(coefficient: Option<&ComplexRational>) -> Rational {
    let Some(c) = coefficient.filter(|c| !c.is_zero()) else {
        return Rational::from(1);
    };
    let norm = Rational::from(&c.re * &c.re) + Rational::from(&c.im * &c.im);
    let above = i64::from(norm.numer().significant_bits());
    let below = i64::from(norm.denom().significant_bits());
    let exponent = (above - below).div_euclid(2);
    let shift = u32::try_from(exponent.unsigned_abs()).unwrap_or(u32::MAX);
    let power = Rational::from(1) << shift;
    if exponent < 0 { power.recip() } else { power }
}

/// The family of a system without parameters, and the parameters of the system itself.
///
/// Each monomial has the coefficient r + s p with a parameter p: s is the size of the given coefficient,
/// p at the target is the nearest double to it, in units of s, and r is what is left of it. So the
/// system at these parameters is the given one without rounding. Where solutions may have zeros,
/// equations get a constant term, as a start by mixed cells gives them one: `supports` are that start's.
///
/// # Errors
/// Why its coefficients are not known, in words.
pub fn coefficient_family(
    system: &System,
    supports: &[Vec<Vec<i64>>],
) -> Result<(System, Vec<Complex64>), String> {
    let n = system.variable_count();
    let mut family = system.clone();
    let mut out = Expressions::new();
    let mut values = Vec::new();
    for (equation, support) in family.equations.iter_mut().zip(supports) {
        let polynomial = Polynomial::expand(&system.expressions, *equation, n, 0)
            .ok_or("the equations are not multiplied out")?;
        let mut sum = out.integer(0);
        for point in support {
            let exponents = point.iter().map(|&e| u32::try_from(e).unwrap_or(0));
            let exponents: Vec<u32> = exponents.collect();
            let given = polynomial.terms.get(&exponents);
            let scale = size(given);
            let given = given.cloned().unwrap_or_default();
            let [re, im] = [&given.re, &given.im].map(|x| Rational::from(x / &scale).to_f64());
            let near = [re, im].map(|x| Rational::from_f64(x).unwrap_or_default() * &scale);
            let [near_re, near_im] = near;
            let left = given.subtract(&ComplexRational::new(near_re, near_im));
            let mut coefficient = out.parameter(values.len() as u32);
            values.push(Complex64::new(re, im));
            if scale != 1 {
                let scale = out.constant(ComplexRational::real(scale));
                coefficient = out.multiply(scale, coefficient);
            }
            if !left.is_zero() {
                let left = out.constant(left);
                coefficient = out.add(coefficient, left);
            }
            let mut term = coefficient;
            for (v, &exponent) in (0..).zip(&exponents) {
                if exponent > 0 {
                    let x = out.variable(v);
                    let power = out.power(x, exponent);
                    term = out.multiply(term, power);
                }
            }
            sum = out.add(sum, term);
        }
        *equation = sum;
    }
    family.expressions = out;
    family.parameters = (0..values.len())
        .map(|k| format!("coefficient{k}"))
        .collect();
    Ok((family, values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{SolveMethod, SolveOptions, plan};
    use crate::run_locally::run_locally;
    use crate::start_costs::cell_supports;
    use crate::synthetic::declared;

    #[test]
    fn sizes_are_powers_of_two() {
        let of = |re: Rational| size(Some(&ComplexRational::real(re)));
        assert_eq!(of(Rational::from(5)), 4);
        assert_eq!(of(Rational::from((1, 5))), Rational::from((1, 4)));
        assert_eq!(of(Rational::from(0)), 1);
        assert_eq!(size(None), 1);
    }

    /// x^2 = 1e8 / 3 and x y = y + 7: four monomials, one coefficient a fraction, two solutions.
    #[test]
    fn a_system_without_parameters_is_solved_by_loops() {
        let system =
            declared("variable_group x, y; function f, g; f = x^2 - 100000000/3; g = x*y - y - 7;");
        let supports = cell_supports(&system).unwrap();
        let (family, values) = coefficient_family(&system, &supports).unwrap();
        assert_eq!((family.parameters.len(), values.len()), (5, 5));
        for seed in 1..=5 {
            let options = SolveOptions {
                method: SolveMethod::MONODROMY,
                seed,
                ..SolveOptions::default()
            };
            let mut plan = plan(&system, &options).unwrap();
            let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8).unwrap();
            assert_eq!(sets[0].counts.nonsingular, 2, "seed {seed}");
            assert_eq!(sets[0].counts.real, Some(2), "seed {seed}");
        }
    }
}
