//! The limits of a search by loops: when it ends.

use super::counts::LoopCounts;
use serde::{Deserialize, Serialize};

/// Paths that idle loops may always cost.
pub(super) const IDLE_PATHS: u64 = 512;
/// How many times more idle loops are made where too few of them move a solution, or where they do not
/// permute as random ones do.
const IDLE_PATIENCE: u64 = 4;
/// Idle loops after which the search ends whatever confidence was asked for: paths are lost then.
const HOPELESS: u64 = 256;
/// Most idle loops that a small set is asked for. After this number of loops, as after the number that costs 512 paths
/// or the five loops of the default, a solution stays hidden with a probability below 1e-9 if each loop permutes all
/// solutions at random.
pub const MOST_IDLE: u64 = 32;

/// When loops end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopLimits {
    /// Loops in a row without anything new after which the set is taken for complete.
    /// HomotopyContinuation.jl takes 5. Where solutions are few, loops cost nothing, and up to
    /// [`MOST_IDLE`] are made: a random loop may well act trivially on three points.
    pub idle_loops: u32,
    /// Solutions at generic parameters, where that number is known: loops end when they are
    /// found, and go on four times longer when they are not.
    pub count: Option<u64>,
    /// Whether a trace test decides that all are found.
    pub trace_test: bool,
    /// With what probability, below 1, none should be missing if loops permute at random
    /// ([`super::estimate`]); then it is not idle loops that end the search, unless they are very many.
    pub confidence: Option<f64>,
    /// Whether loops that end without a trace test that passes have no answer: they were not asked for, and an answer
    /// that may miss solutions would look settled.
    pub only_complete: bool,
}

impl LoopLimits {
    /// Five loops in a row without anything new, and nothing else.
    pub const DEFAULT: Self = Self {
        idle_loops: 5,
        count: None,
        trace_test: false,
        confidence: None,
        only_complete: false,
    };

    /// Whether the loops that bring nothing new are enough. Loops that leave every known solution where it is are no
    /// evidence, nor are any before they permute as random ones do; where that does not come about, loops end without
    /// evidence.
    pub(super) fn are_loops_exhausted(&self, counts: &LoopCounts) -> bool {
        let needed = self.idle_loops_needed(counts.classes);
        let moved = counts.idle_moving >= needed && counts.are_mixing();
        let patience = if self.confidence.is_some() {
            1
        } else {
            IDLE_PATIENCE
        };
        let given_up = counts.idle_loops >= needed.saturating_mul(patience);
        counts.idle_loops >= needed && (moved || counts.classes == 1 || given_up)
    }

    /// Number of idle loops after which a search ends.
    pub(super) fn idle_loops_needed(&self, classes: u64) -> u64 {
        if self.confidence.is_some() {
            return HOPELESS;
        }
        let needed = u64::from(self.idle_loops).max(cheap_loops(classes));
        let patience = if self.count.is_some() { 4 } else { 1 };
        needed.saturating_mul(patience).max(1)
    }
}

impl Default for LoopLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Idle loops that cost so little that they are always made: of few solutions many loops move none.
pub(super) fn cheap_loops(classes: u64) -> u64 {
    (IDLE_PATHS / classes.max(1)).min(MOST_IDLE)
}

/// How many loops more would make the estimate as certain as this confidence, if they bring nothing new: each divides
/// the odds of one more class by their number.
pub(super) fn loops_for_confidence(confidence: f64, counts: &LoopCounts) -> u64 {
    let estimate = counts.estimate.as_ref();
    let mut doubt = 1.0 - estimate.map_or(0.0, |estimate| estimate.confidence);
    let mut loops = 0;
    while loops < 1 || (doubt > 1.0 - confidence && loops < HOPELESS) {
        doubt /= counts.classes as f64 + 1.0;
        loops += 1;
    }
    loops.max(cheap_loops(counts.classes).saturating_sub(counts.idle_loops))
}
