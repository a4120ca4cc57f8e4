//! Quotient: polynomials modulo an ideal with finitely many zeros, as a vector space.

use super::groebner::{Budget, OPERATIONS_PER_TERM, Terms};
use super::monomial::Monomial;
use crate::polynomial::dual_dimensions::{FIELD, PRIME};
use cognate_numeric::random::{Purpose, RandomStream};
use foldhash::{HashMap, HashMapExt};
use std::collections::BTreeSet;

/// Most monomials of a basis.
const MOST_DIMENSION: usize = 2000;

/// The monomials that no leading monomial divides, and what variables make of them.
pub(super) struct Quotient<'a> {
    variables: usize,
    basis: &'a [Terms],
    standard: Vec<Monomial>,
    place: HashMap<Monomial, usize>,
}

impl<'a> Quotient<'a> {
    /// By a reduced Gröbner basis of an ideal with finitely many zeros; `None` where the space is too large.
    pub fn new(variables: usize, basis: &'a [Terms], budget: &mut Budget) -> Option<Self> {
        let mut known: BTreeSet<Monomial> = BTreeSet::new();
        let mut open = vec![Monomial::default()];
        while let Some(monomial) = open.pop() {
            budget.take(basis.len())?;
            if basis.iter().any(|terms| terms[0].0.divides(monomial)) || !known.insert(monomial) {
                continue;
            }
            if known.len() > MOST_DIMENSION {
                return None;
            }
            open.extend((0..variables).map(|k| monomial.times(Monomial::variable(variables, k))));
        }
        let standard: Vec<Monomial> = known.into_iter().collect();
        let mut place = HashMap::with_capacity(standard.len());
        place.extend(standard.iter().copied().zip(0..));
        Some(Self {
            variables,
            basis,
            standard,
            place,
        })
    }

    /// The dimension of the space: the number of zeros with their multiplicities.
    pub fn dimension(&self) -> usize {
        self.standard.len()
    }

    /// The number of zeros, each once: of different values of a random linear form at them. `None` where that takes
    /// more than the budget.
    pub fn distinct_zeros(&self, budget: &mut Budget) -> Option<usize> {
        if self.standard.is_empty() {
            return Some(0);
        }
        let products = self.products(budget)?;
        let minimal = self.minimal_polynomial(&products, budget)?;
        let derivative: Vec<u64> = (1..)
            .zip(&minimal[1..])
            .map(|(k, &c)| k % PRIME * c % PRIME)
            .collect();
        let common = common_divisor(minimal.clone(), derivative)?;
        Some(minimal.len() - common.len())
    }

    /// A random linear form times each monomial of the basis.
    fn products(&self, budget: &mut Budget) -> Option<Vec<Vec<u64>>> {
        let size = self.dimension();
        let mut border: BTreeSet<Monomial> = BTreeSet::new();
        let variables = || (0..self.variables).map(|k| Monomial::variable(self.variables, k));
        for &monomial in &self.standard {
            border.extend(variables().map(|x| monomial.times(x)));
        }
        budget.take(OPERATIONS_PER_TERM / 4 * size * border.len())?;
        let leading: HashMap<Monomial, &Terms> =
            self.basis.iter().map(|terms| (terms[0].0, terms)).collect();
        // What each monomial is modulo the ideal, by what smaller ones are.
        let mut normal: HashMap<Monomial, Vec<u64>> = HashMap::new();
        for &monomial in &border {
            let mut form = vec![0u64; size];
            if let Some(&place) = self.place.get(&monomial) {
                form[place] = 1;
            } else if let Some(terms) = leading.get(&monomial) {
                for (other, c) in &terms[1..] {
                    form[*self.place.get(other)?] = PRIME - c;
                }
            } else {
                let contains = |&k: &usize| monomial.exponent(self.variables, k) > 0;
                let (x, smaller) = (0..self.variables).filter(contains).find_map(|k| {
                    let x = Monomial::variable(self.variables, k);
                    let smaller = monomial.over(x);
                    (!self.place.contains_key(&smaller)).then_some((x, smaller))
                })?;
                for (&c, &factor) in normal.get(&smaller)?.iter().zip(&self.standard) {
                    if c != 0 {
                        budget.take(size)?;
                        add(&mut form, c, normal.get(&factor.times(x))?);
                    }
                }
            }
            normal.insert(monomial, form);
        }
        let mut stream = RandomStream::new(0, Purpose::Probe, self.variables as u64);
        let coefficients: Vec<u64> = (0..self.variables).map(|_| stream.below(PRIME)).collect();
        let product = |&monomial: &Monomial| {
            let mut sum = vec![0u64; size];
            for (x, &c) in variables().zip(&coefficients) {
                add(&mut sum, c, normal.get(&monomial.times(x))?);
            }
            Some(sum)
        };
        budget.take(size * size * self.variables)?;
        self.standard.iter().map(product).collect()
    }

    /// The minimal polynomial of multiplication by the form, lowest coefficient first: of a random functional of its
    /// powers (D. Wiedemann, Solving sparse linear equations over finite fields, 1986).
    fn minimal_polynomial(&self, products: &[Vec<u64>], budget: &mut Budget) -> Option<Vec<u64>> {
        let size = self.dimension();
        budget.take(size.checked_pow(2)?.checked_mul(4 * size)?)?;
        let mut stream = RandomStream::new(1, Purpose::Probe, size as u64);
        let functional: Vec<u64> = (0..size).map(|_| stream.below(PRIME)).collect();
        // The lowest monomial of all is 1.
        let mut power = vec![0u64; size];
        power[0] = 1;
        let mut sequence = Vec::with_capacity(2 * size);
        for _ in 0..2 * size {
            let value = power.iter().zip(&functional);
            sequence.push(value.fold(0, |sum, (&a, &b)| (sum + a * b) % PRIME));
            let mut next = vec![0u64; size];
            for (&c, product) in power.iter().zip(products) {
                add(&mut next, c, product);
            }
            power = next;
        }
        recurrence(&sequence)
    }
}

/// sum + c * row.
fn add(sum: &mut [u64], c: u64, row: &[u64]) {
    if c != 0 {
        sum.iter_mut()
            .zip(row)
            .for_each(|(sum, &x)| *sum = (*sum + c * x) % PRIME);
    }
}

/// The characteristic polynomial of the shortest linear recurrence of a sequence, lowest coefficient first
/// (J. L. Massey, Shift-register synthesis and BCH decoding, 1969).
fn recurrence(sequence: &[u64]) -> Option<Vec<u64>> {
    let mut connection = vec![1u64];
    let mut before = vec![1u64];
    let (mut length, mut since, mut last) = (0usize, 1usize, 1u64);
    for n in 0..sequence.len() {
        let terms = connection.iter().zip(sequence[..=n].iter().rev());
        let discrepancy = terms.fold(0, |sum, (&c, &s)| (sum + c * s) % PRIME);
        if discrepancy == 0 {
            since += 1;
            continue;
        }
        let times = PRIME - discrepancy * FIELD.inverse(last)? % PRIME;
        let mut next = connection.clone();
        next.resize(next.len().max(before.len() + since), 0);
        add(&mut next[since..since + before.len()], times, &before);
        if 2 * length <= n {
            (before, last) = (connection, discrepancy);
            (length, since) = (n + 1 - length, 1);
        } else {
            since += 1;
        }
        connection = next;
    }
    connection.resize(length + 1, 0);
    connection.reverse();
    Some(connection)
}

/// The greatest common divisor of two polynomials, lowest coefficient first.
fn common_divisor(mut a: Vec<u64>, mut b: Vec<u64>) -> Option<Vec<u64>> {
    let trim = |p: &mut Vec<u64>| {
        while p.last() == Some(&0) {
            p.pop();
        }
    };
    trim(&mut a);
    trim(&mut b);
    while let Some(&leading) = b.last() {
        let inverse = FIELD.inverse(leading)?;
        while a.len() >= b.len() {
            let times = a.last()? * inverse % PRIME;
            let shift = a.len() - b.len();
            add(&mut a[shift..], PRIME - times, &b);
            trim(&mut a);
            if a.is_empty() {
                break;
            }
        }
        std::mem::swap(&mut a, &mut b);
    }
    Some(a)
}
