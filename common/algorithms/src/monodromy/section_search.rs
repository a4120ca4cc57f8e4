//! Trace test with sections of a curve: a second search by loops, from the solutions that the first search knows.

use super::counts::{Stop, TraceCounts, TraceForm};
use super::graph::edge_seed;
use super::loop_start::LoopStart;
use super::orbits::RegularSolution;
use super::search::LoopSearch;
use super::trace::{Curve, TraceTest};
use cognate_continuation::start_points::StoredPoints;
use num_complex::Complex64;

/// Least |lambda| of a point that does not lie at the parameters where a curve begins.
const NOT_THERE: f64 = 1e-9;

impl LoopSearch {
    /// A search among the sections of a curve, from all solutions of the base.
    pub(super) fn section_search(&self, curve: &Curve) -> Box<Self> {
        let base_points = self.orbits.images(self.graph.base_points());
        // The coordinate lambda of the curve is 0 at the base.
        let on_curve = |mut point: Vec<Complex64>| {
            point.push(Complex64::default());
            point
        };
        let points: Vec<_> = base_points.into_iter().map(on_curve).collect();
        let points = StoredPoints {
            dimension: points[0].len(),
            coordinates: points.concat(),
        };
        let start = LoopStart::new(curve.first_section.clone(), points);
        let (mut limits, tolerances) = (self.limits, self.tolerances.clone());
        limits.count = None;
        let seed = edge_seed(self.seed, usize::MAX - 1);
        let mut search = Self::new(start, limits, curve.shape.clone(), tolerances, seed);
        search.max_retries = self.max_retries;
        search.trace_test = Some(TraceTest::Slices(curve.pencil.clone()));
        search.curve = Some(Box::new(curve.clone()));
        Box::new(search)
    }

    /// Takes the result of a search among sections, when it has stopped, and adds the solutions that it found.
    pub(super) fn settle_sections(&mut self, sections: &Self) {
        let solutions = sections.solutions_at_begin();
        let new = self.graph.add_to_base(&solutions, &self.orbits);
        self.count_solutions();
        let counts = &mut self.counts;
        counts.tracked += sections.counts.tracked;
        counts.lost += sections.counts.lost;
        counts.crossings_found += sections.counts.crossings_found;
        counts.crossings_resolved += sections.counts.crossings_resolved;
        let has_all = new == 0 && solutions.len() as u64 == counts.solutions;
        let result = sections.counts.trace_test.clone();
        counts.trace_test = result.map(|result| TraceCounts {
            form: TraceForm::Sections,
            complete: sections.counts.stop == Some(Stop::TraceTest) && has_all,
            ..result
        });
        self.tested_points = (new == 0).then(|| self.graph.base_points().len());
    }

    /// Points of a curve at the parameters where the curve begins, without the curve's own coordinate.
    fn solutions_at_begin(&self) -> Vec<RegularSolution> {
        let slices = self.moved_slices.as_ref();
        let points = slices.and_then(|slices| slices.solutions_at_begin(&self.graph));
        let at_base = points.unwrap_or_default().into_iter().filter_map(|point| {
            let (lambda, values) = point.values.split_last()?;
            (lambda.norm_sqr().sqrt() < NOT_THERE).then(|| RegularSolution {
                values: values.to_vec(),
                radius: point.radius,
            })
        });
        at_base.collect()
    }
}
