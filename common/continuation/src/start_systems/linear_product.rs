//! Linear-product start system: each equation a product of linear forms, each in a set of variables.
//!
//! Where the monomials of an equation are among those of its product, all
//! isolated solutions are reached from the regular solutions of the products
//! (Verschelde, Cools 1993; Morgan, Sommese, Wampler: A product-decomposition
//! bound for Bezout numbers, 1995; POLSYS_PLP: Wise, Sommese, Watson 2000). A
//! choice of one factor of each equation has one where its sets have distinct
//! representatives (Hall).

use crate::chart::{Chart, exact};
use cognate_numeric::interruption::count_work;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_systems::expression::{Expressions, NodeId};
use num_complex::Complex64;

/// `structure[equation][factor]`: the variables of the factor, ascending. Constants belong to all.
pub type SetStructure = Vec<Vec<Vec<u32>>>;

/// Most choices that are kept: one entry for equal factors.
const MOST_CHOICES: usize = 1 << 20;
/// Operations that one step of the search among the choices takes, about.
const OPERATIONS_PER_STEP: u64 = 8;
/// Random orders in which the monomials of an equation are put into sets.
const ORDERS: u64 = 12;
/// Structures of one equation that the guess compares by their count.
const CANDIDATES: usize = 5;

/// Most steps for the choices of a system that is solved.
pub const SOLVING_STEPS: u64 = 200_000_000;

/// Reason why there is no start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinearProductError {
    /// Sets that name no variables of the system, or another number of equations.
    #[error("the sets do not fit the system: one list of sets of its variables for each equation")]
    Shape,
    /// A monomial of the equation is not one of the product.
    #[error("equation {} has a monomial that the product of its sets does not have", .0 + 1)]
    NotCovered(usize),
    /// Counting takes too long, or there are too many choices.
    #[error("counting the choices of factors takes too long")]
    TooLong,
}

/// The choices of one factor of each equation that have a solution.
#[derive(Clone, Debug)]
struct Choices {
    /// Factors with the same set, for each equation and each of its different sets.
    equal: Vec<Vec<Vec<u32>>>,
    /// The chosen sets, choice after choice.
    sets: Vec<u16>,
    /// Number of solutions before each choice, and of all.
    offsets: Vec<u64>,
}

/// A search for choices, with a matching of equations to variables.
struct Search<'a> {
    masks: &'a [Vec<u128>],
    equal: &'a [Vec<Vec<u32>>],
    steps: u64,
    chosen: Vec<u16>,
    sets: Vec<u16>,
    offsets: Vec<u64>,
}

impl Search<'_> {
    /// Finds a variable for equation `row`, moving others; `owner[variable]` is the equation + 1.
    fn augment(&mut self, row: usize, owner: &mut [u16], tried: &mut u128) -> Option<bool> {
        self.steps = self.steps.checked_sub(1)?;
        if count_work(OPERATIONS_PER_STEP) {
            return None;
        }
        let mask = self.masks[row][self.chosen[row] as usize];
        let mut left = mask & !*tried;
        while left != 0 {
            let variable = left.trailing_zeros() as usize;
            *tried |= 1 << variable;
            let before = owner[variable];
            if before == 0 || self.augment(usize::from(before) - 1, owner, tried)? {
                owner[variable] = row as u16 + 1;
                return Some(true);
            }
            left = mask & !*tried;
        }
        Some(false)
    }

    fn run(&mut self, row: usize, owner: &[u16], weight: u64) -> Option<()> {
        if row == self.masks.len() {
            if self.offsets.len() > MOST_CHOICES {
                return None;
            }
            self.sets.extend_from_slice(&self.chosen);
            let sum = self.offsets.last().copied().unwrap_or(0);
            self.offsets.push(sum.checked_add(weight)?);
            return Some(());
        }
        for set in 0..self.masks[row].len() {
            self.chosen.push(set as u16);
            let mut owner = owner.to_vec();
            if self.augment(row, &mut owner, &mut 0)? {
                let factors = self.equal[row][set].len() as u64;
                self.run(row + 1, &owner, weight.checked_mul(factors)?)?;
            }
            self.chosen.pop();
        }
        Some(())
    }
}

impl Choices {
    /// All choices; `None` where they take more steps.
    fn new(structure: &SetStructure, variables: usize, steps: u64) -> Option<Self> {
        let mut masks = Vec::new();
        let mut equal = Vec::new();
        for factors in structure {
            let mut different: Vec<u128> = Vec::new();
            let mut of_set: Vec<Vec<u32>> = Vec::new();
            for (number, set) in factors.iter().enumerate() {
                let mask = set.iter().fold(0u128, |mask, &v| mask | 1 << v);
                match different.iter().position(|&other| other == mask) {
                    Some(place) => of_set[place].push(number as u32),
                    None => {
                        different.push(mask);
                        of_set.push(vec![number as u32]);
                    }
                }
            }
            masks.push(different);
            equal.push(of_set);
        }
        let mut search = Search {
            masks: &masks,
            equal: &equal,
            steps,
            chosen: Vec::new(),
            sets: Vec::new(),
            offsets: vec![0],
        };
        search.run(0, &vec![0; variables], 1)?;
        let (sets, offsets) = (search.sets, search.offsets);
        Some(Self {
            equal,
            sets,
            offsets,
        })
    }

    fn count(&self) -> u64 {
        self.offsets.last().copied().unwrap_or(0)
    }

    /// The factor of each equation in choice number `index`.
    fn factors(&self, index: u64) -> Vec<u32> {
        let n = self.equal.len();
        let place = self.offsets.partition_point(|&offset| offset <= index) - 1;
        let mut rest = index - self.offsets[place];
        let sets = &self.sets[place * n..(place + 1) * n];
        sets.iter()
            .zip(&self.equal)
            .map(|(&set, equal)| {
                let factors = &equal[usize::from(set)];
                let size = factors.len() as u64;
                let factor = factors[(rest % size) as usize];
                rest /= size;
                factor
            })
            .collect()
    }
}

/// Number of start points of a structure; `None` where counting takes more steps.
pub fn count(structure: &SetStructure, variables: usize, steps: u64) -> Option<u64> {
    Choices::new(structure, variables, steps).map(|choices| choices.count())
}

/// The start system and its solutions by index.
#[derive(Clone, Debug)]
pub struct LinearProduct {
    choices: Choices,
    /// `forms[equation][factor]`: coefficients in the homogeneous coordinates.
    forms: Vec<Vec<Vec<Complex64>>>,
}

impl LinearProduct {
    /// Random forms in these sets, for a system in one affine group whose variables stand in
    /// order. Counted with at most `steps` steps.
    ///
    /// # Errors
    /// When the sets do not fit the number of variables, or counting takes too long.
    pub fn new(
        structure: &SetStructure,
        variables: usize,
        seed: u64,
        steps: u64,
    ) -> Result<Self, LinearProductError> {
        check_sets(structure, variables)?;
        let choices =
            Choices::new(structure, variables, steps).ok_or(LinearProductError::TooLong)?;
        let mut number = 0;
        let mut form = |set: &Vec<u32>| {
            let mut stream = RandomStream::new(seed, Purpose::StartSystem, number);
            number += 1;
            let mut form = vec![Complex64::default(); variables + 1];
            form[0] = stream.unit();
            for &v in set {
                form[v as usize + 1] = stream.unit();
            }
            form
        };
        let forms = structure
            .iter()
            .map(|factors| factors.iter().map(&mut form).collect())
            .collect();
        Ok(Self { choices, forms })
    }

    /// Number of start points.
    pub fn count(&self) -> u64 {
        self.choices.count()
    }

    /// The equations over the homogeneous coordinates.
    pub fn equations(&self, out: &mut Expressions, coordinates: &[NodeId]) -> Vec<NodeId> {
        self.forms
            .iter()
            .map(|factors| {
                let mut product = out.integer(1);
                for form in factors {
                    let form = linear_form(out, form, coordinates);
                    product = out.multiply(product, form);
                }
                product
            })
            .collect()
    }

    /// Start point number `index`: where the chosen factor of each equation vanishes; `None`
    /// where it lies outside the patch.
    pub fn point(&self, chart: &Chart, index: u64) -> Option<Vec<Complex64>> {
        let factors = self.choices.factors(index);
        let forms = self.forms.iter().zip(&factors);
        let forms: Vec<&[Complex64]> = forms.map(|(f, &k)| f[k as usize].as_slice()).collect();
        let mut coordinates = vec![Complex64::new(1.0, 0.0)];
        coordinates.extend(common_zero(&forms)?);
        chart.point(&coordinates)
    }
}

/// The sum of coefficients times coordinates.
pub(crate) fn linear_form(
    out: &mut Expressions,
    form: &[Complex64],
    coordinates: &[NodeId],
) -> NodeId {
    let mut sum = out.integer(0);
    for (&c, &y) in form.iter().zip(coordinates) {
        if c != Complex64::default() {
            let c = exact(out, c);
            let term = out.multiply(c, y);
            sum = out.add(sum, term);
        }
    }
    sum
}

/// The common zero of linear forms `c_0 + c_1 x_1 + ... + c_n x_n`, as many as variables; `None` where they do not
/// vanish in exactly one point.
pub fn common_zero(forms: &[&[Complex64]]) -> Option<Vec<Complex64>> {
    let n = forms.len();
    let native = |z: Complex64| Complex { re: z.re, im: z.im };
    let mut matrix = Matrix::<f64>::zeros((), n, n + 1);
    for (row, form) in forms.iter().enumerate() {
        for j in 0..n {
            *matrix.at_mut(row, j) = native(form[j + 1]);
        }
        *matrix.at_mut(row, n) = native(-form[0]);
    }
    eliminate::<f64, 1>(&mut matrix, &mut 0.0);
    let point: Vec<Complex64> = (0..n)
        .map(|j| Complex64::new(matrix.at(j, n).re, matrix.at(j, n).im))
        .collect();
    let finite = point.iter().all(|z| z.re.is_finite() && z.im.is_finite());
    finite.then_some(point)
}

fn check_sets(structure: &SetStructure, variables: usize) -> Result<(), LinearProductError> {
    let fits = |set: &Vec<u32>| {
        set.is_sorted_by(|a, b| a < b) && set.iter().all(|&v| (v as usize) < variables)
    };
    // Sets are words of 128 bits, numbers of sets words of 16.
    let few = variables <= 128
        && structure.len() == variables
        && structure.iter().all(|factors| factors.len() < 1 << 15);
    match few && structure.iter().flatten().all(fits) {
        true => Ok(()),
        false => Err(LinearProductError::Shape),
    }
}

/// Checks that the monomials of each equation are among those of its product.
///
/// # Errors
/// When the sets do not fit, or a monomial is not there.
pub fn check_covered(
    structure: &SetStructure,
    supports: &[Vec<Vec<u32>>],
    variables: usize,
) -> Result<(), LinearProductError> {
    check_sets(structure, variables)?;
    if supports.len() != structure.len() {
        return Err(LinearProductError::Shape);
    }
    for (equation, (factors, support)) in structure.iter().zip(supports).enumerate() {
        for monomial in support {
            let variables = occurrences(monomial);
            let cost = |variable: u32, factor: usize| {
                i64::from(factors[factor].binary_search(&variable).is_err())
            };
            let covered =
                variables.len() <= factors.len() && assign(&variables, factors.len(), cost).1 == 0;
            if !covered {
                return Err(LinearProductError::NotCovered(equation));
            }
        }
    }
    Ok(())
}

/// Every variable of a monomial, as often as it occurs.
fn occurrences(monomial: &[u32]) -> Vec<u32> {
    let each = monomial.iter().enumerate();
    each.flat_map(|(v, &e)| std::iter::repeat_n(v as u32, e as usize))
        .collect()
}

/// The cheapest way to give each of `rows` a column of its own, of `columns` that are no fewer:
/// the Hungarian method with potentials. Returns the columns and what they cost.
fn assign(rows: &[u32], columns: usize, cost: impl Fn(u32, usize) -> i64) -> (Vec<usize>, i64) {
    let n = rows.len();
    let (mut of_row, mut of_column) = (vec![0i64; n + 1], vec![0i64; columns + 1]);
    // Row of each column, from 1; column 0 stands for none.
    let mut matched = vec![0usize; columns + 1];
    for row in 1..=n {
        matched[0] = row;
        let mut column = 0;
        let mut least = vec![i64::MAX; columns + 1];
        let mut before = vec![0usize; columns + 1];
        let mut used = vec![false; columns + 1];
        while matched[column] != 0 {
            used[column] = true;
            let i = matched[column];
            let (mut step, mut next) = (i64::MAX, 0);
            for j in (1..=columns).filter(|&j| !used[j]) {
                let reduced = cost(rows[i - 1], j - 1) - of_row[i] - of_column[j];
                if reduced < least[j] {
                    (least[j], before[j]) = (reduced, column);
                }
                if least[j] < step {
                    (step, next) = (least[j], j);
                }
            }
            for j in 0..=columns {
                if used[j] {
                    of_row[matched[j]] += step;
                    of_column[j] -= step;
                } else if least[j] < i64::MAX {
                    least[j] -= step;
                }
            }
            column = next;
        }
        while column != 0 {
            matched[column] = matched[before[column]];
            column = before[column];
        }
    }
    let mut chosen = vec![0; n];
    for column in 1..=columns {
        if matched[column] > 0 {
            chosen[matched[column] - 1] = column - 1;
        }
    }
    let sum = rows.iter().zip(&chosen).map(|(&r, &c)| cost(r, c)).sum();
    (chosen, sum)
}

/// Sets for one equation, as many as its degree: monomial after monomial, each variable goes to
/// a set where it is already, or else to one that it makes least larger.
fn sets_of(support: &[Vec<u32>], order: &[usize], stream: &mut RandomStream) -> Vec<Vec<u32>> {
    const MISSING: i64 = 64;
    let degree = |monomial: &Vec<u32>| monomial.iter().sum::<u32>() as usize;
    let count = support.iter().map(degree).max().unwrap_or(0);
    let mut sets: Vec<Vec<u32>> = vec![Vec::new(); count];
    for &term in order {
        let variables = occurrences(&support[term]);
        let taste: Vec<i64> = (0..count).map(|_| stream.below(8) as i64).collect();
        let cost = |variable: u32, factor: usize| match sets[factor].binary_search(&variable) {
            Ok(_) => 0,
            Err(_) => MISSING + taste[factor],
        };
        let (chosen, _) = assign(&variables, count, cost);
        for (variable, factor) in variables.into_iter().zip(chosen) {
            if let Err(place) = sets[factor].binary_search(&variable) {
                sets[factor].insert(place, variable);
            }
        }
    }
    sets.sort();
    sets
}

/// A set structure with few start points, from the monomials: several for each equation, of
/// which those with the smallest count together are taken, one equation after the other.
///
/// `groups` are tried as sets where they serve. `None` where there are other numbers of
/// equations and variables, or counting takes more than `steps` steps.
pub fn guess(
    supports: &[Vec<Vec<u32>>],
    variables: usize,
    groups: &[Vec<usize>],
    steps: u64,
) -> Option<(SetStructure, u64)> {
    if supports.len() != variables || variables == 0 || variables > 128 {
        return None;
    }
    let candidates: Option<Vec<Vec<Vec<Vec<u32>>>>> = supports
        .iter()
        .enumerate()
        .map(|(i, support)| {
            let degree = support.iter().map(|m| m.iter().sum::<u32>()).max();
            let degree = u64::from(degree.unwrap_or(0));
            let operations = degree
                .saturating_pow(3)
                .saturating_mul(support.len() as u64);
            let mut set_lists: Vec<Vec<Vec<u32>>> =
                by_groups(support, groups).into_iter().collect();
            for number in 0..ORDERS {
                if count_work(operations) {
                    return None;
                }
                let mut stream = RandomStream::new(number, Purpose::Probe, 1000 + i as u64);
                let mut order: Vec<(u32, u64, usize)> = support
                    .iter()
                    .enumerate()
                    .map(|(k, m)| (u32::MAX - m.iter().sum::<u32>(), stream.bits(), k))
                    .collect();
                if number > 0 {
                    order.sort();
                } else {
                    order.sort_by_key(|&(degree, _, k)| (degree, k));
                }
                let order: Vec<usize> = order.into_iter().map(|(_, _, k)| k).collect();
                set_lists.push(sets_of(support, &order, &mut stream));
            }
            let size = |sets: &Vec<Vec<u32>>| {
                let sizes = sets.iter().map(|set| set.len());
                (
                    sizes.clone().sum::<usize>(),
                    sizes.map(|s| s * s).sum::<usize>(),
                )
            };
            set_lists.sort_by(|a, b| size(a).cmp(&size(b)).then_with(|| a.cmp(b)));
            set_lists.dedup();
            set_lists.truncate(CANDIDATES);
            Some(set_lists)
        })
        .collect();
    let candidates = candidates?;
    let mut structure: SetStructure = candidates
        .iter()
        .map(|alternatives| alternatives[0].clone())
        .collect();
    let mut best = count(&structure, variables, steps)?;
    // As long as it is worth it: every count may take as many steps.
    for (i, alternatives) in candidates.iter().enumerate() {
        for candidate in &alternatives[1..] {
            let before = std::mem::replace(&mut structure[i], candidate.clone());
            match count(&structure, variables, steps / 8) {
                Some(number) if number < best => best = number,
                _ => structure[i] = before,
            }
        }
    }
    Some((structure, best))
}

/// The groups as sets, as often as their degree, where that makes as many sets as the degree.
fn by_groups(support: &[Vec<u32>], groups: &[Vec<usize>]) -> Option<Vec<Vec<u32>>> {
    let total = support.iter().map(|m| m.iter().sum::<u32>()).max()?;
    let mut sets = Vec::new();
    for group in groups {
        let degree = |m: &Vec<u32>| group.iter().map(|&v| m[v]).sum::<u32>();
        let degree = support.iter().map(degree).max()?;
        let mut set: Vec<u32> = group.iter().map(|&v| v as u32).collect();
        set.sort_unstable();
        sets.extend(std::iter::repeat_n(set, degree as usize));
    }
    sets.sort();
    (sets.len() == total as usize).then_some(sets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::start_systems::grouping::best_grouping;
    use cognate_systems::named::{Named, cyclic, eco, katsura, noon};
    use cognate_systems::polynomial::supports;

    fn guessed(named: &Named) -> (SetStructure, u64) {
        let supports = supports(&named.system).expect("it is small");
        let variables = named.system.variable_count();
        let groups = best_grouping(&supports, variables).map_or(Vec::new(), |best| best.groups);
        let structure_and_count =
            guess(&supports, variables, &groups, SOLVING_STEPS).expect("it is small");
        check_covered(&structure_and_count.0, &supports, variables)
            .expect("a guess holds its monomials");
        structure_and_count
    }

    /// 3^n - 2n for Noonburg's neural networks (Verschelde, Cools 1993): {x_i} {others} {others}.
    #[test]
    fn known_counts() {
        assert_eq!(guessed(&noon(3)).1, 21);
        assert_eq!(guessed(&noon(5)).1, 233);
        assert_eq!(guessed(&katsura(6)).1, 64);
        let (_, eco) = guessed(&eco(8));
        assert!((64..=1458).contains(&eco), "{eco}");
        let (_, cyclic) = guessed(&cyclic(5));
        assert!((70..120).contains(&cyclic), "{cyclic}");
    }

    #[test]
    fn choices_are_the_permanent_without_dependent_ones() {
        // {0,1}{0} | {0}{1}: 4 choices, {0} with {0} has no solution.
        let structure: SetStructure = vec![vec![vec![0, 1], vec![0]], vec![vec![0], vec![1]]];
        assert_eq!(count(&structure, 2, 1000), Some(3));
        assert_eq!(count(&structure, 2, 2), None);
        let start = LinearProduct::new(&structure, 2, 3, 1000).expect("it fits");
        let mut factor_choices: Vec<Vec<u32>> = (0..3).map(|k| start.choices.factors(k)).collect();
        factor_choices.sort();
        assert_eq!(factor_choices, [vec![0, 0], vec![0, 1], vec![1, 1]]);
    }

    #[test]
    fn what_does_not_hold_the_monomials_is_refused() {
        let supports = vec![vec![vec![1, 1], vec![2, 0]], vec![vec![0, 1]]];
        let structure = |first: Vec<Vec<u32>>| vec![first, vec![vec![1]]];
        let check = |sets| check_covered(&structure(sets), &supports, 2);
        assert_eq!(check(vec![vec![0, 1], vec![0]]), Ok(()));
        let missing = Err(LinearProductError::NotCovered(0));
        assert_eq!(check(vec![vec![0], vec![1]]), missing);
        assert_eq!(check(vec![vec![0, 1]]), missing);
        assert_eq!(
            check(vec![vec![0, 2], vec![0]]),
            Err(LinearProductError::Shape)
        );
    }
}
