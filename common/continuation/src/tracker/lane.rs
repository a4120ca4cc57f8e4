//! Lane: what one path knows of itself between steps.

use super::digits::Digits;
use super::limits::{CONTRACTION, Limits};
use crate::endgames::cauchy::Cauchy;
use crate::path_result::BoundaryKey;
use num_complex::Complex64;

/// Phase of a path. The order is that in which paths go through the phases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Phase {
    /// No path in this lane.
    #[default]
    Idle,
    /// A step of length 0 at t = 1: the start point is refined, the first tangent found.
    Starting,
    /// On the way from t = 1 to t = 0.
    Approaching,
    /// A step of length 0 at t = 0.
    Arriving,
    /// Endgame: inward to a smaller radius, along the real axis.
    Inward,
    /// Endgame: a step of length 0 where the turns begin.
    Settling,
    /// Endgame: along a side of the polygon around t = 0.
    Turning,
    /// Endgame: a step of length 0 at a vertex.
    Sampling,
}

impl Phase {
    /// Whether the path is in the endgame around t = 0.
    #[inline(always)]
    pub fn is_around_zero(self) -> bool {
        !matches!(self, Self::Idle | Self::Starting | Self::Approaching)
    }

    /// Name of the phase, for tables and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Starting => "start",
            Self::Approaching => "approach",
            Self::Arriving => "arrival",
            Self::Inward => "inward",
            Self::Settling => "settle",
            Self::Turning => "turn",
            Self::Sampling => "sample",
        }
    }
}

/// Result of one step in one lane.
pub(super) struct Step {
    pub accepted: bool,
    /// Whether the step was accepted and ends at the lane's target.
    pub arrived: bool,
    /// Whether the step has length 0 and only refines the point.
    pub refines: bool,
    /// First Newton correction, relative to the largest coordinate.
    pub predictor_error: f64,
    pub correction: f64,
    /// The last two Newton corrections, relative.
    pub last: [f64; 2],
    /// Largest coordinate of the point that was tried.
    pub size: f64,
}

impl Step {
    /// Estimates the size c_3 of one more Newton correction by quadratic convergence, with c_1 and c_2 the last two:
    /// c_3 = c_2 (c_2 / c_1)^2.
    pub fn left(&self) -> f64 {
        let [before, last] = self.last;
        if last == 0.0 {
            return 0.0;
        }
        let ratio = last / before;
        last * ratio * ratio
    }
}

/// A path that went up a rung this many times does not go down again.
const MOST_CLIMBS: u32 = 6;

/// State of the path in one lane, apart from its point in the batch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lane {
    /// Index of the path's item in the stage.
    pub item: u64,
    /// Index of the path in the stage that first started it.
    pub origin: u64,
    /// Index of the target of the homotopy that the path goes to.
    pub target: u64,
    pub phase: Phase,
    pub steps: u32,
    pub rejections: u32,
    pub evaluations: u32,
    /// Number of steps, each counted as the steps in doubles that take the same time (see `Settings::max_steps`).
    pub effort: u64,
    /// Highest precision so far.
    pub highest_bits: u32,
    /// Number of times that the path went up a rung.
    pub climbs: u32,
    /// Bits of the arithmetic in which the path last began at its start point.
    pub began_with: u32,
    /// Accepted steps in this tracking context.
    pub steps_here: u32,
    /// Rejections since the last accepted step that only noise explains.
    pub starved: u32,
    /// Second Newton correction of the last of these rejections.
    pub last_rejected: f64,
    /// t and the point where the turns around 0 first began in this tracking context.
    pub first_turn: Option<(f64, Vec<Digits>)>,
    /// t and the point where the last turns with a firm first point began.
    pub last_turn: Option<(f64, Vec<Digits>)>,
    pub cauchy: Cauchy,
    /// t and the valuations of the homogenising coordinates there, past the boundary of the endgame.
    pub valuations: Option<(f64, Vec<Complex64>)>,
    /// Key of the path where it last passed the boundary of the endgame.
    pub boundary: Option<BoundaryKey>,
}

impl Lane {
    /// Begins a path at its start point.
    pub fn begin(&mut self, item: u64, origin: u64, target: u64) {
        (self.item, self.origin, self.target) = (item, origin, target);
        (self.steps, self.rejections, self.evaluations) = (0, 0, 0);
        self.effort = 0;
        (self.highest_bits, self.climbs, self.began_with) = (0, 0, 0);
        self.cauchy.clear();
        self.boundary = None;
    }

    /// The path begins again at its start point in this arithmetic, and goes down no more.
    pub fn begin_again(&mut self, bits: u32) {
        self.began_with = bits;
        self.climbs = MOST_CLIMBS;
        self.cauchy.forget();
        self.arrive(bits);
    }

    /// The path comes into a tracking context of this arithmetic.
    pub fn arrive(&mut self, bits: u32) {
        self.phase = Phase::Starting;
        self.highest_bits = self.highest_bits.max(bits);
        (self.steps_here, self.starved) = (0, 0);
        self.last_rejected = f64::INFINITY;
        (self.first_turn, self.last_turn) = (None, None);
        self.valuations = None;
    }

    /// Counts a step, of this many Newton rounds and this effort.
    pub(super) fn count(&mut self, step: &Step, rounds: usize, effort: u64, limits: &Limits) {
        self.evaluations += rounds as u32;
        self.effort += effort;
        if step.refines {
            return;
        }
        if step.accepted {
            self.steps += 1;
            self.steps_here += 1;
            (self.starved, self.last_rejected) = (0, f64::INFINITY);
            return;
        }
        self.rejections += 1;
        // A correction that neither Newton's method nor a shorter step makes smaller is noise.
        let stuck = step.predictor_error <= limits.noise
            && step.correction > CONTRACTION * step.predictor_error
            && step.correction > 0.3 * self.last_rejected;
        self.starved += u32::from(stuck);
        self.last_rejected = step.correction;
    }

    /// Whether the difficult place that sent the path up lies behind it: each time it was sent
    /// up again, twice as many steps must have gone well.
    pub fn may_go_down(&self) -> bool {
        const STEPS: u32 = 8;
        self.climbs < MOST_CLIMBS && self.steps_here >= STEPS << self.climbs
    }
}
