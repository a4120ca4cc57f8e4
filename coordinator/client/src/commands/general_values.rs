//! General values: random complex values of a family's parameters, at which it is solved before others.

use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// The largest size of each parameter in the sets that are given; 1 where all are 0.
pub(super) fn sizes(given: &[Vec<Complex64>]) -> Vec<f64> {
    let count = given.first().map_or(0, Vec::len);
    let size = |place: usize| {
        let sizes = given.iter().map(|values| values[place].norm_sqr().sqrt());
        let largest = sizes.fold(0.0f64, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    };
    (0..count).map(size).collect()
}

/// The largest size of each parameter, rounded up to a power of 2, so that similar sets have the same general values.
pub(super) fn rounded_sizes(given: &[Vec<Complex64>]) -> Vec<f64> {
    let rounded = |size: f64| {
        let power = f64::from_bits(size.to_bits() & !FRACTION);
        let up = if power < size { 2.0 * power } else { power };
        // Sizes outside the normal doubles stay as they are.
        if up.is_normal() { up } else { size }
    };
    sizes(given).into_iter().map(rounded).collect()
}

/// The bits of a double that are not its sign and exponent.
const FRACTION: u64 = (1 << 52) - 1;

/// Random complex values of these sizes.
pub(super) fn general_values(sizes: &[f64], seed: u64) -> Vec<Complex64> {
    let mut random = RandomStream::new(seed, Purpose::Question, 1 << 52);
    sizes.iter().map(|size| random.unit() * *size).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_those_of_the_largest_values() {
        let z = |re, im| Complex64::new(re, im);
        let given = [
            vec![z(3.0, 4.0), z(0.0, 0.0), z(-0.25, 0.0)],
            vec![z(1.0, 0.0), z(0.0, 0.0), z(0.3, 0.0)],
        ];
        assert_eq!(sizes(&given), [5.0, 1.0, 0.3]);
        assert_eq!(rounded_sizes(&given), [8.0, 1.0, 0.5]);
        let general = general_values(&rounded_sizes(&given), 1);
        let squares: Vec<f64> = general.iter().map(|z| z.norm_sqr()).collect();
        for (square, expected) in squares.iter().zip([64.0, 1.0, 0.25]) {
            assert!((square / expected - 1.0).abs() < 1e-12);
        }
    }
}
