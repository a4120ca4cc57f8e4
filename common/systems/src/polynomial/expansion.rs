//! Polynomial: an equation multiplied out, with exact coefficients.

use crate::expression::differentiate::below;
use crate::expression::{Expressions, Node, NodeId};
use cognate_numeric::interruption::count_work;
use cognate_numeric::rational::ComplexRational;
use foldhash::{HashMap, HashMapExt};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Most products of terms that one expansion may take, and most terms that it
/// may hold at a time: some milliseconds and megabytes.
const MOST_PRODUCTS: usize = 400_000;
const MOST_TERMS: usize = 50_000;
/// Operations that one product of two terms costs, beside those of its exponents: an entry of a tree, and exact numbers.
const OPERATIONS_PER_PRODUCT: u64 = 100;

/// A sparse polynomial with exact coefficients, none of them 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polynomial {
    /// Coefficients by exponents: those of the variables in order, then those
    /// of the parameters.
    pub terms: BTreeMap<Vec<u32>, ComplexRational>,
    /// Number of exponents that belong to variables.
    pub variables: usize,
}

impl Polynomial {
    /// Multiplies an expression out. `None` where that takes too much, or
    /// where a coefficient is not rational or has a parameter below the line.
    pub fn expand(
        expressions: &Expressions,
        root: NodeId,
        variables: usize,
        parameters: usize,
    ) -> Option<Self> {
        let mut budget = Budget {
            products: MOST_PRODUCTS,
            terms: MOST_TERMS,
        };
        let length = variables + parameters;
        let mut done: HashMap<NodeId, Terms> = HashMap::new();
        for id in below(expressions, &[root]) {
            let leaf = |position: usize| {
                let mut exponents = vec![0; length];
                *exponents.get_mut(position)? = 1;
                Some(Terms::from([(exponents, ComplexRational::real(1))]))
            };
            let terms = match expressions.node(id) {
                Node::Constant(c) if c.is_zero() => Terms::new(),
                Node::Constant(c) => Terms::from([(vec![0; length], c.clone())]),
                Node::Variable(v) => leaf(*v as usize)?,
                Node::Parameter(p) => leaf(variables + *p as usize)?,
                Node::Add(a, b) => combine(&done[a], &done[b], false),
                Node::Subtract(a, b) => combine(&done[a], &done[b], true),
                Node::Negate(a) => combine(&Terms::new(), &done[a], true),
                Node::Multiply(a, b) => budget.multiply(&done[a], &done[b])?,
                Node::Power(a, exponent) => budget.power(&done[a], *exponent, length)?,
                Node::Divide(..) | Node::Root(..) | Node::Function(..) => return None,
            };
            budget.terms = budget.terms.checked_sub(terms.len())?;
            if count_work(OPERATIONS_PER_PRODUCT * terms.len() as u64) {
                return None;
            }
            done.insert(id, terms);
        }
        Some(Self {
            terms: done.remove(&root)?,
            variables,
        })
    }

    /// Largest degree in some variables together; 0 for the zero polynomial.
    pub fn degree_in(&self, variables: &[usize]) -> u32 {
        self.degrees_in(variables).max().unwrap_or(0)
    }

    /// Largest degree in all variables; parameters do not count.
    pub fn degree(&self) -> u32 {
        let variables: Vec<usize> = (0..self.variables).collect();
        self.degree_in(&variables)
    }

    /// Whether every term has the same degree in these variables.
    pub fn is_homogeneous_in(&self, variables: &[usize]) -> bool {
        let mut degrees = self.degrees_in(variables);
        let first = degrees.next();
        degrees.all(|d| Some(d) == first)
    }

    fn degrees_in(&self, variables: &[usize]) -> impl Iterator<Item = u32> {
        self.terms
            .keys()
            .map(move |exponents| variables.iter().map(|&v| exponents[v]).sum())
    }

    /// Number of terms, with all their parameters.
    pub fn term_count(&self) -> usize {
        self.terms.len()
    }

    /// The exponents of the variables that occur, each once: the support.
    pub fn support(&self) -> Vec<Vec<u32>> {
        let mut support: Vec<Vec<u32>> = self
            .terms
            .keys()
            .map(|exponents| exponents[..self.variables].to_vec())
            .collect();
        support.dedup();
        support
    }

    /// The coefficients of the monomials in the variables, for these values of the parameters.
    pub fn coefficients_at(&self, parameters: &[Complex64]) -> BTreeMap<Vec<u32>, Complex64> {
        let mut coefficients: BTreeMap<Vec<u32>, Complex64> = BTreeMap::new();
        for (exponents, c) in &self.terms {
            let (of_variables, of_parameters) = exponents.split_at(self.variables);
            let mut value = Complex64::new(c.re.to_f64(), c.im.to_f64());
            for (parameter, &exponent) in parameters.iter().zip(of_parameters) {
                for _ in 0..exponent {
                    value *= parameter;
                }
            }
            *coefficients.entry(of_variables.to_vec()).or_default() += value;
        }
        coefficients
    }

    /// Applies complex conjugation: conjugates the coefficients, and replaces each variable v by variable `partner[v]`.
    /// Parameters stay.
    pub fn conjugate(&self, partner: &[usize]) -> Self {
        let terms = self.terms.iter().map(|(exponents, c)| {
            let mut image = exponents.clone();
            for (v, &w) in partner.iter().enumerate() {
                image[w] = exponents[v];
            }
            (image, c.conjugate())
        });
        Self {
            terms: terms.collect(),
            variables: self.variables,
        }
    }

    /// Writes it into an arena: a sum of terms, the highest first, each a
    /// coefficient times powers. `leaves` stand for variables and parameters.
    pub fn write(&self, out: &mut Expressions, leaves: &[NodeId]) -> NodeId {
        let mut sum = out.integer(0);
        for (exponents, coefficient) in self.terms.iter().rev() {
            let mut term = out.constant(coefficient.clone());
            for (&leaf, &exponent) in leaves.iter().zip(exponents) {
                let power = out.power(leaf, exponent);
                term = out.multiply(term, power);
            }
            sum = out.add(sum, term);
        }
        sum
    }
}

type Terms = BTreeMap<Vec<u32>, ComplexRational>;

fn combine(a: &Terms, b: &Terms, negative: bool) -> Terms {
    let mut sum = a.clone();
    for (exponents, c) in b {
        let c = if negative { c.negate() } else { c.clone() };
        accumulate(&mut sum, exponents.clone(), c);
    }
    sum
}

fn accumulate(sum: &mut Terms, exponents: Vec<u32>, c: ComplexRational) {
    use std::collections::btree_map::Entry;
    match sum.entry(exponents) {
        Entry::Vacant(place) => {
            if !c.is_zero() {
                place.insert(c);
            }
        }
        Entry::Occupied(mut place) => {
            let total = place.get().add(&c);
            if total.is_zero() {
                place.remove();
            } else {
                place.insert(total);
            }
        }
    }
}

struct Budget {
    products: usize,
    terms: usize,
}

impl Budget {
    fn multiply(&mut self, a: &Terms, b: &Terms) -> Option<Terms> {
        self.products = self.products.checked_sub(a.len().checked_mul(b.len())?)?;
        let mut product = Terms::new();
        for (x, c) in a {
            if count_work((OPERATIONS_PER_PRODUCT + x.len() as u64) * b.len() as u64) {
                return None;
            }
            for (y, d) in b {
                let exponents = x
                    .iter()
                    .zip(y)
                    .map(|(&i, &j)| i.checked_add(j))
                    .collect::<Option<Vec<u32>>>()?;
                accumulate(&mut product, exponents, c.multiply(d));
            }
            if product.len() > self.terms {
                return None;
            }
        }
        Some(product)
    }

    /// `None` where a power of two terms or more certainly needs more products of terms than are left: the k-th power has k + 1
    /// terms at least, for it has a root of multiplicity k other than 0 in the powers of one unknown (G. Hajós 1953; A. Schinzel,
    /// On the number of terms of a power of a polynomial, Acta Arith. 49 (1987)).
    fn suffices_for_power(&self, terms: usize, exponent: u32) -> Option<()> {
        let n = exponent as usize;
        let terms_of_all = n.checked_mul(n.checked_add(1)?)? / 2;
        let products = terms_of_all.checked_mul(terms)?;
        (products <= self.products && n < self.terms).then_some(())
    }

    fn power(&mut self, base: &Terms, exponent: u32, length: usize) -> Option<Terms> {
        if base.is_empty() {
            return Some(Terms::new());
        }
        // Coefficients grow with the exponent too; they are bounded as the
        // arena bounds its constants.
        let bits: u64 = base
            .values()
            .flat_map(|c| [c.re.numer(), c.re.denom(), c.im.numer(), c.im.denom()])
            .map(|n| u64::from(n.significant_bits()))
            .max()
            .unwrap_or(0);
        if bits.checked_mul(u64::from(exponent))? > 1 << 20 {
            return None;
        }
        let mut result = Terms::from([(vec![0; length], ComplexRational::real(1))]);
        if base.len() > 1 {
            self.suffices_for_power(base.len(), exponent)?;
            // Repeated multiplication by a short factor is cheaper than squaring.
            for _ in 0..exponent {
                result = self.multiply(&result, base)?;
            }
            return Some(result);
        }
        let mut square = base.clone();
        let mut e = exponent;
        while e > 0 {
            if e & 1 == 1 {
                result = self.multiply(&result, &square)?;
            }
            e >>= 1;
            if e > 0 {
                square = self.multiply(&square, &square)?;
            }
        }
        Some(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_multiplied_out_and_cancel() {
        let mut e = Expressions::new();
        let (x, p) = (e.variable(0), e.parameter(0));
        let one = e.integer(1);
        let sum = e.add(x, one);
        let square = e.power(sum, 2);
        let x2 = e.power(x, 2);
        let difference = e.subtract(square, x2);
        let f = e.multiply(p, difference);
        // p*((x+1)^2 - x^2) = 2px + p
        let expanded = Polynomial::expand(&e, f, 1, 1).expect("small");
        let expected = [(vec![0, 1], 1), (vec![1, 1], 2)];
        assert_eq!(
            expanded.terms,
            expected
                .map(|(x, c)| (x, ComplexRational::real(c)))
                .into_iter()
                .collect()
        );
        assert_eq!(expanded.degree(), 1);
        assert_eq!(expanded.support(), [vec![0], vec![1]]);
        assert!(!expanded.is_homogeneous_in(&[0]));
        let mut out = Expressions::new();
        let leaves = [out.variable(0), out.parameter(0)];
        let written = expanded.write(&mut out, &leaves);
        let expanded_again = Polynomial::expand(&out, written, 1, 1).expect("small");
        assert_eq!(expanded_again, expanded);
    }

    #[test]
    fn powers_that_are_too_large_are_refused_before_they_are_begun() {
        let budget = Budget {
            products: 420,
            terms: 50_000,
        };
        // (1 + x)^20 by 20 products of a power and two terms: 2*(1 + 2 + ... + 20).
        assert_eq!(budget.suffices_for_power(2, 20), Some(()));
        assert_eq!(budget.suffices_for_power(2, 21), None);
        assert_eq!(budget.suffices_for_power(2, u32::MAX), None);
        let base = Terms::from([
            (vec![0], ComplexRational::real(1)),
            (vec![1], ComplexRational::real(1)),
        ]);
        let mut spent = Budget {
            products: 420,
            terms: 50_000,
        };
        let power = spent.power(&base, 20, 1).expect("it suffices");
        assert_eq!((power.len(), spent.products), (21, 0));
    }

    #[test]
    fn what_is_too_large_is_not_expanded() {
        let mut e = Expressions::new();
        let mut sum = e.integer(1);
        for v in 0..8 {
            let x = e.variable(v);
            sum = e.add(sum, x);
        }
        let f = e.power(sum, 60);
        assert_eq!(Polynomial::expand(&e, f, 8, 0), None);
    }

    #[test]
    fn conjugation_exchanges_partners() {
        // i*x + y is, with x and y partners, the conjugate of x - i*y.
        let mut e = Expressions::new();
        let (x, y) = (e.variable(0), e.variable(1));
        let i = e.constant(ComplexRational::i());
        let ix = e.multiply(i, x);
        let f = e.add(ix, y);
        let iy = e.multiply(i, y);
        let g = e.subtract(x, iy);
        let expand = |n| Polynomial::expand(&e, n, 2, 0).expect("small");
        assert_eq!(expand(g).conjugate(&[1, 0]), {
            // conj(x - iy) = y + ix
            expand(f)
        });
    }
}
