//! Action: one generator of a symmetry group, as it moves points.

use crate::field::{Doubles, extract, of_node};
use cognate_systems::expression::{Node, NodeId};
use cognate_systems::system::{SymmetryGenerator, System};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A generator with all that it needs, apart from the system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Variable `i` takes the value of variable `permutation[i]`.
    Permutation(Vec<usize>),
    /// Variable `i` takes the value of node `roots[i]`. Children stand before parents.
    Map {
        /// The expressions, and no other.
        nodes: Vec<Node>,
        /// One expression for each variable.
        roots: Vec<NodeId>,
    },
}

impl Action {
    /// The generator of a checked system; `None` where it has roots or functions of constants, or parameters: these
    /// maps are not supported.
    pub fn of(generator: &SymmetryGenerator, system: &System) -> Option<Self> {
        let roots = match generator {
            SymmetryGenerator::Permutation(p) => return Some(Self::Permutation(p.clone())),
            SymmetryGenerator::Map(roots) => roots,
        };
        let (nodes, roots) = extract(&system.expressions, roots);
        let refused = |node: &Node| {
            matches!(
                node,
                Node::Parameter(_) | Node::Root(..) | Node::Function(..)
            )
        };
        if nodes.iter().any(refused) {
            return None;
        }
        Some(Self::Map { nodes, roots })
    }

    /// Image of a point; `None` where the map does not exist there, or the image is not finite.
    pub fn image(&self, values: &[Complex64]) -> Option<Vec<Complex64>> {
        let image: Vec<Complex64> = match self {
            Self::Permutation(permutation) => permutation.iter().map(|&k| values[k]).collect(),
            Self::Map { nodes, roots } => {
                let mut node_values: Vec<Option<Complex64>> = Vec::with_capacity(nodes.len());
                for node in nodes {
                    let value = of_node(&Doubles, node, &node_values, values, &[])?;
                    node_values.push(Some(value));
                }
                let roots = roots.iter().map(|root| node_values[root.0 as usize]);
                roots.collect::<Option<_>>()?
            }
        };
        let finite = image.iter().all(|z| z.re.is_finite() && z.im.is_finite());
        finite.then_some(image)
    }
}
