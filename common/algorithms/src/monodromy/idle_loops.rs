//! Idle loops, which bring nothing new: how many are made, and whether those that were made are enough.

use super::counts::{Mixing, moving};
use super::estimate::Estimate;
use super::loop_limits::MOST_IDLE;
use super::{BASE, FIRST, MonodromySolve};
use std::collections::BTreeMap;

/// Paths that idle loops may always cost.
pub(super) const IDLE_PATHS: u64 = 512;
/// How many times more idle loops are made where too few of them move a solution, or where they do not
/// permute as random ones do.
const IDLE_PATIENCE: u64 = 4;
/// Idle loops after which the search ends whatever confidence was asked for: paths are lost then.
const HOPELESS: u64 = 256;

impl MonodromySolve {
    /// All legs are tracked: counts idle loops; true when they are enough. Loops that leave every known
    /// solution where it is are no evidence, nor are any before they permute as random ones do; where
    /// that does not come about, loops end without evidence.
    pub(super) fn is_exhausted(&mut self) -> bool {
        let base_points = self.graph.vertices[BASE].points.len();
        let places: Vec<usize> = self.places().collect();
        let loops = self.graph.permutations(&places);
        if base_points > self.exhausted_at {
            self.counts.idle_loops = 0;
            self.idle_from = self.graph.edges.len();
        } else {
            self.counts.idle_loops += self.counts.loops - self.weighed;
        }
        self.weighed = self.counts.loops;
        self.exhausted_at = base_points;
        self.counts.idle_moving = moving(&loops, self.idle_from);
        self.counts.mixing = Mixing::of(&loops);
        let wanted = self.idle_wanted();
        let moved = self.counts.idle_moving >= wanted && self.is_mixing();
        let patience = if self.limits.confidence.is_some() {
            1
        } else {
            IDLE_PATIENCE
        };
        let given_up = self.counts.idle_loops >= wanted.saturating_mul(patience);
        self.counts.idle_loops >= wanted && (moved || base_points == 1 || given_up)
    }

    /// Whether all that is known anywhere is known at the base, and more is unlikely enough.
    pub(super) fn is_confident(&self) -> bool {
        let (Some(wanted), Some(estimate)) = (self.limits.confidence, &self.counts.estimate) else {
            return false;
        };
        let points = |v: usize| self.graph.vertices[v].points.len();
        let base_has_all = self.places().all(|v| points(v) <= points(BASE));
        let tested = self.test.is_none() || self.tested == Some(points(BASE));
        let idle = self.counts.idle_loops >= self.cheap_loops();
        let mixed = self.is_mixing();
        base_has_all && tested && idle && mixed && estimate.confidence >= wanted
    }

    /// Estimate of the number of classes by the graph, once there are loops. Between two places only one detour is
    /// counted: all go around the same branch points, nearly, so that the others are no random permutations (measured:
    /// with them, one of 10 solves of two cubics missed a solution at a claimed 0.9999).
    pub(super) fn estimate(&self) -> Option<Estimate> {
        let class_counts = self.places().map(|v| self.graph.vertices[v].points.len());
        let mut pairs = BTreeMap::<[usize; 2], usize>::new();
        for edge in &self.graph.edges[FIRST + 1..] {
            if !edge.ends.iter().any(|&v| self.is_beside(v)) {
                let most = pairs.entry(edge.ends).or_default();
                *most = edge.pairs().max(*most);
            }
        }
        let pairs: Vec<usize> = pairs.into_values().collect();
        let started = self.graph.targets(FIRST);
        (self.counts.loops > 0).then(|| {
            let estimate = Estimate::new(&class_counts.collect::<Vec<_>>(), &pairs, started);
            match self.is_mixing() {
                true => estimate,
                false => estimate.without_confidence(),
            }
        })
    }

    /// Whether loops are seen to permute the known solutions as random ones do.
    pub(super) fn is_mixing(&self) -> bool {
        let base_points = self.graph.vertices[BASE].points.len() as u64;
        self.counts.mixing.is_shown(base_points)
    }

    /// How many loops more would make the estimate as certain as is wanted, if they bring nothing new:
    /// each divides the odds of one more class by their number.
    pub(super) fn loops_for_confidence(&self, wanted: f64) -> u64 {
        let base_points = self.graph.vertices[BASE].points.len() as f64;
        let estimate = self.counts.estimate.as_ref();
        let mut doubt = 1.0 - estimate.map_or(0.0, |estimate| estimate.confidence);
        let mut loops = 0;
        while loops < 1 || (doubt > 1.0 - wanted && loops < HOPELESS) {
            doubt /= base_points + 1.0;
            loops += 1;
        }
        let idle = self.cheap_loops().saturating_sub(self.counts.idle_loops);
        loops.max(idle)
    }

    /// Idle loops that cost so little that they are always made: of few solutions many loops move none.
    pub(super) fn cheap_loops(&self) -> u64 {
        let base_points = self.graph.vertices[BASE].points.len() as u64;
        (IDLE_PATHS / base_points.max(1)).min(MOST_IDLE)
    }

    /// Number of idle loops after which the solve ends.
    pub(super) fn idle_wanted(&self) -> u64 {
        if self.limits.confidence.is_some() {
            return HOPELESS;
        }
        let wanted = u64::from(self.limits.idle_loops).max(self.cheap_loops());
        let patience = if self.limits.count.is_some() { 4 } else { 1 };
        wanted.saturating_mul(patience).max(1)
    }
}
