//! Fresh loops: another place in the graph of parameters, and its edges to the places before it.

use super::places::{Sizes, generic_parameters};
use super::{BASE, MonodromySolve, edge_seed};
use cognate_continuation::homotopies::way_back;
use std::collections::BTreeMap;

/// Detours between two places, at most, on either side of the line between them: another on one of
/// these sides is mostly the same loop again.
const DETOURS: usize = 2;
/// Edges to a fresh place, at most, where solutions are few.
const EDGES_OF_FEW: usize = 5;

impl MonodromySolve {
    /// A fresh place, joined to those before it as often as is still needed; at first two places, since
    /// two detours between two places make one loop only, which brings new solutions one by one.
    pub(super) fn add_loops(&mut self) {
        let before = self.places().count();
        if before == 1 {
            self.add_place(DETOURS);
            self.add_place(DETOURS + 1);
            return;
        }
        let limits = &self.limits;
        let (loops, most) = match (limits.confidence, limits.count) {
            (Some(wanted), _) => (self.loops_for_confidence(wanted), before),
            // A missing solution is on some loop: most likely a few loops are enough.
            (None, Some(_)) => (u64::MAX, before),
            (None, None) => (
                self.idle_wanted().saturating_sub(self.counts.idle_loops),
                // Where paths cost little, places are many rather than loops through the same ones.
                match self.cheap_loops() > u64::from(limits.idle_loops) {
                    true => EDGES_OF_FEW.min(DETOURS * before),
                    false => DETOURS * before,
                },
            ),
        };
        let edges = usize::try_from(loops.saturating_add(1)).map_or(most, |n| n.clamp(2, most));
        self.add_place(edges);
    }

    /// Adds a fresh vertex and `edges` edges to it from the places in turn: one from each place, and then further ones
    /// on the other side.
    fn add_place(&mut self, edges: usize) {
        let number = self.graph.vertices.len();
        // Where the number is known, sizes need not vary before loops are idle.
        let same = if self.limits.count.is_some() { 4 } else { 0 };
        let sizes = Sizes::of_place((number - BASE).saturating_sub(same));
        let parameters = generic_parameters(&self.start.parameters, self.seed, number, sizes);
        let before: Vec<usize> = match self.places().collect::<Vec<_>>() {
            // The second place is joined to the base on both sides, to the first on one.
            places if edges == DETOURS + 1 && places.len() == 2 => {
                vec![places[0], places[1], places[0]]
            }
            places => places,
        };
        let vertex = self.graph.add_vertex(parameters);
        let mut seeds = BTreeMap::<usize, u64>::new();
        for k in 0..edges {
            let place = before[k % before.len()];
            let fresh = edge_seed(self.seed, self.graph.edges.len());
            let seed = match seeds.insert(place, fresh) {
                None => fresh,
                Some(other_side) => way_back(other_side),
            };
            self.graph.add_edge(place, vertex, seed, true);
        }
        self.counts.loops += edges as u64 - 1;
    }
}
