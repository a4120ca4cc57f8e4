//! PathResult: what is known about one path when it ends.
//!
//! Facts only, no time and no worker, so that two executions of one path can be
//! compared bit for bit. What needs all paths at once (multiplicity, duplicates,
//! classes) is `solutions`' business.

use crate::tracker::outcome::PathOutcome;
use cognate_numeric::precision::DOUBLE;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A path's number: its index in the stage that first started it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct PathIndex(pub u64);

/// The coordinates of a point in the arithmetic that it was found in.
///
/// Homogeneous coordinates, group after group in the order of the system's
/// groups: an affine group of n variables has n + 1 coordinates, the
/// homogenising one first; a homogeneous group has its variables. Each group is
/// scaled so that its largest coordinate has modulus about 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Coordinates {
    /// Hardware doubles.
    Double(Vec<Complex64>),
}

impl Coordinates {
    /// Rounded to doubles.
    pub fn to_double(&self) -> &[Complex64] {
        match self {
            Self::Double(values) => values,
        }
    }
}

/// Work that was done for one path. The same on every machine and at every width.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Accepted steps.
    pub steps: u32,
    /// Rejected steps.
    pub rejections: u32,
    /// Evaluations of the homotopy with its derivatives, each followed by an elimination.
    pub evaluations: u32,
    /// Row exchanges that left the stage's preferred row order.
    pub exchanges: u32,
    /// Turns around the target that the endgame made.
    pub turns: u32,
}

/// Number of values in a key.
pub const NUMBERS: usize = 3;

/// Place where a path entered the endgame, as numbers that do not depend on the scaling of its point (see
/// `projection`). Two paths that became one have equal numbers within their margins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundaryKey {
    /// Numbers of the point at |t| = `endgame_boundary`.
    pub numbers: [f64; NUMBERS],
    /// Bound of the error of each number.
    pub margin: f64,
}

impl BoundaryKey {
    /// False where a number is none, or the margin could be anything.
    pub fn is_sound(&self) -> bool {
        let sound = |number: &f64| number.is_finite();
        self.numbers.iter().all(sound) && self.margin.is_finite() && self.margin >= 0.0
    }
}

/// Fit of an endpoint to the system that is asked, where combinations of its equations were tracked (see
/// `transform::randomize`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AskedFit {
    /// Largest |F_i| over all equations that are asked, each equation and each group scaled to 1.
    pub residual: f64,
    /// Distance by which a least-squares Newton step on all equations would move the endpoint, relative to its largest
    /// coordinate. At a solution it is about the endpoint's error.
    pub correction: f64,
}

/// Growth of the dual space of the system at an endpoint (see `local_dimension`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocalDimension {
    /// Dimension of the space of differential functionals of order 0, 0 and 1, ... that vanish on
    /// the ideal: 1, then 1 more than the corank of the Jacobian, ... Where two are equal the
    /// point is isolated and they are its multiplicity.
    pub dual_dimensions: Vec<u32>,
    /// An isolated point has at most this multiplicity: the dimensions went on no further past it.
    /// `u64::MAX` where no bound is known.
    pub bound: u64,
    /// Least factor between any singular value and the border between values and noise. About 1 where nothing can be
    /// decided.
    pub margin: f64,
    /// Results on the slices that are moved away from the endpoint, farthest first; empty where no slice was asked for.
    pub moved_slices: Vec<MovedSlice>,
}

/// Result of the search for solutions on a hyperplane that passes an endpoint at some distance (see
/// `local_dimension::moved_slice`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MovedSlice {
    /// Distance of the hyperplane from the endpoint, relative to the endpoint's size.
    pub distance: f64,
    /// The least residual found on the hyperplane near the endpoint, all equations scaled to 1.
    pub residual: f64,
    /// Distance from the endpoint to the point with this residual, relative to the endpoint's size.
    pub reached: f64,
}

/// A slice at least this far away that is met tells a set from an isolated point of multiplicity below 10; farther
/// away what Newton's method leaves on a set is a part of the distance.
const TELLING_SLICE: f64 = 0.01;
/// A slice at least this far away need not meet a set through the point.
const FAR_SLICE: f64 = 0.05;

impl MovedSlice {
    /// Whether solutions are met on slices at all small distances, one of which is far enough away to mean something.
    ///
    /// A slice is met where the residual on it, as it would be nearer, is at most `residual`, and misses everything
    /// where it is above `missed`.
    pub fn are_met(slices: &[Self], residual: f64, missed: f64) -> bool {
        let met = |slice: &Self| slice.near_residual() <= residual;
        // Far away Newton's method may find nothing; but a residual that is small there and falls with
        // the distance is that of a point of high multiplicity.
        let clear = |slice: &Self| met(slice) || slice.residual > missed;
        let (far, near): (Vec<&Self>, Vec<&Self>) =
            slices.iter().partition(|slice| slice.distance >= FAR_SLICE);
        near.iter().any(|slice| slice.distance >= TELLING_SLICE)
            && near.into_iter().all(met)
            && far.into_iter().all(clear)
    }

    /// The residual of a slice that is far away as it would be nearer.
    pub(crate) fn near_residual(&self) -> f64 {
        self.residual / (self.distance / TELLING_SLICE).max(1.0)
    }

    /// False where a number is none or negative.
    pub fn is_sound(&self) -> bool {
        [self.distance, self.residual, self.reached]
            .iter()
            .all(|&x| x >= 0.0)
    }
}

/// All that is known about one path when it ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathResult {
    /// The path, by its index in the stage that first started it.
    pub origin: PathIndex,
    /// 0 for the first time that the path is tracked, then 1, 2, ...
    pub attempt: u16,
    /// Outcome of the path.
    pub outcome: PathOutcome,
    /// Endpoint of the path; the last point of a failed path.
    pub endpoint: Coordinates,
    /// The path parameter where it ended: 0, except for a failed path.
    pub t: Complex64,
    /// Largest |F_i| at the endpoint, each equation and each group scaled to 1.
    pub residual: f64,
    /// Condition number of the Jacobian at the endpoint, each equation scaled to 1 on the patch;
    /// infinite where unknown.
    pub condition: f64,
    /// Error of the endpoint, relative to its largest coordinate: of a regular finite end of the system a bound that
    /// includes the rounding to doubles (see `tracker::iterative_refinement`), of others an estimate. Of a path that diverges:
    /// a power sum over its sheets of a homogenising coordinate (the largest coordinate being 1)
    /// that is not 0, but too small to tell it from infinity by doubles; infinite where there is none.
    pub accuracy: f64,
    /// Turns around t = 0 that bring the path back to itself; `None` where it was not asked (a regular endpoint has
    /// winding number 1).
    pub winding_number: Option<u32>,
    /// For each affine group: how often the homogenising coordinate turned around 0 while the
    /// path made its `winding_number` turns around t = 0. Positive: the coordinate goes to 0
    /// with t (the endpoint is at infinity). Empty where no turn was made.
    pub infinity_turns: Vec<i32>,
    /// Highest precision used, in bits.
    pub precision_bits: u32,
    /// Work that was done for the path.
    pub counts: Counts,
    /// Fit of the endpoint to the system that is asked; `None` where the asked system is the tracked one, and for a
    /// failed path.
    pub asked: Option<AskedFit>,
    /// Whether the endpoint is isolated, as a later stage found out; `None` where it was not asked.
    pub local_dimension: Option<LocalDimension>,
    /// Place where the path entered the endgame, for a path that ends at a singular point or runs to infinity; a
    /// regular end is enough to tell the path from others.
    pub boundary: Option<Box<BoundaryKey>>,
}

/// Largest error of a value of a refined end, before the rounding to doubles, as a part of the largest value (2^-57).
pub const REFINED_ERROR: f64 = 6.938_893_903_907_228e-18;

impl PathResult {
    /// Whether the values of the unknowns at this end have the digits that doubles can show (see
    /// `tracker::iterative_refinement`): the accuracy is that of the rounding to doubles.
    pub fn is_refined(&self) -> bool {
        let rounding = f64::EPSILON..=f64::EPSILON + REFINED_ERROR;
        self.outcome == PathOutcome::Regular && rounding.contains(&self.accuracy)
    }

    /// A result without a path: this point, and nothing known of it.
    pub fn untracked(
        origin: u64,
        attempt: u16,
        outcome: PathOutcome,
        endpoint: Vec<Complex64>,
    ) -> Self {
        Self {
            origin: PathIndex(origin),
            attempt,
            outcome,
            endpoint: Coordinates::Double(endpoint),
            t: Complex64::default(),
            residual: f64::INFINITY,
            condition: f64::INFINITY,
            accuracy: f64::INFINITY,
            winding_number: None,
            infinity_turns: Vec::new(),
            precision_bits: DOUBLE,
            counts: Counts::default(),
            asked: None,
            local_dimension: None,
            boundary: None,
        }
    }
}
