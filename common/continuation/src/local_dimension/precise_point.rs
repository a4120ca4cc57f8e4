//! PrecisePoint: a point in double-doubles that Newton's method in doubles moves; a nearly singular but
//! regular solution is known by it.

use super::split::square;
use crate::asked_system::AskedSystem;
use crate::chart::norm;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::scalar::{Complex, DoubleDouble, Real};
use num_complex::Complex64;

/// Newton steps towards a regular solution: each makes the error about 1e-16 times the condition number
/// as large, or squares it.
const MOST_STEPS: usize = 12;
/// A Jacobian in doubles is regular where its least singular value is at least this part of the largest:
/// some hundred rounding errors.
const REGULAR: f64 = 1e-13;
/// Steps shorter than this, relative to the point's size, are rounding errors.
const SETTLED: f64 = 1e-24;

/// Coordinates in double-doubles.
pub(super) struct PrecisePoint(Vec<Complex<DoubleDouble<f64>>>);

impl PrecisePoint {
    pub(super) fn new(point: &[Complex64]) -> Self {
        let number = |z: &Complex64| Complex {
            re: DoubleDouble::from_f64((), z.re),
            im: DoubleDouble::from_f64((), z.im),
        };
        Self(point.iter().map(number).collect())
    }

    pub(super) fn coordinates(&self) -> &[Complex<DoubleDouble<f64>>] {
        &self.0
    }

    pub(super) fn add(&mut self, step: &[Complex64]) {
        for (x, s) in self.0.iter_mut().zip(step) {
            x.re.add(&DoubleDouble::from_f64((), s.re));
            x.im.add(&DoubleDouble::from_f64((), s.im));
        }
    }
}

/// Whether Newton's method converges from the point to a solution with a regular Jacobian, at most `farthest` away:
/// then the endpoint is a nonsingular solution with a large condition number. The value is the ratio of the least
/// singular value to one that would be 0.
pub(super) fn regular_nearby(
    system: &AskedSystem,
    target: u64,
    point: &[Complex64],
    farthest: f64,
) -> Option<f64> {
    let mut x = PrecisePoint::new(point);
    let size = norm(point);
    let mut moved = 0.0;
    for _ in 0..MOST_STEPS {
        let linearization = system.linearize_precisely(x.coordinates(), target);
        if !square(&linearization.values).is_finite() {
            return None;
        }
        let svd = Svd::of(linearization.columns);
        let (largest, least) = (svd.values.first()?, svd.values.last()?);
        if *least < REGULAR * largest {
            return None;
        }
        let mut step = svd.least_squares(&linearization.values, svd.values.len());
        step.iter_mut().for_each(|s| *s = -*s);
        let length = square(&step).sqrt();
        if length <= SETTLED * size {
            return Some(least / (REGULAR * largest / 10.0));
        }
        moved += length;
        if moved > farthest {
            return None;
        }
        x.add(&step);
    }
    None
}
