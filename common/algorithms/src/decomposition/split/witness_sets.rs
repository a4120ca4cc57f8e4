//! The components of a split set as witness sets, with their evidence, and what is said of their dimension.

use super::Split;
use crate::decomposition::classes::Class;
use crate::decomposition::deflated::Deflations;
use crate::decomposition::moved::{bounded, is_closed};
use crate::decomposition::problem::Problem;
use cognate_continuation::bend::rounded;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::witness::{
    ComponentId, Dimension, Doubt, Evidence, Irreducible, Trace, WitnessSet,
};
use num_complex::Complex64;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A sum is clearly not 0 above this many times its error.
const OPEN: f64 = 1e7;
/// Witness points of a set whose ranks are looked at.
const GAPS_ASKED: usize = 16;

impl Split {
    /// Components of the set, and the result for its dimension. Points and classes are taken: there may be too many to
    /// hold them twice.
    pub fn components(
        &mut self,
        problem: &Problem,
        deflations: &mut Deflations,
    ) -> (Vec<WitnessSet>, Dimension) {
        let kind = (self.set.dimension, self.set.ranks.as_slice());
        let points = self.set.points.iter().take(GAPS_ASKED);
        let gaps = points.map(|point| deflations.rank_gap(problem, kind, point));
        let rank_gap = gaps.reduce(f64::min).map(bounded);
        let dimension = self.set.dimension as u32;
        let mut doubts = Vec::new();
        // Points are components by themselves.
        let mut left: Vec<usize> = match dimension {
            0 => Vec::new(),
            _ => self.open_points().collect(),
        };
        left.sort_unstable();
        let trace_of_left = self.trace(left.iter().copied());
        self.bends = None;
        let classes = std::mem::take(&mut self.classes);
        let (orbits, generators) = self.orbits(&classes);
        if generators > 0 {
            doubts.push(Doubt::Symmetry { generators });
        }
        let mut components = Vec::with_capacity(classes.len());
        let mut classes_left = 0;
        let slice = Arc::new(problem.slices_of_variables(self.set.dimension));
        let about = (problem, &slice, rank_gap);
        for (k, Class { points, closed }) in classes.into_iter().enumerate() {
            if closed.is_none() && dimension > 0 {
                classes_left += 1;
                continue;
            }
            let sure = |trace: Trace| self.smallest_wrong.is_none_or(|s| s > OPEN * trace.noise);
            let doubts = match closed.is_none_or(sure) {
                true => Vec::new(),
                false => vec![Doubt::Open { classes: 1 }],
            };
            let orbit = orbits.as_ref().map(|orbits| orbits[k] as u32);
            let component = self.component(about, &points, closed, doubts);
            components.push(WitnessSet { orbit, ..component });
        }
        if !left.is_empty() {
            if !is_closed(&trace_of_left) {
                doubts.push(Doubt::PointsMissing);
            }
            let whole = Some(trace_of_left);
            components.push(match problem.split {
                true => {
                    let classes = classes_left;
                    self.component(about, &left, whole, vec![Doubt::Open { classes }])
                }
                false => WitnessSet {
                    irreducible: Irreducible::NotAsked,
                    ..self.component(about, &left, whole, Vec::new())
                },
            });
        }
        if self.broken > 0 && !left.is_empty() {
            doubts.push(Doubt::BrokenLoops { loops: self.broken });
        }
        let dimension = Dimension {
            number: dimension,
            superset: 0,
            junk: 0,
            removed: 0,
            excess: 0,
            failed: 0,
            found_by_loops: self.search.found() * self.set.multiplicity.tracked,
            degree: 0,
            complete: Completeness::NotKnown,
            doubts,
        };
        (components, dimension)
    }

    /// The orbit of each class under the symmetry group, by the first class in it, where each class is a component and
    /// the group is known here; and how many of its generators do not do what symmetries do.
    fn orbits(&self, classes: &[Class]) -> (Option<Vec<usize>>, u64) {
        let refused = self.symmetry.refused();
        let is_component = |class: &Class| class.closed.is_some() || self.set.dimension == 0;
        if !self.symmetry.are_known() || !classes.iter().all(is_component) {
            return (None, refused);
        }
        let points: Vec<&[usize]> = classes.iter().map(|c| c.points.as_slice()).collect();
        match self.symmetry.orbits(&points) {
            Some(orbits) => (Some(orbits), refused),
            None => (None, self.symmetry.generators()),
        }
    }

    /// Whether the conjugates of these points come to them again, all or none.
    fn is_self_conjugate(&self, points: &[usize]) -> Option<bool> {
        let images = self.mirrored.as_ref()?;
        let class_points: BTreeSet<usize> = points.iter().copied().collect();
        let inside = points
            .iter()
            .filter(|&&k| class_points.contains(&images[k]))
            .count();
        match inside {
            0 => Some(false),
            count if count == points.len() => Some(true),
            _ => None,
        }
    }

    /// Makes the witness set of one component; the points are moved into it.
    fn component(
        &mut self,
        (problem, slice, rank_gap): (&Problem, &Arc<Vec<Vec<Complex64>>>, Option<f64>),
        points: &[usize],
        trace: Option<Trace>,
        mut doubts: Vec<Doubt>,
    ) -> WitnessSet {
        let variable_count = problem.variables();
        let self_conjugate = self.is_self_conjugate(points);
        let set = &mut self.set;
        let mut values = |&k: &usize| {
            let point = std::mem::take(&mut set.points[k].point);
            let point: Vec<_> = point[..variable_count].iter().map(rounded).collect();
            problem.to_variables(&point)
        };
        let values = points.iter().map(&mut values).collect();
        let condition = |&k: &usize| set.points[k].condition;
        let irreducible = match doubts.is_empty() {
            true => Irreducible::Yes,
            false => Irreducible::Unsettled,
        };
        if set.multiplicity.scheme.is_none() {
            doubts.push(Doubt::Multiplicity);
        }
        WitnessSet {
            id: ComponentId {
                dimension: set.dimension as u32,
                number: 0,
            },
            degree: points.len() as u64,
            multiplicity: set.multiplicity.clone(),
            irreducible,
            deflation: set.ranks.clone(),
            self_conjugate,
            orbit: None,
            slice: Arc::clone(slice),
            points: values,
            evidence: Evidence {
                trace,
                smallest_wrong_union: self.smallest_wrong,
                loops: self.loops,
                rank_gap,
                worst_condition: points
                    .iter()
                    .map(condition)
                    .fold(0.0, f64::max)
                    .min(f64::MAX),
                proof: None,
                doubts,
            },
        }
    }
}
