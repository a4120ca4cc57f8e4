//! Coefficient family: the systems with the monomials of a given one.
//!
//! A system without parameters can be solved by loops through its family, as Macaulay2's
//! `sparseMonodromySolve` does.

use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::Expressions;
use cognate_systems::polynomial::Polynomial;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::collections::{BTreeMap, HashMap};

/// A power of 2 within a factor of 2 of the size of a coefficient; 1 for 0.
fn size(c: &ComplexRational) -> Rational {
    if c.is_zero() {
        return Rational::from(1);
    }
    let norm = Rational::from(&c.re * &c.re) + Rational::from(&c.im * &c.im);
    let above = i64::from(norm.numer().significant_bits());
    let below = i64::from(norm.denom().significant_bits());
    let exponent = (above - below).div_euclid(2);
    let shift = u32::try_from(exponent.unsigned_abs()).unwrap_or(u32::MAX);
    let power = Rational::from(1) << shift;
    if exponent < 0 { power.recip() } else { power }
}

/// The systems that a given one is a member of.
pub struct CoefficientFamily {
    /// The system with its coefficients as parameters.
    pub system: System,
    /// The parameters of the given system.
    pub values: Vec<Complex64>,
    /// Monomials that share a parameter with others in every equation.
    pub tied: usize,
}

/// The family of a system without parameters.
///
/// Monomials whose coefficients have one ratio in all equations keep it: of conditions on planes that are
/// written in minors, the family has as many solutions as the conditions in general, far fewer than its
/// monomials admit. Each of these sums, mostly one monomial, has the coefficient r + s p with a parameter p in
/// an equation: s is the size of the given coefficient,
/// p at the target is the nearest double to it, in units of s, and r is what is left of it. So the system at these
/// parameters is the given one without rounding.
///
/// Equations that all have the same monomials are combined, so that none is nearly a combination of the others. The
/// combined system is far from systems with fewer solutions, and fewer steps lead there (two pole placement problems,
/// whose equations are dependent but for 1/600, take 2/3 and 1/3 of the time).
///
/// Where solutions may have zeros, equations get a constant term, as a start by mixed cells gives them one:
/// `supports` are that start's.
///
/// # Errors
/// Why its coefficients are not known, in words.
pub fn coefficient_family(
    system: &System,
    supports: &[Vec<Vec<i64>>],
) -> Result<CoefficientFamily, String> {
    let n = system.variable_count();
    let polynomials = system.equations.iter().map(|&equation| {
        Polynomial::expand(&system.expressions, equation, n, 0)
            .ok_or("the equations are not multiplied out")
    });
    let polynomials = polynomials.collect::<Result<Vec<_>, _>>()?;
    let polynomials = orthogonal(&polynomials).unwrap_or(polynomials);
    let sums = sums(&polynomials);
    let tied = sums.iter().map(|sum| sum.terms.len());
    let tied = tied.filter(|&terms| terms > 1).sum();
    let mut family = system.clone();
    let mut out = Expressions::new();
    let leaves: Vec<_> = (0..n as u32).map(|v| out.variable(v)).collect();
    let written: Vec<_> = sums
        .iter()
        .map(|sum| sum.write(&mut out, &leaves))
        .collect();
    let one = out.integer(1);
    let mut values = Vec::new();
    for ((equation, support), given) in family.equations.iter_mut().zip(supports).zip(&polynomials)
    {
        let constant = vec![0; n];
        let has_constant = support.iter().any(|point| point.iter().all(|&e| e == 0));
        let coefficients = sums.iter().zip(&written).filter_map(|(sum, &node)| {
            // The factor of the first monomial in its own sum is 1.
            let first = sum.terms.keys().next()?;
            Some((given.terms.get(first)?.clone(), node))
        });
        let free = given.terms.get(&constant).cloned().unwrap_or_default();
        let coefficients = coefficients.chain(has_constant.then_some((free, one)));
        let mut sum = out.integer(0);
        for (given, node) in coefficients.collect::<Vec<_>>() {
            let scale = size(&given);
            let [re, im] = [&given.re, &given.im].map(|x| Rational::from(x / &scale).to_f64());
            let value = Complex64::new(re, im);
            let near = ComplexRational::from_doubles(value).unwrap_or_default();
            let left = given.subtract(&near.multiply(&ComplexRational::real(scale.clone())));
            let mut coefficient = out.parameter(values.len() as u32);
            values.push(value);
            if scale != 1 {
                let scale = out.constant(ComplexRational::real(scale));
                coefficient = out.multiply(scale, coefficient);
            }
            if !left.is_zero() {
                let left = out.constant(left);
                coefficient = out.add(coefficient, left);
            }
            let term = out.multiply(coefficient, node);
            sum = out.add(sum, term);
        }
        *equation = sum;
    }
    family.expressions = out;
    family.parameters = (0..values.len())
        .map(|k| format!("coefficient{k}"))
        .collect();
    Ok(CoefficientFamily {
        system: family,
        values,
        tied,
    })
}

/// Combinations of equations with the same monomials, whose coefficients are orthonormal up to rounding; `None` for
/// others, or where the equations are dependent as far as doubles can tell.
fn orthogonal(polynomials: &[Polynomial]) -> Option<Vec<Polynomial>> {
    let (first, others) = polynomials.split_first()?;
    let same = |other: &Polynomial| other.terms.keys().eq(first.terms.keys());
    if !others.iter().all(same) {
        return None;
    }
    let mut rows = Vec::<Vec<Complex64>>::new();
    let mut factors = Vec::<Vec<Complex64>>::new();
    for (i, polynomial) in polynomials.iter().enumerate() {
        let double = |c: &ComplexRational| Complex64::new(c.re.to_f64(), c.im.to_f64());
        let mut row: Vec<_> = polynomial.terms.values().map(double).collect();
        let mut combination = vec![Complex64::default(); polynomials.len()];
        combination[i] = Complex64::new(1.0, 0.0);
        normalize(&mut row, &mut combination)?;
        // Once more removes what rounding has left the first time.
        for _ in 0..2 {
            for (unit_row, factor) in rows.iter().zip(&factors) {
                let along: Complex64 = row.iter().zip(unit_row).map(|(x, k)| x * k.conj()).sum();
                subtract(&mut row, unit_row, along);
                subtract(&mut combination, factor, along);
            }
            normalize(&mut row, &mut combination)?;
        }
        rows.push(row);
        factors.push(combination);
    }
    let exact = |&z: &Complex64| ComplexRational::from_doubles(z);
    let combined = factors.iter().map(|factors| {
        let factors: Vec<_> = factors.iter().map(exact).collect::<Option<_>>()?;
        let terms = first.terms.keys().map(|exponents| {
            let parts = polynomials.iter().zip(&factors);
            let sum = parts.fold(ComplexRational::default(), |sum, (polynomial, factor)| {
                sum.add(&polynomial.terms[exponents].multiply(factor))
            });
            (exponents.clone(), sum)
        });
        Some(Polynomial {
            terms: terms.filter(|(_, sum)| !sum.is_zero()).collect(),
            variables: first.variables,
        })
    });
    combined.collect()
}

/// Least part of an equation that is independent of the equations before it.
const INDEPENDENT: f64 = 1e-10;

/// Divides a vector and what it is made of by its length, where that is not lost in rounding.
fn normalize(row: &mut [Complex64], combination: &mut [Complex64]) -> Option<()> {
    let length = row.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
    let largest = combination
        .iter()
        .map(Complex64::norm_sqr)
        .sum::<f64>()
        .sqrt();
    if !(length.is_normal() && largest.is_normal() && length > INDEPENDENT) {
        return None;
    }
    for z in row.iter_mut().chain(combination) {
        *z /= length;
    }
    Some(())
}

fn subtract(from: &mut [Complex64], vector: &[Complex64], times: Complex64) {
    for (z, v) in from.iter_mut().zip(vector) {
        *z -= times * v;
    }
}

/// All monomials but the constant, those together that stand in the same equations, two or more, with
/// coefficients of one ratio.
fn sums(polynomials: &[Polynomial]) -> Vec<Polynomial> {
    let mut columns = BTreeMap::<&Vec<u32>, Vec<(usize, &ComplexRational)>>::new();
    for (i, polynomial) in polynomials.iter().enumerate() {
        for (exponents, coefficient) in &polynomial.terms {
            columns.entry(exponents).or_default().push((i, coefficient));
        }
    }
    let mut sums = Vec::<Polynomial>::new();
    let mut leading = Vec::<&ComplexRational>::new();
    let mut place_of_ratios = HashMap::<Vec<(usize, ComplexRational)>, usize>::new();
    for (exponents, column) in columns {
        let [(_, first), rest @ ..] = column.as_slice() else {
            continue;
        };
        if exponents.iter().all(|&e| e == 0) {
            continue;
        }
        let fresh = sums.len();
        let place = match rest {
            [] => fresh,
            _ => {
                let ratio = |&(i, c): &(usize, &ComplexRational)| Some((i, c.divide(first)?));
                let direction = column.iter().filter_map(ratio).collect();
                *place_of_ratios.entry(direction).or_insert(fresh)
            }
        };
        if place == fresh {
            leading.push(first);
            sums.push(Polynomial {
                terms: BTreeMap::new(),
                variables: exponents.len(),
            });
        }
        let factor = first.divide(leading[place]);
        let terms = &mut sums[place].terms;
        terms.extend(factor.map(|factor| (exponents.clone(), factor)));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PathAlgorithm;
    use crate::plan::{SolveMethod, SolveOptions, plan};
    use crate::run_locally::run_locally;
    use crate::start_costs::cell_supports;
    use crate::synthetic::declared;
    use cognate_solutions::completeness::Completeness;

    const CIRCLES: &str = "variable_group x, y; function f, g; \
        f = 2*x^2 + 2*y^2 - 3*x + y - 7; g = x^2 + y^2 + x - 4*y - 5;";

    #[test]
    fn sizes_are_powers_of_two() {
        let power_of_two = |re: Rational| size(&ComplexRational::real(re));
        assert_eq!(power_of_two(Rational::from(5)), 4);
        assert_eq!(power_of_two(Rational::from((1, 5))), Rational::from((1, 4)));
        assert_eq!(power_of_two(Rational::from(0)), 1);
    }

    /// x^2 = 1e8 / 3 and x y = y + 7: four monomials, one coefficient a fraction, two solutions.
    #[test]
    fn a_system_without_parameters_is_solved_by_loops() {
        let system =
            declared("variable_group x, y; function f, g; f = x^2 - 100000000/3; g = x*y - y - 7;");
        let supports = cell_supports(&system).unwrap();
        let family = coefficient_family(&system, &supports).unwrap();
        assert_eq!((family.values.len(), family.tied), (5, 0));
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

    /// Two circles: their squares keep their ratio, and of four points two are left.
    #[test]
    fn squares_of_circles_stay_tied() {
        let circles = declared(CIRCLES);
        let supports = cell_supports(&circles).unwrap();
        let family = coefficient_family(&circles, &supports).unwrap();
        assert_eq!((family.values.len(), family.tied), (8, 2));
        assert!(crate::monodromy::trace::has_pencil(&family.system));
        let mut loops = SolveMethod::MONODROMY;
        if let SolveMethod::Monodromy(options) = &mut loops {
            options.limits.trace_test = true;
        }
        for seed in 1..=5 {
            let options = SolveOptions {
                method: loops.clone(),
                seed,
                ..SolveOptions::default()
            };
            let mut plan = plan(&circles, &options).unwrap();
            assert!(
                plan.why
                    .ends_with("coefficients of 2 monomials keep their ratios")
            );
            let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8).unwrap();
            assert_eq!((sets[0].counts.nonsingular, sets[0].paths.total), (2, 2));
            assert_eq!(sets[0].counts.complete, Completeness::Yes, "seed {seed}");
        }
    }

    /// Loops that were not asked for and end without a trace test that passes have no answer.
    #[test]
    fn loops_that_fall_short_are_no_answer() {
        let circles = declared(CIRCLES);
        let mut loops = SolveMethod::MONODROMY;
        if let SolveMethod::Monodromy(options) = &mut loops {
            options.limits.only_complete = true;
        }
        let options = SolveOptions {
            method: loops,
            ..SolveOptions::default()
        };
        let mut plan = plan(&circles, &options).unwrap();
        let end = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        assert!(end.is_err() && plan.algorithm.failure().is_some());
        let failure = end.unwrap_err().to_string();
        assert!(failure.contains("found 2 solutions"), "{failure}");
    }

    /// Equations that differ by 10^-6 are combined exactly, to coefficients that are orthonormal.
    #[test]
    fn nearly_dependent_equations_are_combined() {
        let system = declared(
            "variable_group x, y; function f, g; \
             f = x*y + 2*x - 3*y + 5; g = x*y + 2*x - 3*y + 5 + (x*y - x + 7*y - 1)/1000000;",
        );
        let given = system
            .equations
            .iter()
            .map(|&equation| Polynomial::expand(&system.expressions, equation, 2, 0).unwrap());
        let given: Vec<Polynomial> = given.collect();
        let combined = orthogonal(&given).unwrap();
        let product = |a: &Polynomial, b: &Polynomial| -> f64 {
            let product_of_parts =
                |(x, y): (&ComplexRational, &ComplexRational)| x.re.to_f64() * y.re.to_f64();
            a.terms
                .values()
                .zip(b.terms.values())
                .map(product_of_parts)
                .sum()
        };
        assert!((product(&combined[0], &combined[0]) - 1.0).abs() < 1e-9);
        assert!((product(&combined[1], &combined[1]) - 1.0).abs() < 1e-9);
        assert!(product(&combined[0], &combined[1]).abs() < 1e-9);
        // Each is exactly a combination of the given ones: all four minors of three rows are 0.
        let row =
            |p: &Polynomial| -> Vec<Rational> { p.terms.values().map(|c| c.re.clone()).collect() };
        let [a, b] = [row(&given[0]), row(&given[1])];
        for c in combined.iter().map(row) {
            for [i, j, k] in [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]] {
                let minor = |x: usize, y: usize| {
                    Rational::from(&a[x] * &b[y]) - Rational::from(&a[y] * &b[x])
                };
                let determinant = minor(j, k) * &c[i] - minor(i, k) * &c[j] + minor(i, j) * &c[k];
                assert_eq!(determinant, 0);
            }
        }
        assert!(orthogonal(&[given[0].clone(), given[0].clone()]).is_none());
    }
}
