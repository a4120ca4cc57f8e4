//! The sizes of a system's coefficients, as binary logarithms, whatever doubles hold.
//!
//! Terms are collected as if nothing cancelled: of what cancels exactly, the sizes change with the
//! units as all others do.

use crate::evaluation::values;
use crate::expression::differentiate::below;
use crate::expression::{Dependence, Node, NodeId};
use crate::system::System;
use cognate_numeric::rational::{ComplexRational, Rational};
use foldhash::{HashMap, HashMapExt};
use num_complex::Complex64;
use rug::Integer;
use std::collections::BTreeMap;

/// Most products of terms that the sizes of one system's coefficients may take: some 100 ms.
const MOST_PRODUCTS: usize = 400_000;
/// Most terms of one equation.
const MOST_TERMS: usize = 4_000;

/// A monomial in the variables: indices of variables with their exponents, ascending.
pub(super) type Monomial = Vec<(u32, u32)>;

/// log2 of the size of each monomial's coefficient.
pub(super) type Magnitudes = BTreeMap<Monomial, f64>;

/// log2 |v| to within 0.1, without libm; `None` for 0.
fn log2_rational(v: &Rational) -> Option<f64> {
    // m 2^bits with m in [1/2, 1), whose logarithm is nearly 2 m - 2.
    let part = |n: &Integer| {
        let bits = n.significant_bits();
        let top = match bits > 53 {
            true => Integer::from(n.abs_ref()) >> (bits - 53),
            false => Integer::from(n.abs_ref()) << (53 - bits),
        };
        let mantissa = top.to_f64() / (1u64 << 53) as f64;
        f64::from(bits) + 2.0 * mantissa - 2.0
    };
    (*v != 0).then(|| part(v.numer()) - part(v.denom()))
}

fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.max(b)),
        (a, b) => a.or(b),
    }
}

/// log2 of the larger part of a number; `None` for 0.
pub(super) fn log2(c: &ComplexRational) -> Option<f64> {
    larger(log2_rational(&c.re), log2_rational(&c.im))
}

/// log2 of the larger part of a double; `None` for 0 and for a part that is not finite.
fn log2_double(z: Complex64) -> Option<f64> {
    let part = |v: f64| log2_rational(&Rational::from_f64(v)?);
    larger(part(z.re), part(z.im))
}

/// The sizes of the coefficients of each equation at these values of the parameters; `None` for
/// an equation with too many terms, or with a constant whose size is not seen.
pub(super) fn magnitudes(system: &System, parameters: &[Complex64]) -> Vec<Option<Magnitudes>> {
    let mut products = MOST_PRODUCTS;
    let each = system.equations.iter();
    each.map(|&equation| of_equation(system, equation, parameters, &mut products))
        .collect()
}

fn of_equation(
    system: &System,
    root: NodeId,
    parameters: &[Complex64],
    products: &mut usize,
) -> Option<Magnitudes> {
    let from = &system.expressions;
    let mut done: HashMap<NodeId, Magnitudes> = HashMap::new();
    let number = |size: Option<f64>| {
        size.map(|size| (Monomial::new(), size))
            .into_iter()
            .collect()
    };
    for id in below(from, &[root]) {
        let node_magnitudes: Magnitudes = match from.node(id) {
            Node::Constant(c) => number(log2(c)),
            Node::Parameter(p) => number(parameters.get(*p as usize).and_then(|&z| log2_double(z))),
            Node::Variable(v) => Magnitudes::from([(vec![(*v, 1)], 0.0)]),
            Node::Root(..) | Node::Function(..) => {
                number(values(from, &[id], &[], &[]).pop().and_then(log2_double))
            }
            Node::Add(a, b) | Node::Subtract(a, b) => {
                let mut sum = done[a].clone();
                for (monomial, &size) in &done[b] {
                    include(&mut sum, monomial.clone(), size);
                }
                sum
            }
            Node::Negate(a) => done[a].clone(),
            Node::Multiply(a, b) => product(&done[a], &done[b], products)?,
            Node::Power(a, exponent) => {
                let base = &done[a];
                match (base.len(), base.first_key_value()) {
                    (1, Some((monomial, size))) => {
                        let raised = monomial
                            .iter()
                            .map(|&(v, e)| (v, e.saturating_mul(*exponent)));
                        Magnitudes::from([(raised.collect(), size * f64::from(*exponent))])
                    }
                    _ => {
                        let mut power = base.clone();
                        for _ in 1..*exponent {
                            power = product(&power, base, products)?;
                        }
                        power
                    }
                }
            }
            Node::Divide(a, b) => {
                if from.dependence(*b) == Dependence::Variables {
                    return None;
                }
                let below = *done[b].values().next()?;
                done[a]
                    .iter()
                    .map(|(m, size)| (m.clone(), size - below))
                    .collect()
            }
        };
        if node_magnitudes.len() > MOST_TERMS {
            return None;
        }
        done.insert(id, node_magnitudes);
    }
    done.remove(&root)
}

/// The larger size counts: what cancels is not seen.
fn include(sum: &mut Magnitudes, monomial: Monomial, size: f64) {
    let largest_size = sum.entry(monomial).or_insert(size);
    *largest_size = largest_size.max(size);
}

fn product(a: &Magnitudes, b: &Magnitudes, products: &mut usize) -> Option<Magnitudes> {
    *products = products.checked_sub(a.len().checked_mul(b.len())?)?;
    let mut product_magnitudes = Magnitudes::new();
    for (x, c) in a {
        for (y, d) in b {
            include(&mut product_magnitudes, together(x, y), c + d);
        }
    }
    Some(product_magnitudes)
}

/// The product of two monomials.
fn together(a: &Monomial, b: &Monomial) -> Monomial {
    let mut product = Monomial::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    while let (Some(&&(v, e)), Some(&&(w, f))) = (a.peek(), b.peek()) {
        let next = match v.cmp(&w) {
            std::cmp::Ordering::Less => (v, e),
            std::cmp::Ordering::Greater => (w, f),
            std::cmp::Ordering::Equal => (v, e.saturating_add(f)),
        };
        if v <= w {
            a.next();
        }
        if w <= v {
            b.next();
        }
        product.push(next);
    }
    product.extend(a.chain(b));
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read;

    #[test]
    fn sizes_are_seen_beyond_doubles() {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x, y; parameter p; function f; \
                    f = 1e400*x^2*y - 2^(1/2)*p*y + (x/1e20 + 3)^2/p;\nEND;\n";
        let system = read("test", text.as_bytes()).unwrap().system;
        let system_magnitudes = magnitudes(&system, &[Complex64::new(0.0, 1024.0)]);
        let equation_magnitudes = system_magnitudes[0].as_ref().unwrap();
        let near = |monomial: &[(u32, u32)], expected: f64| {
            let size = equation_magnitudes[monomial];
            assert!((size - expected).abs() < 0.3, "{monomial:?}: {size}");
        };
        near(&[(0, 2), (1, 1)], 1328.77);
        near(&[(1, 1)], 10.5);
        near(&[(0, 2)], -132.88 - 10.0);
        near(&[(0, 1)], 1.585 - 66.44 - 10.0);
        near(&[], 3.17 - 10.0);
        assert_eq!(equation_magnitudes.len(), 5);
    }
}
