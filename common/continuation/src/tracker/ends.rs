//! Ends: how a lane's path ends, is put aside or fails, and what is recorded of it.

use super::far_out::{self, Place};
use super::lockstep::Lockstep;
use super::outcome::{Failure, PathOutcome};
use crate::path_result::{Coordinates, Counts, PathIndex, PathResult};
use crate::refine::{Refiner, Report};
use cognate_numeric::precision::DOUBLE;
use cognate_numeric::scalar::{DoubleDouble, Real};
use num_complex::Complex64;

/// A regular end whose homogenising coordinate is below this part of the largest lacks digits.
const FAR_OUT: f64 = 1e-6;
/// Above this condition number doubles do not tell a regular point from one beside a double point: Newton's method stops
/// at the distance d from a double point where d^2 is rounding, 1e-8, and the condition number there is about 1/d, less
/// for equations whose second derivatives are large.
const CONDITION_BESIDE_DOUBLE_POINT: f64 = 1e5;

/// End of a path: outcome, t and facts.
pub(super) struct End {
    pub outcome: PathOutcome,
    /// t at the end.
    pub t: Complex64,
    pub report: Report,
    pub winding_number: Option<u32>,
    /// Turns of each homogenising coordinate.
    pub infinity_turns: Vec<i32>,
}

impl<R: Real> Lockstep<'_, R> {
    /// Whether a point where Newton's method has led, as this report says, is a regular end of a path: it converges there,
    /// the condition number is small enough, and where doubles do not tell, Newton's method converges with twice the
    /// digits, too.
    pub(super) fn is_regular_end(&self, point: &[Complex64], target: u64, report: &Report) -> bool {
        let is_regular = report.converged && report.condition <= self.settings.singular_condition;
        let told = self.tracking.bits > DOUBLE || report.condition <= CONDITION_BESIDE_DOUBLE_POINT;
        is_regular
            && (told || {
                let homotopy = self.tracking.homotopy;
                let mut refiner = Refiner::<DoubleDouble<f64>>::new(homotopy, ()).with_all_digits();
                refiner.refine(&mut point.to_vec(), target).converged
            })
    }

    /// Records the end of a path at `self.point`; the lane takes the next path.
    pub(super) fn finish(
        &mut self,
        lane: usize,
        outcome: PathOutcome,
        report: Report,
        winding_number: Option<u32>,
        infinity_turns: Vec<i32>,
    ) {
        let (outcome, report, endpoint) = self.endpoint(self.lanes[lane].target, outcome, report);
        let end = End {
            outcome,
            t: Complex64::default(),
            report,
            winding_number,
            infinity_turns,
        };
        self.record(lane, end, endpoint);
        self.refill(lane);
    }

    /// The path is not followed further than where it is.
    pub(super) fn put_aside(&mut self, lane: usize, t: Complex64) {
        self.batch
            .read_here(lane, &mut self.point, &mut self.tangent);
        self.stop(lane, t, PathOutcome::PutAside);
        self.refill(lane);
    }

    /// The path fails where it is.
    pub(super) fn fail_and_refill(&mut self, lane: usize, t: Complex64, why: Failure) {
        self.batch
            .read_here(lane, &mut self.point, &mut self.tangent);
        self.fail(lane, t, why);
        self.refill(lane);
    }

    pub(super) fn fail(&mut self, lane: usize, t: Complex64, why: Failure) {
        self.stop(lane, t, PathOutcome::Failed(why));
    }

    /// The path's end is not known: it stops at `self.point`.
    fn stop(&mut self, lane: usize, t: Complex64, outcome: PathOutcome) {
        let end = End {
            outcome,
            t,
            report: Report::unknown(),
            winding_number: None,
            infinity_turns: Vec::new(),
        };
        let endpoint = self.tracking.homotopy.endpoint(&self.point);
        self.record(lane, end, endpoint);
    }

    /// Records the end of a path, at a point with these normalised homogeneous coordinates.
    pub(super) fn record(&mut self, lane: usize, end: End, endpoint: Vec<Complex64>) {
        let path = &self.lanes[lane];
        let result = PathResult {
            origin: PathIndex(path.origin),
            attempt: self.stage.attempt(),
            outcome: end.outcome,
            endpoint: Coordinates::Double(endpoint),
            t: end.t,
            residual: end.report.residual,
            condition: end.report.condition,
            accuracy: end.report.accuracy,
            winding_number: end.winding_number,
            infinity_turns: end.infinity_turns,
            precision_bits: path.highest_bits,
            counts: Counts {
                steps: path.steps,
                rejections: path.rejections,
                evaluations: path.evaluations,
                exchanges: self.batch.exchanges.lane(lane) as u32,
                turns: path.cauchy.total_turns(),
            },
            asked: None,
            local_dimension: None,
            boundary: path
                .boundary
                .filter(|_| matches!(end.outcome, PathOutcome::Singular | PathOutcome::Diverging))
                .map(Box::new),
        };
        self.ended.results.push((path.item, result));
    }

    /// Outcome of a path, and the normalised homogeneous coordinates of its end. A regular point far out is given with
    /// digits of its own: the digits that doubles have there are those of its largest coordinate.
    fn endpoint(
        &self,
        target: u64,
        outcome: PathOutcome,
        report: Report,
    ) -> (PathOutcome, Report, Vec<Complex64>) {
        let homotopy = self.tracking.homotopy;
        let coordinates = homotopy.endpoint(&self.point);
        let is_far_out = || homotopy.smallest_homogenizing(&coordinates) < FAR_OUT;
        if outcome != PathOutcome::Regular || !is_far_out() {
            return (outcome, report, coordinates);
        }
        match far_out::resolve(self.stage, homotopy, &self.point, target) {
            Place::Resolved(coordinates) => (outcome, report, coordinates),
            Place::WithinDataAccuracy(coordinate) => {
                let accuracy = coordinate;
                let report = Report { accuracy, ..report };
                (PathOutcome::Diverging, report, coordinates)
            }
            Place::Unresolved => {
                let coordinates = far_out::unresolved(homotopy, coordinates);
                (outcome, report, coordinates)
            }
        }
    }
}
