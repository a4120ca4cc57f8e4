//! Values, Jacobian and derivative along the parameters' direction, as expressions of one arena.
//!
//! The derivatives are symbolic, so that everything that they share with the
//! values and with each other is computed once. Which sweep is cheaper depends
//! on the system: the stages of the program are made for each and counted.

use crate::expression::differentiate::{directional, gradient};
use crate::expression::{Expressions, Node, NodeId};

/// Direction in which derivatives are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// From each equation back to its leaves.
    Reverse,
    /// From the leaves to all equations, one direction at a time.
    Forward,
}

/// The entries of [J | H | H_t], row after row, as expressions.
pub(crate) struct Linearization {
    /// Parameters from `parameters` on are directions.
    pub arena: Expressions,
    /// `equations * (variables + 2)` nodes.
    pub entries: Vec<NodeId>,
}

/// Differentiates the equations; `jacobian` and `along_path` choose the sweeps.
pub(crate) fn linearization(
    expressions: &Expressions,
    equations: &[NodeId],
    variables: usize,
    parameters: usize,
    jacobian: Sweep,
    along_path: Sweep,
) -> Linearization {
    let mut arena = expressions.clone();
    let values = equations;
    let zero = arena.integer(0);
    let columns = variables + 2;
    let mut entries = vec![zero; values.len() * columns];
    for (i, &value) in values.iter().enumerate() {
        entries[i * columns + variables] = value;
    }
    let direction =
        |e: &mut Expressions, p: u32| e.parameter(p + u32::try_from(parameters).expect("few"));
    for (i, &value) in values.iter().enumerate() {
        if jacobian == Sweep::Forward && along_path == Sweep::Forward {
            break;
        }
        let partial = gradient(&mut arena, value, &mut |leaf| match leaf {
            Node::Variable(_) => jacobian == Sweep::Reverse,
            _ => along_path == Sweep::Reverse,
        });
        let mut sum = zero;
        for (leaf, derivative) in partial {
            match *arena.node(leaf) {
                Node::Variable(v) => entries[i * columns + v as usize] = derivative,
                Node::Parameter(p) => {
                    let dot = direction(&mut arena, p);
                    let term = arena.multiply(derivative, dot);
                    sum = arena.add(sum, term);
                }
                _ => unreachable!("only leaves have partial derivatives"),
            }
        }
        entries[i * columns + variables + 1] = sum;
    }
    if jacobian == Sweep::Forward {
        for v in 0..variables {
            let column = directional(&mut arena, values, &mut |e, leaf| {
                (*leaf == Node::Variable(v as u32)).then(|| e.integer(1))
            });
            for (i, entry) in column.into_iter().enumerate() {
                entries[i * columns + v] = entry.unwrap_or(zero);
            }
        }
    }
    if along_path == Sweep::Forward {
        let column = directional(&mut arena, values, &mut |e, leaf| match *leaf {
            Node::Parameter(p) => Some(direction(e, p)),
            _ => None,
        });
        for (i, entry) in column.into_iter().enumerate() {
            entries[i * columns + variables + 1] = entry.unwrap_or(zero);
        }
    }
    Linearization { arena, entries }
}
