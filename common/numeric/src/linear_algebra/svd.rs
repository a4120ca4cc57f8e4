//! Singular values and a basis of the domain, by one-sided Jacobi rotations: ranks, null spaces, least squares.
//!
//! Slower than bidiagonalisation and simpler, and small singular values keep
//! their digits (Demmel, Veselic: Jacobi's method is more accurate than QR,
//! SIAM J. Matrix Anal. Appl. 13, 1992). For single small matrices at the end of a
//! path; nothing here is in an inner loop.

use super::vector::{inner, square};
use num_complex::Complex64;

/// A matrix as columns, and A V = U S with orthonormal V and the singular values S.
#[derive(Clone, Debug)]
pub struct Svd {
    /// Singular values, descending; as many as the matrix has columns.
    pub values: Vec<f64>,
    /// Columns of V in the same order: an orthonormal basis of the domain. Those of singular
    /// value 0 span the null space.
    pub domain: Vec<Vec<Complex64>>,
    /// A V: images of the basis, orthogonal, as long as the singular values say.
    pub images: Vec<Vec<Complex64>>,
}

/// Rotations end when every pair of columns is orthogonal to this.
const ORTHOGONAL: f64 = 1e-15;
/// More sweeps than any matrix needs; convergence is quadratic.
const MOST_SWEEPS: usize = 60;

/// Two columns turned by the rotation that makes the columns orthogonal.
fn turn(p: &mut [Complex64], q: &mut [Complex64], c: f64, s: f64, phase: Complex64) {
    for (a, b) in p.iter_mut().zip(q) {
        let turned = *b * phase.conj();
        let (x, y) = (*a * c - turned * s, *a * s + turned * c);
        *a = x;
        *b = y;
    }
}

impl Svd {
    /// Of the matrix with these columns, all of one length.
    ///
    /// # Panics
    /// When the columns differ in length.
    pub fn of(columns: Vec<Vec<Complex64>>) -> Self {
        let n = columns.len();
        assert!(
            columns.windows(2).all(|w| w[0].len() == w[1].len()),
            "a matrix has columns of one length"
        );
        let mut images = columns;
        let mut domain: Vec<Vec<Complex64>> = (0..n)
            .map(|j| {
                let mut unit = vec![Complex64::default(); n];
                unit[j] = Complex64::new(1.0, 0.0);
                unit
            })
            .collect();
        for _ in 0..MOST_SWEEPS {
            let mut turned = false;
            let largest = images.iter().map(|c| square(c)).fold(0.0, f64::max);
            for p in 0..n {
                for q in p + 1..n {
                    let (alpha, beta) = (square(&images[p]), square(&images[q]));
                    let gamma = inner(&images[p], &images[q]);
                    let size = gamma.norm_sqr().sqrt();
                    // Columns that are rounding errors of the largest have no direction.
                    let noise = 1e-34 * largest;
                    if !(size > ORTHOGONAL * (alpha * beta).sqrt() && size > noise) {
                        continue;
                    }
                    turned = true;
                    let zeta = (beta - alpha) / (2.0 * size);
                    let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                    let c = 1.0 / (1.0 + t * t).sqrt();
                    let s = c * t;
                    let phase = gamma / size;
                    let (left, right) = images.split_at_mut(q);
                    turn(&mut left[p], &mut right[0], c, s, phase);
                    let (left, right) = domain.split_at_mut(q);
                    turn(&mut left[p], &mut right[0], c, s, phase);
                }
            }
            if !turned {
                break;
            }
        }
        let sizes: Vec<f64> = images.iter().map(|c| square(c).sqrt()).collect();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]).then(a.cmp(&b)));
        let take = |from: &[Vec<Complex64>]| order.iter().map(|&k| from[k].clone()).collect();
        Self {
            values: order.iter().map(|&k| sizes[k]).collect(),
            domain: take(&domain),
            images: take(&images),
        }
    }

    /// The shortest x that makes |A x - b| least, where singular values from number `rank` on
    /// count as 0.
    pub fn least_squares(&self, b: &[Complex64], rank: usize) -> Vec<Complex64> {
        let mut x = vec![Complex64::default(); self.domain.len()];
        for k in 0..rank.min(self.values.len()) {
            let factor = inner(&self.images[k], b) / (self.values[k] * self.values[k]);
            for (x, v) in x.iter_mut().zip(&self.domain[k]) {
                *x += factor * v;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, RandomStream};

    fn random(rows: usize, columns: usize, seed: u64) -> Vec<Vec<Complex64>> {
        let mut stream = RandomStream::new(seed, Purpose::Test, 5);
        (0..columns)
            .map(|_| (0..rows).map(|_| stream.disc()).collect())
            .collect()
    }

    fn times(columns: &[Vec<Complex64>], x: &[Complex64]) -> Vec<Complex64> {
        let mut y = vec![Complex64::default(); columns.first().map_or(0, Vec::len)];
        for (column, x) in columns.iter().zip(x) {
            for (y, a) in y.iter_mut().zip(column) {
                *y += a * x;
            }
        }
        y
    }

    fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
        a.iter()
            .zip(b)
            .map(|(x, y)| (x - y).norm_sqr())
            .sum::<f64>()
            .sqrt()
    }

    #[test]
    fn the_basis_is_orthonormal_and_mapped_to_orthogonal_images() {
        for (rows, columns) in [(5, 5), (7, 3), (3, 6), (1, 1), (40, 30)] {
            let a = random(rows, columns, 3);
            let svd = Svd::of(a.clone());
            for i in 0..columns {
                assert!(distance(&times(&a, &svd.domain[i]), &svd.images[i]) < 1e-13);
                for j in 0..columns {
                    let expected = f64::from(u8::from(i == j));
                    let v = inner(&svd.domain[i], &svd.domain[j]);
                    assert!((v - expected).norm_sqr().sqrt() < 1e-13);
                    if i != j {
                        let u = inner(&svd.images[i], &svd.images[j]).norm_sqr().sqrt();
                        assert!(u < 1e-13 * svd.values[0] * svd.values[0]);
                    }
                }
            }
            assert!(svd.values.windows(2).all(|w| w[0] >= w[1]));
            let rank = rows.min(columns);
            assert!(svd.values[rank - 1] > 1e-3);
            assert!(svd.values[rank..].iter().all(|&s| s < 1e-14));
        }
    }

    #[test]
    fn known_singular_values() {
        // diag(3, 4e-12) turned by a rotation on the left: Jacobi keeps the small one's digits.
        let number = |re: f64| Complex64::new(re, 0.0);
        let svd = Svd::of(vec![
            vec![number(3.0 * 0.6), number(3.0 * 0.8)],
            vec![number(-4e-12 * 0.8), number(4e-12 * 0.6)],
        ]);
        assert!((svd.values[0] - 3.0).abs() < 1e-14);
        assert!((svd.values[1] - 4e-12).abs() < 1e-26);
    }

    #[test]
    fn least_squares_solves_what_can_be_solved() {
        let a = random(6, 4, 8);
        let x: Vec<Complex64> = random(4, 1, 9).remove(0);
        let svd = Svd::of(a.clone());
        assert!(distance(&svd.least_squares(&times(&a, &x), 4), &x) < 1e-13);
        // What is orthogonal to the image changes nothing.
        let wide = Svd::of(random(3, 6, 1));
        let b = random(3, 1, 2).remove(0);
        let short = wide.least_squares(&b, 3);
        assert!(distance(&times(&random(3, 6, 1), &short), &b) < 1e-13);
    }
}
