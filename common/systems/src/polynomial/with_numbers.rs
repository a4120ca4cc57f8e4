//! Polynomials whose coefficients need not be rational: a number such as `sqrt(2)` is a parameter of them.
//!
//! The monomials are those of an equation in which these numbers are general: terms that cancel only because of a
//! relation between the numbers, as in `sqrt(8)*x - 2*sqrt(2)*x`, are kept.

use super::Polynomial;
use crate::evaluation::values;
use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};
use foldhash::{HashMap, HashMapExt};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Numbers that are not rational, of one equation: each takes an exponent in every term.
const MOST_NUMBERS: usize = 256;

/// A number that stands for a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Number {
    /// The value of a node.
    Value(NodeId),
    /// 1 over the value of a node.
    Inverse(NodeId),
}

/// An equation multiplied out.
#[derive(Clone, Debug)]
pub struct PolynomialWithNumbers {
    /// The polynomial, in the variables, the parameters and then its numbers.
    pub polynomial: Polynomial,
    numbers: Vec<Number>,
}

impl PolynomialWithNumbers {
    /// Multiplies an expression out; `None` where that takes too much, or where a variable stands below the line.
    pub fn expand(
        expressions: &Expressions,
        root: NodeId,
        variables: usize,
        parameters: usize,
    ) -> Option<Self> {
        let nodes = below(expressions, &[root]);
        if nodes.iter().all(|&id| is_rational(expressions.node(id))) {
            let polynomial = Polynomial::expand(expressions, root, variables, parameters)?;
            return Some(Self {
                polynomial,
                numbers: Vec::new(),
            });
        }
        let mut named = Named {
            from: expressions,
            parameters,
            out: Expressions::new(),
            copies: HashMap::new(),
            numbers: Vec::new(),
        };
        for id in nodes {
            named.take(id)?;
        }
        let root = named.copy(root);
        let Named { out, numbers, .. } = named;
        if numbers.len() > MOST_NUMBERS {
            return None;
        }
        let polynomial = Polynomial::expand(&out, root, variables, parameters + numbers.len())?;
        Some(Self {
            polynomial,
            numbers,
        })
    }

    /// The coefficients of the monomials in the variables, for these values of the parameters of the expression, which
    /// stands in the same arena as when it was multiplied out.
    pub fn coefficients_at(
        &self,
        expressions: &Expressions,
        parameters: &[Complex64],
    ) -> BTreeMap<Vec<u32>, Complex64> {
        let nodes = self.numbers.iter().map(|number| match number {
            Number::Value(id) | Number::Inverse(id) => *id,
        });
        let nodes: Vec<NodeId> = nodes.collect();
        let values = values(expressions, &nodes, &[], parameters);
        let numbers = self.numbers.iter().zip(values);
        let numbers = numbers.map(|(number, value)| match number {
            Number::Value(_) => value,
            Number::Inverse(_) => value.inv(),
        });
        let parameters: Vec<Complex64> = parameters.iter().copied().chain(numbers).collect();
        self.polynomial.coefficients_at(&parameters)
    }
}

/// Whether a node of rational polynomials makes one.
fn is_rational(node: &Node) -> bool {
    !matches!(node, Node::Divide(..) | Node::Root(..) | Node::Function(..))
}

/// An expression with parameters for its numbers, while it is copied.
struct Named<'a> {
    from: &'a Expressions,
    /// Number of parameters of the expression itself.
    parameters: usize,
    out: Expressions,
    /// The copies of nodes. A number that is not rational has none: it is a parameter where it is used.
    copies: HashMap<NodeId, NodeId>,
    numbers: Vec<Number>,
}

impl Named<'_> {
    /// Copies a node, of which the parts were taken before; `None` where a variable stands below the line.
    fn take(&mut self, id: NodeId) -> Option<()> {
        let node = self.from.node(id);
        if self.from.dependence(id) != Dependence::Variables && !self.is_copied(node) {
            return Some(());
        }
        let copy = match node {
            Node::Constant(c) => self.out.constant(c.clone()),
            Node::Variable(v) => self.out.variable(*v),
            Node::Parameter(p) => self.out.parameter(*p),
            Node::Add(a, b) => {
                let (a, b) = (self.copy(*a), self.copy(*b));
                self.out.add(a, b)
            }
            Node::Subtract(a, b) => {
                let (a, b) = (self.copy(*a), self.copy(*b));
                self.out.subtract(a, b)
            }
            Node::Multiply(a, b) => {
                let (a, b) = (self.copy(*a), self.copy(*b));
                self.out.multiply(a, b)
            }
            Node::Negate(a) => {
                let a = self.copy(*a);
                self.out.negate(a)
            }
            Node::Power(a, exponent) => {
                let a = self.copy(*a);
                self.out.power(a, *exponent)
            }
            Node::Divide(a, b) if self.from.dependence(*b) != Dependence::Variables => {
                let (a, inverse) = (self.copy(*a), self.parameter(Number::Inverse(*b)));
                self.out.multiply(a, inverse)
            }
            Node::Divide(..) | Node::Root(..) | Node::Function(..) => return None,
        };
        self.copies.insert(id, copy);
        Some(())
    }

    /// Whether a node without variables is rational, as all its parts are.
    fn is_copied(&self, node: &Node) -> bool {
        let has = |id: &NodeId| self.copies.contains_key(id);
        match node {
            Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => true,
            Node::Add(a, b) | Node::Subtract(a, b) | Node::Multiply(a, b) => has(a) && has(b),
            Node::Negate(a) | Node::Power(a, _) => has(a),
            Node::Divide(..) | Node::Root(..) | Node::Function(..) => false,
        }
    }

    fn copy(&mut self, id: NodeId) -> NodeId {
        match self.copies.get(&id) {
            Some(&copy) => copy,
            None => self.parameter(Number::Value(id)),
        }
    }

    fn parameter(&mut self, number: Number) -> NodeId {
        let earlier = self.numbers.iter().position(|n| *n == number);
        let place = earlier.unwrap_or_else(|| {
            self.numbers.push(number);
            self.numbers.len() - 1
        });
        self.out.parameter((self.parameters + place) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::plain;
    use crate::polynomial::supports;
    use crate::system::System;

    fn system(text: &str) -> System {
        plain::typed("-e", text).expect("plain equations").system
    }

    fn first(text: &str) -> (System, PolynomialWithNumbers) {
        let system = system(text);
        let (n, p) = (system.variable_count(), system.parameters.len());
        let f = PolynomialWithNumbers::expand(&system.expressions, system.equations[0], n, p);
        (system, f.expect("few terms"))
    }

    #[test]
    fn numbers_keep_the_monomials() {
        let irrational = "(sqrt(2)*x + y/pi)^2 = 10^(-6.3)*x*y + 3/sqrt(7)\nx + 2*y = 1";
        let rational = "(7*x + 3*y)^2 = 5*x*y + 3\nx + 2*y = 1";
        assert_eq!(supports(&system(irrational)), supports(&system(rational)));
        assert!(supports(&system(irrational)).is_some());
    }

    #[test]
    fn coefficients_are_those_of_the_equation() {
        let (system, f) = first("(sqrt(2)*x + y/sqrt(3))^2 = sqrt(5)\nx = y");
        let coefficients = f.coefficients_at(&system.expressions, &[]);
        let expected = [
            (vec![2, 0], 2.0),
            (vec![1, 1], 2.0 * 2f64.sqrt() / 3f64.sqrt()),
            (vec![0, 2], 1.0 / 3.0),
            (vec![0, 0], -5f64.sqrt()),
        ];
        assert_eq!(coefficients.len(), expected.len());
        for (exponents, value) in expected {
            let error = (coefficients[&exponents] - value).norm_sqr();
            assert!(error < 1e-30, "{exponents:?}: {error:e}");
        }
    }

    #[test]
    fn equal_numbers_cancel() {
        let (_, f) = first("sqrt(2)*x^3 + x - sqrt(2)*x^3 = 1\nx = y");
        assert_eq!(f.polynomial.degree(), 1);
    }

    #[test]
    fn parameters_may_stand_below_the_line() {
        let text = "parameters: p\nx^2/p = 2\nx + y = 1";
        let (system, f) = first(text);
        let coefficients = f.coefficients_at(&system.expressions, &[Complex64::new(4.0, 0.0)]);
        assert_eq!(coefficients[&vec![2, 0]], Complex64::new(0.25, 0.0));
    }
}
