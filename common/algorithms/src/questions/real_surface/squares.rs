//! Squares: equations that are written as a sum of two even powers, whose real zeros are those of both bases.
//!
//! A sum of two even powers is a product of a polynomial and its conjugate, each a combination of the two powers. Where
//! a surface that is a component of the one meets its conjugate both are 0, and so both bases: they cut out the curves
//! with the least degrees.

use super::reduced::with_equations;
use crate::decomposition::problem::Problem;
use cognate_continuation::bend::{Number, SlicedEquations};
use cognate_systems::expression::{Dependence, Expressions, Node, NodeId};
use cognate_systems::system::System;
use cognate_systems::transform::{equilibrate, factors};

/// A factor is 0 at a witness point where the distance to its zeros is below this, relative to the point.
const ZERO: f64 = 1e-12;

/// The bases of the two even powers, of the first sum of two even powers among the factors of the equations that is 0
/// at a witness point of the surface; `None` where there is none. Where a denominator of the given equations is 0 the
/// result has no solutions.
pub(super) fn bases(problem: &Problem, witness_point: &[Number]) -> Option<System> {
    let mut given = (*problem.given).clone();
    for equation in given.equations.clone() {
        for (factor, _) in factors(&given.expressions, equation) {
            let Some(powers) = two_even_powers(&given.expressions, factor) else {
                continue;
            };
            let alone = equilibrate(&with_equations(&given, vec![factor]), problem.seed());
            let residuals = SlicedEquations::new(&alone, Vec::new()).residuals(witness_point);
            if residuals[0].1 > ZERO {
                continue;
            }
            let bases = powers.map(|factors| {
                let e = &mut given.expressions;
                let one = e.integer(1);
                let product = |product, factor| e.multiply(product, factor);
                factors.into_iter().fold(one, product)
            });
            let system = System {
                degenerate: problem.given.degenerate.clone(),
                ..with_equations(&given, bases.to_vec())
            };
            return Some(equilibrate(&system, problem.seed()));
        }
    }
    None
}

/// The factors of the bases of two even powers with real coefficients of one sign, of which a node is the sum.
fn two_even_powers(e: &Expressions, node: NodeId) -> Option<[Vec<NodeId>; 2]> {
    if !is_real(e, node) {
        return None;
    }
    let mut terms = Vec::new();
    let mut open = vec![(node, true)];
    while let Some((node, plus)) = open.pop() {
        match e.node(node) {
            Node::Add(a, b) => open.extend([(*a, plus), (*b, plus)]),
            Node::Subtract(a, b) => open.extend([(*a, plus), (*b, !plus)]),
            Node::Negate(a) => open.push((*a, !plus)),
            _ => terms.push((node, plus)),
        }
    }
    let [(first, first_plus), (second, second_plus)] = terms[..] else {
        return None;
    };
    let signs = [
        is_positive(e, first)? == first_plus,
        is_positive(e, second)? == second_plus,
    ];
    let base = |term: NodeId| -> Option<Vec<NodeId>> {
        let factors = factors(e, term);
        let even = !factors.is_empty() && factors.iter().all(|(_, exponent)| exponent % 2 == 0);
        even.then(|| factors.into_iter().map(|(factor, _)| factor).collect())
    };
    let bases = [base(first)?, base(second)?];
    (signs[0] == signs[1]).then_some(bases)
}

/// Whether all constants of an expression are real rational numbers.
fn is_real(e: &Expressions, node: NodeId) -> bool {
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        match e.node(node) {
            Node::Constant(c) if c.is_real() => {}
            Node::Variable(_) => {}
            Node::Add(a, b) | Node::Subtract(a, b) | Node::Multiply(a, b) | Node::Divide(a, b) => {
                open.extend([*a, *b]);
            }
            Node::Negate(a) | Node::Power(a, _) => open.push(*a),
            Node::Constant(_) | Node::Parameter(_) | Node::Root(..) | Node::Function(..) => {
                return false;
            }
        }
    }
    true
}

/// The sign of the coefficient of a product of even powers; `None` where it is 0 or no number that is written down.
fn is_positive(e: &Expressions, node: NodeId) -> Option<bool> {
    match e.node(node) {
        Node::Multiply(a, b) | Node::Divide(a, b) => {
            Some(is_positive(e, *a)? == is_positive(e, *b)?)
        }
        Node::Negate(a) => Some(!is_positive(e, *a)?),
        Node::Power(_, k) if k % 2 == 0 => Some(true),
        Node::Power(a, _) => is_positive(e, *a),
        Node::Constant(c) if c.is_zero() => None,
        Node::Constant(c) => Some(c.re.to_f64() > 0.0),
        _ if e.dependence(node) == Dependence::Variables => Some(true),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_sum(equation: &str) -> bool {
        let text =
            format!("{{\"variables\": [\"x\", \"y\", \"z\"], \"equations\": [\"{equation}\"]}}");
        let read = cognate_systems::formats::read("test", text.as_bytes());
        let system = read.expect("a problem of this test").system;
        two_even_powers(&system.expressions, system.equations[0]).is_some()
    }

    #[test]
    fn sums_of_two_even_powers_are_told() {
        for sum in [
            "x^2 + y^2",
            "-3*(x - 1)^2 - 1/2*y^4*z^2",
            "(x^2 + y^2 - 1)^2 - (-2)*(z*z)",
        ] {
            assert!(is_sum(sum), "{sum}");
        }
        for other in [
            "x^2 - y^2",
            "x^2 + y^3",
            "x^2 + y^2 + z^2",
            "x^2 + 1",
            "(x + I*y)^2 + (x - I*y)^2",
        ] {
            assert!(!is_sum(other), "{other}");
        }
    }
}
