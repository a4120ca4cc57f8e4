//! Multihomogeneous start system: products of random linear forms, one for each degree in each group.
//!
//! Counting and unranking go by the same table, so that a start point is made
//! from its index and never stored (survey, section 6.1). With an exchange of
//! groups the forms are exchanged too, and of two start points one is counted.

use super::exchange::Exchange;
use crate::chart::{Chart, exact};
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::Complex;
use cognate_systems::expression::{Expressions, NodeId};
use num_complex::Complex64;
use std::collections::HashMap;

/// The start system and its solutions by index.
#[derive(Clone, Debug)]
pub struct Multihomogeneous {
    choices: Choices,
    /// `forms[equation][group][factor]`: coefficients of a linear form in the
    /// homogeneous coordinates of the group.
    forms: Vec<Vec<Vec<Vec<Complex64>>>>,
    /// Image of each equation under the exchange.
    exchanged: Option<Vec<usize>>,
}

impl Multihomogeneous {
    /// Random forms for these degrees; `None` when there are too many choices to count, or the
    /// exchange gives no half of them.
    pub fn new(
        degrees: &[Vec<u32>],
        dimensions: &[u32],
        exchange: Option<&Exchange>,
        chart: &Chart,
        seed: u64,
    ) -> Option<Self> {
        let choices = Choices::of_half(degrees, dimensions, exchange)?;
        let mut number = 0;
        let mut forms: Vec<Vec<Vec<Vec<Complex64>>>> = degrees
            .iter()
            .map(|row| {
                row.iter()
                    .enumerate()
                    .map(|(group, &d)| {
                        (0..d)
                            .map(|_| {
                                let mut stream =
                                    RandomStream::new(seed, Purpose::StartSystem, number);
                                number += 1;
                                (0..chart.group_size(group))
                                    .map(|_| stream.unit())
                                    .collect()
                            })
                            .collect()
                    })
                    .collect()
            })
            .collect();
        for (i, k) in (0..forms.len()).flat_map(|i| (0..dimensions.len()).map(move |k| (i, k))) {
            let Some(e) = exchange else { break };
            let (j, l) = (e.equations[i], e.groups[k]);
            if (i, k) < (j, l) {
                let images = forms[i][k].iter();
                forms[j][l] = images.map(|form| chart.exchanged(form, k, e)).collect();
            }
        }
        Some(Self {
            choices,
            forms,
            exchanged: exchange.map(|e| e.equations.clone()),
        })
    }

    /// Image of each equation under the exchange, if there is one.
    pub(crate) fn exchanged(&self) -> Option<&[usize]> {
        self.exchanged.as_deref()
    }

    /// The equations over the homogeneous coordinates of all groups.
    pub fn equations(&self, out: &mut Expressions, coordinates: &[Vec<NodeId>]) -> Vec<NodeId> {
        self.forms
            .iter()
            .map(|groups| {
                let mut product = out.integer(1);
                for (group, factors) in groups.iter().enumerate() {
                    for form in factors {
                        let mut sum = out.integer(0);
                        for (&c, &y) in form.iter().zip(&coordinates[group]) {
                            let c = exact(out, c);
                            let term = out.multiply(c, y);
                            sum = out.add(sum, term);
                        }
                        product = out.multiply(product, sum);
                    }
                }
                product
            })
            .collect()
    }

    /// Start point number `index`: where the chosen factor of each equation vanishes.
    pub fn point(&self, chart: &Chart, index: u64) -> Option<Vec<Complex64>> {
        let choice = self.choices.choice(index);
        let mut point = vec![Complex64::default(); chart.dimension()];
        for group in 0..chart.group_count() {
            let (patch, first) = chart.patch(group);
            let n = patch.len() - 1;
            if n == 0 {
                continue;
            }
            let mut system = Matrix::<f64>::zeros((), n, n + 1);
            let chosen = choice.iter().enumerate().filter(|(_, (g, _))| *g == group);
            for (row, (equation, (_, factor))) in chosen.enumerate() {
                let form = &self.forms[equation][group][*factor as usize];
                let native = |z: Complex64| Complex { re: z.re, im: z.im };
                for j in 0..n {
                    *system.at_mut(row, j) = native(form[j + 1] + form[0] * patch[j + 1]);
                }
                *system.at_mut(row, n) = native(-form[0] * patch[0]);
            }
            eliminate::<f64, 1>(&mut system, &mut 0.0);
            for j in 0..n {
                let y = system.at(j, n);
                if !(y.re.is_finite() && y.im.is_finite()) {
                    return None;
                }
                point[first + j] = Complex64::new(y.re, y.im);
            }
        }
        Some(point)
    }
}

/// How many ways there are to take one factor from each equation so that group
/// k is taken `dimensions[k]` times: the multihomogeneous Bezout number.
///
/// `None` when it does not fit in 64 bits or the dimensions do not add up to
/// the number of equations.
pub fn bezout_number(degrees: &[Vec<u32>], dimensions: &[u32]) -> Option<u64> {
    Choices::new(degrees, dimensions).map(|choices| choices.count())
}

/// The choices of factors, counted and ordered.
#[derive(Clone, Debug)]
pub struct Choices {
    degrees: Vec<Vec<u32>>,
    dimensions: Vec<u32>,
    /// Number of ways to go on from equation `i` with these places left in each group.
    ways: Vec<HashMap<Vec<u32>, u64>>,
}

impl Choices {
    /// The table of all counts; `None` when a count does not fit in 64 bits.
    pub fn new(degrees: &[Vec<u32>], dimensions: &[u32]) -> Option<Self> {
        let total: u64 = dimensions.iter().map(|&d| u64::from(d)).sum();
        if total != degrees.len() as u64 {
            return None;
        }
        // Places left that can be reached from the beginning, equation by equation.
        let mut reachable = vec![vec![dimensions.to_vec()]];
        for row in degrees {
            let mut next = std::collections::BTreeSet::new();
            for left in reachable.last().expect("never empty") {
                for (k, &d) in row.iter().enumerate() {
                    if d > 0 && left[k] > 0 {
                        let mut left = left.clone();
                        left[k] -= 1;
                        next.insert(left);
                    }
                }
            }
            reachable.push(next.into_iter().collect());
        }
        let mut ways = vec![HashMap::new(); degrees.len() + 1];
        for left in &reachable[degrees.len()] {
            ways[degrees.len()].insert(left.clone(), 1u64);
        }
        for i in (0..degrees.len()).rev() {
            for left in &reachable[i] {
                let mut sum = 0u64;
                for (k, &d) in degrees[i].iter().enumerate() {
                    if d > 0 && left[k] > 0 {
                        let mut after = left.clone();
                        after[k] -= 1;
                        let rest = ways[i + 1].get(&after).copied().unwrap_or(0);
                        sum = sum.checked_add(rest.checked_mul(u64::from(d))?)?;
                    }
                }
                ways[i].insert(left.clone(), sum);
            }
        }
        Some(Self {
            degrees: degrees.to_vec(),
            dimensions: dimensions.to_vec(),
            ways,
        })
    }

    /// With an exchange, of each two choices that it takes to each other that one where the
    /// equation that says which takes its factor from the first of two groups; `None` also where no
    /// equation says so.
    pub fn of_half(
        degrees: &[Vec<u32>],
        dimensions: &[u32],
        exchange: Option<&Exchange>,
    ) -> Option<Self> {
        let Some(exchange) = exchange else {
            return Self::new(degrees, dimensions);
        };
        let row = exchange.halving(degrees)?;
        let mut half = degrees.to_vec();
        for (degree, (k, &to)) in half[row].iter_mut().zip(exchange.groups.iter().enumerate()) {
            if to < k {
                *degree = 0;
            }
        }
        Self::new(&half, dimensions)
    }

    /// Number of choices.
    pub fn count(&self) -> u64 {
        self.ways[0].get(&self.dimensions).copied().unwrap_or(0)
    }

    /// Choice number `index`: for each equation the group and which of its factors.
    ///
    /// # Panics
    /// When `index` is not below the number of choices.
    pub fn choice(&self, mut index: u64) -> Vec<(usize, u32)> {
        assert!(index < self.count(), "there is no choice number {index}");
        let mut left = self.dimensions.clone();
        let mut chosen = Vec::with_capacity(self.degrees.len());
        for (i, row) in self.degrees.iter().enumerate() {
            for (k, &d) in row.iter().enumerate() {
                if d == 0 || left[k] == 0 {
                    continue;
                }
                left[k] -= 1;
                let rest = self.ways[i + 1].get(&left).copied().unwrap_or(0);
                if index < rest * u64::from(d) {
                    chosen.push((k, (index / rest) as u32));
                    index %= rest;
                    break;
                }
                index -= rest * u64::from(d);
                left[k] += 1;
            }
        }
        chosen
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_bezout_numbers() {
        // Survey, section 6.1: 3-RPR platform in two groups, 6.
        let platform: Vec<Vec<u32>> = [
            vec![vec![1, 0]; 3],
            vec![vec![0, 1]; 3],
            vec![vec![1, 1]; 4],
        ]
        .concat();
        assert_eq!(bezout_number(&platform, &[5, 5]), Some(6));
        // Nine-point path synthesis in two groups: 286,720 (Wampler, Morgan, Sommese 1992).
        let nine: Vec<Vec<u32>> = [
            vec![vec![2, 0]; 2],
            vec![vec![0, 2]; 2],
            vec![vec![2, 2]; 8],
        ]
        .concat();
        assert_eq!(bezout_number(&nine, &[6, 6]), Some(286_720));
        assert_eq!(bezout_number(&nine, &[6, 5]), None);
    }

    #[test]
    fn every_choice_is_met_once() {
        let degrees = vec![vec![2, 1], vec![1, 3], vec![0, 2], vec![2, 0]];
        let choices = Choices::new(&degrees, &[2, 2]).unwrap();
        let mut choice_list: Vec<_> = (0..choices.count()).map(|i| choices.choice(i)).collect();
        for choice in &choice_list {
            assert_eq!(choice.iter().filter(|(k, _)| *k == 0).count(), 2);
            assert!(
                choice
                    .iter()
                    .zip(&degrees)
                    .all(|((k, j), row)| *j < row[*k])
            );
        }
        let count = choice_list.len();
        choice_list.sort();
        choice_list.dedup();
        assert_eq!(choice_list.len(), count);
    }
}
