//! Whether the least value on a positive-dimensional set of critical points is taken at a real point that meets the
//! conditions.
//!
//! The least value on a region where it is taken is one of the critical values. A real point of the region with a value
//! between two critical values proves that the least one is no larger than the lower of them; it need not be critical.
//! A second system gives these points: critical points of the objective and a small multiple of the squared distance
//! to a general point, which is least at isolated points near the set.
//!
//! A set that no such point proves may lie outside the conditions. All values on the region are at least the least value of
//! the second objective less that multiple of the largest squared distance, which a third system gives on a bounded region:
//! sets with lower values are left out.

use super::general_point::general_point;
use super::value::{Place, PointInside, Value};
use super::{Critical, without_multipliers};
use crate::selection::Verdict;
use crate::solution::Solution;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::objective::Goal;
use cognate_systems::polynomial::attained::Attained;
use cognate_systems::system::System;
use cognate_systems::transform::{add_squared_distance, subtract_objective};
use num_complex::Complex64;

/// Logarithm to base 2 of the reciprocal of the weight of the squared distance: 1.5e-5 leaves values apart that differ by
/// a thousandth, and a condition number of 1e5 that doubles bear.
const WEIGHT: u32 = 16;

/// Part of 1 and its size by which a value on a set is at least below that of the second objective, where the third system
/// is solved.
const LEAST_GAP: f64 = 1e-3;
/// Number of unknowns of a point, at most, that a reason names.
const MOST_NAMED_UNKNOWNS: usize = 6;

/// Weight of half of the squared distance.
fn weight() -> f64 {
    1.0 / f64::from(1u32 << WEIGHT)
}

impl Critical {
    /// The system of the second solve, in the variables of that of the critical points; `None` where no point is needed.
    pub fn near_sets(&self) -> Option<System> {
        let on_set = |value: &Value| value.place == Place::OnSet;
        let sign = match self.goal {
            Goal::Critical => return None,
            Goal::Minimize => 1,
            Goal::Maximize => -1,
        };
        // A point that meets all conditions but for equality proves nothing of those on the set.
        let alternatives = self.alternatives.as_ref();
        let excludes_equality = alternatives.is_some_and(|with| with.excludes_equality);
        if excludes_equality || !self.values.iter().any(on_set) {
            return None;
        }
        let centre = general_point(self.unknowns);
        let weight = ComplexRational::real(Rational::from((sign, 1u64 << WEIGHT)));
        let mut system = self.system.clone();
        add_squared_distance(&mut system, &centre, &weight);
        Some(system)
    }

    /// Adds the solutions of the second system; `are_all` says that there are no others.
    pub fn add_points_near_sets(
        &mut self,
        solutions: Vec<Solution>,
        are_all: bool,
        parameters: &[Complex64],
    ) {
        let sign = self.sign();
        let mut least = f64::INFINITY;
        for solution in solutions {
            let Some((verdict, point)) = self.verdict_of(solution, parameters) else {
                continue;
            };
            let moved = sign * point.value + 0.5 * weight() * point.squared_distance();
            least = least.min(moved - point.error);
            if verdict == Verdict::Selected {
                self.points_inside.push(point);
            }
        }
        self.least_near = are_all.then_some(least);
    }

    /// The system of the points that lie farthest from the general point; `None` where they tell nothing or the region is
    /// not bounded.
    pub fn farthest(&self, parameters: &[Complex64]) -> Option<System> {
        let least = self.least_near?;
        let sign = self.sign();
        let is_below = |value: &Value| {
            let gap = LEAST_GAP * (1.0 + value.value.abs());
            value.place == Place::OnSet && sign * value.value + value.error + gap < least
        };
        let is_bounded = || self.attained(sign, parameters) == Some(Attained::Bounded);
        if !self.values.iter().any(is_below) || !is_bounded() {
            return None;
        }
        let centre = general_point(self.unknowns);
        let mut system = self.system.clone();
        subtract_objective(&mut system, self.objective, self.unknowns);
        add_squared_distance(&mut system, &centre, &ComplexRational::real(1));
        Some(system)
    }

    /// Adds all solutions of the third system.
    pub fn add_farthest_points(&mut self, solutions: Vec<Solution>, parameters: &[Complex64]) {
        let mut largest = f64::NEG_INFINITY;
        for solution in solutions {
            if let Some((_, point)) = self.verdict_of(solution, parameters) {
                largest = largest.max(point.squared_distance());
            }
        }
        let least = self.least_near.filter(|_| largest.is_finite());
        self.least_inside = least.map(|least| least - 0.5 * weight() * largest);
    }

    /// Decides the conditions at a solution that may be real; `None` where it is outside.
    fn verdict_of(
        &mut self,
        solution: Solution,
        parameters: &[Complex64],
    ) -> Option<(Verdict, PointInside)> {
        if solution.real == Some(false) {
            return None;
        }
        let is_sure = solution.real == Some(true) && !solution.undecided;
        let point: Vec<Complex64> = solution.variables.values().collect();
        let bounds = self.bounds(&solution, parameters);
        let (value, error) = self.value(&point, parameters, &bounds[0]);
        let active = self.active(&point, &bounds[1..], solution.singular);
        let zeros = self.zeros(&active);
        let solution = without_multipliers(solution, &point, self.unknowns);
        let verdict = match &mut self.alternatives {
            None if is_sure => Verdict::Selected,
            None => Verdict::Undecided,
            Some(with) => with
                .closed
                .verdict_with_zeros(&solution, parameters, &zeros),
        };
        let point = PointInside {
            value,
            error,
            unknowns: point[..self.unknowns].iter().map(|z| z.re).collect(),
        };
        (verdict != Verdict::Rejected).then_some((verdict, point))
    }

    /// Words that name a point near the set on which the least value is taken; none where unknowns stand for functions.
    pub(super) fn example(&self, point: &PointInside) -> String {
        let n = self.unknowns;
        if self.with_helpers.is_some() || n > MOST_NAMED_UNKNOWNS {
            return String::new();
        }
        let names = self.system.variables[..n].join(", ");
        let numbers: Vec<String> = point.unknowns.iter().map(|x| format!("{x:.3}")).collect();
        format!(", as near ({names}) = ({})", numbers.join(", "))
    }

    /// A real point that meets all conditions, with a value between the least of the critical `values`, which is `best`,
    /// and the next; `None` where none is at hand. The least value has the sign 1, the largest -1.
    pub(super) fn point_that_proves(
        &self,
        best: &Value,
        values: &[Value],
        sign: f64,
    ) -> Option<&PointInside> {
        let others = values.iter().filter(|other| !other.is_near(best));
        let next = others.map(|other| sign * other.value - other.error);
        let next = next.fold(f64::INFINITY, f64::min);
        let mut points: Vec<&PointInside> = self.points_inside.iter().collect();
        points.retain(|point| sign * point.value + point.error < next);
        points
            .into_iter()
            .min_by(|a, b| (sign * a.value).total_cmp(&(sign * b.value)))
    }
}
