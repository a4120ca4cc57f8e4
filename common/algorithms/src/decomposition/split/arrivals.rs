//! Arrivals: the witness points to which the paths of a stage came.

use crate::decomposition::job::Job;
use cognate_continuation::bend::{RefinedPoint, rounded};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_solutions::classification::Verdict;
use num_complex::Complex64;
use std::collections::{BTreeMap, BTreeSet};

/// An end of a path is at a witness point within this, relative to the point.
const SAME: f64 = 1e-6;

/// Ends of all paths of a stage, in their order; `None` if a path did not arrive, or some met.
pub(super) fn ends(job: &Job) -> Option<Vec<Vec<Complex64>>> {
    if job.crossings_left() > 0 {
        return None;
    }
    let mut ends: BTreeMap<u64, Vec<Complex64>> = BTreeMap::new();
    for (result, decision, values) in job.ends() {
        if decision.verdict != Verdict::Finite {
            return None;
        }
        ends.insert(result.origin.0, values);
    }
    Some(ends.into_values().collect())
}

/// Some witness points of a set, among which ends of paths are looked up.
pub(super) struct WitnessPoints<'a> {
    points: &'a [RefinedPoint],
    /// A linear form of length 1 in the variables: no two points are nearer than its values at them.
    form: Vec<Complex64>,
    /// Real part of the form at each point, ascending, and the number of the point.
    order: Vec<(f64, usize)>,
}

impl<'a> WitnessPoints<'a> {
    /// The points with the numbers `among`, by the first `variable_count` coordinates of each.
    pub fn new(
        points: &'a [RefinedPoint],
        among: impl IntoIterator<Item = usize>,
        variable_count: usize,
    ) -> Self {
        let mut random = RandomStream::new(0, Purpose::Probe, 4);
        let weight = 1.0 / (variable_count as f64).sqrt();
        let mut witness_points = Self {
            points,
            form: (0..variable_count)
                .map(|_| random.unit() * weight)
                .collect(),
            order: Vec::new(),
        };
        let value = |k: usize| witness_points.value(witness_points.coordinates(k));
        let mut order: Vec<(f64, usize)> = among.into_iter().map(|k| (value(k), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        witness_points.order = order;
        witness_points
    }

    /// The witness point at each of these ends; `None` if an end is at none of them, or two ends are at one.
    pub fn distinct_at(&self, ends: &[Vec<Complex64>]) -> Option<Vec<usize>> {
        let points: Vec<usize> = ends.iter().map(|end| self.at(end)).collect::<Option<_>>()?;
        let different: BTreeSet<usize> = points.iter().copied().collect();
        (different.len() == points.len()).then_some(points)
    }

    /// Number of the witness point at this end; `None`: it is at none of them.
    pub fn at(&self, end: &[Complex64]) -> Option<usize> {
        let size = 1.0 + end.iter().map(|y| y.norm_sqr()).sum::<f64>();
        let (value, reach) = (self.value(end.iter().copied()), 2.0 * SAME * size.sqrt());
        let first = self.order.partition_point(|(v, _)| *v < value - reach);
        let near = self.order[first..].iter();
        let near = near.take_while(|(v, _)| *v <= value + reach);
        let near = near.map(|&(_, k)| (self.distance_squared(k, end), k));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        (nearest.0 <= SAME * SAME).then_some(nearest.1)
    }

    fn coordinates(&self, k: usize) -> impl Iterator<Item = Complex64> {
        let variable_count = self.form.len();
        self.points[k].point[..variable_count].iter().map(rounded)
    }

    fn value(&self, point: impl Iterator<Item = Complex64>) -> f64 {
        point.zip(&self.form).map(|(x, c)| (x * c).re).sum()
    }

    /// Square of the distance of a witness point and an end, relative to the size of the point.
    fn distance_squared(&self, k: usize, end: &[Complex64]) -> f64 {
        let pairs = self.coordinates(k).zip(end).map(|(x, &y)| (x, x - y));
        let (size, apart) = pairs.fold((1.0, 0.0), |(size, apart), (x, d)| {
            (size + x.norm_sqr(), apart + d.norm_sqr())
        });
        apart / size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cognate_continuation::bend::exactly;

    #[test]
    fn paths_that_come_to_one_point_or_to_none_are_no_permutation() {
        let coordinate = |k: usize| Complex64::new(k as f64, 0.0);
        let point = |k: usize| RefinedPoint {
            // A second unknown, which is no variable.
            point: vec![exactly(coordinate(k)), exactly(coordinate(7))],
            correction: 0.0,
            moved: 0.0,
            residual: 0.0,
            condition: 1.0,
        };
        let points: Vec<RefinedPoint> = (0..20).map(point).collect();
        let witness_points = WitnessPoints::new(&points, [12, 0, 5, 7], 1);
        let ends = |places: [usize; 3]| places.map(|k| vec![coordinate(k), coordinate(9)]);
        let at = |ends: &[Vec<Complex64>]| witness_points.distinct_at(ends);
        assert_eq!(at(&ends([5, 12, 0])), Some(vec![5, 12, 0]));
        // Two paths come to one point: one of them has left its way, perhaps to another component.
        assert_eq!(at(&ends([5, 12, 5])), None);
        // A path comes to no witness point, or to one that is not among these.
        assert_eq!(at(&ends([5, 12, 6])), None);
        let mut near = ends([5, 12, 0]);
        near[1][0] += 1e-6;
        assert_eq!(at(&near), Some(vec![5, 12, 0]));
        near[1][0] += 1e-4;
        assert_eq!(at(&near), None);
    }
}
