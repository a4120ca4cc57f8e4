//! Summaries: what a finished job is in one JSON object, field by field as the contract has it.
//!
//! A coordinator makes them of an answer and of what it knows of the job ([`about`]); clients read them.
//! [`solve`] has isolated solutions, [`decomposition`] components, [`family`] what they become at other values of parameters, [`question`] answers
//! of components, in the blocks of [`question_answer`].
#![forbid(unsafe_code)]

pub mod about;
pub mod decomposition;
mod explained;
pub mod family;
pub mod pictures;
pub mod question;
pub mod question_answer;
pub mod solve;
#[cfg(test)]
mod tests_of_answers;

use about::About;
use cognate_algorithms::Answer;
use decomposition::DecompositionSummary;
use question::QuestionSummary;
use serde::Serialize;
use solve::Summary;

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
    /// The summary of a job with this answer.
    pub fn new(answer: &Answer, about: &About) -> Self {
        match answer {
            Answer::Isolated(solutions) => Self::Solve(Box::new(Summary::new(about, solutions))),
            Answer::Decomposition(decomposition) => {
                Self::Decomposition(Box::new(DecompositionSummary::new(about, decomposition)))
            }
            Answer::Question(asked) => Self::Question(Box::new(QuestionSummary::new(about, asked))),
        }
    }

    /// The summary as one JSON object.
    pub fn to_json(&self) -> Vec<u8> {
        serde_json::to_vec_pretty(self).expect("names and numbers can be written as JSON")
    }

    /// Reads the JSON object of any kind: each of the other kinds has a field that tells it.
    pub fn read(json: &str) -> Result<Self, serde_json::Error> {
        let value: serde_json::Value = serde_json::from_str(json)?;
        Ok(if value.get("decomposition").is_some() {
            Self::Decomposition(serde_json::from_str(json)?)
        } else if value.get("question").is_some() {
            Self::Question(Box::new(QuestionSummary::read(json)?))
        } else {
            Self::Solve(serde_json::from_str(json)?)
        })
    }

    /// The summary of isolated solutions; `None` for any other.
    pub fn solve(self) -> Option<Summary> {
        match self {
            Self::Solve(summary) => Some(*summary),
            Self::Decomposition(_) | Self::Question(_) => None,
        }
    }
}
