//! Elimination: solves J x = b for every lane at once, for any scalar and any width.
//!
//! Left-looking (Crout: each entry is one dot product that stays in registers),
//! in the row order that the caller prefers. A lane whose own pivot is small
//! exchanges rows for itself alone, by mask: no lane sees its neighbours, so a
//! path's bits do not depend on who shares its lanes.

use super::matrix::Matrix;
use crate::scalar::{Complex, Mask, Real};

/// A pivot is kept while its modulus is at least this part of its column's largest.
const KEPT_PIVOT: f64 = 0.1;

/// Solves for the last `RHS` columns of the n x (n + extra) matrix `a`, of which the first n are J.
///
/// The right-hand sides are the columns n .. n+RHS; on return they hold the
/// solutions. `exchanges` grows by one for each lane and each row exchange.
/// A singular J gives infinities or NaN in its lanes, which no comparison accepts.
#[inline(always)]
pub fn eliminate<R: Real, const RHS: usize>(a: &mut Matrix<R>, exchanges: &mut R::Control) {
    let n = a.rows();
    let stride = a.columns();
    debug_assert!(
        stride >= n + RHS,
        "the right-hand sides stand behind the matrix"
    );
    let entries = &mut a.entries[..];
    let context = entries[0].re.context();
    let kept = R::Control::from_f64((), KEPT_PIVOT * KEPT_PIVOT);
    let one = R::Control::from_f64((), 1.0);
    for k in 0..n {
        // Column k below the diagonal: a_ik - sum_{m<k} l_im u_mk.
        let mut largest = R::Control::from_f64((), 0.0);
        let mut own = R::Control::from_f64((), 0.0);
        for i in k..n {
            let mut sum = entries[i * stride + k].clone();
            for m in 0..k {
                sum.mul_sub(&entries[i * stride + m], &entries[m * stride + k]);
            }
            let size = sum.norm_sqr().control();
            if i == k {
                own = size.clone();
            }
            largest.max(&size);
            entries[i * stride + k].set(&sum);
        }
        let mut bound = largest.clone();
        bound.mul(&kept);
        let small = own.less(&bound);
        if small.any() {
            let mut wanted = small;
            for i in k + 1..n {
                let size = entries[i * stride + k].norm_sqr().control();
                let here = wanted.and(largest.less_equal(&size));
                if !here.any() {
                    continue;
                }
                wanted = wanted.and(here.not());
                let mut count = R::Control::from_f64((), 0.0);
                count.select(here, &one);
                exchanges.add(&count);
                for j in 0..n + RHS {
                    let upper = entries[k * stride + j].clone();
                    let lower = entries[i * stride + j].clone();
                    entries[k * stride + j].select(here, &lower);
                    entries[i * stride + j].select(here, &upper);
                }
            }
        }
        // Row k right of the diagonal, divided by the pivot: unit upper triangle.
        let inverse = entries[k * stride + k].inverse();
        for j in k + 1..n + RHS {
            let mut sum = entries[k * stride + j].clone();
            for m in 0..k {
                sum.mul_sub(&entries[k * stride + m], &entries[m * stride + j]);
            }
            let mut quotient = Complex::zero(context);
            quotient.set_product(&sum, &inverse);
            entries[k * stride + j].set(&quotient);
        }
    }
    for k in (0..n).rev() {
        for r in n..n + RHS {
            let mut sum = entries[k * stride + r].clone();
            for j in k + 1..n {
                sum.mul_sub(&entries[k * stride + j], &entries[j * stride + r]);
            }
            entries[k * stride + r].set(&sum);
        }
    }
}

/// The row order in which elimination with full column comparison meets its pivots.
///
/// A stage takes it once, from a probe point, as the order that its paths prefer.
pub fn pivot_order(a: &Matrix<f64>) -> Vec<usize> {
    let n = a.rows();
    let mut work = a.clone();
    let mut order: Vec<usize> = (0..n).collect();
    for k in 0..n {
        let size = |i: usize| work.at(i, k).norm_sqr();
        let best = (k..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
        if best != k {
            order.swap(k, best);
            for j in 0..n {
                let upper = *work.at(k, j);
                *work.at_mut(k, j) = *work.at(best, j);
                *work.at_mut(best, j) = upper;
            }
        }
        let inverse = work.at(k, k).inverse();
        for i in k + 1..n {
            let mut factor = *work.at(i, k);
            factor.mul(&inverse);
            for j in k + 1..n {
                let pivot_row = *work.at(k, j);
                work.at_mut(i, j).mul_sub(&factor, &pivot_row);
            }
        }
    }
    order
}

/// Real flops of one elimination with `rhs` right-hand sides, divisions counted as one.
pub fn flops(n: u64, rhs: u64) -> u64 {
    // Complex multiply-subtracts: the triangle of LU, and both substitutions.
    let lu = (0..n).map(|k| (n - k) * k + (n - 1 - k) * k).sum::<u64>();
    let substitutions = rhs * (0..n).map(|k| k + (n - 1 - k)).sum::<u64>();
    let products = (0..n).map(|k| n - 1 - k + rhs).sum::<u64>();
    8 * (lu + substitutions) + 6 * products + 6 * n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::random::{Purpose, RandomStream};
    use num_complex::Complex64;

    fn random_matrix(n: usize, seed: u64, tiny_pivots: bool) -> Vec<Complex64> {
        let mut stream = RandomStream::new(seed, Purpose::Test, n as u64);
        let mut m: Vec<Complex64> = (0..n * (n + 2)).map(|_| stream.disc()).collect();
        if tiny_pivots {
            for k in 0..n {
                m[k * (n + 2) + k] *= 1e-9;
            }
        }
        m
    }

    fn solve<R: Real>(
        context: R::Context,
        n: usize,
        lanes: &[Vec<Complex64>],
    ) -> (Matrix<R>, R::Control) {
        let mut a = Matrix::<R>::zeros(context, n, n + 2);
        for (lane, m) in lanes.iter().enumerate() {
            for (entry, value) in a.entries.iter_mut().zip(m) {
                entry.set_lane(lane, *value);
            }
        }
        let mut exchanges = R::Control::from_f64((), 0.0);
        eliminate::<R, 2>(&mut a, &mut exchanges);
        (a, exchanges)
    }

    #[test]
    fn solutions_satisfy_the_equations_and_lanes_agree_with_one_path() {
        for n in [1, 2, 5, 8, 13] {
            let lanes: Vec<_> = (0..8).map(|l| random_matrix(n, l, l % 3 == 0)).collect();
            let (wide, wide_exchanges) = solve::<Lanes<8>>((), n, &lanes);
            for (lane, m) in lanes.iter().enumerate() {
                let (narrow, exchanges) = solve::<f64>((), n, std::slice::from_ref(m));
                assert_eq!(exchanges, wide_exchanges.lane(lane));
                for r in n..n + 2 {
                    for i in 0..n {
                        assert_eq!(narrow.at(i, r).lane(0), wide.at(i, r).lane(lane));
                        let mut sum = -m[i * (n + 2) + r];
                        for j in 0..n {
                            sum += m[i * (n + 2) + j] * narrow.at(j, r).lane(0);
                        }
                        assert!(sum.norm_sqr() < 1e-18, "n = {n}, lane {lane}: {sum}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_pivot_order_needs_no_exchange() {
        let n = 7;
        let m = random_matrix(n, 3, true);
        let mut a = Matrix::<f64>::zeros((), n, n + 2);
        for (entry, value) in a.entries.iter_mut().zip(&m) {
            entry.set_lane(0, *value);
        }
        let order = pivot_order(&a);
        let ordered: Vec<Complex64> = order
            .iter()
            .flat_map(|&i| m[i * (n + 2)..(i + 1) * (n + 2)].to_vec())
            .collect();
        let (_, exchanges) = solve::<f64>((), n, &[ordered]);
        assert_eq!(exchanges, 0.0);
    }

    #[test]
    fn a_small_pivot_is_exchanged() {
        let (_, exchanges) = solve::<f64>((), 6, &[random_matrix(6, 1, true)]);
        assert!(exchanges >= 1.0);
    }
}
