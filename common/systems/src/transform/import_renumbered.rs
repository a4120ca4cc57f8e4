//! Import renumbered: an equation of one system among the expressions of another, with other numbers of its variables.

use crate::expression::{Expressions, Node, NodeId};
use crate::system::System;
use foldhash::HashMap;

/// The copy of an equation of a system without parameters; variable v becomes the one at `place(v)`. `memory` is kept
/// between equations of one system.
///
/// # Panics
/// When the system has parameters.
pub(super) fn import_renumbered(
    to: &mut Expressions,
    (from, equation): (&System, NodeId),
    memory: &mut HashMap<NodeId, NodeId>,
    place: impl Fn(usize) -> usize,
) -> NodeId {
    to.import(
        &from.expressions,
        equation,
        memory,
        &mut |e, leaf| match leaf {
            Node::Variable(v) => {
                let place = u32::try_from(place(*v as usize));
                e.variable(place.expect("variables are counted in 32 bits"))
            }
            _ => unreachable!("a system without parameters has no other leaves"),
        },
    )
}
