//! PrepareError: why a stage cannot be prepared.

use crate::start_points::{DamagedPoints, Digest};
use cognate_numeric::counted::counted;
use cognate_systems::system::SystemError;

/// Reason why a stage cannot be prepared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PrepareError {
    /// The system is not one.
    #[error(transparent)]
    System(#[from] SystemError),
    /// Fewer equations than unknowns.
    #[error(
        "the system has {} for {}; tracking needs at least as many equations as unknowns",
        counted(*.equations, "equation"),
        counted(*.dimension, "unknown")
    )]
    Underdetermined {
        /// Number of equations.
        equations: usize,
        /// Unknowns, up to the scaling of homogeneous groups.
        dimension: usize,
    },
    /// Degrees cannot be found, or the system is not homogeneous where it says so.
    #[error("{0}")]
    Degrees(String),
    /// The start points do not fit the system.
    #[error("the start points do not fit the system: {0}")]
    StartPoints(String),
    /// Parameter values do not fit the system.
    #[error("{what}: {} for {}", counted(*.found, "value"), counted(*.expected, "parameter"))]
    Parameters {
        /// Name of the values.
        what: &'static str,
        /// Number of values that were given.
        found: usize,
        /// Number of values that the stage needs.
        expected: usize,
    },
    /// The stage has no paths.
    #[error("the stage asks for other work than tracking")]
    Work,
    /// The object with the start points is not there.
    #[error("the object {0} with the start points is missing")]
    MissingObject(Digest),
    /// No caller waits for the items any more.
    #[error("nobody waits for it any more")]
    Interrupted,
    /// The object with the start points is damaged.
    #[error(transparent)]
    Damaged(#[from] DamagedPoints),
}
