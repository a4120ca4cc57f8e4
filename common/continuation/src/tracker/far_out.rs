//! Regular ends far out: whether they are finite, by Newton's method with as many digits as that takes.
//!
//! A regular point moves with its equations by no more than their error times its condition, so that digits tell a
//! solution of norm 10^20 from one at infinity, where turns around 0 would have to be smaller than any number.

use super::settings::Settings;
use crate::chart::norm;
use crate::endgames::cauchy::generic_form;
use crate::homotopies::Homotopy;
use crate::refine::{Refiner, Report};
use cognate_numeric::precision::{DOUBLE_DOUBLE, rungs};
use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision, Real};
use num_complex::Complex64;

/// A homogenising coordinate that is at most this part of the largest is 0, unless coefficients are exact: rounded
/// coefficients have solutions with coordinates of this size where exact ones have infinity.
const WITHIN_DATA: f64 = 1e-13;
/// Nothing is decided within this factor of [`WITHIN_DATA`].
const BAND: f64 = 10.0;
/// With exact coefficients a homogenising coordinate may be the square of a small coefficient, and is known to be 0
/// within this.
const EXACT: f64 = 1e-22;
/// Smallest bound below which a homogenising coordinate counts as 0.
const LEAST: f64 = 1e-290;
/// A start beside a solution is this part of its homogenising coordinate away from it.
const BESIDE: f64 = 1e-6;
/// Newton's method has led to the same solution where coordinates differ by at most this part of the homogenising one.
const SAME: f64 = 1e-10;
/// Bound of errors, as a multiple of the last Newton correction.
const MARGIN: f64 = 1e3;

/// Place of a regular end far out.
pub(super) enum Place {
    /// These normalised homogeneous coordinates, the homogenising ones with digits of their own: 0 where they vanish.
    Resolved(Vec<Complex64>),
    /// The smallest homogenising coordinate is this part of the largest, which coefficients within their accuracy make
    /// 0.
    WithinDataAccuracy(f64),
    /// The digits of no rung decide.
    Unresolved,
}

/// Whether a homogenising coordinate that is this part of the largest, and has digits of its own, is clearly not 0.
pub(super) fn is_finite(settings: &Settings, coordinate: f64) -> bool {
    coordinate
        > if settings.exact_data {
            0.0
        } else {
            WITHIN_DATA * BAND
        }
}

/// Finds the place of a regular end near a point of the chart.
pub(super) fn resolve(
    homotopy: &Homotopy,
    settings: &Settings,
    point: &[Complex64],
    target: u64,
) -> Place {
    let accuracy = settings.data_accuracy;
    let (zero, least) = match (settings.exact_data, accuracy > 0.0) {
        (true, true) => (0.0, EXACT.min(accuracy * accuracy)),
        (true, false) => (0.0, EXACT),
        (false, _) => (WITHIN_DATA, WITHIN_DATA),
    };
    if least < LEAST {
        return Place::Unresolved;
    }
    for bits in rungs(DOUBLE_DOUBLE, settings.max_precision_bits) {
        let solution = match bits {
            DOUBLE_DOUBLE => at::<DoubleDouble<f64>>(homotopy, (), point, target),
            _ => at::<MultiplePrecision>(homotopy, bits, point, target),
        };
        let Some((mut coordinates, accuracy)) = solution else {
            continue;
        };
        let error = MARGIN * accuracy;
        let vanishing = error.max(zero);
        let smallest = homotopy.smallest_homogenizing(&coordinates);
        if smallest > zero / BAND && smallest < zero * BAND {
            // With digits of its own, and so known not to be 0 for these coefficients.
            let is_known = settings.data_accuracy > 0.0 && smallest > error;
            if is_known {
                return Place::WithinDataAccuracy(smallest);
            }
            continue;
        }
        let finite = smallest > vanishing;
        if !finite {
            homotopy.set_homogenizing(&mut coordinates, vanishing, 0.0);
        }
        if finite || error <= least {
            return Place::Resolved(coordinates);
        }
    }
    Place::Unresolved
}

/// Finds an isolated solution far out, with its normalised homogeneous coordinates, where turns on one sheet have led
/// to infinity as far as the digits of doubles tell: Newton's method begins at the mean of the turns with twice the
/// digits.
///
/// On a set of solutions that goes to infinity it finds some point, and from beside that another one. At a multiple
/// point it does not come to rest.
pub(super) fn find_isolated(
    homotopy: &Homotopy,
    settings: &Settings,
    mean: &[Complex64],
    target: u64,
) -> Option<(Report, Vec<Complex64>)> {
    if !settings.exact_data {
        return None;
    }
    let mut point = mean.to_vec();
    let mut refiner = Refiner::<DoubleDouble<f64>>::new(homotopy, ()).with_all_digits();
    let report = refiner.refine(&mut point, target);
    let coordinates = homotopy.precise_endpoint((), refiner.last());
    let y0 = homotopy.smallest_homogenizing(&coordinates);
    let comes_to_rest = |report: &Report| report.converged && MARGIN * report.accuracy < SAME * y0;
    if !comes_to_rest(&report) {
        return None;
    }
    let isolated_point = refiner.last().to_vec();
    let away = BESIDE * y0 * norm(&point);
    let by: Vec<Complex64> = generic_form()
        .take(isolated_point.len())
        .map(|z| z * away)
        .collect();
    // Where equations are far from linear a correction may exceed the one before it: a second run begins there.
    refiner.refine_beside_last(&mut point, &by, target);
    let none = vec![Complex64::default(); isolated_point.len()];
    let second_run = refiner.refine_beside_last(&mut point, &none, target);
    let differences = refiner
        .last()
        .iter()
        .zip(&isolated_point)
        .map(|(z, isolated)| {
            let mut difference = *z;
            difference.sub(isolated);
            difference.lane(0)
        });
    let same = differences
        .fold(0.0f64, |most, z| most.max(z.norm_sqr()))
        .sqrt()
        <= SAME * y0 * norm(&point);
    (comes_to_rest(&second_run) && same).then_some((report, coordinates))
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
    point: &[Complex64],
    target: u64,
) -> Option<(Vec<Complex64>, f64)> {
    let mut point = point.to_vec();
    let mut refiner = Refiner::<S>::new(homotopy, context).with_all_digits();
    let report = refiner.refine(&mut point, target);
    let coordinates = || homotopy.precise_endpoint(context, refiner.last());
    report.converged.then(|| (coordinates(), report.accuracy))
}
