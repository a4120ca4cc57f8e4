//! FamilyBlock: fate of the components of a general member of a family, field by field as in the JSON.

use cognate_solutions::witness::{CarriedComponent, Family};
use serde::{Deserialize, Serialize};

/// Use of the components of a general member of a family.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FamilyBlock {
    /// Dimension that was found from the components of the general member; `null`: all were found anew.
    pub dimension: Option<u32>,
    /// Reason why all components were found anew; empty if they were not.
    pub reason: String,
    /// The components of the general member in that dimension.
    pub components: Vec<CarriedBlock>,
    /// Names of components whose points come to several components.
    pub split: Vec<String>,
    /// Names of components to which points of several components of the general member come.
    pub joined: Vec<String>,
}

/// Ends of the witness points of one component of the general member.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CarriedBlock {
    /// The component of the general member.
    pub id: String,
    /// The components that it becomes.
    pub becomes: Vec<BecomesBlock>,
    /// Points that go to infinity.
    pub at_infinity: u64,
    /// Points that come to a set of higher dimension.
    pub elsewhere: u64,
    /// Points that were lost.
    pub failed: u64,
}

/// A component to which witness points came.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BecomesBlock {
    /// Name of the component.
    pub id: String,
    /// Number of witness points that came to the component.
    pub points: u64,
}

impl FamilyBlock {
    /// The block as JSON has it.
    pub fn new(family: &Family) -> Self {
        let block = |c: &CarriedComponent| CarriedBlock {
            id: c.id.to_string(),
            becomes: c
                .becomes
                .iter()
                .map(|(id, points)| BecomesBlock {
                    id: id.to_string(),
                    points: *points,
                })
                .collect(),
            at_infinity: c.at_infinity,
            elsewhere: c.elsewhere,
            failed: c.failed,
        };
        Self {
            dimension: family.dimension,
            reason: family.reason.clone(),
            components: family.components.iter().map(block).collect(),
            split: family.split().map(|c| c.id.to_string()).collect(),
            joined: family.joined().iter().map(ToString::to_string).collect(),
        }
    }
}
