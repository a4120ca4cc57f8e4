//! Phase: where a stage and its repetitions stand.

use cognate_continuation::start_points::StoredPoints;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Next step of a stage and its repetitions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Phase {
    /// The first stage is to be opened, with the points that it brings.
    Begins(Vec<Arc<StoredPoints>>),
    /// The results of an open stage are awaited.
    Waits,
    /// These paths, which were put aside, are to be followed to their ends, ascending.
    Follows(Vec<u64>),
    /// These paths are to be tracked again, ascending.
    Repeats(Vec<u64>),
    /// Singular points are to be asked whether they are isolated.
    Asks,
    /// Nothing.
    Done,
}
