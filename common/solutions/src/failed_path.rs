//! FailedPath: a path that is not accounted for, and why.

use cognate_continuation::tracker::outcome::Failure;
use serde::{Deserialize, Serialize};

/// Reason why a path counts as failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum FailureReason {
    /// The tracker gave the path up.
    Tracking(Failure),
    /// The result of the path holds no point.
    DamagedResult,
    /// The point that the tracker took for the endpoint does not solve the system.
    NoSolution,
    /// The path ends at the regular endpoint of an earlier path, however tightly both are tracked.
    Crossing,
    /// A coordinate of the endpoint is too large for a double.
    BeyondDoubles,
}

impl FailureReason {
    /// The reason in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Tracking(failure) => failure.describe(),
            Self::DamagedResult => "its result holds no point",
            Self::NoSolution => "what was taken for its endpoint does not solve the system",
            Self::Crossing => "it ends at the regular endpoint of another path",
            Self::BeyondDoubles => {
                "a coordinate of its endpoint is beyond 1.8e308, the largest double"
            }
        }
    }
}

/// A path that was not accounted for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailedPath {
    /// Index of the path in the stage that first started it.
    pub path: u64,
    /// Reason of the failure.
    pub reason: FailureReason,
    /// |t| where the path stopped.
    pub t: f64,
}
