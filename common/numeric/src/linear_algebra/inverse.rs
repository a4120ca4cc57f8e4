//! The approximate inverse of a small matrix: of one in any arithmetic, which preconditions a proof, and of one in each lane.

use super::lu::eliminate_columns;
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

/// Writes the inverses of the n x n matrices in the first n columns of `work`, one in each lane, into its last n columns;
/// what was in both is lost. A singular matrix gives infinities or NaN in its lanes.
#[inline(always)]
pub fn invert<R: Real>(work: &mut Matrix<R>) {
    let n = work.rows();
    debug_assert!(
        work.columns() == 2 * n,
        "the inverse stands behind the matrix"
    );
    let context = work.at(0, 0).re.context();
    for i in 0..n {
        for j in 0..n {
            let entry = Complex::from_f64(context, if i == j { 1.0 } else { 0.0 }, 0.0);
            work.at_mut(i, n + j).set(&entry);
        }
    }
    eliminate_columns(work, n, &mut R::Control::from_f64((), 0.0));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
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

    #[test]
    fn lanes_have_their_own_inverses() {
        let mut random = RandomStream::new(6, Purpose::Test, 0);
        let n = 5;
        let mut work = Matrix::<Lanes<8>>::zeros((), n, 2 * n);
        let mut single = vec![Matrix::<f64>::zeros((), n, n); 8];
        for i in 0..n {
            for j in 0..n {
                for (lane, single) in single.iter_mut().enumerate() {
                    // One asks for an exchange, the last is singular.
                    let by = if lane == 3 && (i, j) == (0, 0) || lane == 7 && i == 2 {
                        0.0
                    } else {
                        1.0
                    };
                    let z = random.unit() * by;
                    work.at_mut(i, j).set_lane(lane, z);
                    *single.at_mut(i, j) = Complex::from_f64((), z.re, z.im);
                }
            }
        }
        invert(&mut work);
        for (lane, single) in single.iter().enumerate() {
            let Some(expected) = inverse((), single) else {
                assert_eq!(lane, 7);
                assert!(!work.at(2, n).lane(lane).is_finite());
                continue;
            };
            for i in 0..n {
                for j in 0..n {
                    let difference = work.at(i, n + j).lane(lane) - expected.at(i, j).lane(0);
                    assert!(difference.norm_sqr().sqrt() < 1e-11, "{difference}");
                }
            }
        }
    }
}
