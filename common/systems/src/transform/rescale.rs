//! A system in other units: each variable a power of two times a new one, each equation divided by
//! a power of two, exactly and on the graph.

use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId};
use crate::helper_unknown::Helper;
use crate::scaling::{Scaling, exact_times};
use crate::system::{DegenerateSet, System};
use cognate_numeric::rational::{ComplexRational, Rational};
use foldhash::{HashMap, HashMapExt};
use std::borrow::Cow;

/// The system with variable i replaced by 2^(e_i) times variable i.
///
/// Every node is written as 2^s times a node whose constants and variables have ordinary sizes, and
/// the equations' own powers are left out: coefficients of hundreds of digits, which no double
/// holds, become such as doubles hold. The result has no scaling and no symmetry.
fn rescale(system: &System, scaling: &Scaling) -> System {
    let from = &system.expressions;
    let mut out = Expressions::new();
    let mut done: HashMap<NodeId, Scaled> = HashMap::new();
    let of_sets = system.degenerate.values().flat_map(DegenerateSet::nodes);
    let radicands = system.root_unknowns().map(|root| &root.radicand);
    let roots = system.equations.iter().chain(of_sets).chain(radicands);
    let roots: Vec<NodeId> = roots.copied().collect();
    for id in below(from, &roots) {
        let scaled_operand = |n: &NodeId| done[n];
        let scaled = match from.node(id) {
            Node::Constant(c) => {
                let exponent = binary_exponent(c).unwrap_or(0);
                let node = out.constant(exact_times(c, -exponent));
                Scaled { node, exponent }
            }
            Node::Variable(v) => Scaled {
                node: out.variable(*v),
                exponent: i64::from(scaling.exponent(*v as usize)),
            },
            Node::Parameter(p) => Scaled {
                node: out.parameter(*p),
                exponent: 0,
            },
            Node::Add(a, b) => sum(
                &mut out,
                scaled_operand(a),
                scaled_operand(b),
                Expressions::add,
            ),
            Node::Subtract(a, b) => sum(
                &mut out,
                scaled_operand(a),
                scaled_operand(b),
                Expressions::subtract,
            ),
            Node::Multiply(a, b) => Scaled {
                node: out.multiply(scaled_operand(a).node, scaled_operand(b).node),
                exponent: scaled_operand(a).exponent + scaled_operand(b).exponent,
            },
            Node::Divide(a, b) => Scaled {
                node: out.divide(scaled_operand(a).node, scaled_operand(b).node),
                exponent: scaled_operand(a).exponent - scaled_operand(b).exponent,
            },
            Node::Negate(a) => Scaled {
                node: out.negate(scaled_operand(a).node),
                exponent: scaled_operand(a).exponent,
            },
            Node::Power(a, k) => Scaled {
                node: out.power(scaled_operand(a).node, *k),
                exponent: scaled_operand(a).exponent * i64::from(*k),
            },
            // They are taken of constants, which are put back as they were.
            Node::Root(a, power) => {
                let base = times(&mut out, scaled_operand(a).node, scaled_operand(a).exponent);
                Scaled {
                    node: out.root(base, power.clone()),
                    exponent: 0,
                }
            }
            Node::Function(function, a) => {
                let argument = times(&mut out, scaled_operand(a).node, scaled_operand(a).exponent);
                Scaled {
                    node: out.function(*function, argument),
                    exponent: 0,
                }
            }
        };
        done.insert(id, scaled);
    }
    let node = |n: &NodeId| done[n].node;
    let degenerate = system.degenerate.iter().map(|(name, set)| {
        let set = match set {
            DegenerateSet::Nonzero(root) => DegenerateSet::Nonzero(node(root)),
            DegenerateSet::Equations(roots) => {
                DegenerateSet::Equations(roots.iter().map(node).collect())
            }
        };
        (name.clone(), set)
    });
    let degenerate = degenerate.collect();
    let mut helpers = system.helpers.clone();
    for helper in &mut helpers {
        if let Helper::Root(root) = helper {
            let radicand = done[&root.radicand];
            let power = i64::from(root.degree) * i64::from(scaling.exponent(root.variable));
            root.radicand = times(&mut out, radicand.node, radicand.exponent - power);
        }
    }
    System {
        helpers,
        degenerate,
        equations: system.equations.iter().map(|e| done[e].node).collect(),
        expressions: out,
        scaling: Scaling::default(),
        symmetry: Vec::new(),
        ..system.clone()
    }
}

impl System {
    /// Returns the system in the unknowns that are tracked, without a scaling; a system without a scaling is returned
    /// as it is. Equations are multiplied by powers of two; symmetries are left out.
    pub fn in_unknowns(&self) -> Cow<'_, System> {
        match self.scaling.is_none() {
            true => Cow::Borrowed(self),
            false => Cow::Owned(rescale(self, &self.scaling)),
        }
    }

    /// The other way: a system in unknowns of this scaling, in the units of the variables.
    pub fn in_variables(&self, scaling: &Scaling) -> System {
        match scaling.is_none() {
            true => self.clone(),
            false => rescale(self, &scaling.inverse()),
        }
    }
}

/// 2^exponent times a node.
#[derive(Clone, Copy)]
struct Scaled {
    node: NodeId,
    exponent: i64,
}

fn sum(
    out: &mut Expressions,
    a: Scaled,
    b: Scaled,
    combine: fn(&mut Expressions, NodeId, NodeId) -> NodeId,
) -> Scaled {
    let zero = |out: &Expressions, n: NodeId| out.as_constant(n).is_some_and(|c| c.is_zero());
    let exponent = match (zero(out, a.node), zero(out, b.node)) {
        (true, _) => b.exponent,
        (_, true) => a.exponent,
        _ => a.exponent.max(b.exponent),
    };
    let a = times(out, a.node, a.exponent - exponent);
    let b = times(out, b.node, b.exponent - exponent);
    Scaled {
        node: combine(out, a, b),
        exponent,
    }
}

/// `node * 2^exponent`, the power taken into a constant factor where there is one.
fn times(out: &mut Expressions, node: NodeId, exponent: i64) -> NodeId {
    if exponent == 0 {
        return node;
    }
    match out.node(node).clone() {
        Node::Constant(c) => out.constant(exact_times(&c, exponent)),
        Node::Negate(inner) => {
            let inner = times(out, inner, exponent);
            out.negate(inner)
        }
        Node::Multiply(a, b) if out.as_constant(a).is_some() => {
            let a = times(out, a, exponent);
            out.multiply(a, b)
        }
        _ => {
            let power = exact_times(&ComplexRational::real(1), exponent);
            let power = out.constant(power);
            out.multiply(power, node)
        }
    }
}

/// The least e with |re|, |im| < 2^(e+1), or one more; `None` for 0.
fn binary_exponent(c: &ComplexRational) -> Option<i64> {
    let part = |v: &Rational| {
        let bits = |n: &rug::Integer| i64::from(n.significant_bits());
        (*v != 0).then(|| bits(v.numer()) - bits(v.denom()))
    };
    part(&c.re).into_iter().chain(part(&c.im)).max()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::exact;
    use crate::formats::read;
    use crate::polynomial::degrees;

    #[test]
    fn equations_are_multiples_of_what_they_were() {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y; parameter p; function f, g, h; \
                    f = 1e400*(x + p)^3*y - 3*(x + I)*y^2/p + 7; g = (x - 1)^5 - x^5 + 1e-300*y; \
                    h = 2^(1/2)*x - y;\nEND;\n";
        let system = read("test", text.as_bytes()).unwrap().system;
        let scaling = Scaling {
            exponents: vec![40, -33],
        };
        let scaled = rescale(&system, &scaling);
        scaled.check().unwrap();
        assert_eq!(degrees(&scaled).unwrap(), degrees(&system).unwrap());
        let number = |k: i64| ComplexRational::new(Rational::from((k, 7)), Rational::from((1, k)));
        let (unknowns, p) = ([number(5), number(-3)], [number(2)]);
        let variables = [
            exact_times(&unknowns[0], 40),
            exact_times(&unknowns[1], -33),
        ];
        let roots = |s: &System| s.equations[..2].to_vec();
        let before = exact::values(&system.expressions, &roots(&system), &variables, &p);
        let after = exact::values(&scaled.expressions, &roots(&scaled), &unknowns, &p);
        for (before, after) in before.iter().zip(&after) {
            let ratio = before.as_ref().unwrap().divide(after.as_ref().unwrap());
            let ratio = ratio.unwrap();
            assert!(ratio.is_real());
            let exponent = binary_exponent(&ratio).unwrap();
            assert_eq!(exact_times(&ComplexRational::real(1), exponent), ratio);
        }
        // Back again, and each equation is itself up to a factor.
        let back = rescale(&scaled, &scaling.inverse());
        let restored_values = exact::values(&back.expressions, &roots(&back), &variables, &p);
        for (before, restored_value) in before.iter().zip(&restored_values) {
            let ratio = before
                .as_ref()
                .unwrap()
                .divide(restored_value.as_ref().unwrap());
            let exponent = binary_exponent(ratio.as_ref().unwrap()).unwrap();
            assert_eq!(
                Some(exact_times(&ComplexRational::real(1), exponent)),
                ratio
            );
        }
    }
}
