//! Start points of the simultaneous iteration: on circles whose radii are the slopes of the Newton polygon of the
//! coefficients' sizes (D. A. Bini, Numerical computation of polynomial zeros by means of Aberth's method, 1996).

use super::exact_polynomial::ExactPolynomial;
use cognate_numeric::roots_of_unity::on_the_circle;
use rug::ops::Pow;
use rug::{Complex, Float};

/// Bits of radii: only their sizes matter.
const BITS: u32 = 53;
/// The first angle on each circle, and from one circle to the next, as part of a turn: no symmetry of a polynomial with
/// real coefficients is one of the start points. Bini's 0.7 radians, in turns.
const FIRST_TURN: f64 = 0.111_408;

/// As many start points as the polynomial has roots, none of them 0, each with this many bits.
///
/// The constant coefficient is not 0.
pub(super) fn start_points(polynomial: &ExactPolynomial, bits: u32) -> Vec<Complex> {
    let corners = newton_polygon(polynomial);
    let degree = polynomial.degree();
    let mut points = Vec::with_capacity(degree);
    for edge in corners.windows(2) {
        let [low, high] = [&edge[0], &edge[1]];
        let count = high.exponent - low.exponent;
        let slope = Float::with_val(BITS, &low.logarithm - &high.logarithm) / count as u32;
        let radius = Float::with_val(bits, Float::with_val(BITS, 2).pow(slope));
        for k in 0..count {
            let turn = k as f64 / count as f64 + low.exponent as f64 / degree as f64;
            let direction = on_the_circle(part_of_turn(turn + FIRST_TURN));
            let unit = Complex::with_val(bits, (direction.re, direction.im));
            points.push(unit * &radius);
        }
    }
    points
}

/// A number of turns as a part of 2^128 of one.
fn part_of_turn(turns: f64) -> u128 {
    let part = turns - turns.floor();
    ((part * (1u64 << 53) as f64) as u128) << 75
}

/// A corner of the upper convex hull of the points (exponent, logarithm of the coefficient's size).
struct Corner {
    exponent: usize,
    /// Logarithm to the base 2.
    logarithm: Float,
}

fn newton_polygon(polynomial: &ExactPolynomial) -> Vec<Corner> {
    let mut hull: Vec<Corner> = Vec::new();
    for (exponent, c) in polynomial.coefficients.iter().enumerate() {
        if c.is_zero() {
            continue;
        }
        let size = Float::with_val(BITS, Complex::with_val(BITS, (&c.re, &c.im)).abs_ref());
        let corner = Corner {
            exponent,
            logarithm: size.log2(),
        };
        while hull.len() >= 2 && is_below(&hull[hull.len() - 2], &hull[hull.len() - 1], &corner) {
            hull.pop();
        }
        hull.push(corner);
    }
    hull
}

/// Whether the middle one of three points is on or below the line through the others.
fn is_below(left: &Corner, middle: &Corner, right: &Corner) -> bool {
    let rise = Float::with_val(BITS, &right.logarithm - &left.logarithm);
    let part = Float::with_val(BITS, rise * (middle.exponent - left.exponent) as u32);
    let on_line = part / (right.exponent - left.exponent) as u32 + &left.logarithm;
    middle.logarithm <= on_line
}
