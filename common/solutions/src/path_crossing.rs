//! Path crossings: two paths that became one, so that one of them has jumped.
//!
//! To a regular solution leads exactly one path, finite or at infinity; where
//! many paths end, at a singular point or at infinity, each comes from elsewhere
//! at the boundary of the endgame ([`BoundaryKey`]). All paths that meet are
//! tracked again, with the same gamma and tighter settings. [`CrossingRecord`]
//! remembers which meetings were seen and whether they came apart.

use crate::classification::{Decision, Tolerances, Verdict, error_bound};
use crate::point_shape::PointShape;
use crate::unique_points::{Neighbourhood, Reach, clusters, joined};
use cognate_continuation::path_result::{BoundaryKey, PathResult};
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_numeric::precision::DOUBLE;
use serde::{Deserialize, Serialize};

/// Radius of an endpoint: two endpoints are the same when their distance is at most the sum of their radii.
pub fn radius(result: &PathResult, tolerances: &Tolerances) -> f64 {
    if result.outcome == PathOutcome::Singular {
        return singular_radius(result.accuracy, result.precision_bits, tolerances);
    }
    let (factor, floor) = (tolerances.coincidence_factor, tolerances.coincidence_floor);
    error_bound(result.accuracy, factor, floor)
}

/// Radius of a singular point with this estimated error, which was tracked to with this many bits.
pub(crate) fn singular_radius(accuracy: f64, precision_bits: u32, tolerances: &Tolerances) -> f64 {
    // With more digits than doubles turns are made where ends that are only close are apart.
    let floor = if precision_bits > DOUBLE {
        tolerances.coincidence_floor
    } else {
        tolerances.singular_coincidence_floor
    };
    error_bound(accuracy, tolerances.singular_coincidence_factor, floor)
}

/// The neighbourhood of a path's end.
pub fn neighbourhood<'a>(result: &'a PathResult, tolerances: &Tolerances) -> Neighbourhood<'a> {
    Neighbourhood {
        point: result.endpoint.to_double(),
        radius: radius(result, tolerances),
        refined: result.is_refined(),
    }
}

/// Groups of paths, by their places among `results`, whose endpoints coincide.
/// Only paths for which `chosen` holds take part.
pub fn coincidences(
    results: &[PathResult],
    shape: &PointShape,
    tolerances: &Tolerances,
    seed: u64,
    chosen: impl Fn(usize) -> bool,
) -> Vec<Vec<usize>> {
    let places: Vec<usize> = (0..results.len()).filter(|&k| chosen(k)).collect();
    let points: Vec<Neighbourhood<'_>> = places
        .iter()
        .map(|&k| neighbourhood(&results[k], tolerances))
        .collect();
    clusters(&points, shape, seed)
        .into_iter()
        .map(|members| members.into_iter().map(|m| places[m]).collect())
        .collect()
}

/// Key by which a path is told from others where its end does not tell it: the key of the boundary, for paths that end
/// at a singular point or run to infinity.
pub fn boundary_key(result: &PathResult, verdict: Verdict) -> Option<BoundaryKey> {
    let kept = match result.outcome {
        PathOutcome::Singular | PathOutcome::Diverging => verdict != Verdict::Failed,
        PathOutcome::Regular | PathOutcome::PutAside | PathOutcome::Failed(_) => false,
    };
    result.boundary.as_deref().copied().filter(|_| kept)
}

/// Groups of two or more of these keys, by their places, that may be of one point.
pub fn meetings(keys: &[BoundaryKey]) -> Vec<Vec<usize>> {
    let reach = |key: &BoundaryKey| (key.numbers[0] - key.margin, key.numbers[0] + key.margin);
    let meet = |a: usize, b: usize| {
        let mut numbers = keys[a].numbers.iter().zip(keys[b].numbers);
        let margin = keys[a].margin + keys[b].margin;
        numbers.all(|(a, b)| (a - b).abs() <= margin)
    };
    let within = |one: &BoundaryKey, other: &BoundaryKey| {
        let mut numbers = one.numbers.iter().zip(other.numbers);
        numbers.all(|(a, b)| (a - b).abs() + other.margin <= one.margin)
    };
    let stands_for = |one: &Reach, other: &Reach| within(&keys[one.place], &keys[other.place]);
    let mut path_groups = joined(keys.iter().map(reach), meet, stands_for);
    path_groups.retain(|members| members.len() > 1);
    path_groups
}

/// Groups of two or more paths, by their places, that end at one regular point, or entered the endgame at one point.
pub fn crossings(
    results: &[PathResult],
    decisions: &[Decision],
    shape: &PointShape,
    tolerances: &Tolerances,
    seed: u64,
) -> Vec<Vec<usize>> {
    let mut path_groups = coincidences(results, shape, tolerances, seed, |k| {
        results[k].outcome == PathOutcome::Regular && decisions[k].verdict != Verdict::Failed
    });
    path_groups.retain(|members| members.len() > 1);
    let (places, keys): (Vec<usize>, Vec<BoundaryKey>) = results
        .iter()
        .zip(decisions)
        .enumerate()
        .filter_map(|(k, (result, decision))| Some((k, boundary_key(result, decision.verdict)?)))
        .unzip();
    let before = meetings(&keys).into_iter();
    path_groups.extend(before.map(|members| members.into_iter().map(|m| places[m]).collect()));
    path_groups
}

/// Of the paths that end at one singular point, by their places, those of cycles that are not
/// whole: a turn around t = 0 permutes the paths, and one with winding number w takes w of them in
/// turn, which all end there.
pub fn broken_cycles(results: &[PathResult], members: &[usize]) -> Vec<usize> {
    let winding = |place: usize| results[place].winding_number.unwrap_or(1).max(1);
    let whole = |w: u32| {
        let turning = members.iter().filter(|&&place| winding(place) == w);
        turning.count().is_multiple_of(w as usize)
    };
    let broken = members.iter().filter(|&&place| !whole(winding(place)));
    broken.copied().collect()
}

/// The crossings that were seen in a solve, and those that are left.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CrossingRecord {
    seen: Vec<Vec<u64>>,
    left: Vec<Vec<u64>>,
}

impl CrossingRecord {
    /// Takes all crossings that there are now, by path indices, ascending in each.
    pub fn update(&mut self, crossings: Vec<Vec<u64>>) {
        for crossing in &crossings {
            if !self.seen.iter().any(|old| share_two(old, crossing)) {
                self.seen.push(crossing.clone());
            }
        }
        self.left = crossings;
    }

    /// Number of crossings that were ever seen; paths that meet again are one crossing.
    pub fn found(&self) -> u64 {
        self.seen.len() as u64
    }

    /// Number of crossings whose paths came apart.
    pub fn resolved(&self) -> u64 {
        let open = |old: &&Vec<u64>| self.left.iter().any(|crossing| share_two(old, crossing));
        self.found() - self.seen.iter().filter(open).count() as u64
    }

    /// The paths that still meet another.
    pub fn paths(&self) -> impl Iterator<Item = u64> + '_ {
        self.left.iter().flatten().copied()
    }
}

/// True when two ascending lists have two members in common.
fn share_two(a: &[u64], b: &[u64]) -> bool {
    let common = a.iter().filter(|path| b.binary_search(path).is_ok());
    common.take(2).count() == 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::classification::classify;
    use crate::test_results::{affine_shape, failed, regular, singular};
    use cognate_numeric::random::{Purpose, RandomStream};

    #[test]
    fn only_regular_endpoints_cross() {
        let shape = affine_shape(1);
        let tolerances = Tolerances::default();
        let results = [
            regular(0, &[(1.0, 0.0), (0.5, 0.0)]),
            failed(1),
            regular(2, &[(0.0, 2.0), (0.0, 1.0)]), // the same point, scaled
            singular(3, &[(1.0, 0.0), (0.5, 0.0)], 1, &[0]),
            regular(4, &[(1.0, 0.0), (0.5, 1e-6)]),
            regular(5, &[(0.0, 0.0), (0.0, 1.0)]),
            regular(6, &[(0.0, 0.0), (1.0, 0.0)]), // at infinity too
        ];
        let decisions: Vec<Decision> = results
            .iter()
            .map(|r| classify(r, &shape, &tolerances))
            .collect();
        let crossing_paths = crossings(&results, &decisions, &shape, &tolerances, 1);
        assert_eq!(crossing_paths, [vec![0, 2], vec![5, 6]]);
    }

    /// The solutions x = 3e12 and x = 3e11 of quadratics with all their digits, and a rough end there.
    #[test]
    fn refined_ends_are_told_apart_by_values() {
        let shape = affine_shape(1);
        let tolerances = Tolerances::default();
        let unit = 2.0f64.powi(-42);
        let refined = |path: u64, x: f64, unit: f64| PathResult {
            accuracy: f64::EPSILON,
            ..regular(path, &[(unit, 0.0), (x * unit, 0.0)])
        };
        let results = [
            refined(0, 3e12, unit),
            refined(1, 3e11, unit / 8.0),
            refined(2, 3e12 * (1.0 + 1e-11), unit),
        ];
        let groups =
            |results: &[PathResult]| coincidences(results, &shape, &tolerances, 1, |_| true);
        assert_eq!(groups(&results), [vec![0, 2], vec![1]]);
        let rough = regular(1, &[(unit / 8.0, 0.0), (3e11 * unit / 8.0, 0.0)]);
        let [first, _, third] = results;
        assert_eq!(groups(&[first, rough, third]), [vec![0, 1, 2]]);
    }

    #[test]
    fn where_many_paths_end_the_boundary_tells_them_apart() {
        let shape = affine_shape(1);
        let tolerances = Tolerances::default();
        let at = |result, place: f64, margin| PathResult {
            boundary: Some(Box::new(BoundaryKey {
                numbers: [0.5, place, 1.5],
                margin,
            })),
            ..result
        };
        let away = |path| singular(path, &[(1e-15, 0.0), (1.0, 0.0)], 2, &[1]);
        let double = |path| singular(path, &[(1.0, 0.0), (0.5, 0.0)], 1, &[0]);
        let results = [
            at(away(0), 0.1, 1e-6),
            at(away(1), 0.2, 1e-6),
            // As near as the less certain of two allows.
            at(double(2), 0.100_03, 3e-5),
            at(double(3), 0.3, 1e-6),
            at(failed(4), 0.3, 1e-6),
            // A regular end belongs to one path, wherever others were.
            at(regular(5, &[(1.0, 0.0), (0.7, 0.0)]), 0.3, 1e-6),
            away(6),
            away(7),
        ];
        let decisions: Vec<Decision> = results
            .iter()
            .map(|r| classify(r, &shape, &tolerances))
            .collect();
        let crossing_paths = crossings(&results, &decisions, &shape, &tolerances, 1);
        assert_eq!(crossing_paths, [vec![0, 2]]);
    }

    #[test]
    fn no_meeting_is_missed_in_a_crowd() {
        let mut random = RandomStream::new(1, Purpose::Test, 3);
        let key = |_| BoundaryKey {
            numbers: std::array::from_fn(|_| random.uniform()),
            margin: 0.1 * random.uniform() * random.uniform(),
        };
        let keys: Vec<BoundaryKey> = (0..400).map(key).collect();
        let groups = meetings(&keys);
        let together = |a, b| {
            groups
                .iter()
                .any(|members| members.contains(&a) && members.contains(&b))
        };
        let mut pairs = 0;
        for (a, one) in keys.iter().enumerate() {
            for (b, two) in keys.iter().enumerate().take(a) {
                let mut numbers = one.numbers.iter().zip(two.numbers);
                if numbers.all(|(x, y)| (x - y).abs() <= one.margin + two.margin) {
                    assert!(together(a, b), "{a} {b}");
                    pairs += 1;
                }
            }
        }
        assert!(pairs > 100, "{pairs}");
    }

    #[test]
    fn cycles_are_whole_or_named() {
        let at = |path, winding| singular(path, &[(1.0, 0.0), (0.5, 0.0)], winding, &[0]);
        let results = [at(0, 2), at(1, 3), at(2, 2), at(3, 1), at(4, 3), at(5, 2)];
        let named = |members: &[usize]| broken_cycles(&results, members);
        assert!(named(&[0, 2, 3]).is_empty());
        assert_eq!(named(&[0, 1, 2, 3, 4]), [1, 4], "one of three is missing");
        assert_eq!(named(&[0, 1, 2, 5]), [0, 1, 2, 5]);
    }

    #[test]
    fn a_crossing_counts_once_and_is_resolved_when_its_paths_part() {
        let mut book = CrossingRecord::default();
        book.update(vec![vec![1, 2], vec![5, 6, 7]]);
        assert_eq!((book.found(), book.resolved()), (2, 0));
        book.update(vec![vec![6, 7]]);
        assert_eq!((book.found(), book.resolved()), (2, 1));
        book.update(vec![vec![6, 8]]);
        assert_eq!((book.found(), book.resolved()), (3, 2));
        assert_eq!(book.paths().collect::<Vec<_>>(), [6, 8]);
        book.update(vec![]);
        assert_eq!((book.found(), book.resolved()), (3, 3));
    }
}
