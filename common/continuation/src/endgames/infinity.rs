//! Infinity: whether a homogenising coordinate vanishes at t = 0, from turns around it.
//!
//! A closed path has joined as many sheets as it made turns. The power sums of a coordinate over the
//! sheets are analytic in t, so that their values at t = 0 are means over the samples of all turns; by
//! Newton's identities they are all 0 where every sheet's value is, and only there. One radius is
//! enough for that, and the larger it is, the fewer digits are needed: branch points inside join
//! sheets with different ends, whose power sums are not 0.

use super::circle::{VERTICES, exact_vertex};
use crate::tracker::settings::Settings;
use cognate_numeric::scalar::{Complex, DoubleDouble};
use num_complex::Complex64;

/// A homogenising coordinate with the digits of double-doubles, where a path has as many: whether
/// it vanishes at t = 0 shows in powers of it.
pub(crate) type Homogenizing = Complex<DoubleDouble<f64>>;

/// A homogenising coordinate is believed to vanish where solutions at which it is this or more would
/// show: their norm is 1e10 or less.
const FARTHEST: f64 = 1e-10;
/// Bound below which the value at t = 0 of a path that is alone must be shown to lie: the path may end as far out as
/// coefficients with that many digits take it.
const FARTHEST_ALONE: f64 = 1e-12;
/// Bound of the errors of homogenising coordinates, as a multiple of the last Newton correction.
const NOISE: f64 = 100.0;
/// Bound of aliasing errors, as a multiple of their estimate.
const ALIASING: f64 = 10.0;
/// Least power sum that is told from 0 where several sheets end together far out, where only power sums show that they
/// do not end at infinity. Equations with a smaller power sum have infinity to 20 digits.
pub const LEAST_POWER_SUM: f64 = 1e-20;
/// Values that double-doubles show, with the noise of turns.
const SHOWN: f64 = 1e-28;
/// Where more digits are wanted, an aliasing error is small enough if it is expected to be at most this part of its
/// bound.
const SMALL_ENOUGH: f64 = 0.01;
/// A power sum that exceeds its estimated error by this factor is not 0.
const CLEARLY: f64 = 100.0;

/// Conclusion from the samples of a closed path on whether the path goes to infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Infinity {
    /// A homogenising coordinate vanishes at t = 0.
    Shown,
    /// A homogenising coordinate vanishes as far as these digits tell, which is not far enough.
    BelowNoise {
        /// Part of this radius, about, at which more digits are expected to show it.
        within: f64,
    },
    /// The samples are too few to show whether a homogenising coordinate vanishes.
    Unresolved,
    /// No homogenising coordinate vanishes.
    No,
    /// No homogenising coordinate vanishes on all sheets: branch points inside the radius join the sheets.
    Apart {
        /// Distance of these branch points from 0, about, as a part of the radius.
        part: f64,
        /// The power sum that is not 0; equations that differ by this amount may have a solution at infinity there.
        power_sum: f64,
    },
}

/// Below what values and power sums at t = 0 count as 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zero {
    /// Values on one sheet.
    pub alone: f64,
    /// Values on several sheets.
    pub value: f64,
    /// Power sums.
    pub power_sum: f64,
}

impl Zero {
    /// Coefficients that are exact to many digits, or differ by many orders of magnitude, have smaller values and
    /// power sums that are not 0: products of several small coefficients, or of what rounding makes.
    ///
    /// Exact coefficients of many digits take several sheets together far out without this range: where turns can be
    /// made with more digits, turns in doubles do not decide.
    pub(super) fn of(settings: &Settings, may_be_finer: bool) -> Self {
        let accuracy = settings.data_accuracy;
        match (settings.exact_data, accuracy > 0.0) {
            (true, true) => {
                let value = Self::value(accuracy);
                Self {
                    alone: FARTHEST_ALONE.min(value),
                    value,
                    power_sum: LEAST_POWER_SUM
                        .min(accuracy * accuracy * accuracy)
                        .max(1e-60),
                }
            }
            (false, false) if may_be_finer => Self {
                value: LEAST_POWER_SUM,
                ..Self::EXACT
            },
            _ => Self::EXACT,
        }
    }

    /// A coordinate may be a product of several coefficients: four, as far as double-doubles tell, and two as far as
    /// any number does.
    fn value(accuracy: f64) -> f64 {
        let two = accuracy * accuracy;
        FARTHEST.min(two).min((two * two).max(SHOWN)).max(1e-40)
    }

    /// Bounds for integers, fractions and short decimals.
    const EXACT: Self = Self {
        alone: FARTHEST_ALONE,
        value: FARTHEST,
        power_sum: LEAST_POWER_SUM,
    };
}

/// Whether a homogenising coordinate vanishes at t = 0 on all the sheets that a closed path has joined.
///
/// `samples`: its values at all vertices of all turns, in their order; `sheets`: the number of turns;
/// `turns`: whether it turned around 0; `noise`: relative error of the samples; `size`: the largest
/// coordinate; `zero`: below what values count as 0.
pub(super) fn vanishes(
    samples: &[&Homogenizing],
    sheets: u32,
    turns: bool,
    noise: f64,
    size: f64,
    zero: Zero,
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
    let mut verdict = Infinity::Shown;
    let (mut farthest, mut power_sum) = (None, 0.0f64);
    let mut within = 1.0f64;
    for k in 1..=sheets {
        if k > 1 {
            for (power, value) in powers.iter_mut().zip(&values) {
                power.mul(value);
            }
        }
        let PowerMean { mean, aliasing } = PowerMean::of(&powers);
        let noise = f64::from(k) * noise * scale;
        scale *= largest;
        limit = match sheets {
            1 => zero.alone,
            _ => (limit * zero.value).max(zero.power_sum),
        };
        let bound = noise + aliasing;
        if !mean.is_finite() {
            return Infinity::No;
        }
        // One sheet ends at a regular point, however far out; several that part only below this do not.
        let is_zero = sheets > 1 && mean <= zero.power_sum;
        if mean > CLEARLY * bound && !is_zero {
            // Where y_0^c = b + a t, the mean of power c is b and y_0^c at the radius is a t; a mean of
            // power k speaks of values at t = 0 whose power c is that to c/k.
            let ratio = mean / scale.max(f64::MIN_POSITIVE);
            let part = (0..sheets / k).fold(1.0, |part, _| part * ratio);
            farthest = Some(farthest.map_or(part, |most: f64| most.max(part)));
            power_sum = power_sum.max(mean);
        } else if (mean > bound && !is_zero) || bound > limit {
            // Where more samples are wanted as well, a smaller radius gives both.
            within = within.min(radius_ratio(SMALL_ENOUGH * limit, aliasing));
            verdict = match verdict {
                Infinity::Shown | Infinity::BelowNoise { .. } if mean <= bound && noise > limit => {
                    Infinity::BelowNoise { within }
                }
                _ => Infinity::Unresolved,
            };
        }
    }
    match farthest {
        Some(part) if part.is_finite() => Infinity::Apart { part, power_sum },
        Some(_) => Infinity::No,
        None => verdict,
    }
}

/// The mean of a power over the samples of a closed path: its power sum at t = 0.
struct PowerMean {
    /// Modulus of the mean.
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
        let (full, half, quarter) = (every(1), every(2), every(4));
        // Fourier coefficients fall by a factor from one to the next: the error of 16 samples is to that
        // of 8 as the square of that of 8 to that of 4.
        let (of_half, of_quarter) = (modulus(half - full), modulus(quarter - full));
        let ratio = (of_half / of_quarter.max(f64::MIN_POSITIVE)).min(1.0);
        Self {
            mean: modulus(full),
            aliasing: ALIASING * of_half * ratio * ratio,
        }
    }
}

/// The part of a radius at which an aliasing error of `error` there becomes `wanted`, at most 1: with 16 samples a turn
/// it falls with the 16th power of the radius.
fn radius_ratio(wanted: f64, error: f64) -> f64 {
    let mut ratio = (wanted / error.max(f64::MIN_POSITIVE)).min(1.0);
    let mut power = VERTICES;
    while power > 1 {
        ratio = ratio.sqrt();
        power /= 2;
    }
    ratio
}

/// Distance of a vertex of the circle from the double `t` next to it.
pub(super) fn beside_vertex(t: Complex64, radius: f64, vertex: u32) -> Complex64 {
    let mut off = exact_vertex(radius, vertex);
    off.sub(&Complex::from_f64((), t.re, t.im));
    off.lane(0)
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
    let change = valuation * beside_vertex(t, radius, vertex) / t;
    let mut moved = *value;
    moved.mul_add(&Complex::from_f64((), change.re, change.im), value);
    moved
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

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::roots_of_unity::roots_of_unity;

    /// y_0 with y_0^c = b + t at all vertices of c turns, from each to the next by Newton's method.
    fn samples(c: u32, b: f64, radius: f64) -> Vec<Homogenizing> {
        let number = |value: f64| Homogenizing::from_f64((), value, 0.0);
        let mut last = number(0.5);
        let mut values = Vec::new();
        for vertex in 0..c * VERTICES {
            // Between two vertices are places enough that a sheet is not left.
            let (from, to) = (
                exact_vertex(radius, vertex + VERTICES - 1),
                exact_vertex(radius, vertex),
            );
            for part in 1..=8 {
                let mut wanted = to;
                wanted.sub(&from);
                wanted.mul(&number(f64::from(part) / 8.0));
                wanted.add(&from);
                wanted.add(&number(b));
                for _ in 0..60 {
                    let mut power = number(1.0);
                    (1..c).for_each(|_| power.mul(&last));
                    let mut value = product(&power, &last);
                    value.sub(&wanted);
                    power.mul(&number(f64::from(c)));
                    value.mul(&power.inverse());
                    last.sub(&value);
                }
            }
            values.push(last);
        }
        values
    }

    fn infinity_at(c: u32, b: f64, radius: f64, noise: f64) -> Infinity {
        let samples = samples(c, b, radius);
        let samples: Vec<_> = samples.iter().collect();
        vanishes(&samples, c, true, noise, 1.0, Zero::EXACT)
    }

    fn below_noise(c: u32, b: f64, noise: f64) -> bool {
        matches!(infinity_at(c, b, 1e-3, noise), Infinity::BelowNoise { .. })
    }

    #[test]
    fn sheets_that_end_at_infinity_have_no_power_sums() {
        for c in [1, 2, 3, 5, 7] {
            assert_eq!(
                infinity_at(c, 0.0, 1e-3, 1e-28),
                Infinity::Shown,
                "{c} sheets"
            );
        }
        // With the digits of doubles one sheet shows it, not three.
        assert_eq!(infinity_at(1, 0.0, 1e-3, 1e-15), Infinity::Shown);
        assert!(below_noise(3, 0.0, 1e-15));
    }

    #[test]
    fn sheets_that_end_far_out_have_some() {
        for (c, b) in [(1, 1e-12), (2, 1e-18), (3, 1e-15), (7, 1e-9)] {
            let Infinity::Apart { part, power_sum } = infinity_at(c, b, 1e-3, 1e-28) else {
                panic!("{c} sheets, {b}: {:?}", infinity_at(c, b, 1e-3, 1e-28));
            };
            let near = |value: f64, expected: f64| (value / expected - 1.0).abs() < 0.1;
            assert!(
                near(power_sum, b) && near(part, b / 1e-3),
                "{c}: {part} {power_sum}"
            );
        }
        assert!(below_noise(2, 1e-18, 1e-15));
        // A solution of norm 2e11, below the noise of the samples.
        assert!(below_noise(1, 5e-12, 1e-13));
    }

    #[test]
    fn a_coordinate_that_does_not_turn_does_not_vanish() {
        let circle = roots_of_unity(VERTICES);
        let at =
            |z: &num_complex::Complex64| Homogenizing::from_f64((), 0.1 + 1e-3 * z.re, 1e-3 * z.im);
        let samples: Vec<Homogenizing> = circle.iter().map(at).collect();
        let samples: Vec<&Homogenizing> = samples.iter().collect();
        assert_eq!(
            vanishes(&samples, 1, false, 1e-15, 1.0, Zero::EXACT),
            Infinity::No
        );
    }
}
