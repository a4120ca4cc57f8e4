//! Regular ends far out: whether they are finite, by Newton's method with as many digits as that takes.
//!
//! A regular point moves with its equations by no more than their error times its condition, so that digits tell a
//! solution of norm 10^20 from one at infinity, where turns around 0 would have to be smaller than any number.

use super::settings::Settings;
use crate::chart::norm;
use crate::endgames::cauchy::generic_form;
use crate::homotopies::Homotopy;
use crate::refine::{Refiner, Report};
use crate::stage::PreparedStage;
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
/// The place of an end is known where slightly other values of parameters change its homogenising coordinate by at
/// most this part.
const STEADY: f64 = 1e-2;

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

/// Finds the place of a regular end of the stage near a point of the chart of this homotopy.
pub(super) fn resolve(
    stage: &PreparedStage,
    homotopy: &Homotopy,
    point: &[Complex64],
    target: u64,
) -> Place {
    let settings = stage.settings();
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
        let Some((mut coordinates, accuracy)) = at(homotopy, bits, point, target) else {
            continue;
        };
        let error = MARGIN * accuracy;
        let vanishing = error.max(zero);
        let smallest = homotopy.smallest_homogenizing(&coordinates);
        let may_be_steady = smallest > error && smallest < zero * BAND;
        if may_be_steady && is_steady(stage, homotopy, bits, &coordinates, target) {
            return Place::Resolved(coordinates);
        }
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

/// Whether normalised homogeneous coordinates of an end, found in an arithmetic of this many bits, keep their place
/// where the values of parameters are slightly other ones. Where these have no part in it, it is not known.
fn is_steady(
    stage: &PreparedStage,
    homotopy: &Homotopy,
    bits: u32,
    coordinates: &[Complex64],
    target: u64,
) -> bool {
    let Some(moved) = stage.with_moved_parameters(homotopy, target) else {
        return false;
    };
    let Some(point) = moved.homotopy.chart().point(coordinates) else {
        return false;
    };
    let Some((moved_coordinates, accuracy)) = at(&moved.homotopy, bits, &point, moved.target)
    else {
        return false;
    };
    let [place, moved_place] = [coordinates, &moved_coordinates[..]]
        .map(|coordinates| homotopy.smallest_homogenizing(coordinates));
    let is_known = MARGIN * accuracy <= STEADY * moved_place;
    is_known && (moved_place - place).abs() <= STEADY * place
}

/// Result of Newton's method at a point beside an isolated solution far out, or beside none.
enum Attempt {
    /// The solution, with its normalised homogeneous coordinates.
    Isolated(Report, Vec<Complex64>),
    /// The corrections vanish, and the digits of the arithmetic do not tell the homogenising coordinate.
    FewDigits,
    /// There is no isolated solution.
    None,
}

/// Finds an isolated solution far out, with its normalised homogeneous coordinates, where turns on one sheet have led
/// to infinity as far as the digits of doubles tell: Newton's method begins at the mean of the turns with at least twice
/// the digits.
pub(super) fn find_isolated(
    stage: &PreparedStage,
    homotopy: &Homotopy,
    mean: &[Complex64],
    target: u64,
) -> Option<(Report, Vec<Complex64>)> {
    let settings = stage.settings();
    let is_exact = settings.exact_data;
    if !is_exact && !stage.has_moved_parameters() {
        return None;
    }
    for bits in rungs(DOUBLE_DOUBLE, settings.max_precision_bits) {
        let attempt = match bits {
            DOUBLE_DOUBLE => isolated::<DoubleDouble<f64>>(homotopy, (), mean, target),
            _ => isolated::<MultiplePrecision>(homotopy, bits, mean, target),
        };
        match attempt {
            Attempt::Isolated(report, coordinates) => {
                let has_place = is_exact || is_steady(stage, homotopy, bits, &coordinates, target);
                return has_place.then_some((report, coordinates));
            }
            Attempt::FewDigits => {}
            Attempt::None => return None,
        }
    }
    None
}

/// Looks for an isolated solution near a point of the chart.
///
/// On a set of solutions that goes to infinity Newton's method finds some point, and from beside that another one. At a
/// multiple point it does not come to rest.
fn isolated<S: Real>(
    homotopy: &Homotopy,
    context: S::Context,
    point: &[Complex64],
    target: u64,
) -> Attempt {
    let mut point = point.to_vec();
    let mut refiner = Refiner::<S>::new(homotopy, context).with_all_digits();
    let report = refiner.refine(&mut point, target);
    let coordinates = homotopy.precise_endpoint(context, refiner.last());
    let y0 = homotopy.smallest_homogenizing(&coordinates);
    let is_known = |report: &Report| MARGIN * report.accuracy < SAME * y0;
    if !report.converged {
        return Attempt::None;
    }
    if !is_known(&report) {
        return Attempt::FewDigits;
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
            let mut difference = z.clone();
            difference.sub(isolated);
            difference.lane(0)
        });
    let same = differences
        .fold(0.0f64, |most, z| most.max(z.norm_sqr()))
        .sqrt()
        <= SAME * y0 * norm(&point);
    match second_run.converged && is_known(&second_run) && same {
        true => Attempt::Isolated(report, coordinates),
        false => Attempt::None,
    }
}

/// A point whose homogenising coordinates are neither 0 nor not as far as is known.
pub(super) fn unresolved(homotopy: &Homotopy, mut coordinates: Vec<Complex64>) -> Vec<Complex64> {
    homotopy.set_homogenizing(&mut coordinates, BAND * WITHIN_DATA, f64::MIN_POSITIVE);
    coordinates
}

/// The coordinates of the solution at the end of paths, by Newton's method in an arithmetic of this many bits from a
/// point of the chart, and their relative error.
fn at(
    homotopy: &Homotopy,
    bits: u32,
    point: &[Complex64],
    target: u64,
) -> Option<(Vec<Complex64>, f64)> {
    match bits {
        DOUBLE_DOUBLE => in_arithmetic::<DoubleDouble<f64>>(homotopy, (), point, target),
        _ => in_arithmetic::<MultiplePrecision>(homotopy, bits, point, target),
    }
}

fn in_arithmetic<S: Real>(
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

#[cfg(test)]
mod tests {
    use crate::homotopies::HomotopyKind;
    use crate::stage::PreparedStage;
    use crate::start_points::{Digest, StartPoints, StoredPoints};
    use crate::tracker::outcome::PathOutcome;
    use crate::tracker::settings::Settings;
    use crate::work::{Stage, Work};
    use num_complex::Complex64;
    use std::sync::Arc;

    /// a x^3 + x^2 = 4, y = x^2: for a small a one solution is near (-1/a, 1/a^2).
    #[test]
    fn a_parameter_takes_a_solution_far_out() {
        let text =
            "variable_group x, y; parameter a; function f, g; f = a*x^3 + x^2 - 4; g = y - x^2;";
        let system = cognate_systems::formats::read("family", text.as_bytes())
            .unwrap()
            .system;
        // The solutions at 3/4 + i/2.
        let x = [
            Complex64::new(-0.9292737895813434, 1.747841904603416),
            Complex64::new(-1.341611289820849, -0.9602486915165171),
            Complex64::new(1.3478081563252695, -0.1722085977022833),
        ];
        let points = Arc::new(StoredPoints {
            dimension: 2,
            coordinates: x.iter().flat_map(|&x| [x, x * x]).collect(),
        });
        let real = |value: f64| vec![Complex64::new(value, 0.0)];
        let values = [1e-6, 1e-8, 1e-10, 1e-14, 0.0];
        let stage = Stage::new(
            Work::Track,
            HomotopyKind::Parameter {
                start: vec![Complex64::new(0.75, 0.5)],
                targets: values.map(real).into(),
            },
            StartPoints::Stored {
                object: Digest([1; 32]),
                count: 3,
            },
            Settings::default(),
            7,
        );
        let prepared = PreparedStage::new(&system, &stage, &|_| Some(points.clone())).unwrap();
        let results = prepared.track(0..prepared.items(), 8);
        for (results, a) in results.chunks(3).zip(values) {
            let is_far = |y: &[Complex64]| (y[1] / y[0] * a + 1.0).norm_sqr() < 1e-6;
            let regular = results.iter().filter(|r| r.outcome == PathOutcome::Regular);
            let far = regular.filter(|r| is_far(r.endpoint.to_double())).count();
            assert_eq!(far, usize::from(a != 0.0), "{a:e}");
        }
    }
}
