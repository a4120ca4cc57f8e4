//! The limits of a search by loops: when it ends.

use serde::{Deserialize, Serialize};

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
}

impl Default for LoopLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Most idle loops that a small set is asked for. After this number of loops, as after the number that costs 512 paths
/// or the five loops of the default, a solution stays hidden with a probability below 1e-9 if each loop permutes all
/// solutions at random.
pub const MOST_IDLE: u64 = 32;
