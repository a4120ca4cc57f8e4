//! Method: how witness points of all dimensions are found, before they are sifted and told apart.

use serde::{Deserialize, Serialize};

/// A way to a witness superset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// General combinations of the equations, one after the other (Hauenstein, Sommese, Wampler 2011).
    Cascade,
    /// The equations themselves, one after the other, each on the sets of those before it (Hauenstein, Wampler
    /// 2017).
    Equations,
    /// Each dimension by itself, on its slices (Sommese, Wampler 2005, section 13.2).
    Slices,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::Cascade, Self::Equations, Self::Slices];

    /// Name of the method as users type it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cascade => "cascade",
            Self::Equations => "equations",
            Self::Slices => "slices",
        }
    }
}

/// Comparison of a second method with the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verification {
    /// The second method.
    pub method: Method,
    /// Whether both methods found the same dimensions, degrees, multiplicities and counts.
    pub agrees: bool,
    /// Whether no result of the second method is in doubt.
    pub settled: bool,
}
