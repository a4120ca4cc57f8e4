//! Prediction: where the paths of all lanes are expected at the end of a step.

use super::attempt::Attempt;
use super::batch::Batch;
use super::taylor_probe::Series;
use crate::predictor::hermite::{POINTS, weights};
use cognate_numeric::scalar::{Complex, Mask, Real};

/// Predicted points of all lanes.
pub(super) struct Prediction<R: Real> {
    pub x: Vec<Complex<R>>,
    /// Space for the tangents that the corrector finds.
    pub tangent: Vec<Complex<R>>,
    /// Earlier points that the predictor used, in each lane: the order of its error follows from their number.
    pub used: [R::Mask; POINTS - 1],
}

/// `sum += weight * value`. Within a function of its own, since a closure that is called in several places would
/// not be compiled for the instruction set of its caller.
#[inline(always)]
fn accumulate<R: Real>(
    context: R::Context,
    sum: &mut Complex<R>,
    weight: &Complex<R::Control>,
    value: &Complex<R>,
) {
    sum.mul_add(&Complex::from_control(context, weight), value);
}

impl<R: Real> Prediction<R> {
    /// Hermite's extrapolation through the points that count; from the point itself where the step has length 0.
    ///
    /// `fine`: numbers have more digits than doubles, of which the weights are made.
    #[inline(always)]
    pub fn extrapolated(
        context: R::Context,
        batch: &mut Batch<R>,
        attempt: &Attempt<R>,
        fine: bool,
    ) -> Self {
        let slots: [usize; POINTS] = std::array::from_fn(|age| batch.slot(age));
        let used: [R::Mask; POINTS - 1] = std::array::from_fn(|k| batch.known[slots[k + 1]]);
        let moving = attempt.refines.not();
        let w = weights(
            &std::array::from_fn(|age| batch.t[slots[age]].clone()),
            &attempt.t,
            &std::array::from_fn(|k| used[k].and(moving)),
        );
        let next = batch.slot(POINTS);
        let mut x = std::mem::take(&mut batch.x[next]);
        let tangent = std::mem::take(&mut batch.tangent[next]);
        let newest = batch.newest;
        for i in 0..x.len() {
            let mut sum = Complex::zero(context);
            let here = &batch.x[newest][i];
            for (age, &slot) in slots.iter().enumerate().rev() {
                accumulate(context, &mut sum, &w.tangent[age], &batch.tangent[slot][i]);
                // Weights are doubles: their rounding counts as a part of how far the points are apart,
                // not of how large they are, where there are more digits.
                if !fine {
                    accumulate(context, &mut sum, &w.point[age], &batch.x[slot][i]);
                } else if age > 0 {
                    x[i].set(&batch.x[slot][i]);
                    x[i].sub(here);
                    accumulate(context, &mut sum, &w.point[age], &x[i]);
                }
            }
            if fine {
                sum.add(here);
            }
            x[i].set(&sum);
        }
        Self { x, tangent, used }
    }

    /// Replaces the prediction by that of the Taylor series, in lanes that move and have one.
    #[inline(always)]
    pub fn follow_series(
        &mut self,
        context: R::Context,
        batch: &Batch<R>,
        attempt: &Attempt<R>,
        series: &[Option<Series>],
    ) {
        let moving = attempt.refines.not();
        for (lane, series) in series.iter().enumerate() {
            if let Some(series) = series.as_ref().filter(|_| moving.lane(lane)) {
                let length = attempt.length.lane(lane);
                batch.extrapolate(context, lane, series, length, &mut self.x);
                // The error of the series is of order 5: between those of Hermite's formula with two points and with
                // three.
                for (k, used) in self.used.iter_mut().enumerate() {
                    used.set_lane(lane, k == 0);
                }
            }
        }
    }
}
