//! Results: write-once objects, and the summary of a finished job.

pub mod decomposition;
mod explained;
pub mod question;
pub mod store;
pub mod summary;

use decomposition::DecompositionSummary;
use question::QuestionSummary;
use serde::Serialize;
use summary::Summary;

/// The summary of a finished job of any kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AnySummary {
    /// Isolated solutions.
    Solve(Box<Summary>),
    /// Components.
    Decomposition(Box<DecompositionSummary>),
    /// An answer of components.
    Question(Box<QuestionSummary>),
}

impl AnySummary {
    /// Reads the JSON object of any kind: each of the other kinds has a field that tells it.
    pub fn read(json: &str) -> Result<Self, serde_json::Error> {
        let value: serde_json::Value = serde_json::from_str(json)?;
        Ok(if value.get("decomposition").is_some() {
            Self::Decomposition(serde_json::from_str(json)?)
        } else if value.get("question").is_some() {
            Self::Question(serde_json::from_str(json)?)
        } else {
            Self::Solve(serde_json::from_str(json)?)
        })
    }

    /// That of isolated solutions.
    pub fn solve(self) -> Option<Summary> {
        match self {
            Self::Solve(summary) => Some(*summary),
            Self::Decomposition(_) | Self::Question(_) => None,
        }
    }
}
