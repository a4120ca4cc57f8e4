//! CompletenessClaim: whether a method says that it misses no isolated solution, and why.

use cognate_solutions::completeness::Completeness;
use serde::{Deserialize, Serialize};

/// Claim of a method about its completeness.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompletenessClaim {
    /// Whether all are found.
    pub complete: Completeness,
    /// Reason of the claim, in words.
    pub reason: String,
}

impl CompletenessClaim {
    /// None is missing.
    pub fn yes(reason: String) -> Self {
        let complete = Completeness::Yes;
        Self { complete, reason }
    }

    /// Some are missing.
    pub fn no(reason: String) -> Self {
        let complete = Completeness::No;
        Self { complete, reason }
    }

    /// Some may be missing.
    pub fn not_known(reason: String) -> Self {
        let complete = Completeness::NotKnown;
        Self { complete, reason }
    }
}
