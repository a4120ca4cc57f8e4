//! A system with rational numbers in the place of its constants that are not rational.

use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};
use crate::straight_line_program::constant::ConstantPool;
use crate::system::{DegenerateSet, System};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::MultiplePrecision;
use foldhash::{HashMap, HashMapExt};
use rug::Integer;

/// The system with a rational number for each constant such as `10^(-6.3)`: the simplest that differs from it by at most
/// 2^-`bits` of it, parts of complex numbers by themselves. `None` where a constant depends on parameters.
///
/// Equations and denominators are changed; symmetry, helper unknowns and units stay those of the given system.
pub fn rational_constants(system: &System, bits: u32) -> Option<System> {
    let mut near = Near {
        out: system.expressions.clone(),
        from: &system.expressions,
        copies: HashMap::new(),
        pool: ConstantPool::default(),
        bits,
    };
    let equations = system.equations.iter().map(|&node| near.copy(node));
    let equations = equations.collect::<Option<_>>()?;
    let mut degenerate = system.degenerate.clone();
    for set in degenerate.values_mut() {
        let nodes: &mut [NodeId] = match set {
            DegenerateSet::Nonzero(node) => std::slice::from_mut(node),
            DegenerateSet::Equations(nodes) => nodes,
        };
        for node in nodes {
            *node = near.copy(*node)?;
        }
    }
    Some(System {
        expressions: near.out,
        equations,
        degenerate,
        ..system.clone()
    })
}

/// Expressions while they are copied.
struct Near<'a> {
    /// All nodes of the given system, and after them those that are new.
    out: Expressions,
    from: &'a Expressions,
    copies: HashMap<NodeId, NodeId>,
    pool: ConstantPool,
    bits: u32,
}

impl Near<'_> {
    fn copy(&mut self, root: NodeId) -> Option<NodeId> {
        for id in below(self.from, &[root]) {
            if self.copies.contains_key(&id) {
                continue;
            }
            let copy = match self.from.dependence(id) {
                Dependence::Constant => self.constant(id)?,
                Dependence::Parameters | Dependence::Variables => self.node(id)?,
            };
            self.copies.insert(id, copy);
        }
        self.copies.get(&root).copied()
    }

    /// A rational number near a constant.
    fn constant(&mut self, id: NodeId) -> Option<NodeId> {
        if self.from.as_constant(id).is_some() {
            return Some(id);
        }
        let constant = self.pool.describe(self.from, id);
        let number = self.pool.insert(constant);
        // The simplest number near it is sought among more digits than it needs.
        let precise = self.pool.round::<MultiplePrecision>(number, 2 * self.bits);
        let part = |part: &MultiplePrecision| Some(simplest(&part.0.to_rational()?, self.bits));
        let near = ComplexRational::new(part(&precise.re)?, part(&precise.im)?);
        Some(self.out.constant(near))
    }

    fn node(&mut self, id: NodeId) -> Option<NodeId> {
        let (from, to) = (self.from, &self.copies);
        Some(match from.node(id) {
            Node::Variable(_) | Node::Parameter(_) => id,
            Node::Add(a, b) => self.out.add(to[a], to[b]),
            Node::Subtract(a, b) => self.out.subtract(to[a], to[b]),
            Node::Multiply(a, b) => self.out.multiply(to[a], to[b]),
            Node::Negate(a) => self.out.negate(to[a]),
            Node::Power(a, exponent) => self.out.power(to[a], *exponent),
            Node::Divide(a, b) => match (to[a], to[b]) {
                (a, b) if self.out.dependence(b) == Dependence::Variables => {
                    self.out.insert(Node::Divide(a, b))
                }
                (_, b)
                    if self
                        .out
                        .as_constant(b)
                        .is_some_and(ComplexRational::is_zero) =>
                {
                    return None;
                }
                (a, b) => self.out.divide(a, b),
            },
            Node::Constant(_) | Node::Root(..) | Node::Function(..) => return None,
        })
    }
}

/// The convergent of the continued fraction of a number that is the first within 2^-`bits` of it.
fn simplest(number: &Rational, bits: u32) -> Rational {
    let tolerance = Rational::from(number.abs_ref()) >> bits;
    let (mut above, mut last) = (
        [Integer::from(1), Integer::from(0)],
        [Integer::from(0), Integer::from(1)],
    );
    let mut rest = number.clone();
    loop {
        let whole = Integer::from(rest.floor_ref());
        let next = [
            Integer::from(&whole * &above[0]) + &last[0],
            Integer::from(&whole * &above[1]) + &last[1],
        ];
        last = std::mem::replace(&mut above, next);
        let convergent = Rational::from((above[0].clone(), above[1].clone()));
        let difference = Rational::from(&convergent - number).abs();
        rest -= whole;
        if difference <= tolerance || rest == 0 {
            return convergent;
        }
        rest.recip_mut();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expression::exact;
    use crate::formats::plain;

    #[test]
    fn numbers_are_the_simplest_near_ones() {
        let number = |numerator: u64, denominator: u64| Rational::from((numerator, denominator));
        // pi to 20 digits: its convergents are 3, 22/7, 333/106, 355/113.
        let pi = Rational::from((
            "31415926535897932385".parse::<Integer>().unwrap(),
            Integer::from(Integer::u_pow_u(10, 19)),
        ));
        assert_eq!(simplest(&pi, 8), number(22, 7));
        assert_eq!(simplest(&pi, 20), number(355, 113));
        assert_eq!(simplest(&number(3, 4), 40), number(3, 4));
        assert_eq!(simplest(&-number(7, 2), 40), -number(7, 2));
        assert_eq!(simplest(&Rational::new(), 40), 0);
    }

    #[test]
    fn constants_become_rational_and_hardly_change() {
        let text = "10^(-6.3)*x + y/pi = cbrt(5)\nx/(y + sqrt(2)) = 1";
        let given = plain::typed("-e", text).expect("plain equations").system;
        let near = rational_constants(&given, 128).expect("no parameters");
        let nodes = below(&near.expressions, &near.equations);
        let is_rational = |id: &NodeId| {
            !matches!(
                near.expressions.node(*id),
                Node::Root(..) | Node::Function(..)
            )
        };
        assert!(nodes.iter().all(is_rational));
        // The constant term of the first equation is the cube root of 5.
        let zero = vec![ComplexRational::default(); 2];
        let root = exact::value(&near.expressions, near.equations[0], &zero, &[]);
        let root = root.expect("rational").re;
        let cube = Rational::from(&root * &root) * &root;
        let error = (cube.abs() - 5u32).to_f64().abs();
        assert!(error > 0.0 && error < 1e-36, "{error:e}");
    }

    #[test]
    fn roots_of_parameters_stay() {
        let text = "parameters: p\nx^2 = p/sqrt(2)\nx + y = 1";
        let given = plain::typed("-e", text).expect("plain equations").system;
        let near = rational_constants(&given, 64).expect("only a number is replaced");
        assert_eq!(near.parameters, given.parameters);
    }
}
