//! UniquePoints: which endpoints are one point, to within their own errors.
//!
//! In n log n: each point gets one number that does not change with its
//! scaling (`projection`); points are sorted by it and only neighbours are
//! compared in full. The answer depends on the points alone, not on how they
//! were split among workers.

use crate::disjoint_sets::DisjointSets;
use crate::point_shape::PointShape;
use num_complex::Complex64;

/// A point and how near another must be to be the same.
#[derive(Clone, Copy, Debug)]
pub struct Neighbourhood<'a> {
    /// Homogeneous coordinates, laid out by a `PointShape`.
    pub point: &'a [Complex64],
    /// Two points are one when their distance is at most the sum of their radii.
    pub radius: f64,
    /// Whether the values of the unknowns have the digits that doubles can show: two of these points are apart, too,
    /// where one value differs by more than that part of its size.
    pub refined: bool,
}

impl Neighbourhood<'_> {
    /// Whether two points are one.
    pub fn meets(&self, other: &Self, shape: &PointShape) -> bool {
        let reach = self.radius + other.radius;
        shape.distance(self.point, other.point) <= reach
            && !(self.refined
                && other.refined
                && shape.have_other_values(self.point, other.point, reach))
    }
}

/// Puts points that coincide together. Every point is in exactly one cluster;
/// members are ascending, and so are the clusters by their first members.
pub fn clusters(points: &[Neighbourhood<'_>], shape: &PointShape, seed: u64) -> Vec<Vec<usize>> {
    let projection = shape.projection(seed);
    let reaches = points.iter().map(|p| {
        let value = projection.value(p.point);
        let margin = projection.slope() * p.radius + projection.rounding();
        (value - margin, value + margin)
    });
    let meet = |a: usize, b: usize| points[a].meets(&points[b], shape);
    // A point that meets one point of a cluster meets nearly any other: the point with the farther reach stands for
    // both. A refined point may be apart from others that a rough one meets.
    let is_rougher =
        |one: &Reach, other: &Reach| points[other.place].refined || !points[one.place].refined;
    joined(reaches, meet, |one, other| {
        one.to >= other.to && is_rougher(one, other)
    })
}

/// Groups things that are one: `reaches` gives the interval of each thing, `meet` decides whether two things are one,
/// and `stands_for` decides for two things that are one whether every thing that meets the second also meets the first.
pub(crate) fn joined(
    reaches: impl Iterator<Item = (f64, f64)>,
    meet: impl Fn(usize, usize) -> bool,
    stands_for: impl Fn(&Reach, &Reach) -> bool,
) -> Vec<Vec<usize>> {
    // Sorted as they are, not by way of their places: a million of them do not fit in a cache.
    let mut sorted: Vec<Reach> = reaches
        .enumerate()
        .map(|(place, (from, to))| Reach { from, to, place })
        .collect();
    sorted.sort_unstable_by(|a, b| a.from.total_cmp(&b.from).then(a.place.cmp(&b.place)));

    let mut sets = DisjointSets::new(sorted.len());
    // Points that the next ones may still meet, or others that stand for them.
    let mut open: Vec<Reach> = Vec::new();
    for new in sorted {
        let mut needed = true;
        open.retain(|old| {
            if old.to < new.from {
                return false;
            }
            if !meet(old.place, new.place) {
                return true;
            }
            sets.join(old.place, new.place);
            let stands = stands_for(old, &new);
            needed &= !stands;
            stands || !stands_for(&new, old)
        });
        if needed {
            open.push(new);
        }
    }
    sets.clusters()
}

/// Between which numbers a thing lies.
#[derive(Clone, Copy)]
pub(crate) struct Reach {
    pub from: f64,
    pub to: f64,
    pub place: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_results::affine_shape;
    use cognate_numeric::random::{Purpose, RandomStream};

    /// Finds the clusters by comparing all pairs.
    fn naive(points: &[Neighbourhood<'_>], shape: &PointShape) -> Vec<Vec<usize>> {
        let mut sets = DisjointSets::new(points.len());
        for a in 0..points.len() {
            for b in 0..a {
                if points[a].meets(&points[b], shape) {
                    sets.join(a, b);
                }
            }
        }
        sets.clusters()
    }

    #[test]
    fn agrees_with_comparing_all_pairs() {
        let shape = affine_shape(3);
        let mut random = RandomStream::new(5, Purpose::Test, 1);
        let centres: Vec<Vec<Complex64>> = (0..40)
            .map(|_| (0..4).map(|_| random.disc()).collect())
            .collect();
        let mut points = Vec::new();
        for _ in 0..300 {
            // Scaled at random, moved by less than the radius.
            let centre = &centres[random.below(40) as usize];
            let factor = random.unit() * (0.1 + random.uniform());
            let point: Vec<Complex64> = centre
                .iter()
                .map(|z| z * factor * (1.0 + random.disc() * 1e-11))
                .collect();
            points.push(point);
        }
        let radii: Vec<f64> = (0..points.len())
            .map(|k| if k % 17 == 0 { 1e-6 } else { 1e-10 })
            .collect();
        let neighbourhoods: Vec<Neighbourhood<'_>> = points
            .iter()
            .zip(&radii)
            .map(|(point, &radius)| Neighbourhood {
                point,
                radius,
                refined: false,
            })
            .collect();
        let expected = naive(&neighbourhoods, &shape);
        assert!(expected.len() <= 40);
        for seed in 0..5 {
            assert_eq!(clusters(&neighbourhoods, &shape, seed), expected);
        }
    }

    #[test]
    fn many_paths_to_one_point_are_no_quadratic_work() {
        let shape = affine_shape(2);
        let point = [
            Complex64::new(0.0, 0.0),
            Complex64::new(1.0, 0.0),
            Complex64::new(0.0, 1.0),
        ];
        let neighbourhoods = vec![
            Neighbourhood {
                point: &point,
                radius: 1e-9,
                refined: false,
            };
            200_000
        ];
        assert_eq!(clusters(&neighbourhoods, &shape, 1).len(), 1);
    }
}
