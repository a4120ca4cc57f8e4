//! LoopSearch: solutions of a generic member of a family by loops, as a plain value.
//!
//! The search says which batches of paths are to be tracked next, learns from their results, and says when to stop
//! ([`LoopSearch::next_round`], [`LoopSearch::settle`]). It opens no stages.

use super::counts::{LoopCounts, Stop};
use super::graph::{BASE, EdgeEnd, EdgePath, EdgePoint, FIRST, Graph, PathBatch};
use super::idle_loops::{IdleLoops, estimate};
use super::loop_limits::{LoopLimits, cheap_loops};
use super::loop_start::LoopStart;
use super::moved_slices::MovedSlices;
use super::orbits::{Orbits, RegularSolution};
use super::places::{Sizes, generic_parameters};
use super::trace::{Curve, TraceTest};
use crate::limits::MAX_PATHS;
use crate::retried_stage::{MAX_RETRIES, can_be_helped};
use cognate_continuation::path_result::PathResult;
use cognate_solutions::classification::{Tolerances, Verdict, classify};
use cognate_solutions::path_crossing::radius;
use cognate_solutions::point_shape::PointShape;
use cognate_solutions::symmetry::SymmetryGroup;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Symmetry that the system declares.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Symmetry {
    /// The generators are to be checked at the first solution of the base.
    Unchecked(SymmetryGroup),
    /// Orbits are those of the declared group, which is trivial where the system declares none.
    InUse,
    /// The group is not used, for this reason.
    Refused(String),
}

/// Step that a search asks for.
pub(super) enum NextRound {
    /// Paths between vertices, one batch for each stage; [`LoopSearch::settle`] takes their results.
    Batches(Vec<PathBatch>),
    /// The images of the first solution of the base under this group, tracked on the spot;
    /// [`LoopSearch::settle_symmetry`] takes the results.
    SymmetryCheck(SymmetryGroup),
    /// Another search, among the sections of a curve; [`LoopSearch::settle_sections`] takes that search when it stops.
    Sections(Box<LoopSearch>),
    /// Nothing more; [`LoopCounts::stop`] says why.
    Stop,
}

/// The search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct LoopSearch {
    pub start: LoopStart,
    /// Curve whose sections have the parameters as coefficients; `None` if they are the parameters of the system.
    pub curve: Option<Box<Curve>>,
    pub limits: LoopLimits,
    pub tolerances: Tolerances,
    /// Most repetitions of a path before it is lost.
    pub max_retries: u16,
    pub seed: u64,
    pub orbits: Orbits,
    pub symmetry: Symmetry,
    pub graph: Graph,
    /// Last results of the start solutions by their numbers, for when none of them leads anywhere.
    pub start_results: BTreeMap<u32, PathResult>,
    pub counts: LoopCounts,
    idle: IdleLoops,
    /// Trace test that is asked for, if any.
    pub trace_test: Option<TraceTest>,
    /// Vertices of a trace test with slices, once they have moved.
    pub moved_slices: Option<MovedSlices>,
    /// Points of the base that the last trace test was about.
    pub tested_points: Option<usize>,
}

impl LoopSearch {
    /// A search without a symmetry and without a trace test.
    pub fn new(
        start: LoopStart,
        limits: LoopLimits,
        shape: PointShape,
        tolerances: Tolerances,
        seed: u64,
    ) -> Self {
        let count = usize::try_from(start.count).expect("a plan has no more paths than its limit");
        let base = generic_parameters(&start.parameters, seed, BASE, Sizes::Own);
        Self {
            curve: None,
            limits,
            tolerances,
            max_retries: MAX_RETRIES,
            seed,
            orbits: Orbits {
                group: SymmetryGroup::trivial(),
                shape,
                seed,
            },
            symmetry: Symmetry::InUse,
            graph: Graph::new(start.parameters.clone(), count, base, seed),
            start,
            start_results: BTreeMap::new(),
            counts: LoopCounts {
                group_order: 1,
                ..LoopCounts::default()
            },
            idle: IdleLoops::new(),
            trace_test: None,
            moved_slices: None,
            tested_points: None,
        }
    }

    /// Plans the next step after a round, or at the beginning.
    pub fn next_round(&mut self) -> NextRound {
        let open = self.graph.open_batches(self.expected_points());
        if open.iter().any(|batch| batch.edge == FIRST) {
            return NextRound::Batches(open);
        }
        if self.graph.base_points().is_empty() {
            return self.stop(Stop::NoStart);
        }
        if let Some(group) = self.unchecked_symmetry() {
            return NextRound::SymmetryCheck(group);
        }
        self.count_solutions();
        let mut exhausted = false;
        if open.is_empty() {
            self.idle.count(&self.graph, &mut self.counts);
            exhausted = self.limits.are_loops_exhausted(&self.counts);
        }
        self.counts.estimate = estimate(&self.graph, &self.counts);
        let counts = &self.counts;
        if self.limits.count.is_some_and(|n| counts.solutions >= n) {
            return self.stop(Stop::Count);
        }
        if self.is_confident() {
            return self.stop(Stop::Confidence);
        }
        if counts.tracked > MAX_PATHS {
            return self.stop(Stop::PathLimit);
        }
        if open.is_empty()
            && let Some(next) = self.test_completeness(exhausted)
        {
            return next;
        }
        if exhausted {
            return self.stop(Stop::IdleLoops);
        }
        let mut batches = self.graph.open_batches(self.expected_points());
        if batches.is_empty() {
            self.add_loops();
            batches = self.graph.open_batches(self.expected_points());
        }
        NextRound::Batches(batches)
    }

    fn stop(&mut self, stop: Stop) -> NextRound {
        self.counts.stop = Some(stop);
        NextRound::Stop
    }

    /// Counts the solutions at the base, all members of the orbits.
    pub fn count_solutions(&mut self) {
        let points = self.graph.base_points();
        for point in &points[self.counts.classes as usize..] {
            self.counts.solutions += self.orbits.images([point]).len() as u64;
        }
        self.counts.classes = points.len() as u64;
    }

    /// Number of points of a vertex, if as many solutions are as was said and their orbits are as large as those that
    /// are known.
    fn expected_points(&self) -> Option<usize> {
        let (classes, solutions) = (self.counts.classes, self.counts.solutions);
        let points = self.limits.count?.saturating_mul(classes);
        usize::try_from(points.div_ceil(solutions.max(1)))
            .ok()
            .filter(|_| solutions > 0)
    }

    /// The declared group as the first solution of the base shows it, if it is to be checked.
    fn unchecked_symmetry(&mut self) -> Option<SymmetryGroup> {
        let Symmetry::Unchecked(group) = &self.symmetry else {
            return None;
        };
        let mut group = group.clone();
        let solution = &self.graph.base_points()[0];
        match group.close(&solution.values, &self.orbits.shape) {
            Ok(()) => Some(group),
            Err(error) => {
                self.symmetry = Symmetry::Refused(error.to_string());
                None
            }
        }
    }

    /// Takes the results of the images of one solution: the group is used if all of them are solutions.
    pub fn settle_symmetry(&mut self, group: SymmetryGroup, results: &[PathResult]) {
        let order = group.order();
        let solutions = results.iter().filter_map(|result| self.solution(result));
        let solved = solutions.count();
        if solved < order {
            self.symmetry = Symmetry::Refused(format!(
                "of the {order} images of a solution only {solved} are solutions"
            ));
            return;
        }
        self.symmetry = Symmetry::InUse;
        self.counts.group_order = order as u64;
        self.orbits.group = group;
        self.graph.merge_base(&self.orbits);
    }

    /// End of a path, if it is a regular finite solution.
    pub fn solution(&self, result: &PathResult) -> Option<RegularSolution> {
        let shape = &self.orbits.shape;
        let decision = classify(result, shape, &self.tolerances);
        (decision.verdict == Verdict::Finite).then(|| RegularSolution {
            values: shape.to_variables(result.endpoint.to_double()),
            radius: radius(result, &self.tolerances),
        })
    }

    /// Takes the results of all batches of a round, in the order of the batches.
    pub fn settle(
        &mut self,
        batches: Vec<PathBatch>,
        results: impl Iterator<Item = Vec<PathResult>>,
    ) {
        let mut ends = Vec::new();
        for (batch, results) in batches.into_iter().zip(results) {
            for (&point, result) in batch.sources.iter().zip(&results) {
                let end = self.solution(result);
                // A path that more attempts cannot help is not tracked again.
                let attempt = if end.is_some() || can_be_helped(result.outcome) {
                    batch.attempt
                } else {
                    self.max_retries
                };
                let source = EdgePoint {
                    edge: batch.edge,
                    direction: batch.direction,
                    point,
                };
                let path = EdgePath { source, attempt };
                ends.push(EdgeEnd { path, end });
            }
            if batch.edge == FIRST {
                let results = batch.sources.into_iter().zip(results);
                self.start_results.extend(results);
            }
        }
        let round = self.graph.settle(&ends, &self.orbits, self.max_retries);
        let counts = &mut self.counts;
        counts.lost += round.lost;
        counts.crossings_found += round.crossings;
        // A meeting is resolved until it is given up.
        counts.crossings_resolved += round.crossings;
        counts.crossings_resolved = counts
            .crossings_resolved
            .saturating_sub(round.crossings_left);
    }

    /// Whether all that is known anywhere is known at the base, and more is unlikely enough.
    fn is_confident(&self) -> bool {
        let counts = &self.counts;
        let (Some(wanted), Some(estimate)) = (self.limits.confidence, &counts.estimate) else {
            return false;
        };
        let base_points = self.graph.base_points().len();
        let places = self.graph.places();
        let mut places = places.iter().map(|&place| &self.graph.vertices[place]);
        let base_has_all = places.all(|place| place.points.len() <= base_points);
        let tested = self.trace_test.is_none() || self.tested_points == Some(base_points);
        let idle = counts.idle_loops >= cheap_loops(counts.classes);
        base_has_all && tested && idle && counts.are_mixing() && estimate.confidence >= wanted
    }

    /// The next step by the trace test when nothing is left to track; `None` if it has nothing to say. `exhausted`:
    /// loops would end now.
    fn test_completeness(&mut self, exhausted: bool) -> Option<NextRound> {
        let base_points = Some(self.graph.base_points().len());
        if self.tested_points != base_points {
            match (self.trace_test.as_ref()?, &self.moved_slices) {
                (TraceTest::Sections(curve), _) => {
                    return exhausted.then(|| NextRound::Sections(self.section_search(curve)));
                }
                (TraceTest::Slices(_), None) if self.counts.loops == 0 => return None,
                (TraceTest::Slices(pencil), None) => {
                    // On a curve solutions are known again where the search began.
                    let begin = self.curve.as_ref().map(|_| &self.start.parameters[..]);
                    let slices = MovedSlices::new(&mut self.graph, pencil, begin, self.seed);
                    self.moved_slices = Some(slices);
                    let batches = self.graph.open_batches(self.expected_points());
                    return Some(NextRound::Batches(batches));
                }
                (TraceTest::Slices(pencil), Some(slices)) => {
                    let result = slices.result(pencil, &self.graph, &self.orbits);
                    self.counts.trace_test = Some(result);
                    self.tested_points = base_points;
                }
            }
        }
        let result = self.counts.trace_test.as_ref()?;
        result.complete.then(|| self.stop(Stop::TraceTest))
    }
}
