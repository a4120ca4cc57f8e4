//! Derivatives of expressions as expressions of the same arena.
//!
//! [`gradient`] sweeps backwards from one expression to all its leaves,
//! [`directional`] forwards from all leaves in one direction. Both share every
//! subexpression with what is there, since the arena holds no node twice.

use super::{Dependence, Expressions, Node, NodeId};
use foldhash::{HashMap, HashMapExt};
use std::collections::{BTreeMap, BinaryHeap};

/// All partial derivatives of `root` with respect to leaves that it contains,
/// by leaf (a variable's or a parameter's node), by one reverse sweep.
///
/// A leaf that is missing in the map has derivative 0. `wanted` says which leaves count.
pub fn gradient(
    expressions: &mut Expressions,
    root: NodeId,
    wanted: &mut dyn FnMut(&Node) -> bool,
) -> BTreeMap<NodeId, NodeId> {
    let active = active_below(expressions, &[root], wanted);
    let mut result = BTreeMap::new();
    let mut adjoint: HashMap<NodeId, NodeId> = HashMap::new();
    // Parents have larger numbers than children, so popping the largest first
    // meets every node after all its parents.
    let mut heap = BinaryHeap::new();
    if active.contains_key(&root) {
        adjoint.insert(root, expressions.integer(1));
        heap.push(root);
    }
    while let Some(id) = heap.pop() {
        let bar = adjoint[&id];
        let mut give = |e: &mut Expressions, child: NodeId, share: NodeId| {
            if !active.contains_key(&child) {
                return;
            }
            match adjoint.get_mut(&child) {
                Some(sum) => *sum = e.add(*sum, share),
                None => {
                    adjoint.insert(child, share);
                    heap.push(child);
                }
            }
        };
        match *expressions.node(id) {
            Node::Variable(_) | Node::Parameter(_) => {
                result.insert(id, bar);
            }
            Node::Add(a, b) => {
                give(expressions, a, bar);
                give(expressions, b, bar);
            }
            Node::Subtract(a, b) => {
                give(expressions, a, bar);
                if active.contains_key(&b) {
                    let negative = expressions.negate(bar);
                    give(expressions, b, negative);
                }
            }
            Node::Negate(a) => {
                let negative = expressions.negate(bar);
                give(expressions, a, negative);
            }
            Node::Multiply(a, b) => {
                for (child, other) in [(a, b), (b, a)] {
                    if active.contains_key(&child) {
                        let share = expressions.multiply(bar, other);
                        give(expressions, child, share);
                    }
                }
            }
            Node::Divide(a, b) => {
                let share = quotient(expressions, bar, b);
                give(expressions, a, share);
                if active.contains_key(&b) {
                    let product = expressions.multiply(share, id);
                    let negative = expressions.negate(product);
                    give(expressions, b, negative);
                }
            }
            Node::Power(a, exponent) => {
                let slope = power_slope(expressions, a, exponent, bar);
                give(expressions, a, slope);
            }
            Node::Constant(_) | Node::Root(..) | Node::Function(..) => {
                unreachable!("constants contain no leaf, so they are not active")
            }
        }
    }
    result
}

/// `a / b`, where `b` may contain variables: rational maps have derivatives too.
fn quotient(e: &mut Expressions, a: NodeId, b: NodeId) -> NodeId {
    if e.dependence(b) == Dependence::Variables {
        e.insert(Node::Divide(a, b))
    } else {
        e.divide(a, b)
    }
}

/// `(exponent * factor) * a^(exponent-1)`.
fn power_slope(e: &mut Expressions, a: NodeId, exponent: u32, factor: NodeId) -> NodeId {
    let number = e.integer(i64::from(exponent));
    let scaled = e.multiply(number, factor);
    let power = e.power(a, exponent - 1);
    e.multiply(scaled, power)
}

/// Derivatives of all `roots` along one direction, by one forward sweep.
///
/// `leaf` gives the derivative of a variable or parameter, `None` for 0; so
/// does the result.
pub fn directional(
    expressions: &mut Expressions,
    roots: &[NodeId],
    leaf: &mut dyn FnMut(&mut Expressions, &Node) -> Option<NodeId>,
) -> Vec<Option<NodeId>> {
    let mut tangent: HashMap<NodeId, Option<NodeId>> = HashMap::new();
    for id in below(expressions, roots) {
        let dot = match expressions.node(id).clone() {
            Node::Constant(_) | Node::Root(..) | Node::Function(..) => None,
            node @ (Node::Variable(_) | Node::Parameter(_)) => leaf(expressions, &node),
            Node::Add(a, b) => match (tangent[&a], tangent[&b]) {
                (Some(x), Some(y)) => Some(expressions.add(x, y)),
                (x, y) => x.or(y),
            },
            Node::Subtract(a, b) => match (tangent[&a], tangent[&b]) {
                (Some(x), Some(y)) => Some(expressions.subtract(x, y)),
                (None, Some(y)) => Some(expressions.negate(y)),
                (x, None) => x,
            },
            Node::Negate(a) => tangent[&a].map(|x| expressions.negate(x)),
            Node::Multiply(a, b) => {
                let x = tangent[&a].map(|x| expressions.multiply(x, b));
                let y = tangent[&b].map(|y| expressions.multiply(a, y));
                match (x, y) {
                    (Some(x), Some(y)) => Some(expressions.add(x, y)),
                    (x, y) => x.or(y),
                }
            }
            Node::Divide(a, b) => {
                let y = tangent[&b].map(|y| expressions.multiply(id, y));
                let numerator = match (tangent[&a], y) {
                    (Some(x), Some(y)) => Some(expressions.subtract(x, y)),
                    (None, Some(y)) => Some(expressions.negate(y)),
                    (x, None) => x,
                };
                numerator.map(|n| quotient(expressions, n, b))
            }
            Node::Power(a, exponent) => {
                tangent[&a].map(|x| power_slope(expressions, a, exponent, x))
            }
        };
        let zero = dot.is_some_and(|d| expressions.as_constant(d).is_some_and(|c| c.is_zero()));
        tangent.insert(id, dot.filter(|_| !zero));
    }
    roots.iter().map(|root| tangent[root]).collect()
}

/// Every node that some root needs, children before parents.
pub fn below(expressions: &Expressions, roots: &[NodeId]) -> Vec<NodeId> {
    let mut seen: HashMap<NodeId, ()> = HashMap::new();
    let mut stack: Vec<NodeId> = roots.to_vec();
    let mut order = Vec::new();
    while let Some(id) = stack.pop() {
        if seen.insert(id, ()).is_none() {
            order.push(id);
            stack.extend(expressions.children(id));
        }
    }
    order.sort_unstable();
    order
}

/// The nodes below the roots that contain a wanted leaf.
fn active_below(
    expressions: &Expressions,
    roots: &[NodeId],
    wanted: &mut dyn FnMut(&Node) -> bool,
) -> HashMap<NodeId, ()> {
    let mut active = HashMap::new();
    for id in below(expressions, roots) {
        let is_active = match expressions.node(id) {
            node @ (Node::Variable(_) | Node::Parameter(_)) => wanted(node),
            _ if expressions.dependence(id) == Dependence::Constant => false,
            _ => expressions
                .children(id)
                .any(|child| active.contains_key(&child)),
        };
        if is_active {
            active.insert(id, ());
        }
    }
    active
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backwards_and_forwards_give_the_product_rule() {
        // d(x*y + x^3) = (y + 3x^2) dx + x dy
        let mut e = Expressions::new();
        let (x, y) = (e.variable(0), e.variable(1));
        let product = e.multiply(x, y);
        let cube = e.power(x, 3);
        let f = e.add(product, cube);
        let g = gradient(&mut e, f, &mut |n| matches!(n, Node::Variable(_)));
        assert_eq!(g[&y], x);
        let square = e.power(x, 2);
        let three = e.integer(3);
        let slope = e.multiply(three, square);
        let expected = e.add(y, slope);
        assert_eq!(g[&x], expected);
        let dot = directional(&mut e, &[f], &mut |e, n| {
            matches!(n, Node::Variable(0)).then(|| e.integer(1))
        });
        assert_eq!(dot, [Some(expected)]);
    }

    #[test]
    fn what_does_not_occur_has_no_derivative() {
        let mut e = Expressions::new();
        let (x, p) = (e.variable(0), e.parameter(0));
        let f = e.multiply(x, p);
        let g = gradient(&mut e, f, &mut |n| matches!(n, Node::Parameter(_)));
        assert_eq!(g.len(), 1);
        assert_eq!(g[&p], x);
        assert_eq!(directional(&mut e, &[f], &mut |_, _| None), [None]);
    }
}
