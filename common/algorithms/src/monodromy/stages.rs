//! Stages of a search: what its batches of paths are tracked by.

use super::graph::{BASE, Direction, FIRST, PathBatch, edge_seed};
use super::search::LoopSearch;
use crate::opening::Opening;
use cognate_continuation::homotopies::{HomotopyKind, way_back};
use cognate_continuation::start_points::{StartPoints, StoredPoints};
use cognate_continuation::tracker::settings::Settings;
use cognate_continuation::work::{Stage, Work};
use cognate_solutions::symmetry::SymmetryGroup;
use num_complex::Complex64;
use std::sync::Arc;

/// A search and the settings of the tracker.
pub(super) struct SearchStages<'a> {
    pub search: &'a LoopSearch,
    pub settings: &'a Settings,
}

impl SearchStages<'_> {
    fn stage(&self, homotopy: HomotopyKind, seed: u64, start_points: StartPoints) -> Stage {
        Stage::new(
            Work::Track,
            homotopy,
            start_points,
            self.settings.clone(),
            seed,
        )
    }

    /// A stage that brings its start points.
    fn opening(&self, homotopy: HomotopyKind, seed: u64, points: StoredPoints) -> Opening {
        Opening {
            stage: self.stage(homotopy, seed, points.as_start()),
            system: None,
            objects: vec![Arc::new(points)],
        }
    }

    /// Homotopy along the path of parameters from one vertex to another.
    fn homotopy(&self, from: usize, to: usize) -> HomotopyKind {
        let parameters = |vertex: usize| &self.search.graph.vertices[vertex].parameters;
        match &self.search.curve {
            Some(curve) => curve.homotopy(parameters(from), parameters(to)),
            None => HomotopyKind::Parameter {
                start: parameters(from).clone(),
                targets: vec![parameters(to).clone()],
            },
        }
    }

    /// The stage that tracks the paths of a batch.
    pub fn batch(&self, batch: &PathBatch) -> Opening {
        let edge = &self.search.graph.edges[batch.edge];
        let (from, to) = (edge.source(batch.direction), edge.target(batch.direction));
        let seed = match batch.direction {
            Direction::Ahead => edge.seed,
            Direction::Back => way_back(edge.seed),
        };
        let homotopy = self.homotopy(from, to);
        let mut opening = if batch.edge == FIRST {
            let start = &self.search.start;
            Opening {
                stage: self.stage(homotopy, seed, start.selected(&batch.sources)),
                system: None,
                objects: start.object.iter().cloned().collect(),
            }
        } else {
            let points = self.search.graph.stored(from, &batch.sources);
            self.opening(homotopy, seed, points)
        };
        opening.stage.settings = self.settings.tightened(batch.attempt);
        opening.stage.attempt = batch.attempt;
        opening
    }

    /// The stage that tracks the images of the first solution of the base on the spot.
    pub fn symmetry_check(&self, group: &SymmetryGroup) -> Opening {
        let LoopSearch { orbits, graph, .. } = self.search;
        let solution = &graph.base_points()[0].values;
        let points = StoredPoints {
            dimension: solution.len(),
            coordinates: group.orbit(solution, &orbits.shape).concat(),
        };
        let seed = edge_seed(self.search.seed, FIRST);
        self.opening(self.homotopy(BASE, BASE), seed, points)
    }

    /// The stage that tracks all solutions of the base, orbit by orbit, to the wanted parameters.
    pub fn arrival(&self, targets: &[Vec<Complex64>]) -> Opening {
        let LoopSearch { orbits, graph, .. } = self.search;
        let points = graph.base_points();
        let points = StoredPoints {
            dimension: points[0].values.len(),
            coordinates: orbits.images(points).concat(),
        };
        let homotopy = HomotopyKind::Parameter {
            start: graph.vertices[BASE].parameters.clone(),
            targets: targets.to_vec(),
        };
        let seed = edge_seed(self.search.seed, usize::MAX);
        self.opening(homotopy, seed, points)
    }
}
