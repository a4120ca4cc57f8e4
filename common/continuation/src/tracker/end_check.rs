//! Check of reported ends: regular ends are checked by Newton's method, started at each of them.
//!
//! Results of a stage's paths come in. The places of results go out that are not what their paths give, or may not be.
//! A step in doubles suffices where rounding is small beside the error that an end claims; elsewhere the method
//! is that of `iterative_refinement`, so that an end that has its digits is at rest. Singular ends and paths that
//! diverge are not checked, nor whether an end is that of its path: only the path tells.

use super::iterative_refinement::{NewtonAtEnds, RoughEnd, StepInDoubles, largest_part};
use crate::item_result::ItemResult;
use crate::path_result::PathResult;
use crate::refine::Refiner;
use crate::stage::PreparedStage;
use crate::tracker::outcome::PathOutcome;
use cognate_numeric::lanes::called::WIDTH;
use cognate_numeric::precision::{DOUBLE_DOUBLE, rungs};
use cognate_numeric::scalar::MultiplePrecision;
use num_complex::Complex64;

/// Newton's method moves an end by at most so many times the error that it claims.
const MARGIN: f64 = 64.0;
/// Newton's method moves an end by at most this part of its largest coordinate, whatever error it claims.
const MOST_RELATIVE_MOVE: f64 = 1e-6;
/// The same where all coordinates are small, as at the solution 0: absolute.
const MOST_MOVE_NEAR_ZERO: f64 = 1e-12;
/// Bound of the coordinates of an end: in each group the largest one has modulus about 1.
const MOST_COORDINATE: f64 = 4.0;

/// A regular end that a worker reports.
#[derive(Clone)]
struct ReportedEnd {
    end: RoughEnd,
    /// The accuracy that the worker claims.
    accuracy: f64,
}

impl PreparedStage {
    /// Places of results, of the items from `first` on, that are not what their paths give, or may not be.
    pub(crate) fn doubtful_ends(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        let mut doubtful = Vec::new();
        let mut regular = Vec::new();
        for (place, result) in results.iter().enumerate() {
            let (_, target) = self.item(first + place as u64);
            let Some(path) = result
                .path()
                .filter(|path| self.is_consistent(path, target))
            else {
                doubtful.push(place);
                continue;
            };
            if path.outcome != PathOutcome::Regular {
                continue;
            }
            match self.homotopy().chart().point(path.endpoint.to_double()) {
                None => doubtful.push(place),
                Some(point) => regular.push(ReportedEnd {
                    end: RoughEnd {
                        place,
                        point,
                        target,
                    },
                    accuracy: path.accuracy,
                }),
            }
        }
        doubtful.extend(self.not_at_rest(&regular));
        doubtful.sort_unstable();
        doubtful
    }

    /// Whether an end has as many coordinates as it must have, of the right size, and solves the equations that are asked
    /// as well as it claims.
    fn is_consistent(&self, path: &PathResult, target: u64) -> bool {
        if matches!(path.outcome, PathOutcome::Failed(_)) {
            return true;
        }
        let chart = self.homotopy().chart();
        let coordinates: usize = (0..chart.group_count())
            .map(|group| chart.group_size(group))
            .sum();
        let end = path.endpoint.to_double();
        // A comparison that a NaN fails.
        let is_scaled =
            |z: &Complex64| z.re.abs() <= MOST_COORDINATE && z.im.abs() <= MOST_COORDINATE;
        let has_coordinates = end.len() == coordinates && end.iter().all(is_scaled);
        has_coordinates && path.asked == self.fit_of_asked(path, target)
    }

    /// Places of the ends that Newton's method moves too far, or at which it does not settle.
    fn not_at_rest(&self, ends: &[ReportedEnd]) -> Vec<usize> {
        if ends.is_empty() {
            return Vec::new();
        }
        let mut newton = NewtonAtEnds::new(self.homotopy());
        let mut to_refine = Vec::new();
        for ends in ends.chunks(WIDTH) {
            let rough: Vec<RoughEnd> = ends.iter().map(|reported| reported.end.clone()).collect();
            let steps = newton.steps_in_doubles(&rough);
            // A comparison that a NaN fails.
            let is_at_rest = |reported: &ReportedEnd, step: &StepInDoubles| {
                step.correction + step.rounding <= self.most_move(reported.accuracy, step.largest)
            };
            let both = ends.iter().zip(&steps);
            let in_doubt = both.filter(|(reported, step)| !is_at_rest(reported, step));
            to_refine.extend(in_doubt.map(|(reported, _)| reported.clone()));
        }
        let mut moved_too_far = Vec::new();
        for ends in to_refine.chunks(WIDTH) {
            let rough: Vec<RoughEnd> = ends.iter().map(|reported| reported.end.clone()).collect();
            for (reported, settled) in ends.iter().zip(newton.refine(&rough)) {
                let point = &reported.end.point;
                let settled = settled.map(|point| point.x.iter().map(|x| x.lane(0)).collect());
                let settled: Option<Vec<Complex64>> =
                    settled.or_else(|| self.settled(&reported.end));
                let is_at_rest = settled.is_some_and(|settled| {
                    let largest = largest_part(point.iter().copied());
                    let moved = largest_part(settled.iter().zip(point).map(|(a, b)| a - b));
                    moved <= self.most_move(reported.accuracy, largest)
                });
                if !is_at_rest {
                    moved_too_far.push(reported.end.place);
                }
            }
        }
        moved_too_far
    }

    /// How far Newton's method may move an end of this accuracy and size.
    fn most_move(&self, accuracy: f64, largest: f64) -> f64 {
        let relative = match self.ends_at_the_system() {
            true => (MARGIN * accuracy.max(f64::EPSILON)).min(MOST_RELATIVE_MOVE),
            // A stage that is not the last gives start points, which the next one refines.
            false => MOST_RELATIVE_MOVE,
        };
        (relative * largest).max(MOST_MOVE_NEAR_ZERO)
    }

    /// The point at which Newton's method settles on the rungs above double-doubles.
    fn settled(&self, end: &RoughEnd) -> Option<Vec<Complex64>> {
        let mut above = rungs(DOUBLE_DOUBLE, self.settings().max_precision_bits).skip(1);
        above.find_map(|bits| {
            let mut point = end.point.clone();
            let refiner = Refiner::<MultiplePrecision>::new(self.homotopy(), bits);
            let report = refiner.with_all_digits().refine(&mut point, end.target);
            report.converged.then_some(point)
        })
    }
}
