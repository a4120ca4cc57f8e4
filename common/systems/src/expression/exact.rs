//! Exact: the value of an expression at a rational point, operation by operation.
//!
//! Slow and obviously right: the yardstick for readers, writers and evaluators.

use super::{Expressions, Node, NodeId};
use cognate_numeric::rational::ComplexRational;

/// The values of some nodes at a point; `None` for a value that is not
/// rational (roots, elementary functions) or does not exist (division by 0).
pub fn values(
    expressions: &Expressions,
    roots: &[NodeId],
    variables: &[ComplexRational],
    parameters: &[ComplexRational],
) -> Vec<Option<ComplexRational>> {
    let count = roots.iter().map(|r| r.0 as usize + 1).max().unwrap_or(0);
    let mut needed = vec![false; count];
    for root in roots {
        needed[root.0 as usize] = true;
    }
    for id in (0..count).rev() {
        if needed[id] {
            for child in expressions.children(NodeId(id as u32)) {
                needed[child.0 as usize] = true;
            }
        }
    }
    let mut value: Vec<Option<ComplexRational>> = vec![None; count];
    for id in 0..count {
        if !needed[id] {
            continue;
        }
        let operand = |n: &NodeId| value[n.0 as usize].as_ref();
        let both = |a: &NodeId, b: &NodeId| Some((operand(a)?, operand(b)?));
        let result = match expressions.node(NodeId(id as u32)) {
            Node::Constant(c) => Some(c.clone()),
            Node::Variable(v) => variables.get(*v as usize).cloned(),
            Node::Parameter(p) => parameters.get(*p as usize).cloned(),
            Node::Add(a, b) => both(a, b).map(|(a, b)| a.add(b)),
            Node::Subtract(a, b) => both(a, b).map(|(a, b)| a.subtract(b)),
            Node::Multiply(a, b) => both(a, b).map(|(a, b)| a.multiply(b)),
            Node::Divide(a, b) => both(a, b).and_then(|(a, b)| a.divide(b)),
            Node::Negate(a) => operand(a).map(ComplexRational::negate),
            Node::Power(a, exponent) => operand(a).map(|a| a.power(*exponent)),
            Node::Root(..) | Node::Function(..) => None,
        };
        value[id] = result;
    }
    roots.iter().map(|r| value[r.0 as usize].clone()).collect()
}

/// The value of one node at a point; see [`values`].
pub fn value(
    expressions: &Expressions,
    root: NodeId,
    variables: &[ComplexRational],
    parameters: &[ComplexRational],
) -> Option<ComplexRational> {
    values(expressions, &[root], variables, parameters)
        .pop()
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deep_graph_is_evaluated_without_recursion() {
        let mut e = Expressions::new();
        let x = e.variable(0);
        let one = e.integer(1);
        // 1 + x*(1 + x*(...)) has the value of a geometric series.
        let mut node = one;
        for _ in 0..50_000 {
            let product = e.multiply(x, node);
            node = e.add(one, product);
        }
        let at = |v: i64| value(&e, node, &[ComplexRational::real(v)], &[]).expect("rational");
        assert_eq!(at(1), ComplexRational::real(50_001));
        assert_eq!(at(-1), ComplexRational::real(1));
        let unit = value(&e, node, &[ComplexRational::i()], &[]);
        assert_eq!(unit, Some(ComplexRational::real(1)));
    }

    #[test]
    fn what_is_not_rational_has_no_value() {
        let mut e = Expressions::new();
        let two = e.integer(2);
        let root = e.root(two, (1, 2).into());
        let x = e.variable(0);
        let quotient = e.insert(Node::Divide(two, x));
        let zero = [ComplexRational::real(0)];
        assert_eq!(
            values(&e, &[root, quotient, two], &zero, &[]),
            [None, None, Some(ComplexRational::real(2)),]
        );
    }
}
