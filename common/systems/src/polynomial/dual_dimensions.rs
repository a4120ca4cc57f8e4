//! Dimensions of the dual space of a system at an exact solution, over a prime field.
//!
//! The functionals of order up to k that vanish on the ideal at a point are the kernel of Macaulay's matrix: the
//! products of the equations with monomials, in powers of the distances from the point, up to degree k. Where
//! dimensions stop growing they are the multiplicity (Macaulay 1916; Dayton, Zeng: Computing the multiplicity
//! structure in solving polynomial systems, ISSAC 2005). A rank over the field is at most the rank over the rationals,
//! and the same but for primes that divide a minor, so that nothing is ever taken for simpler than it is.

use super::modular::Field;
use crate::expression::differentiate::below;
use crate::expression::{Node, NodeId};
use crate::system::System;
use cognate_numeric::rational::ComplexRational;
use foldhash::{HashMap, HashMapExt};
use std::collections::BTreeMap;

/// The second largest prime below 2^31, which is 1 modulo 4: products of residues fit in 64 bits.
pub(super) const FIELD: Field = Field {
    prime: PRIME,
    i: 629_208_553,
};
pub(super) const PRIME: u64 = 2_147_483_629;
/// Matrices with more columns than this are not made,
const MOST_COLUMNS: usize = 1200;
/// nor series for which more products of terms are taken.
const MOST_PRODUCTS: usize = 4_000_000;

/// A power series in the distances from the point, up to some degree: residues, none of them 0.
type Series = BTreeMap<Vec<u32>, u64>;

/// Dimensions of the dual space up to order `order` - 1 and `order` at a point of affine groups that solves the system;
/// `None` where that takes too much, or the equations are no polynomials with rational coefficients.
pub fn dual_dimensions(
    system: &System,
    point: &[ComplexRational],
    parameters: &[ComplexRational],
    order: u32,
) -> Option<[u32; 2]> {
    let columns = Columns::new(point.len(), order)?;
    let mut expansion = Expansion {
        order,
        products: MOST_PRODUCTS,
    };
    let equations = expansion.of_equations(system, point, parameters)?;
    let before = order.checked_sub(1)?;
    Some([
        columns.dimension(&equations, before),
        columns.dimension(&equations, order),
    ])
}

struct Expansion {
    order: u32,
    /// Products of terms that may still be taken.
    products: usize,
}

impl Expansion {
    fn of_equations(
        &mut self,
        system: &System,
        point: &[ComplexRational],
        parameters: &[ComplexRational],
    ) -> Option<Vec<Series>> {
        let n = point.len();
        let constant = |c: &ComplexRational| -> Option<Series> {
            let residue = FIELD.complex(c)?;
            let term = (residue != 0).then(|| (vec![0; n], residue));
            Some(term.into_iter().collect())
        };
        let mut done: HashMap<NodeId, Series> = HashMap::new();
        for id in below(&system.expressions, &system.equations) {
            let series = match system.expressions.node(id) {
                Node::Constant(c) => constant(c)?,
                Node::Parameter(p) => constant(parameters.get(*p as usize)?)?,
                Node::Variable(v) => {
                    let v = *v as usize;
                    let mut series = constant(point.get(v)?)?;
                    let distance = (0..n).map(|k| u32::from(k == v)).collect();
                    series.insert(distance, 1);
                    series
                }
                Node::Add(a, b) => sum(&done[a], &done[b], 1),
                Node::Subtract(a, b) => sum(&done[a], &done[b], PRIME - 1),
                Node::Negate(a) => sum(&Series::new(), &done[a], PRIME - 1),
                Node::Multiply(a, b) => self.product(&done[a], &done[b])?,
                Node::Power(a, exponent) => self.power(&done[a], *exponent, n)?,
                Node::Divide(a, b) => {
                    let (exponents, value) = done[b].first_key_value()?;
                    if done[b].len() > 1 || exponents.iter().any(|&e| e > 0) {
                        return None;
                    }
                    sum(&Series::new(), &done[a], FIELD.inverse(*value)?)
                }
                Node::Root(..) | Node::Function(..) => return None,
            };
            done.insert(id, series);
        }
        let series_of = |equation: &NodeId| done.get(equation).cloned();
        system.equations.iter().map(series_of).collect()
    }

    fn product(&mut self, a: &Series, b: &Series) -> Option<Series> {
        self.products = self
            .products
            .checked_sub(a.len().checked_mul(b.len())?.max(1))?;
        let mut product = Series::new();
        for (x, c) in a {
            let left = self.order.checked_sub(x.iter().sum())?;
            for (y, d) in b {
                if y.iter().sum::<u32>() <= left {
                    let exponents = x.iter().zip(y).map(|(&i, &j)| i + j).collect();
                    add(&mut product, exponents, c * d % PRIME);
                }
            }
        }
        Some(product)
    }

    fn power(&mut self, a: &Series, mut exponent: u32, n: usize) -> Option<Series> {
        let mut result = Series::from([(vec![0; n], 1)]);
        let mut base = a.clone();
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.product(&result, &base)?;
            }
            exponent >>= 1;
            if exponent > 0 {
                base = self.product(&base, &base)?;
            }
        }
        Some(result)
    }
}

/// a + times * b.
fn sum(a: &Series, b: &Series, times: u64) -> Series {
    let mut sum = a.clone();
    for (exponents, value) in b {
        add(&mut sum, exponents.clone(), value * times % PRIME);
    }
    sum
}

fn add(series: &mut Series, exponents: Vec<u32>, value: u64) {
    use std::collections::btree_map::Entry;
    match series.entry(exponents) {
        Entry::Vacant(place) => {
            if value != 0 {
                place.insert(value);
            }
        }
        Entry::Occupied(mut place) => match (place.get() + value) % PRIME {
            0 => {
                place.remove();
            }
            total => *place.get_mut() = total,
        },
    }
}

/// The monomials up to a degree, the lower degrees first, by their exponents.
struct Columns {
    place: BTreeMap<Vec<u32>, usize>,
    monomials: Vec<Vec<u32>>,
}

impl Columns {
    fn new(variables: usize, order: u32) -> Option<Self> {
        let mut monomials = vec![vec![0; variables]];
        let mut last = 0..1;
        for _ in 0..order {
            let end = monomials.len();
            for k in last {
                let monomial: Vec<u32> = monomials[k].clone();
                // Each monomial once: from the one without its last factor.
                let least = monomial.iter().rposition(|&e| e > 0).unwrap_or(0);
                for v in least..variables {
                    let mut next = monomial.clone();
                    next[v] += 1;
                    monomials.push(next);
                }
                if monomials.len() > MOST_COLUMNS {
                    return None;
                }
            }
            last = end..monomials.len();
        }
        let place = monomials.iter().cloned().zip(0..).collect();
        Some(Self { place, monomials })
    }

    /// Monomials up to the order, without the rank of the equations' multiples up to it.
    fn dimension(&self, equations: &[Series], order: u32) -> u32 {
        let degree = |monomial: &Vec<u32>| monomial.iter().sum::<u32>();
        let width = self.monomials.partition_point(|m| degree(m) <= order);
        let mut rows: Vec<Option<Vec<u64>>> = vec![None; width];
        let mut rank = 0;
        for factor in self.monomials[..width].iter().filter(|m| degree(m) < order) {
            for equation in equations {
                let mut row = vec![0u64; width];
                for (exponents, value) in equation {
                    let product = exponents.iter().zip(factor).map(|(&i, &j)| i + j);
                    if let Some(&place) = self.place.get(&product.collect::<Vec<_>>())
                        && place < width
                    {
                        row[place] = *value;
                    }
                }
                rank += u32::from(reduce(row, &mut rows));
            }
        }
        width as u32 - rank
    }
}

/// Takes a row among those with a leading 1 each, at its place; false where it is a combination of them.
fn reduce(mut row: Vec<u64>, rows: &mut [Option<Vec<u64>>]) -> bool {
    for place in 0..row.len() {
        let value = row[place];
        if value == 0 {
            continue;
        }
        match &rows[place] {
            Some(pivot_row) => {
                let times = PRIME - value;
                for (x, k) in row[place..].iter_mut().zip(&pivot_row[place..]) {
                    *x = (*x + times * k) % PRIME;
                }
            }
            None => {
                let Some(inverse) = FIELD.inverse(value) else {
                    continue;
                };
                for x in &mut row[place..] {
                    *x = *x * inverse % PRIME;
                }
                rows[place] = Some(row);
                return true;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::rational::Rational;

    fn dimensions(text: &str, point: &[(i32, i32)], order: u32) -> Option<[u32; 2]> {
        let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
        let read = crate::formats::read("test", text.as_bytes());
        let system = read.expect("a problem of this test").system;
        let number = |&(p, q): &(i32, i32)| ComplexRational::real(Rational::from((p, q)));
        let point: Vec<_> = point.iter().map(number).collect();
        dual_dimensions(&system, &point, &[], order)
    }

    #[test]
    fn the_square_of_i_is_the_negative_of_one() {
        assert_eq!(FIELD.mul(FIELD.i, FIELD.i), PRIME - 1);
    }

    #[test]
    fn multiplicities_are_exact() {
        // Two roots 1e-13 apart, at one of them.
        let near = "variable_group x, y; function f, g; \
                    f = (4*x - 5)*(x - y/1000); g = (y + 1)*(y + 1 - 1/10000000000000);";
        assert_eq!(dimensions(near, &[(5, 4), (-1, 1)], 2), Some([1, 1]));
        let double = near.replace("(y + 1 - 1/10000000000000)", "(y + 1)");
        assert_eq!(dimensions(&double, &[(5, 4), (-1, 1)], 2), Some([2, 2]));
        // A double root and a simple one beside it.
        let beside = near.replace("g = ", "g = (y + 1)*");
        assert_eq!(dimensions(&beside, &[(5, 4), (-1, 1)], 3), Some([2, 2]));
        // x^2 + y^2, x^3 (Dayton, Zeng): multiplicity 6; and the cusp on a line: 3.
        let six = "variable_group x, y; function f, g; f = x^2 + y^2; g = x^3;";
        assert_eq!(dimensions(six, &[(0, 1), (0, 1)], 4), Some([6, 6]));
        let cusp = "variable_group x, y; function f, g; f = y^2 - x^3; g = y - 2*x/3 + x;";
        assert_eq!(dimensions(cusp, &[(0, 1), (0, 1)], 2), Some([2, 2]));
        // A line of solutions.
        let line = "variable_group x, y; function f, g; f = x*y; g = x*(x - 3);";
        assert_eq!(dimensions(line, &[(0, 1), (5, 1)], 4), Some([4, 5]));
        assert_eq!(dimensions(line, &[(0, 1), (5, 1)], 48), None, "too large");
    }
}
