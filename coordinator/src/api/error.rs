//! Our errors to gRPC status codes, in one place.
//!
//! An error of the request is reported with the field at fault. An error of the service is logged, and the caller is
//! told that the service is at fault.

use crate::coordinator::CoordinatorError;
use crate::intake::IntakeError;
use crate::jobs::planning::PlanningError;
use crate::ledger::LedgerError;
use crate::ledger::identity::IdentityError;
use crate::results::store::StoreError;
use cognate_algorithms::plan_error::PlanError;
use cognate_protocol::error::ProtocolError;
use tonic::{Code, Status};
use tonic_types::{ErrorDetails, StatusExt};

/// Why a call was not answered.
#[derive(Debug, thiserror::Error)]
pub enum ApiError {
    /// A message is malformed.
    #[error(transparent)]
    Message(#[from] ProtocolError),
    /// A problem is not taken.
    #[error(transparent)]
    Intake(#[from] IntakeError),
    /// A name is none.
    #[error(transparent)]
    Identity(#[from] IdentityError),
    /// A client asks for what is another tenant's.
    #[error("this token is of tenant {own}, and the request is for tenant {asked}")]
    OtherTenant {
        /// The token's tenant.
        own: String,
        /// The request's tenant.
        asked: String,
    },
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

/// A code as gRPC's pages write it.
pub fn code_name(code: Code) -> &'static str {
    match code {
        Code::Ok => "OK",
        Code::Cancelled => "CANCELLED",
        Code::Unknown => "UNKNOWN",
        Code::InvalidArgument => "INVALID_ARGUMENT",
        Code::DeadlineExceeded => "DEADLINE_EXCEEDED",
        Code::NotFound => "NOT_FOUND",
        Code::AlreadyExists => "ALREADY_EXISTS",
        Code::PermissionDenied => "PERMISSION_DENIED",
        Code::ResourceExhausted => "RESOURCE_EXHAUSTED",
        Code::FailedPrecondition => "FAILED_PRECONDITION",
        Code::Aborted => "ABORTED",
        Code::OutOfRange => "OUT_OF_RANGE",
        Code::Unimplemented => "UNIMPLEMENTED",
        Code::Internal => "INTERNAL",
        Code::Unavailable => "UNAVAILABLE",
        Code::DataLoss => "DATA_LOSS",
        Code::Unauthenticated => "UNAUTHENTICATED",
    }
}

impl ApiError {
    /// The status code that says what kind of error it is.
    pub fn code(&self) -> Code {
        match self {
            Self::Message(ProtocolError::Limit { .. })
            | Self::Intake(IntakeError::Message(ProtocolError::Limit { .. })) => {
                Code::ResourceExhausted
            }
            Self::Intake(IntakeError::NotInThisVersion(_)) => Code::Unimplemented,
            Self::Message(_) | Self::Intake(_) | Self::Identity(_) => Code::InvalidArgument,
            Self::OtherTenant { .. } => Code::PermissionDenied,
            Self::Coordinator(error) => code(error),
            Self::Stopping => Code::Unavailable,
            Self::Panic(_) => Code::Internal,
        }
    }
}

impl ApiError {
    /// The field of the request that is at fault, as a path from the outermost message; `None` where it is not
    /// one field.
    fn field(&self) -> Option<String> {
        match self {
            Self::Message(error) => Some(error.field().to_owned()),
            Self::Intake(error) => error.field(),
            Self::Identity(error) => error.field().map(str::to_owned),
            Self::OtherTenant { .. } => Some("tenant".to_owned()),
            Self::Coordinator(_) | Self::Stopping | Self::Panic(_) => None,
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
        | CoordinatorError::Ledger(LedgerError::UnknownJob(_)) => Code::NotFound,
        CoordinatorError::NoResult { .. }
        | CoordinatorError::OtherAnswer { .. }
        | CoordinatorError::GoesOn { .. }
        | CoordinatorError::ForeignResults(_)
        | CoordinatorError::Store(StoreError::Foreign(_)) => Code::FailedPrecondition,
        CoordinatorError::Ledger(
            LedgerError::RequestReused(_) | LedgerError::RequestOfDeleted(_),
        ) => Code::AlreadyExists,
        CoordinatorError::Ledger(LedgerError::NameTaken(_)) => Code::PermissionDenied,
        CoordinatorError::NotPlanned(_)
        | CoordinatorError::OverLimit { .. }
        | CoordinatorError::Ledger(LedgerError::TooLarge(_)) => Code::ResourceExhausted,
        CoordinatorError::Ledger(
            LedgerError::Storage(_)
            | LedgerError::Malformed(_)
            | LedgerError::Unreachable(_)
            | LedgerError::Closed,
        )
        | CoordinatorError::Store(
            StoreError::Storage(_)
            | StoreError::Folder { .. }
            | StoreError::Bucket { .. }
            | StoreError::Away(_),
        ) => Code::Unavailable,
        CoordinatorError::Plan(_)
        | CoordinatorError::Ledger(LedgerError::Damaged(_))
        | CoordinatorError::Store(
            StoreError::Missing(_) | StoreError::Damaged { .. } | StoreError::Differs(_),
        ) => Code::DataLoss,
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
        let message = error.to_string();
        match error.field() {
            // For programs: the field by itself, as a detail.
            Some(field) => {
                let details = ErrorDetails::with_bad_request_violation(field, message.clone());
                Status::with_error_details(code, message, details)
            }
            None => Status::new(code, message),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_intake_refuses_has_the_code_of_its_kind() {
        let later = IntakeError::NotInThisVersion("precision of 9999 bits".into());
        let field = IntakeError::Field {
            field: "options.start_solutions",
            what: "too few".into(),
        };
        let text =
            cognate_systems::formats::read("a.txt", b"variable_group x; function f; f = (x;");
        let text = IntakeError::File(text.expect_err("this is no system"));
        for (error, code, named) in [
            (later, Code::Unimplemented, None),
            (
                field,
                Code::InvalidArgument,
                Some("problem.options.start_solutions"),
            ),
            (text, Code::InvalidArgument, Some("problem.text")),
        ] {
            let error = ApiError::from(error);
            assert_eq!(error.code(), code, "{error}");
            assert_eq!(error.field().as_deref(), named, "{error}");
        }
    }
}
