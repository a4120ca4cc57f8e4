//! Step length: how long the next step of every lane may be, by how good the prediction of this one was.

use super::attempt::Attempt;
use super::batch::Batch;
use super::corrector::Corrections;
use super::limits::control;
use super::settings::Settings;
use crate::predictor::hermite::POINTS;
use crate::step_control::{largest_error, next_step};
use cognate_numeric::scalar::{Mask, Real};

/// Sets the wanted length of the next step.
///
/// `used`: which points behind it the predictor used; `noise`: a second correction below it says nothing of
/// convergence; `moved`: the lanes whose step has a length and is accepted.
#[inline(always)]
pub(super) fn set_next_length<R: Real>(
    batch: &mut Batch<R>,
    attempt: &Attempt<R>,
    settings: &Settings,
    noise: f64,
    used: &[R::Mask; POINTS - 1],
    corrections: &Corrections<R>,
    moved: R::Mask,
) {
    let [first, second, _] = &corrections.relative;
    let tolerance = control::<R>(settings.tolerance);
    let noise = control::<R>(noise);
    let largest = largest_error(first, second, &batch.limit, &tolerance, &noise);
    let mut h = next_step(&batch.h, first, &largest, used, moved, batch.may_grow);
    h.min(&control::<R>(settings.max_step));
    h.select(attempt.refines, &batch.h);
    batch.h.set(&h);
    batch.may_grow = moved.or(attempt.refines);
}
