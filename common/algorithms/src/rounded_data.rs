//! Rounded data: solutions whose number, or being real, depends on digits beyond the accuracy of the given decimals.

use cognate_numeric::counted::counted;
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use num_complex::Complex64;

/// A solution, its coordinates, and how far an error of the data moves it.
struct Point<'a> {
    solution: &'a Solution,
    values: Vec<Complex64>,
    /// Error of its largest coordinate that an error of the data makes, at most.
    error: f64,
}

impl<'a> Point<'a> {
    fn of(solution: &'a Solution, data_accuracy: f64) -> Self {
        let values: Vec<Complex64> = solution.variables.values().collect();
        let squares = values.iter().map(|z| z.norm_sqr());
        let size = squares.fold(0.0, f64::max).sqrt();
        Self {
            error: solution.condition * data_accuracy * size,
            solution,
            values,
        }
    }
}

/// Warns of solutions that are multiple, or nearer to another than an error of the data moves both.
///
/// `data_accuracy`: relative accuracy to which the equations' coefficients are known, 0 where they are exact.
pub(crate) fn warn_of_rounded_data(set: &mut SolutionSet, data_accuracy: f64) {
    if data_accuracy == 0.0 {
        return;
    }
    let count = sensitive_solutions(&set.solutions, data_accuracy);
    if count > 0 {
        let (is, its) = match count {
            1 => ("is", "its"),
            _ => ("are", "their"),
        };
        set.warnings.push(format!(
            "{} {is} multiple, or so near to another, that other digits beyond the accuracy of the given decimals may \
             change {its} number or {its} being real",
            counted(count as u64, "solution"),
        ));
    }
}

/// Number of solutions that are multiple, or nearer to another than an error of the data moves both.
fn sensitive_solutions(solutions: &[Solution], data_accuracy: f64) -> usize {
    let mut points: Vec<Point> = solutions
        .iter()
        .map(|solution| Point::of(solution, data_accuracy))
        .collect();
    points.sort_by(|a, b| first(a).total_cmp(&first(b)));
    let is_sensitive = |k: usize| points[k].solution.singular || has_neighbour(&points, k);
    (0..points.len()).filter(|&k| is_sensitive(k)).count()
}

/// Real part of the first coordinate, by which points are sorted.
fn first(point: &Point) -> f64 {
    point.values.first().map_or(0.0, |z| z.re)
}

/// Whether another of the points, which are sorted by [`first`], is within twice the error of a point.
fn has_neighbour(points: &[Point], k: usize) -> bool {
    let point = &points[k];
    let radius = 2.0 * point.error;
    let is_near = |other: &&Point| first(other) - first(point) <= radius;
    let is_far = |other: &&Point| first(point) - first(other) <= radius;
    let after = points[k + 1..].iter().take_while(is_near);
    let before = points[..k].iter().rev().take_while(is_far);
    after.chain(before).any(|other| {
        let pairs = point.values.iter().zip(&other.values);
        let differences = pairs.map(|(a, b)| (a - b).norm_sqr());
        differences.fold(0.0, f64::max).sqrt() <= radius
    })
}

#[cfg(test)]
mod tests {
    use crate::plan::{SolveOptions, plan};
    use crate::run_locally::run_locally;
    use cognate_systems::formats::read;

    /// Number of solutions and warnings of a text, whose decimals are known to this accuracy.
    fn solve(text: &str, data_accuracy: f64) -> (u64, Vec<String>) {
        let system = read("test", text.as_bytes()).expect("equations").system;
        let mut options = SolveOptions::default();
        options.tracking.settings.data_accuracy = data_accuracy;
        let mut plan = plan(&system, &options).expect("a plan");
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        let set = sets.expect("solutions").remove(0);
        assert!(set.settled(), "{set:?}");
        (set.counts.distinct, set.warnings)
    }

    /// A tangent of a circle, whose distance from the centre is sqrt(2) to 15 digits, meets it twice, 1e-7 apart.
    #[test]
    fn a_tangent_of_fifteen_digits_is_warned_of() {
        let tangent = "x^2 + y^2 = 1\ny = 1.41421356237309 - x";
        let (distinct, warnings) = solve(tangent, 3.5e-15);
        assert_eq!((distinct, warnings.len()), (2, 1), "{warnings:?}");
        assert!(warnings[0].starts_with("2 solutions are multiple, or so near"));
        assert_eq!(solve(tangent, 0.0), (2, Vec::new()));
    }

    #[test]
    fn distant_solutions_of_rounded_data_are_not_warned_of() {
        let secant = "x^2 + y^2 = 1\ny = 1.23456789012345 - x";
        assert_eq!(solve(secant, 4e-15), (2, Vec::new()));
    }
}
