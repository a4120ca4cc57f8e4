//! KnownComponents: all components of some of the equations of a system, which others cut.

use super::witness_set::WitnessSet;
use serde::{Deserialize, Serialize};

/// All components of the first equations of a system. One that is missing is missing in what is made of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KnownComponents {
    /// How many of the first equations they are of.
    pub equations: u32,
    /// The components, on slices of any kind.
    pub components: Vec<WitnessSet>,
}
