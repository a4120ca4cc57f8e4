//! PathOutcome: why a path ended. A failed path is a value, not an error.

use serde::{Deserialize, Serialize};

/// Outcome of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PathOutcome {
    /// Reached t = 0, and Newton's method confirms a regular endpoint there.
    Regular,
    /// The endgame settled on an endpoint at which the Jacobian is singular.
    Singular,
    /// A homogenising coordinate goes to 0 like a positive power of t: the path goes to infinity.
    /// Where it ends there was not settled.
    Diverging,
    /// The endgame of the path needs more digits than this stage gives it (`Settings::max_endgame_bits`), or this stage
    /// does not run endgames.
    PutAside,
    /// The path stopped before t = 0.
    Failed(Failure),
}

/// Reason why a path was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Failure {
    /// The start point does not solve the start system.
    InvalidStartPoint,
    /// The step became too small for the arithmetic: the path needs a higher rung of precision.
    StepTooSmall,
    /// The path took more steps than the settings allow.
    TooManySteps,
    /// The endgame found no radius at which winding number and endpoint are stable.
    EndgameUnsettled,
    /// Tracking this path ended the process that tracked it, every time.
    KilledItsWorker,
}

impl Failure {
    /// All reasons, for tables of counts.
    pub const ALL: [Self; 5] = [
        Self::InvalidStartPoint,
        Self::StepTooSmall,
        Self::TooManySteps,
        Self::EndgameUnsettled,
        Self::KilledItsWorker,
    ];

    /// The reason in words, for people.
    pub fn describe(self) -> &'static str {
        match self {
            Self::InvalidStartPoint => "the start point does not solve the start system",
            Self::StepTooSmall => "the step became too small for the highest precision allowed",
            Self::TooManySteps => "more steps than the settings allow",
            Self::EndgameUnsettled => "the endgame found no stable endpoint",
            Self::KilledItsWorker => "tracking it ended the worker's process, every time",
        }
    }
}
