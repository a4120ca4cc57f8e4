//! Step control: from the observed correction to the next step length.
//!
//! The first Newton correction measures the predictor's error e; with local
//! order q the error of a step h scales as h^q, so the step that would have
//! met the target is h (target/e)^(1/q). Roots are taken as chains of square
//! roots, which are correctly rounded: nothing from libm decides a step.

use crate::predictor::hermite::{POINTS, at_least};
use cognate_numeric::scalar::{Mask, Real};

/// The error aimed at, as a part of the largest that is accepted.
const AIM: f64 = 0.25;
/// Longest growth of an accepted step, and shortest.
const GROWTH: (f64, f64) = (0.3, 2.0);
/// Largest and smallest shrinkage of a rejected step.
const SHRINKAGE: (f64, f64) = (0.1, 0.5);

/// `h` for the next step. `error` is the size of the first Newton correction, `limit` the largest accepted.
///
/// `known[k]`: whether the predictor could use point k + 1; `may_grow` is false after a rejection.
#[inline(always)]
pub fn next_step<C: Real<Context = (), Control = C>>(
    h: &C,
    error: &C,
    limit: &C,
    known: &[C::Mask; POINTS - 1],
    accepted: C::Mask,
    may_grow: C::Mask,
) -> C {
    let mut ratio = C::from_f64((), AIM);
    ratio.mul(limit);
    let mut floor = C::from_f64((), 1e-18);
    floor.max(error);
    ratio.div(&floor);
    // (target/error)^(1/2), ^(1/4), about ^(1/6) (1/8 + 1/32 = 1/6.4), and ^(1/8).
    let mut half = ratio;
    half.sqrt();
    let mut quarter = half.clone();
    quarter.sqrt();
    let mut eighth = quarter.clone();
    eighth.sqrt();
    let mut sixth = eighth.clone();
    sixth.sqrt();
    sixth.sqrt();
    sixth.mul(&eighth);
    let mut factor = half;
    for (enough, root) in at_least(known).iter().zip([&quarter, &sixth, &eighth]) {
        factor.select(*enough, root);
    }
    factor.mul(&C::from_f64((), 0.95));

    let mut grown = factor.clone();
    grown.max(&C::from_f64((), GROWTH.0));
    grown.min(&C::from_f64((), GROWTH.1));
    let mut steady = grown.clone();
    steady.min(&C::from_f64((), 1.0));
    grown.select(may_grow.not(), &steady);

    let mut shrunk = factor;
    // A correction that is not a number says nothing: take the shortest.
    shrunk.max(&C::from_f64((), SHRINKAGE.0));
    shrunk.min(&C::from_f64((), SHRINKAGE.1));
    shrunk.select(accepted, &grown);
    shrunk.mul(h);
    shrunk
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_shrink_grow_and_survive_nonsense() {
        let step = |error: f64, accepted: bool, may_grow: bool| {
            next_step::<f64>(&1.0, &error, &1e-4, &[true; 3], accepted, may_grow)
        };
        assert_eq!(step(1e-17, true, true), 2.0);
        assert_eq!(step(1e-17, true, false), 1.0);
        let same = step(2.5e-5, true, true);
        assert!((same - 0.95).abs() < 1e-12, "{same}");
        assert_eq!(step(f64::NAN, false, false), 0.1);
        assert_eq!(step(f64::INFINITY, false, false), 0.1);
    }
}
