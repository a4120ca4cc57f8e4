//! Roots of a polynomial of degree 4, all at once (O. Aberth 1973).

use num_complex::Complex64;

/// Degree of the polynomials.
const DEGREE: usize = 4;
/// Sweeps over all roots at most: four to eight are usual, a multiple root takes more.
const MOST_SWEEPS: usize = 60;
/// A root is one where the value is below this part of the sum of its terms' sizes: rounding of Horner's scheme.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A first coefficient below this part of the largest stands for a root at infinity.
const LEAST_FIRST: f64 = 1e-12;
/// Where the iteration begins: near the unit circle, which holds the real turns, and without symmetry.
const START: [(f64, f64); DEGREE] = [(0.83, 0.47), (-0.41, 0.96), (-1.02, -0.53), (0.52, -0.79)];

/// The roots of the polynomial with these coefficients, that of the highest power last; `None` where one is near infinity
/// or not reached.
pub fn roots(coefficients: &[Complex64; DEGREE + 1]) -> Option<[Complex64; DEGREE]> {
    let sizes = coefficients.map(|c| c.norm_sqr().sqrt());
    let largest = sizes.iter().fold(0.0, |most: f64, x| most.max(*x));
    if sizes[DEGREE].is_nan() || sizes[DEGREE] <= LEAST_FIRST * largest {
        return None;
    }
    let mut roots = START.map(|(re, im)| Complex64::new(re, im));
    for _ in 0..MOST_SWEEPS {
        let mut is_done = true;
        for k in 0..DEGREE {
            let (value, slope, bound) = horner(coefficients, &sizes, roots[k]);
            if value.norm_sqr() <= (ROUNDING * bound) * (ROUNDING * bound) {
                continue;
            }
            is_done = false;
            let newton = value / slope;
            let others = (0..DEGREE).filter(|j| *j != k);
            let repulsion: Complex64 = others.map(|j| 1.0 / (roots[k] - roots[j])).sum();
            roots[k] -= newton / (1.0 - newton * repulsion);
        }
        if is_done {
            return Some(roots);
        }
    }
    None
}

/// The value, the derivative, and the sum of the sizes of the terms.
fn horner(
    coefficients: &[Complex64; DEGREE + 1],
    sizes: &[f64; DEGREE + 1],
    x: Complex64,
) -> (Complex64, Complex64, f64) {
    let size = x.norm_sqr().sqrt();
    let (mut value, mut slope, mut bound) =
        (coefficients[DEGREE], Complex64::default(), sizes[DEGREE]);
    for k in (0..DEGREE).rev() {
        slope = slope * x + value;
        value = value * x + coefficients[k];
        bound = bound * size + sizes[k];
    }
    (value, slope, bound)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    fn product(roots: &[Complex64; DEGREE]) -> [Complex64; DEGREE + 1] {
        let mut coefficients = [Complex64::default(); DEGREE + 1];
        coefficients[0] = Complex64::new(0.3, -0.7);
        for (n, root) in roots.iter().enumerate() {
            for k in (0..=n + 1).rev() {
                let before = if k > 0 {
                    coefficients[k - 1]
                } else {
                    Complex64::default()
                };
                coefficients[k] = before - root * coefficients[k];
            }
        }
        coefficients
    }

    fn check(expected: &[Complex64; DEGREE], error: f64) {
        let computed = roots(&product(expected)).expect("roots");
        for root in expected {
            let apart = computed.iter().map(|x| (x - root).norm_sqr().sqrt());
            let nearest = apart.fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= error * (1.0 + root.norm_sqr().sqrt()),
                "{expected:?}: {nearest:e}"
            );
        }
    }

    #[test]
    fn roots_come_back_from_their_product() {
        let mut random = RandomStream::new(1, Purpose::Test, 71);
        for _ in 0..2000 {
            check(&std::array::from_fn(|_| random.disc() * 3.0), 1e-7);
        }
        let pair = |r: f64| [r, 1.0 / r].map(|r| Complex64::new(0.6 * r, 0.8 * r));
        let [a, b] = pair(30.0);
        check(
            &[a, b, Complex64::new(0.0, 1.0), Complex64::new(-1.0, 0.0)],
            1e-12,
        );
        // A double root has half of the digits.
        check(
            &[a, b, Complex64::new(0.0, 1.0), Complex64::new(0.0, 1.0)],
            1e-6,
        );
        let one = Complex64::new(1.0, 0.0);
        check(&[one, -one, Complex64::i(), -Complex64::i()], 1e-14);
    }

    #[test]
    fn a_root_at_infinity_is_refused() {
        let mut coefficients = product(&[Complex64::new(0.5, 0.1); DEGREE]);
        coefficients[DEGREE] *= 1e-14;
        assert_eq!(roots(&coefficients), None);
        assert_eq!(roots(&[Complex64::default(); DEGREE + 1]), None);
        assert_eq!(roots(&[Complex64::new(f64::NAN, 0.0); DEGREE + 1]), None);
    }
}
