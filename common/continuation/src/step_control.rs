//! Step control: from the observed correction to the next step length.
//!
//! The first Newton correction measures the predictor's error e; with local
//! order q the error of a step h scales as h^q, so the step that would have
//! met the target is h (target/e)^(1/q). The target is also one from which Newton's
//! method converges: where the second correction c is K e^2, what is left after it is
//! K^2 e^3 (Deuflhard, Newton Methods for Nonlinear Problems, 2004, section 5.1). Roots
//! are taken as chains of square roots, which are correctly rounded: nothing from libm
//! decides a step.

use crate::predictor::hermite::{POINTS, at_least};
use cognate_numeric::scalar::{Mask, Real};

/// The error aimed at, as a part of the largest that is accepted.
const AIM: f64 = 0.25;
/// Longest growth of an accepted step, and shortest.
const GROWTH: (f64, f64) = (0.3, 2.0);
/// Largest and smallest shrinkage of a rejected step.
const SHRINKAGE: (f64, f64) = (0.1, 0.5);

/// The largest first Newton correction from which two corrections leave no more than `tolerance`, and at most `limit`.
///
/// `first`, `second`: the corrections of this step; a second one below `noise` says nothing of convergence.
#[inline(always)]
pub fn largest_error<C: Real<Context = (), Control = C>>(
    first: &C,
    second: &C,
    limit: &C,
    tolerance: &C,
    noise: &C,
) -> C {
    // (tolerance e / c^2)^(1/3), about: 1/4 + 1/16.
    let mut largest = tolerance.clone();
    largest.mul(first);
    let mut square = second.clone();
    square.mul(second);
    square.max(&C::from_f64((), 1e-60));
    largest.div(&square);
    largest.sqrt();
    largest.sqrt();
    let mut sixteenth = largest.clone();
    sixteenth.sqrt();
    sixteenth.sqrt();
    largest.mul(&sixteenth);
    largest.mul(first);
    largest.min(limit);
    largest.select(second.less_equal(noise), limit);
    largest
}

/// `h` for the next step. `error` is the size of the first Newton correction, `limit` the largest accepted.
///
/// `history[k]`: whether the predictor could use point k + 1; `may_grow` is false after a rejection.
#[inline(always)]
pub fn next_step<C: Real<Context = (), Control = C>>(
    h: &C,
    error: &C,
    limit: &C,
    history: &[C::Mask; POINTS - 1],
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
    for (enough, root) in at_least(history).iter().zip([&quarter, &sixth, &eighth]) {
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

    #[test]
    fn predictions_stay_where_newton_converges() {
        let largest =
            |first: f64, second: f64| largest_error::<f64>(&first, &second, &1e-4, &1e-10, &1e-11);
        // Far from every singularity, and where only noise is left.
        assert_eq!(largest(2e-5, 1e-14), 1e-4);
        assert_eq!(largest(1e-11, 1e-11), 1e-4);
        // c = 5e4 e^2: below e = 3.4e-7 two corrections leave 1e-10.
        for first in [1e-7, 3e-7, 1e-6] {
            let ratio = largest(first, 5e4 * first * first) / 3.4e-7;
            assert!((0.7..1.4).contains(&ratio), "{first}: {ratio}");
        }
    }
}
