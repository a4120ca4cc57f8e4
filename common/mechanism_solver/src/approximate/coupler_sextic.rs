//! The coupler curve of a four-bar as the zeros of a polynomial of degree 6 in the place of the coupler point, with
//! derivatives by the place and by the linkage.
//!
//! With z the direction of the coupler, A = p + r z and B = p + (s + i t) z are its joints when its point is at p. Their
//! distances from the pivots give u z + conj(u z) = -m and v z + conj(v z) = -n, where u = conj(p - A0) r,
//! v = conj(p - B0) (s + i t), m = |p - A0|^2 + r^2 - l^2, n likewise. Elimination of z by |z| = 1 gives
//! |n conj(u) - m conj(v)|^2 = 4 Im(u conj(v))^2 (after Roberts 1876).

use cognate_kinematics::linkage::Linkage;
use cognate_kinematics::plane::{direction, modulus};
use num_complex::Complex64;
use std::ops::{Add, Mul, Sub};

/// Numbers that describe a linkage: pivots A0 and B0 (x, y), r, s, t, and the squares of the lengths of both sides.
pub const NUMBERS: usize = 9;
/// Derivatives: by the place of the point, then by the numbers.
const DERIVATIVES: usize = NUMBERS + 2;
/// Directions of the first side in which a position of the linkage is looked for, in a turn.
const DIRECTIONS: u32 = 360;

/// A value with its derivatives.
#[derive(Clone, Copy, Debug)]
struct Jet {
    value: f64,
    derivatives: [f64; DERIVATIVES],
}

impl Jet {
    const ZERO: Self = Self {
        value: 0.0,
        derivatives: [0.0; DERIVATIVES],
    };

    fn variable(value: f64, place: usize) -> Self {
        let mut derivatives = [0.0; DERIVATIVES];
        derivatives[place] = 1.0;
        Self { value, derivatives }
    }

    fn scaled(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            derivatives: self.derivatives.map(|derivative| derivative * factor),
        }
    }

    fn square(self) -> Self {
        self * self
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            derivatives: std::array::from_fn(|k| self.derivatives[k] + other.derivatives[k]),
        }
    }
}

impl Sub for Jet {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            derivatives: std::array::from_fn(|k| self.derivatives[k] - other.derivatives[k]),
        }
    }
}

impl Mul for Jet {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            ..self.scaled(other.value).add(other.scaled(self.value))
        }
    }
}

/// The polynomial at a place.
#[derive(Clone, Copy, Debug)]
pub struct SexticValue {
    /// The value.
    pub value: f64,
    /// Derivatives by the place.
    pub by_place: Complex64,
    /// Derivatives by the numbers of the linkage.
    pub by_numbers: [f64; NUMBERS],
}

/// The polynomial and its derivatives.
pub fn sextic(place: Complex64, numbers: &[f64; NUMBERS]) -> SexticValue {
    let [x, y] = [(place.re, 0), (place.im, 1)].map(|(value, k)| Jet::variable(value, k));
    let number = |k: usize| Jet::variable(numbers[k], k + 2);
    let (ax, ay) = (x - number(0), y - number(1));
    let (bx, by) = (x - number(2), y - number(3));
    let (r, s, t) = (number(4), number(5), number(6));
    // u = conj(p - A0) r, v = conj(p - B0) (s + i t).
    let (ur, ui) = (ax * r, Jet::ZERO - ay * r);
    let (vr, vi) = (bx * s + by * t, bx * t - by * s);
    let m = ax.square() + ay.square() + r.square() - number(7);
    let n = bx.square() + by.square() + s.square() + t.square() - number(8);
    let across = (n * ur - m * vr).square() + (n * ui - m * vi).square();
    let along = ui * vr - ur * vi;
    let square = along.square();
    let polynomial = across - (square + square + square + square);
    let [dx, dy, by_numbers @ ..] = polynomial.derivatives;
    SexticValue {
        value: polynomial.value,
        by_place: Complex64::new(dx, dy),
        by_numbers,
    }
}

/// A position of the linkage with these numbers; `None` where it cannot be assembled.
pub fn position(numbers: &[f64; NUMBERS]) -> Option<Linkage> {
    let [a0x, a0y, b0x, b0y, r, s, t, first, second] = *numbers;
    let pivots = [Complex64::new(a0x, a0y), Complex64::new(b0x, b0y)];
    let (to_a, to_b) = (Complex64::from(r), Complex64::new(s, t));
    let coupler = modulus(to_b - to_a);
    if first <= 0.0 || second <= 0.0 || coupler == 0.0 {
        return None;
    }
    let (first, second) = (first.sqrt(), second.sqrt());
    (0..DIRECTIONS).find_map(|k| {
        let turn = 360.0 * f64::from(k) / f64::from(DIRECTIONS);
        let a = pivots[0] + direction(turn) * first;
        let way = pivots[1] - a;
        let distance = modulus(way);
        let is_spanned = distance < coupler + second && distance > (coupler - second).abs();
        if !is_spanned {
            return None;
        }
        // Where the circles about A and B0 meet.
        let along = (distance * distance + coupler * coupler - second * second) / (2.0 * distance);
        let across = (coupler * coupler - along * along).max(0.0).sqrt();
        let b = a + way / distance * Complex64::new(along, across);
        let turn = (b - a) / (to_b - to_a);
        Some(Linkage {
            pivots,
            joints: [a, b],
            point: a - to_a * turn,
        })
    })
}

/// The numbers of a linkage.
pub fn numbers(linkage: &Linkage) -> Option<[f64; NUMBERS]> {
    let [a0, b0] = linkage.pivots;
    let [to_a, to_b] = linkage.joints.map(|joint| joint - linkage.point);
    let r = modulus(to_a);
    if r == 0.0 {
        return None;
    }
    let turned = to_b * to_a.conj() / r;
    let sides = [0, 1].map(|k| (linkage.joints[k] - linkage.pivots[k]).norm_sqr());
    Some([
        a0.re, a0.im, b0.re, b0.im, r, turned.re, turned.im, sides[0], sides[1],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_kinematics::coupler_curve::circuits;

    fn linkage() -> Linkage {
        Linkage {
            pivots: [Complex64::new(0.0, 0.0), Complex64::new(4.0, 0.5)],
            joints: [Complex64::new(0.0, 1.0), Complex64::new(3.0, 2.8)],
            point: Complex64::new(1.0, 3.0),
        }
    }

    #[test]
    fn the_polynomial_vanishes_on_the_curve_and_not_beside_it() {
        let numbers = numbers(&linkage()).expect("a point that is no joint");
        for circuit in circuits(&linkage()) {
            for point in circuit.points.iter().step_by(37) {
                let here = sextic(*point, &numbers);
                let beside = sextic(
                    point + here.by_place / modulus(here.by_place) * 0.1,
                    &numbers,
                );
                assert!(here.value.abs() < 1e-9 * beside.value.abs(), "{point}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let numbers = numbers(&linkage()).expect("a point that is no joint");
        let place = Complex64::new(0.7, 2.1);
        let here = sextic(place, &numbers);
        let step = 1e-6;
        for k in 0..NUMBERS {
            let mut moved = [numbers; 2];
            moved[0][k] += step;
            moved[1][k] -= step;
            let [more, less] = moved.map(|numbers| sextic(place, &numbers).value);
            let difference = (more - less) / (2.0 * step);
            let size = here.by_numbers[k].abs().max(1.0);
            assert!((difference - here.by_numbers[k]).abs() < 1e-6 * size, "{k}");
        }
        let [more, less] = [step, -step].map(|d| sextic(place + d, &numbers).value);
        assert!(
            ((more - less) / (2.0 * step) - here.by_place.re).abs() < 1e-6 * here.by_place.re.abs()
        );
    }

    #[test]
    fn a_position_has_the_numbers_of_its_linkage() {
        let expected = numbers(&linkage()).expect("a point that is no joint");
        let linkage = position(&expected).expect("it can be assembled");
        let assembled = numbers(&linkage).expect("a point that is no joint");
        for (a, b) in expected.iter().zip(assembled) {
            assert!((a - b).abs() < 1e-12, "{expected:?} {assembled:?}");
        }
    }
}
