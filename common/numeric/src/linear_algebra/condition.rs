//! Condition number of a small matrix, once at the end of a path.

use super::lu::eliminate_columns;
use super::matrix::Matrix;
use crate::scalar::{Complex, Real};

/// `||A|| ||A^-1||` in the maximum norm of the n x n matrix in the first n columns of `a`;
/// infinite for a singular one.
///
/// Rows are not scaled: where a multiple solution makes a whole gradient vanish (x^2 = 0),
/// scaling would hide it. The caller's equations have natural sizes of about 1.
/// The inverse is made by one elimination: n^3 work, done once a path. Beyond the inverse of the unit roundoff of
/// `R` the result says no more than that.
#[inline(always)]
pub fn condition_number<R: Real>(a: &Matrix<R>) -> f64 {
    let n = a.rows();
    let context = a.at(0, 0).re.context();
    let modulus = |z: &Complex<R>| z.norm_sqr().lane(0).sqrt();
    let mut work = Matrix::<R>::zeros(context, n, 2 * n);
    let mut of_matrix = 0.0;
    for i in 0..n {
        let mut sum = 0.0;
        for j in 0..n {
            work.at_mut(i, j).set(a.at(i, j));
            sum += modulus(a.at(i, j));
        }
        *work.at_mut(i, n + i) = Complex::from_f64(context, 1.0, 0.0);
        of_matrix = larger(of_matrix, sum);
    }
    eliminate_columns(&mut work, n, &mut R::Control::from_f64((), 0.0));
    let mut of_inverse = 0.0;
    for i in 0..n {
        let sum = (n..2 * n).map(|j| modulus(work.at(i, j))).sum();
        of_inverse = larger(of_inverse, sum);
    }
    let condition: f64 = of_matrix * of_inverse;
    if condition.is_nan() {
        f64::INFINITY
    } else {
        condition.max(1.0)
    }
}

/// The larger of two, where not being a number is largest.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
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
