//! StreamedTargets: the ends of a large stage to several targets, whose paths follow each other.

use crate::streamed::{EndpointIndex, PathFilter, StreamedCounts};
use cognate_continuation::path_result::PathResult;

/// An index of ends for each target.
#[derive(Clone, Debug)]
pub struct StreamedTargets {
    paths_per_target: u64,
    targets: Vec<EndpointIndex>,
}

impl StreamedTargets {
    /// Empty indices with capacity for `paths` paths in all, as many to each target; a filter for each.
    ///
    /// # Panics
    /// When there is no target, or another number of paths to one of them.
    pub fn new(filters: Vec<PathFilter>, paths: u64) -> Self {
        let targets = filters.len() as u64;
        assert!(
            targets > 0 && paths.is_multiple_of(targets),
            "every target has the same number of paths"
        );
        let paths_per_target = paths / targets;
        let index = |filter| EndpointIndex::new(filter, paths_per_target);
        Self {
            paths_per_target,
            targets: filters.into_iter().map(index).collect(),
        }
    }

    fn target_of(&self, path: u64) -> usize {
        (path / self.paths_per_target.max(1)) as usize
    }

    /// Takes one more path. All of a stage come in the order of their indices, then [`Self::settle`].
    pub fn see(&mut self, result: &PathResult) {
        let target = self.target_of(result.origin.0);
        self.targets[target].see(result);
    }

    /// Once all are seen: the paths that must be held, ascending. Each is to be given to [`Self::take_back`]
    /// with its result before anything else is asked.
    pub fn settle(&mut self) -> Vec<u64> {
        let targets = self.targets.iter_mut();
        targets.flat_map(EndpointIndex::settle).collect()
    }

    /// Holds these paths, ascending, from now on.
    pub fn take_back(&mut self, results: &[PathResult]) {
        let paths = self.paths_per_target.max(1);
        let target_of = |result: &PathResult| result.origin.0 / paths;
        for of_target in results.chunk_by(|a, b| target_of(a) == target_of(b)) {
            self.targets[target_of(&of_target[0]) as usize].take_back(of_target);
        }
    }

    /// The paths that are not held, ascending, whose ends may be at the ends of `others`, or that entered the endgame
    /// where a path of `others` did.
    pub fn near(&self, others: &[PathResult]) -> Vec<u64> {
        let mut by_target: Vec<Vec<PathResult>> = vec![Vec::new(); self.targets.len()];
        for result in others {
            by_target[self.target_of(result.origin.0)].push(result.clone());
        }
        let targets = self.targets.iter().zip(by_target);
        let some = targets.filter(|(_, others)| !others.is_empty());
        some.flat_map(|(index, others)| index.near(&others))
            .collect()
    }

    /// The paths that are not held, counted, target by target.
    pub fn counts(&self) -> Vec<StreamedCounts> {
        let targets = self.targets.iter();
        targets.map(|index| index.counts().clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::classification::Tolerances;
    use crate::test_results::{regular, roots_of_unity};

    #[test]
    fn only_ends_at_one_target_are_near_each_other() {
        let system = roots_of_unity(2);
        let filter = PathFilter::new(&system, &[], &Tolerances::default(), 7);
        let mut index = StreamedTargets::new(vec![filter.clone(), filter], 6);
        // Paths 0 and 1 end together, and so do 3 and 2, but at two targets.
        let ends = [0.5, 0.5, 0.25, 0.25, 0.1, 0.7];
        let results: Vec<PathResult> = (0..)
            .zip(ends)
            .map(|(path, x)| regular(path, &[(1.0, 0.0), (x, 0.0)]))
            .collect();
        results.iter().for_each(|result| index.see(result));
        assert_eq!(index.settle(), [0, 1]);
        index.take_back(&results[..2]);
        let finite: Vec<u64> = index.counts().iter().map(|counts| counts.finite).collect();
        assert_eq!(finite, [1, 3]);
        let late = |path| regular(path, &[(1.0, 0.0), (0.25, 0.0)]);
        assert_eq!(index.near(&[late(0)]), [2]);
        assert_eq!(index.near(&[late(1), late(4)]), [2, 3]);
    }
}
