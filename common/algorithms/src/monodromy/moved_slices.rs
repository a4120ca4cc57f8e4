//! Trace test with slices: the solutions of the base are tracked to two parallel slices, in the graph of a search.

use super::counts::{TraceCounts, TraceForm};
use super::graph::{BASE, Graph, Role, edge_seed};
use super::orbits::{Orbits, RegularSolution};
use super::trace::{MOST_DEVIATION, Pencil, deviation};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Vertices of the graph that serve the test alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct MovedSlices {
    /// Vertices at the slices that moved once and twice as far.
    moved: [usize; 2],
    /// Vertex at the parameters where the search began, if the solutions there are asked for.
    begin: Option<usize>,
}

impl MovedSlices {
    /// Adds vertices at two slices at equal distances. `begin`: parameters where the search began, if the solutions
    /// there are asked for.
    pub fn new(graph: &mut Graph, pencil: &Pencil, begin: Option<&[Complex64]>, seed: u64) -> Self {
        let base = graph.vertices[BASE].parameters.clone();
        let size = |z: &Complex64| z.norm_sqr().sqrt();
        let scale = base.iter().map(size).fold(0.0, f64::max);
        // Adds a vertex with one edge from the base.
        let mut add_vertex = |parameters: Vec<Complex64>| {
            let vertex = graph.add_vertex(parameters, Role::TraceTest);
            let seed = edge_seed(seed, graph.edges.len());
            graph.add_edge(BASE, vertex, seed, true);
            vertex
        };
        let moved = [1.0, 2.0].map(|times| {
            let steps = base.iter().zip(&pencil.direction);
            add_vertex(steps.map(|(p, d)| p + d * (times * scale)).collect())
        });
        let begin = begin.map(|parameters| add_vertex(parameters.to_vec()));
        Self { moved, begin }
    }

    /// Result of the test, once all paths to these vertices are tracked.
    pub fn result(&self, pencil: &Pencil, graph: &Graph, orbits: &Orbits) -> TraceCounts {
        let here = orbits.images(graph.base_points());
        let moved = self.moved.map(|v| Some(orbits.images(graph.reached(v)?)));
        let begin_is_reached = self.begin.is_none_or(|v| graph.reached(v).is_some());
        let bent = match &moved {
            [Some(one), Some(two)] if begin_is_reached => {
                Some(deviation([&here, one, two], pencil))
            }
            _ => None,
        };
        TraceCounts {
            form: TraceForm::Slices,
            points: here.len() as u64,
            deviation: bent.filter(|bent| bent.is_finite()),
            complete: bent.is_some_and(|bent| bent <= MOST_DEVIATION),
        }
    }

    /// Solutions where the search began; `None` if they are not asked for or a path there is lost.
    pub fn solutions_at_begin<'a>(&self, graph: &'a Graph) -> Option<Vec<&'a RegularSolution>> {
        graph.reached(self.begin?)
    }
}
