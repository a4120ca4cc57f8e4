//! Completeness: whether a method says that it misses no isolated solution.

pub use cognate_solutions::completeness::Completeness as Complete;
use serde::{Deserialize, Serialize};

/// What a method knows of that, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Completeness {
    /// Whether all are found.
    pub complete: Complete,
    /// Why, in words.
    pub reason: String,
}

impl Completeness {
    /// None is missing.
    pub fn yes(reason: String) -> Self {
        let complete = Complete::Yes;
        Self { complete, reason }
    }

    /// Some may be missing.
    pub fn not_known(reason: String) -> Self {
        let complete = Complete::NotKnown;
        Self { complete, reason }
    }
}
