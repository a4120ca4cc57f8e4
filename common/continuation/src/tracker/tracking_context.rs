//! TrackingContext: a chart and an arithmetic, and what is handed from one to another.

use super::digits::Digits;
use super::lane::Lane;
use super::settings::Settings;
use crate::homotopies::Homotopy;
use crate::path_result::PathResult;
use crate::stage::PreparedStage;
use cognate_numeric::precision::DOUBLE;
use num_complex::Complex64;
use std::collections::VecDeque;
use std::ops::Range;

/// Tracking context where a path goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Handoff {
    /// Projective patches, with as many digits.
    Projective,
    /// The next rung of the ladder of precision.
    Up,
    /// The rung below.
    Down,
}

/// A path on its way from one tracking context to another.
#[derive(Clone, Debug)]
pub(super) struct HandedOffPath {
    pub lane: Lane,
    pub t: Complex64,
    /// The point in the chart of the next context; `None` where that chart misses it.
    pub point: Option<Vec<Digits>>,
    pub exchanges: f64,
    pub handoff: Handoff,
}

/// Paths of one tracking context that wait for a lane.
pub(super) struct Queue {
    /// Items of the stage, whose paths begin at their start points.
    pub items: Range<u64>,
    /// Paths that other contexts handed over.
    pub handed_off: VecDeque<HandedOffPath>,
}

impl Queue {
    /// Number of paths that wait.
    pub fn count(&self) -> u64 {
        self.items.end - self.items.start + self.handed_off.len() as u64
    }
}

/// Results of the paths that ended in a tracking context.
#[derive(Default)]
pub(super) struct Ended {
    /// Results with the items whose paths they are of.
    pub results: Vec<(u64, PathResult)>,
    pub handed_off: Vec<HandedOffPath>,
}

/// Shortest step on the higher rungs, as a part of the way that is left: t is a double there too.
const LEAST_STEP: f64 = 1e-15;

/// A chart and an arithmetic, and where paths may be handed to from there.
#[derive(Clone, Copy)]
pub(super) struct TrackingContext<'a> {
    pub stage: &'a PreparedStage,
    pub homotopy: &'a Homotopy,
    /// Bits of the arithmetic.
    pub bits: u32,
    /// Whether a path may go on in projective patches.
    pub projective: bool,
    /// Whether a path may go on on the next rung.
    pub up: bool,
    /// Whether a path may go on on the rung below.
    pub down: bool,
}

impl TrackingContext<'_> {
    /// The stage's settings as they are meant for this arithmetic: the endgame may go as much
    /// further in as there are more digits, and steps may be as short as doubles can tell values of
    /// t apart.
    pub fn settings(&self) -> Settings {
        let mut settings = self.stage.settings().clone();
        if self.bits > DOUBLE {
            settings.min_step = settings.min_step.min(LEAST_STEP);
        }
        let least = settings.endgame_min_radius;
        for _ in 1..(self.bits / DOUBLE).min(4) {
            settings.endgame_min_radius *= least;
        }
        settings
    }
}
