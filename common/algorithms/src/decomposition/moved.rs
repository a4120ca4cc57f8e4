//! MovedPoints: second derivatives of witness points along a moving slice, held for sums of them.

use cognate_continuation::bend::{Bend, Number, length, rounded};
use cognate_solutions::witness::Trace;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Errors above this part of the derivatives tell nothing.
const NOISY: f64 = 1e-16;
/// Errors are not believed to be smaller than this part of the derivatives.
const LEAST_NOISE: f64 = 1e-28;
/// A sum is 0 within this many times its error.
const CLOSED: f64 = 1e3;

/// Precision of double-doubles, in bits.
const BITS: u32 = 106;

/// Derivatives of many points, without what no sum needs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MovedPoints {
    /// Variables of the problem.
    own: usize,
    /// x'' in these, point after point.
    second: Vec<Number>,
    /// Length of x'' and of x' in these, together.
    lengths: Vec<f64>,
    errors: Vec<f64>,
}

impl MovedPoints {
    /// Makes an empty store with capacity for `points` points in `variable_count` variables.
    pub fn with_capacity(points: usize, variable_count: usize) -> Self {
        Self {
            own: variable_count,
            second: Vec::with_capacity(points * variable_count),
            lengths: Vec::with_capacity(points),
            errors: Vec::with_capacity(points),
        }
    }

    /// Number of points in the store.
    pub fn count(&self) -> usize {
        self.lengths.len()
    }

    /// Takes one more point; `None`: any error may be in its derivatives.
    pub fn push(&mut self, bend: Option<&Bend>) {
        let variable_count = self.own;
        let Some(bend) = bend else {
            self.second
                .extend((0..variable_count).map(|_| Number::zero(())));
            self.lengths.push(0.0);
            self.errors.push(f64::INFINITY);
            return;
        };
        let coordinates =
            |v: &[Number]| -> Vec<Complex64> { v[..variable_count].iter().map(rounded).collect() };
        let size = length(&coordinates(&bend.acceleration)) + length(&coordinates(&bend.velocity));
        self.second
            .extend_from_slice(&bend.acceleration[..variable_count]);
        self.lengths.push(size);
        self.errors.push(bend.error);
    }

    /// Takes these points, too.
    pub fn extend(&mut self, more: Self) {
        if self.count() == 0 {
            *self = more;
            return;
        }
        self.second.extend(more.second);
        self.lengths.extend(more.lengths);
        self.errors.extend(more.errors);
    }

    /// The sum of second derivatives over these points.
    pub fn trace(&self, points: impl Iterator<Item = usize>) -> Trace {
        let mut sum = vec![Number::zero(()); self.own];
        let (mut lengths, mut errors) = (0.0, 0.0);
        for k in points {
            lengths += self.lengths[k];
            errors += self.errors[k];
            let second = &self.second[k * self.own..(k + 1) * self.own];
            for (sum, t) in sum.iter_mut().zip(second) {
                sum.add(t);
            }
        }
        let sum: Vec<Complex64> = sum.iter().map(rounded).collect();
        Trace {
            deviation: bounded(length(&sum) / lengths),
            noise: bounded(errors / lengths).max(LEAST_NOISE),
            precision_bits: BITS,
        }
    }

    /// The sum over all points.
    pub fn whole(&self) -> Trace {
        self.trace(0..self.lengths.len())
    }

    /// The sum of second derivatives over these points in doubles, and the sum of lengths.
    pub fn rough(&self, points: &[usize]) -> (Vec<Complex64>, f64) {
        let mut sum = vec![Complex64::default(); self.own];
        let mut lengths = 0.0;
        for &k in points {
            lengths += self.lengths[k];
            let second = &self.second[k * self.own..(k + 1) * self.own];
            for (sum, t) in sum.iter_mut().zip(second) {
                *sum += rounded(t);
            }
        }
        (sum, lengths)
    }
}

/// The number, or the largest where it is none.
pub(super) fn bounded(x: f64) -> f64 {
    match x.is_finite() {
        true => x,
        false => f64::MAX,
    }
}

/// Whether points with this sum are whole components.
pub(crate) fn is_closed(trace: &Trace) -> bool {
    trace.noise < NOISY && trace.deviation <= CLOSED * trace.noise
}

/// Whether the sum tells that points are missing.
pub(crate) fn misses_points(trace: &Trace) -> bool {
    trace.noise < NOISY && !is_closed(trace)
}
