//! Elimination of large matrices with few entries: what is always 0 is never touched.
//!
//! Which entries may differ from 0 is known before the paths begin. Rows and columns are ordered
//! so that little fills in and pivots stay large (Markowitz 1957, with a threshold), the sums of
//! the left-looking elimination are listed without their empty terms, and all lanes follow the
//! lists. A lane whose pivot is small exchanges rows for itself alone, as in `lu`; from there on
//! that batch is eliminated with all its terms, of which the empty ones change no bit, so that a
//! path's bits do not depend on who shares its lanes.

use super::lu::exchange_in;
use super::matrix::Matrix;
use crate::scalar::{Complex, Mask, Real};
use std::ops::Range;

/// A pivot is kept while its modulus is at least this part of its column's largest: smaller than
/// in `lu`, since an exchange costs the lists. Newton's method corrects what that blurs.
const KEPT_PIVOT: f64 = 1e-5;
/// Entries above this part of their column's largest may be chosen as pivots.
const SAFE: f64 = 0.05;

/// Orders of rows and columns for [`SparseElimination`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// Row k of the elimination is this row of the pattern.
    pub rows: Vec<usize>,
    /// Column k of the elimination is this column.
    pub columns: Vec<usize>,
}

/// Orders of rows and columns with little fill-in, for matrices of one pattern: `pattern[i][j]` says whether entry (i,
/// j) may differ from 0; the samples (at least one, n rows) are matrices of this pattern.
///
/// Each pivot is chosen among the entries that are safe in most samples: its row and column have the fewest other
/// entries. Of equal choices the larger pivot is taken.
pub fn sparse_order(pattern: &[Vec<bool>], samples: &[Matrix<f64>]) -> Order {
    let n = pattern.len();
    let mut pattern = pattern.to_vec();
    let mut samples = samples.to_vec();
    let (mut rows, mut columns): (Vec<usize>, Vec<usize>) = ((0..n).collect(), (0..n).collect());
    for k in 0..n {
        let count = |cells: &mut dyn Iterator<Item = bool>| cells.filter(|&cell| cell).count();
        let in_row: Vec<usize> = (0..n)
            .map(|i| count(&mut columns[k..].iter().map(|&j| pattern[rows[i]][j])))
            .collect();
        let mut best: Option<(usize, usize, (usize, usize, f64))> = None;
        for (place, &j) in columns.iter().enumerate().skip(k) {
            let in_column = count(&mut rows[k..].iter().map(|&i| pattern[i][j]));
            let largest: Vec<f64> = samples
                .iter()
                .map(|work| {
                    let sizes = rows[k..].iter().map(|&i| work.at(i, j).norm_sqr());
                    sizes.fold(0.0, |m, size| if size > m { size } else { m })
                })
                .collect();
            for at in k..n {
                let i = rows[at];
                if !pattern[i][j] {
                    continue;
                }
                let (mut unsafe_in, mut sum) = (0, 0.0);
                for (work, &largest) in samples.iter().zip(&largest) {
                    let part = work.at(i, j).norm_sqr() / largest;
                    unsafe_in += usize::from(part.is_nan() || part < SAFE * SAFE);
                    sum += if part.is_finite() { part } else { 0.0 };
                }
                let fill = (in_row[at] - 1) * (in_column - 1);
                let better = best.is_none_or(|(_, _, (others, least, most))| {
                    (unsafe_in, fill) < (others, least)
                        || ((unsafe_in, fill) == (others, least) && sum > most)
                });
                if better {
                    best = Some((at, place, (unsafe_in, fill, sum)));
                }
            }
        }
        // Where nothing is left the matrix is singular, whatever its entries: any order serves.
        let (at, place) = best.map_or((k, k), |(at, place, _)| (at, place));
        rows.swap(k, at);
        columns.swap(k, place);
        let (row, column) = (rows[k], columns[k]);
        for &i in &rows[k + 1..] {
            if !pattern[i][column] {
                continue;
            }
            for &j in &columns[k + 1..] {
                pattern[i][j] |= pattern[row][j];
            }
            for work in &mut samples {
                let mut factor = *work.at(i, column);
                factor.mul(&work.at(row, column).inverse());
                for &j in &columns[k + 1..] {
                    let upper = *work.at(row, j);
                    work.at_mut(i, j).mul_sub(&factor, &upper);
                }
            }
        }
    }
    Order { rows, columns }
}

/// A sum that the elimination forms: `entry -= sum over m of (row, m) (m, column)`.
#[derive(Clone, Debug)]
struct Entry {
    /// Row of the entry, or position of the entry in the order of columns, in the elimination.
    at: u32,
    /// Terms of the sum, as a range of the list of all terms.
    terms: Range<u32>,
}

/// The sums of one pivot.
#[derive(Clone, Debug, Default)]
struct Pivot {
    /// Entries of the pivot's column, from the diagonal down: the diagonal is the first.
    column: Vec<Entry>,
    /// Entries of the pivot's row, right of the diagonal.
    row: Vec<Entry>,
    /// Terms of the pivot's right-hand sides.
    below: Range<u32>,
    /// Columns right of the diagonal in which the pivot's row has an entry.
    above: Range<u32>,
}

/// Elimination for matrices of n rows and n + 2 columns whose rows already stand in the order
/// that was found, with entries in the same places.
#[derive(Clone, Debug)]
pub struct SparseElimination {
    columns: Vec<usize>,
    pivots: Vec<Pivot>,
    /// Indices m of all terms, and columns of the substitutions.
    list: Vec<u32>,
    flops: u64,
}

impl SparseElimination {
    /// For matrices with these entries: `pattern[i][j]` says whether entry (i, j) may differ from
    /// 0, rows in the order of the elimination; `columns` is the order of the columns.
    pub fn new(pattern: &[Vec<bool>], columns: &[usize]) -> Self {
        let n = pattern.len();
        let index = |k: usize| u32::try_from(k).expect("a matrix has fewer rows");
        // Entries that may differ from 0 after fill-in, in the order of the elimination.
        let mut filled: Vec<Vec<bool>> = pattern
            .iter()
            .map(|row| columns.iter().map(|&j| row[j]).collect())
            .collect();
        for k in 0..n {
            // A pivot is divided by, wherever it comes from.
            filled[k][k] = true;
            let upper = filled[k].clone();
            for row in &mut filled[k + 1..] {
                if row[k] {
                    for j in k + 1..n {
                        row[j] |= upper[j];
                    }
                }
            }
        }
        let mut list: Vec<u32> = Vec::new();
        let mut flops = 0;
        let mut collect = |terms: &mut dyn Iterator<Item = usize>, each: u64| {
            let begin = index(list.len());
            list.extend(terms.map(index));
            let terms = begin..index(list.len());
            flops += 8 * each * u64::from(terms.end - terms.start);
            terms
        };
        let filled = &filled;
        let pivots = (0..n)
            .map(|k| Pivot {
                column: (k..n)
                    .filter(|&i| filled[i][k])
                    .map(|i| Entry {
                        at: index(i),
                        terms: collect(&mut (0..k).filter(|&m| filled[i][m] && filled[m][k]), 1),
                    })
                    .collect(),
                row: (k + 1..n)
                    .filter(|&j| filled[k][j])
                    .map(|j| Entry {
                        at: index(j),
                        terms: collect(&mut (0..k).filter(|&m| filled[k][m] && filled[m][j]), 1),
                    })
                    .collect(),
                below: collect(&mut (0..k).filter(|&m| filled[k][m]), 2),
                above: collect(&mut (k + 1..n).filter(|&j| filled[k][j]), 2),
            })
            .collect();
        Self {
            columns: columns.to_vec(),
            pivots,
            list,
            flops,
        }
    }

    /// Real operations of one elimination with two right-hand sides, without divisions.
    pub fn flops(&self) -> u64 {
        self.flops
    }

    /// Solves for the last `RHS` columns, as `lu::eliminate` does: on return they hold the
    /// solutions, row i that of column i.
    ///
    /// A lane in which some solution is no number gets none that are.
    #[inline(always)]
    pub fn eliminate<R: Real, const RHS: usize>(
        &self,
        a: &mut Matrix<R>,
        exchanges: &mut R::Control,
    ) {
        let n = self.columns.len();
        let stride = a.columns();
        debug_assert!(a.rows() == n && stride >= n + RHS, "the matrix fits");
        let entries = &mut a.entries[..];
        let context = entries[0].re.context();
        let kept = R::Control::from_f64((), KEPT_PIVOT * KEPT_PIVOT);
        let mut dense = false;
        let column = |j: usize| self.column(j);
        for (k, pivot) in self.pivots.iter().enumerate() {
            let mut largest = R::Control::from_f64((), 0.0);
            let mut diagonal = largest.clone();
            let mut look = |i: usize, size: R::Control| {
                largest.max(&size);
                if i == k {
                    diagonal = size;
                }
            };
            let ck = column(k);
            if dense {
                for i in k..n {
                    let size = sum(entries, stride, (i, ck), 0..k, &column);
                    look(i, size);
                }
            } else {
                for entry in &pivot.column {
                    let (i, terms) = (entry.at as usize, self.terms(&entry.terms));
                    let size = sum(entries, stride, (i, ck), terms, &column);
                    look(i, size);
                }
            }
            largest.mul(&kept);
            let small = diagonal.less(&largest);
            if small.any() {
                dense = true;
                for lane in 0..R::WIDTH {
                    if small.lane(lane) {
                        exchange_in(entries, stride, k..n, ck, n + RHS, lane);
                        exchanges.set_lane(lane, exchanges.lane(lane) + 1.0);
                    }
                }
            }
            let inverse = entries[k * stride + ck].inverse();
            let scale = |entries: &mut [Complex<R>], j: usize| {
                let mut quotient = Complex::zero(context);
                quotient.set_product(&entries[k * stride + j], &inverse);
                entries[k * stride + j].set(&quotient);
            };
            if dense {
                for j in k + 1..n {
                    sum(entries, stride, (k, column(j)), 0..k, &column);
                    scale(entries, column(j));
                }
                for r in n..n + RHS {
                    sum(entries, stride, (k, r), 0..k, &column);
                    scale(entries, r);
                }
            } else {
                for entry in &pivot.row {
                    let j = column(entry.at as usize);
                    sum(entries, stride, (k, j), self.terms(&entry.terms), &column);
                    scale(entries, j);
                }
                for r in n..n + RHS {
                    sum(entries, stride, (k, r), self.terms(&pivot.below), &column);
                    scale(entries, r);
                }
            }
        }
        for k in (0..n).rev() {
            for r in n..n + RHS {
                if dense {
                    sum(entries, stride, (k, r), k + 1..n, &column);
                } else {
                    let terms = self.terms(&self.pivots[k].above);
                    sum(entries, stride, (k, r), terms, &column);
                }
            }
        }
        self.sort_solutions::<R, RHS>(entries, stride);
    }

    /// Moves the solutions to the rows of their columns.
    ///
    /// A term that the lists leave out could change the sign of a 0, or bring in a value that is no number. A sum with
    /// `nothing`, which is 0 or no number, gives the same bits with and without these terms.
    #[inline(always)]
    fn sort_solutions<R: Real, const RHS: usize>(&self, entries: &mut [Complex<R>], stride: usize) {
        let n = self.columns.len();
        let zero = R::from_f64(entries[0].re.context(), 0.0);
        for r in n..n + RHS {
            let mut nothing = zero.clone();
            for k in 0..n {
                // The first column is free by now.
                let solution = entries[k * stride + r].clone();
                nothing.mul_add(&solution.re, &zero);
                nothing.mul_add(&solution.im, &zero);
                entries[self.column(k) * stride].set(&solution);
            }
            for i in 0..n {
                let mut solution = entries[i * stride].clone();
                solution.re.add(&nothing);
                solution.im.add(&nothing);
                entries[i * stride + r].set(&solution);
            }
        }
    }

    /// The column of the matrix that is column j of the elimination; right-hand sides stay where they are.
    #[inline(always)]
    fn column(&self, j: usize) -> usize {
        self.columns.get(j).copied().unwrap_or(j)
    }

    #[inline(always)]
    fn terms(&self, range: &Range<u32>) -> impl Iterator<Item = usize> {
        let terms = &self.list[range.start as usize..range.end as usize];
        terms.iter().map(|&m| m as usize)
    }
}

/// Subtracts the terms m from entry (row, column); the size of what is left.
#[inline(always)]
fn sum<R: Real>(
    entries: &mut [Complex<R>],
    stride: usize,
    (row, to): (usize, usize),
    terms: impl Iterator<Item = usize>,
    column: &impl Fn(usize) -> usize,
) -> R::Control {
    let mut sum = entries[row * stride + to].clone();
    for m in terms {
        sum.mul_sub(
            &entries[row * stride + column(m)],
            &entries[m * stride + to],
        );
    }
    entries[row * stride + to].set(&sum);
    sum.norm_sqr().control()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::lanes::dispatch::{Job, dispatch};
    use crate::linear_algebra::lu;
    use crate::random::{Purpose, RandomStream};
    use num_complex::Complex64;

    /// Some of the entries beside the diagonal, a few full rows and columns.
    fn random_pattern(n: usize, seed: u64) -> Vec<Vec<bool>> {
        let mut stream = RandomStream::new(seed, Purpose::Test, n as u64);
        let mut pattern: Vec<Vec<bool>> = (0..n)
            .map(|i| {
                let full = i % 11 == 3;
                (0..n)
                    .map(|j| (i * 7) % n == j || full && j % 2 == 0 || stream.uniform() < 0.06)
                    .collect()
            })
            .collect();
        for row in &mut pattern {
            row[n / 2] = true;
        }
        // (7 i mod n) is a permutation only where 7 does not divide n.
        assert!(!n.is_multiple_of(7));
        pattern
    }

    fn random_values(pattern: &[Vec<bool>], seed: u64) -> Vec<Complex64> {
        let n = pattern.len();
        let mut stream = RandomStream::new(seed, Purpose::Test, 1);
        let mut values = Vec::new();
        for row in pattern {
            for j in 0..n + 2 {
                let z = stream.disc();
                let there = row.get(j).copied().unwrap_or(true);
                values.push(if there { z } else { Complex64::default() });
            }
        }
        values
    }

    fn matrix<R: Real<Context = ()>>(n: usize, lanes: &[Vec<Complex64>]) -> Matrix<R> {
        let mut a = Matrix::zeros((), n, n + 2);
        for (lane, values) in lanes.iter().enumerate() {
            for (entry, z) in a.entries.iter_mut().zip(values) {
                entry.set_lane(lane, *z);
            }
        }
        a
    }

    /// Orders of rows and columns, the pattern with its rows in order, and that of any values.
    fn ordered(pattern: &[Vec<bool>], seed: u64) -> (Order, Vec<Vec<bool>>) {
        let n = pattern.len();
        let samples: Vec<Matrix<f64>> = (0..3)
            .map(|k| matrix(n, &[random_values(pattern, seed + 100 + k)]))
            .collect();
        let order = sparse_order(pattern, &samples);
        let rows = order.rows.iter().map(|&i| pattern[i].clone()).collect();
        (order, rows)
    }

    struct Sparse<'a, R: Real>(&'a SparseElimination, Matrix<R>);

    impl<R: Real<Context = (), Control = R>> Job for Sparse<'_, R> {
        type Output = (Matrix<R>, R);
        #[inline(always)]
        fn run(mut self) -> Self::Output {
            let mut exchanges = R::from_f64((), 0.0);
            self.0.eliminate::<R, 2>(&mut self.1, &mut exchanges);
            (self.1, exchanges)
        }
    }

    #[test]
    fn solutions_solve_and_little_fills_in() {
        for (n, seed) in [(5, 1), (23, 2), (40, 3), (66, 4)] {
            let pattern = random_pattern(n, seed);
            let (order, rows) = ordered(&pattern, seed);
            let elimination = SparseElimination::new(&rows, &order.columns);
            let values = random_values(&rows, seed);
            let a = matrix::<f64>(n, std::slice::from_ref(&values));
            let (solved, _) = dispatch(Sparse(&elimination, a.clone()));
            for r in n..n + 2 {
                for i in 0..n {
                    let mut rest = *a.at(i, r);
                    for j in 0..n {
                        rest.mul_sub(a.at(i, j), solved.at(j, r));
                    }
                    assert!(rest.norm_sqr() < 1e-16, "n = {n}: {}", rest.norm_sqr());
                }
            }
            if n > 20 {
                assert!(elimination.flops() * 3 < lu::flops(n as u64, 2), "n = {n}");
            }
        }
    }

    #[test]
    fn a_lane_is_the_same_in_any_company() {
        let n = 30;
        let pattern = random_pattern(n, 5);
        let (order, rows) = ordered(&pattern, 5);
        let elimination = SparseElimination::new(&rows, &order.columns);
        let mut lanes: Vec<Vec<Complex64>> = (0..8).map(|k| random_values(&rows, k)).collect();
        // A small pivot early and one late; a column of zeros; something that is no number.
        for (lane, k) in [(1, 2), (2, n - 3)] {
            lanes[lane][k * (n + 2) + order.columns[k]] *= 1e-9;
        }
        for i in 0..n {
            lanes[3][i * (n + 2) + order.columns[n / 2]] = Complex64::default();
        }
        lanes[4][order.columns[0]] = Complex64::new(f64::NAN, 0.0);
        let (together, exchanges) = dispatch(Sparse(&elimination, matrix::<Lanes<8>>(n, &lanes)));
        assert!(exchanges.lane(1) >= 1.0);
        for (lane, values) in lanes.iter().enumerate() {
            let alone = matrix::<f64>(n, std::slice::from_ref(values));
            let (alone, exchanged) = dispatch(Sparse(&elimination, alone));
            assert_eq!(exchanged, exchanges.lane(lane));
            for i in 0..n {
                for r in n..n + 2 {
                    let (a, b) = (together.at(i, r).lane(lane), alone.at(i, r).lane(0));
                    let none = lane == 3 || lane == 4;
                    assert_eq!(a.re.is_nan() && a.im.is_nan(), none, "lane {lane}: {a}");
                    assert!(
                        none || (a.re.to_bits(), a.im.to_bits())
                            == (b.re.to_bits(), b.im.to_bits())
                    );
                    assert!(!none || b.re.is_nan());
                }
            }
        }
    }
}
