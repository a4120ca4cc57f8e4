//! Regular ends far out: whether they are finite, by Newton's method with as many digits as that takes.
//!
//! A regular point moves with its equations by no more than their error times its condition, so that digits tell a
//! solution of norm 10^20 from one at infinity, where turns around 0 would have to be smaller than any number.

use super::settings::Settings;
use crate::homotopies::Homotopy;
use crate::refine::Refiner;
use cognate_numeric::precision::{DOUBLE_DOUBLE, rungs, unit_roundoff};
use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision, Real};
use num_complex::Complex64;

/// A homogenising coordinate that is at most this part of the largest is 0, unless coefficients are exact and differ by
/// many orders of magnitude: rounded coefficients have such solutions where exact ones have infinity.
const WITHIN_DATA: f64 = 1e-13;
/// Within this factor of that, nothing tells.
const BAND: f64 = 10.0;
/// With those such a coordinate may be the square of how small coefficients are, and is known to be 0 within this.
const EXACT: f64 = 1e-22;
/// No smaller than this.
const LEAST: f64 = 1e-290;
/// Errors are at most so many times the last Newton correction.
const MARGIN: f64 = 1e3;

/// Normalised homogeneous coordinates of a regular end near a point of the chart, the homogenising ones with digits of
/// their own: 0 where they vanish. `None` where no rung's digits tell.
pub(super) fn resolve(
    homotopy: &Homotopy,
    settings: &Settings,
    point: &[Complex64],
    target: u64,
) -> Option<Vec<Complex64>> {
    let accuracy = settings.data_accuracy;
    let (zero, least) = match settings.exact_data && accuracy > 0.0 {
        true => (0.0, EXACT.min(accuracy * accuracy)),
        false => (WITHIN_DATA, WITHIN_DATA),
    };
    if least < LEAST {
        return None;
    }
    let mut bits = rungs(DOUBLE_DOUBLE, settings.max_precision_bits);
    bits.find_map(|bits| {
        let (mut coordinates, accuracy) = match bits {
            DOUBLE_DOUBLE => at::<DoubleDouble<f64>>(homotopy, (), bits, point, target),
            _ => at::<MultiplePrecision>(homotopy, bits, bits, point, target),
        }?;
        let error = MARGIN * accuracy;
        let vanishing = error.max(zero);
        let smallest = homotopy.smallest_homogenizing(&coordinates);
        if smallest > zero / BAND && smallest < zero * BAND {
            return None;
        }
        let finite = smallest > vanishing;
        if !finite {
            homotopy.set_homogenizing(&mut coordinates, vanishing, 0.0);
        }
        (finite || error <= least).then_some(coordinates)
    })
}

/// A point whose homogenising coordinates are neither 0 nor not as far as is known.
pub(super) fn unresolved(homotopy: &Homotopy, mut coordinates: Vec<Complex64>) -> Vec<Complex64> {
    homotopy.set_homogenizing(&mut coordinates, BAND * WITHIN_DATA, f64::MIN_POSITIVE);
    coordinates
}

/// The coordinates, and their relative error.
fn at<S: Real>(
    homotopy: &Homotopy,
    context: S::Context,
    bits: u32,
    point: &[Complex64],
    target: u64,
) -> Option<(Vec<Complex64>, f64)> {
    let mut point = point.to_vec();
    let mut refiner = Refiner::<S>::new(homotopy, context).until(unit_roundoff(bits));
    let report = refiner.refine(&mut point, target);
    let coordinates = || homotopy.precise_endpoint(context, refiner.last());
    report.converged.then(|| (coordinates(), report.accuracy))
}
