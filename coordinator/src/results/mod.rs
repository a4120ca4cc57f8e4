//! Results: write-once objects, and the summary of a finished job.

pub mod decomposition;
mod explained;
pub mod store;
pub mod summary;

use decomposition::DecompositionSummary;
use serde::Serialize;
use summary::Summary;

/// The summary of a finished job of either kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AnySummary {
    /// Isolated solutions.
    Solve(Box<Summary>),
    /// Components.
    Decomposition(Box<DecompositionSummary>),
}

impl AnySummary {
    /// Reads the JSON object of either kind: only that of a decomposition has such a field.
    pub fn read(json: &str) -> Result<Self, serde_json::Error> {
        let value: serde_json::Value = serde_json::from_str(json)?;
        Ok(match value.get("decomposition") {
            Some(_) => Self::Decomposition(serde_json::from_str(json)?),
            None => Self::Solve(serde_json::from_str(json)?),
        })
    }

    /// That of isolated solutions.
    pub fn solve(self) -> Option<Summary> {
        match self {
            Self::Solve(summary) => Some(*summary),
            Self::Decomposition(_) => None,
        }
    }
}
