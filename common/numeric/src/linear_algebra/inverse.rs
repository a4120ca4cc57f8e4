//! The approximate inverse of one small matrix, in any arithmetic: what preconditions a proof.

use super::matrix::Matrix;
use crate::scalar::{Complex, Real};

/// The inverse of the square matrix `a`, by Gauss and Jordan with partial pivoting; `None` where
/// a pivot is 0 or not a number. For one path at a time.
pub fn inverse<R: Real<Mask = bool, Control = f64>>(
    context: R::Context,
    a: &Matrix<R>,
) -> Option<Matrix<R>> {
    let n = a.rows();
    debug_assert!(a.columns() == n, "only a square matrix has an inverse");
    let mut left = a.clone();
    let mut right = Matrix::zeros(context, n, n);
    for i in 0..n {
        *right.at_mut(i, i) = Complex::from_f64(context, 1.0, 0.0);
    }
    for k in 0..n {
        let size = |left: &Matrix<R>, i: usize| left.at(i, k).norm_sqr().control();
        let pivot = (k..n).fold(k, |best, i| {
            if size(&left, i) > size(&left, best) {
                i
            } else {
                best
            }
        });
        let largest = size(&left, pivot);
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        for matrix in [&mut left, &mut right] {
            for j in 0..n {
                matrix.entries.swap(k * n + j, pivot * n + j);
            }
        }
        let scale = left.at(k, k).inverse();
        for matrix in [&mut left, &mut right] {
            for j in 0..n {
                matrix.at_mut(k, j).mul(&scale);
            }
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = left.at(i, k).clone();
            for matrix in [&mut left, &mut right] {
                for j in 0..n {
                    let above = matrix.at(k, j).clone();
                    matrix.at_mut(i, j).mul_sub(&factor, &above);
                }
            }
        }
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, RandomStream};
    use crate::scalar::MultiplePrecision;

    fn check<R: Real<Mask = bool, Control = f64>>(context: R::Context, tolerance: f64) {
        let mut random = RandomStream::new(5, Purpose::Test, 0);
        for n in [1, 2, 7] {
            let mut a = Matrix::<R>::zeros(context, n, n);
            for entry in &mut a.entries {
                let z = random.unit();
                *entry = Complex::from_f64(context, z.re, z.im);
            }
            if n > 1 {
                *a.at_mut(0, 0) = Complex::zero(context); // asks for an exchange
            }
            let b = inverse(context, &a).unwrap();
            for i in 0..n {
                for j in 0..n {
                    let mut sum = Complex::from_f64(context, if i == j { -1.0 } else { 0.0 }, 0.0);
                    for k in 0..n {
                        sum.mul_add(a.at(i, k), b.at(k, j));
                    }
                    assert!(sum.norm_sqr().control() < tolerance * tolerance);
                }
            }
        }
        assert!(inverse(context, &Matrix::<R>::zeros(context, 2, 2)).is_none());
    }

    #[test]
    fn a_matrix_times_its_inverse_is_one() {
        check::<f64>((), 1e-13);
        check::<MultiplePrecision>(200, 1e-55);
    }
}
