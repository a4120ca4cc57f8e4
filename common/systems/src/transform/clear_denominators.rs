//! Systems with variables in denominators, multiplied out.
//!
//! An equation is multiplied by the least product of denominators that makes it a polynomial. Where a denominator of
//! the equations that were given is 0, one that cancels among them, the equation has no value, so that a point there is
//! no solution. Points of this kind are a degenerate set by name, and no answer holds them.

use crate::expression::differentiate::below;
use crate::expression::{Dependence, Expressions, Node, NodeId};
use crate::polynomial::Polynomial;
use crate::system::{DegenerateSet, System};
use cognate_numeric::rational::ComplexRational;
use foldhash::HashMap;
use std::collections::{BTreeMap, BTreeSet};

/// The name of the set of points where a denominator of the given equations is 0.
pub const ZERO_DENOMINATOR: &str = "a denominator is 0";

/// Multiplies every equation by the denominators that it has.
///
/// An equation stays as it is where an exponent would be past all limits, or a denominator is 0 everywhere.
pub fn clear_denominators(system: &mut System) {
    let polynomial = system.polynomial_nodes();
    let mut fractions = Fractions::default();
    let out = &mut system.expressions;
    // Denominators that a reader saw and that no equation holds any more.
    if let Some(DegenerateSet::Nonzero(product)) = system.degenerate.get(ZERO_DENOMINATOR) {
        let one = out.integer(1);
        let inverse = out.insert(Node::Divide(one, *product));
        fractions.of(out, inverse);
    }
    for equation in &mut system.equations {
        if polynomial[equation.0 as usize] {
            continue;
        }
        let Some((numerator, under)) = fractions.of(out, *equation) else {
            continue;
        };
        let (variables, parameters) = (system.variables.len(), system.parameters.len());
        *equation = without_common_variables(out, numerator, &under, variables, parameters);
    }
    let nonzero = fractions.nonzero.into_iter().map(|factor| (factor, 1));
    let nonzero: Factors = nonzero.collect();
    if !nonzero.is_empty() {
        let one = out.integer(1);
        let set = DegenerateSet::Nonzero(times(out, one, &nonzero));
        system.degenerate.insert(ZERO_DENOMINATOR.into(), set);
    }
}

/// The factors of the denominators of the equations that were given: variables and sums.
pub fn denominator_factors(system: &System) -> Vec<NodeId> {
    let mut factors = Vec::new();
    let Some(DegenerateSet::Nonzero(product)) = system.degenerate.get(ZERO_DENOMINATOR) else {
        return factors;
    };
    let mut open = vec![*product];
    while let Some(id) = open.pop() {
        match system.expressions.node(id) {
            Node::Multiply(a, b) => open.extend([*a, *b]),
            Node::Negate(a) | Node::Power(a, _) => open.push(*a),
            _ => factors.push(id),
        }
    }
    factors
}

/// Whether each variable is a denominator of the equations that were given.
pub fn nonzero_variables(system: &System) -> Vec<bool> {
    let mut nonzero = vec![false; system.variables.len()];
    for factor in denominator_factors(system) {
        if let Node::Variable(v) = system.expressions.node(factor) {
            nonzero[*v as usize] = true;
        }
    }
    nonzero
}

/// A product of variables and sums, with their exponents.
type Factors = BTreeMap<NodeId, u32>;

/// A polynomial and the factors of its denominator.
type Fraction = (NodeId, Factors);

fn times(out: &mut Expressions, node: NodeId, factors: &Factors) -> NodeId {
    let mut product = node;
    for (&factor, &exponent) in factors {
        let power = out.power(factor, exponent);
        product = out.multiply(product, power);
    }
    product
}

fn plus(a: &Factors, b: &Factors) -> Option<Factors> {
    let mut sum = a.clone();
    for (&factor, &exponent) in b {
        let total_exponent = sum.entry(factor).or_default();
        *total_exponent = total_exponent.checked_add(exponent)?;
    }
    Some(sum)
}

fn multiple(a: &Factors, k: u32) -> Option<Factors> {
    let each = a.iter();
    each.map(|(&factor, exponent)| Some((factor, exponent.checked_mul(k)?)))
        .collect()
}

/// Nodes as fractions and as products, each computed once.
#[derive(Default)]
struct Fractions {
    fractions: HashMap<NodeId, Fraction>,
    /// Coefficient and factors.
    products: HashMap<NodeId, Fraction>,
    /// The factors of all denominators that were met.
    nonzero: BTreeSet<NodeId>,
}

impl Fractions {
    /// Writes a node as a fraction; `None` where an exponent is past 32 bits, or a denominator is 0 everywhere.
    fn of(&mut self, out: &mut Expressions, root: NodeId) -> Option<Fraction> {
        for id in below(out, &[root]) {
            if self.fractions.contains_key(&id) {
                continue;
            }
            let done = &self.fractions;
            let fraction = match out.node(id).clone() {
                Node::Add(a, b) => joined(out, &done[&a], &done[&b], Expressions::add),
                Node::Subtract(a, b) => joined(out, &done[&a], &done[&b], Expressions::subtract),
                Node::Multiply(a, b) => {
                    let ((a, under_a), (b, under_b)) = (&done[&a], &done[&b]);
                    (out.multiply(*a, *b), plus(under_a, under_b)?)
                }
                Node::Divide(a, b) => {
                    let ((a, under_a), (b, under_b)) = (done[&a].clone(), done[&b].clone());
                    let (coefficient, factors) = self.product(out, b)?;
                    let zero = out.as_constant(coefficient);
                    if zero.is_some_and(ComplexRational::is_zero) {
                        return None;
                    }
                    self.nonzero.extend(factors.keys());
                    let numerator = times(out, a, &under_b);
                    let numerator = out.divide(numerator, coefficient);
                    (numerator, plus(&under_a, &factors)?)
                }
                Node::Negate(a) => {
                    let (a, under) = &done[&a];
                    (out.negate(*a), under.clone())
                }
                Node::Power(a, k) => {
                    let (a, under) = &done[&a];
                    (out.power(*a, k), multiple(under, k)?)
                }
                Node::Constant(_)
                | Node::Variable(_)
                | Node::Parameter(_)
                | Node::Root(..)
                | Node::Function(..) => (id, Factors::new()),
            };
            self.fractions.insert(id, fraction);
        }
        self.fractions.get(&root).cloned()
    }

    /// A polynomial as a coefficient without variables, and factors.
    fn product(&mut self, out: &mut Expressions, root: NodeId) -> Option<Fraction> {
        for id in below(out, &[root]) {
            if self.products.contains_key(&id) {
                continue;
            }
            let done = &self.products;
            let factored_product = match out.node(id).clone() {
                _ if out.dependence(id) != Dependence::Variables => (id, Factors::new()),
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
                    (out.power(*a, k), multiple(of_a, k)?)
                }
                _ => (out.integer(1), Factors::from([(id, 1)])),
            };
            self.products.insert(id, factored_product);
        }
        self.products.get(&root).cloned()
    }
}

/// Two fractions over their common denominator.
fn joined(
    out: &mut Expressions,
    (a, under_a): &Fraction,
    (b, under_b): &Fraction,
    join: impl Fn(&mut Expressions, NodeId, NodeId) -> NodeId,
) -> Fraction {
    let mut common = under_a.clone();
    for (&factor, &exponent) in under_b {
        let common_exponent = common.entry(factor).or_default();
        *common_exponent = exponent.max(*common_exponent);
    }
    let lacks = |under: &Factors| -> Factors {
        let exponent_of = |factor: &NodeId| under.get(factor).copied().unwrap_or(0);
        let factors = common.iter();
        factors
            .map(|(factor, exponent)| (*factor, exponent - exponent_of(factor)))
            .collect()
    };
    let a = times(out, *a, &lacks(under_a));
    let b = times(out, *b, &lacks(under_b));
    (join(out, a, b), common)
}

/// The numerator without the variables of the denominator that all its terms have in common.
fn without_common_variables(
    out: &mut Expressions,
    numerator: NodeId,
    under: &Factors,
    variables: usize,
    parameters: usize,
) -> NodeId {
    let is_variable = |id: &NodeId| matches!(out.node(*id), Node::Variable(_));
    if !under.keys().any(is_variable) {
        return numerator;
    }
    let Some(f) = Polynomial::expand(out, numerator, variables, parameters) else {
        return numerator;
    };
    let mut common = vec![0; variables];
    for (&id, &exponent) in under {
        if let Node::Variable(v) = out.node(id) {
            let v = *v as usize;
            let least = f.terms.keys().map(|e| e[v]).min().unwrap_or(0);
            common[v] = exponent.min(least);
        }
    }
    if f.terms.is_empty() || common.iter().all(|&e| e == 0) {
        return numerator;
    }
    let x: Vec<NodeId> = (0..variables as u32).map(|v| out.variable(v)).collect();
    let mut sum = out.integer(0);
    for (exponents, coefficient) in &f.terms {
        let mut term = out.constant(coefficient.clone());
        for (p, &exponent) in (0u32..).zip(&exponents[variables..]) {
            let parameter = out.parameter(p);
            let power = out.power(parameter, exponent);
            term = out.multiply(term, power);
        }
        for ((&x, exponent), common) in x.iter().zip(exponents).zip(&common) {
            let power = out.power(x, exponent - common);
            term = out.multiply(term, power);
        }
        sum = out.add(sum, term);
    }
    sum
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
        assert_eq!(
            degree("x*y/x - 1"),
            (1, vec![true, false]),
            "x cancels, and is a denominator"
        );
        assert_eq!(degree("(x + 1/y)^2/(2*p*x) - 3"), (4, vec![true, true]));
        assert_eq!(degree("1/(1/(x*y)) - 1"), (2, vec![true, true]));
        assert_eq!(degree("x*y - 1"), (2, vec![false, false]));
    }

    #[test]
    fn values_are_those_of_the_given_equation_times_the_monomial() {
        let (system, _) = cleared("(x + 1/y)^2/(2*p*x) - 3*y^-1");
        let number = |re: f64, im: f64| Complex64::new(re, im);
        let (x, y, p) = (number(0.5, 1.0), number(-1.5, 0.25), number(2.0, -1.0));
        let cleared_value = values(&system.expressions, &system.equations, &[x, y], &[p])[0];
        let sum = x + y.inv();
        let expected = (sum * sum / (p * 2.0 * x) - y.inv() * 3.0) * x * y * y;
        assert!(
            (cleared_value - expected).norm_sqr() < 1e-26,
            "{cleared_value} {expected}"
        );
    }

    #[test]
    fn denominators_that_reading_simplifies_away_are_denominators() {
        for equation in [
            "x - 1 + 0/y",
            "x - 1 + 0*(2/y)",
            "1/y - 1/y + x - 1",
            "x - (3/y + x)^0",
            "x - (y/y)^0",
        ] {
            let (system, nonzero) = cleared(equation);
            assert_eq!(nonzero, [false, true], "{equation}");
            assert_eq!(crate::polynomial::degrees(&system).unwrap().total, [1]);
        }
        let text = "variable_group x, y; function f; f = x - 1/(y/y - 1);";
        assert!(read(text).is_err(), "a denominator that is 0 everywhere");
    }

    #[test]
    fn sums_below_the_line_are_multiplied_out() {
        let (system, nonzero) = cleared("1/(x + y) + p*x/(y*(x + y)^2) - 1/(2*y - 2)");
        assert_eq!(nonzero, [false, true]);
        assert_eq!(denominator_factors(&system).len(), 3);
        let number = |re: f64, im: f64| Complex64::new(re, im);
        let (x, y, p) = (number(0.5, 1.0), number(-1.5, 0.25), number(2.0, -1.0));
        let cleared_value = values(&system.expressions, &system.equations, &[x, y], &[p])[0];
        let (s, t) = (x + y, y * 2.0 - 2.0);
        let expected = (s.inv() + p * x / (y * s * s) - t.inv()) * y * s * s * t;
        assert!(
            (cleared_value - expected).norm_sqr() < 1e-24,
            "{cleared_value} {expected}"
        );
        assert_eq!(crate::polynomial::degrees(&system).unwrap().total, [3]);
    }
}
