//! Lane: what one path knows of itself between steps.

use crate::endgames::cauchy::Cauchy;

/// Where a path is in its life. The order is that of the life.
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
    /// For tables and plots.
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

    /// Phases that consist of one step of length 0.
    pub fn refines(self) -> bool {
        matches!(
            self,
            Self::Starting | Self::Arriving | Self::Settling | Self::Sampling
        )
    }
}

/// What one path knows of itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lane {
    /// Item of the stage.
    pub item: u64,
    /// Index in the stage that first started the path.
    pub origin: u64,
    pub phase: Phase,
    pub steps: u32,
    pub rejections: u32,
    pub evaluations: u32,
    pub cauchy: Cauchy,
}
