//! Our errors to gRPC status codes, in one place.
//!
//! What is wrong with a request is said with its field; what is wrong with us
//! is logged, and the caller hears that it is not his fault.

use crate::ledger::LedgerError;
use crate::ledger::identity::IdentityError;
use cognate_continuation::start_points::Digest;
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
    /// Something named in the request is not here.
    #[error("there is no {what} {name}")]
    NotFound {
        /// What kind of thing.
        what: &'static str,
        /// Which.
        name: String,
    },
    /// The job has not ended, or not with a result.
    #[error("job {job} is {state}{reason}: it has no result")]
    NoResult {
        /// Which.
        job: String,
        /// Its state.
        state: &'static str,
        /// Why, with a colon before it, or empty.
        reason: String,
    },
    /// The ledger refused or failed.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
    /// The result store failed.
    #[error("the store of results failed: {0}")]
    Store(String),
    /// An object is not what it should be.
    #[error("object {object} is damaged: {what}")]
    Damaged {
        /// Which.
        object: Digest,
        /// What is wrong with it.
        what: String,
    },
    /// The service is stopping.
    #[error("this coordinator is stopping")]
    Stopping,
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
            Self::NotFound { .. } | Self::Ledger(LedgerError::UnknownJob(_)) => Code::NotFound,
            Self::NoResult { .. } => Code::FailedPrecondition,
            Self::Ledger(LedgerError::RequestReused(_)) => Code::AlreadyExists,
            Self::Ledger(LedgerError::TooLarge(_)) => Code::ResourceExhausted,
            Self::Ledger(LedgerError::Storage(_) | LedgerError::Closed)
            | Self::Store(_)
            | Self::Stopping => Code::Unavailable,
            Self::Damaged { .. } => Code::DataLoss,
            Self::Ledger(_) => Code::Internal,
        }
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
