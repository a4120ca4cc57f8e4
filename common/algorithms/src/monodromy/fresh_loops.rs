//! Fresh loops: another place in the graph of parameters, and its edges to the places before it.

use super::graph::{BASE, Role, edge_seed};
use super::loop_limits::{cheap_loops, loops_for_confidence};
use super::places::{Sizes, generic_parameters};
use super::search::LoopSearch;
use cognate_continuation::homotopies::way_back;
use std::collections::BTreeMap;

/// Detours between two places, at most, on either side of the line between them: another on one of
/// these sides is mostly the same loop again.
const DETOURS: usize = 2;
/// Edges to a fresh place, at most, where solutions are few.
const EDGES_OF_FEW: usize = 5;

impl LoopSearch {
    /// A fresh place, joined to those before it as often as is still needed; at first two places, since
    /// two detours between two places make one loop only, which brings new solutions one by one.
    pub(super) fn add_loops(&mut self) {
        let before = self.graph.places();
        if before.len() == 1 {
            self.add_place(&[BASE; DETOURS]);
            // The second place is joined to the base on both sides, to the first on one.
            let first = self.graph.vertices.len() - 1;
            self.add_place(&[BASE, first, BASE]);
            return;
        }
        let edges = self.edges_to_fresh_place(before.len());
        let in_turn: Vec<usize> = before.into_iter().cycle().take(edges).collect();
        self.add_place(&in_turn);
    }

    /// Number of edges that join a fresh place to those before it.
    fn edges_to_fresh_place(&self, places_before: usize) -> usize {
        let (limits, counts) = (&self.limits, &self.counts);
        let cheap = cheap_loops(counts.classes);
        let (loops, most) = match (limits.confidence, limits.count) {
            (Some(confidence), _) => (loops_for_confidence(confidence, counts), places_before),
            // A missing solution is on some loop: most likely a few loops are enough.
            (None, Some(_)) => (u64::MAX, places_before),
            (None, None) => {
                let needed = limits.idle_loops_needed(counts.classes);
                let most = DETOURS * places_before;
                // Where paths cost little, places are many rather than loops through the same ones.
                let is_cheap = cheap > u64::from(limits.idle_loops);
                let most = if is_cheap {
                    EDGES_OF_FEW.min(most)
                } else {
                    most
                };
                (needed.saturating_sub(counts.idle_loops), most)
            }
        };
        usize::try_from(loops.saturating_add(1)).map_or(most, |n| n.clamp(2, most))
    }

    /// Adds a fresh place, with an edge from each of these places; a second edge from one place takes the other side.
    fn add_place(&mut self, before: &[usize]) {
        let number = self.graph.vertices.len();
        // Where the number is known, sizes need not vary before loops are idle.
        let same = if self.limits.count.is_some() { 4 } else { 0 };
        let sizes = Sizes::of_place((number - BASE).saturating_sub(same));
        let parameters = generic_parameters(&self.start.parameters, self.seed, number, sizes);
        let vertex = self.graph.add_vertex(parameters, Role::Place);
        let mut seeds = BTreeMap::<usize, u64>::new();
        for &place in before {
            let fresh = edge_seed(self.seed, self.graph.edges.len());
            let seed = match seeds.insert(place, fresh) {
                None => fresh,
                Some(other_side) => way_back(other_side),
            };
            self.graph.add_edge(place, vertex, seed, true);
        }
        self.counts.loops += before.len() as u64 - 1;
    }
}
