//! Condition number of a small matrix, rows scaled, once at the end of a path.

use super::lu::eliminate;
use super::matrix::Matrix;
use crate::scalar::Complex;

/// `||A|| ||A^-1||` in the maximum norm of the n x n matrix in the first n columns of `a`, after
/// each row has been scaled to 1; infinite for a singular one.
///
/// The inverse is made column by column: n^3 work, done once a path.
pub fn condition_number(a: &Matrix<f64>) -> f64 {
    let n = a.rows();
    let modulus = |z: &Complex<f64>| z.norm_sqr().sqrt();
    let mut scaled = Matrix::<f64>::zeros((), n, n);
    for i in 0..n {
        let size: f64 = (0..n).map(|j| modulus(a.at(i, j))).sum();
        if size.is_nan() || size <= 0.0 {
            return f64::INFINITY;
        }
        for j in 0..n {
            let mut z = *a.at(i, j);
            z.scale(&(1.0 / size));
            *scaled.at_mut(i, j) = z;
        }
    }
    // Rows have norm 1, so the norm of A is 1 and what is left is the norm of the inverse.
    let mut work = Matrix::<f64>::zeros((), n, n + 1);
    let mut row_sums = vec![0.0; n];
    for column in 0..n {
        for i in 0..n {
            for j in 0..n {
                *work.at_mut(i, j) = *scaled.at(i, j);
            }
            *work.at_mut(i, n) = Complex::from_f64((), f64::from(i == column), 0.0);
        }
        eliminate::<f64, 1>(&mut work, &mut 0.0);
        for i in 0..n {
            row_sums[i] += modulus(work.at(i, n));
        }
    }
    let norm = row_sums
        .iter()
        .fold(0.0, |m: f64, &s| if s > m || s.is_nan() { s } else { m });
    if norm.is_nan() {
        f64::INFINITY
    } else {
        norm.max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_condition_numbers() {
        let mut a = Matrix::<f64>::zeros((), 2, 2);
        for (entry, value) in a.entries.iter_mut().zip([1.0, 0.0, 0.0, 1e-7]) {
            entry.re = value;
        }
        assert_eq!(condition_number(&a), 1.0); // only badly scaled
        for (entry, value) in a.entries.iter_mut().zip([1.0, 1.0, 1.0, 1.0 + 1e-8]) {
            entry.re = value;
        }
        let condition = condition_number(&a);
        assert!(condition > 1e8 && condition < 1e9, "{condition}");
        for (entry, value) in a.entries.iter_mut().zip([1.0, 1.0, 1.0, 1.0]) {
            entry.re = value;
        }
        assert_eq!(condition_number(&a), f64::INFINITY);
    }
}
