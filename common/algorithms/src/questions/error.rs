//! Reasons why a question cannot be asked.

use crate::decomposition::ProblemError;
use crate::decomposition::operand::OperandError;

/// Reason why a question cannot be asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuestionError {
    /// The system cannot be one of components.
    #[error("{0}")]
    Problem(#[from] ProblemError),
    /// A witness set is not one of the system.
    #[error("{0}")]
    Operand(#[from] OperandError),
    /// A part of the question has a value that makes no sense.
    #[error("{field}: {found}; expected {expected}")]
    Wish {
        /// The part of the question.
        field: &'static str,
        /// Value of the part in the question.
        found: String,
        /// Values that the part may have.
        expected: String,
    },
}

impl QuestionError {
    /// A part of the question has this value instead of an expected one.
    pub(super) fn wish(
        field: &'static str,
        value: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Wish {
            field,
            found: value.into(),
            expected: expected.into(),
        }
    }
}

/// Checks that a number of the question is one of 1 to `most`.
pub(super) fn check_number(
    field: &'static str,
    number: u64,
    most: u64,
) -> Result<(), QuestionError> {
    if (1..=most).contains(&number) {
        return Ok(());
    }
    let expected = format!("1 to {most}");
    Err(QuestionError::wish(field, number.to_string(), expected))
}
