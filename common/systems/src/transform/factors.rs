//! Factors: what an equation that is written as a product is a product of.

use crate::expression::{Dependence, Expressions, Node, NodeId};
use std::collections::BTreeMap;

/// The different factors of a product that depend on variables, each with its exponent, in the order of their
/// nodes. An equation that is no product is its only factor. Nothing is expanded or divided: factors are those
/// that are written down.
pub fn factors(expressions: &Expressions, equation: NodeId) -> Vec<(NodeId, u32)> {
    let mut exponents: BTreeMap<NodeId, u32> = BTreeMap::new();
    let mut open = vec![(equation, 1u32)];
    while let Some((node, exponent)) = open.pop() {
        match expressions.node(node) {
            Node::Multiply(a, b) => open.extend([(*a, exponent), (*b, exponent)]),
            Node::Divide(a, _) | Node::Negate(a) => open.push((*a, exponent)),
            Node::Power(a, k) => open.push((*a, exponent.saturating_mul(*k))),
            _ if expressions.dependence(node) == Dependence::Variables => {
                let total_exponent = exponents.entry(node).or_default();
                *total_exponent = total_exponent.saturating_add(exponent);
            }
            _ => {}
        }
    }
    exponents.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_that_are_written() {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y; function f, g;\
                     f = -3*(x - 1)^2*(x + y)*(x - 1)/2; g = x^2 - y;\nEND;\n";
        let problem = crate::formats::read("test", text);
        let system = problem.expect("a problem of this test").system;
        let equation_factors = |k: usize| factors(&system.expressions, system.equations[k]);
        let exponents =
            |k: usize| -> Vec<u32> { equation_factors(k).into_iter().map(|(_, e)| e).collect() };
        let mut first = exponents(0);
        first.sort_unstable();
        assert_eq!(first, [1, 3]);
        assert_eq!(equation_factors(1), [(system.equations[1], 1)]);
    }
}
