//! Missing points: witness points that no path came to, looked for by loops of the slice.
//!
//! Around a loop a witness point comes to one of the same component, also to one that is not known. A new point joins
//! the set as a class by itself: which points belong together is said by loops that know all of them.

use crate::decomposition::deflated::{ProblemContext, PureSet};
use crate::decomposition::problem::REFINED;
use cognate_continuation::bend::RefinedPoint;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Loops in a row that find no point before those that are missing stay so.
const IDLE: u32 = 8;
/// New ends nearer to one another than this, relative to their size, are those of paths that met.
const MET: f64 = 1e-6;

/// Counts of the search for missing points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MissingPoints {
    found: u64,
    /// Loops since the last that found points.
    idle: u32,
}

impl MissingPoints {
    /// Whether another loop may find points.
    pub fn may_be_found(&self) -> bool {
        self.idle < IDLE
    }

    /// Points that were found in all.
    pub fn found(&self) -> u64 {
        self.found
    }

    /// Counts a loop that found this number of points.
    pub fn count_loop(&mut self, new_points: usize) {
        self.found += new_points as u64;
        if new_points > 0 {
            self.idle = 0;
        } else {
            self.idle += 1;
        }
    }
}

/// The ends of a loop that are no known points of the set: regular solutions of all its equations on its slices. None
/// of a loop in which paths met, or ended elsewhere. `places`: which known point each end is.
pub(super) fn new_points(
    context: &mut ProblemContext<'_>,
    set: &PureSet,
    ends: &[Vec<Complex64>],
    places: &[Option<usize>],
) -> Vec<RefinedPoint> {
    let problem = context.problem;
    let variable_count = problem.variables();
    let known_places: Vec<usize> = places.iter().copied().flatten().collect();
    let different: BTreeSet<usize> = known_places.iter().copied().collect();
    let pairs = ends.iter().zip(places);
    let new = pairs.filter(|(_, place)| place.is_none());
    let new: Vec<Vec<Complex64>> = new.map(|(end, _)| end[..variable_count].to_vec()).collect();
    if different.len() < known_places.len() || new.is_empty() || some_met(&new) {
        return Vec::new();
    }
    let slices = problem.slices(set.dimension);
    let refined = context
        .deflations
        .points_on(problem, (&slices, &set.ranks), &new);
    let solves = |refined: &RefinedPoint| {
        problem.solves(&refined.point[..variable_count], &REFINED) == Some(true)
    };
    let new_points: Option<Vec<RefinedPoint>> = refined
        .into_iter()
        .map(|refined| refined.filter(solves))
        .collect();
    new_points.unwrap_or_default()
}

/// Whether two of these points are one.
fn some_met(points: &[Vec<Complex64>]) -> bool {
    let near = |a: &[Complex64], b: &[Complex64]| {
        let pairs = a.iter().zip(b);
        let (size, apart) = pairs.fold((1.0, 0.0), |(size, apart), (x, y)| {
            (size + x.norm_sqr(), apart + (x - y).norm_sqr())
        });
        apart <= MET * MET * size
    };
    let mut after = points.iter().enumerate();
    after.any(|(k, a)| points[k + 1..].iter().any(|b| near(a, b)))
}
