//! PathStore: the last results of a stage's paths. Of a large stage most are only counted, and read again from
//! where results are kept when somebody asks for them.

use cognate_continuation::path_result::PathResult;
use cognate_solutions::streamed::StreamedCounts;
use serde::{Deserialize, Serialize};

/// Last results of all paths, or of the paths that are held, with the other paths counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PathStore {
    /// The targets' paths follow each other.
    paths_per_target: u64,
    targets: usize,
    /// Results by index of the path, ascending; a path's place is its index if all are held.
    results: Vec<PathResult>,
    /// The paths that are not held, target by target; `None` where all are.
    streamed: Option<Vec<StreamedCounts>>,
}

impl PathStore {
    /// An empty store for paths that are still to be tracked.
    pub fn new(paths_per_target: u64, targets: u64) -> Self {
        Self {
            paths_per_target,
            targets: targets as usize,
            results: Vec::new(),
            streamed: None,
        }
    }

    /// The results that are held, by index of the path.
    pub fn results(&self) -> &[PathResult] {
        &self.results
    }

    /// The results that are held, target by target.
    pub fn by_target(&self) -> impl Iterator<Item = &[PathResult]> {
        (0..self.targets).map(|target| self.of_target(target))
    }

    /// The results of one target's paths that are held; none before they are tracked.
    pub fn of_target(&self, target: usize) -> &[PathResult] {
        let first = target as u64 * self.paths_per_target;
        let place = |path: u64| match self.streamed {
            Some(_) => self.results.partition_point(|r| r.origin.0 < path),
            None => self.results.len().min(path as usize),
        };
        &self.results[place(first)..place(first + self.paths_per_target)]
    }

    /// True where not all paths are held.
    pub fn leaves_out(&self) -> bool {
        self.streamed.is_some()
    }

    /// The paths to a target that are not held, counted; `None` where all are held.
    pub fn streamed(&self, target: usize) -> Option<&StreamedCounts> {
        self.streamed.as_ref().map(|streamed| &streamed[target])
    }

    /// Paths with a result, held or not.
    pub fn known(&self) -> u64 {
        let streamed = self.streamed.iter().flatten().map(StreamedCounts::total);
        self.results.len() as u64 + streamed.sum::<u64>()
    }

    /// Takes the counts, for each target, of the paths that are not held.
    pub fn leave_out(&mut self, streamed: Vec<StreamedCounts>) {
        assert_eq!(streamed.len(), self.targets, "counts for each target");
        self.streamed = Some(streamed);
    }

    /// Holds these paths, too; `streamed` are left.
    pub fn take_back(&mut self, results: Vec<PathResult>, streamed: Vec<StreamedCounts>) {
        self.leave_out(streamed);
        self.results.extend(results);
        self.results.sort_by_key(|result| result.origin);
    }

    fn place(&self, path: u64) -> Option<usize> {
        if self.streamed.is_some() {
            let position = self.results.binary_search_by_key(&path, |r| r.origin.0);
            return position.ok();
        }
        usize::try_from(path)
            .ok()
            .filter(|&place| place < self.results.len())
    }

    /// The result of a path; `None` where it is not held.
    pub fn get(&self, path: u64) -> Option<&PathResult> {
        self.place(path).map(|place| &self.results[place])
    }

    /// The result of a path, to be changed; `None` where it is not held.
    pub fn get_mut(&mut self, path: u64) -> Option<&mut PathResult> {
        self.place(path).map(|place| &mut self.results[place])
    }

    /// The first result of a path.
    ///
    /// # Panics
    /// When it is not that of the next path.
    pub fn begin(&mut self, result: PathResult) {
        let origin = result.origin.0;
        let in_order = match self.streamed {
            None => origin == self.results.len() as u64,
            Some(_) => self.results.last().is_none_or(|r| r.origin.0 < origin),
        };
        assert!(in_order, "results come in item order");
        self.results.push(result);
    }

    /// A later result of a path that is held.
    ///
    /// # Panics
    /// When it is not held.
    pub fn replace(&mut self, result: PathResult) {
        let held = self.get_mut(result.origin.0);
        *held.expect("an index of a path that is in memory") = result;
    }
}
