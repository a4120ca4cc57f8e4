//! The components of a split set as witness sets, with their evidence, and what is said of their dimension.

use super::Split;
use crate::decomposition::classes::Class;
use crate::decomposition::deflated::ProblemContext;
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

/// Data that all witness sets of a split share.
struct Shared<'a> {
    problem: &'a Problem,
    slice: Arc<Vec<Vec<Complex64>>>,
    rank_gap: Option<f64>,
}

impl Split {
    /// Components of the set, and the result for its dimension. Points and classes are taken: there may be too many to
    /// hold them twice.
    pub fn components(&mut self, context: &mut ProblemContext<'_>) -> (Vec<WitnessSet>, Dimension) {
        let problem = context.problem;
        let shared = Shared {
            problem,
            slice: Arc::new(problem.slices_of_variables(self.set.dimension)),
            rank_gap: self.rank_gap(context),
        };
        // In dimension 0 points are components by themselves.
        let is_isolated = self.set.dimension == 0;
        let open_points = if is_isolated {
            Vec::new()
        } else {
            self.classes.open_points()
        };
        let open_trace = self.classes.trace(open_points.iter().copied());
        let open_trace = (!open_points.is_empty()).then_some(open_trace);
        let classes = self.classes.take();
        let (orbits, refused_generators) = self.orbits(&classes);
        let mut components = Vec::with_capacity(classes.len());
        let mut open_classes = 0;
        for (k, Class { points, closed }) in classes.into_iter().enumerate() {
            if closed.is_none() && !is_isolated {
                open_classes += 1;
                continue;
            }
            let doubts = if closed.is_none_or(|trace| self.is_sure(trace)) {
                Vec::new()
            } else {
                vec![Doubt::Open { classes: 1 }]
            };
            components.push(WitnessSet {
                orbit: orbits.as_ref().map(|orbits| orbits[k] as u32),
                ..self.witness_set(&shared, &points, closed, doubts)
            });
        }
        if open_trace.is_some() {
            components.push(if problem.split {
                let classes = open_classes;
                let doubts = vec![Doubt::Open { classes }];
                self.witness_set(&shared, &open_points, open_trace, doubts)
            } else {
                WitnessSet {
                    irreducible: Irreducible::NotAsked,
                    ..self.witness_set(&shared, &open_points, open_trace, Vec::new())
                }
            });
        }
        (components, self.dimension(refused_generators, open_trace))
    }

    fn rank_gap(&self, context: &mut ProblemContext<'_>) -> Option<f64> {
        let (problem, deflations) = (context.problem, &mut *context.deflations);
        let kind = (self.set.dimension, self.set.ranks.as_slice());
        let points = self.set.points.iter().take(GAPS_ASKED);
        let gaps = points.map(|point| deflations.rank_gap(problem, kind, point));
        gaps.reduce(f64::min).map(bounded)
    }

    /// Whether sums that are not 0 are clearly apart from this one.
    fn is_sure(&self, trace: Trace) -> bool {
        let smallest_wrong = self.classes.smallest_wrong();
        smallest_wrong.is_none_or(|wrong| wrong > OPEN * trace.noise)
    }

    /// The result for the dimension of the set. `open_trace`: the sum over points that are in no component, where there
    /// are some.
    fn dimension(&self, refused_generators: u64, open_trace: Option<Trace>) -> Dimension {
        let mut doubts = Vec::new();
        if refused_generators > 0 {
            doubts.push(Doubt::Symmetry {
                generators: refused_generators,
            });
        }
        if let Some(trace) = open_trace {
            if !is_closed(&trace) {
                doubts.push(Doubt::PointsMissing);
            }
            let loops = self.broken_loops + self.classes.taken_back();
            if loops > 0 {
                doubts.push(Doubt::BrokenLoops { loops });
            }
        }
        Dimension {
            number: self.set.dimension as u32,
            superset: 0,
            junk: 0,
            removed: 0,
            excess: 0,
            failed: 0,
            found_by_loops: self.missing_points.found() * self.set.multiplicity.tracked,
            degree: 0,
            complete: Completeness::NotKnown,
            doubts,
        }
    }

    /// The orbit of each class under the symmetry group, by the first class in it, where each class is a component and
    /// the group is known here; and how many of its generators do not do what symmetries do.
    fn orbits(&self, classes: &[Class]) -> (Option<Vec<usize>>, u64) {
        let symmetry = &self.classes.symmetry;
        let is_component = |class: &Class| class.closed.is_some() || self.set.dimension == 0;
        if !symmetry.are_known() || !classes.iter().all(is_component) {
            return (None, symmetry.refused());
        }
        let points: Vec<&[usize]> = classes.iter().map(|c| c.points.as_slice()).collect();
        match symmetry.orbits(&points) {
            Some(orbits) => (Some(orbits), symmetry.refused()),
            None => (None, symmetry.generators()),
        }
    }

    /// Whether the conjugates of these points come to them again, all or none.
    fn is_self_conjugate(&self, points: &[usize]) -> Option<bool> {
        let images = self.conjugates.as_ref()?;
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

    /// Makes the witness set of these points, which are moved into it: a component, where there are no doubts.
    fn witness_set(
        &mut self,
        shared: &Shared<'_>,
        points: &[usize],
        trace: Option<Trace>,
        mut doubts: Vec<Doubt>,
    ) -> WitnessSet {
        let problem = shared.problem;
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
        let worst_condition = points.iter().map(condition).fold(0.0, f64::max);
        let irreducible = if doubts.is_empty() {
            Irreducible::Yes
        } else {
            Irreducible::Unsettled
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
            slice: Arc::clone(&shared.slice),
            points: values,
            evidence: Evidence {
                trace,
                smallest_wrong_union: self.classes.smallest_wrong(),
                loops: self.loops,
                rank_gap: shared.rank_gap,
                worst_condition: worst_condition.min(f64::MAX),
                proof: None,
                doubts,
            },
        }
    }
}
