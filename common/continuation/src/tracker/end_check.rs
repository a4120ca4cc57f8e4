//! Check of ends that somebody else reports: regular ones by Newton's method in double-doubles, started at each of them.
//!
//! Results of a stage's paths come in; the places of those go out that are not what the paths give, or may not be. The
//! method is that of `iterative_refinement`, so that an end which has its digits is at rest. It says nothing of singular
//! ends and of paths that diverge, nor whether an end is that of its path: only the path tells that.

use super::iterative_refinement::{NewtonAtEnds, RoughEnd, largest_part};
use crate::item_result::ItemResult;
use crate::path_result::PathResult;
use crate::refine::Refiner;
use crate::stage::PreparedStage;
use crate::tracker::outcome::PathOutcome;
use cognate_numeric::lanes::called::WIDTH;
use cognate_numeric::precision::{DOUBLE_DOUBLE, rungs};
use cognate_numeric::scalar::MultiplePrecision;
use num_complex::Complex64;

/// Newton's method moves an end by at most so many times its error.
const MARGIN: f64 = 64.0;
/// An end is moved by at most this part of its largest coordinate, whatever error it claims.
const MOST: f64 = 1e-6;
/// The same where all coordinates are small, as at the solution 0: absolute.
const MOST_NEAR_ZERO: f64 = 1e-12;
/// No coordinate of an end is larger: the largest one of each group has modulus about 1.
const MOST_COORDINATE: f64 = 4.0;

impl PreparedStage {
    /// Places of the results, of the items from `first` on, that are not what their paths give, or may not be.
    pub(crate) fn doubtful_ends(&self, first: u64, results: &[ItemResult]) -> Vec<usize> {
        let mut doubtful = Vec::new();
        let mut regular: Vec<(RoughEnd, f64)> = Vec::new();
        for (place, result) in results.iter().enumerate() {
            let ItemResult::Track(path) = result else {
                doubtful.push(place);
                continue;
            };
            let (_, target) = self.item(first + place as u64);
            if !self.is_consistent(path, target) {
                doubtful.push(place);
            } else if path.outcome == PathOutcome::Regular {
                match self.homotopy().chart().point(path.endpoint.to_double()) {
                    None => doubtful.push(place),
                    Some(point) => {
                        let end = RoughEnd {
                            place,
                            point,
                            target,
                        };
                        regular.push((end, path.accuracy));
                    }
                }
            }
        }
        doubtful.extend(self.not_at_rest(&regular));
        doubtful.sort_unstable();
        doubtful
    }

    /// Whether an end has the coordinates that it must have, and what is said of the equations that are asked is so.
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

    /// Places of the ends that Newton's method moves by more than their errors, in doubles, or does not settle at.
    fn not_at_rest(&self, ends: &[(RoughEnd, f64)]) -> Vec<usize> {
        if ends.is_empty() {
            return Vec::new();
        }
        let mut newton = NewtonAtEnds::new(self.homotopy());
        let mut moved_too_far = Vec::new();
        for ends in ends.chunks(WIDTH) {
            let (rough, errors): (Vec<RoughEnd>, Vec<f64>) = ends.iter().cloned().unzip();
            let settled = newton.refine(&rough);
            for ((end, error), settled) in rough.iter().zip(errors).zip(settled) {
                let settled = settled.map(|point| point.x.iter().map(|x| x.lane(0)).collect());
                let settled: Option<Vec<Complex64>> = settled.or_else(|| self.settled(end));
                let is_at_rest = settled.is_some_and(|settled| {
                    let largest = largest_part(end.point.iter().copied());
                    let moved = largest_part(settled.iter().zip(&end.point).map(|(a, b)| a - b));
                    // A stage that is not the last gives start points, which the next one refines.
                    let error = match self.ends_at_the_system() {
                        true => (MARGIN * error.max(f64::EPSILON)).min(MOST),
                        false => MOST,
                    };
                    moved <= (error * largest).max(MOST_NEAR_ZERO)
                });
                if !is_at_rest {
                    moved_too_far.push(end.place);
                }
            }
        }
        moved_too_far
    }

    /// Where Newton's method settles on the rungs above double-doubles.
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
