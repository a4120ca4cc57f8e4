//! Laurent systems: equations with monomials in denominators, multiplied out.
//!
//! An equation is multiplied by the least monomial that makes it a polynomial. Where a variable of
//! that monomial is 0 the given equation has no value, so that a point there is no solution of it:
//! such points are a degenerate set by name.

use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};
use crate::polynomial::Polynomial;
use crate::system::{DegenerateSet, System};
use std::collections::HashMap;

/// The name of the set of points where a denominator of the given equations is 0.
pub const ZERO_DENOMINATOR: &str = "a denominator is 0";

/// Multiplies every equation by the monomial that it is divided by.
///
/// What cannot be cleared so, because a denominator is no monomial of variables, stays as it is.
pub fn clear_denominators(system: &mut System) {
    let polynomial = system.polynomial_nodes();
    let n = system.variables.len();
    let mut nonzero = vec![false; n];
    let mut fractions = HashMap::new();
    for i in 0..system.equations.len() {
        let equation = system.equations[i];
        if polynomial[equation.0 as usize] {
            continue;
        }
        let out = &mut system.expressions;
        let Some((numerator, divisor)) = fraction(out, equation, n, &mut fractions) else {
            continue;
        };
        let parameters = system.parameters.len();
        let (numerator, divisor) = reduced(out, numerator, divisor, parameters);
        system.equations[i] = numerator;
        for (nonzero, exponent) in nonzero.iter_mut().zip(divisor) {
            *nonzero |= exponent > 0;
        }
    }
    if nonzero.contains(&true) && !system.degenerate.contains_key(ZERO_DENOMINATOR) {
        let out = &mut system.expressions;
        let divisors: Vec<u32> = nonzero.into_iter().map(u32::from).collect();
        let one = out.integer(1);
        let product = times(out, one, &divisors);
        let set = DegenerateSet::Nonzero(product);
        system.degenerate.insert(ZERO_DENOMINATOR.into(), set);
    }
}

/// For each variable, whether it stands in a denominator of the equations that were given.
pub fn nonzero_variables(system: &System) -> Vec<bool> {
    let mut nonzero = vec![false; system.variables.len()];
    if let Some(DegenerateSet::Nonzero(product)) = system.degenerate.get(ZERO_DENOMINATOR) {
        for id in below(&system.expressions, &[*product]) {
            if let Node::Variable(v) = system.expressions.node(id) {
                nonzero[*v as usize] = true;
            }
        }
    }
    nonzero
}

/// Whether a node is a monomial of variables with a coefficient that contains none.
pub(crate) fn is_monomial(expressions: &Expressions, root: NodeId) -> bool {
    let mut monomial: HashMap<NodeId, bool> = HashMap::new();
    for id in below(expressions, &[root]) {
        let here = match expressions.node(id) {
            _ if expressions.dependence(id) != Dependence::Variables => true,
            Node::Variable(_) => true,
            Node::Multiply(a, b) | Node::Divide(a, b) => monomial[a] && monomial[b],
            Node::Negate(a) | Node::Power(a, _) => monomial[a],
            _ => false,
        };
        monomial.insert(id, here);
    }
    monomial[&root]
}

/// A polynomial and the exponents of the monomial below it.
type Fraction = (NodeId, Vec<u32>);

fn times(out: &mut Expressions, node: NodeId, exponents: &[u32]) -> NodeId {
    let mut product = node;
    for (v, &exponent) in (0u32..).zip(exponents) {
        if exponent > 0 {
            let x = out.variable(v);
            let power = out.power(x, exponent);
            product = out.multiply(product, power);
        }
    }
    product
}

fn plus(a: &[u32], b: &[u32]) -> Option<Vec<u32>> {
    a.iter().zip(b).map(|(a, b)| a.checked_add(*b)).collect()
}

/// What a node is as a fraction; `None` where a denominator is no monomial.
fn fraction(
    out: &mut Expressions,
    root: NodeId,
    n: usize,
    done: &mut HashMap<NodeId, Fraction>,
) -> Option<Fraction> {
    for id in below(out, &[root]) {
        if done.contains_key(&id) {
            continue;
        }
        let found = match out.node(id).clone() {
            Node::Add(a, b) => joined(out, &done[&a], &done[&b], Expressions::add),
            Node::Subtract(a, b) => joined(out, &done[&a], &done[&b], Expressions::subtract),
            Node::Multiply(a, b) => {
                let ((a, under_a), (b, under_b)) = (&done[&a], &done[&b]);
                (out.multiply(*a, *b), plus(under_a, under_b)?)
            }
            Node::Divide(a, b) => {
                let ((a, under_a), (b, under_b)) = (&done[&a], &done[&b]);
                let (coefficient, exponents) = monomial(out, *b, n)?;
                let numerator = times(out, *a, under_b);
                let numerator = out.divide(numerator, coefficient);
                (numerator, plus(under_a, &exponents)?)
            }
            Node::Negate(a) => {
                let (a, under) = &done[&a];
                (out.negate(*a), under.clone())
            }
            Node::Power(a, k) => {
                let (a, under) = &done[&a];
                let under = under.iter().map(|e| e.checked_mul(k));
                (out.power(*a, k), under.collect::<Option<_>>()?)
            }
            Node::Constant(_)
            | Node::Variable(_)
            | Node::Parameter(_)
            | Node::Root(..)
            | Node::Function(..) => (id, vec![0; n]),
        };
        done.insert(id, found);
    }
    done.get(&root).cloned()
}

/// Two fractions over their common monomial.
fn joined(
    out: &mut Expressions,
    (a, under_a): &Fraction,
    (b, under_b): &Fraction,
    join: impl Fn(&mut Expressions, NodeId, NodeId) -> NodeId,
) -> Fraction {
    let common: Vec<u32> = under_a
        .iter()
        .zip(under_b)
        .map(|(a, b)| *a.max(b))
        .collect();
    let lacks = |under: &[u32]| -> Vec<u32> {
        common
            .iter()
            .zip(under)
            .map(|(all, own)| all - own)
            .collect()
    };
    let a = times(out, *a, &lacks(under_a));
    let b = times(out, *b, &lacks(under_b));
    (join(out, a, b), common)
}

/// The coefficient and the exponents of a monomial.
fn monomial(out: &mut Expressions, root: NodeId, n: usize) -> Option<(NodeId, Vec<u32>)> {
    let mut done: HashMap<NodeId, (NodeId, Vec<u32>)> = HashMap::new();
    for id in below(out, &[root]) {
        let found = match out.node(id).clone() {
            _ if out.dependence(id) != Dependence::Variables => (id, vec![0; n]),
            Node::Variable(v) => {
                let mut exponents = vec![0; n];
                exponents[v as usize] = 1;
                (out.integer(1), exponents)
            }
            Node::Multiply(a, b) => {
                let ((a, of_a), (b, of_b)) = (&done[&a], &done[&b]);
                (out.multiply(*a, *b), plus(of_a, of_b)?)
            }
            Node::Divide(a, b) if out.dependence(b) != Dependence::Variables => {
                let (a, of_a) = &done[&a];
                (out.divide(*a, b), of_a.clone())
            }
            Node::Negate(a) => {
                let (a, of_a) = &done[&a];
                (out.negate(*a), of_a.clone())
            }
            Node::Power(a, k) => {
                let (a, of_a) = &done[&a];
                let exponents = of_a.iter().map(|e| e.checked_mul(k));
                (out.power(*a, k), exponents.collect::<Option<_>>()?)
            }
            _ => return None,
        };
        done.insert(id, found);
    }
    done.remove(&root)
}

/// The fraction without what all terms of the numerator have in common with its monomial.
fn reduced(
    out: &mut Expressions,
    numerator: NodeId,
    divisor: Vec<u32>,
    parameters: usize,
) -> Fraction {
    let n = divisor.len();
    let Some(f) = Polynomial::expand(out, numerator, n, parameters) else {
        return (numerator, divisor);
    };
    let least = |v: usize| f.terms.keys().map(|e| e[v]).min().unwrap_or(0);
    let common: Vec<u32> = (0..n).map(|v| divisor[v].min(least(v))).collect();
    if f.terms.is_empty() || common.iter().all(|&e| e == 0) {
        return (numerator, divisor);
    }
    let mut sum = out.integer(0);
    for (exponents, coefficient) in &f.terms {
        let mut term = out.constant(coefficient.clone());
        for (p, &exponent) in (0u32..).zip(&exponents[n..]) {
            let parameter = out.parameter(p);
            let power = out.power(parameter, exponent);
            term = out.multiply(term, power);
        }
        let left = exponents.iter().zip(&common).map(|(e, c)| e - c);
        let term = times(out, term, &left.collect::<Vec<u32>>());
        sum = out.add(sum, term);
    }
    let divisor = divisor.iter().zip(&common).map(|(d, c)| d - c);
    (sum, divisor.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::values;
    use num_complex::Complex64;

    fn read(text: &str) -> Result<System, String> {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        let read = crate::formats::read("test", text.as_bytes());
        read.map(|problem| problem.system)
            .map_err(|e| e.to_string())
    }

    fn cleared(equation: &str) -> (System, Vec<bool>) {
        let text = format!("variable_group x, y; parameter p; function f; f = {equation};");
        let system = read(&text).unwrap();
        let nonzero = nonzero_variables(&system);
        (system, nonzero)
    }

    #[test]
    fn an_equation_is_multiplied_by_the_least_monomial() {
        let degree = |equation: &str| {
            let (system, nonzero) = cleared(equation);
            assert_eq!(system.check(), Ok(()));
            (
                crate::polynomial::degrees(&system).unwrap().total[0],
                nonzero,
            )
        };
        assert_eq!(degree("x + 1/x - 2"), (2, vec![true, false]));
        assert_eq!(degree("x^-2*y^(-1) + p"), (3, vec![true, true]));
        assert_eq!(degree("x*y/x - 1"), (1, vec![false, false]), "x cancels");
        assert_eq!(degree("(x + 1/y)^2/(2*p*x) - 3"), (4, vec![true, true]));
        assert_eq!(degree("1/(1/(x*y)) - 1"), (2, vec![false, false]));
        assert_eq!(degree("x*y - 1"), (2, vec![false, false]));
    }

    #[test]
    fn values_are_those_of_the_given_equation_times_the_monomial() {
        let (system, _) = cleared("(x + 1/y)^2/(2*p*x) - 3*y^-1");
        let number = |re: f64, im: f64| Complex64::new(re, im);
        let (x, y, p) = (number(0.5, 1.0), number(-1.5, 0.25), number(2.0, -1.0));
        let found = values(&system.expressions, &system.equations, &[x, y], &[p])[0];
        let sum = x + y.inv();
        let expected = (sum * sum / (p * 2.0 * x) - y.inv() * 3.0) * x * y * y;
        assert!((found - expected).norm_sqr() < 1e-26, "{found} {expected}");
    }

    #[test]
    fn other_denominators_are_refused() {
        let text = "variable_group x, y; function f; f = 1/(x + y) - 1;";
        let error = read(text).unwrap_err();
        assert!(
            error.contains("division by an expression with variables"),
            "{error}"
        );
    }
}
