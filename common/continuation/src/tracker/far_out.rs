//! Regular ends far out: whether they are finite, by Newton's method with as many digits as that takes.
//!
//! A regular point moves with its equations by no more than their error times its condition, so that digits tell a
//! solution of norm 10^20 from one at infinity, where turns around 0 would have to be smaller than any number.

use super::settings::Settings;
use crate::homotopies::Homotopy;
use crate::refine::{Refiner, Report};
use cognate_numeric::precision::{DOUBLE_DOUBLE, rungs, unit_roundoff};
use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision, Real};
use num_complex::Complex64;

/// A homogenising coordinate that is at most this part of the largest is 0 where data is known to fewer digits.
const WITHIN_DATA: f64 = 1e-13;
/// And this where it is exact, unless its coefficients differ by many orders of magnitude.
const EXACT: f64 = 1e-22;
/// What such a coordinate may be is the square of how small its coefficients are; no smaller than this.
const LEAST: f64 = 1e-290;
/// Errors are at most so many times the last Newton correction.
const MARGIN: f64 = 1e3;

/// A regular end of which it is known whether it is finite.
pub(super) struct FarOut {
    pub finite: bool,
    /// In the chart, rounded.
    pub point: Vec<Complex64>,
    /// Normalised homogeneous coordinates, the homogenising ones with digits of their own; those that vanish are 0.
    pub coordinates: Vec<Complex64>,
    pub report: Report,
}

/// What Newton's method shows from a point of the chart near the end; `None` where no rung's digits tell.
pub(super) fn resolve(
    homotopy: &Homotopy,
    settings: &Settings,
    point: &[Complex64],
    target: u64,
) -> Option<FarOut> {
    let accuracy = settings.data_accuracy;
    let (zero, least) = match (settings.exact_data, accuracy > 0.0) {
        (false, true) => (WITHIN_DATA, WITHIN_DATA),
        (true, true) => (0.0, EXACT.min(accuracy * accuracy)),
        (_, false) => (0.0, EXACT),
    };
    if least < LEAST {
        return None;
    }
    let mut bits = rungs(DOUBLE_DOUBLE, settings.max_precision_bits);
    bits.find_map(|bits| {
        let mut far = match bits {
            DOUBLE_DOUBLE => at::<DoubleDouble<f64>>(homotopy, (), bits, point, target),
            _ => at::<MultiplePrecision>(homotopy, bits, bits, point, target),
        }?;
        let error = MARGIN * far.report.accuracy;
        let smallest = homotopy.smallest_homogenizing(&far.coordinates);
        far.finite = smallest > error.max(zero);
        if !far.finite {
            homotopy.set_homogenizing(&mut far.coordinates, error.max(zero), 0.0);
        }
        (far.finite || error <= least).then_some(far)
    })
}

/// A point whose homogenising coordinates are neither 0 nor not as far as is known.
pub(super) fn unresolved(homotopy: &Homotopy, mut coordinates: Vec<Complex64>) -> Vec<Complex64> {
    homotopy.set_homogenizing(&mut coordinates, WITHIN_DATA, f64::MIN_POSITIVE);
    coordinates
}

fn at<S: Real>(
    homotopy: &Homotopy,
    context: S::Context,
    bits: u32,
    point: &[Complex64],
    target: u64,
) -> Option<FarOut> {
    let mut point = point.to_vec();
    let mut refiner = Refiner::<S>::new(homotopy, context).until(unit_roundoff(bits));
    let report = refiner.refine(&mut point, target);
    report.converged.then(|| FarOut {
        finite: false,
        point,
        coordinates: homotopy.precise_endpoint(context, refiner.last()),
        report,
    })
}
