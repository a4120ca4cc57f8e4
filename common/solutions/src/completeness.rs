//! Whether the solutions of an answer are all isolated solutions that there are.

use serde::{Deserialize, Serialize};

/// Whether there are no more solutions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Completeness {
    /// The start bounds the solutions, and every path is accounted for.
    #[serde(rename = "yes")]
    Yes,
    /// There are other solutions, or there should be.
    #[serde(rename = "no")]
    No,
    /// It is not known whether there are other solutions.
    #[default]
    #[serde(rename = "not known")]
    NotKnown,
}

impl Completeness {
    /// Completeness of several answers together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::No, _) | (_, Self::No) => Self::No,
            (Self::NotKnown, _) | (_, Self::NotKnown) => Self::NotKnown,
            (Self::Yes, Self::Yes) => Self::Yes,
        }
    }

    /// The answer in words, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::No => "no",
            Self::NotKnown => "not known",
        }
    }
}
