//! An expression as a quotient of two polynomials with coefficients in doubles.

use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId};
use num_complex::Complex64;
use std::collections::{BTreeMap, HashMap};

/// Coefficients by the exponents of the variables.
pub(super) type Terms = BTreeMap<Vec<u32>, f64>;

/// Quotients with more terms above or below are not written out.
const MOST_TERMS: usize = 1000;
/// Quotients with a higher power of a sum are not written out.
const HIGHEST_POWER: u32 = 64;

/// Two polynomials, the second of which is not 0 everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Quotient {
    pub(super) numerator: Terms,
    pub(super) denominator: Terms,
}

impl Quotient {
    /// Writes out an expression in the first `variables` variables; `None` where it has others, roots or functions,
    /// nonreal numbers, or too many terms.
    pub fn of(
        expressions: &Expressions,
        root: NodeId,
        variables: usize,
        parameters: &[Complex64],
    ) -> Option<Self> {
        let mut done: HashMap<NodeId, Self> = HashMap::new();
        let real = |z: Complex64| (z.im == 0.0).then_some(z.re);
        for id in below(expressions, &[root]) {
            let quotient = match expressions.node(id) {
                Node::Constant(c) if c.is_real() => Self::constant(c.re.to_f64(), variables),
                Node::Parameter(p) => {
                    Self::constant(real(*parameters.get(*p as usize)?)?, variables)
                }
                Node::Variable(v) if (*v as usize) < variables => {
                    let mut key = vec![0; variables];
                    key[*v as usize] = 1;
                    Self {
                        numerator: Terms::from([(key, 1.0)]),
                        ..Self::constant(1.0, variables)
                    }
                }
                Node::Add(a, b) => done[a].plus(&done[b], 1.0)?,
                Node::Subtract(a, b) => done[a].plus(&done[b], -1.0)?,
                Node::Negate(a) => Self::constant(0.0, variables).plus(&done[a], -1.0)?,
                Node::Multiply(a, b) => done[a].times(&done[b])?,
                Node::Divide(a, b) => done[a].times(&done[b].inverse()?)?,
                Node::Power(a, exponent) if *exponent <= HIGHEST_POWER => {
                    let mut power = Self::constant(1.0, variables);
                    for _ in 0..*exponent {
                        power = power.times(&done[a])?;
                    }
                    power
                }
                _ => return None,
            };
            done.insert(id, quotient);
        }
        done.remove(&root)
    }

    /// Number of variables.
    pub(super) fn variables(&self) -> usize {
        self.denominator.keys().next().map_or(0, Vec::len)
    }

    fn constant(value: f64, variables: usize) -> Self {
        let terms = |value: f64| {
            let term = (value != 0.0).then(|| (vec![0; variables], value));
            term.into_iter().collect()
        };
        Self {
            numerator: terms(value),
            denominator: terms(1.0),
        }
    }

    /// The quotient plus a multiple of another.
    pub(super) fn plus(&self, other: &Self, factor: f64) -> Option<Self> {
        if self.denominator == other.denominator {
            return Some(Self {
                numerator: sum(&self.numerator, &other.numerator, factor),
                denominator: self.denominator.clone(),
            });
        }
        let left = product(&self.numerator, &other.denominator)?;
        let right = product(&other.numerator, &self.denominator)?;
        Some(Self {
            numerator: sum(&left, &right, factor),
            denominator: product(&self.denominator, &other.denominator)?,
        })
    }

    fn times(&self, other: &Self) -> Option<Self> {
        Some(Self {
            numerator: product(&self.numerator, &other.numerator)?,
            denominator: product(&self.denominator, &other.denominator)?,
        })
    }

    fn inverse(&self) -> Option<Self> {
        (!self.numerator.is_empty()).then(|| Self {
            numerator: self.denominator.clone(),
            denominator: self.numerator.clone(),
        })
    }

    /// The quotient times a number.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            numerator: scaled(&self.numerator, factor),
            denominator: self.denominator.clone(),
        }
    }
}

/// A polynomial times a number.
pub(super) fn scaled(terms: &Terms, factor: f64) -> Terms {
    terms
        .iter()
        .map(|(key, c)| (key.clone(), c * factor))
        .collect()
}

/// A polynomial plus a multiple of another.
pub(super) fn sum(a: &Terms, b: &Terms, factor: f64) -> Terms {
    let mut terms = a.clone();
    for (key, coefficient) in b {
        *terms.entry(key.clone()).or_default() += factor * coefficient;
    }
    terms.retain(|_, coefficient| *coefficient != 0.0);
    terms
}

fn product(a: &Terms, b: &Terms) -> Option<Terms> {
    let mut terms = Terms::new();
    for (left, x) in a {
        for (right, y) in b {
            let key = left.iter().zip(right).map(|(i, j)| i.checked_add(*j));
            *terms.entry(key.collect::<Option<Vec<u32>>>()?).or_default() += x * y;
        }
        if terms.len() > MOST_TERMS {
            return None;
        }
    }
    terms.retain(|_, coefficient| *coefficient != 0.0);
    Some(terms)
}
