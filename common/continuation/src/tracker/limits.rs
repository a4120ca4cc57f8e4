//! Limits: which relative sizes an arithmetic can tell.

use super::settings::Settings;
use cognate_numeric::precision::{DOUBLE, DOUBLE_DOUBLE, unit_roundoff};
use cognate_numeric::scalar::Real;

/// Newton rounds of a step on the higher rungs; in doubles two. The tangent is that of the point before
/// the last, and where the Jacobian is nearly singular, its error times the next step is the next
/// prediction's error.
pub(super) const MOST_ROUNDS: usize = 3;
/// A step is accepted when the second Newton correction is at most this part of the first.
pub(super) const CONTRACTION: f64 = 0.1;
/// An endgame that does not settle is not tried again above this many bits: what then remains
/// is not for want of digits.
pub(super) const ENDGAME_BITS: u32 = 212;
/// Steps in doubles that take as long as a step in multiple precision, for each two doubles' digits.
const MULTIPLE_PRECISION: u32 = 4;
/// A refinement is accepted when its last correction is below this: then it is noise.
const REFINED: f64 = 1e-6;

/// Relative sizes that an arithmetic can tell.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Which correction of a step decides whether it is accepted: the second or the third.
    pub decisive: usize,
    /// A last correction below this need not contract.
    pub settled: f64,
    /// A last correction below this need not contract in a refinement.
    pub refined: f64,
    /// First corrections larger than this are not noise.
    pub noise: f64,
}

impl Limits {
    /// Limits around t = 0: those of doubles, except that the bound for noise falls with the unit roundoff.
    /// Double-doubles take the other limits of doubles, because the endgame knows which noise it can bear. (At singular
    /// ends they have so much noise that a third correction decides nothing. Sheets that they mix up go up a rung,
    /// where paths with coordinates of very different sizes are told from the points that they are near.)
    pub fn around_zero(bits: u32, settings: &Settings) -> Self {
        let many = bits > DOUBLE_DOUBLE;
        Self {
            decisive: if many { MOST_ROUNDS } else { 2 },
            settled: 0.1 * settings.tolerance * if many { finer(bits).sqrt() } else { 1.0 },
            refined: REFINED,
            noise: 0.01 * settings.predictor_tolerance * finer(bits),
        }
    }

    /// On the way, a higher rung is for paths that are near one another: sizes fall with the
    /// square root of the unit roundoff, since a matrix that is nearly singular may take the other
    /// half of the digits.
    pub fn on_the_way(bits: u32, settings: &Settings) -> Self {
        let limits = Self::around_zero(bits, settings);
        let half = finer(bits).sqrt();
        Self {
            decisive: rounds(bits),
            settled: half * 0.1 * settings.tolerance,
            refined: half * limits.refined,
            ..limits
        }
    }
}

/// Newton rounds of a step.
pub(super) fn rounds(bits: u32) -> usize {
    if bits > DOUBLE { MOST_ROUNDS } else { 2 }
}

/// Number of steps in doubles that take as long as a step of this precision: numbers of more digits than two doubles
/// are tracked one at a time, by functions of a library.
pub(super) fn effort(bits: u32) -> u64 {
    match bits {
        ..=DOUBLE_DOUBLE => 1,
        _ => u64::from(MULTIPLE_PRECISION * (bits / DOUBLE_DOUBLE)),
    }
}

/// A control number with this value in every lane. A function, since a closure that is called in several places would
/// not be compiled for the instruction set of its caller.
#[inline(always)]
pub(super) fn control<R: Real>(value: f64) -> R::Control {
    R::Control::from_f64((), value)
}

/// The unit roundoff as a part of that of doubles.
fn finer(bits: u32) -> f64 {
    unit_roundoff(bits) / unit_roundoff(DOUBLE)
}
