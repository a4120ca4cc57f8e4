//! Family: what has become of the components of a general member of a family at other values of its parameters.

use super::witness_set::ComponentId;
use serde::{Deserialize, Serialize};

/// Ends of the witness points of one component of the general member.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CarriedComponent {
    /// The component of the general member.
    pub id: ComponentId,
    /// The components that it becomes, and the number of its points that each of these gets.
    pub becomes: Vec<(ComponentId, u64)>,
    /// Points that go to infinity.
    pub at_infinity: u64,
    /// Points that lie on a set of higher dimension in the end.
    pub elsewhere: u64,
    /// Points that were lost.
    pub failed: u64,
}

/// Use of the components of a general member of a family.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Family {
    /// The dimension that was found from them; `None`: all were found anew.
    pub dimension: Option<u32>,
    /// The components of the general member in that dimension.
    pub components: Vec<CarriedComponent>,
    /// Reason why all components were found anew; empty where they were not.
    pub reason: String,
}

impl Default for CarriedComponent {
    fn default() -> Self {
        Self {
            id: ComponentId {
                dimension: 0,
                number: 0,
            },
            becomes: Vec::new(),
            at_infinity: 0,
            elsewhere: 0,
            failed: 0,
        }
    }
}

impl Family {
    /// Components of the general member whose points go to several components.
    pub fn split(&self) -> impl Iterator<Item = &CarriedComponent> {
        self.components.iter().filter(|c| c.becomes.len() > 1)
    }

    /// Components to which points of several components of the general member come.
    pub fn joined(&self) -> Vec<ComponentId> {
        let reached = self.components.iter().flat_map(|c| &c.becomes);
        let mut reached: Vec<ComponentId> = reached.map(|(id, _)| *id).collect();
        reached.sort_unstable();
        let twice = reached.windows(2).filter(|pair| pair[0] == pair[1]);
        let mut twice: Vec<ComponentId> = twice.map(|pair| pair[0]).collect();
        twice.dedup();
        twice
    }
}
