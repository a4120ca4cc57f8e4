//! Power series in a few variables, cut off above an order: the arithmetic in which equations are expanded about a point.

use cognate_numeric::rational::ComplexRational;
use cognate_numeric::scalar::Complex;
use cognate_systems::expression::differentiate::below;
use cognate_systems::expression::{Dependence, Expressions, Node, NodeId};
use cognate_systems::straight_line_program::constant::algebraic;
use num_complex::Complex64;
use std::collections::HashMap;

/// All monomials of some variables up to an order, by degree, with their products.
#[derive(Clone, Debug)]
pub struct Monomials {
    /// Exponents of each monomial.
    exponents: Vec<Vec<u32>>,
    /// `first[d]` is the place of the first of degree d; one more entry for the end.
    first: Vec<usize>,
    /// Degree of each monomial.
    degree: Vec<u32>,
    /// `products[i][j]`: place of the product of i and j, for j as long as it is within the order.
    products: Vec<Vec<u32>>,
}

/// The numbers in some expressions, rounded to doubles.
#[derive(Clone, Debug)]
pub struct Constants(HashMap<NodeId, Complex64>);

impl Constants {
    /// Of all that these expressions are made of.
    pub fn of(expressions: &Expressions, roots: &[NodeId]) -> Self {
        let rounded = |c: &ComplexRational| {
            let c = Complex::<f64>::from_rational((), c);
            Complex64::new(c.re, c.im)
        };
        let constant = |id: NodeId| match expressions.node(id) {
            Node::Constant(c) => Some((id, rounded(c))),
            Node::Root(..) | Node::Function(..) => (expressions.dependence(id)
                == Dependence::Constant)
                .then(|| (id, rounded(&algebraic(expressions, id, 53)))),
            _ => None,
        };
        let nodes = below(expressions, roots).into_iter();
        Self(nodes.filter_map(constant).collect())
    }
}

/// A series: one coefficient for each monomial.
pub type Series = Vec<Complex64>;

impl Monomials {
    /// Number of monomials: binomial(variables + order, order).
    pub fn count_of(variables: usize, order: u32) -> usize {
        let mut count = 1usize;
        for k in 1..=order as usize {
            // Binomial coefficients: every division comes out even.
            count = count.saturating_mul(variables + k) / k;
        }
        count
    }

    /// All monomials up to this order, lowest degree first.
    pub fn new(variables: usize, order: u32) -> Self {
        let mut exponents = vec![vec![0; variables]];
        let mut first = vec![0, 1];
        for d in 1..=order as usize {
            // From those of one degree less: raise a variable that is not before the last raised.
            for k in first[d - 1]..first[d] {
                let from: Vec<u32> = exponents[k].clone();
                let last = from.iter().rposition(|&e| e > 0).unwrap_or(0);
                for v in last..variables {
                    let mut next = from.clone();
                    next[v] += 1;
                    exponents.push(next);
                }
            }
            first.push(exponents.len());
        }
        let place: HashMap<&[u32], u32> = exponents
            .iter()
            .enumerate()
            .map(|(k, e)| (e.as_slice(), k as u32))
            .collect();
        let degree: Vec<u32> = exponents.iter().map(|e| e.iter().sum()).collect();
        let products = exponents
            .iter()
            .zip(&degree)
            .map(|(a, &d)| {
                exponents[..first[(order - d) as usize + 1]]
                    .iter()
                    .map(|b| {
                        let sum: Vec<u32> = a.iter().zip(b).map(|(x, y)| x + y).collect();
                        place[sum.as_slice()]
                    })
                    .collect()
            })
            .collect();
        Self {
            exponents,
            first,
            degree,
            products,
        }
    }

    /// Number of monomials.
    pub fn len(&self) -> usize {
        self.exponents.len()
    }

    /// True for none, which cannot be: there is always 1.
    pub fn is_empty(&self) -> bool {
        self.exponents.is_empty()
    }

    /// Places of the monomials of this degree.
    pub fn of_degree(&self, degree: u32) -> std::ops::Range<usize> {
        self.first[degree as usize]..self.first[degree as usize + 1]
    }

    /// Degree of a monomial.
    pub fn degree(&self, place: usize) -> u32 {
        self.degree[place]
    }

    /// Place of a variable.
    pub fn variable(&self, v: usize) -> usize {
        1 + v
    }

    /// Place of the product of two, where it is within the order.
    pub fn product(&self, a: usize, b: usize) -> Option<usize> {
        self.products[a].get(b).map(|&p| p as usize)
    }

    /// The series of a number.
    pub fn number(&self, value: Complex64) -> Series {
        let mut series = vec![Complex64::default(); self.len()];
        series[0] = value;
        series
    }

    /// Product of two series.
    pub fn multiply(&self, a: &[Complex64], b: &[Complex64]) -> Series {
        let mut result = vec![Complex64::default(); self.len()];
        for (i, x) in a.iter().enumerate() {
            if x.re == 0.0 && x.im == 0.0 {
                continue;
            }
            for (&place, y) in self.products[i].iter().zip(b) {
                result[place as usize] += x * y;
            }
        }
        result
    }

    fn power(&self, base: &[Complex64], exponent: u32) -> Series {
        let mut result = self.number(Complex64::new(1.0, 0.0));
        let mut square = base.to_vec();
        let mut left = exponent;
        while left > 0 {
            if left & 1 == 1 {
                result = self.multiply(&result, &square);
            }
            left >>= 1;
            if left > 0 {
                square = self.multiply(&square, &square);
            }
        }
        result
    }

    /// The series of some expressions, when the variables have these series and the parameters
    /// these values; `constants` are those of all of them. `None` where one is divided by something with variables, or by 0.
    pub fn expand(
        &self,
        expressions: &Expressions,
        constants: &Constants,
        roots: &[NodeId],
        variables: &[Series],
        parameters: &[Complex64],
    ) -> Option<Vec<Series>> {
        let mut values: HashMap<NodeId, Series> = HashMap::new();
        for id in below(expressions, roots) {
            let node = expressions.node(id);
            let value = match node {
                // A root of what is not constant is none of them.
                Node::Constant(_) | Node::Root(..) | Node::Function(..) => {
                    self.number(*constants.0.get(&id)?)
                }
                Node::Variable(v) => variables.get(*v as usize)?.clone(),
                Node::Parameter(p) => self.number(*parameters.get(*p as usize)?),
                Node::Add(a, b) => sum(&values[a], &values[b], 1.0),
                Node::Subtract(a, b) => sum(&values[a], &values[b], -1.0),
                Node::Multiply(a, b) => self.multiply(&values[a], &values[b]),
                Node::Negate(a) => values[a].iter().map(|z| -z).collect(),
                Node::Power(a, exponent) => self.power(&values[a], *exponent),
                Node::Divide(a, b) => {
                    if expressions.dependence(*b) == Dependence::Variables {
                        return None;
                    }
                    let divisor = values[b][0];
                    if divisor.norm_sqr() == 0.0 {
                        return None;
                    }
                    values[a].iter().map(|z| z / divisor).collect()
                }
            };
            values.insert(id, value);
        }
        Some(roots.iter().map(|root| values[root].clone()).collect())
    }
}

fn sum(a: &[Complex64], b: &[Complex64], sign: f64) -> Series {
    a.iter().zip(b).map(|(x, y)| x + y * sign).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(re: f64) -> Complex64 {
        Complex64::new(re, 0.0)
    }

    #[test]
    fn monomials_are_all_there_once() {
        for (variables, order) in [(1, 6), (2, 4), (4, 5), (7, 2), (3, 0)] {
            let m = Monomials::new(variables, order);
            assert_eq!(m.len(), Monomials::count_of(variables, order));
            let mut monomials = m.exponents.clone();
            monomials.sort();
            monomials.dedup();
            assert_eq!(monomials.len(), m.len());
            assert!(m.degree.windows(2).all(|w| w[0] <= w[1]));
            for v in 0..if order > 0 { variables } else { 0 } {
                assert_eq!(m.exponents[m.variable(v)][v], 1);
                assert_eq!(m.degree(m.variable(v)), 1);
            }
        }
        let m = Monomials::new(2, 3);
        let square = m.product(1, 2).unwrap();
        assert_eq!(m.exponents[square], [1, 1]);
        assert_eq!(m.product(square, square), None, "above the order");
    }

    /// ((x + 2 y)^2 - 3) / 2 at (1 + a, -1 + b): 1/4 (a + 2b - 1)^2 ... coefficient by coefficient.
    #[test]
    fn expressions_are_expanded_about_a_point() {
        let mut e = Expressions::new();
        let (x, y) = (e.variable(0), e.variable(1));
        let two = e.integer(2);
        let three = e.integer(3);
        let root = e.root(three, (1, 2).into());
        let three = e.power(root, 2);
        let y2 = e.multiply(two, y);
        let sum = e.add(x, y2);
        let square = e.power(sum, 2);
        let difference = e.subtract(square, three);
        let p = e.parameter(0);
        let half = e.divide(difference, p);
        let f = e.negate(half);
        let m = Monomials::new(2, 2);
        let shifted = |v: usize, at: f64| {
            let mut s = m.number(number(at));
            s[m.variable(v)] = number(1.0);
            s
        };
        let at = [shifted(0, 1.0), shifted(1, -1.0)];
        let constants = Constants::of(&e, &[f]);
        let series = m.expand(&e, &constants, &[f], &at, &[number(2.0)]).unwrap();
        // -((a + 2b - 1)^2 - 3)/2 = 1 + a + 2b - a^2/2 - 2ab - 2b^2
        let expected = [1.0, 1.0, 2.0, -0.5, -2.0, -2.0];
        for (found, expected) in series[0].iter().zip(expected) {
            assert!((found - expected).norm_sqr() < 1e-28, "{series:?}");
        }
        assert_eq!(m.expand(&e, &constants, &[f], &at, &[number(0.0)]), None);
    }
}
