//! Opening: a stage to open, with the points that were made for it.

use cognate_continuation::start_points::{Digest, StoredPoints};
use cognate_continuation::work::Stage;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A stage to open. The caller first stores the objects under their digests, and only then lets workers know of the
/// stage: objects are written once, so doing it again after a crash changes nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Opening {
    /// The stage.
    pub stage: Stage,
    /// System of the stage, if it differs from the system that was planned for. The caller that stores the system names
    /// it in the stage.
    pub system: Option<Arc<System>>,
    /// Points that its start points name and that nobody has yet: made from earlier results.
    /// Later stages may name them again without bringing them.
    pub objects: Vec<Arc<StoredPoints>>,
}

impl Opening {
    /// The object of this digest, where the stage brings it.
    pub fn object(&self, wanted: Digest) -> Option<Arc<StoredPoints>> {
        let matching_object = self.objects.iter().find(|points| points.digest() == wanted);
        matching_object.cloned()
    }
}

/// A stage that brings nothing: its start points are made from their index, or stored already.
impl From<Stage> for Opening {
    fn from(stage: Stage) -> Self {
        Self {
            stage,
            system: None,
            objects: Vec::new(),
        }
    }
}
