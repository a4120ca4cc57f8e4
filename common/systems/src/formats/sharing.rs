//! Sharing: which subexpressions of a system are written as definitions of their own.
//!
//! A subexpression gets a definition if it is used more than once and is not short, or if it stands in too many
//! brackets. So the text grows with the graph and not with the tree.

use super::limits;
use crate::expression::display::{Display, Style};
use crate::expression::{Expressions, NodeId};
use crate::system::{SymmetryGenerator, System};
use std::collections::{HashMap, HashSet};

/// Reason why a system cannot be written in a notation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WriteError {
    /// A name has another meaning in the notation.
    #[error("the name `{name}` cannot be written in {format} notation: it is {meaning} there")]
    ReservedName {
        /// The name.
        name: String,
        /// The notation.
        format: super::Format,
        /// Meaning of the name in the notation.
        meaning: &'static str,
    },
    /// The notation has no words for something.
    #[error("{format} notation has no {what}")]
    Inexpressible {
        /// The notation.
        format: super::Format,
        /// The feature that the notation lacks.
        what: &'static str,
    },
    /// Without definitions of its own the text would be too long.
    #[error("the system is too large for {0} notation, which has no definitions")]
    TooLarge(super::Format),
}

/// Operands of a shared subexpression that is worth a name.
const WORTH_A_NAME: u64 = 8;
/// Brackets within brackets before a name is made.
const BRACKETS: u64 = 100;

/// All expressions that a system is made of.
pub(crate) fn roots(system: &System, equations_only: bool) -> Vec<NodeId> {
    let mut roots = system.equations.clone();
    if !equations_only {
        for set in system.degenerate.values() {
            roots.extend(set.nodes());
        }
        for generator in &system.symmetry {
            if let SymmetryGenerator::Map(map) = generator {
                roots.extend(map);
            }
        }
    }
    roots
}

/// Names for shared subexpressions, children before parents.
pub(crate) struct Sharing {
    /// The nodes in the order of their definitions.
    pub order: Vec<NodeId>,
    /// Names of these nodes.
    pub names: HashMap<NodeId, String>,
}

/// Chooses what is shared below `roots`; `taken` are names that are used already.
pub(crate) fn share(
    system: &System,
    style: Style,
    roots: &[NodeId],
    mut taken: HashSet<String>,
    may_share: &dyn Fn(NodeId) -> bool,
) -> Sharing {
    let expressions = &system.expressions;
    let uses = uses(expressions, roots);
    let mut sharing = Sharing {
        order: Vec::new(),
        names: HashMap::new(),
    };
    let mut size = vec![0u64; uses.len()];
    let mut depth = vec![0u64; uses.len()];
    let mut number = 0;
    for id in 0..uses.len() {
        let node = NodeId(id as u32);
        if uses[id] == 0 {
            continue;
        }
        let display = display(system, style, &sharing.names);
        let operands = display.bracketed(node);
        size[id] = 1;
        for (child, bracket) in operands.into_iter().flatten() {
            size[id] = size[id].saturating_add(size[child.0 as usize]);
            depth[id] = depth[id].max(depth[child.0 as usize] + u64::from(bracket));
        }
        let inner = expressions.children(node).next().is_some();
        let wanted = uses[id] > 1 && size[id] > WORTH_A_NAME || depth[id] > BRACKETS;
        if inner && wanted && may_share(node) {
            let name = loop {
                number += 1;
                let name = format!("s{number}");
                if taken.insert(name.clone()) {
                    break name;
                }
            };
            sharing.order.push(node);
            sharing.names.insert(node, name);
            (size[id], depth[id]) = (1, 0);
        }
    }
    sharing
}

/// Whether the equations can be written without definitions.
pub(crate) fn fits_unshared(system: &System, style: Style) -> bool {
    let uses = uses(&system.expressions, &system.equations);
    let names = HashMap::new();
    let display = display(system, style, &names);
    let mut size = vec![1u64; uses.len()];
    let mut depth = vec![0u64; uses.len()];
    for id in (0..uses.len()).filter(|&id| uses[id] > 0) {
        for (child, bracket) in display.bracketed(NodeId(id as u32)).into_iter().flatten() {
            size[id] = size[id].saturating_add(size[child.0 as usize]);
            depth[id] = depth[id].max(depth[child.0 as usize] + u64::from(bracket));
        }
    }
    let total = system
        .equations
        .iter()
        .map(|e| size[e.0 as usize])
        .fold(0, u64::saturating_add);
    // A step has a few bytes; half of the limit leaves room for constants in brackets.
    total < limits::OPERATIONS.value / 8
        && system
            .equations
            .iter()
            .all(|e| depth[e.0 as usize] < limits::NESTING.value / 4)
}

pub(crate) fn display<'a>(
    system: &'a System,
    style: Style,
    shared: &'a HashMap<NodeId, String>,
) -> Display<'a> {
    Display {
        expressions: &system.expressions,
        variables: &system.variables,
        parameters: &system.parameters,
        shared,
        style,
    }
}

/// Counts how often each node is used below the roots; a root counts as a use.
fn uses(expressions: &Expressions, roots: &[NodeId]) -> Vec<u32> {
    let count = roots.iter().map(|r| r.0 as usize + 1).max().unwrap_or(0);
    let mut uses = vec![0u32; count];
    for root in roots {
        uses[root.0 as usize] += 1;
    }
    for id in (0..count).rev() {
        if uses[id] > 0 {
            for child in expressions.children(NodeId(id as u32)) {
                uses[child.0 as usize] = uses[child.0 as usize].saturating_add(1);
            }
        }
    }
    uses
}
