//! UndecidedEnds: ends of paths of which it is not known whether they are isolated, brought to the solutions beside them.
//!
//! An exact count tells how many solutions the equations have, and not that an end is one of them: where all terms of an
//! equation are small, as x^3 y^3 - 3 x y where y is 5e-12, a path can stop far from every solution with a residual of
//! 1e-12.

use cognate_continuation::sharpening::search::sharpen_in_variables;
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::system::System;
use num_complex::Complex64;

/// Decimal digits to which an end is brought: solutions that differ in the last digit of doubles differ clearly.
const DIGITS: u32 = 32;
/// Ends that are looked at, at most: one can take some seconds.
const MOST_ENDS: usize = 100;
/// Seed of the random combinations of derivatives.
const SEED: u64 = 1;
/// Coordinates are the same where they differ by at most this part of the larger one.
const SAME: f64 = 1e-12;
/// A point of a set is within this many times its claimed error of the solution.
const MARGIN: f64 = 64.0;

/// The undecided points of the set, each with the coordinates of the solution that Newton's method proves beside it.
///
/// `None` where that fails for one of them: no solution as multiple as the point is listed lies there, or it is one that
/// the set has at another place.
pub(crate) fn at_solutions(
    set: &SolutionSet,
    system: &System,
    parameters: &[Complex64],
) -> Option<Vec<Solution>> {
    if set.undecided.len() > MOST_ENDS {
        return None;
    }
    let in_unknowns = system.in_unknowns();
    let at_solution = |end: &Solution| {
        let values: Vec<Complex64> = end.variables.values().collect();
        let (system, scaling) = (&in_unknowns, &system.scaling);
        let sharpened = sharpen_in_variables(system, scaling, parameters, &values, DIGITS, SEED);
        let sharpened = sharpened.ok()?;
        let is_as_multiple = (sharpened.deflations > 0) == (end.multiplicity > 1);
        if !is_as_multiple {
            return None;
        }
        let mut end = end.clone();
        for (variable, exact) in end.variables.0.iter_mut().zip(&sharpened.values) {
            variable.value = Complex64::new(exact.re.to_f64(), exact.im.to_f64());
        }
        end.accuracy = f64::EPSILON;
        Some(end)
    };
    let ends: Option<Vec<Solution>> = set.undecided.iter().map(at_solution).collect();
    ends.filter(|ends| are_apart(ends, &set.solutions))
}

/// Whether no two of these ends are the same, and none is one of the solutions.
fn are_apart(ends: &[Solution], solutions: &[Solution]) -> bool {
    ends.iter().enumerate().all(|(place, end)| {
        let mut others = ends[..place].iter().chain(solutions);
        !others.any(|other| may_be_same(end, other))
    })
}

fn may_be_same(a: &Solution, b: &Solution) -> bool {
    let size = |z: Complex64| z.re.abs().max(z.im.abs());
    let largest = |point: &Solution| point.variables.values().map(size).fold(0.0, f64::max);
    let error = MARGIN * (a.accuracy * largest(a) + b.accuracy * largest(b));
    let mut both = a.variables.values().zip(b.variables.values());
    both.all(|(x, y)| size(x - y) <= error.max(SAME * size(x).max(size(y))))
}
