//! Acceptance: decides in which lanes Newton's corrections show that the step led to a point of the path.

use super::batch::Batch;
use super::corrector::Corrections;
use super::limits::{CONTRACTION, Limits, MOST_ROUNDS, control};
use super::settings::Settings;
use cognate_numeric::precision::DOUBLE;
use cognate_numeric::scalar::{Mask, Real};

/// On the higher rungs, where other paths are near, the third Newton correction is at most this part of the second:
/// while a first correction is made up of what every path has, the later ones show where between
/// two paths the prediction fell.
const CONVERGENCE: f64 = 0.01;
/// Corrections that shrink twice by a factor between these are those of Newton's method at a multiple point (a half at a
/// double one): the prediction fell nearer to it than to the path.
const LINEAR: (f64, f64) = (0.3, 0.9);
/// Largest first correction at which a start point is believed.
const START_ERROR: f64 = 1e-3;

/// Rule by which steps are accepted in one arithmetic, from the sizes of Newton's corrections.
pub(super) struct AcceptanceRule {
    pub on_the_way: Limits,
    pub around_zero: Limits,
    tolerance: f64,
    /// Whether numbers have more digits than doubles.
    fine: bool,
}

/// Lanes whose steps are accepted.
pub(super) struct Accepted<R: Real> {
    /// All lanes whose steps are accepted.
    pub all: R::Mask,
    /// Lanes whose steps are accepted and have a length.
    pub moved: R::Mask,
}

impl AcceptanceRule {
    pub fn new(bits: u32, settings: &Settings) -> Self {
        Self {
            on_the_way: Limits::on_the_way(bits, settings),
            around_zero: Limits::around_zero(bits, settings),
            tolerance: settings.tolerance,
            fine: bits > DOUBLE,
        }
    }

    /// Accepts where the corrections contract, and what is left of them is below the tolerance.
    ///
    /// `around`: the lanes whose paths are in the endgame. Which correction decides, and how small it must be, is
    /// another thing on the way than around 0; in doubles both are the same.
    #[inline(always)]
    pub fn judge<R: Real>(
        &self,
        batch: &Batch<R>,
        corrections: &Corrections<R>,
        around: R::Mask,
    ) -> Accepted<R> {
        let (way, zero) = (&self.on_the_way, &self.around_zero);
        let [first, second, third] = &corrections.relative;
        let second_decides = R::Mask::splat(zero.decisive < MOST_ROUNDS).and(around);
        let mut last = if way.decisive == MOST_ROUNDS {
            third
        } else {
            second
        }
        .clone();
        last.select(second_decides, second);

        let converging = self.converges::<R>(corrections, second_decides);
        let settled = of_phase::<R>(way.settled, zero.settled, around);
        let mut settled = last.less_equal(&settled).or(converging);
        let refined = of_phase::<R>(way.refined, zero.refined, around);
        let mut refined = last.less_equal(&refined);
        if self.fine {
            settled = settled.and(linearly(first, second, third).not());
            // A start point has the digits of doubles, however many there are here.
            refined = refined.or(converging.and(second_decides.not()));
        }
        let near = first.less_equal(&batch.limit);
        let moved = near.and(settled).and(batch.refine.not());
        let near = first.less_equal(&control::<R>(START_ERROR));
        let refined = refined.and(near).and(batch.refine);
        Accepted {
            all: moved.or(refined),
            moved,
        }
    }

    /// Lanes in which corrections fall as Newton's method does near a regular point, to below the tolerance.
    #[inline(always)]
    fn converges<R: Real>(&self, corrections: &Corrections<R>, second_decides: R::Mask) -> R::Mask {
        let [first, second, third] = &corrections.relative;
        let mut contracted = control::<R>(CONTRACTION);
        contracted.mul(first);
        let mut left = second.clone();
        left.mul(second);
        let mut allowed = control::<R>(self.tolerance);
        allowed.mul(first);
        let converging = second
            .less_equal(&contracted)
            .and(left.less_equal(&allowed));
        let mut quadratically = control::<R>(CONVERGENCE);
        quadratically.mul(second);
        let quadratically = third.less_equal(&quadratically).or(second_decides);
        let two_rounds = R::Mask::splat(self.on_the_way.decisive < MOST_ROUNDS);
        converging.and(quadratically.or(two_rounds))
    }
}

/// A number for lanes on the way and another one for lanes around 0.
#[inline(always)]
fn of_phase<R: Real>(way: f64, zero: f64, around: R::Mask) -> R::Control {
    let mut value = control::<R>(way);
    value.select(around, &control::<R>(zero));
    value
}

/// `a b`. A function, since a closure under `dispatch` cannot be inlined for certain.
#[inline(always)]
fn times<C: Real<Context = (), Control = C>>(a: &C, b: f64) -> C {
    let mut product = C::from_f64((), b);
    product.mul(a);
    product
}

/// Lanes in which three corrections converge linearly.
#[inline(always)]
fn linearly<C: Real<Context = (), Control = C>>(first: &C, second: &C, third: &C) -> C::Mask {
    let slowly = times(first, LINEAR.0).less_equal(second);
    let slowly = slowly.and(times(second, LINEAR.0).less_equal(third));
    let shrinks = second.less_equal(&times(first, LINEAR.1));
    slowly
        .and(shrinks)
        .and(third.less_equal(&times(second, LINEAR.1)))
}
