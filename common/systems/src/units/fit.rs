//! The units that make the coefficients of each equation as equal as they can be.
//!
//! Morgan, Solving Polynomial Systems Using Continuation (1987), chapter 5, asks for the least sum
//! of squares of the logarithms of all scaled coefficients and of their differences within an
//! equation. Here sums of absolute values are taken, by weighted least squares: a coefficient that
//! rounding left, where exact arithmetic has 0, then moves no unit. The factors of the equations
//! are those that leave least, so that only differences within an equation count.

use super::magnitudes::{Magnitudes, Monomial, magnitudes};
use crate::scaling::{MOST_EXPONENT, Scaling};
use crate::system::{SymmetryGenerator, System};
use num_complex::Complex64;

/// Units below 2^6 either way are left as they are: doubles, tolerances and start systems serve as
/// well, and systems that are ordinary keep the bits of their paths.
const LEAST_EXPONENT: i32 = 6;
/// Scaled coefficients are to vary at most by this part of what they did: units that explain less
/// are none.
const EXPLAINED: f64 = 0.7;
/// Coefficients beyond 2^300 either way are scaled even in ordinary units: products of a few are no
/// doubles.
const LARGEST_COEFFICIENT: f64 = 300.0;
/// Weighted least squares again and again: some passes come near the least sum of moduli.
const PASSES: usize = 12;
/// Differences of logarithms below this count as squares: no coefficient is exactly fitted.
const SMALL: f64 = 2.0;
/// Part of 1 with which the exponents themselves count, for those that nothing else determines.
const RIDGE: f64 = 1e-6;
/// Most unknown units that are fitted: elimination for more would take seconds.
const MOST_UNITS: usize = 500;
/// Largest power of two in a term: a bound of the constants that scaling makes.
const MOST_BITS: u64 = 1 << 18;

/// One term of one equation: its exponents in the unknown units, and the logarithm of its
/// coefficient.
struct Term {
    powers: Vec<(usize, f64)>,
    size: f64,
}

/// The units of a checked system, and what its coefficients are in them.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The units; none where coefficients have ordinary sizes already.
    pub scaling: Scaling,
    /// Largest number of powers of two by which the coefficients of one equation differ in these units; 0 where nothing
    /// is known.
    pub coefficient_range: f64,
}

/// The scaling that suits a checked system at these values of its parameters (those where its
/// paths begin and end, one list for each).
///
/// Variables that a declared conjugation or permutation takes to each other have one unit.
pub fn fit(system: &System, parameters: &[Vec<Complex64>]) -> Fit {
    let (units, of_variable) = units(system);
    // Parameters that nothing is known of are of ordinary size.
    let none = vec![Complex64::new(1.0, 0.0); system.parameters.len()];
    let magnitude_sets: Vec<Vec<Option<Magnitudes>>> = match parameters.is_empty() {
        true => vec![magnitudes(system, &none)],
        false => parameters.iter().map(|p| magnitudes(system, p)).collect(),
    };
    let equations: Vec<Vec<Term>> = magnitude_sets
        .iter()
        .flatten()
        .flatten()
        .map(|equation| terms(equation, &of_variable))
        .collect();
    let serving_exponents = serving(&equations, units);
    let largest = equations.iter().flatten().map(|term| term.size.abs());
    let beyond = largest.fold(0.0, f64::max) > LARGEST_COEFFICIENT;
    let exponents = serving_exponents.clone().unwrap_or_else(|| vec![0; units]);
    let scaling = match serving_exponents.is_some() || beyond {
        true => Scaling {
            exponents: of_variable.iter().map(|&unit| exponents[unit]).collect(),
        },
        false => Scaling::default(),
    };
    let exponents: Vec<f64> = exponents.iter().map(|&e| f64::from(e)).collect();
    Fit {
        scaling,
        coefficient_range: coefficient_range(&equations, &exponents),
    }
}

/// Computes the scaling alone.
pub fn scaling_of(system: &System, parameters: &[Vec<Complex64>]) -> Scaling {
    fit(system, parameters).scaling
}

/// The exponents of the units, where there are some that explain the sizes.
fn serving(equations: &[Vec<Term>], units: usize) -> Option<Vec<i32>> {
    if units > MOST_UNITS {
        return None;
    }
    let real_exponents = exponents(equations, units);
    let rounded: Vec<i32> = real_exponents.iter().map(|&e| round(e)).collect();
    let scaled: Vec<f64> = rounded.iter().map(|&e| f64::from(e)).collect();
    let before = spread(equations, &vec![0.0; units]);
    let serves = rounded.iter().any(|e| e.abs() >= LEAST_EXPONENT)
        && spread(equations, &scaled) <= EXPLAINED * before
        && bits(equations, &scaled) <= MOST_BITS;
    serves.then_some(rounded)
}

/// Largest number of powers of two by which the coefficients of one equation differ.
fn coefficient_range(equations: &[Vec<Term>], exponents: &[f64]) -> f64 {
    let range = |terms: &Vec<Term>| {
        let sizes = terms.iter().map(|term| term.scaled(exponents));
        let limits = (f64::INFINITY, f64::NEG_INFINITY);
        let (least, most) = sizes.fold(limits, |(least, most), size| {
            (least.min(size), most.max(size))
        });
        most - least
    };
    equations.iter().map(range).fold(0.0, f64::max)
}

/// The nearest integer within bounds, from a finite number or not.
fn round(e: f64) -> i32 {
    let most = f64::from(MOST_EXPONENT);
    match e.is_finite() {
        true => (e.clamp(-most, most) + 0.5).floor() as i32,
        false => 0,
    }
}

/// Number of units, and the unit of each variable: one for all variables that are exchanged.
fn units(system: &System) -> (usize, Vec<usize>) {
    let n = system.variable_count();
    let mut root: Vec<usize> = (0..n).collect();
    fn find(root: &[usize], mut v: usize) -> usize {
        while root[v] != v {
            v = root[v];
        }
        v
    }
    let permutations = system
        .symmetry
        .iter()
        .filter_map(|generator| match generator {
            SymmetryGenerator::Permutation(images) => Some(images.iter().copied().enumerate()),
            SymmetryGenerator::Map(_) => None,
        });
    let pairs = system.conjugates.iter().copied();
    for (a, b) in permutations.flatten().chain(pairs) {
        let (a, b) = (find(&root, a), find(&root, b));
        root[a.max(b)] = a.min(b);
    }
    let mut number = vec![usize::MAX; n];
    let mut count = 0;
    let of_variable = (0..n).map(|v| {
        let first = find(&root, v);
        if number[first] == usize::MAX {
            number[first] = count;
            count += 1;
        }
        number[first]
    });
    let of_variable = of_variable.collect();
    (count, of_variable)
}

fn terms(equation: &Magnitudes, of_variable: &[usize]) -> Vec<Term> {
    let term = |(monomial, &size): (&Monomial, &f64)| {
        let mut powers: Vec<(usize, f64)> = Vec::with_capacity(monomial.len());
        for &(v, e) in monomial {
            let unit = of_variable[v as usize];
            match powers
                .iter_mut()
                .find(|(other_unit, _)| *other_unit == unit)
            {
                Some((_, power)) => *power += f64::from(e),
                None => powers.push((unit, f64::from(e))),
            }
        }
        Term { powers, size }
    };
    equation.iter().map(term).collect()
}

impl Term {
    /// The logarithm of its coefficient in these units.
    fn scaled(&self, exponents: &[f64]) -> f64 {
        let units = self
            .powers
            .iter()
            .map(|&(unit, power)| power * exponents[unit]);
        self.size + units.sum::<f64>()
    }
}

/// Sum over all equations of the mean difference between logarithms and their median.
fn spread(equations: &[Vec<Term>], exponents: &[f64]) -> f64 {
    let of_equation = |terms: &Vec<Term>| {
        let mut sizes: Vec<f64> = terms.iter().map(|term| term.scaled(exponents)).collect();
        sizes.sort_by(f64::total_cmp);
        let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        let sum: f64 = sizes.iter().map(|size| (size - median).abs()).sum();
        sum / sizes.len().max(1) as f64
    };
    equations.iter().map(of_equation).sum()
}

/// Largest power of two that a term takes.
fn bits(equations: &[Vec<Term>], exponents: &[f64]) -> u64 {
    let of_term = |term: &Term| {
        let each = term.powers.iter();
        each.map(|&(unit, power)| (power * exponents[unit]).abs())
            .sum::<f64>()
    };
    let largest = equations.iter().flatten().map(of_term).fold(0.0, f64::max);
    largest as u64
}

/// The exponents that leave least: weighted least squares, the weights from what the last ones left.
fn exponents(equations: &[Vec<Term>], units: usize) -> Vec<f64> {
    let mut exponents = vec![0.0; units];
    for pass in 0..PASSES {
        let mut matrix = vec![vec![0.0; units + 1]; units];
        for terms in equations {
            let sizes: Vec<f64> = terms.iter().map(|term| term.scaled(&exponents)).collect();
            let mut sorted = sizes.clone();
            sorted.sort_by(f64::total_cmp);
            let Some(&median) = sorted.get(sorted.len() / 2) else {
                continue;
            };
            let weight = |size: f64| match pass {
                0 => 1.0,
                _ => 1.0 / (size - median).abs().max(SMALL),
            };
            add_equation(&mut matrix, terms, &sizes, weight);
        }
        for (unit, row) in matrix.iter_mut().enumerate() {
            row[unit] += RIDGE;
            // The unknowns of the matrix are changes of the exponents, and the ridge pulls the new exponents to about
            // 0.
            row[units] -= RIDGE * exponents[unit];
        }
        let Some(change) = solve(matrix) else {
            return exponents;
        };
        exponents.iter_mut().zip(change).for_each(|(e, c)| *e += c);
    }
    exponents
}

/// Adds the normal equations of one equation: its weighted terms about their weighted mean.
fn add_equation(
    matrix: &mut [Vec<f64>],
    terms: &[Term],
    sizes: &[f64],
    weight: impl Fn(f64) -> f64,
) {
    let units = matrix.len();
    let count = terms.len() as f64;
    let (mut total, mut mean) = (0.0, 0.0);
    let mut mean_powers: std::collections::BTreeMap<usize, f64> = Default::default();
    for (term, &size) in terms.iter().zip(sizes) {
        let w = weight(size) / count;
        total += w;
        mean += w * size;
        for &(unit, power) in &term.powers {
            *mean_powers.entry(unit).or_default() += w * power;
            matrix[unit][units] -= w * power * size;
            for &(other, of_other) in &term.powers {
                matrix[unit][other] += w * power * of_other;
            }
        }
    }
    for (&unit, power) in &mean_powers {
        matrix[unit][units] += power * mean / total;
        for (&other, of_other) in &mean_powers {
            matrix[unit][other] -= power * of_other / total;
        }
    }
}

/// Elimination of a positive definite matrix with one right-hand side.
fn solve(mut matrix: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = matrix.len();
    for k in 0..n {
        let pivot = matrix[k][k];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        let (above, rest) = matrix.split_at_mut(k + 1);
        let row = &above[k];
        for below in rest {
            let factor = below[k] / pivot;
            if factor != 0.0 {
                below[k..]
                    .iter_mut()
                    .zip(&row[k..])
                    .for_each(|(b, r)| *b -= factor * r);
            }
        }
    }
    let mut solution = vec![0.0; n];
    for k in (0..n).rev() {
        let solved_part: f64 = (k + 1..n).map(|j| matrix[k][j] * solution[j]).sum();
        solution[k] = (matrix[k][n] - solved_part) / matrix[k][k];
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read;
    use crate::named;

    fn of(input: &str) -> Vec<i32> {
        let text = format!("CONFIG\nEND;\nINPUT\n{input}\nEND;\n");
        let system = read("test", text.as_bytes()).unwrap().system;
        scaling_of(&system, &[]).exponents
    }

    #[test]
    fn units_are_found() {
        let f = "variable_group x, y; function f, g;";
        assert_eq!(of(&format!("{f} f = x^2 - 1e16; g = y^2 - 3;")), [27, 1]);
        let circle = "f = x^2 + y^2 - 1e-14; g = x*y - 3e-15;";
        assert_eq!(of(&format!("{f} {circle}")), [-24, -24]);
        assert_eq!(of("variable_group x; function f; f = x + 2^100;"), [100]);
        assert_eq!(of("variable_group x; function f; f = x^2 - 1e-20;"), [-33]);
    }

    #[test]
    fn coefficients_range_over_powers_of_two() {
        let range = |input: &str| {
            let text = format!("CONFIG\nEND;\nINPUT\n{input}\nEND;\n");
            let system = read("test", text.as_bytes()).unwrap().system;
            fit(&system, &[]).coefficient_range
        };
        let f = "variable_group x, y; function f, g;";
        assert!(range(&format!("{f} f = x^2 - 1e16; g = y^2 - 3;")) < 3.0);
        let wide = range(&format!("{f} f = (x+y)^2 + 2^80; g = (x-y)^2 - 2^-20;"));
        assert!((79.0..102.0).contains(&wide), "{wide}");
    }

    #[test]
    fn what_has_ordinary_sizes_stays() {
        let f = "variable_group x, y; function f, g;";
        assert_eq!(of(&format!("{f} f = x^2 - 100; g = x*y - 3;")), [0i32; 0]);
        // A coefficient that is 0 but for rounding decides no unit.
        let rounded = "f = x^2 + x*y + 2*y^2 - 3 + 1e-16*x; g = x*y + x - 2*y + 5 - 1e-15*y^2;";
        assert_eq!(of(&format!("{f} {rounded}")), [0i32; 0]);
        for named in [
            named::katsura(5),
            named::cyclic(6),
            named::noon(4),
            named::eco(6),
        ] {
            assert!(scaling_of(&named.system, &[]).is_none());
        }
    }

    #[test]
    fn coefficients_of_hundreds_of_digits_are_scaled_alone() {
        let f = "variable_group x, y; function f, g; f = 1e400*x^2 - 3e400; g = x + y - 1;";
        assert_eq!(of(f), [0, 0]);
    }

    #[test]
    fn what_is_exchanged_has_one_unit() {
        let text = r#"{"variables": ["x", "y"], "equations": ["x*y - 1e20", "x + y - 3e12"],
                       "symmetry": [{"permutation": {"x": "y", "y": "x"}}]}"#;
        let system = read("test", text.as_bytes()).unwrap().system;
        let scaling_exponents = scaling_of(&system, &[]).exponents;
        assert_eq!(scaling_exponents[0], scaling_exponents[1]);
        assert!(
            (30..=42).contains(&scaling_exponents[0]),
            "{scaling_exponents:?}"
        );
    }
}
