//! Centre: the point from which the solutions of a polynomial system are seen at ordinary coordinates.
//!
//! A polynomial f of degree d has f(x + c) = f_d + (f_(d-1) + sum of c_k df_d/dx_k) + ...: c by least squares makes the terms
//! below the highest small (Tschirnhaus' substitution, in several variables). Along directions on which the highest do not depend the
//! next ones do the same. Far from the origin, where that is not done, the
//! terms of an equation nearly cancel on all of its solutions.

use crate::expression::Expressions;
use crate::polynomial::Polynomial;
use crate::system::System;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::rational::ComplexRational;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Least gain of a centre: powers of two by which solutions look smaller from it.
const LEAST_GAIN: f64 = 2.0;
/// Singular values below this part of the largest leave their direction alone.
const RANK: f64 = 1e-6;
/// Bits of the largest coordinate of a centre.
const BITS: i32 = 24;

/// The system about its centre, multiplied out, without symmetries and degenerate sets, and the centre; `None` where that
/// gains little or the equations are no polynomials of moderate size. `partner`: the variables that conjugation exchanges,
/// under which the centre is real.
///
/// # Panics
/// When the system has parameters.
pub fn about_centre(system: &System, partner: &[usize]) -> Option<(System, Vec<Complex64>)> {
    assert!(system.parameters.is_empty(), "parameters have values here");
    if system.groups.iter().any(|group| group.homogeneous) {
        return None;
    }
    let n = system.variables.len();
    let expand = |&root| Polynomial::expand(&system.expressions, root, n, 0);
    let equations: Vec<Polynomial> = system.equations.iter().map(expand).collect::<Option<_>>()?;
    let centre = centre_of(&equations, partner)?;
    let about = translated(&equations, &centre)?;
    let far = size(&equations) >= LEAST_GAIN + size(&about);
    far.then(|| (written(system, &about), centre))
}

/// About how large solutions are, as a power of two: that of which powers make up for the coefficients below the highest.
/// Linear equations say nothing: a plane has no size, and about a rounded point of it its constant is a rounding error.
fn size(equations: &[Polynomial]) -> f64 {
    let of_equation = |equation: &Polynomial| {
        let degree = equation.degree();
        let coefficients = equation.coefficients_at(&[]).into_iter();
        let terms = coefficients.map(|(e, c)| (degree - e.iter().sum::<u32>(), c.norm_sqr()));
        let terms: Vec<(u32, f64)> = terms.collect();
        let highest = terms.iter().filter(|(below, _)| *below == 0);
        let highest = highest.map(|(_, c)| *c).fold(0.0, f64::max);
        let lower = terms.iter().filter(|(below, _)| *below > 0);
        // Of squares.
        let sizes =
            lower.map(|&(below, c)| f64::from(exponent(c / highest)) / f64::from(2 * below));
        sizes.fold(f64::from(-BITS), f64::max)
    };
    let curved = equations.iter().filter(|equation| equation.degree() > 1);
    curved.map(of_equation).fold(f64::from(-BITS), f64::max)
}

/// The exponent of a positive double.
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// The centre of these equations, rounded; `None` where nothing determines it.
fn centre_of(equations: &[Polynomial], partner: &[usize]) -> Option<Vec<Complex64>> {
    let n = partner.len();
    let unit = |k: usize| {
        (0..n)
            .map(|j| Complex64::from(f64::from(u8::from(j == k))))
            .collect()
    };
    let mut free: Vec<Vec<Complex64>> = (0..n).map(unit).collect();
    let mut centre = vec![Complex64::default(); n];
    let most = equations.iter().map(Polynomial::degree).max().unwrap_or(0);
    for below in 1..=most {
        if free.is_empty() {
            break;
        }
        let about = translated(equations, &centre)?;
        let (step, left) = step(&about, &free, below)?;
        for (k, c) in centre.iter_mut().enumerate() {
            *c += 0.5 * (step[k] + step[partner[k]].conj());
        }
        centre = rounded(&centre);
        free = left;
    }
    Some(centre)
}

/// The step along some directions, on which terms of higher degrees do not depend, that makes those so far below the highest
/// least, and the directions on which these do not depend either.
fn step(
    equations: &[Polynomial],
    free: &[Vec<Complex64>],
    below: u32,
) -> Option<(Vec<Complex64>, Vec<Vec<Complex64>>)> {
    let n = free.first()?.len();
    let mut rows: Vec<Vec<Complex64>> = Vec::new();
    for equation in equations {
        rows.extend(rows_of(equation, n, below));
    }
    let along = |direction: &Vec<Complex64>| -> Vec<Complex64> {
        let dot = |row: &Vec<Complex64>| row.iter().zip(direction).map(|(a, b)| a * b).sum();
        rows.iter().map(dot).collect()
    };
    let wanted: Vec<Complex64> = rows.iter().map(|row| row[n]).collect();
    if wanted
        .iter()
        .any(|z| !z.re.is_finite() || !z.im.is_finite())
    {
        return None;
    }
    let svd = Svd::of(free.iter().map(along).collect());
    let largest = svd.values.first().copied().unwrap_or(0.0).max(RANK);
    let rank = svd.values.iter().filter(|&&v| v > RANK * largest).count();
    let combined = |parts: &[Complex64]| -> Vec<Complex64> {
        let part = |k: usize| parts.iter().zip(free).map(|(c, d)| c * d[k]).sum();
        (0..n).map(part).collect()
    };
    let left = svd.domain[rank..].iter().map(|parts| combined(parts));
    Some((combined(&svd.least_squares(&wanted, rank)), left.collect()))
}

/// For each monomial so far below the highest degree: the change of its coefficient with each variable, and minus the
/// coefficient.
fn rows_of(equation: &Polynomial, n: usize, below: u32) -> Vec<Vec<Complex64>> {
    let coefficients = equation.coefficients_at(&[]);
    let degree = equation.degree();
    let size = |total_degree: u32| {
        let terms = coefficients
            .iter()
            .filter(|(e, _)| e.iter().sum::<u32>() == total_degree);
        terms.map(|(_, c)| c.norm_sqr()).sum::<f64>().sqrt()
    };
    let size = size(degree);
    if degree < below || !size.is_normal() {
        return Vec::new();
    }
    let mut rows: BTreeMap<Vec<u32>, Vec<Complex64>> = BTreeMap::new();
    let zeros = || vec![Complex64::default(); n + 1];
    for (exponents, c) in &coefficients {
        let term_degree = exponents.iter().sum::<u32>();
        if term_degree + below == degree {
            rows.entry(exponents.clone()).or_insert_with(zeros)[n] -= c / size;
        }
        if term_degree + below == degree + 1 {
            for k in (0..n).filter(|&k| exponents[k] > 0) {
                let mut lower = exponents.clone();
                lower[k] -= 1;
                rows.entry(lower).or_insert_with(zeros)[k] += c * f64::from(exponents[k]) / size;
            }
        }
    }
    rows.into_values().collect()
}

/// A point with few bits.
fn rounded(point: &[Complex64]) -> Vec<Complex64> {
    let parts = point.iter().flat_map(|z| [z.re.abs(), z.im.abs()]);
    let largest = parts.fold(0.0, f64::max);
    let unit = f64::from_bits(((exponent(largest) - BITS + 1023).max(1) as u64) << 52);
    let round = |x: f64| (x / unit).round() * unit;
    let each = point
        .iter()
        .map(|z| Complex64::new(round(z.re), round(z.im)));
    each.collect()
}

/// The equations at x + c, multiplied out.
fn translated(equations: &[Polynomial], centre: &[Complex64]) -> Option<Vec<Polynomial>> {
    let mut between = Expressions::new();
    let mut leaves = Vec::with_capacity(centre.len());
    for (k, &c) in centre.iter().enumerate() {
        let (x, c) = (
            between.variable(k as u32),
            between.constant(ComplexRational::from_doubles(c)?),
        );
        leaves.push(between.add(x, c));
    }
    let each = equations.iter().map(|equation| {
        let root = equation.write(&mut between, &leaves);
        Polynomial::expand(&between, root, centre.len(), 0)
    });
    each.collect()
}

/// The system with these equations.
fn written(system: &System, equations: &[Polynomial]) -> System {
    let mut expressions = Expressions::new();
    let variables = 0..system.variables.len();
    let variable_nodes: Vec<_> = variables.map(|k| expressions.variable(k as u32)).collect();
    let roots = equations
        .iter()
        .map(|e| e.write(&mut expressions, &variable_nodes));
    System {
        equations: roots.collect(),
        expressions,
        scaling: Default::default(),
        symmetry: Vec::new(),
        helpers: Vec::new(),
        degenerate: Default::default(),
        ..system.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(text: &str) -> System {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        crate::formats::read("test", text.as_bytes())
            .unwrap()
            .system
    }

    #[test]
    fn a_torus_far_away_is_moved_to_the_origin() {
        let far = system(
            "variable_group x, y, z; function f; s = (x - 20)^2 + (y + 10)^2 + (z - 1/3)^2 + 3; \
             f = s^2 - 16*((x - 20)^2 + (y + 10)^2);",
        );
        let (moved, centre) = about_centre(&far, &[0, 1, 2]).unwrap();
        for (c, expected) in centre.iter().zip([20.0, -10.0, 1.0 / 3.0]) {
            assert!((c.re - expected).abs() < 1e-5 && c.im == 0.0, "{centre:?}");
        }
        let expand = |s: &System| Polynomial::expand(&s.expressions, s.equations[0], 3, 0).unwrap();
        assert_eq!(expand(&moved).degree(), 4);
        assert_eq!(about_centre(&moved, &[0, 1, 2]), None);
    }

    #[test]
    fn variables_without_terms_of_the_highest_degree_have_a_centre() {
        let far = system(
            "variable_group x, y; function f; f = (y + 20000)^2 - (x - 10000)^2*(x - 9999);",
        );
        let (_, centre) = about_centre(&far, &[0, 1]).unwrap();
        let at = centre.iter().zip([10_000.0 - 1.0 / 3.0, -20_000.0]);
        assert!(
            at.into_iter().all(|(c, x)| (c.re - x).abs() < 1e-2),
            "{centre:?}"
        );
    }

    #[test]
    fn what_is_near_the_origin_or_no_polynomial_stays() {
        let near = system("variable_group x, y; function f; f = (x - 1)^2 + y^2 - 1;");
        assert_eq!(about_centre(&near, &[0, 1]), None);
        let pair = system(
            "variable_group p, q; function f; f = (p - 1000 - 2000*I)*(q - 1000 + 2000*I) - 1;",
        );
        let (_, centre) = about_centre(&pair, &[1, 0]).unwrap();
        assert_eq!(centre[0], centre[1].conj());
        assert!((centre[0] - Complex64::new(1000.0, 2000.0)).norm_sqr() < 1e-3);
    }
}
