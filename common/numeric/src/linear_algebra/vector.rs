//! Products of short vectors of complex doubles.

use num_complex::Complex64;

/// The inner product conj(a) . b, summed in the order of the coordinates.
pub fn inner(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    let mut sum = Complex64::default();
    for (x, y) in a.iter().zip(b) {
        sum += x.conj() * y;
    }
    sum
}

/// The square of the Euclidean length, summed in the order of the coordinates.
pub fn square(a: &[Complex64]) -> f64 {
    a.iter().map(|z| z.norm_sqr()).sum()
}
