//! Projection: one real number per point that its scaling does not change.
//!
//! For each group |<a, x>|^2 / <x, x> with a random unit vector a, summed over
//! the groups. Unlike a quotient of two linear forms it has no poles, so how
//! far it moves with the point is bounded.

use crate::point_shape::PointShape;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// The random vectors.
#[derive(Clone, Debug)]
pub struct Projection {
    /// One coordinate for each of the point's.
    direction: Vec<Complex64>,
    slope: f64,
}

impl Projection {
    /// Drawn from the seed.
    pub fn new(shape: &PointShape, seed: u64) -> Self {
        let mut random = RandomStream::new(seed, Purpose::Probe, 0);
        let mut direction = Vec::with_capacity(shape.coordinates());
        let mut slope = 0.0;
        for span in shape.spans() {
            let raw: Vec<Complex64> = span.range.clone().map(|_| random.unit()).collect();
            let length = raw.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
            direction.extend(raw.iter().map(|z| z / length));
            // For unit vectors |<a,x>|^2 moves by at most 2 |dx|, and a largest
            // coordinate of dx of at most r means |dx| <= sqrt(n) r.
            slope += 2.0 * (span.range.len() as f64).sqrt();
        }
        Self { direction, slope }
    }

    /// The number of one point.
    pub fn value(&self, shape: &PointShape, point: &[Complex64]) -> f64 {
        let mut sum = 0.0;
        for span in shape.spans() {
            let mut product = Complex64::new(0.0, 0.0);
            let mut square = 0.0;
            for (a, x) in self.direction[span.range.clone()]
                .iter()
                .zip(&point[span.range])
            {
                product += a.conj() * x;
                square += x.norm_sqr();
            }
            sum += product.norm_sqr() / square;
        }
        sum
    }

    /// How much the number changes at most, by distance.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Bound on the rounding errors of [`Self::value`].
    pub fn rounding(&self) -> f64 {
        16.0 * f64::EPSILON * self.direction.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_results::affine_shape;

    #[test]
    fn scaling_changes_nothing_and_moving_no_more_than_the_slope() {
        let shape = affine_shape(5);
        let mut random = RandomStream::new(3, Purpose::Test, 2);
        for seed in 0..200 {
            let projection = Projection::new(&shape, seed);
            let point: Vec<Complex64> = (0..6).map(|_| random.disc()).collect();
            let value = projection.value(&shape, &point);
            let factor = random.unit() * 1e-3;
            let scaled: Vec<Complex64> = point.iter().map(|z| z * factor).collect();
            assert!((projection.value(&shape, &scaled) - value).abs() <= projection.rounding());
            let moved: Vec<Complex64> = point.iter().map(|z| z + random.disc() * 1e-4).collect();
            let change = (projection.value(&shape, &moved) - value).abs();
            let bound = projection.slope() * shape.distance(&point, &moved);
            assert!(change <= bound + projection.rounding(), "{change} {bound}");
        }
    }
}
