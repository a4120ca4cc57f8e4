//! Action: one generator of a symmetry group, as it moves points.

use crate::field::{Doubles, of_node};
use cognate_systems::expression::{Node, NodeId};
use cognate_systems::system::{SymmetryGenerator, System};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// A generator with all that it needs, apart from the system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Variable `i` takes the value of variable `permutation[i]`.
    Permutation(Vec<usize>),
    /// Variable `i` takes the value of node `roots[i]`. Children stand before parents.
    Map {
        /// The expressions, and no other.
        nodes: Vec<Node>,
        /// One for each variable.
        roots: Vec<NodeId>,
    },
}

impl Action {
    /// The generator of a checked system; `None` where it has roots or functions of constants,
    /// or parameters: such maps are not followed.
    pub fn of(generator: &SymmetryGenerator, system: &System) -> Option<Self> {
        let roots = match generator {
            SymmetryGenerator::Permutation(p) => return Some(Self::Permutation(p.clone())),
            SymmetryGenerator::Map(roots) => roots,
        };
        let e = &system.expressions;
        let mut needed = vec![false; e.nodes().len()];
        for root in roots {
            needed[root.0 as usize] = true;
        }
        for id in (0..needed.len()).rev() {
            if needed[id] {
                for child in e.children(NodeId(id as u32)) {
                    needed[child.0 as usize] = true;
                }
            }
        }
        let mut places = HashMap::new();
        let mut nodes = Vec::new();
        for id in (0..needed.len()).filter(|&id| needed[id]) {
            let at = |n: &NodeId| places[n];
            let node = match e.node(NodeId(id as u32)) {
                Node::Add(a, b) => Node::Add(at(a), at(b)),
                Node::Subtract(a, b) => Node::Subtract(at(a), at(b)),
                Node::Multiply(a, b) => Node::Multiply(at(a), at(b)),
                Node::Divide(a, b) => Node::Divide(at(a), at(b)),
                Node::Negate(a) => Node::Negate(at(a)),
                Node::Power(a, exponent) => Node::Power(at(a), *exponent),
                leaf @ (Node::Constant(_) | Node::Variable(_)) => leaf.clone(),
                Node::Parameter(_) | Node::Root(..) | Node::Function(..) => return None,
            };
            places.insert(NodeId(id as u32), NodeId(nodes.len() as u32));
            nodes.push(node);
        }
        let roots = roots.iter().map(|root| places[root]).collect();
        Some(Self::Map { nodes, roots })
    }

    /// Where a point goes; `None` where the map does not exist there, or its image is not finite.
    pub fn image(&self, values: &[Complex64]) -> Option<Vec<Complex64>> {
        let image: Vec<Complex64> = match self {
            Self::Permutation(permutation) => permutation.iter().map(|&k| values[k]).collect(),
            Self::Map { nodes, roots } => {
                let mut found: Vec<Option<Complex64>> = Vec::with_capacity(nodes.len());
                for node in nodes {
                    let value = of_node(&Doubles, node, &found, values, &[])?;
                    found.push(Some(value));
                }
                let roots = roots.iter().map(|root| found[root.0 as usize]);
                roots.collect::<Option<_>>()?
            }
        };
        let finite = image.iter().all(|z| z.re.is_finite() && z.im.is_finite());
        finite.then_some(image)
    }
}
