//! Eigenvalues of a real symmetric matrix, by Jacobi's method of plane rotations.
//!
//! For small matrices, such as Hessians: the signs of eigenvalues are right to rounding relative to the largest one.

/// Sweeps over all entries; convergence is quadratic, and eight suffice for doubles.
const SWEEPS: usize = 40;

/// The eigenvalues, ascending, of the symmetric matrix with these rows, of which only the lower triangle is read.
///
/// # Panics
/// When the matrix is not square.
pub fn symmetric_eigenvalues(rows: &[Vec<f64>]) -> Vec<f64> {
    let n = rows.len();
    let mut a: Vec<Vec<f64>> = vec![vec![0.0; n]; n];
    for (i, row) in rows.iter().enumerate() {
        assert!(row.len() == n, "a square matrix");
        for j in 0..=i {
            a[i][j] = row[j];
            a[j][i] = row[j];
        }
    }
    for _ in 0..SWEEPS {
        let mut is_diagonal = true;
        for p in 0..n {
            for q in p + 1..n {
                let tiny = f64::EPSILON * 1e-3 * (a[p][p] * a[q][q]).abs().sqrt();
                if a[p][q] == 0.0 || a[p][q].abs() <= tiny {
                    continue;
                }
                is_diagonal = false;
                rotate(&mut a, p, q);
            }
        }
        if is_diagonal {
            break;
        }
    }
    let mut values: Vec<f64> = (0..n).map(|i| a[i][i]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Makes the entry at (p, q) 0 by a rotation of rows and columns p and q (Golub and Van Loan, Matrix Computations, 8.5).
fn rotate(a: &mut [Vec<f64>], p: usize, q: usize) {
    let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let sign = if tau < 0.0 { -1.0 } else { 1.0 };
    let tangent = sign / (tau.abs() + (1.0 + tau * tau).sqrt());
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    let sine = tangent * cosine;
    for row in a.iter_mut() {
        let (x, y) = (row[p], row[q]);
        row[p] = cosine * x - sine * y;
        row[q] = sine * x + cosine * y;
    }
    for k in 0..a.len() {
        let (x, y) = (a[p][k], a[q][k]);
        a[p][k] = cosine * x - sine * y;
        a[q][k] = sine * x + cosine * y;
    }
    a[p][q] = 0.0;
    a[q][p] = 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_of_the_second_difference() {
        // 2 - 2 cos(k pi / 4), k = 1, 2, 3 (Golub and Van Loan).
        let rows = [[2.0, 0.0, 0.0], [-1.0, 2.0, 0.0], [0.0, -1.0, 2.0]].map(Vec::from);
        let values = symmetric_eigenvalues(&rows);
        let root = 2.0f64.sqrt();
        for (value, expected) in values.iter().zip([2.0 - root, 2.0, 2.0 + root]) {
            assert!((value - expected).abs() < 1e-14, "{values:?}");
        }
        let exchange = symmetric_eigenvalues(&[vec![0.0, 0.0], vec![3.0, 0.0]]);
        assert!((exchange[0] + 3.0).abs() < 1e-14 && (exchange[1] - 3.0).abs() < 1e-14);
        assert_eq!(symmetric_eigenvalues(&[]), [0.0; 0]);
    }
}
