//! Start solutions that a client gives, and whether they fit a system.

use crate::limits::MAX_PATHS;
use crate::plan_error::PlanError;
use crate::start_kind::StartKind;
use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// Start solutions that are stored as an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GivenStart {
    /// Digest of the object.
    pub object: Digest,
    /// Number of points.
    pub count: u64,
    /// Coordinates of each point: the variables of the system, in order.
    pub dimension: usize,
}

impl GivenStart {
    /// Start from these points, which are in the object with their digest.
    pub fn of(points: &StoredPoints) -> Self {
        Self {
            object: points.digest(),
            count: points.len() as u64,
            dimension: points.dimension,
        }
    }
}

/// Checks that this number of start solutions, with this number of coordinates, can be tracked.
pub(crate) fn check_given(system: &System, start: &GivenStart) -> Result<(), PlanError> {
    if start.count == 0 {
        return Err(PlanError::EmptyStart);
    }
    if start.count > MAX_PATHS {
        return Err(PlanError::TooManyPaths {
            start: StartKind::Given,
            number: Some(start.count),
            instead: String::new(),
        });
    }
    if start.dimension != system.variables.len() {
        return Err(PlanError::StartDimension {
            found: start.dimension,
            expected: system.variables.len(),
        });
    }
    Ok(())
}
