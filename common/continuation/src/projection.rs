//! Projection: one real number per point that its scaling does not change.
//!
//! For each group |<a, x>|^2 / <x, x> with a random unit vector a, summed over
//! the groups. Unlike a quotient of two linear forms it has no poles, so how
//! far it moves with the point is bounded.

use crate::chart::Chart;
use crate::start_systems::exchange::Exchange;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;
use std::ops::Range;

/// The random vectors, for homogeneous coordinates group after group (see `Coordinates`).
#[derive(Clone, Debug)]
pub struct Projection {
    /// Direction of the projection: one coordinate for each coordinate of the point.
    direction: Vec<Complex64>,
    groups: Vec<Range<usize>>,
}

impl Projection {
    /// Makes projection number `index` of a seed, for groups with these numbers of homogeneous coordinates.
    pub fn new(sizes: impl IntoIterator<Item = usize>, seed: u64, index: u64) -> Self {
        let mut random = RandomStream::new(seed, Purpose::Probe, index);
        let mut direction = Vec::new();
        let mut groups = Vec::new();
        for size in sizes {
            let raw: Vec<Complex64> = (0..size).map(|_| random.unit()).collect();
            let length = raw.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
            groups.push(direction.len()..direction.len() + size);
            direction.extend(raw.iter().map(|z| z / length));
        }
        Self { direction, groups }
    }

    /// Changes the projection so that a point and its image under the exchange have the same value.
    pub(crate) fn with_exchange(mut self, chart: &Chart, exchange: &Exchange) -> Self {
        for (k, &to) in exchange.groups.iter().enumerate() {
            if k < to {
                let image = chart.exchanged(&self.direction[self.groups[k].clone()], k, exchange);
                self.direction[self.groups[to].clone()].copy_from_slice(&image);
            }
        }
        self
    }

    /// The number of one point.
    pub fn value(&self, point: &[Complex64]) -> f64 {
        let mut sum = 0.0;
        for group in &self.groups {
            let mut product = Complex64::new(0.0, 0.0);
            let mut square = 0.0;
            for (a, x) in self.direction[group.clone()]
                .iter()
                .zip(&point[group.clone()])
            {
                product += a.conj() * x;
                square += x.norm_sqr();
            }
            sum += product.norm_sqr() / square;
        }
        sum
    }

    /// Largest change of the number per largest difference of coordinates, where the largest coordinate of each group
    /// is 1.
    pub fn slope(&self) -> f64 {
        // For unit vectors |<a,x>|^2 moves by at most 2 |dx|, and a largest
        // coordinate of dx of at most r means |dx| <= sqrt(n) r.
        let slopes = self.groups.iter().map(|g| 2.0 * (g.len() as f64).sqrt());
        slopes.sum()
    }

    /// Bound on the rounding errors of [`Self::value`].
    pub fn rounding(&self) -> f64 {
        16.0 * f64::EPSILON * self.direction.len() as f64
    }

    /// The least of the groups' largest coordinates at a point.
    pub(crate) fn least_size(&self, point: &[Complex64]) -> f64 {
        let largest = |group: &Range<usize>| {
            let squares = point[group.clone()].iter().map(|z| z.norm_sqr());
            squares.fold(0.0, f64::max)
        };
        let sizes = self.groups.iter().map(largest);
        sizes.fold(f64::INFINITY, f64::min).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_changes_nothing_and_moving_no_more_than_the_slope() {
        let mut random = RandomStream::new(3, Purpose::Test, 2);
        for seed in 0..200 {
            let projection = Projection::new([2, 4], seed, 0);
            let mut point: Vec<Complex64> = (0..6).map(|_| random.disc()).collect();
            // The largest coordinate of each group is 1.
            (point[1], point[3]) = (random.unit(), random.unit());
            let value = projection.value(&point);
            let factor = [random.unit() * 1e-3, random.unit() * 1e5];
            let scaled = point.iter().enumerate();
            let scaled: Vec<Complex64> = scaled
                .map(|(k, z)| z * factor[usize::from(k > 1)])
                .collect();
            assert!((projection.value(&scaled) - value).abs() <= projection.rounding());
            assert!((projection.least_size(&scaled) - 1e-3).abs() < 1e-12);
            let moved: Vec<Complex64> = point.iter().map(|z| z + random.disc() * 1e-4).collect();
            let change = (projection.value(&moved) - value).abs();
            let bound = projection.slope() * 1e-4;
            assert!(change <= bound + projection.rounding(), "{change} {bound}");
        }
    }
}
