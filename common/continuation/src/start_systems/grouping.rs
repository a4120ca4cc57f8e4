//! Grouping: the partition of the variables with the smallest multihomogeneous Bezout number.
//!
//! Exact by branch and bound where that is affordable, else by a local search
//! (survey, section 6.1; Wampler, Bezout number calculations for
//! multi-homogeneous polynomial systems, 1992). Costs are bounded by counts of
//! operations, never by a clock.

use cognate_numeric::interruption::{count_work, is_interrupted};
use cognate_numeric::random::{Purpose, RandomStream};
use std::collections::{BTreeMap, BTreeSet};

/// Most variables of an exact search: its tables grow as 4^variables.
const MOST_EXACT: usize = 13;
/// Most products that the exact search may take: about half a second.
const EXACT_OPERATIONS: u64 = 100_000_000;
/// Most products that the local search may take.
const LOCAL_OPERATIONS: u64 = 60_000_000;
/// Most entries of the exact search's tables, and of one count's table.
const MOST_ENTRIES: usize = 1 << 22;
const MOST_STATES: usize = 100_000;
/// Random partitions that the local search begins with.
const RANDOM_BEGINNINGS: u64 = 12;

/// A partition of the variables and its cost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grouping {
    /// Variables of each group, ascending; the groups by their first variable.
    pub groups: Vec<Vec<usize>>,
    /// Multihomogeneous Bezout number, at most `u128::MAX`.
    pub number: u128,
    /// Whether no partition with a positive number has a smaller one.
    pub exact: bool,
}

/// The best partition of `variables` variables for as many equations, given the
/// exponents that occur in each. Partitions whose number is 0 are passed over:
/// they say that there is no isolated solution, not where paths begin.
///
/// `None` where the number of equations is another, or no partition was found.
pub fn best_grouping(supports: &[Vec<Vec<u32>>], variables: usize) -> Option<Grouping> {
    if supports.len() != variables || variables == 0 {
        return None;
    }
    let kinds = Kinds::new(supports, variables);
    let local = local_search(&kinds);
    let exact = Exact::new(&kinds).and_then(|mut search| search.run(local.as_ref()));
    let best = exact.or(local)?;
    (best.number > 0).then_some(best)
}

/// Equations of equal degrees in everything are one kind.
struct Kinds {
    variables: usize,
    /// Largest exponents of each kind, none below another.
    exponents: Vec<Vec<Vec<u32>>>,
    /// Number of equations of each kind.
    counts: Vec<usize>,
}

impl Kinds {
    fn new(supports: &[Vec<Vec<u32>>], variables: usize) -> Self {
        let mut kinds: BTreeMap<Vec<Vec<u32>>, usize> = BTreeMap::new();
        for support in supports {
            let below = |a: &[u32], b: &[u32]| a != b && a.iter().zip(b).all(|(a, b)| a <= b);
            let mut largest: Vec<Vec<u32>> = support
                .iter()
                .filter(|a| {
                    let work = (support.len() * a.len()) as u64;
                    !is_interrupted() && !count_work(work) && !support.iter().any(|b| below(a, b))
                })
                .cloned()
                .collect();
            largest.sort_unstable();
            largest.dedup();
            *kinds.entry(largest).or_insert(0) += 1;
        }
        let (exponents, counts) = kinds.into_iter().unzip();
        Self {
            variables,
            exponents,
            counts,
        }
    }

    /// Degree of a kind in some variables together.
    fn degree(&self, kind: usize, group: &[usize]) -> u32 {
        let degree_of = |exponents: &Vec<u32>| group.iter().map(|&v| exponents[v]).sum();
        self.exponents[kind]
            .iter()
            .map(degree_of)
            .max()
            .unwrap_or(0)
    }

    /// Multihomogeneous Bezout number; `None` where its table would be too large
    /// or the operations run out.
    fn number(&self, groups: &[Vec<usize>], operations: &mut u64) -> Option<u128> {
        let mut states = 1usize;
        let mut strides = Vec::with_capacity(groups.len());
        for group in groups {
            strides.push(states);
            states = states.checked_mul(group.len() + 1)?;
        }
        if states > MOST_STATES || is_interrupted() {
            return None;
        }
        // ways[places taken in each group], equation by equation.
        let mut ways = vec![0u128; states];
        ways[0] = 1;
        for (kind, &count) in self.counts.iter().enumerate() {
            let degrees: Vec<u128> = groups
                .iter()
                .map(|group| u128::from(self.degree(kind, group)))
                .collect();
            for _ in 0..count {
                let cost = (states * groups.len()) as u64;
                *operations = operations.checked_sub(cost)?;
                if count_work(cost) {
                    return None;
                }
                let mut next = vec![0u128; states];
                for (state, &number) in ways.iter().enumerate() {
                    if number == 0 {
                        continue;
                    }
                    for (g, &degree) in degrees.iter().enumerate() {
                        let taken = state / strides[g] % (groups[g].len() + 1);
                        if degree > 0 && taken < groups[g].len() {
                            let sum = &mut next[state + strides[g]];
                            *sum = sum.saturating_add(number.saturating_mul(degree));
                        }
                    }
                }
                ways = next;
            }
        }
        ways.last().copied()
    }
}

fn canonical(mut groups: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    groups.retain(|group| !group.is_empty());
    for group in &mut groups {
        group.sort_unstable();
    }
    groups.sort_unstable();
    groups
}

/// Local search from several beginnings: moves one variable, or joins two groups, while the number falls.
fn local_search(kinds: &Kinds) -> Option<Grouping> {
    let n = kinds.variables;
    let mut operations = LOCAL_OPERATIONS;
    let mut best: Option<Grouping> = None;
    let mut beginnings = vec![vec![(0..n).collect::<Vec<_>>()]];
    beginnings.extend(two_sides(kinds));
    beginnings.push((0..n).map(|v| vec![v]).collect());
    for k in 0..RANDOM_BEGINNINGS {
        let mut stream = RandomStream::new(0, Purpose::Probe, k);
        let mut groups = vec![Vec::new(); 2 + (k % 3) as usize];
        for v in 0..n {
            let count = groups.len() as u64;
            groups[stream.below(count) as usize].push(v);
        }
        beginnings.push(groups);
    }
    for beginning in beginnings {
        let mut groups = canonical(beginning);
        let Some(mut number) = kinds.number(&groups, &mut operations) else {
            continue;
        };
        loop {
            let mut better: Option<(u128, Vec<Vec<usize>>)> = None;
            for candidate in neighbours(&groups, n) {
                let Some(bezout_number) = kinds.number(&candidate, &mut operations) else {
                    continue;
                };
                let least = better.as_ref().map_or(number, |b| b.0);
                // A number of 0 is no progress, but anything is better than it.
                if bezout_number > 0 && (bezout_number < least || least == 0) {
                    better = Some((bezout_number, candidate));
                }
            }
            match better {
                Some(next) => (number, groups) = next,
                None => break,
            }
        }
        if number > 0 && best.as_ref().is_none_or(|b| number < b.number) {
            best = Some(Grouping {
                groups,
                number,
                exact: false,
            });
        }
    }
    best
}

fn neighbours(groups: &[Vec<usize>], variables: usize) -> Vec<Vec<Vec<usize>>> {
    let mut groupings = Vec::new();
    for v in 0..variables {
        for target in 0..=groups.len() {
            if groups.get(target).is_some_and(|group| group.contains(&v)) {
                continue;
            }
            let mut moved = groups.to_vec();
            moved.push(Vec::new());
            for group in &mut moved {
                group.retain(|&w| w != v);
            }
            moved[target].push(v);
            groupings.push(canonical(moved));
        }
    }
    for a in 0..groups.len() {
        for b in 0..a {
            let mut joined = groups.to_vec();
            let group = joined.remove(a);
            joined[b].extend(group);
            groupings.push(canonical(joined));
        }
    }
    groupings
}

/// Finds two groups where no equation has a product of two variables of one group; `None` where there are none.
fn two_sides(kinds: &Kinds) -> Option<Vec<Vec<usize>>> {
    let n = kinds.variables;
    let mut side: Vec<Option<bool>> = vec![None; n];
    let mut meets: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
    for exponents in kinds.exponents.iter().flatten() {
        let mut occurring = (0..n).filter(|&v| exponents[v] > 0);
        match (occurring.next(), occurring.next(), occurring.next()) {
            // Of three variables two are on one side.
            (_, _, Some(_)) => return None,
            (Some(a), Some(b), None) => {
                meets[a].insert(b);
                meets[b].insert(a);
            }
            _ => {}
        }
    }
    for first in 0..n {
        if side[first].is_some() {
            continue;
        }
        side[first] = Some(false);
        let mut waiting = vec![first];
        while let Some(a) = waiting.pop() {
            for &b in &meets[a] {
                if side[b] == side[a] {
                    return None;
                }
                if side[b].is_none() {
                    side[b] = side[a].map(|s| !s);
                    waiting.push(b);
                }
            }
        }
    }
    let side_variables = |wanted| (0..n).filter(|&v| side[v] == Some(wanted)).collect();
    Some(vec![side_variables(false), side_variables(true)])
}

/// Branch and bound over partitions, block by block, each with the smallest variable left.
///
/// A state says how many equations of each kind have been used. Which
/// equations go to a block can be chosen for each state on its own at no
/// greater cost, which bounds what is left from below: a recursion over
/// subsets of variables, and exact where only one state is possible. Numbers
/// stop at `u64::MAX`: no start with more paths is of use.
struct Exact<'a> {
    kinds: &'a Kinds,
    states: usize,
    /// `transitions[state][places]`: states after giving away `places` equations, and the number of ways to choose
    /// these.
    transitions: Vec<Vec<Vec<(u32, u64)>>>,
    /// `degrees[variables as bits][kind]`.
    degrees: Vec<Vec<u32>>,
    /// `powers[block][difference of states]`: product of the degrees of the
    /// equations that went to the block.
    powers: Vec<Vec<u64>>,
    /// States by the number of equations used.
    by_size: Vec<Vec<usize>>,
    /// Number of equations of each kind that a state has used.
    used: Vec<Vec<usize>>,
    /// `bounds[variables left as bits][state]`.
    bounds: Vec<Vec<u64>>,
    operations: u64,
}

/// Binomial coefficients of small numbers.
fn choose(n: usize, k: usize) -> u64 {
    (0..k).fold(1, |product, i| product * (n - i) as u64 / (i + 1) as u64)
}

impl<'a> Exact<'a> {
    fn new(kinds: &'a Kinds) -> Option<Self> {
        let n = kinds.variables;
        let states = kinds
            .counts
            .iter()
            .try_fold(1usize, |states, count| states.checked_mul(count + 1))?;
        if n > MOST_EXACT || states.checked_mul(1 << n)? > MOST_ENTRIES {
            return None;
        }
        let used: Vec<Vec<usize>> = (0..states)
            .map(|mut state| {
                let digit = |count: &usize| {
                    let digit = state % (count + 1);
                    state /= count + 1;
                    digit
                };
                kinds.counts.iter().map(digit).collect()
            })
            .collect();
        let mut by_size = vec![Vec::new(); n + 1];
        for (state, used) in used.iter().enumerate() {
            by_size[used.iter().sum::<usize>()].push(state);
        }
        let degrees = (0..1usize << n)
            .map(|mask| {
                let group: Vec<usize> = (0..n).filter(|v| mask >> v & 1 == 1).collect();
                (0..kinds.counts.len())
                    .map(|kind| kinds.degree(kind, &group))
                    .collect()
            })
            .collect();
        let mut search = Self {
            kinds,
            states,
            transitions: Vec::new(),
            degrees,
            powers: vec![Vec::new(); 1 << n],
            by_size,
            used,
            bounds: vec![Vec::new(); 1 << n],
            operations: EXACT_OPERATIONS,
        };
        search.fill_transitions()?;
        Some(search)
    }

    fn fill_transitions(&mut self) -> Option<()> {
        for from in 0..self.states {
            let mut by_places = vec![Vec::new(); self.kinds.variables + 1];
            for to in from..self.states {
                self.operations = self.operations.checked_sub(1)?;
                let (a, b) = (&self.used[from], &self.used[to]);
                if count_work(a.len() as u64) {
                    return None;
                }
                if a.iter().zip(b).any(|(a, b)| a > b) {
                    continue;
                }
                let places = b.iter().sum::<usize>() - a.iter().sum::<usize>();
                let ways = a
                    .iter()
                    .zip(b)
                    .zip(&self.kinds.counts)
                    .map(|((a, b), count)| choose(count - a, b - a))
                    .product();
                by_places[places].push((to as u32, ways));
            }
            self.transitions.push(by_places);
        }
        Some(())
    }

    fn fill_powers(&mut self, block: usize) {
        if !self.powers[block].is_empty() {
            return;
        }
        let mut powers = vec![0; self.states];
        for &difference in &self.by_size[block.count_ones() as usize] {
            powers[difference] = self.used[difference].iter().zip(&self.degrees[block]).fold(
                1u64,
                |product, (&taken, &degree)| {
                    product.saturating_mul(u64::from(degree).saturating_pow(taken as u32))
                },
            );
        }
        self.powers[block] = powers;
    }

    /// Blocks out of `left` that contain its smallest variable.
    fn blocks(left: usize) -> impl Iterator<Item = usize> {
        let first = left & left.wrapping_neg();
        let rest = left ^ first;
        let mut subset = Some(rest);
        std::iter::from_fn(move || {
            let bits = subset?;
            subset = (bits > 0).then(|| (bits - 1) & rest);
            Some(bits | first)
        })
    }

    fn fill_bounds(&mut self) -> Option<()> {
        let n = self.kinds.variables;
        self.bounds[0] = vec![0; self.states];
        self.bounds[0][self.states - 1] = 1;
        for left in 1..1usize << n {
            let begun = n - left.count_ones() as usize;
            let mut least = vec![u64::MAX; self.states];
            for block in Self::blocks(left) {
                self.fill_powers(block);
                if count_work(self.states as u64) {
                    return None;
                }
                let (powers, after) = (&self.powers[block], &self.bounds[left ^ block]);
                let places = block.count_ones() as usize;
                for &state in &self.by_size[begun] {
                    let transitions = &self.transitions[state][places];
                    self.operations = self.operations.checked_sub(transitions.len() as u64)?;
                    if count_work(transitions.len() as u64) {
                        return None;
                    }
                    let mut sum = 0u64;
                    for &(next, ways) in transitions {
                        let next = next as usize;
                        let weight = ways.saturating_mul(powers[next - state]);
                        sum = sum.saturating_add(weight.saturating_mul(after[next]));
                    }
                    least[state] = least[state].min(sum);
                }
            }
            self.bounds[left] = least;
        }
        Some(())
    }

    fn run(&mut self, incumbent: Option<&Grouping>) -> Option<Grouping> {
        self.fill_bounds()?;
        let mut best = incumbent.cloned();
        let mut ways = vec![0u64; self.states];
        ways[0] = 1;
        let every_variable = (1usize << self.kinds.variables) - 1;
        self.descend(every_variable, &ways, &mut Vec::new(), &mut best)?;
        best.map(|best| Grouping {
            exact: true,
            ..best
        })
    }

    fn descend(
        &mut self,
        left: usize,
        ways: &[u64],
        blocks: &mut Vec<usize>,
        best: &mut Option<Grouping>,
    ) -> Option<()> {
        let limit = |best: &Option<Grouping>| best.as_ref().map_or(u128::MAX, |b| b.number);
        if left == 0 {
            let number = u128::from(ways[self.states - 1]);
            if number > 0 && number < limit(best) {
                let members = |&mask: &usize| {
                    (0..self.kinds.variables)
                        .filter(|v| mask >> v & 1 == 1)
                        .collect()
                };
                *best = Some(Grouping {
                    groups: canonical(blocks.iter().map(members).collect()),
                    number,
                    exact: false,
                });
            }
            return Some(());
        }
        let begun = self.kinds.variables - left.count_ones() as usize;
        let mut children = Vec::new();
        for block in Self::blocks(left) {
            self.fill_powers(block);
            let powers = &self.powers[block];
            let mut next = vec![0u64; self.states];
            let places = block.count_ones() as usize;
            for &state in &self.by_size[begun] {
                if ways[state] == 0 {
                    continue;
                }
                let transitions = &self.transitions[state][places];
                self.operations = self.operations.checked_sub(transitions.len() as u64)?;
                if count_work(transitions.len() as u64) {
                    return None;
                }
                for &(after, choices) in transitions {
                    let after = after as usize;
                    let weight = choices.saturating_mul(powers[after - state]);
                    let more = ways[state].saturating_mul(weight);
                    next[after] = next[after].saturating_add(more);
                }
            }
            if count_work(self.states as u64) {
                return None;
            }
            let bound = next
                .iter()
                .zip(&self.bounds[left ^ block])
                .fold(0u64, |sum, (&a, &b)| {
                    sum.saturating_add(a.saturating_mul(b))
                });
            if u128::from(bound) < limit(best) {
                children.push((bound, block, next));
            }
        }
        children.sort_by_key(|&(bound, block, _)| (bound, block));
        for (bound, block, next) in children {
            if u128::from(bound) >= limit(best) {
                break;
            }
            blocks.push(block);
            let done = self.descend(left ^ block, &next, blocks, best);
            blocks.pop();
            done?;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::start_systems::multihomogeneous::bezout_number;
    use cognate_numeric::random::{Purpose, RandomStream};

    /// All partitions of `0..n`, by restricted growth.
    fn partitions(n: usize) -> Vec<Vec<Vec<usize>>> {
        let mut partition_list: Vec<Vec<Vec<usize>>> = vec![vec![]];
        for v in 0..n {
            partition_list = partition_list
                .into_iter()
                .flat_map(|partition| {
                    (0..=partition.len()).map(move |g| {
                        let mut next = partition.clone();
                        if g == next.len() {
                            next.push(vec![]);
                        }
                        next[g].push(v);
                        next
                    })
                })
                .collect();
        }
        partition_list
    }

    fn number(supports: &[Vec<Vec<u32>>], groups: &[Vec<usize>]) -> u64 {
        let degree = |support: &Vec<Vec<u32>>, group: &Vec<usize>| {
            let group_degree = |e: &Vec<u32>| group.iter().map(|&v| e[v]).sum::<u32>();
            support.iter().map(group_degree).max().unwrap_or(0)
        };
        let degrees: Vec<Vec<u32>> = supports
            .iter()
            .map(|s| groups.iter().map(|g| degree(s, g)).collect())
            .collect();
        let dimensions: Vec<u32> = groups.iter().map(|g| g.len() as u32).collect();
        bezout_number(&degrees, &dimensions).expect("it fits")
    }

    #[test]
    fn the_search_agrees_with_trying_all_partitions() {
        for seed in 0..60 {
            let mut stream = RandomStream::new(seed, Purpose::Test, 0);
            let n = 2 + stream.below(5) as usize;
            let supports: Vec<Vec<Vec<u32>>> = (0..n)
                .map(|_| {
                    (0..1 + stream.below(4))
                        .map(|_| (0..n).map(|_| stream.below(3) as u32).collect())
                        .collect()
                })
                .collect();
            let least = partitions(n)
                .iter()
                .map(|p| number(&supports, p))
                .filter(|&b| b > 0)
                .min();
            let grouping = best_grouping(&supports, n);
            assert_eq!(
                grouping.as_ref().map(|f| f.number),
                least.map(u128::from),
                "seed {seed}"
            );
            if let Some(grouping) = grouping {
                assert!(grouping.exact);
                let bezout_number = number(&supports, &grouping.groups);
                assert_eq!(u128::from(bezout_number), grouping.number);
                assert_eq!(grouping.groups.iter().flatten().count(), n);
            }
        }
    }

    #[test]
    fn bilinear_systems_split_in_two_beyond_the_exact_search() {
        // 16 bilinear equations in 8 + 8 variables: C(16, 8) against 2^16.
        let n = 16;
        let support: Vec<Vec<u32>> = (0..n / 2)
            .flat_map(|a| {
                (n / 2..n).map(move |b| (0..n).map(|v| u32::from(v == a || v == b)).collect())
            })
            .collect();
        let grouping = best_grouping(&vec![support; n], n).expect("there is a grouping");
        assert_eq!(grouping.number, 12_870);
        assert_eq!(grouping.groups.len(), 2);
        assert!(!grouping.exact);
    }

    #[test]
    fn more_equations_than_variables_have_no_grouping() {
        assert_eq!(best_grouping(&[vec![vec![1]], vec![vec![2]]], 1), None);
    }
}
