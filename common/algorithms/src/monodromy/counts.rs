//! Counts: how a set of solutions was found by monodromy, for people and for the summary.

use super::estimate::Estimate;
use serde::{Deserialize, Serialize};

/// Why no more loops were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stop {
    /// As many solutions as were asked for are known.
    Count,
    /// Enough loops in a row brought nothing new.
    IdleLoops,
    /// A trace test says that none is missing.
    TraceTest,
    /// If loops permute at random, none is missing with the probability that was asked for.
    Confidence,
    /// As many paths were tracked as one solve may.
    PathLimit,
    /// No start point could be tracked to generic parameters.
    NoStart,
}

/// What moves in a trace test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TraceForm {
    /// Linear equations whose coefficients the parameters are.
    Slices,
    /// Bilinear sections of the curve that the family has over a line of its parameters.
    Sections,
}

/// What a trace test found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceCounts {
    /// What moved.
    pub form: TraceForm,
    /// Points whose sum was followed.
    pub points: u64,
    /// How far the sum was off a line, in parts of the sum of moduli; `None` where a point was lost
    /// on the way.
    pub deviation: Option<f64>,
    /// Whether the solutions are all that can be reached from one of them by loops.
    pub complete: bool,
}

/// How far loops have come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoopCounts {
    /// Independent loops in the space of parameters.
    pub loops: u64,
    /// Loops since the last that brought something new.
    pub idle_loops: u64,
    /// Paths tracked along legs of loops; repetitions counted.
    pub tracked: u64,
    /// Paths that reached no regular solution, however tightly they were tracked.
    pub lost: u64,
    /// Meetings of two paths of one leg at one solution: one of them had jumped.
    pub crossings_found: u64,
    /// ... of which came apart when they were tracked again.
    pub crossings_resolved: u64,
    /// Orbits of solutions known; solutions where there is no symmetry.
    pub classes: u64,
    /// Elements of the symmetry group.
    pub group_order: u64,
    /// Solutions known at generic parameters.
    pub solutions: u64,
    /// Why no more loops were made; `None` while they are.
    pub stop: Option<Stop>,
    /// The last trace test; `None` where none was asked for or came to an end.
    #[serde(default)]
    pub trace_test: Option<TraceCounts>,
    /// How many classes there are by what was met again; `None` before the first loop.
    #[serde(default)]
    pub estimate: Option<Estimate>,
}
