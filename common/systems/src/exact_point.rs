//! Exact point: whether an endpoint is next to a solution with small rational coordinates, which exact arithmetic
//! proves.
//!
//! Most multiple points of textbooks are rational. At a rational point the dual space is that of one point, not of
//! several that are nearer together than the digits of an endpoint, and only rounding stands between values and noise.
//! A comparison of a rational point with a rational number is exact.

use crate::expression::differentiate::below;
use crate::expression::{Node, NodeId, exact};
use crate::system::System;
use cognate_numeric::rational::{ComplexRational, Rational};
use num_complex::Complex64;
use std::collections::HashMap;

/// Denominators are at most this.
const LARGEST_DENOMINATOR: u64 = 1000;
/// A rational number as near to a coordinate as this, relative to its size or 1, is tried, however exact that is.
const NEAR: f64 = 1e-11;
/// Numbers that may have more bits than this are not computed, nor
const MOST_BITS: u64 = 100_000;
/// more than this in all of them together.
const MOST_BITS_IN_ALL: u64 = 20_000_000;

/// The solution with small rational coordinates within this relative error of a point of affine groups, exactly;
/// `None` where there is none, or the equations are not rational.
pub fn exact_point(
    system: &System,
    parameters: &[ComplexRational],
    point: &[Complex64],
    error: f64,
) -> Option<Vec<ComplexRational>> {
    if system.groups.iter().any(|group| group.homogeneous) {
        return None;
    }
    let near = |z: &Complex64| near(*z, error.max(NEAR) * z.norm_sqr().sqrt().max(1.0));
    let point: Option<Vec<_>> = point.iter().map(near).collect();
    point.filter(|point| solves(system, &system.equations, parameters, point))
}

/// Whether equations are 0 at a point, where that can be computed exactly.
fn solves(
    system: &System,
    equations: &[NodeId],
    parameters: &[ComplexRational],
    point: &[ComplexRational],
) -> bool {
    if !is_small(system, equations, point, parameters) {
        return false;
    }
    let values = exact::values(&system.expressions, equations, point, parameters);
    let is_zero =
        |value: &Option<ComplexRational>| value.as_ref().is_some_and(ComplexRational::is_zero);
    values.iter().all(is_zero)
}

/// The number with small rational parts within this distance of a coordinate.
fn near(z: Complex64, error: f64) -> Option<ComplexRational> {
    Some(ComplexRational::new(
        simplest_within(z.re, error)?,
        simplest_within(z.im, error)?,
    ))
}

/// The coordinates of a nonsingular solution that are rational numbers by the equations, not only within its error,
/// which is relative to its largest coordinate.
///
/// All are where the whole point is rational. Else a coordinate is where one equation is 0 for every point with this
/// coordinate: the other equations then have a nonsingular solution with it next to this one, which is this one.
/// Whether an equation is 0 for all points with this coordinate is tested at a general one, so that the answer holds
/// with probability 1.
pub fn exact_coordinates(
    system: &System,
    parameters: &[ComplexRational],
    point: &[Complex64],
    error: f64,
) -> Vec<Option<ComplexRational>> {
    let mut exact = vec![None; point.len()];
    if system.groups.iter().any(|group| group.homogeneous) {
        return exact;
    }
    let largest = point.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    let error = error * largest.sqrt();
    let candidates: Vec<_> = point.iter().map(|z| near(*z, error)).collect();
    let whole: Option<Vec<ComplexRational>> = candidates.iter().cloned().collect();
    if whole.is_some_and(|point| solves(system, &system.equations, parameters, &point)) {
        return candidates;
    }
    if system.equations.len() != point.len() {
        return exact;
    }
    let mut open: Vec<NodeId> = system.equations.clone();
    loop {
        let before = open.len();
        for (place, candidate) in candidates.iter().enumerate() {
            if exact[place].is_some() || candidate.is_none() {
                continue;
            }
            let mut with = exact.clone();
            with[place].clone_from(candidate);
            let vanishes = open.iter().position(|equation| {
                vanishes(system, parameters, *equation, &with)
                    && !vanishes(system, parameters, *equation, &exact)
            });
            if let Some(equation) = vanishes {
                open.remove(equation);
                exact = with;
            }
        }
        if open.len() == before {
            return exact;
        }
    }
}

/// Whether an equation is 0 at a general point with these coordinates.
fn vanishes(
    system: &System,
    parameters: &[ComplexRational],
    equation: NodeId,
    coordinates: &[Option<ComplexRational>],
) -> bool {
    // Multiples of the golden ratio modulo 1, as fractions: no equation of anybody knows them.
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;
    let general = |place: usize| {
        let numerator = STEP.wrapping_mul(place as u64 + 1) >> 32;
        ComplexRational::real(Rational::from((numerator, 1u64 << 20)))
    };
    let places = coordinates.iter().enumerate();
    let point = places.map(|(place, exact)| exact.clone().unwrap_or_else(|| general(place)));
    let point: Vec<ComplexRational> = point.collect();
    solves(system, &[equation], parameters, &point)
}

/// Bits of a numerator and of a denominator that is not 1.
type Bits = (u64, u64);

fn bits(value: &ComplexRational) -> Bits {
    let part_bits = |part: &Rational| -> Bits {
        let denominator = match *part.denom() == 1 {
            true => 0,
            false => u64::from(part.denom().significant_bits()),
        };
        (u64::from(part.numer().significant_bits()), denominator)
    };
    sum(part_bits(&value.re), part_bits(&value.im))
}

/// A bound for a sum of two numbers.
fn sum(a: Bits, b: Bits) -> Bits {
    let numerator = a.0.saturating_add(b.1).max(b.0.saturating_add(a.1));
    (numerator.saturating_add(1), a.1.saturating_add(b.1))
}

/// A bound for a product of two numbers.
fn product(a: Bits, b: Bits) -> Bits {
    let numerator = a.0.saturating_add(b.0).saturating_add(1);
    (numerator, a.1.saturating_add(b.1))
}

/// Whether the values of equations can be computed exactly in little time and memory, by bounds for the numbers at all
/// their nodes.
fn is_small(
    system: &System,
    equations: &[NodeId],
    point: &[ComplexRational],
    parameters: &[ComplexRational],
) -> bool {
    let mut bounds: HashMap<NodeId, Bits> = HashMap::new();
    let mut in_all = 0u64;
    for id in below(&system.expressions, equations) {
        let given = |values: &[ComplexRational], k: &u32| values.get(*k as usize).map(bits);
        let bound = match system.expressions.node(id) {
            Node::Constant(c) => Some(bits(c)),
            Node::Variable(v) => given(point, v),
            Node::Parameter(p) => given(parameters, p),
            Node::Add(a, b) | Node::Subtract(a, b) => Some(sum(bounds[a], bounds[b])),
            Node::Multiply(a, b) => Some(product(bounds[a], bounds[b])),
            // By the conjugate, over the square of the modulus.
            Node::Divide(a, b) => {
                let (numerator, denominator) = product(bounds[b], bounds[b]);
                let modulus_bits = numerator.saturating_add(denominator).saturating_mul(2);
                Some(product(
                    product(bounds[a], bounds[b]),
                    (modulus_bits, modulus_bits),
                ))
            }
            Node::Negate(a) => Some(bounds[a]),
            Node::Power(a, exponent) => {
                let (numerator, denominator) = bounds[a];
                let times = |bits: u64| bits.saturating_mul(u64::from(*exponent));
                Some((times(numerator.saturating_add(1)), times(denominator)))
            }
            Node::Root(..) | Node::Function(..) => None,
        };
        let Some(bound) = bound else {
            return false;
        };
        let bits = bound.0.saturating_add(bound.1);
        in_all = in_all.saturating_add(bits);
        if bits > MOST_BITS || in_all > MOST_BITS_IN_ALL {
            return false;
        }
        bounds.insert(id, bound);
    }
    true
}

/// The fraction with the least denominator that is within `error` of a number, by its continued fraction.
fn simplest_within(value: f64, error: f64) -> Option<Rational> {
    if !(value.is_finite() && value.abs() < 1e15) {
        return None;
    }
    let (mut before, mut last) = ((0i128, 1i128), (1i128, 0i128));
    let mut rest = value;
    loop {
        let whole = rest.round();
        let convergent = |k: fn((i128, i128)) -> i128| whole as i128 * k(last) + k(before);
        let (numerator, denominator) = (convergent(|p| p.0), convergent(|p| p.1));
        if denominator.unsigned_abs() > u128::from(LARGEST_DENOMINATOR) || denominator == 0 {
            return None;
        }
        if (value - numerator as f64 / denominator as f64).abs() <= error {
            return Some(Rational::from((numerator, denominator)));
        }
        (before, last) = (last, (numerator, denominator));
        let fraction = rest - whole;
        if fraction == 0.0 {
            return None;
        }
        rest = 1.0 / fraction;
        if rest.abs() > 1e15 {
            return None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simple_fractions_are_found() {
        for (numerator, denominator) in [(0, 1), (1, 3), (-22, 7), (355, 113), (5, 1), (-499, 1000)]
        {
            let value = f64::from(numerator) / f64::from(denominator);
            let simplest_fraction = simplest_within(value + 1e-13, 1e-11);
            assert_eq!(
                simplest_fraction,
                Some(Rational::from((numerator, denominator)))
            );
        }
        for value in [
            std::f64::consts::PI,
            f64::NAN,
            f64::INFINITY,
            1e300,
            1.0 / 1009.0,
        ] {
            assert_eq!(simplest_within(value, 1e-11), None, "{value}");
        }
    }

    #[test]
    fn a_coordinate_that_an_equation_fixes_is_exact_beside_others_that_are_not() {
        let text = "x*y = 0\n(x - 2)*z = z*y\nz^2 + x = 2 + y^3 - 3*y";
        let system = crate::formats::read("test", text.as_bytes())
            .unwrap()
            .system;
        let exact = |x: f64, y: f64, z: f64| {
            let point = [x, y, z].map(|value| Complex64::new(value, 0.0));
            let exact = exact_coordinates(&system, &[], &point, 1e-15);
            exact.iter().map(Option::is_some).collect::<Vec<bool>>()
        };
        let root = 2.0f64.sqrt();
        // The whole point, then x alone, then y and with it x, then none.
        assert_eq!(exact(2.0, 0.0, 0.0), [true, true, true]);
        assert_eq!(exact(0.0, root, 0.5), [true, false, false]);
        assert_eq!(exact(2.0, 0.0, root), [true, true, false]);
        assert_eq!(exact(root, root, root), [false, false, false]);
    }

    #[test]
    fn only_solutions_are_taken() {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y; function f, g;\nf = (3*x - 1)^4; g = x*y - 2/3;\nEND;\n";
        let system = crate::formats::read("test", text.as_bytes())
            .unwrap()
            .system;
        let near = |x: f64, y: f64| {
            let point = [Complex64::new(x, 1e-12), Complex64::new(y, 0.0)];
            exact_point(&system, &[], &point, 1e-11)
        };
        let third = ComplexRational::real(Rational::from((1, 3)));
        let two = ComplexRational::real(Rational::from(2));
        assert_eq!(near(1.0 / 3.0 + 3e-12, 2.0), Some(vec![third, two]));
        assert_eq!(near(1.0 / 3.0, 2.001), None);
        assert_eq!(near(0.4, 2.0), None);
        // Solved at (2, 1/3), which is not computed.
        let tower = text.replace("(3*x - 1)^4", "(x - 2)^90000");
        let system = crate::formats::read("test", tower.as_bytes())
            .unwrap()
            .system;
        let point = [Complex64::new(2.0, 0.0), Complex64::new(1.0 / 3.0, 0.0)];
        assert_eq!(exact_point(&system, &[], &point, 1e-11), None);
    }
}
