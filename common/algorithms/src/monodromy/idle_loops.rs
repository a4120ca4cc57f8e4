//! Idle loops, which bring nothing new: their count, and the estimate of the number of classes from all loops.

use super::counts::{LoopCounts, Mixing, moving};
use super::estimate::Estimate;
use super::graph::{FIRST, Graph, Role};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// State of a search when all paths of its edges were last tracked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct IdleLoops {
    /// Points of the base.
    points: usize,
    /// Loops that were counted.
    loops: u64,
    /// Edges that there were when the base last got a new point: later ones close idle loops.
    first_edge: usize,
}

impl IdleLoops {
    /// The state before the first round.
    pub fn new() -> Self {
        Self {
            points: 0,
            loops: 0,
            first_edge: FIRST + 1,
        }
    }

    /// Counts idle loops when all paths of all edges are tracked.
    pub fn count(&mut self, graph: &Graph, counts: &mut LoopCounts) {
        let points = graph.base_points().len();
        if points > self.points {
            counts.idle_loops = 0;
            self.first_edge = graph.edges.len();
        } else {
            counts.idle_loops += counts.loops - self.loops;
        }
        self.loops = counts.loops;
        self.points = points;
        let permutations = graph.permutations();
        counts.idle_moving = moving(&permutations, self.first_edge);
        counts.mixing = Mixing::of(&permutations);
    }
}

/// Estimate of the number of classes by the graph, once there are loops. Between two places only one detour is
/// counted: all go around the same branch points, nearly, so that the others are no random permutations (measured:
/// with them, one of 10 solves of two cubics missed a solution at a claimed 0.9999).
pub(super) fn estimate(graph: &Graph, counts: &LoopCounts) -> Option<Estimate> {
    if counts.loops == 0 {
        return None;
    }
    let places = graph.places().into_iter();
    let class_counts: Vec<usize> = places.map(|v| graph.vertices[v].points.len()).collect();
    let mut pairs = BTreeMap::<[usize; 2], usize>::new();
    let is_place = |&vertex: &usize| graph.vertices[vertex].role == Role::Place;
    for edge in graph.edges.iter().filter(|e| e.ends.iter().all(is_place)) {
        let most = pairs.entry(edge.ends).or_default();
        *most = edge.pairs().max(*most);
    }
    let pairs: Vec<usize> = pairs.into_values().collect();
    let estimate = Estimate::new(&class_counts, &pairs, graph.start_targets());
    if counts.are_mixing() {
        Some(estimate)
    } else {
        Some(estimate.without_confidence())
    }
}
