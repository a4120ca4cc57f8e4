//! Moved slices: whether solutions are met near a point when a hyperplane through it is moved away.
//!
//! Every set of positive dimension through a point p meets the hyperplane l(x - p) = δ near p for every
//! small δ and generic l, where l is a linear form on the null space of the Jacobian at p, which
//! contains all tangents (Kuo, Li: Determining dimension of the solution component that
//! contains a computed zero of a polynomial system, J. Math. Anal. Appl. 338, 2008). Near an isolated point
//! of multiplicity m the equations are at least about δ^m there. So the least residual on slices
//! at several distances is evidence for a set that does not depend on dual spaces, or on how many paths
//! end at p. Residuals are evaluated in double-doubles.

use super::{Split, square};
use crate::asked_system::AskedSystem;
use crate::chart::norm;
use crate::path_result::MovedSlice;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, DoubleDouble, Real};
use num_complex::Complex64;

/// Distances of the slices, relative to the point's size, farthest first.
const DISTANCES: [f64; 4] = [0.1, 0.0125, 0.0016, 0.0002];
/// A slice has at least this many times the point's error as its distance.
const ABOVE_ERROR: f64 = 40.0;
/// Directions, within the null space, in which the first point on a slice is sought.
const DIRECTIONS: u64 = 3;
/// Gauss-Newton steps on one slice: towards a set of multiplicity 3 each makes the error smaller by a
/// third only.
const MOST_STEPS: usize = 60;
/// Points farther away than this many distances of the slice are not near.
const REACH: f64 = 30.0;
/// Singular values below this part of the largest are rounding errors of the Jacobian.
const LEAST_VALUE: f64 = 1e-15;
/// Residuals below this are as good as 0: towards a set of multiplicity 3 or more Newton's method comes to about
/// 1e-22, where the Jacobian in doubles has no more digits.
const MET: f64 = 1e-20;
/// A slice at least this far away that is met decides that the endpoint is on no isolated point of
/// multiplicity below 10.
const TELLING: f64 = 0.01;
/// Residuals of a double-double evaluation, equations and coordinates scaled to 1, that are rounding.
const ROUNDING: f64 = 1e-28;

/// A point in double-doubles.
type Precise = Vec<Complex<DoubleDouble<f64>>>;

/// What the slices at each distance meet, up to one that meets nothing; none at distances that the point's
/// error does not allow.
pub(super) fn moved_slices(
    system: &AskedSystem,
    target: u64,
    split: &Split,
    error: f64,
) -> Vec<MovedSlice> {
    let size = norm(&split.point);
    let slices = DISTANCES.iter().map(|distance| distance * size);
    let mut found = Vec::new();
    for distance in slices.filter(|&distance| distance > ABOVE_ERROR * error) {
        let mut best = MovedSlice {
            distance: distance / size,
            residual: f64::INFINITY,
            reached: f64::INFINITY,
        };
        for attempt in 0..DIRECTIONS {
            let slice = Slice::new(split, distance, attempt);
            let (residual, reached) = slice.nearest(system, target, split);
            if residual < best.residual {
                (best.residual, best.reached) = (residual, reached / size);
            }
            if best.residual <= MET {
                break;
            }
        }
        found.push(best);
        // Only the farthest slice may miss a set.
        if found.len() > 1 && best.residual > MET {
            break;
        }
    }
    found
}

/// Whether a slice was met that is not too near to mean something.
pub(super) fn meets(slices: &[MovedSlice]) -> bool {
    let telling = |slice: &MovedSlice| slice.distance >= TELLING && slice.residual <= MET;
    slices.iter().any(telling)
}

/// The hyperplane l(x - p) = δ and where to begin on it.
struct Slice {
    /// l, of length 1 and 0 outside the null space.
    form: Vec<Complex64>,
    /// From p to the first point on the slice.
    begin: Vec<Complex64>,
    distance: f64,
}

impl Slice {
    fn new(split: &Split, distance: f64, attempt: u64) -> Self {
        let dimension = split.point.len();
        // One form for all attempts and distances: the points that are met are those of one curve.
        let mut random = RandomStream::new(0, Purpose::Probe, 3);
        let mut form = vec![Complex64::default(); dimension];
        for direction in &split.kernel {
            let weight = random.unit();
            for (l, v) in form.iter_mut().zip(direction) {
                *l += weight * v.conj();
            }
        }
        let length = square(&form).sqrt();
        form.iter_mut().for_each(|l| *l /= length);
        let mut begin = vec![Complex64::default(); dimension];
        let mut random = RandomStream::new(attempt, Purpose::Probe, 4);
        for direction in &split.kernel {
            let weight = random.disc();
            for (b, v) in begin.iter_mut().zip(direction) {
                *b += weight * v;
            }
        }
        // l applied to the direction, made δ; the direction that is nearest to l first.
        if attempt == 0 {
            begin = form.iter().map(Complex64::conj).collect();
        }
        let value = apply(&form, &begin);
        let value = if value.norm_sqr() > 1e-4 * square(&begin) {
            value
        } else {
            begin = form.iter().map(Complex64::conj).collect();
            Complex64::new(1.0, 0.0)
        };
        begin.iter_mut().for_each(|b| *b *= distance / value);
        Self {
            form,
            begin,
            distance,
        }
    }

    /// The least residual that Gauss-Newton steps find near p on the slice, and how far from p.
    fn nearest(&self, system: &AskedSystem, target: u64, split: &Split) -> (f64, f64) {
        let mut offset = self.begin.clone();
        let mut x: Precise = split.point.iter().map(precise).collect();
        add(&mut x, &offset);
        let mut best = (f64::INFINITY, f64::INFINITY);
        let mut without_gain = 0;
        for _ in 0..MOST_STEPS {
            let found = system.linearize_precisely(&x, target);
            let residual = square(&found.values).sqrt() / split.scale;
            let reached = square(&offset).sqrt();
            if !residual.is_finite() || reached > REACH * self.distance {
                break;
            }
            without_gain = if residual < 0.8 * best.0 {
                0
            } else {
                without_gain + 1
            };
            if residual < best.0 {
                best = (residual, reached);
            }
            if residual <= ROUNDING || without_gain > 6 {
                break;
            }
            // The slice as one more equation, as large as the others.
            let mut values = found.values;
            let missed = apply(&self.form, &offset) - self.distance;
            values.push(missed * split.scale);
            let mut columns = found.columns;
            for (column, l) in columns.iter_mut().zip(&self.form) {
                column.push(l * split.scale);
            }
            let svd = Svd::of(columns);
            let largest = svd.values.first().copied().unwrap_or(0.0);
            let rank = svd
                .values
                .iter()
                .filter(|&&s| s > LEAST_VALUE * largest)
                .count();
            let mut step = svd.least_squares(&values, rank);
            step.iter_mut().for_each(|s| *s = -*s);
            // Where the equations are nearly singular a step is long without reason.
            let length = square(&step).sqrt();
            if length > self.distance {
                step.iter_mut().for_each(|s| *s *= self.distance / length);
            }
            add(&mut x, &step);
            for (o, s) in offset.iter_mut().zip(&step) {
                *o += s;
            }
        }
        best
    }
}

fn apply(form: &[Complex64], x: &[Complex64]) -> Complex64 {
    form.iter().zip(x).map(|(l, x)| l * x).sum()
}

fn precise(z: &Complex64) -> Complex<DoubleDouble<f64>> {
    Complex {
        re: DoubleDouble::<f64>::from_f64((), z.re),
        im: DoubleDouble::<f64>::from_f64((), z.im),
    }
}

fn add(x: &mut Precise, step: &[Complex64]) {
    for (x, s) in x.iter_mut().zip(step) {
        x.re.add(&DoubleDouble::<f64>::from_f64((), s.re));
        x.im.add(&DoubleDouble::<f64>::from_f64((), s.im));
    }
}
