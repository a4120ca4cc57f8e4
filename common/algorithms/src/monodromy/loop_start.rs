//! Start of a search by loops: parameters and solutions of the system there.

use cognate_continuation::start_points::{StartPoints, StoredPoints};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Parameters and points of the start solutions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopStart {
    /// Parameters at which the start solutions solve the system.
    pub parameters: Vec<Complex64>,
    /// Start points of the stage that tracks all start solutions.
    pub points: StartPoints,
    /// Number of start solutions.
    pub count: u64,
    /// Object that the start points name; `None` if it was stored before the solve began.
    pub object: Option<Arc<StoredPoints>>,
}

impl LoopStart {
    /// A start from solutions that nobody has stored yet.
    pub(crate) fn new(parameters: Vec<Complex64>, points: StoredPoints) -> Self {
        Self {
            parameters,
            points: points.as_start(),
            count: points.len() as u64,
            object: Some(Arc::new(points)),
        }
    }

    /// Start points of some of the start solutions, ascending.
    pub(super) fn selected(&self, sources: &[u32]) -> StartPoints {
        if sources.len() as u64 == self.count {
            self.points.clone()
        } else {
            StartPoints::Selected {
                base: Box::new(self.points.clone()),
                indices: sources.iter().map(|&source| u64::from(source)).collect(),
            }
        }
    }
}
