//! Solutions of rational equations, in monomials of the unknowns where this makes degrees much lower.

use super::exact_point::ExactPoint;
use super::in_all_unknowns::exact_points_in_all_unknowns;
use super::monomial_change::MonomialChange;
use super::rational_equations::RationalEquations;
use crate::polynomial::solution_count::NotCounted;
use crate::polynomial::solution_count::groebner::Budget;

/// Computes all solutions of equations, each with at least `digits` decimal digits, within the budget.
pub(super) fn solved(
    equations: &RationalEquations,
    digits: u32,
    operations: u64,
) -> Result<Option<Vec<ExactPoint>>, NotCounted> {
    let mut budget = Budget(operations);
    let points = match MonomialChange::of(equations) {
        Some(change) => change.points(equations, digits, &mut budget)?,
        None => exact_points_in_all_unknowns(equations, digits, &mut budget)?,
    };
    Ok(points.map(|points| with_positive_roots(points, equations)))
}

/// The points where each square root of a number is the positive one, without these unknowns.
fn with_positive_roots(
    mut points: Vec<ExactPoint>,
    equations: &RationalEquations,
) -> Vec<ExactPoint> {
    points.retain(|point| equations.has_positive_roots(point));
    for point in &mut points {
        point.values.truncate(equations.square_roots.start);
        point.rounded.truncate(equations.square_roots.start);
    }
    points
}
