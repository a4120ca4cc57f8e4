//! Moved slices: whether solutions are met near a point when a hyperplane through it is moved away.
//!
//! Every set of positive dimension through a point p meets the hyperplane l(x - p) = δ near p for every
//! small δ and generic l, where l is a linear form on the null space of the Jacobian at p, which
//! contains all tangents (Kuo, Li: Determining dimension of the solution component that
//! contains a computed zero of a polynomial system, J. Math. Anal. Appl. 338, 2008). Near an isolated point
//! of multiplicity m the equations are at least about δ^m there. So the least residual on slices
//! at several distances is evidence for a set that does not depend on dual spaces, or on how many paths
//! end at p. Residuals are evaluated in double-doubles.

use super::precise_point::PrecisePoint;
use super::split::{Split, square};
use crate::asked_system::AskedSystem;
use crate::chart::norm;
use crate::path_result::MovedSlice;
use cognate_numeric::linear_algebra::least_squares::least_squares;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// Distances of the slices, relative to the point's size, farthest first. The near ones tell a set
/// through the point from one that passes it.
const DISTANCES: [f64; 6] = [0.1, 0.0125, 0.0016, 0.0002, 1e-5, 2e-7];
/// A slice has at least this many times the point's error as its distance.
const ABOVE_ERROR: f64 = 40.0;
/// Directions, within the null space, in which the first point on a slice is sought.
const DIRECTIONS: u64 = 2;
/// Normals of the hyperplanes that are tried one after another where dual spaces of a low order did not stop. Where two
/// branches have one tangent space, Newton's method on a slice leads to the one that is nearer there.
const MANY_NORMALS: u64 = 8;
/// Most hyperplanes through the point that cut a set besides the one that is moved, except as many as
/// the null space has dimensions.
const MOST_CUTS: usize = 2;
/// Gauss-Newton steps on one slice: towards a set of multiplicity 3 each makes the error smaller by a
/// third only.
const MOST_STEPS: usize = 60;
/// Two successive Newton steps have the same direction if they differ by at most this part of their length.
const SAME_DIRECTION: f64 = 0.2;
/// Least ratio of the lengths of two successive steps towards a multiple point or set.
const LEAST_SHRINKING: f64 = 0.35;
/// Largest ratio of the lengths of two successive steps towards a multiple point or set: a multiplicity of 5.
const MOST_SHRINKING: f64 = 0.82;
/// Points farther away than this many distances of the slice are not near.
const REACH: f64 = 30.0;
/// Singular values below this part of the largest are rounding errors of the Jacobian in doubles.
const LEAST_VALUE: f64 = 1e-14;
/// Residuals below this are as good as 0: towards a set of multiplicity 3 Newton's method comes to about
/// 1e-21, where the Jacobian in doubles has no more digits.
const MET: f64 = 1e-20;
/// A residual above this, on a slice that is far, is one of a place where there is nothing.
const MISSED: f64 = 1e-8;
/// Residuals of a double-double evaluation, equations and coordinates scaled to 1, that are rounding.
const ROUNDING: f64 = 1e-28;

/// Directions in which points on slices are searched.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Search<'a> {
    /// Whether hyperplanes with many normals are tried instead of one.
    pub(super) many: bool,
    /// A direction that is likely to be a tangent, by its components in the null space.
    pub(super) tangent: Option<&'a [Complex64]>,
}

/// A singular point and the system of which slices are taken there.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    pub(super) system: &'a AskedSystem,
    pub(super) target: u64,
    pub(super) split: &'a Split,
    /// Bound of the error of the point.
    pub(super) error: f64,
}

impl Around<'_> {
    /// Searches solutions on the slices at each distance, up to the first slice that meets none. Distances that the
    /// error of the point does not allow are left out.
    pub(super) fn moved_slices(&self, search: Search<'_>) -> Vec<MovedSlice> {
        let kernel = self.split.kernel.len();
        let mut cuts: Vec<usize> = (0..kernel.min(MOST_CUTS + 1)).collect();
        // A set that fills the null space is cut to a regular point by as many hyperplanes.
        if kernel > MOST_CUTS + 1 {
            cuts.push(kernel - 1);
        }
        cuts.reverse();
        let normals = if search.many { MANY_NORMALS } else { 1 };
        let mut best = Vec::new();
        for normal in 0..normals {
            for &cut in &cuts {
                let slices = Slices::new(*self, cut, normal).meet(search);
                if meets(&slices) {
                    return slices;
                }
                if nearer(&slices, &best) {
                    best = slices;
                }
            }
        }
        best
    }
}

/// Whether a slice was met that is not too near to mean something, and all that are nearer.
pub(super) fn meets(slices: &[MovedSlice]) -> bool {
    meets_within(slices, MET)
}

/// Whether [`meets`] holds when residuals up to `residual` count as 0; residuals of rounding always do.
pub(super) fn meets_within(slices: &[MovedSlice], residual: f64) -> bool {
    MovedSlice::are_met(slices, residual.max(MET), MISSED)
}

/// Whether the first slices came nearer to a solution than the others did.
fn nearer(slices: &[MovedSlice], others: &[MovedSlice]) -> bool {
    let last = |slices: &[MovedSlice]| slices.last().map_or(f64::INFINITY, |s| s.residual);
    others.is_empty() || last(slices) < last(others)
}

/// Hyperplanes l_0(x - p) = δ and l_k(x - p) = 0 in the neighbourhood of p.
struct Slices<'a> {
    around: Around<'a>,
    /// l_0, l_1, ..., of length 1 and 0 outside the null space.
    forms: Vec<Vec<Complex64>>,
}

/// The point on a slice that comes nearest to a solution.
struct Nearest {
    residual: f64,
    /// Difference between this point and the singular point.
    offset: Vec<Complex64>,
}

impl Default for Nearest {
    fn default() -> Self {
        Self {
            residual: f64::INFINITY,
            offset: Vec::new(),
        }
    }
}

impl<'a> Slices<'a> {
    /// Makes slices with `cuts` hyperplanes besides the one that is moved; `normal` is the number of the normals that
    /// are tried.
    fn new(around: Around<'a>, cuts: usize, normal: u64) -> Self {
        let split = around.split;
        // All distances share these forms, so that the points on the slices belong to one curve.
        let mut random = RandomStream::new(cuts as u64 + (normal << 32), Purpose::Probe, 3);
        let forms = (0..=cuts).map(|_| {
            let mut form = vec![Complex64::default(); split.point.len()];
            for direction in &split.kernel {
                let weight = random.disc();
                for (l, v) in form.iter_mut().zip(direction) {
                    *l += weight * v.conj();
                }
            }
            let length = square(&form).sqrt();
            form.iter_mut().for_each(|l| *l /= length);
            form
        });
        Self {
            forms: forms.collect(),
            around,
        }
    }

    fn meet(&self, search: Search<'_>) -> Vec<MovedSlice> {
        let mut moved_slices: Vec<MovedSlice> = Vec::new();
        // Where a slice was met, the next one is met in the same direction.
        let mut direction = search.tangent.map(|components| self.along(components));
        for distance in self.distances() {
            let nearest = self.nearest_of(direction.as_deref(), distance);
            let slice = self.slice(distance, &nearest);
            let met = slice.near_residual() <= MET;
            moved_slices.push(slice);
            if met {
                direction = Some(nearest.offset);
            }
            // Only the farthest slice may miss a set.
            if moved_slices.len() > 1 && !met {
                break;
            }
        }
        moved_slices
    }

    /// Distances that the point's error allows, farthest first.
    fn distances(&self) -> impl Iterator<Item = f64> {
        let size = norm(&self.around.split.point);
        let least = ABOVE_ERROR * self.around.error;
        let distances = DISTANCES.iter().map(move |distance| distance * size);
        distances.filter(move |&distance| distance > least)
    }

    fn slice(&self, distance: f64, nearest: &Nearest) -> MovedSlice {
        let size = norm(&self.around.split.point);
        MovedSlice {
            distance: distance / size,
            residual: nearest.residual,
            reached: square(&nearest.offset).sqrt() / size,
        }
    }

    /// The nearest to a solution that is found in a direction that is known and in several others.
    fn nearest_of(&self, first_guess: Option<&[Complex64]>, distance: f64) -> Nearest {
        let first_guess = first_guess.map(<[Complex64]>::to_vec).into_iter();
        let others = (0..DIRECTIONS).map(|attempt| self.direction(attempt));
        let mut best = Nearest::default();
        for begin in first_guess.chain(others) {
            let tried = self.nearest(&begin, distance);
            if tried.residual < best.residual {
                best = tried;
            }
            if best.residual <= MET {
                break;
            }
        }
        best
    }

    /// A direction within the null space: that of l_0 at first, then others at random.
    fn direction(&self, attempt: u64) -> Vec<Complex64> {
        if attempt == 0 {
            return self.forms[0].iter().map(Complex64::conj).collect();
        }
        let mut random = RandomStream::new(attempt, Purpose::Probe, 4);
        let weights: Vec<Complex64> = self
            .around
            .split
            .kernel
            .iter()
            .map(|_| random.disc())
            .collect();
        self.along(&weights)
    }

    /// The direction with these components in the null space.
    fn along(&self, components: &[Complex64]) -> Vec<Complex64> {
        let mut direction = vec![Complex64::default(); self.around.split.point.len()];
        for (basis, component) in self.around.split.kernel.iter().zip(components) {
            for (d, v) in direction.iter_mut().zip(basis) {
                *d += component * v;
            }
        }
        direction
    }

    /// The least residual that Gauss-Newton steps find near p on the slice at this distance, beginning in
    /// this direction, and where that is, from p.
    fn nearest(&self, direction: &[Complex64], distance: f64) -> Nearest {
        let value = apply(&self.forms[0], direction);
        let mut best = Nearest::default();
        // Nearly parallel to the slice.
        if value.norm_sqr() < 1e-4 * square(direction) {
            return best;
        }
        let scale = self.around.split.scale;
        let mut offset: Vec<Complex64> = direction.iter().map(|d| d * (distance / value)).collect();
        let mut x = PrecisePoint::new(&self.around.split.point);
        x.add(&offset);
        let mut without_gain = 0;
        let mut before: Option<Vec<Complex64>> = None;
        for _ in 0..MOST_STEPS {
            let Around { system, target, .. } = self.around;
            let linearization = system.linearize_precisely(x.coordinates(), target);
            let residual = square(&linearization.values).sqrt() / scale;
            if !residual.is_finite() || square(&offset).sqrt() > REACH * distance {
                break;
            }
            let gained = residual < 0.8 * best.residual;
            without_gain = if gained { 0 } else { without_gain + 1 };
            if residual < best.residual {
                best = Nearest {
                    residual,
                    offset: offset.clone(),
                };
            }
            if residual <= ROUNDING || without_gain > 6 {
                break;
            }
            // The slices as equations as large as the others.
            let (mut values, mut columns) = (linearization.values, linearization.columns);
            for (k, form) in self.forms.iter().enumerate() {
                let wanted = if k == 0 { distance } else { 0.0 };
                values.push((apply(form, &offset) - wanted) * scale);
                for (column, l) in columns.iter_mut().zip(form) {
                    column.push(l * scale);
                }
            }
            let mut step = newton_step(columns, &values, distance);
            match before.take().and_then(|before| shrinking(&before, &step)) {
                // The sum of all the steps to come.
                Some(ratio) => step.iter_mut().for_each(|s| *s /= 1.0 - ratio),
                None => before = Some(step.clone()),
            }
            x.add(&step);
            offset.iter_mut().zip(&step).for_each(|(o, s)| *o += s);
        }
        best
    }
}

/// By how much a step is shorter than the one before, where it has the same direction and Newton's method converges as it
/// does towards a multiple point or set: steps that shrink by 1/2 in the singular directions if its multiplicity is 2,
/// by 2/3 if it is 3 (Griewank: On solving nonlinear equations with simple singularities, SIAM Review 27, 1985).
fn shrinking(before: &[Complex64], step: &[Complex64]) -> Option<f64> {
    let product: Complex64 = before.iter().zip(step).map(|(b, s)| b.conj() * s).sum();
    let ratio = product.re / square(before);
    let turned: Vec<Complex64> = before
        .iter()
        .zip(step)
        .map(|(b, s)| s - b * ratio)
        .collect();
    let same = square(&turned) <= SAME_DIRECTION * SAME_DIRECTION * square(step);
    (same && (LEAST_SHRINKING..=MOST_SHRINKING).contains(&ratio)).then_some(ratio)
}

/// The least-squares Newton step.
fn newton_step(columns: Vec<Vec<Complex64>>, values: &[Complex64], limit: f64) -> Vec<Complex64> {
    let step = least_squares(&columns, values).filter(|step| square(step) <= limit * limit);
    match step {
        Some(step) => step.into_iter().map(|s| -s).collect(),
        None => limited_step(&Svd::of(columns), values, limit),
    }
}

/// Computes the least-squares Newton step from singular values, with at most length `limit` in each singular direction:
/// where the equations are nearly singular, the full step is long without reason.
fn limited_step(svd: &Svd, values: &[Complex64], limit: f64) -> Vec<Complex64> {
    let largest = svd.values.first().copied().unwrap_or(0.0);
    let mut step = vec![Complex64::default(); svd.domain.len()];
    let regular = svd
        .values
        .iter()
        .enumerate()
        .filter(|(_, s)| **s > LEAST_VALUE * largest);
    for (k, value) in regular {
        let pairs = svd.images[k].iter().zip(values);
        let product: Complex64 = pairs.map(|(u, b)| u.conj() * b).sum();
        let mut factor = -product / (value * value);
        let length = factor.norm_sqr().sqrt();
        if length > limit {
            factor *= limit / length;
        }
        for (s, v) in step.iter_mut().zip(&svd.domain[k]) {
            *s += factor * v;
        }
    }
    step
}

fn apply(form: &[Complex64], x: &[Complex64]) -> Complex64 {
    form.iter().zip(x).map(|(l, x)| l * x).sum()
}
