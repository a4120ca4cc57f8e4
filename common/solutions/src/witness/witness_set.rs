//! WitnessSet: one component by its witness points on a general slice.

use super::evidence::Evidence;
use num_complex::Complex64;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::sync::Arc;

/// A component's name, such as `1.3`: the third of dimension 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ComponentId {
    /// Dimension of the component.
    pub dimension: u32,
    /// Number of the component among those of its dimension, from 1.
    pub number: u32,
}

impl std::fmt::Display for ComponentId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{}", self.dimension, self.number)
    }
}

/// Multiplicity of a component.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Multiplicity {
    /// Multiplicity of the scheme: dimension of the dual space of the equations and the slice at a witness point;
    /// `None` where the dual space did not close.
    pub scheme: Option<u64>,
    /// Number of paths to each witness point: multiplicity for combinations of the equations, which can be larger.
    pub tracked: u64,
    /// Dimensions of the dual space by order.
    pub dual_dimensions: Vec<u32>,
}

/// Whether a witness set is one component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Irreducible {
    /// The witness set is one component, with probability 1.
    Yes,
    /// The witness set may be several components, or a part of one.
    Unsettled,
    /// The test was not asked for.
    NotAsked,
}

/// A component, or points of one dimension that could not be told apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WitnessSet {
    /// Name of the component.
    pub id: ComponentId,
    /// Number of its witness points.
    pub degree: u64,
    /// Multiplicity of the component.
    pub multiplicity: Multiplicity,
    /// Whether the witness set is one component.
    pub irreducible: Irreducible,
    /// Rank of the Jacobian before each deflation; empty where the equations are regular.
    pub deflation: Vec<u32>,
    /// Whether complex conjugation maps it to itself; `None` where it maps no solutions to solutions, or that was
    /// not found out.
    pub self_conjugate: Option<bool>,
    /// The orbit of components of its dimension that it is in, by number; `None` where no symmetry group was named, or
    /// that was not found out.
    #[serde(default)]
    pub orbit: Option<u32>,
    /// The slice, a row for each dimension: constant first, then a coefficient for each variable. Sets of one dimension
    /// share it.
    pub slice: Arc<Vec<Vec<Complex64>>>,
    /// Values of the variables at the witness points; in files they are apart.
    #[serde(default)]
    pub points: Vec<Vec<Complex64>>,
    /// Evidence that this is one component.
    pub evidence: Evidence,
}

impl std::str::FromStr for ComponentId {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("`{text}` is no component; expected a name such as 1.3");
        let (dimension, place) = text.split_once('.').ok_or_else(expected)?;
        let number = |part: &str| part.parse::<u32>().map_err(|_| expected());
        let (dimension, number) = (number(dimension)?, number(place)?);
        Ok(Self { dimension, number })
    }
}

impl WitnessSet {
    /// Dimension of the component.
    pub fn dimension(&self) -> u32 {
        self.id.dimension
    }

    /// Whether nothing about it is in doubt.
    pub fn settled(&self) -> bool {
        self.irreducible != Irreducible::Unsettled && self.evidence.doubts.is_empty()
    }
}

/// Reads sets of which neighbours with the same slice share it, as they did before they were written.
pub fn sharing_slices<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<WitnessSet>, D::Error> {
    struct Sets;
    impl<'de> Visitor<'de> for Sets {
        type Value = Vec<WitnessSet>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("a sequence of witness sets")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut sets: A) -> Result<Self::Value, A::Error> {
            let mut read: Vec<WitnessSet> = Vec::new();
            while let Some(mut set) = sets.next_element::<WitnessSet>()? {
                if let Some(before) = read.last().filter(|before| before.slice == set.slice) {
                    set.slice = Arc::clone(&before.slice);
                }
                read.push(set);
            }
            Ok(read)
        }
    }
    from.deserialize_seq(Sets)
}
