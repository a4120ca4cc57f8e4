//! Search: witness points that no path came to, looked for by loops of the slice.
//!
//! Around a loop a witness point comes to one of the same component, also to one that is not known. What is found joins
//! the points of its set, and only as a point: which belong together is said by loops that know all of them.

use super::deflated::{Deflations, PureSet};
use super::problem::{Problem, REFINED};
use cognate_continuation::bend::RefinedPoint;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Loops in a row that find no point before those that are missing stay so.
const IDLE: u32 = 8;
/// New ends nearer to one another than this, relative to their size, are those of paths that met.
const MET: f64 = 1e-6;

/// State of the search by loops for missing points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Search {
    /// Whether the open loop searches for missing points.
    on: bool,
    /// Whether the open stage asks for the derivatives of the points that were found.
    bending: bool,
    found: u64,
    idle: u32,
}

impl Search {
    /// Whether another loop may find something; it is then one of these.
    pub fn begin(&mut self) -> bool {
        self.on = self.idle < IDLE;
        self.on
    }

    /// The next loop is none of these.
    pub fn end(&mut self) {
        self.on = false;
    }

    /// Whether the open loop is one of these.
    pub fn is_on(&self) -> bool {
        self.on
    }

    /// Whether the open stage asks how points that were found move.
    pub fn asks_bends(&self) -> bool {
        self.bending
    }

    /// Notes that the derivatives of the found points are known.
    pub fn bends_are_known(&mut self) {
        self.bending = false;
    }

    /// Points that were found in all.
    pub fn found(&self) -> u64 {
        self.found
    }

    /// A loop led to no other points, or not all around.
    pub fn found_nothing(&mut self) {
        self.idle += 1;
    }

    /// The ends of a loop that are no known points of the set: regular solutions of all its equations on its slices.
    /// None of a loop in which paths met, or ended elsewhere. `places`: which known point each end is.
    pub fn lost_points(
        &mut self,
        (problem, deflations): (&Problem, &mut Deflations),
        set: &PureSet,
        ends: &[Vec<Complex64>],
        places: &[Option<usize>],
    ) -> Vec<RefinedPoint> {
        let variable_count = problem.variables();
        let known_places: Vec<usize> = places.iter().copied().flatten().collect();
        let different: BTreeSet<usize> = known_places.iter().copied().collect();
        let pairs = ends.iter().zip(places);
        let new = pairs.filter(|(_, place)| place.is_none());
        let new: Vec<Vec<Complex64>> = new.map(|(end, _)| end[..variable_count].to_vec()).collect();
        if different.len() < known_places.len() || new.is_empty() || some_met(&new) {
            self.found_nothing();
            return Vec::new();
        }
        let slices = problem.slices(set.dimension);
        let refined = deflations.points_on(problem, (&slices, &set.ranks), &new);
        let solves = |refined: &RefinedPoint| {
            problem.solves(&refined.point[..variable_count], &REFINED) == Some(true)
        };
        let lost_points: Option<Vec<RefinedPoint>> = refined
            .into_iter()
            .map(|refined| refined.filter(solves))
            .collect();
        let lost_points = lost_points.unwrap_or_default();
        match lost_points.is_empty() {
            true => self.found_nothing(),
            false => {
                self.idle = 0;
                self.bending = true;
                self.found += lost_points.len() as u64;
            }
        }
        lost_points
    }
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
