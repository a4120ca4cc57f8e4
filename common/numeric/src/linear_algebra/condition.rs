//! Condition number of a small matrix, once at the end of a path.

use super::lu::eliminate;
use super::matrix::Matrix;
use crate::scalar::Complex;

/// `||A|| ||A^-1||` in the maximum norm of the n x n matrix in the first n columns of `a`;
/// infinite for a singular one.
///
/// Rows are not scaled: where a multiple solution makes a whole gradient vanish (x^2 = 0),
/// scaling would hide it. The caller's equations have natural sizes of about 1.
/// The inverse is made column by column: n^4 work at the sizes of mechanisms, done once a path.
pub fn condition_number(a: &Matrix<f64>) -> f64 {
    let n = a.rows();
    let modulus = |z: &Complex<f64>| z.norm_sqr().sqrt();
    let largest = |sums: &[f64]| {
        sums.iter()
            .fold(0.0, |m: f64, &s| if s > m || s.is_nan() { s } else { m })
    };
    let rows: Vec<f64> = (0..n)
        .map(|i| (0..n).map(|j| modulus(a.at(i, j))).sum())
        .collect();
    let mut work = Matrix::<f64>::zeros((), n, n + 1);
    let mut row_sums = vec![0.0; n];
    for column in 0..n {
        for i in 0..n {
            for j in 0..n {
                *work.at_mut(i, j) = *a.at(i, j);
            }
            *work.at_mut(i, n) = Complex::from_f64((), f64::from(i == column), 0.0);
        }
        eliminate::<f64, 1>(&mut work, &mut 0.0);
        for i in 0..n {
            row_sums[i] += modulus(work.at(i, n));
        }
    }
    let condition = largest(&rows) * largest(&row_sums);
    if condition.is_nan() {
        f64::INFINITY
    } else {
        condition.max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_condition_numbers() {
        let mut a = Matrix::<f64>::zeros((), 2, 2);
        for (entry, value) in a.entries.iter_mut().zip([1.0, 0.0, 0.0, 0.125]) {
            entry.re = value;
        }
        assert_eq!(condition_number(&a), 8.0);
        for (entry, value) in a.entries.iter_mut().zip([1.0, 1.0, 1.0, 1.0 + 1e-8]) {
            entry.re = value;
        }
        let condition = condition_number(&a);
        assert!(condition > 3e8 && condition < 5e8, "{condition}");
        for (entry, value) in a.entries.iter_mut().zip([1.0, 1.0, 1.0, 1.0]) {
            entry.re = value;
        }
        assert_eq!(condition_number(&a), f64::INFINITY);
    }
}
