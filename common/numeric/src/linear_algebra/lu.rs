//! Elimination: solves J x = b for every lane at once, for any scalar and any width.
//!
//! Left-looking (Crout: each entry is one dot product that stays in registers),
//! in the row order that the caller prefers. A lane whose own pivot is small
//! exchanges rows for itself alone, by mask: no lane sees its neighbours, so a
//! path's bits do not depend on who shares its lanes.

use super::matrix::Matrix;
use crate::scalar::{Complex, Mask, Real};
use std::ops::Range;

/// A pivot is kept while its modulus is at least this part of its column's largest.
///
/// An exchange costs a lane's whole batch; on nine points 0.1 asked for 1.3 of them in each
/// elimination, 0.01 for a quarter, with the same steps and endpoints. Newton's method
/// corrects what a small pivot blurs.
pub const KEPT_PIVOT: f64 = 0.01;

/// Solves for the last `RHS` columns of the n x (n + extra) matrix `a`, of which the first n are J.
///
/// The right-hand sides are the columns n .. n+RHS; on return they hold the
/// solutions. `exchanges` grows by one for each lane and each row exchange.
/// A singular J gives infinities or NaN in its lanes, which no comparison accepts.
#[inline(always)]
pub fn eliminate<R: Real, const RHS: usize>(a: &mut Matrix<R>, exchanges: &mut R::Control) {
    eliminate_columns(a, RHS, exchanges);
}

/// [`eliminate`] with as many right-hand sides as are asked for.
#[inline(always)]
pub(super) fn eliminate_columns<R: Real>(
    a: &mut Matrix<R>,
    rhs: usize,
    exchanges: &mut R::Control,
) {
    let n = a.rows();
    let stride = a.columns();
    debug_assert!(
        stride >= n + rhs,
        "the right-hand sides stand behind the matrix"
    );
    let entries = &mut a.entries[..];
    let context = entries[0].re.context();
    let kept = R::Control::from_f64((), KEPT_PIVOT * KEPT_PIVOT);
    for k in 0..n {
        // Column k below the diagonal: a_ik - sum_{m<k} l_im u_mk.
        let mut largest = R::Control::from_f64((), 0.0);
        let mut diagonal = R::Control::from_f64((), 0.0);
        for i in k..n {
            let mut sum = entries[i * stride + k].clone();
            for m in 0..k {
                sum.mul_sub(&entries[i * stride + m], &entries[m * stride + k]);
            }
            let size = sum.norm_sqr().control();
            if i == k {
                diagonal = size.clone();
            }
            largest.max(&size);
            entries[i * stride + k].set(&sum);
        }
        let mut bound = largest.clone();
        bound.mul(&kept);
        let small = diagonal.less(&bound);
        if small.any() {
            for lane in 0..R::WIDTH {
                if small.lane(lane) {
                    exchange(entries, stride, k..n, n + rhs, lane);
                    exchanges.set_lane(lane, exchanges.lane(lane) + 1.0);
                }
            }
        }
        // Row k right of the diagonal, divided by the pivot: unit upper triangle.
        let inverse = entries[k * stride + k].inverse();
        for j in k + 1..n + rhs {
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
        for r in n..n + rhs {
            let mut sum = entries[k * stride + r].clone();
            for j in k + 1..n {
                sum.mul_sub(&entries[k * stride + j], &entries[j * stride + r]);
            }
            entries[k * stride + r].set(&sum);
        }
    }
}

/// Brings the row with the largest entry of column `rows.start` to its diagonal, in one lane.
#[inline(always)]
pub fn exchange<R: Real>(
    entries: &mut [Complex<R>],
    stride: usize,
    rows: Range<usize>,
    columns: usize,
    lane: usize,
) {
    let column = rows.start;
    exchange_in(entries, stride, rows, column, columns, lane);
}

/// Brings, of these rows, the one with the largest entry of this column to the place of the first,
/// in one lane; `columns` is how many columns a row has.
#[inline(always)]
pub(super) fn exchange_in<R: Real>(
    entries: &mut [Complex<R>],
    stride: usize,
    rows: Range<usize>,
    column: usize,
    columns: usize,
    lane: usize,
) {
    let first = rows.start;
    let mut best = (first, -1.0);
    for i in rows {
        let entry = &entries[i * stride + column];
        let (re, im) = (entry.re.lane(lane), entry.im.lane(lane));
        let size = re * re + im * im;
        if size > best.1 {
            best = (i, size);
        }
    }
    if best.0 == first {
        return;
    }
    let (above, below) = entries.split_at_mut(best.0 * stride);
    let upper = &mut above[first * stride..first * stride + columns];
    for (upper, lower) in upper.iter_mut().zip(below) {
        upper.swap_lane(lower, lane);
    }
}

/// The row order in which elimination rarely meets a small pivot, for matrices like these samples
/// (at least one, all of one size).
///
/// A stage takes it once, from points that its paths pass, as the order that they prefer: each
/// column's row is the one that would be kept in most samples, and among those the one with the
/// largest entries.
pub fn pivot_order(samples: &[Matrix<f64>]) -> Vec<usize> {
    /// Entries above this part of their column's largest are safe, and stay so for a while.
    const SAFE: f64 = 0.05;
    let n = samples[0].rows();
    let mut samples = samples.to_vec();
    let mut order: Vec<usize> = (0..n).collect();
    for k in 0..n {
        let mut best = (k, 0, f64::NEG_INFINITY);
        for i in k..n {
            let (mut kept, mut sum) = (0, 0.0);
            for work in &samples {
                let largest = (k..n).fold(0.0, |m: f64, i| {
                    let size = work.at(i, k).norm_sqr();
                    if size > m { size } else { m }
                });
                let part = work.at(i, k).norm_sqr() / largest;
                kept += u32::from(part >= SAFE * SAFE);
                sum += if part.is_finite() { part } else { 0.0 };
            }
            if (kept, sum) > (best.1, best.2) {
                best = (i, kept, sum);
            }
        }
        let best = best.0;
        order.swap(k, best);
        for work in &mut samples {
            for j in 0..n {
                let upper = *work.at(k, j);
                *work.at_mut(k, j) = *work.at(best, j);
                *work.at_mut(best, j) = upper;
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
        let order = pivot_order(std::slice::from_ref(&a));
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
