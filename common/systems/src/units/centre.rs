//! Centre: the point from which the solutions of a polynomial system are seen at ordinary coordinates.
//!
//! A polynomial f of degree d has f(x + c) = f_d + (f_(d-1) + sum of c_k df_d/dx_k) + ...: c by least squares makes the terms
//! below the highest small (Tschirnhaus' substitution, in several variables). Far from the origin, where that is not done, the
//! terms of an equation nearly cancel on all of its solutions.

use crate::polynomial::Polynomial;
use crate::system::System;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::rational::ComplexRational;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Solutions must look smaller from the centre by so many powers of two: else it is none.
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
    let (moved, about) = translated(system, &equations, &centre)?;
    (size(&equations) >= LEAST_GAIN + size(&about)).then_some((moved, centre))
}

/// About how large solutions are, as a power of two: that of which powers make up for the coefficients below the highest.
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
    equations
        .iter()
        .map(of_equation)
        .fold(f64::from(-BITS), f64::max)
}

/// The exponent of a positive double.
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// The centre of these equations, rounded; `None` where it is the origin or nothing determines it.
fn centre_of(equations: &[Polynomial], partner: &[usize]) -> Option<Vec<Complex64>> {
    let n = partner.len();
    let mut columns = vec![Vec::new(); n];
    let mut below = Vec::new();
    for equation in equations {
        let coefficients = equation.coefficients_at(&[]);
        let degree = equation.degree();
        let of_degree = |exponents: &Vec<u32>, degree: u32| exponents.iter().sum::<u32>() == degree;
        let highest = coefficients.iter().filter(|(e, _)| of_degree(e, degree));
        let size = highest
            .clone()
            .map(|(_, c)| c.norm_sqr())
            .sum::<f64>()
            .sqrt();
        if degree == 0 || !size.is_normal() {
            continue;
        }
        let mut rows: BTreeMap<Vec<u32>, Vec<Complex64>> = BTreeMap::new();
        let zeros = || vec![Complex64::default(); n + 1];
        for (exponents, c) in highest {
            for k in (0..n).filter(|&k| exponents[k] > 0) {
                let mut lower = exponents.clone();
                lower[k] -= 1;
                rows.entry(lower).or_insert_with(zeros)[k] += c * f64::from(exponents[k]) / size;
            }
        }
        for (exponents, c) in coefficients.iter() {
            if degree > 0 && of_degree(exponents, degree - 1) {
                rows.entry(exponents.clone()).or_insert_with(zeros)[n] -= c / size;
            }
        }
        for row in rows.into_values() {
            for (column, value) in columns.iter_mut().zip(&row) {
                column.push(*value);
            }
            below.push(row[n]);
        }
    }
    if below.is_empty() || below.iter().any(|z| !z.re.is_finite() || !z.im.is_finite()) {
        return None;
    }
    let found = Svd::of(columns);
    let largest = found.values.first().copied().unwrap_or(0.0);
    let rank = found.values.iter().filter(|&&v| v > RANK * largest).count();
    let centre = found.least_squares(&below, rank);
    let real = (0..n).map(|k| 0.5 * (centre[k] + centre[partner[k]].conj()));
    rounded(&real.collect::<Vec<_>>())
}

/// The same with few bits; `None` for the origin.
fn rounded(point: &[Complex64]) -> Option<Vec<Complex64>> {
    let largest = point
        .iter()
        .map(|z| z.re.abs().max(z.im.abs()))
        .fold(0.0, f64::max);
    if !largest.is_normal() {
        return None;
    }
    let unit = f64::from_bits(((exponent(largest) - BITS + 1023).max(1) as u64) << 52);
    let round = |x: f64| (x / unit).round() * unit;
    let point = point
        .iter()
        .map(|z| Complex64::new(round(z.re), round(z.im)));
    Some(point.collect())
}

/// The equations at x + c, multiplied out.
fn translated(
    system: &System,
    equations: &[Polynomial],
    centre: &[Complex64],
) -> Option<(System, Vec<Polynomial>)> {
    let n = centre.len();
    let mut between = crate::expression::Expressions::new();
    let mut leaves = Vec::with_capacity(n);
    for (k, &c) in centre.iter().enumerate() {
        let (x, c) = (
            between.variable(k as u32),
            between.constant(ComplexRational::from_doubles(c)?),
        );
        leaves.push(between.add(x, c));
    }
    let mut moved = System {
        expressions: crate::expression::Expressions::new(),
        equations: Vec::new(),
        scaling: Default::default(),
        symmetry: Vec::new(),
        degenerate: Default::default(),
        ..system.clone()
    };
    let own: Vec<_> = (0..n)
        .map(|k| moved.expressions.variable(k as u32))
        .collect();
    let mut about = Vec::with_capacity(equations.len());
    for equation in equations {
        let root = equation.write(&mut between, &leaves);
        let equation = Polynomial::expand(&between, root, n, 0)?;
        let root = equation.write(&mut moved.expressions, &own);
        moved.equations.push(root);
        about.push(equation);
    }
    Some((moved, about))
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
