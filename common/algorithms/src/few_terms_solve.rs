//! All solutions of equations of few terms and high degree, without paths: in monomials of the unknowns they are of low
//! degree, and few (`systems::polynomial::exact_points`).
//!
//! Paths of equations of degree 170 lose the digits that tell their ends apart, and take more steps than the exact
//! solution takes operations. The counts speak of paths, as everywhere: each solution stands for as many as its
//! multiplicity.

use crate::exact_answer::{self, PathsOfPoint};
use crate::limits::HIGH_DEGREE;
use crate::solve_options::SolveOptions;
use crate::solve_without_paths::{ExactEnd, SolveWithoutPaths, has_double, results};
use cognate_numeric::decimal_text::complex_text;
use cognate_solutions::involution::Involution;
use cognate_solutions::sharpened::{DIGITS_OF_DOUBLES, last_digit};
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::summary::{PathCounts, SharpenedCounts};
use cognate_systems::polynomial::degrees_by_form;
use cognate_systems::polynomial::exact_points::{ExactPoint, degrees_of_few_terms, exact_points};
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::denominator_factors;
use num_complex::Complex64;

/// Reason why no paths are tracked.
pub(crate) const WHY: &str =
    "few terms of high degree: all solutions exactly, in monomials of the unknowns";

/// Largest product of the degrees in the monomials. Two equations of degree 55 whose product is 50 take 4.6 CPU s
/// exactly, and 0.03 by paths from mixed cells; equations of two terms each, whose product is 1, take 0.06 s at any
/// degree.
const LARGEST_PRODUCT: u64 = 8;
/// Largest number of solutions for each in the monomials. Three binomials with 14,731 solutions take 5 s exactly, and 1
/// s by paths; two with 793 take 0.1 s.
const LARGEST_INDEX: u128 = 2_000;
/// Operations of the exact solution, at most: about a second.
const MOST_OPERATIONS: u64 = 200_000_000;

/// Whether a system, of which all solutions are asked, has few terms of high degree, and hardly any degree in monomials
/// of the unknowns. Equations of low degree, which are nearly all, are not multiplied out for that.
pub(crate) fn suits(system: &System, parameters: &[Complex64]) -> bool {
    may_have_high_degree(system)
        && denominator_factors(system).is_empty()
        && degrees_of_few_terms(system, parameters).is_some_and(|degrees| {
            degrees.largest >= HIGH_DEGREE
                && degrees.product_in_monomials <= LARGEST_PRODUCT
                && degrees.index <= LARGEST_INDEX
        })
}

/// Whether the form of an equation suggests a high degree; the true one is no higher.
fn may_have_high_degree(system: &System) -> bool {
    let variables: Vec<usize> = (0..system.variable_count()).collect();
    system.equations.iter().any(|equation| {
        let degrees = degrees_by_form(&system.expressions, *equation, &variables);
        degrees
            .get(equation)
            .is_some_and(|&degree| degree >= HIGH_DEGREE)
    })
}

/// The solutions of a system at these values of its parameters; `None` where they are left to paths.
pub(crate) fn few_terms_solve(
    system: &System,
    parameters: &[Complex64],
    options: &SolveOptions,
) -> Option<SolveWithoutPaths> {
    if !suits(system, parameters) {
        return None;
    }
    let closings = &options.closings;
    let digits = closings.digits.unwrap_or(DIGITS_OF_DOUBLES);
    let points = exact_points(system, parameters, digits, MOST_OPERATIONS).ok()??;
    if points.is_empty() || !points.iter().all(has_doubles) {
        return None;
    }
    let mut set = solution_set(system, parameters, &points, digits);
    if digits > DIGITS_OF_DOUBLES || closings.deflate {
        set.counts.sharpened = Some(SharpenedCounts {
            digits,
            solutions: set.counts.distinct,
            by_deflation: set.counts.singular,
        });
        for solution in &mut set.solutions {
            solution.deflations = Some(u32::from(solution.singular));
        }
    }
    let results = results(system, points.iter().map(end_of));
    Some(SolveWithoutPaths::new(set, results, parameters, options))
}

/// Whether doubles hold both parts of all unknowns.
fn has_doubles(point: &ExactPoint) -> bool {
    let mut pairs = point.values.iter().zip(&point.rounded);
    pairs.all(|(exact, &rounded)| has_double(exact, rounded))
}

fn solution_set(
    system: &System,
    parameters: &[Complex64],
    points: &[ExactPoint],
    digits: u32,
) -> SolutionSet {
    let involution = Involution::of(system, parameters);
    let mut set = SolutionSet::default();
    let mut paths = PathCounts {
        positive_dimensional: Some(0),
        excess: Some(0),
        ..PathCounts::default()
    };
    for point in points {
        let ended = PathsOfPoint {
            paths: (paths.total..paths.total + point.multiplicity).collect(),
            cycles: vec![multiplicity(point)],
        };
        paths.total += point.multiplicity;
        match point.multiplicity {
            1 => paths.finite += 1,
            several => paths.singular += several,
        }
        let bits = paths.by_precision.entry(point.precision_bits);
        *bits.or_default() += point.multiplicity;
        let real = involution.as_ref().ok();
        let real = real.map(|involution| exact_answer::is_real(point, involution));
        let solution = exact_answer::solution(system, point.clone(), ended, real);
        set.solutions.push(with_digits(solution, point, digits));
    }
    paths.highest_precision_bits = paths.by_precision.keys().copied().max().unwrap_or(0);
    assert_eq!(paths.sum(), paths.total, "every solution is in one class");
    set.paths = paths;
    let real_reason = involution.err().map(|reason| reason.to_string());
    exact_answer::count(
        &mut set,
        "all solutions of the equations, exactly",
        real_reason,
    );
    set
}

/// Writes the coordinates of the solution with all digits that were asked for.
fn with_digits(mut solution: Solution, point: &ExactPoint, digits: u32) -> Solution {
    if digits > DIGITS_OF_DOUBLES {
        for (value, exact) in solution.variables.0.iter_mut().zip(&point.values) {
            value.digits = Some(complex_text(exact, digits));
        }
        solution.accuracy = last_digit(digits);
    }
    solution
}

/// A point as an end of as many paths as its multiplicity.
fn end_of(point: &ExactPoint) -> ExactEnd {
    ExactEnd {
        values: point.rounded.clone(),
        multiplicity: multiplicity(point),
        residual: point.residual,
        condition: point.condition,
        accuracy: exact_answer::ROUNDING,
        precision_bits: point.precision_bits,
    }
}

/// Number of paths that end at a point: below 2^32, since the product of the degrees in the monomials is at most
/// [`LARGEST_PRODUCT`].
fn multiplicity(point: &ExactPoint) -> u32 {
    u32::try_from(point.multiplicity).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::any_algorithm::AnyAlgorithm;
    use crate::run_locally::run_locally;
    use crate::solve_options::{ClosingOptions, SolveMethod};
    use crate::start_kind::StartKind;
    use crate::{Plan, plan};
    use cognate_systems::formats::read;

    fn planned(text: &str, options: &SolveOptions) -> Plan {
        let system = read("test", text.as_bytes()).expect("equations").system;
        plan(&system, options).expect("a plan")
    }

    fn solve(text: &str, options: &SolveOptions) -> SolutionSet {
        let mut plan = planned(text, options);
        assert_eq!(plan.start, StartKind::FewTerms);
        let restored = AnyAlgorithm::restore(&plan.algorithm.snapshot()).expect("a snapshot");
        assert_eq!(restored, plan.algorithm);
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        let set = sets.expect("solutions").remove(0);
        assert_eq!(set.paths.sum(), set.paths.total);
        assert_eq!(Some(set.paths.total), plan.paths);
        assert!(set.settled());
        set
    }

    /// x = 3/2 and y^60 = 2 (2/3)^60, and the determinant of two binomials.
    #[test]
    fn counts_add_up() {
        let set = solve("x^60*y^60 = 2\nx^61*y^60 = 3", &SolveOptions::default());
        let counts = &set.counts;
        assert_eq!((counts.distinct, counts.real), (60, Some(2)));
        let set = solve("(x^40*y^30 - 2)^2\nx^30*y^40 = 3", &SolveOptions::default());
        let (paths, counts) = (&set.paths, &set.counts);
        assert_eq!((paths.total, paths.finite, paths.singular), (1400, 0, 1400));
        let counted = (counts.distinct, counts.with_multiplicity, counts.real);
        assert_eq!(counted, (700, 1400, Some(4)));
    }

    #[test]
    fn digits_and_certificates_are_for_whom_they_are_asked() {
        let closings = ClosingOptions {
            digits: Some(30),
            certify: true,
            ..ClosingOptions::default()
        };
        let options = SolveOptions {
            closings,
            ..SolveOptions::default()
        };
        let set = solve("x^60*y^60 = 2\nx^61*y^60 = 3", &options);
        assert_eq!(
            (set.counts.certified, set.counts.certified_real),
            (Some(60), Some(2))
        );
        let digits = set.solutions[0].variables.0[0].digits.clone();
        let expected = "1.50000000000000000000000000000".to_string();
        assert_eq!(digits, Some([expected, "0".to_string()]));
    }

    #[test]
    fn other_equations_are_left_to_paths() {
        let named = SolveOptions {
            method: SolveMethod::TotalDegree,
            ..SolveOptions::default()
        };
        let high = "x^30*y^31 = 2\nx^31*y^30 = 3";
        assert_eq!(planned(high, &named).start, StartKind::TotalDegree);
        // Low degrees, numbers that are not rational, a solution where an unknown is 0, many terms, and many
        // solutions.
        for text in [
            "x^18*y^12 - x^19*y^10 - x^35*y^21 + 1\nx^19*y^12 - 3*x^17*y^11 + 2",
            "x^2*y^3 = 2\nx^3*y^2 = 3",
            "x^30*y^31 = Pi\nx^31*y^30 = 3",
            "x^30 + y^31 = 0\nx^31*y^30 = y",
            "x^20*y^3*z^5 = 2\nx*y^25*z^4 = 3\nx^2*y^6*z^31 = 5",
        ] {
            let plan = planned(text, &SolveOptions::default());
            assert_ne!(plan.start, StartKind::FewTerms, "{text}");
        }
    }
}
