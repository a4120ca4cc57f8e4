//! Points where a polynomial has an inverse: the determinant of the Jacobian at nonsingular ones, denominators at
//! those where fractions have a value.

use super::groebner::{Budget, OPERATIONS_PER_TERM, Terms};
use super::monomial::{MOST_DEGREE, MOST_VARIABLES, Monomial};
use crate::polynomial::dual_dimensions::PRIME;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// The equations, and in one more variable, which comes first, that it times the determinant of their Jacobian is 1
/// (J. L. Rabinowitsch, Zum Hilbertschen Nullstellensatz, 1929). `None` where there are not as many equations as
/// variables, or it takes more than the budget.
pub(super) fn with_inverse_of_determinant(
    variables: usize,
    mut equations: Vec<Terms>,
    budget: &mut Budget,
) -> Option<Vec<Terms>> {
    if equations.len() != variables || variables == MOST_VARIABLES {
        return None;
    }
    let determinant = jacobian_determinant(variables, &equations, budget)?;
    equations.push(inverse_of(&determinant, variables, PRIME)?);
    Some(equations)
}

/// The equation that a polynomial times one more variable, which comes first, is 1. `None` past the highest degree.
fn inverse_of(polynomial: &Terms, variables: usize, prime: u64) -> Option<Terms> {
    if variables >= MOST_VARIABLES {
        return None;
    }
    // Words of monomials stay what they are with a variable before the others.
    let inverse = Monomial::variable(variables + 1, 0);
    let highest = polynomial.first().map_or(0, |(m, _)| m.degree());
    if highest >= MOST_DEGREE {
        return None;
    }
    let terms = polynomial
        .iter()
        .map(|&(monomial, c)| (monomial.times(inverse), c));
    let mut product: Terms = terms.collect();
    product.push((Monomial::default(), prime - 1));
    Some(product)
}

/// The equations, and that each of some polynomials has an inverse, a variable for each of them; how many variables
/// there are then. `None` where there are too many.
pub(in crate::polynomial) fn with_inverses(
    prime: u64,
    mut variables: usize,
    mut equations: Vec<Terms>,
    polynomials: &[Terms],
) -> Option<(usize, Vec<Terms>)> {
    for polynomial in polynomials {
        equations.push(inverse_of(polynomial, variables, prime)?);
        variables += 1;
    }
    Some((variables, equations))
}

/// Computes the determinant by minors of the first rows, each from those of one row less.
fn jacobian_determinant(n: usize, equations: &[Terms], budget: &mut Budget) -> Option<Terms> {
    let mut minors = BTreeMap::from([(0u32, vec![(Monomial::default(), 1)])]);
    for equation in equations {
        let mut next: BTreeMap<u32, Terms> = BTreeMap::new();
        for k in 0..n {
            let entry = derivative(n, equation, k);
            for (&columns, minor) in minors.iter().filter(|&(columns, _)| columns >> k & 1 == 0) {
                let odd = (columns >> k).count_ones() % 2 == 1;
                let sum = next.entry(columns | 1 << k).or_default();
                *sum = sum_with_product(sum, minor, &entry, odd, budget)?;
            }
        }
        minors = next;
    }
    minors.into_values().next()
}

fn derivative(n: usize, terms: &Terms, k: usize) -> Terms {
    let x = Monomial::variable(n, k);
    let of_term = |&(monomial, c): &(Monomial, u64)| {
        let exponent = u64::from(monomial.exponent(n, k));
        (exponent > 0).then(|| (monomial.over(x), c * exponent % PRIME))
    };
    terms.iter().filter_map(of_term).collect()
}

/// sum + a b, or sum - a b.
fn sum_with_product(
    sum: &Terms,
    a: &Terms,
    b: &Terms,
    subtract: bool,
    budget: &mut Budget,
) -> Option<Terms> {
    budget.take(OPERATIONS_PER_TERM * a.len().checked_mul(b.len())?)?;
    let highest = |terms: &Terms| terms.first().map_or(0, |(monomial, _)| monomial.degree());
    if highest(a) + highest(b) >= MOST_DEGREE {
        return None;
    }
    let mut terms: BTreeMap<Reverse<Monomial>, u64> = sum
        .iter()
        .map(|&(monomial, c)| (Reverse(monomial), c))
        .collect();
    for &(x, c) in a {
        let c = if subtract { PRIME - c } else { c };
        for &(y, d) in b {
            let place = terms.entry(Reverse(x.times(y))).or_default();
            *place = (*place + c * d) % PRIME;
        }
    }
    let terms = terms.into_iter().filter(|&(_, c)| c != 0);
    Some(terms.map(|(Reverse(monomial), c)| (monomial, c)).collect())
}
