//! Infinity: whether a homogenising coordinate vanishes at t = 0, from turns around it.
//!
//! A closed path has joined as many sheets as it made turns. The power sums of a coordinate over the
//! sheets are analytic in t, so that their values at t = 0 are means over the samples of all turns; by
//! Newton's identities they are all 0 where every sheet's value is, and only there. One radius is
//! enough for that, and the larger it is, the fewer digits are needed: branch points inside join
//! sheets with different ends, whose power sums are not 0.

use super::cauchy::VERTICES;
use cognate_numeric::scalar::{Complex, DoubleDouble, Real};
use num_complex::Complex64;

/// A homogenising coordinate with the digits of double-doubles, where a path has as many: whether
/// it vanishes at t = 0 shows in powers of it.
pub(crate) type Homogenizing = Complex<DoubleDouble<f64>>;

/// A homogenising coordinate is believed to vanish where solutions at which it is this or more would
/// show: their norm is 1e10 or less.
const FARTHEST: f64 = 1e-10;
/// Errors of homogenising coordinates are at most so many times the last Newton correction.
const NOISE: f64 = 100.0;
/// Aliasing errors are at most so many times their estimate.
const ALIASING: f64 = 10.0;
/// Where several sheets end together, so far out, only their power sums show what is not 0: a power sum
/// this small would be one of equations that have infinity to 20 digits.
const LEAST_POWER_SUM: f64 = 1e-20;
/// A power sum that exceeds its estimated error by this factor is not 0.
const CLEARLY: f64 = 100.0;

/// What the samples of a closed path say of infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Infinity {
    /// A homogenising coordinate vanishes at t = 0.
    Shown,
    /// It does as far as these digits tell, which is not far enough.
    BelowNoise,
    /// None does.
    No,
    /// None does on all sheets: branch points that lie inside join them.
    Apart {
        /// How far out they lie, as a part of the radius, about.
        part: f64,
        /// The power sum that is not 0: equations that differ by so much may have infinity there.
        power_sum: f64,
    },
}

/// Whether a homogenising coordinate vanishes at t = 0 on all the sheets that a closed path has joined.
///
/// `samples`: its values at all vertices of all turns, in their order; `sheets`: the number of turns;
/// `turns`: whether it turned around 0; `noise`: relative error of the samples; `size`: the largest coordinate.
pub(super) fn vanishes(
    samples: &[&Homogenizing],
    sheets: u32,
    turns: bool,
    noise: f64,
    size: f64,
) -> Infinity {
    let inverse = Complex::from_f64((), 1.0 / size, 0.0);
    let values: Vec<Homogenizing> = samples.iter().map(|z| product(z, &inverse)).collect();
    let largest = values.iter().fold(0.0f64, |m, z| m.max(modulus(z.lane(0))));
    let noise = NOISE * noise.max(f64::EPSILON * f64::EPSILON);
    if !(turns || largest <= noise) {
        return Infinity::No;
    }
    let mut powers = values.clone();
    let (mut scale, mut limit) = (1.0, 1.0f64);
    let mut found = Infinity::Shown;
    for k in 1..=sheets {
        if k > 1 {
            for (power, value) in powers.iter_mut().zip(&values) {
                power.mul(value);
            }
        }
        let PowerMean { mean, aliasing } = PowerMean::of(&powers);
        let noise = f64::from(k) * noise * scale;
        scale *= largest;
        limit *= FARTHEST;
        let bound = noise + aliasing;
        if !(mean <= bound) {
            // Where y_0^c = b + a t, the mean of the power is b and y_0^c at the radius is a t.
            let part = mean / scale.max(f64::MIN_POSITIVE);
            let power_sum = mean;
            return match mean > CLEARLY * bound && part.is_finite() {
                true => Infinity::Apart { part, power_sum },
                false => Infinity::No,
            };
        }
        let limit = limit.max(LEAST_POWER_SUM);
        if noise > limit {
            found = Infinity::BelowNoise;
        } else if bound > limit {
            return Infinity::No;
        }
    }
    found
}

/// The mean of a power over the samples of a closed path: its power sum at t = 0.
struct PowerMean {
    /// Its modulus.
    mean: f64,
    /// Estimated error of replacing the integral by a sum.
    aliasing: f64,
}

impl PowerMean {
    /// `powers`: the power at each sample, in the order of the samples.
    fn of(powers: &[Homogenizing]) -> Self {
        let every = |step: usize| {
            let mut sum: Homogenizing = Complex::zero(());
            for power in powers.iter().step_by(step) {
                sum.add(power);
            }
            sum.lane(0) / powers.len().div_ceil(step) as f64
        };
        let (all, half, quarter) = (every(1), every(2), every(4));
        // Fourier coefficients fall by a factor from one to the next: the error of 16 samples is to that
        // of 8 as the square of that of 8 to that of 4.
        let (of_half, of_quarter) = (modulus(half - all), modulus(quarter - all));
        let ratio = (of_half / of_quarter.max(f64::MIN_POSITIVE)).min(1.0);
        Self {
            mean: modulus(all),
            aliasing: ALIASING * of_half * ratio * ratio,
        }
    }
}

/// The value at a vertex of the circle itself, from that at the double `t` next to it.
///
/// `valuation`: t x'/x there. A power of the value would show the rounding of `t`.
pub(super) fn at_exact_vertex(
    value: &Homogenizing,
    valuation: Complex64,
    t: Complex64,
    radius: f64,
    vertex: u32,
) -> Homogenizing {
    let mut off = exact_vertex(radius, vertex);
    off.sub(&Complex::from_f64((), t.re, t.im));
    let change = valuation * off.lane(0) / t;
    let mut moved = value.clone();
    moved.mul_add(&Complex::from_f64((), change.re, change.im), value);
    moved
}

/// Vertex number `vertex` of the regular polygon of [`VERTICES`] sides, with the digits of double-doubles.
fn exact_vertex(radius: f64, vertex: u32) -> Homogenizing {
    // Halving the angle pi/4 once: 2 cos^2 = 1 + cos.
    let number = |value: f64| DoubleDouble::from_f64((), value);
    let mut half_root = number(0.5);
    half_root.sqrt();
    let halved = |sign: f64| {
        let mut square = half_root;
        square.mul(&number(sign));
        square.add(&number(1.0));
        square.mul(&number(0.5));
        square.sqrt();
        square
    };
    let (cosine, sine) = (halved(1.0), halved(-1.0));
    let first = Complex {
        re: cosine,
        im: sine,
    };
    let mut place = Complex::from_f64((), radius, 0.0);
    for _ in 0..vertex % VERTICES {
        place.mul(&first);
    }
    place
}

/// |z|, without libm.
fn modulus(z: Complex64) -> f64 {
    z.norm_sqr().sqrt()
}

fn product(a: &Homogenizing, b: &Homogenizing) -> Homogenizing {
    let mut product: Homogenizing = Complex::zero(());
    product.set_product(a, b);
    product
}
