//! Streamed paths: ends that are understood without any other, so that a large solve need not hold them.
//!
//! A path can be streamed when it ends clearly at infinity, or at a regular point with no other regular end near
//! it. Of its end a key is kept, 24 bytes, or 40 of where it entered the endgame when it ends at infinity; the
//! end itself is read again from where results are stored when it is asked for. All others are held, and treated as in a solve that holds everything. As nearly all
//! paths of a good solve are streamed, memory grows with the number of paths by their keys only.

use crate::classification::{Tolerances, Verdict, classify};
use crate::involution::Involution;
use crate::path_crossing::{boundary_key, meetings, neighbourhood, radius};
use crate::point_shape::PointShape;
use crate::real::{is_real, write_as_real};
use crate::solution::Solution;
use crate::solution_set::SolutionSet;
use crate::weak_evidence::{is_in_cluster, may_be_finite};
use cognate_continuation::path_result::{BoundaryKey, PathResult};
use cognate_continuation::projection::Projection;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Plain paths, counted. What is counted can be taken away again.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StreamedCounts {
    /// Paths that end at a finite regular point.
    pub finite: u64,
    /// Paths that end at infinity.
    pub at_infinity: u64,
    /// Paths at infinity that do not end at a regular point, so that a set of positive dimension may be there.
    pub not_regular: u64,
    /// Paths at infinity that end together with other sheets.
    pub in_clusters: u64,
    /// Paths that end at a real point; 0 where that is not asked.
    pub real: u64,
    /// Paths by the highest precision that they used, in bits.
    pub by_precision: BTreeMap<u32, u64>,
}

impl StreamedCounts {
    /// Number of all streamed paths.
    pub fn total(&self) -> u64 {
        self.finite + self.at_infinity
    }
}

/// Kind of a path, by its own end alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The path is held, whatever other paths there are.
    Special,
    /// The path ends at infinity, and its result does not depend on other ends.
    Away,
    /// The path ends at a regular point, and is streamed where no other end is near.
    Regular(Verdict),
}

/// Tells streamed paths from others, by the rules of `classification` and `path_crossing`.
#[derive(Clone, Debug)]
pub struct PathFilter {
    shape: PointShape,
    tolerances: Tolerances,
    projection: Projection,
    involution: Option<Involution>,
    variables: Vec<String>,
}

impl PathFilter {
    /// A filter for the ends of this system's paths, where its parameters have these values.
    pub fn new(
        system: &System,
        parameters: &[Complex64],
        tolerances: &Tolerances,
        seed: u64,
    ) -> Self {
        let shape = PointShape::of(system);
        Self {
            projection: shape.projection(seed),
            tolerances: tolerances.clone(),
            involution: Involution::of(system, parameters).ok(),
            variables: system.variables.clone(),
            shape,
        }
    }

    /// False for systems whose solutions are compared with each other beyond being equal, counted in
    /// named sets, or written in other unknowns: there every end is held.
    pub fn suits(system: &System) -> bool {
        system.degenerate.is_empty() && system.symmetry.is_empty() && system.helpers.is_empty()
    }

    fn kind(&self, result: &PathResult) -> Kind {
        let decision = classify(result, &self.shape, &self.tolerances);
        match (decision.verdict, result.outcome) {
            _ if decision.by_precision_limit => Kind::Special,
            (_, PathOutcome::Regular) if result.winding_number.is_some_and(|w| w > 1) => {
                Kind::Special
            }
            (verdict @ (Verdict::Finite | Verdict::AtInfinity), PathOutcome::Regular) => {
                Kind::Regular(verdict)
            }
            (Verdict::AtInfinity, _) if may_be_finite(result, &self.shape) => Kind::Special,
            (Verdict::AtInfinity, _) => Kind::Away,
            _ => Kind::Special,
        }
    }

    /// Interval of the number of a point, for ends that another may coincide with.
    fn key(&self, result: &PathResult) -> Option<Key> {
        let verdict = classify(result, &self.shape, &self.tolerances).verdict;
        if result.outcome != PathOutcome::Regular || verdict == Verdict::Failed {
            return None;
        }
        let point = result.endpoint.to_double();
        let value = self.projection.value(point);
        let margin =
            self.projection.slope() * radius(result, &self.tolerances) + self.projection.rounding();
        Some(Key {
            from: value - margin,
            to: value + margin,
            path: result.origin.0,
        })
    }

    /// Key of the point where a path entered the endgame, if others might have entered there, too.
    fn boundary(&self, result: &PathResult) -> Option<BoundaryKey> {
        boundary_key(
            result,
            classify(result, &self.shape, &self.tolerances).verdict,
        )
    }

    fn is_real(&self, result: &PathResult) -> Option<bool> {
        let involution = self.involution.as_ref()?;
        let end = neighbourhood(result, &self.tolerances);
        Some(is_real(&end, &self.shape, involution, &[]))
    }

    /// Verdict on a streamed path, and the solution at its end where this is finite; both are equal to those in a
    /// `SolutionSet`. Meant for streamed paths only.
    pub fn answer(&self, result: &PathResult) -> (Verdict, Option<Solution>) {
        let verdict = classify(result, &self.shape, &self.tolerances).verdict;
        if verdict != Verdict::Finite {
            return (verdict, None);
        }
        let values = self.shape.to_variables(result.endpoint.to_double());
        let winding = result.winding_number.unwrap_or(1).max(1);
        let mut variables = self.variables.iter().cloned().zip(values).collect();
        let real = self.is_real(result);
        if let (Some(true), Some(involution)) = (real, &self.involution) {
            write_as_real(&mut variables, &self.shape, involution, &[]);
        }
        let solution = Solution {
            variables,
            multiplicity: 1,
            cycles: vec![winding],
            real,
            singular: false,
            residual: result.residual,
            condition: result.condition,
            accuracy: result.accuracy,
            precision_bits: result.precision_bits,
            class: None,
            paths: vec![result.origin.0],
            certificate: None,
            deflations: None,
            undecided: false,
        };
        (verdict, Some(solution))
    }

    /// The shape of the points.
    pub fn shape(&self) -> &PointShape {
        &self.shape
    }
}

/// Interval of the number of an end (see `unique_points`), and the path that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    from: f64,
    to: f64,
    path: u64,
}

/// All paths of a large stage: counts and keys of those that are streamed, the names of the others.
#[derive(Clone, Debug)]
pub struct EndpointIndex {
    filter: PathFilter,
    counts: StreamedCounts,
    /// Sorted once all are seen.
    keys: Vec<Key>,
    widest: f64,
    /// Keys of the paths that the boundary of the endgame tells apart.
    boundaries: Vec<BoundaryKey>,
    owners: Vec<u64>,
    special: Vec<u64>,
}

impl EndpointIndex {
    /// An empty index with capacity for the keys of `paths` paths.
    pub fn new(filter: PathFilter, paths: u64) -> Self {
        Self {
            filter,
            counts: StreamedCounts::default(),
            // A vector that grows by doubling would hold three times as much for a moment.
            keys: Vec::with_capacity(usize::try_from(paths).unwrap_or(0)),
            widest: 0.0,
            boundaries: Vec::new(),
            owners: Vec::new(),
            special: Vec::new(),
        }
    }

    /// The filter by which paths are told apart.
    pub fn filter(&self) -> &PathFilter {
        &self.filter
    }

    /// The streamed paths, counted. Those that are near each other are counted too, until they are taken back.
    pub fn counts(&self) -> &StreamedCounts {
        &self.counts
    }

    /// Takes one more path. All of a stage come in the order of their indices, then [`Self::settle`].
    pub fn see(&mut self, result: &PathResult) {
        if self.filter.kind(result) == Kind::Special {
            self.special.push(result.origin.0);
        } else {
            self.count(result, |count| *count += 1);
        }
        if let Some(key) = self.filter.key(result) {
            self.widest = self.widest.max(key.to - key.from);
            self.keys.push(key);
        }
        if let Some(key) = self.filter.boundary(result) {
            self.boundaries.push(key);
            self.owners.push(result.origin.0);
        }
    }

    fn count(&mut self, result: &PathResult, change: impl Fn(&mut u64)) {
        let counts = &mut self.counts;
        match self.filter.kind(result) {
            Kind::Special => return,
            Kind::Away => {
                change(&mut counts.at_infinity);
                change(&mut counts.not_regular);
                if is_in_cluster(result) {
                    change(&mut counts.in_clusters);
                }
            }
            Kind::Regular(Verdict::Finite) => {
                change(&mut counts.finite);
                if self.filter.is_real(result) == Some(true) {
                    change(&mut counts.real);
                }
            }
            Kind::Regular(_) => change(&mut counts.at_infinity),
        }
        let of_bits = counts
            .by_precision
            .entry(result.precision_bits)
            .or_default();
        change(of_bits);
        if *of_bits == 0 {
            counts.by_precision.remove(&result.precision_bits);
        }
    }

    /// Once all are seen: the paths that must be held, ascending. Each is to be given to [`Self::take_back`]
    /// with its result before anything else is asked.
    pub fn settle(&mut self) -> Vec<u64> {
        self.keys
            .sort_unstable_by(|a, b| a.from.total_cmp(&b.from).then(a.path.cmp(&b.path)));
        let mut held = std::mem::take(&mut self.special);
        let mut first = 0;
        while first < self.keys.len() {
            // A chain of intervals of which each meets one before it.
            let (mut end, mut reach) = (first + 1, self.keys[first].to);
            while end < self.keys.len() && self.keys[end].from <= reach {
                reach = reach.max(self.keys[end].to);
                end += 1;
            }
            if end - first > 1 {
                held.extend(self.keys[first..end].iter().map(|key| key.path));
            }
            first = end;
        }
        let met = meetings(&self.boundaries);
        held.extend(met.iter().flatten().map(|&place| self.owners[place]));
        held.sort_unstable();
        held.dedup();
        held
    }

    /// Holds these paths, ascending, from now on: they are neither counted here nor found by [`Self::near`].
    pub fn take_back(&mut self, results: &[PathResult]) {
        for result in results {
            self.count(result, |count| *count -= 1);
        }
        self.forget(|path| results.binary_search_by_key(&path, |r| r.origin.0).is_ok());
    }

    /// Drops the keys of these paths: they are held, and were counted out before.
    pub fn forget(&mut self, held: impl Fn(u64) -> bool) {
        self.keys.retain(|key| !held(key.path));
        let mut owners = self.owners.iter();
        self.boundaries
            .retain(|_| owners.next().is_some_and(|&path| !held(path)));
        self.owners.retain(|&path| !held(path));
    }

    /// The streamed paths, ascending, whose ends may be at the ends of `others`, or that entered the endgame where a
    /// path of `others` did.
    pub fn near(&self, others: &[PathResult]) -> Vec<u64> {
        let mut paths = Vec::new();
        for key in others.iter().filter_map(|result| self.filter.key(result)) {
            let first = (self.keys).partition_point(|old| old.from < key.from - self.widest);
            let reached = self.keys[first..].iter();
            let reached = reached.take_while(|old| old.from <= key.to);
            paths.extend(reached.filter(|old| old.to >= key.from).map(|old| old.path));
        }
        let streamed_count = self.boundaries.len();
        let mut boundary_keys = self.boundaries.clone();
        boundary_keys.extend(others.iter().filter_map(|r| self.filter.boundary(r)));
        if boundary_keys.len() > streamed_count {
            let met = meetings(&boundary_keys).into_iter();
            let met = met.filter(|members| members.iter().any(|&place| place >= streamed_count));
            let streamed = met.flatten().filter_map(|place| self.owners.get(place));
            paths.extend(streamed);
        }
        paths.sort_unstable();
        paths.dedup();
        paths
    }
}

impl SolutionSet {
    /// The set of all paths, from the set of those that are held: the solutions of the others are
    /// counted, and not in the list.
    #[must_use]
    pub fn with_streamed(mut self, streamed: &StreamedCounts) -> Self {
        let paths = &mut self.paths;
        paths.total += streamed.total();
        paths.finite += streamed.finite;
        paths.at_infinity += streamed.at_infinity;
        self.in_clusters_at_infinity += streamed.in_clusters;
        for (&bits, &count) in &streamed.by_precision {
            *paths.by_precision.entry(bits).or_default() += count;
            paths.highest_precision_bits = paths.highest_precision_bits.max(bits);
        }
        assert_eq!(paths.sum(), paths.total, "every path is in one class");
        let counts = &mut self.counts;
        counts.distinct += streamed.finite;
        counts.nonsingular += streamed.finite;
        counts.with_multiplicity += streamed.finite;
        counts.real = counts.real.map(|real| real + streamed.real);
        if streamed.not_regular > 0 {
            counts.positive_dimensional = counts.positive_dimensional.filter(|&there| there);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solution_set::History;
    use crate::test_results::{failed, regular, roots_of_unity, singular};
    use cognate_continuation::path_result::PathIndex;
    use cognate_numeric::random::{Purpose, RandomStream};

    /// Ends of all kinds, many of them near each other.
    fn ends(count: u64) -> Vec<PathResult> {
        let mut random = RandomStream::new(3, Purpose::Test, 9);
        let mut place = |k: u64| match k % 11 {
            0 => (0.25, 0.0),
            1 => (f64::from(u32::try_from(k).unwrap()) / 1e4, 0.0),
            _ => {
                let z = random.disc();
                (z.re, z.im)
            }
        };
        (0..count)
            .map(|k| match k % 23 {
                3 => failed(k),
                5 => singular(k, &[(1.0, 0.0), (0.5, 0.0)], 1, &[0]),
                7 => away(k),
                9 => regular(k, &[(0.0, 0.0), (1.0, 0.0)]),
                _ => regular(k, &[(1.0, 0.0), place(k)]),
            })
            .collect()
    }

    /// A path to infinity; some entered the endgame where another did.
    fn away(k: u64) -> PathResult {
        let place = if k.is_multiple_of(5) {
            0.5
        } else {
            k as f64 / 1e3
        };
        PathResult {
            boundary: Some(Box::new(BoundaryKey {
                numbers: [0.25, place, 1.0],
                margin: 1e-5,
            })),
            ..singular(k, &[(1e-15, 0.0), (1.0, 0.0)], 1, &[1])
        }
    }

    fn whole(results: &[PathResult], history: &History) -> SolutionSet {
        SolutionSet::new(
            &roots_of_unity(7),
            &[],
            results,
            history,
            &Tolerances::default(),
            5,
        )
    }

    fn index(results: &[PathResult]) -> (EndpointIndex, Vec<PathResult>) {
        let filter = PathFilter::new(&roots_of_unity(7), &[], &Tolerances::default(), 5);
        let mut index = EndpointIndex::new(filter, results.len() as u64);
        results.iter().for_each(|result| index.see(result));
        let held = index.settle();
        let held: Vec<PathResult> = held.iter().map(|&k| results[k as usize].clone()).collect();
        index.take_back(&held);
        (index, held)
    }

    #[test]
    fn what_is_held_and_what_is_counted_make_up_the_whole() {
        for count in [0, 1, 40, 700] {
            let results = ends(count);
            for complete_start in [false, true] {
                let history = History {
                    complete_start,
                    is_part: true,
                    ..History::default()
                };
                let expected = whole(&results, &history);
                let (index, held) = index(&results);
                assert_eq!(index.counts().total() + held.len() as u64, count);
                assert!(
                    count < 700 || index.counts().finite > 300,
                    "most are streamed"
                );
                let mut set = whole(&held, &history).with_streamed(index.counts());
                // The solutions of the others are made of their results.
                let is_held = |r: &&PathResult| held.iter().any(|h| h.origin == r.origin);
                let others = results.iter().filter(|r| !is_held(r));
                set.solutions
                    .extend(others.filter_map(|r| index.filter().answer(r).1));
                set.solutions.sort_by_key(|solution| solution.paths[0]);
                assert_eq!(set, expected);
            }
        }
    }

    #[test]
    fn who_came_to_the_endgame_with_another_is_held_whenever_that_shows() {
        let results: Vec<PathResult> = (0..300).map(away).collect();
        let (mut index, held) = index(&results);
        let held: Vec<u64> = held.iter().map(|result| result.origin.0).collect();
        assert!(held.iter().copied().eq((0..300).step_by(5)));
        let late = PathResult {
            origin: PathIndex(70),
            ..away(17)
        };
        assert_eq!(index.near(std::slice::from_ref(&late)), [17]);
        index.take_back(&[away(17)]);
        assert_eq!(index.near(&[late]), [] as [u64; 0]);
    }

    #[test]
    fn a_streamed_end_is_found_when_another_comes_there_later() {
        let results = ends(700);
        let (mut index, held) = index(&results);
        let streamed = results
            .iter()
            .find(|r| !held.iter().any(|h| h.origin == r.origin));
        let streamed = streamed.expect("most are streamed");
        let mut late = streamed.clone();
        late.origin = held[0].origin;
        assert_eq!(index.near(&[late.clone()]), [streamed.origin.0]);
        assert_eq!(index.near(&[held[0].clone()]), [] as [u64; 0]);
        let before = index.counts().total();
        index.take_back(std::slice::from_ref(streamed));
        assert_eq!(index.counts().total(), before - 1);
        assert_eq!(index.near(&[late]), [] as [u64; 0]);
    }
}
