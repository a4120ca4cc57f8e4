//! Whether the least value on a positive-dimensional set of critical points is taken at a real point that meets the
//! conditions.
//!
//! The least value on a region where it is taken is one of the critical values. A real point of the region with a value
//! between two critical values proves that the least one is no larger than the lower of them; it need not be critical.
//! Such points come from a second system: critical points of the objective and a small multiple of the squared distance
//! to a general point, which is least at isolated points near the set.

use super::general_point::general_point;
use super::value::{Place, Value};
use super::{Critical, without_multipliers};
use crate::selection::Verdict;
use crate::solution::Solution;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::objective::Goal;
use cognate_systems::system::System;
use cognate_systems::transform::add_squared_distance;
use num_complex::Complex64;

/// Logarithm to base 2 of the reciprocal of the weight of the squared distance: 1.5e-5 leaves values apart that differ by
/// a thousandth, and a condition number of 1e5 that doubles bear.
const WEIGHT: u32 = 16;

/// Number of unknowns of a point, at most, that a reason names.
const MOST_NAMED_UNKNOWNS: usize = 6;

/// A real point that meets the equations and all conditions.
#[derive(Clone, Debug)]
pub(super) struct PointInside {
    /// Value of the objective.
    value: f64,
    /// How far the value may be from the exact one.
    error: f64,
    /// Values of the unknowns.
    unknowns: Vec<f64>,
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

    /// Adds a solution of the second system, where it is a real point that meets all conditions.
    pub fn add_point_near_sets(&mut self, solution: Solution, parameters: &[Complex64]) {
        if solution.real != Some(true) || solution.undecided {
            return;
        }
        let point: Vec<Complex64> = solution.variables.values().collect();
        let bounds = self.bounds(&solution, parameters);
        let (value, error) = self.value(&point, parameters, &bounds[0]);
        let active = self.active(&point, &bounds[1..], solution.singular);
        let zeros = self.zeros(&active);
        let solution = without_multipliers(solution, &point, self.unknowns);
        let is_inside = self.alternatives.as_mut().is_none_or(|with| {
            with.closed
                .verdict_with_zeros(&solution, parameters, &zeros)
                == Verdict::Selected
        });
        if is_inside {
            self.points_inside.push(PointInside {
                value,
                error,
                unknowns: point[..self.unknowns].iter().map(|z| z.re).collect(),
            });
        }
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
