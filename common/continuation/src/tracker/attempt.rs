//! Attempt: where the next step of every lane leads.

use super::batch::Batch;
use super::limits::control;
use cognate_numeric::scalar::{Complex, Mask, Real};

/// The step of every lane that is tried.
pub(super) struct Attempt<R: Real> {
    /// The value of t that the step leads to.
    pub t: Complex<R::Control>,
    /// Length of the step in t.
    pub length: R::Control,
    /// Lanes whose step ends at their target.
    pub reaches: R::Mask,
    /// Lanes whose step has length 0: their points are refined.
    pub refines: R::Mask,
}

impl<R: Real> Attempt<R> {
    /// A step of the wanted length towards the target, or the target itself.
    #[inline(always)]
    pub fn next(batch: &Batch<R>) -> Self {
        let here = &batch.t[batch.newest];
        let mut way = batch.target.clone();
        way.sub(here);
        let mut remaining = way.norm_sqr();
        remaining.sqrt();
        let reaches = remaining.less_equal(&batch.h);
        // The last two steps are equal: a tiny last one would show nothing but noise.
        let mut half = remaining.clone();
        half.mul(&control::<R>(0.5));
        let mut length = batch.h.clone();
        length.select(half.less_equal(&batch.h), &half);
        length.select(reaches, &remaining);
        let mut ratio = length.clone();
        ratio.div(&remaining);
        length.select(batch.refine, &control::<R>(0.0));
        let mut t = here.clone();
        way.scale(&ratio);
        t.add(&way);
        t.select(reaches, &batch.target);
        t.select(batch.refine, here);
        Self {
            t,
            length,
            reaches,
            refines: batch.refine,
        }
    }

    /// Lanes whose step leads from outside this circle around t = 0 to its inside, on the real axis.
    #[inline(always)]
    pub fn enters(&self, batch: &Batch<R>, radius: f64) -> R::Mask {
        let radius = control::<R>(radius);
        let outside = batch.t[batch.newest].re.less_equal(&radius).not();
        self.t.re.less_equal(&radius).and(outside)
    }
}
