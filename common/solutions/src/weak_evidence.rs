//! WeakEvidence: verdicts that rest on less than what is at stake.
//!
//! Turns around t = 0 show facts about several sheets together. The more sheets there are, the less power sums and
//! valuations say of each. An answer with weak evidence is not settled by its paths; an exact count that agrees with it
//! settles it.

use crate::classification::{Decision, Verdict};
use crate::point_shape::{PointShape, largest, modulus};
use cognate_continuation::endgames::LEAST_POWER_SUM;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_numeric::rational::Rational;
use cognate_systems::expression::Node;
use cognate_systems::expression::differentiate::below;
use cognate_systems::polynomial::has_many_digits;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// Homogenising coordinates of solutions that must not be taken for infinity, the largest coordinate being 1: those of
/// norm 1e4 and less.
const FARTHEST: f64 = 1e-4;
/// Coefficients below this, or above its inverse, show no more in the digits of doubles beside ordinary ones.
const FINEST: f64 = 1e-16;

/// Numbers of paths with verdicts that rest on too little.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WeakEvidence {
    /// Taken for paths to infinity; solutions of moderate norm may be among their ends.
    pub at_infinity: u64,
    /// Taken for paths to positive-dimensional sets.
    pub on_sets: u64,
    /// Taken for paths to multiple points, which may be several points.
    pub multiple: u64,
}

/// Properties that the paths of a start should have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    /// Whether the paths lead to all isolated solutions, so that the answer claims to have all of them.
    pub every_solution: bool,
    /// Least number of paths to positive-dimensional sets, where there are such sets.
    pub least_on_sets: u64,
}

impl WeakEvidence {
    /// Counts weak evidence in the last results of all paths of one target and in their verdicts.
    pub fn of(
        system: &System,
        shape: &PointShape,
        results: &[PathResult],
        decisions: &[Decision],
        expected: Expected,
    ) -> Self {
        let count = |verdict: Verdict| {
            let of_it = decisions.iter().filter(|d| d.verdict == verdict);
            of_it.count() as u64
        };
        let [at_infinity, on_sets, multiple] = [
            Verdict::AtInfinity,
            Verdict::PositiveDimensional,
            Verdict::Singular,
        ]
        .map(count);
        // Most answers of many targets have none of these: their equations are not looked at.
        if at_infinity + on_sets + multiple == 0 {
            return Self::default();
        }
        let numbers = Numbers::of(system);
        // A regular end may lie far out, too: a coordinate beside 1e35 is not told from 0. The digits of the constants
        // of a system with parameters say nothing about the system at general parameters.
        let may_lie_far = |result: &PathResult| {
            let is_general =
                !system.parameters.is_empty() && result.outcome == PathOutcome::Regular;
            numbers.are_long && expected.every_solution && !is_general
        };
        let leaves_open = |result: &PathResult| may_lie_far(result) || may_be_finite(result, shape);
        let open = results.iter().zip(decisions).filter(|(result, decision)| {
            decision.verdict == Verdict::AtInfinity && leaves_open(result)
        });
        // Some of the paths to a set may end at its points at infinity.
        let too_few = on_sets + at_infinity < expected.least_on_sets;
        Self {
            at_infinity: open.count() as u64,
            on_sets: if numbers.are_fine || too_few {
                on_sets
            } else {
                0
            },
            multiple: if numbers.are_long { multiple } else { 0 },
        }
    }

    /// Number of all paths with weak evidence.
    pub fn paths(&self) -> u64 {
        self.at_infinity + self.on_sets + self.multiple
    }
}

/// Whether a path that was taken to infinity may end at a solution of moderate norm.
///
/// Of c sheets that have closed power sums below 1e-20 were taken for 0: c solutions whose homogenising coordinates are
/// the c-th roots of less have no others. A path that has not closed was taken to infinity because its homogenising
/// coordinate is a power of t; it has a limit that is no larger than the coordinate was where the path stopped.
pub fn may_be_finite(result: &PathResult, shape: &PointShape) -> bool {
    if result.outcome != PathOutcome::Diverging || result.accuracy.is_finite() {
        return false;
    }
    match result.winding_number {
        Some(0 | 1) => false,
        Some(sheets) => {
            let product = (0..sheets).fold(1.0, |product, _| product * FARTHEST);
            product < LEAST_POWER_SUM
        }
        None => {
            let point = result.endpoint.to_double();
            let affine = shape.spans().filter(|span| !span.group.homogeneous);
            let coordinates = affine.map(|span| {
                let group = &point[span.range];
                modulus(group[0]) / largest(group)
            });
            // A coordinate that is no number counts as 1.
            coordinates.fold(1.0, f64::min) > FARTHEST
        }
    }
}

/// Whether a path was taken to infinity together with other sheets.
pub fn is_in_cluster(result: &PathResult) -> bool {
    result.outcome == PathOutcome::Diverging && !matches!(result.winding_number, Some(0 | 1))
}

/// Whether numbers in the equations have sizes or digits that make verdicts of paths uncertain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Numbers {
    /// Some numbers lie below the digits in which points are tracked: solutions that differ only by these numbers look
    /// like one, or like points of a set.
    are_fine: bool,
    /// Some numbers are fine or have many digits: solutions may lie at norms of 1e10 and more, which look like
    /// infinity, and nearer to each other than the digits of the paths.
    are_long: bool,
}

impl Numbers {
    fn of(system: &System) -> Self {
        let is_fine = |part: &Rational| {
            let size = part.to_f64().abs();
            *part != 0 && !(FINEST..=1.0 / FINEST).contains(&size)
        };
        let mut numbers = Self {
            are_fine: false,
            are_long: false,
        };
        for id in below(&system.expressions, &system.equations) {
            if let Node::Constant(number) = system.expressions.node(id) {
                numbers.are_fine |= is_fine(&number.re) || is_fine(&number.im);
                numbers.are_long |= numbers.are_fine || has_many_digits(number);
            }
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_results::{affine_shape, regular, roots_of_unity};
    use cognate_numeric::rational::ComplexRational;

    #[test]
    fn the_more_sheets_the_more_must_be_shown() {
        let shape = affine_shape(1);
        let diverging = |winding_number, coordinate: f64| PathResult {
            outcome: PathOutcome::Diverging,
            accuracy: f64::INFINITY,
            winding_number,
            ..regular(0, &[(coordinate, 0.0), (1.0, 0.0)])
        };
        for sheets in 1..=5 {
            assert!(
                !may_be_finite(&diverging(Some(sheets), 0.1), &shape),
                "{sheets}"
            );
        }
        for sheets in [6, 7, 36] {
            assert!(
                may_be_finite(&diverging(Some(sheets), 0.1), &shape),
                "{sheets}"
            );
        }
        // A path of 36 sheets that has not closed stopped where its coordinate was 0.01.
        assert!(may_be_finite(&diverging(None, 1e-2), &shape));
        assert!(!may_be_finite(&diverging(None, 1e-5), &shape));
        assert!(may_be_finite(&diverging(None, f64::NAN), &shape));
        assert!(!may_be_finite(
            &regular(0, &[(0.0, 0.0), (1.0, 0.0)]),
            &shape
        ));
    }

    /// Of the eight paths of three quadrics none or at least two end on a set.
    #[test]
    fn a_set_has_as_many_paths_as_the_lowest_degree_says() {
        let (system, shape) = (roots_of_unity(2), affine_shape(1));
        let weak_paths = |verdicts: &[Verdict], least| {
            let results: Vec<PathResult> = (0..verdicts.len() as u64)
                .map(|path| regular(path, &[(1.0, 0.0), (0.5, 0.0)]))
                .collect();
            let decisions = verdicts.iter().map(|&verdict| Decision {
                verdict,
                by_precision_limit: false,
            });
            let decisions: Vec<Decision> = decisions.collect();
            let expected = Expected {
                every_solution: true,
                least_on_sets: least,
            };
            WeakEvidence::of(&system, &shape, &results, &decisions, expected).paths()
        };
        let (point, set) = (Verdict::Finite, Verdict::PositiveDimensional);
        assert_eq!(weak_paths(&[point, point, set], 2), 1);
        assert_eq!(weak_paths(&[point, set, set], 2), 0);
        assert_eq!(weak_paths(&[point, Verdict::AtInfinity, set], 2), 0);
        assert_eq!(weak_paths(&[point, point, set], 1), 0);
    }

    #[test]
    fn numbers_below_the_digits_of_the_paths_are_seen() {
        let system = |constant: Rational| {
            let mut system = roots_of_unity(2);
            let e = &mut system.expressions;
            let c = e.constant(ComplexRational::real(constant));
            system.equations[0] = e.add(system.equations[0], c);
            system
        };
        let long = |constant| Numbers::of(&system(constant)).are_long;
        let fine = |constant| Numbers::of(&system(constant)).are_fine;
        assert!(!long(Rational::from((355, 113))));
        assert!(!long(Rational::from((1, 1_000_000_000))));
        let tiny = Rational::from((1, 1_000_000_000_000_000_000i64));
        assert!(fine(tiny.clone()) && fine(tiny.clone().recip()));
        let long_number = Rational::from(1) - tiny.clone() * tiny;
        assert!(long(long_number.clone()) && !fine(long_number));
    }
}
