//! Gröbner bases over a prime field, by elimination on matrices.
//!
//! J.-C. Faugère, A new efficient algorithm for computing Gröbner bases (F4), 1999; pairs are left out by R. Gebauer,
//! H. M. Möller, On an installation of Buchberger's algorithm, 1988.

use super::monomial::Monomial;
use super::prime_field::PrimeField;
use cognate_numeric::interruption::count_work;
use foldhash::{HashMap, HashMapExt, HashSet};
use std::collections::{BTreeMap, BTreeSet};

/// Residues by monomials, the highest first, none of them 0.
pub(in crate::polynomial) type Terms = Vec<(Monomial, u64)>;

/// Operations that may still be done.
pub(in crate::polynomial) struct Budget(pub u64);

/// Operations that a stored term counts as: the budget of operations bounds memory, too.
pub(in crate::polynomial) const OPERATIONS_PER_TERM: usize = 32;

impl Budget {
    /// `None` where too few are left.
    pub fn take(&mut self, operations: usize) -> Option<()> {
        self.0 = self.0.checked_sub(operations as u64)?;
        (!count_work(operations as u64)).then_some(())
    }
}

/// Two elements whose leading terms are to cancel.
#[derive(Clone, Copy)]
struct Pair {
    elements: [usize; 2],
    multiple: Monomial,
}

struct Element {
    /// Terms of the element; the leading coefficient is 1.
    terms: Terms,
    /// Whether the leading monomial of the element is a multiple of the leading monomial of a later one.
    redundant: bool,
}

impl Element {
    fn lead(&self) -> Monomial {
        self.terms[0].0
    }
}

struct Basis {
    field: PrimeField,
    elements: Vec<Element>,
    pairs: Vec<Pair>,
}

/// The reduced Gröbner basis of an ideal, ascending by leading monomials; `None` where it takes more than the budget,
/// or degrees that are too high.
pub(in crate::polynomial) fn groebner_basis(
    field: PrimeField,
    mut given: Vec<Terms>,
    budget: &mut Budget,
) -> Option<Vec<Terms>> {
    let mut basis = Basis {
        field,
        elements: Vec::new(),
        pairs: Vec::new(),
    };
    given.retain(|terms| !terms.is_empty());
    loop {
        let of_pairs = basis.pairs.iter().map(|pair| pair.multiple.degree());
        let of_given = given.iter().map(|terms| terms[0].0.degree());
        let Some(degree) = of_pairs.chain(of_given).min() else {
            return basis.reduced(budget);
        };
        let (now, later) = given
            .into_iter()
            .partition(|terms| terms[0].0.degree() == degree);
        given = later;
        let of_pairs = basis.rows_of_degree(degree, budget)?;
        let mut new_elements = basis.eliminate(of_pairs, now, budget)?;
        new_elements.sort_by_key(|terms| terms[0].0);
        for terms in new_elements {
            basis.add(terms, budget)?;
        }
    }
}

impl Basis {
    /// Makes the rows for the pairs of a degree: multiples of elements, at least two with each leading monomial.
    fn rows_of_degree(
        &mut self,
        degree: u32,
        budget: &mut Budget,
    ) -> Option<BTreeMap<Monomial, Vec<Terms>>> {
        let (now, later): (Vec<Pair>, Vec<Pair>) = self
            .pairs
            .iter()
            .partition(|pair| pair.multiple.degree() == degree);
        self.pairs = later;
        let halves = now
            .iter()
            .flat_map(|pair| pair.elements.map(|element| (pair.multiple, element)));
        let halves: BTreeSet<(Monomial, usize)> = halves.collect();
        let mut rows: BTreeMap<Monomial, Vec<Terms>> = BTreeMap::new();
        for (multiple, element) in halves {
            let row = self.multiple_of(element, multiple, budget)?;
            rows.entry(multiple).or_default().push(row);
        }
        Some(rows)
    }

    /// An element times what makes its leading monomial this one.
    fn multiple_of(&self, element: usize, lead: Monomial, budget: &mut Budget) -> Option<Terms> {
        let element = &self.elements[element];
        let factor = lead.over(element.lead());
        budget.take(OPERATIONS_PER_TERM * element.terms.len())?;
        let terms = element.terms.iter();
        Some(terms.map(|&(m, c)| (m.times(factor), c)).collect())
    }

    /// Reduces the rows of pairs and of equations by multiples of elements and by each other; the rows that are left
    /// have new leading monomials.
    fn eliminate(
        &self,
        of_pairs: BTreeMap<Monomial, Vec<Terms>>,
        mut others: Vec<Terms>,
        budget: &mut Budget,
    ) -> Option<Vec<Terms>> {
        let mut columns = Columns::default();
        let mut reducers: Vec<Terms> = Vec::new();
        for (lead, mut rows) in of_pairs {
            // The shortest takes the leading monomial away from the others.
            rows.sort_by_key(Vec::len);
            columns.reduced(lead);
            let mut rows = rows.into_iter();
            reducers.extend(rows.next());
            others.extend(rows);
        }
        reducers
            .iter()
            .chain(&others)
            .for_each(|row| columns.see(row));
        self.reducers_of(&mut columns, &mut reducers, budget)?;
        Matrix::new(self.field, &columns, &reducers).reduce(&others, budget)
    }

    /// Adds a multiple of an element for each monomial seen that one's leading monomial divides.
    fn reducers_of(
        &self,
        columns: &mut Columns,
        reducers: &mut Vec<Terms>,
        budget: &mut Budget,
    ) -> Option<()> {
        while let Some(monomial) = columns.open.pop() {
            budget.take(self.elements.len())?;
            let divides =
                |element: &Element| !element.redundant && element.lead().divides(monomial);
            let Some(element) = self.elements.iter().position(divides) else {
                continue;
            };
            let row = self.multiple_of(element, monomial, budget)?;
            columns.see(&row);
            reducers.push(row);
        }
        Some(())
    }

    /// A new element, and its pairs that are not superfluous.
    fn add(&mut self, terms: Terms, budget: &mut Budget) -> Option<()> {
        let new = self.elements.len();
        let lead = terms[0].0;
        budget.take(8 * (self.pairs.len() + new * new.min(64)))?;
        let with: Vec<Option<Monomial>> = self
            .elements
            .iter()
            .map(|element| element.lead().common_multiple(lead))
            .collect();
        self.pairs.retain(|pair| {
            let differs = |element: usize| with[element] != Some(pair.multiple);
            !(lead.divides(pair.multiple) && pair.elements.iter().all(|&element| differs(element)))
        });
        let mut candidates: BTreeMap<Monomial, (usize, bool)> = BTreeMap::new();
        for (k, element) in self
            .elements
            .iter()
            .enumerate()
            .filter(|(_, element)| !element.redundant)
        {
            // Of pairs with one common multiple one will do, none where leading monomials of one are coprime.
            let entry = candidates.entry(with[k]?).or_insert((k, false));
            entry.1 |= element.lead().is_coprime_to(lead);
        }
        let multiples: Vec<Monomial> = candidates.keys().copied().collect();
        for (multiple, (k, coprime)) in candidates {
            let smaller = multiples.iter().take_while(|&&other| other < multiple);
            if !coprime && !smaller.into_iter().any(|other| other.divides(multiple)) {
                self.pairs.push(Pair {
                    elements: [k, new],
                    multiple,
                });
            }
        }
        for element in &mut self.elements {
            element.redundant |= lead.divides(element.lead());
        }
        self.elements.push(Element {
            terms,
            redundant: false,
        });
        Some(())
    }

    /// The elements that are needed, none of whose other monomials is a multiple of a leading one.
    fn reduced(mut self, budget: &mut Budget) -> Option<Vec<Terms>> {
        self.elements.retain(|element| !element.redundant);
        // The lowest first: it takes its leading monomial away from the others.
        self.elements.sort_by_key(Element::lead);
        let mut columns = Columns::default();
        let mut reducers = Vec::new();
        self.elements
            .iter()
            .for_each(|element| columns.reduced(element.lead()));
        self.elements
            .iter()
            .for_each(|element| columns.see(&element.terms));
        self.reducers_of(&mut columns, &mut reducers, budget)?;
        let rows: Vec<Terms> = self
            .elements
            .into_iter()
            .map(|element| element.terms)
            .collect();
        Matrix::new(self.field, &columns, &reducers).reduce(&rows, budget)
    }
}

/// The monomials of a matrix.
#[derive(Default)]
struct Columns {
    all: HashSet<Monomial>,
    /// Monomials of which it is not known yet whether an element takes them away.
    open: Vec<Monomial>,
}

impl Columns {
    /// A monomial that needs no multiple of an element.
    fn reduced(&mut self, monomial: Monomial) {
        self.all.insert(monomial);
    }

    fn see(&mut self, row: &Terms) {
        for &(monomial, _) in row {
            if self.all.insert(monomial) {
                self.open.push(monomial);
            }
        }
    }
}

/// Rows by columns, the highest monomial first.
struct Matrix {
    field: PrimeField,
    monomials: Vec<Monomial>,
    place: HashMap<Monomial, usize>,
    /// The row that takes a column away: places and residues, the first of which is 1.
    pivots: Vec<Option<Vec<(usize, u64)>>>,
}

impl Matrix {
    fn new(field: PrimeField, columns: &Columns, reducers: &[Terms]) -> Self {
        let mut monomials: Vec<Monomial> = columns.all.iter().copied().collect();
        monomials.sort_unstable_by(|a, b| b.cmp(a));
        let mut place = HashMap::with_capacity(monomials.len());
        place.extend(monomials.iter().copied().zip(0..));
        let mut matrix = Self {
            field,
            pivots: vec![None; monomials.len()],
            monomials,
            place,
        };
        for row in reducers {
            let row = matrix.places(row);
            let lead = row[0].0;
            matrix.pivots[lead] = Some(row);
        }
        matrix
    }

    fn places(&self, row: &Terms) -> Vec<(usize, u64)> {
        row.iter()
            .map(|&(monomial, c)| (self.place[&monomial], c))
            .collect()
    }

    /// Reduces rows by the rows of the matrix, and scales each row that is left to leading coefficient 1.
    fn reduce(mut self, rows: &[Terms], budget: &mut Budget) -> Option<Vec<Terms>> {
        let field = self.field;
        let square = field.prime() * field.prime();
        let mut left = Vec::new();
        let mut dense = vec![0u64; self.monomials.len()];
        for row in rows {
            let row = self.places(row);
            let first = row[0].0;
            row.iter().for_each(|&(place, c)| dense[place] = c);
            budget.take(dense.len() - first)?;
            let mut remaining = Vec::new();
            for place in first..dense.len() {
                let value = field.reduce(std::mem::take(&mut dense[place]));
                match &self.pivots[place] {
                    _ if value == 0 => {}
                    None => remaining.push((place, value)),
                    Some(pivot) => {
                        budget.take(pivot.len())?;
                        let times = field.prime() - value;
                        for &(at, c) in &pivot[1..] {
                            // Below the square of the prime before and after.
                            let sum = dense[at] + times * c;
                            dense[at] = if sum >= square { sum - square } else { sum };
                        }
                    }
                }
            }
            let Some(&(lead, value)) = remaining.first() else {
                continue;
            };
            let inverse = field.inverse(value)?;
            budget.take(OPERATIONS_PER_TERM * remaining.len())?;
            remaining
                .iter_mut()
                .for_each(|(_, c)| *c = field.multiply(*c, inverse));
            let terms = remaining
                .iter()
                .map(|&(place, c)| (self.monomials[place], c));
            left.push(terms.collect());
            self.pivots[lead] = Some(remaining);
        }
        Some(left)
    }
}
