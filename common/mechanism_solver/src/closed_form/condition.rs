//! The condition number of six screws, by the least and the largest eigenvalue of their products: in a fifth of the time of
//! singular values, which decide where screws nearly depend.

use cognate_kinematics::real_arm::condition_of_screws;

/// Screws, and numbers of a screw.
const SIX: usize = 6;
/// Squares of condition numbers above this are left to singular values: rounding has taken half of the digits.
const LARGEST_SQUARE: f64 = 1e8;
/// Steps of Laguerre's method at most; three to five are usual.
const MOST_STEPS: usize = 20;
/// Laguerre's method ends after a step below this part of the eigenvalue.
const LAST_STEP: f64 = 1e-10;

/// The condition number of these screws.
pub fn condition(screws: &[[f64; SIX]; SIX]) -> f64 {
    let product = |i: usize, j: usize| screws[i].iter().zip(&screws[j]).map(|(x, y)| x * y).sum();
    let mut products = [[0.0; SIX]; SIX];
    for i in 0..SIX {
        for j in 0..=i {
            products[i][j] = product(i, j);
            products[j][i] = products[i][j];
        }
    }
    let trace: f64 = (0..SIX).map(|i| products[i][i]).sum();
    let tridiagonal = Tridiagonal::of(products);
    let (least, largest) = (
        tridiagonal.eigenvalue_from(0.0),
        tridiagonal.eigenvalue_from(trace),
    );
    let square = largest / least;
    match square > 0.0 && square < LARGEST_SQUARE {
        true => square.sqrt(),
        false => condition_of_screws(screws.to_vec()),
    }
}

/// A symmetric matrix with entries on and beside its diagonal alone.
struct Tridiagonal {
    diagonal: [f64; SIX],
    /// Squares of the entries beside the diagonal.
    beside: [f64; SIX - 1],
}

impl Tridiagonal {
    /// The matrix with the same eigenvalues as a symmetric one, by reflections (A. S. Householder 1958).
    fn of(mut a: [[f64; SIX]; SIX]) -> Self {
        let mut beside = [0.0; SIX - 1];
        for k in 0..SIX - 2 {
            let mut v = [0.0; SIX];
            for i in k + 1..SIX {
                v[i] = a[i][k];
            }
            let square: f64 = v.iter().map(|x| x * x).sum();
            beside[k] = square;
            let first = v[k + 1];
            v[k + 1] += square.sqrt().copysign(first);
            // Half of the square of v, whose length has changed with its first entry.
            let half = square + first.abs() * square.sqrt();
            if half == 0.0 {
                continue;
            }
            let mut p = [0.0; SIX];
            for i in k + 1..SIX {
                for j in k + 1..SIX {
                    p[i] += a[i][j] * v[j] / half;
                }
            }
            let along = v.iter().zip(&p).map(|(x, y)| x * y).sum::<f64>() / (2.0 * half);
            for i in k + 1..SIX {
                p[i] -= along * v[i];
            }
            for i in k + 1..SIX {
                for j in k + 1..SIX {
                    a[i][j] -= v[i] * p[j] + p[i] * v[j];
                }
            }
        }
        beside[SIX - 2] = a[SIX - 1][SIX - 2] * a[SIX - 1][SIX - 2];
        Self {
            diagonal: std::array::from_fn(|i| a[i][i]),
            beside,
        }
    }

    /// The characteristic polynomial at a number, with its first and second derivative.
    fn polynomial(&self, x: f64) -> [f64; 3] {
        let (mut before, mut here) = ([0.0; 3], [1.0, 0.0, 0.0]);
        for (k, diagonal) in self.diagonal.iter().enumerate() {
            let across = if k > 0 { self.beside[k - 1] } else { 0.0 };
            let rest = diagonal - x;
            let next = [
                rest * here[0] - across * before[0],
                rest * here[1] - here[0] - across * before[1],
                rest * here[2] - 2.0 * here[1] - across * before[2],
            ];
            (before, here) = (here, next);
        }
        here
    }

    /// The eigenvalue next to a number beyond all of them, by Laguerre's method, which comes to it from one side.
    fn eigenvalue_from(&self, start: f64) -> f64 {
        let n = SIX as f64;
        let mut x = start;
        for _ in 0..MOST_STEPS {
            let [value, first, second] = self.polynomial(x);
            if value == 0.0 {
                break;
            }
            let slope = first / value;
            let curvature = slope * slope - second / value;
            let root = ((n - 1.0) * (n * curvature - slope * slope))
                .max(0.0)
                .sqrt();
            let step = n / (slope + root.copysign(slope));
            x -= step;
            if step.abs() <= LAST_STEP * x.abs() {
                break;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    #[test]
    fn condition_numbers_are_those_of_singular_values() {
        let mut random = RandomStream::new(1, Purpose::Test, 76);
        for n in 0..2000 {
            let mut screws: [[f64; SIX]; SIX] =
                std::array::from_fn(|_| std::array::from_fn(|_| 2.0 * random.uniform() - 1.0));
            if n % 4 == 0 {
                // Axes at right angles and screws that nearly depend.
                let near = 10.0f64.powi(-(n % 11));
                screws[3] = std::array::from_fn(|i| screws[2][i] + near * screws[3][i]);
                screws[0] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
                screws[1] = [0.0, 1.0, 0.0, 0.0, 0.0, 0.5];
            }
            let expected = condition_of_screws(screws.to_vec());
            let computed = condition(&screws);
            assert!(
                (computed / expected - 1.0).abs() < 1e-6,
                "{computed:e} {expected:e}"
            );
        }
        let same = condition(&[[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]; SIX]);
        assert!(same > 1e12, "{same:e}");
        let orthogonal =
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        assert!((condition(&orthogonal) - 1.0).abs() < 1e-9);
    }
}
