//! Quotient: polynomials modulo an ideal with finitely many zeros, as a vector space.

use super::groebner::{Budget, OPERATIONS_PER_TERM, Terms};
use super::monomial::Monomial;
use super::prime_field::PrimeField;
use super::residue_polynomial::{common_divisor, derivative, recurrence};
use cognate_numeric::random::{Purpose, RandomStream};
use foldhash::{HashMap, HashMapExt};
use std::collections::BTreeSet;

/// Most monomials of a basis.
const MOST_DIMENSION: usize = 2000;

/// The monomials that no leading monomial divides, and what variables make of them.
pub(in crate::polynomial) struct Quotient<'a> {
    field: PrimeField,
    variables: usize,
    basis: &'a [Terms],
    standard: Vec<Monomial>,
    place: HashMap<Monomial, usize>,
}

impl<'a> Quotient<'a> {
    /// Quotient by an ideal with finitely many zeros, from its reduced Gröbner basis; `None` if the space is too large.
    pub fn new(
        field: PrimeField,
        variables: usize,
        basis: &'a [Terms],
        budget: &mut Budget,
    ) -> Option<Self> {
        let mut monomials: BTreeSet<Monomial> = BTreeSet::new();
        let mut open = vec![Monomial::default()];
        while let Some(monomial) = open.pop() {
            budget.take(basis.len())?;
            if basis.iter().any(|terms| terms[0].0.divides(monomial)) || !monomials.insert(monomial)
            {
                continue;
            }
            if monomials.len() > MOST_DIMENSION {
                return None;
            }
            open.extend((0..variables).map(|k| monomial.times(Monomial::variable(variables, k))));
        }
        let standard: Vec<Monomial> = monomials.into_iter().collect();
        let mut place = HashMap::with_capacity(standard.len());
        place.extend(standard.iter().copied().zip(0..));
        Some(Self {
            field,
            variables,
            basis,
            standard,
            place,
        })
    }

    /// The field of the coefficients.
    pub fn field(&self) -> PrimeField {
        self.field
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
        let prime = self.field.prime();
        let mut stream = RandomStream::new(0, Purpose::Probe, self.variables as u64);
        let coefficients: Vec<u64> = (0..self.variables).map(|_| stream.below(prime)).collect();
        let form = self
            .normal_forms(budget)?
            .linear_form(&coefficients, budget)?;
        let mut stream = RandomStream::new(1, Purpose::Probe, self.dimension() as u64);
        let functional: Vec<u64> = self.standard.iter().map(|_| stream.below(prime)).collect();
        // The minimal polynomial of multiplication by the form (D. Wiedemann, Solving sparse linear equations over
        // finite fields, 1986).
        let powers = form.powers(2 * self.dimension(), budget)?;
        let values = powers
            .iter()
            .map(|power| self.field.dot(power, &functional));
        let minimal = recurrence(self.field, &values.collect::<Vec<u64>>())?;
        let common = common_divisor(
            self.field,
            minimal.clone(),
            derivative(self.field, &minimal),
        )?;
        Some(minimal.len() - common.len())
    }

    /// Computes each variable times each monomial of the basis modulo the ideal.
    pub fn normal_forms(&self, budget: &mut Budget) -> Option<NormalForms<'_>> {
        let size = self.dimension();
        let mut border: BTreeSet<Monomial> = BTreeSet::new();
        let variables = || (0..self.variables).map(|k| Monomial::variable(self.variables, k));
        for &monomial in &self.standard {
            border.extend(variables().map(|x| monomial.times(x)));
        }
        budget.take(OPERATIONS_PER_TERM / 4 * size * border.len())?;
        let leading: HashMap<Monomial, &Terms> =
            self.basis.iter().map(|terms| (terms[0].0, terms)).collect();
        // Each by what smaller ones are.
        let mut normal: HashMap<Monomial, Vec<u64>> = HashMap::new();
        for &monomial in &border {
            let mut form = vec![0u64; size];
            if let Some(&place) = self.place.get(&monomial) {
                form[place] = 1;
            } else if let Some(terms) = leading.get(&monomial) {
                for &(other, c) in &terms[1..] {
                    form[*self.place.get(&other)?] = self.field.negative(c);
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
                        let product = normal.get(&factor.times(x))?;
                        self.field.add_multiple(&mut form, c, product);
                    }
                }
            }
            normal.insert(monomial, form);
        }
        Some(NormalForms {
            quotient: self,
            normal,
        })
    }
}

/// Products of variables and monomials of the basis, modulo the ideal.
pub(in crate::polynomial) struct NormalForms<'a> {
    quotient: &'a Quotient<'a>,
    normal: HashMap<Monomial, Vec<u64>>,
}

impl NormalForms<'_> {
    /// Multiplication by the sum of the variables with these coefficients.
    pub fn linear_form(&self, coefficients: &[u64], budget: &mut Budget) -> Option<Multiplication> {
        let Quotient {
            field, variables, ..
        } = *self.quotient;
        let size = self.quotient.dimension();
        budget.take(size * size * variables)?;
        let product = |&monomial: &Monomial| {
            let mut sum = vec![0u64; size];
            for (k, &c) in coefficients.iter().enumerate().filter(|&(_, &c)| c != 0) {
                let multiple = monomial.times(Monomial::variable(variables, k));
                field.add_multiple(&mut sum, c, self.normal.get(&multiple)?);
            }
            Some(sum)
        };
        let rows: Option<Vec<Vec<u64>>> = self.quotient.standard.iter().map(product).collect();
        Some(Multiplication { field, rows: rows? })
    }
}

/// Multiplication by an element of the quotient: its product with each monomial of the basis.
pub(in crate::polynomial) struct Multiplication {
    field: PrimeField,
    pub rows: Vec<Vec<u64>>,
}

impl Multiplication {
    /// The first powers of the element, from that of exponent 0.
    pub fn powers(&self, count: usize, budget: &mut Budget) -> Option<Vec<Vec<u64>>> {
        let size = self.rows.len();
        budget.take(size.checked_pow(2)?.checked_mul(2 * count)?)?;
        // The lowest monomial of all is 1.
        let mut power = vec![0u64; size];
        power[0] = 1;
        let mut powers = Vec::with_capacity(count);
        for _ in 0..count {
            let mut next = vec![0u64; size];
            for (&c, row) in power.iter().zip(&self.rows) {
                self.field.add_multiple(&mut next, c, row);
            }
            powers.push(std::mem::replace(&mut power, next));
        }
        Some(powers)
    }
}
