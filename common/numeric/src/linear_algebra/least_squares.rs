//! Least squares of well-conditioned small systems, by modified Gram-Schmidt orthogonalisation of the matrix
//! with its right-hand side, which is as stable as Householder's reflections (Björck: Solving linear least
//! squares problems by Gram-Schmidt orthogonalization, BIT 7, 1967).

use super::vector::{inner, square};
use num_complex::Complex64;

/// A column of which no more than this part is left when those before it are taken out belongs to a matrix for
/// [`super::svd::Svd`].
const DEPENDENT: f64 = 1e-6;

/// The x for which |A x - b| is least, where A has these columns; `None` where they are nearly dependent, or
/// no numbers.
///
/// # Panics
/// When columns and right-hand side differ in length.
pub fn least_squares(columns: &[Vec<Complex64>], b: &[Complex64]) -> Option<Vec<Complex64>> {
    let rows = b.len();
    assert!(
        columns.iter().all(|column| column.len() == rows),
        "columns are as long as the right-hand side"
    );
    let n = columns.len();
    let mut left: Vec<Vec<Complex64>> = columns.iter().cloned().chain([b.to_vec()]).collect();
    // R, and last Q* b, row after row.
    let mut upper = vec![vec![Complex64::default(); n + 1]; n];
    for j in 0..n {
        let (before, after) = left.split_at_mut(j + 1);
        let unit = &mut before[j];
        let length = square(unit).sqrt();
        let enough = length > DEPENDENT * square(&columns[j]).sqrt();
        if !enough {
            return None;
        }
        unit.iter_mut().for_each(|q| *q /= length);
        upper[j][j] = length.into();
        for (k, column) in (j + 1..).zip(after) {
            let share = inner(unit, column);
            column
                .iter_mut()
                .zip(&*unit)
                .for_each(|(a, q)| *a -= share * q);
            upper[j][k] = share;
        }
    }
    let mut x = vec![Complex64::default(); n];
    for j in (0..n).rev() {
        let substituted: Complex64 = (j + 1..n).map(|k| upper[j][k] * x[k]).sum();
        x[j] = (upper[j][n] - substituted) / upper[j][j];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::super::svd::Svd;
    use super::*;
    use crate::random::{Purpose, RandomStream};

    #[test]
    fn it_agrees_with_singular_values() {
        let mut random = RandomStream::new(1, Purpose::Probe, 0);
        for (rows, n) in [(1, 1), (4, 4), (9, 5), (12, 11)] {
            let mut vector = || (0..rows).map(|_| random.disc()).collect::<Vec<_>>();
            let columns: Vec<_> = (0..n).map(|_| vector()).collect();
            let b = vector();
            let expected = Svd::of(columns.clone()).least_squares(&b, n);
            let solution = least_squares(&columns, &b).expect("random columns are independent");
            let off: Vec<Complex64> = solution.iter().zip(&expected).map(|(a, b)| a - b).collect();
            assert!(
                square(&off) < 1e-24 * square(&expected).max(1.0),
                "{rows} x {n}"
            );
        }
    }

    #[test]
    fn dependent_columns_are_refused() {
        let one = Complex64::new(1.0, 0.0);
        let nearly = vec![one, one * (1.0 + 1e-9)];
        assert_eq!(least_squares(&[vec![one, one], nearly], &[one, one]), None);
        let nothing = vec![Complex64::default(); 2];
        assert_eq!(least_squares(&[nothing], &[one, one]), None);
        let no_number = vec![Complex64::new(f64::NAN, 0.0), one];
        assert_eq!(least_squares(&[no_number], &[one, one]), None);
    }
}
