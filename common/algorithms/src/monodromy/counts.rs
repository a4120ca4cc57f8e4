//! Counts: how a set of solutions was found by monodromy, for people and for the summary.

use serde::{Deserialize, Serialize};

/// Why no more loops were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stop {
    /// As many solutions as were asked for are known.
    Count,
    /// Enough loops in a row brought nothing new.
    IdleLoops,
    /// As many paths were tracked as one solve may.
    PathLimit,
    /// No start point could be tracked to generic parameters.
    NoStart,
}

/// How far loops have come.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
}
