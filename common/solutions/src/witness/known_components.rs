//! KnownComponents: all components of some of the equations of a system, which others cut, or of a general member of
//! a family.

use super::witness_set::WitnessSet;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// All components of the first equations of a system. One that is missing is missing in what is made of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KnownComponents {
    /// Number of the equations that the components are of; these are the first equations.
    pub equations: u32,
    /// The components, on slices of any kind.
    pub components: Vec<WitnessSet>,
    /// Values of the parameters at which they are known, general ones, where others are asked; empty: those that are
    /// asked. They are of all equations then.
    #[serde(default)]
    pub parameters: Vec<Complex64>,
}
