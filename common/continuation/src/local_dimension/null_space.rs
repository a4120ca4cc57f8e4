//! The null space of a large matrix by orthogonalisation with column pivoting, where singular values would take too
//! long: one pass instead of some ten sweeps.
//!
//! The remaining columns' lengths stand for singular values: they exceed the least of them by a factor that is small in
//! practice (Golub, Van Loan: Matrix Computations, section 5.5.7), and differ from noise by many orders of magnitude
//! where a rank is believed at all.

use super::split::square;
use cognate_numeric::linear_algebra::vector::inner;
use num_complex::Complex64;

/// A basis of what the matrix with these columns takes to 0, and the least factor by which a length differs from
/// `cut`, above which it is no noise.
pub(super) fn null_space(mut columns: Vec<Vec<Complex64>>, cut: f64) -> (Vec<Vec<Complex64>>, f64) {
    let n = columns.len();
    let mut order: Vec<usize> = (0..n).collect();
    // `upper[k][j]`: component of column j of `order` along the k-th direction.
    let mut upper: Vec<Vec<Complex64>> = Vec::new();
    let mut margin = f64::INFINITY;
    for k in 0..n {
        let length = |j: &usize| square(&columns[*j]);
        let longest = (k..n).max_by(|a, b| length(a).total_cmp(&length(b)));
        let longest = longest.expect("a column is left");
        let size = square(&columns[longest]).sqrt();
        if size <= cut {
            margin = margin.min(cut / size.max(f64::MIN_POSITIVE));
            break;
        }
        margin = margin.min(size / cut);
        columns.swap(k, longest);
        order.swap(k, longest);
        for row in &mut upper {
            row.swap(k, longest);
        }
        let mut row = vec![Complex64::default(); n];
        row[k] = Complex64::new(size, 0.0);
        let (done, left) = columns.split_at_mut(k + 1);
        let direction = &mut done[k];
        direction.iter_mut().for_each(|z| *z /= size);
        for (column, component) in left.iter_mut().zip(&mut row[k + 1..]) {
            *component = inner(direction, column);
            for (z, d) in column.iter_mut().zip(direction.iter()) {
                *z -= *component * d;
            }
        }
        upper.push(row);
    }
    let rank = upper.len();
    let mut basis: Vec<Vec<Complex64>> = Vec::new();
    for j in rank..n {
        let mut vector = vec![Complex64::default(); n];
        vector[order[j]] = Complex64::new(1.0, 0.0);
        for k in (0..rank).rev() {
            let solved_terms = (k + 1..rank).map(|i| upper[k][i] * vector[order[i]]);
            let sum = upper[k][j] + solved_terms.sum::<Complex64>();
            vector[order[k]] = -sum / upper[k][k];
        }
        for other in &basis {
            let component = inner(other, &vector);
            for (z, o) in vector.iter_mut().zip(other) {
                *z -= component * o;
            }
        }
        let size = square(&vector).sqrt();
        vector.iter_mut().for_each(|z| *z /= size);
        basis.push(vector);
    }
    (basis, margin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    #[test]
    fn vectors_that_are_taken_to_0_are_found() {
        // Twelve columns of length 20 that are combinations of seven.
        let mut random = RandomStream::new(1, Purpose::Test, 0);
        let mut vector = |n: usize| -> Vec<Complex64> { (0..n).map(|_| random.disc()).collect() };
        let directions: Vec<_> = (0..7).map(|_| vector(20)).collect();
        let columns: Vec<Vec<Complex64>> = (0..12)
            .map(|_| {
                let weights = vector(7);
                let component = |i: usize| -> Complex64 {
                    directions.iter().zip(&weights).map(|(d, w)| d[i] * w).sum()
                };
                (0..20).map(component).collect()
            })
            .collect();
        let (basis, margin) = null_space(columns.clone(), 1e-10);
        assert_eq!(basis.len(), 5);
        assert!(margin > 1e3, "{margin}");
        for (k, vector) in basis.iter().enumerate() {
            for i in 0..20 {
                let value: Complex64 = columns.iter().zip(vector).map(|(c, v)| c[i] * v).sum();
                assert!(value.norm_sqr() < 1e-24);
            }
            for (l, other) in basis.iter().enumerate() {
                let expected = f64::from(u8::from(k == l));
                assert!((inner(vector, other) - expected).norm_sqr() < 1e-24);
            }
        }
    }
}
