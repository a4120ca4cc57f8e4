//! Our errors to gRPC status codes, in one place.
//!
//! What is wrong with a request is said with its field; what is wrong with us
//! is logged, and the caller hears that it is not his fault.

use crate::coordinator::CoordinatorError;
use crate::jobs::planning::PlanningError;
use crate::ledger::LedgerError;
use crate::ledger::identity::IdentityError;
use crate::results::store::StoreError;
use cognate_algorithms::plan_error::PlanError;
use cognate_protocol::error::ProtocolError;
use cognate_systems::formats::FormatError;
use tonic::{Code, Status};

/// Why a call was not answered.
#[derive(Debug, thiserror::Error)]
pub enum ApiError {
    /// A message is malformed.
    #[error(transparent)]
    Message(#[from] ProtocolError),
    /// A file that was sent is malformed.
    #[error(transparent)]
    File(#[from] FormatError),
    /// A name is none.
    #[error(transparent)]
    Identity(#[from] IdentityError),
    /// The problem cannot be solved as asked.
    #[error("{0}")]
    Problem(String),
    /// A later version will.
    #[error("not in this version: {0}")]
    NotInThisVersion(String),
    /// The coordinator did not do it.
    #[error(transparent)]
    Coordinator(#[from] CoordinatorError),
    /// The service is stopping.
    #[error("this coordinator is stopping")]
    Stopping,
    /// A bug of ours.
    #[error("the coordinator failed at this request; the request is at fault or we are: {0}")]
    Panic(String),
}

impl ApiError {
    /// The status code that says what kind of error it is.
    pub fn code(&self) -> Code {
        match self {
            Self::Message(ProtocolError::Limit { .. }) => Code::ResourceExhausted,
            Self::Message(_) | Self::File(_) | Self::Identity(_) | Self::Problem(_) => {
                Code::InvalidArgument
            }
            Self::NotInThisVersion(_) => Code::Unimplemented,
            Self::Coordinator(error) => code(error),
            Self::Stopping => Code::Unavailable,
            Self::Panic(_) => Code::Internal,
        }
    }
}

fn code(error: &CoordinatorError) -> Code {
    match error {
        CoordinatorError::Planning(PlanningError::Plan(
            PlanError::FewerEquations { .. }
            | PlanError::ConstrainedParameters(_)
            | PlanError::TooManyPaths { .. }
            | PlanError::TooManyGroups { .. },
        )) => Code::Unimplemented,
        CoordinatorError::Planning(_)
        | CoordinatorError::Problem(_)
        | CoordinatorError::Report { .. } => Code::InvalidArgument,
        CoordinatorError::UnknownStage { .. }
        | CoordinatorError::Ledger(LedgerError::UnknownJob(_))
        | CoordinatorError::Store(StoreError::Missing(_)) => Code::NotFound,
        CoordinatorError::NoResult { .. } | CoordinatorError::OtherAnswer { .. } => {
            Code::FailedPrecondition
        }
        CoordinatorError::Ledger(LedgerError::RequestReused(_)) => Code::AlreadyExists,
        CoordinatorError::NotPlanned(_) | CoordinatorError::Ledger(LedgerError::TooLarge(_)) => {
            Code::ResourceExhausted
        }
        CoordinatorError::Ledger(
            LedgerError::Storage(_) | LedgerError::Unreachable(_) | LedgerError::Closed,
        )
        | CoordinatorError::Store(
            StoreError::Storage(_) | StoreError::Folder { .. } | StoreError::Away(_),
        ) => Code::Unavailable,
        CoordinatorError::Plan(_)
        | CoordinatorError::Ledger(LedgerError::Damaged(_))
        | CoordinatorError::Store(StoreError::Damaged { .. } | StoreError::Differs(_)) => {
            Code::DataLoss
        }
        CoordinatorError::Ledger(_) => Code::Internal,
    }
}

impl From<ApiError> for Status {
    fn from(error: ApiError) -> Self {
        let code = error.code();
        match code {
            Code::Internal | Code::DataLoss => tracing::error!(%error, "a call failed"),
            Code::Unavailable => tracing::warn!(%error, "a call failed"),
            _ => tracing::debug!(%error, "a call was refused"),
        }
        Status::new(code, error.to_string())
    }
}
