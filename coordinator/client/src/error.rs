//! Errors of the command line, and the exit codes that report them.

use std::path::PathBuf;

/// How a command ends, as programs see it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// Solved, and every path accounted for.
    Solved = 0,
    /// Solved, but some paths failed or a count is not settled.
    Unsettled = 1,
    /// Bad input or usage.
    BadInput = 2,
    /// The service could not be reached or gave up.
    Unavailable = 3,
    /// The job was cancelled.
    Cancelled = 4,
    /// Interrupted from the keyboard.
    Interrupted = 130,
}

impl Exit {
    /// Exit code of an answer, or of an inspection, that may be in doubt.
    pub fn of_settled(is_settled: bool) -> Self {
        match is_settled {
            true => Self::Solved,
            false => Self::Unsettled,
        }
    }
}

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// Parsed, but not there yet.
    #[error("not in this version: {what}")]
    NotInThisVersion {
        /// The option or command.
        what: String,
    },
    /// A file could not be read or written.
    #[error("{action} {path}: {source}", path = path.display())]
    File {
        /// "cannot read" or "cannot write".
        action: &'static str,
        /// Path of the file.
        path: PathBuf,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The contents of a file or the value of an option are wrong.
    #[error("{origin}: {message}")]
    Input {
        /// The file or option.
        origin: String,
        /// Place of the fault, and the input that was expected.
        message: String,
    },
    /// A family is to be solved at no values of its parameters.
    #[error(
        "{origin}: the system has parameters ({}) and no values for them: --targets gives one value of each, or many",
        .names.join(", ")
    )]
    WithoutValues {
        /// The family's file.
        origin: String,
        /// Names of the parameters.
        names: Vec<String>,
    },
    /// A file was not understood; the message names file, line and column.
    #[error("{0}")]
    Format(String),
    /// Parts of the request that do not go together.
    #[error("{0}")]
    Misfit(String),
    /// The coordinator refused the request.
    #[error("the coordinator refused: {0}")]
    Refused(String),
    /// No process listens at the address, for example because a coordinator is about to start.
    #[error(
        "no coordinator answers at {address}: {reason}\n  start one with `cognate coordinator`, or name another with --coordinator URL or COGNATE_COORDINATOR"
    )]
    Absent {
        /// Address at which a coordinator was expected.
        address: String,
        /// Message of the connection.
        reason: String,
    },
    /// No coordinator answers.
    #[error(
        "no coordinator answers at {address}: {reason}\n  start one with `cognate coordinator`, or name another with --coordinator URL or COGNATE_COORDINATOR"
    )]
    Unreachable {
        /// Address at which a coordinator was expected.
        address: String,
        /// Message of the connection.
        reason: String,
    },
    /// The coordinator answered, and failed.
    #[error("the coordinator gave up: {0}")]
    GaveUp(String),
    /// A part of `cognate solve` did not come up or died.
    #[error("{0}")]
    Local(String),
    /// Somebody stopped the job.
    #[error("the job was cancelled")]
    Cancelled,
    /// Ctrl-C.
    #[error("interrupted")]
    Interrupted,
}

impl ClientError {
    /// The exit code of this error.
    pub fn exit(&self) -> Exit {
        match self {
            Self::NotInThisVersion { .. }
            | Self::File { .. }
            | Self::Input { .. }
            | Self::WithoutValues { .. }
            | Self::Format(_)
            | Self::Misfit(_)
            | Self::Refused(_) => Exit::BadInput,
            Self::Absent { .. } | Self::Unreachable { .. } | Self::GaveUp(_) | Self::Local(_) => {
                Exit::Unavailable
            }
            Self::Cancelled => Exit::Cancelled,
            Self::Interrupted => Exit::Interrupted,
        }
    }
}
