//! MissedSlice: a point that looks like one of a set of solutions, since doubles take small terms for 0, and is none.
//!
//! A set of positive dimension through a point meets each hyperplane beside it. Where Newton's method, with many digits,
//! comes to rest on the hyperplane and leaves a residual that is small, and is not 0, there is no solution: the
//! equation y^3 x = 0 is that of a set where y is 6e-12 only as far as 34 digits tell.

use super::newton::{Newton, Number, exponent, least_squares};
use super::search::MOST_WORK;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::Complex;
use cognate_systems::evaluation::Interpreter;
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Bits of the arithmetic.
const BITS: u32 = 1024;
/// The largest correction relative to the point's size, as a power of 2, at which Newton's method is at rest.
const AT_REST: i64 = -480;
/// A residual relative to its equation's terms, as a power of 2, from which on it is not 0.
const NOT_ZERO: i64 = -400;
/// A residual relative to its equation's terms, as a power of 2, below which doubles take it for 0. Where more is left Newton's
/// method may have missed a set.
const SMALL: i64 = -40;
/// Distance of the hyperplane from the point, relative to the point's size (2^-10).
const DISTANCE: f64 = 0.000_976_562_5;
/// Newton's method goes at most this far, relative to the point's size, as a power of 2.
const FARTHEST: i64 = -4;
/// Newton steps at most.
const MOST_ROUNDS: usize = 40;
/// Bits that each correction after the first ones gains at least.
const GAIN: i64 = 8;
/// Corrections before [`GAIN`] is asked for.
const PATIENCE: usize = 3;

/// Whether the solutions of a system in its unknowns, with exact coefficients, miss a hyperplane beside a point that look
/// as if they met it.
pub fn misses_slice(
    system: &System,
    parameters: &[Complex64],
    point: &[Complex64],
    seed: u64,
) -> bool {
    let is_affine = system.groups.iter().all(|group| !group.homogeneous);
    if !is_affine || point.len() != system.variable_count() || !point.iter().all(|z| z.is_finite())
    {
        return false;
    }
    let (expressions, with_slice) = with_slice(system, point, seed);
    let program = Interpreter::compile(&expressions, &with_slice, point.len(), parameters.len());
    if program.flops() + 16 * with_slice.len() * point.len().pow(2) > MOST_WORK {
        return false;
    }
    let unknowns: Vec<usize> = (0..point.len()).collect();
    let mut newton = Newton::new(&program, parameters, &unknowns, point.len(), BITS);
    let start = point
        .iter()
        .map(|z| Complex::from_f64(BITS, z.re, z.im))
        .collect();
    let Some(rest) = at_rest(&mut newton, start) else {
        return false;
    };
    let residual = newton.relative_residual(&rest);
    residual.is_some_and(|residual| (NOT_ZERO..SMALL).contains(&residual))
}

/// The equations, and that of a hyperplane beside the point.
fn with_slice(system: &System, point: &[Complex64], seed: u64) -> (Expressions, Vec<NodeId>) {
    let mut expressions = system.expressions.clone();
    let mut random = RandomStream::new(seed, Purpose::Probe, 5);
    let exact = |z: Complex64| ComplexRational::from_doubles(z).unwrap_or_default();
    let part = |size: f64, z: &Complex64| size.max(z.re.abs()).max(z.im.abs());
    let size = point.iter().fold(1.0, part);
    let mut sum = expressions.constant(exact(Complex64::from(-size * DISTANCE)));
    for (v, z) in (0..).zip(point) {
        let (variable, at_point) = (expressions.variable(v), expressions.constant(exact(*z)));
        let difference = expressions.subtract(variable, at_point);
        let weight = expressions.constant(exact(random.unit()));
        let term = expressions.multiply(weight, difference);
        sum = expressions.add(sum, term);
    }
    let mut equations = system.equations.clone();
    equations.push(sum);
    (expressions, equations)
}

/// The point at which Newton's method comes to rest, by least squares; `None` where it does not, or goes far.
fn at_rest(newton: &mut Newton<'_>, start: Vec<Number>) -> Option<Vec<Number>> {
    let size_of = |x: &[Number]| x.iter().filter_map(exponent).max();
    let size = size_of(&start).unwrap_or(0).max(0);
    let farthest = size + FARTHEST;
    let mut x = start.clone();
    let mut last = i64::MAX;
    for round in 0..MOST_ROUNDS {
        let (columns, values) = newton.linearization(&x);
        let delta = least_squares(BITS, &columns, &values)?;
        let correction = size_of(&delta).map_or(i64::MIN, |moved| moved - size);
        for (x, delta) in x.iter_mut().zip(&delta) {
            x.sub(delta);
        }
        let mut away = x.clone();
        for (away, start) in away.iter_mut().zip(&start) {
            away.sub(start);
        }
        if size_of(&away).is_some_and(|away| away > farthest) {
            return None;
        }
        if correction <= AT_REST {
            return Some(x);
        }
        if round >= PATIENCE && correction > last - GAIN {
            return None;
        }
        last = correction;
    }
    None
}
