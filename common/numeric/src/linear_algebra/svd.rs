//! Singular values and a basis of the domain, by one-sided Jacobi rotations: ranks, null spaces, least squares.
//!
//! Slower than bidiagonalisation and simpler, and small singular values keep
//! their digits (Demmel, Veselic: Jacobi's method is more accurate than QR,
//! SIAM J. Matrix Anal. Appl. 13, 1992). For small matrices at the ends of paths; a solve of which many paths end on sets
//! spends much of its time here.

use super::vector::inner;
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

/// A column of A V above the same column of V, real and imaginary parts apart; rows are filled up with 0 to a multiple
/// of [`AT_ONCE`] before V begins.
struct Column {
    re: Vec<f64>,
    im: Vec<f64>,
    /// Squared length of the part of A V.
    square: f64,
}

/// Terms that are summed apart, so that sums are not one chain of additions.
const AT_ONCE: usize = 4;

fn terms(part: &[f64]) -> &[[f64; AT_ONCE]] {
    part.as_chunks().0
}

impl Column {
    /// The part of A V, `rows` long.
    fn parts(&self, rows: usize) -> (&[f64], &[f64]) {
        (&self.re[..rows], &self.im[..rows])
    }

    fn measure(&mut self, rows: usize) {
        let (re, im) = self.parts(rows);
        let mut sums = [0.0; AT_ONCE];
        for (re, im) in terms(re).iter().zip(terms(im)) {
            for k in 0..AT_ONCE {
                sums[k] += re[k] * re[k] + im[k] * im[k];
            }
        }
        self.square = sums.iter().sum();
    }

    /// The inner product of two columns of A V.
    fn inner(&self, other: &Self, rows: usize) -> Complex64 {
        let ((a, b), (x, y)) = (self.parts(rows), other.parts(rows));
        let (mut re, mut im) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
        let left = terms(a).iter().zip(terms(b));
        let right = terms(x).iter().zip(terms(y));
        for ((a, b), (x, y)) in left.zip(right) {
            for k in 0..AT_ONCE {
                re[k] += a[k] * x[k] + b[k] * y[k];
                im[k] += a[k] * y[k] - b[k] * x[k];
            }
        }
        Complex64::new(re.iter().sum(), im.iter().sum())
    }

    /// This column and another turned by the rotation that makes them orthogonal.
    fn turn(&mut self, other: &mut Self, c: f64, s: f64, phase: Complex64) {
        let left = self.re.iter_mut().zip(&mut self.im);
        let right = other.re.iter_mut().zip(&mut other.im);
        for ((a, b), (x, y)) in left.zip(right) {
            let re = *x * phase.re + *y * phase.im;
            let im = *y * phase.re - *x * phase.im;
            (*a, *x) = (*a * c - re * s, *a * s + re * c);
            (*b, *y) = (*b * c - im * s, *b * s + im * c);
        }
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
        let length = columns.first().map_or(0, Vec::len);
        let rows = length.next_multiple_of(AT_ONCE);
        let column = |(j, from): (usize, &Vec<Complex64>)| {
            let mut column = Column {
                re: vec![0.0; rows + n],
                im: vec![0.0; rows + n],
                square: 0.0,
            };
            for (i, z) in from.iter().enumerate() {
                (column.re[i], column.im[i]) = (z.re, z.im);
            }
            column.re[rows + j] = 1.0;
            column.measure(rows);
            column
        };
        let mut turned: Vec<Column> = columns.iter().enumerate().map(column).collect();
        for _ in 0..MOST_SWEEPS {
            if !sweep(&mut turned, rows) {
                break;
            }
        }
        turned.sort_by(|a, b| b.square.total_cmp(&a.square));
        let take = |range: std::ops::Range<usize>| {
            let part = |column: &Column| {
                let both = column.re[range.clone()]
                    .iter()
                    .zip(&column.im[range.clone()]);
                both.map(|(&re, &im)| Complex64::new(re, im)).collect()
            };
            turned.iter().map(part).collect()
        };
        Self {
            values: turned.iter().map(|column| column.square.sqrt()).collect(),
            domain: take(rows..rows + n),
            images: take(0..length),
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

/// Every pair of columns made orthogonal in turn, the longest first (de Rijk: A one-sided Jacobi algorithm for computing
/// the singular value decomposition on a vector computer, SIAM J. Sci. Stat. Comput. 10, 1989); whether one was not.
fn sweep(columns: &mut [Column], rows: usize) -> bool {
    let mut any = false;
    // Columns that are rounding errors of the largest have no direction.
    let noise = 1e-34 * columns.iter().map(|c| c.square).fold(0.0, f64::max);
    for p in 0..columns.len() {
        let longest = (p..columns.len()).max_by(|&a, &b| {
            columns[a]
                .square
                .total_cmp(&columns[b].square)
                .then(b.cmp(&a))
        });
        columns.swap(p, longest.unwrap_or(p));
        let (left, right) = columns.split_at_mut(p + 1);
        let this = &mut left[p];
        for other in right {
            let gamma = this.inner(other, rows);
            let size = gamma.norm_sqr().sqrt();
            if !(size > ORTHOGONAL * (this.square * other.square).sqrt() && size > noise) {
                continue;
            }
            any = true;
            let zeta = (other.square - this.square) / (2.0 * size);
            let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let c = 1.0 / (1.0 + t * t).sqrt();
            this.turn(other, c, c * t, gamma / size);
            this.measure(rows);
            other.measure(rows);
        }
    }
    any
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
        // A right-hand side may have a part orthogonal to the image: this part changes nothing.
        let wide = Svd::of(random(3, 6, 1));
        let b = random(3, 1, 2).remove(0);
        let short = wide.least_squares(&b, 3);
        assert!(distance(&times(&random(3, 6, 1), &short), &b) < 1e-13);
    }
}
