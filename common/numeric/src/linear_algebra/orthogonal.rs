//! Least squares by Householder's reflections, of matrices that are known to be well-conditioned: solved many
//! times, with the condition number that says whether they are.
//!
//! A tenth of the work of [`super::svd::Svd`], which is for all others.

use num_complex::Complex64;

/// A = Q R with reflections for Q.
#[derive(Clone, Debug)]
pub struct Orthogonal {
    rows: usize,
    columns: usize,
    /// Column after column: R above the diagonal, the reflections' vectors from the diagonal on.
    entries: Vec<Complex64>,
    /// Inverses of the diagonal of R, and 2 / |v|^2 of each reflection.
    inverses: Vec<Complex64>,
    scales: Vec<f64>,
    /// |R| |R^-1| in Frobenius norms: at least the condition number in the 2-norm, and at most that number times the
    /// number of columns. Infinite where a column is dependent.
    pub condition: f64,
}

impl Orthogonal {
    /// Of the matrix with these entries, column after column.
    ///
    /// # Panics
    /// When there are fewer rows than columns, or another number of entries.
    pub fn of(mut entries: Vec<Complex64>, rows: usize, columns: usize) -> Self {
        assert!(
            rows >= columns && entries.len() == rows * columns,
            "as many rows as columns, or more"
        );
        let mut inverses = vec![Complex64::default(); columns];
        let mut of_matrix = 0.0;
        let mut scales = vec![0.0; columns];
        for k in 0..columns {
            let (before, after) = entries.split_at_mut((k + 1) * rows);
            let vector = &mut before[k * rows + k..];
            let length = vector.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
            let first = vector[0].norm_sqr().sqrt();
            let turn = match first > 0.0 {
                true => vector[0] / first,
                false => Complex64::new(1.0, 0.0),
            };
            vector[0] += turn * length;
            inverses[k] = -turn.conj() / length;
            of_matrix += length * length;
            scales[k] = 1.0 / (length * (length + first));
            for column in after.chunks_exact_mut(rows) {
                reflect(vector, scales[k], &mut column[k..]);
            }
        }
        let mut made = Self {
            rows,
            columns,
            entries,
            inverses,
            scales,
            condition: f64::INFINITY,
        };
        made.condition = made.frobenius_condition(of_matrix);
        made
    }

    /// `diagonal`: the sum of the squares of the diagonal of R.
    fn frobenius_condition(&self, diagonal: f64) -> f64 {
        let n = self.columns;
        let mut of_matrix = diagonal;
        let mut of_inverse = 0.0;
        let mut column = vec![Complex64::default(); n];
        for k in 0..n {
            let above = &self.entries[k * self.rows..k * self.rows + k];
            of_matrix += above.iter().map(|z| z.norm_sqr()).sum::<f64>();
            column[..k].fill(Complex64::default());
            column[k] = Complex64::new(1.0, 0.0);
            self.substitute(&mut column[..=k]);
            of_inverse += column[..=k].iter().map(|z| z.norm_sqr()).sum::<f64>();
        }
        let condition = of_matrix.sqrt() * of_inverse.sqrt();
        if condition.is_nan() {
            f64::INFINITY
        } else {
            condition
        }
    }

    /// Solves R x = b for as many first unknowns as `b` has, in its place.
    fn substitute(&self, b: &mut [Complex64]) {
        for k in (0..b.len()).rev() {
            let (rest, x) = b.split_at_mut(k);
            x[0] *= self.inverses[k];
            let above = &self.entries[k * self.rows..k * self.rows + k];
            for (rest, a) in rest.iter_mut().zip(above) {
                *rest -= x[0] * a;
            }
        }
    }

    /// The x that makes |A x - b| least.
    ///
    /// # Panics
    /// When `b` has another length than the columns.
    pub fn least_squares(&self, b: &[Complex64]) -> Vec<Complex64> {
        assert_eq!(b.len(), self.rows, "a number for each row");
        let mut x = b.to_vec();
        for k in 0..self.columns {
            let vector = &self.entries[k * self.rows + k..(k + 1) * self.rows];
            reflect(vector, self.scales[k], &mut x[k..]);
        }
        x.truncate(self.columns);
        self.substitute(&mut x);
        x
    }
}

/// `x -= scale (v* x) v`.
fn reflect(v: &[Complex64], scale: f64, x: &mut [Complex64]) {
    let mut share = Complex64::default();
    for (v, x) in v.iter().zip(&*x) {
        share += v.conj() * x;
    }
    share *= scale;
    for (v, x) in v.iter().zip(x) {
        *x -= share * v;
    }
}

#[cfg(test)]
mod tests {
    use super::super::svd::Svd;
    use super::*;
    use crate::random::{Purpose, RandomStream};

    #[test]
    fn solutions_and_condition_are_those_of_singular_values() {
        let mut stream = RandomStream::new(4, Purpose::Test, 6);
        for (rows, columns, small) in [(5, 5, 1.0), (9, 4, 1.0), (1, 1, 1.0), (12, 12, 1e-6)] {
            let mut vectors: Vec<Vec<Complex64>> = (0..columns)
                .map(|_| (0..rows).map(|_| stream.disc()).collect())
                .collect();
            vectors[0].iter_mut().for_each(|z| *z *= small);
            let b: Vec<Complex64> = (0..rows).map(|_| stream.disc()).collect();
            let factorization = Orthogonal::of(vectors.concat(), rows, columns);
            let svd = Svd::of(vectors);
            let expected = svd.least_squares(&b, columns);
            let size = expected.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
            for (x, y) in factorization.least_squares(&b).iter().zip(&expected) {
                assert!((x - y).norm_sqr().sqrt() < 1e-9 * size, "{x} {y}");
            }
            let least = svd.values[0] / svd.values[columns - 1];
            let range = 0.999 * least..=1.001 * least * columns as f64;
            assert!(
                range.contains(&factorization.condition),
                "{}",
                factorization.condition
            );
        }
    }

    #[test]
    fn dependent_columns_have_no_condition() {
        let column: Vec<Complex64> = (1..=4).map(|k| Complex64::new(k as f64, 1.0)).collect();
        let twice = [column.clone(), column.clone()].concat();
        assert!(Orthogonal::of(twice, 4, 2).condition > 1e14);
        let zero = vec![Complex64::default(); 8];
        assert_eq!(Orthogonal::of(zero, 4, 2).condition, f64::INFINITY);
    }
}
