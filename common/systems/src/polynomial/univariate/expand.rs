//! From an expression in one unknown to its coefficients.

use super::exact_polynomial::ExactPolynomial;
use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId};
use cognate_numeric::rational::ComplexRational;
use foldhash::{HashMap, HashMapExt};
use std::collections::BTreeMap;

/// Largest degree that is expanded.
const MOST_DEGREE: u32 = 4096;
/// Most products of terms: some seconds.
const MOST_PRODUCTS: usize = 20_000_000;
/// Most bits of a coefficient, as the arena bounds its constants.
const MOST_BITS: u64 = 1 << 20;

/// Coefficients by exponents, none of them 0.
type Terms = BTreeMap<u32, ComplexRational>;

/// The polynomial, up to a constant factor, for these values of the parameters. `None` where a number is not rational,
/// or the polynomial is too large.
pub(super) fn expand(
    expressions: &Expressions,
    root: NodeId,
    parameters: &[ComplexRational],
) -> Option<ExactPolynomial> {
    let nodes = below(expressions, &[root]);
    let mut expansion = Expansion::new(expressions, &nodes, root);
    for &id in &nodes {
        let terms = expansion.terms(id, parameters)?;
        if terms.keys().next_back().is_some_and(|&d| d > MOST_DEGREE) {
            return None;
        }
        expansion.done.insert(id, terms);
    }
    let terms = expansion.done.remove(&root)?;
    let degree = terms.keys().next_back().copied().unwrap_or(0);
    let zero = ComplexRational::default();
    let coefficients = (0..=degree).map(|k| terms.get(&k).unwrap_or(&zero).clone());
    let coefficients: Vec<ComplexRational> = coefficients.collect();
    Some(ExactPolynomial::from_rationals(&coefficients))
}

struct Expansion<'a> {
    expressions: &'a Expressions,
    done: HashMap<NodeId, Terms>,
    /// Number of times that each node is still needed.
    uses: HashMap<NodeId, u32>,
    products: usize,
}

impl<'a> Expansion<'a> {
    fn new(expressions: &'a Expressions, nodes: &[NodeId], root: NodeId) -> Self {
        let mut uses = HashMap::new();
        uses.insert(root, 1);
        for child in nodes.iter().flat_map(|&id| expressions.children(id)) {
            *uses.entry(child).or_insert(0) += 1;
        }
        Self {
            expressions,
            done: HashMap::new(),
            uses,
            products: MOST_PRODUCTS,
        }
    }

    fn terms(&mut self, id: NodeId, parameters: &[ComplexRational]) -> Option<Terms> {
        let leaf = |exponent: u32, c: ComplexRational| match c.is_zero() {
            true => Terms::new(),
            false => Terms::from([(exponent, c)]),
        };
        Some(match self.expressions.node(id).clone() {
            Node::Constant(c) => leaf(0, c),
            Node::Parameter(p) => leaf(0, parameters.get(p as usize)?.clone()),
            Node::Variable(_) => leaf(1, ComplexRational::real(1)),
            Node::Add(a, b) => self.sum(a, b, false),
            Node::Subtract(a, b) => self.sum(a, b, true),
            Node::Negate(a) => {
                let mut terms = self.take(a);
                terms.values_mut().for_each(|c| *c = c.negate());
                terms
            }
            Node::Multiply(a, b) => {
                let (a, b) = (self.take(a), self.take(b));
                self.product(&a, &b)?
            }
            Node::Divide(a, b) => {
                let (mut a, b) = (self.take(a), self.take(b));
                let (Some((0, divisor)), 1) = (b.first_key_value(), b.len()) else {
                    return None;
                };
                for c in a.values_mut() {
                    *c = c.divide(divisor)?;
                }
                a
            }
            Node::Power(a, exponent) => {
                let base = self.take(a);
                self.power(&base, exponent)?
            }
            Node::Root(..) | Node::Function(..) => return None,
        })
    }

    /// The terms of a node, for the last time where nothing else needs them.
    fn take(&mut self, id: NodeId) -> Terms {
        let uses = self.uses.get_mut(&id).expect("a child is counted");
        *uses -= 1;
        let terms = match *uses {
            0 => self.done.remove(&id),
            _ => self.done.get(&id).cloned(),
        };
        terms.expect("children come before their parents")
    }

    fn sum(&mut self, a: NodeId, b: NodeId, is_difference: bool) -> Terms {
        let (mut sum, b) = (self.take(a), self.take(b));
        for (exponent, c) in b {
            let c = if is_difference { c.negate() } else { c };
            accumulate(&mut sum, exponent, c);
        }
        sum
    }

    fn product(&mut self, a: &Terms, b: &Terms) -> Option<Terms> {
        self.products = self.products.checked_sub(a.len() * b.len())?;
        let mut product = Terms::new();
        for (i, c) in a {
            for (j, d) in b {
                accumulate(&mut product, i.checked_add(*j)?, c.multiply(d));
            }
        }
        Some(product)
    }

    fn power(&mut self, base: &Terms, exponent: u32) -> Option<Terms> {
        let degree = base.keys().next_back().copied().unwrap_or(0);
        let bits = base.values().map(|c| u64::from(bits(c))).max();
        if degree.checked_mul(exponent)? > MOST_DEGREE
            || bits.unwrap_or(0).checked_mul(u64::from(exponent))? > MOST_BITS
        {
            return None;
        }
        if let (Some((&degree, c)), 1) = (base.first_key_value(), base.len()) {
            return Some(Terms::from([(degree * exponent, c.power(exponent))]));
        }
        let mut power = Terms::from([(0, ComplexRational::real(1))]);
        for _ in 0..exponent {
            power = self.product(&power, base)?;
        }
        Some(power)
    }
}

/// Bits of the largest integer in a number.
fn bits(c: &ComplexRational) -> u32 {
    let parts = [&c.re, &c.im];
    let each = parts.iter().map(|part| {
        let (n, d) = (part.numer(), part.denom());
        n.significant_bits().max(d.significant_bits())
    });
    each.max().unwrap_or(0)
}

fn accumulate(sum: &mut Terms, exponent: u32, c: ComplexRational) {
    let entry = sum.entry(exponent).or_default();
    *entry = entry.add(&c);
    if entry.is_zero() {
        sum.remove(&exponent);
    }
}
