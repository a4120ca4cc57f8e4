//! Ranks: of matrices of residues by elimination, of matrices of doubles by singular values with a gap.

use super::field::{Doubles, Field, Residues};
use cognate_numeric::linear_algebra::svd::Svd;
use num_complex::Complex64;

/// Singular values below this part of the largest are 0: they are made by rounding.
pub const ZERO: f64 = 1e-11;
/// Singular values above this part of the largest are not 0. Between the two nothing is said: numbers that are typed to eight
/// digits leave singular values there.
pub const NONZERO: f64 = 1e-5;

/// Rows of a matrix.
pub type Matrix<E> = Vec<Vec<E>>;

/// Result of the elimination of a matrix J.
#[derive(Clone, Debug)]
pub struct Reduction<E> {
    /// The rank.
    pub rank: usize,
    /// Combinations of rows, as many as the rank: `solve` J `lift` is the identity.
    pub solve: Matrix<E>,
    /// Combinations of rows that are 0.
    pub rest: Matrix<E>,
    /// A basis of the kernel.
    pub kernel: Matrix<E>,
    /// Vectors, as many as the rank.
    pub lift: Matrix<E>,
}

/// A field that decides ranks; `Err` has a singular value, as a part of the largest, of which it is not clear whether it is 0.
pub trait Ranks: Field {
    /// The reduction of a matrix with `columns` columns.
    fn reduce(
        &self,
        rows: &Matrix<Self::Element>,
        columns: usize,
    ) -> Result<Reduction<Self::Element>, f64>;
    /// The rank.
    fn rank(&self, rows: Matrix<Self::Element>, columns: usize) -> Result<usize, f64>;
    /// Largest number of monomials of one order that is looked at, which is the number of columns of the matrices.
    fn most_monomials(&self) -> usize;
    /// Whether an element is 0, up to rounding of numbers of about 1.
    fn is_zero(&self, element: Self::Element) -> bool;
}

impl Residues {
    /// Row echelon form; columns of the pivots.
    fn eliminate(&self, rows: &mut Matrix<u64>, columns: usize) -> Vec<usize> {
        let mut pivots = Vec::new();
        for column in 0..columns {
            let top = pivots.len();
            let Some(pivot_row) = (top..rows.len()).find(|r| rows[*r][column] != 0) else {
                continue;
            };
            rows.swap(top, pivot_row);
            let over = self.inverse(rows[top][column]);
            let pivot: Vec<u64> = rows[top].iter().map(|x| self.multiply(*x, over)).collect();
            rows[top].clone_from(&pivot);
            for (r, row) in rows.iter_mut().enumerate() {
                let factor = row[column];
                if r == top || factor == 0 {
                    continue;
                }
                for (x, p) in row.iter_mut().zip(&pivot).filter(|(_, p)| **p != 0) {
                    *x = self.subtract(*x, self.multiply(factor, *p));
                }
            }
            pivots.push(column);
        }
        pivots
    }
}

impl Ranks for Residues {
    fn reduce(&self, rows: &Matrix<u64>, columns: usize) -> Result<Reduction<u64>, f64> {
        let m = rows.len();
        let unit = |n: usize, k: usize| (0..n).map(|i| u64::from(i == k)).collect::<Vec<_>>();
        let mut wide: Matrix<u64> = rows.clone();
        for (r, row) in wide.iter_mut().enumerate() {
            row.extend(unit(m, r));
        }
        let pivots = self.eliminate(&mut wide, columns);
        let rank = pivots.len();
        let free = (0..columns).filter(|c| !pivots.contains(c));
        let kernel = free
            .map(|c| {
                let mut vector = unit(columns, c);
                for (row, pivot) in wide.iter().zip(&pivots) {
                    vector[*pivot] = self.subtract(0, row[c]);
                }
                vector
            })
            .collect();
        let combination = |row: &Vec<u64>| row[columns..].to_vec();
        Ok(Reduction {
            rank,
            solve: wide[..rank].iter().map(combination).collect(),
            rest: wide[rank..].iter().map(combination).collect(),
            kernel,
            lift: pivots.iter().map(|c| unit(columns, *c)).collect(),
        })
    }

    fn rank(&self, mut rows: Matrix<u64>, columns: usize) -> Result<usize, f64> {
        Ok(self.eliminate(&mut rows, columns).len())
    }

    fn most_monomials(&self) -> usize {
        220
    }

    fn is_zero(&self, element: u64) -> bool {
        element == 0
    }
}

/// The rank by singular values, in descending order.
fn rank_of(values: &[f64]) -> Result<usize, f64> {
    let largest = values.first().copied().unwrap_or(0.0);
    // Equations are divided by the size: a matrix of rounding errors is 0.
    if largest <= ZERO {
        return Ok(0);
    }
    let parts = values.iter().map(|x| x / largest);
    match parts.clone().find(|x| (ZERO..NONZERO).contains(x)) {
        Some(between) => Err(between),
        None => Ok(parts.filter(|x| *x >= NONZERO).count()),
    }
}

fn columns_of(rows: &Matrix<Complex64>, columns: usize) -> Vec<Vec<Complex64>> {
    let column = |c: usize| rows.iter().map(|row| row[c]).collect();
    (0..columns).map(column).collect()
}

/// Singular values of a matrix, in descending order.
pub fn singular_values(rows: &Matrix<Complex64>, columns: usize) -> Vec<f64> {
    if rows.is_empty() || columns == 0 {
        return Vec::new();
    }
    let mut values = Svd::of(columns_of(rows, columns)).values;
    values.truncate(rows.len());
    values
}

impl Ranks for Doubles {
    fn reduce(
        &self,
        rows: &Matrix<Complex64>,
        columns: usize,
    ) -> Result<Reduction<Complex64>, f64> {
        let unit = |n: usize, k: usize| -> Vec<Complex64> {
            (0..n).map(|i| f64::from(u8::from(i == k)).into()).collect()
        };
        if rows.is_empty() {
            return Ok(Reduction {
                rank: 0,
                solve: Vec::new(),
                rest: Vec::new(),
                kernel: (0..columns).map(|k| unit(columns, k)).collect(),
                lift: Vec::new(),
            });
        }
        let right = Svd::of(columns_of(rows, columns));
        let conjugate = |row: &Vec<Complex64>| row.iter().map(Complex64::conj).collect::<Vec<_>>();
        let left = Svd::of(rows.iter().map(conjugate).collect());
        let rank = rank_of(&right.values[..columns.min(rows.len())])?;
        let solve = (0..rank).map(|k| {
            let square = right.values[k] * right.values[k];
            right.images[k].iter().map(|x| x.conj() / square).collect()
        });
        Ok(Reduction {
            rank,
            solve: solve.collect(),
            rest: left.domain[rank..].iter().map(conjugate).collect(),
            kernel: right.domain[rank..].to_vec(),
            lift: right.domain[..rank].to_vec(),
        })
    }

    fn rank(&self, rows: Matrix<Complex64>, columns: usize) -> Result<usize, f64> {
        // Conditions of different orders have different sizes.
        let scaled = rows.into_iter().filter_map(|row| {
            let length = row.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
            (length > ZERO).then(|| row.iter().map(|x| x / length).collect())
        });
        let scaled: Matrix<Complex64> = scaled.collect();
        rank_of(&singular_values(&scaled, columns))
    }

    fn most_monomials(&self) -> usize {
        // Singular values take longer than elimination, and high orders lose digits.
        60
    }

    fn is_zero(&self, element: Complex64) -> bool {
        element.norm_sqr() <= ZERO * ZERO
    }
}
