//! All roots of equations in one unknown, without paths: they are found while the solve is planned, and no worker has
//! anything to do but for certificates.
//!
//! The counts speak of paths, as everywhere: each root stands for as many as its multiplicity, together as many as the
//! greatest common divisor of the equations has degrees.

use crate::exact_answer::ROUNDING;
use crate::solve_options::SolveOptions;
use crate::solve_without_paths::{ExactEnd, SolveWithoutPaths, has_double, results};
use cognate_numeric::decimal_text::complex_text;
use cognate_numeric::rational::ComplexRational;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::involution::Involution;
use cognate_solutions::sharpened::{DIGITS_OF_DOUBLES, last_digit};
use cognate_solutions::solution::{NamedValue, NamedValues, Solution};
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::summary::{PathCounts, SharpenedCounts, SolutionCounts};
use cognate_systems::expression::Node;
use cognate_systems::expression::differentiate::below;
use cognate_systems::polynomial::univariate::{UnivariateRoot, UnivariateRoots, univariate_roots};
use cognate_systems::scaling::Scaling;
use cognate_systems::system::System;
use cognate_systems::transform::clear_denominators::{ZERO_DENOMINATOR, denominator_factors};
use num_complex::Complex64;

/// Reason why no paths are tracked.
pub(crate) const WHY: &str = "one unknown: square-free factors exactly, and all roots of each together, in discs that hold one each";

/// Most operations, about one for each product of 64-bit numbers: half a minute. Degree 1000 takes a tenth.
const MOST_OPERATIONS: u64 = 1 << 32;
/// Roots that are larger, in the units in which a system is tracked, are infinite within the accuracy of rounded
/// coefficients, or nearly so: the paths say which (`tracker/far_out.rs`).
const FARTHEST_OF_ROUNDED: f64 = 1e12;

/// The roots of a system in one unknown at these values of its parameters; `None` where they are left to paths.
pub(crate) fn one_unknown_solve(
    system: &System,
    parameters: &[Complex64],
    options: &SolveOptions,
) -> Option<SolveWithoutPaths> {
    if !suits(system) || options.closings.no_exact_count {
        return None;
    }
    let settings = &options.tracking.settings;
    let is_rounded = settings.error_of_data() > 0.0;
    // Rounded equations have a common root only nearly, and a rounded denominator is 0 only nearly.
    let is_one_polynomial = system.equation_count() == 1 && denominator_factors(system).is_empty();
    if is_rounded && !is_one_polynomial {
        return None;
    }
    let exact: Option<Vec<ComplexRational>> = parameters
        .iter()
        .map(|&value| ComplexRational::from_doubles(value))
        .collect();
    let digits = options.closings.digits.unwrap_or(DIGITS_OF_DOUBLES);
    let roots = univariate_roots(system, &exact?, digits, MOST_OPERATIONS).ok()?;
    let is_far =
        |root: &UnivariateRoot| is_rounded && farthest(root, &system.scaling) > FARTHEST_OF_ROUNDED;
    let is_bounded = |root: &UnivariateRoot| root.rounded.is_finite();
    // Equations without a common root have ends that are near to all of them.
    if roots.degree == 0 || roots.roots.iter().any(is_far) || !roots.roots.iter().all(is_bounded) {
        return None;
    }
    let written = WrittenRoots {
        system,
        parameters,
        digits,
        is_sharpened: digits > DIGITS_OF_DOUBLES || options.closings.deflate,
    };
    let set = written.solution_set(&roots);
    let results = results(system, roots.roots.iter().map(end_of));
    Some(SolveWithoutPaths::new(set, results, parameters, options))
}

/// Whether a system has one unknown and rational coefficients, and nothing is asked that is said of paths.
pub(crate) fn suits(system: &System) -> bool {
    let expressions = &system.expressions;
    let is_rational = below(expressions, &system.equations).iter().all(|&id| {
        let node = expressions.node(id);
        !matches!(node, Node::Root(..) | Node::Function(..))
    });
    let is_declared = system
        .degenerate
        .keys()
        .any(|name| name != ZERO_DENOMINATOR);
    let is_one_point = system.dimension() == 1 && system.variable_count() == 1;
    is_one_point
        && is_rational
        && !is_declared
        && system.path_variable.is_none()
        && system.symmetry.is_empty()
        && system.helpers.is_empty()
}

/// The larger part of a root in the units in which the system is tracked.
fn farthest(root: &UnivariateRoot, scaling: &Scaling) -> f64 {
    let unknown = scaling.to_unknown(0, root.rounded);
    unknown.re.abs().max(unknown.im.abs())
}

/// Roots to be written as solutions.
struct WrittenRoots<'a> {
    system: &'a System,
    parameters: &'a [Complex64],
    digits: u32,
    /// Whether more digits, or those of multiple roots, were asked for.
    is_sharpened: bool,
}

impl WrittenRoots<'_> {
    fn solution_set(&self, roots: &UnivariateRoots) -> SolutionSet {
        let mut set = SolutionSet::default();
        if !denominator_factors(self.system).is_empty() {
            set.counts.removed.insert(ZERO_DENOMINATOR.into(), 0);
        }
        let involution = Involution::of(self.system, self.parameters);
        let mut path = 0;
        for root in &roots.roots {
            let multiplicity = u64::from(root.multiplicity);
            let paths: Vec<u64> = (path..path + multiplicity).collect();
            path += multiplicity;
            let bits = set.paths.by_precision.entry(root.precision_bits);
            *bits.or_default() += multiplicity;
            if root.is_removed {
                set.removed.extend(paths);
                let removed = set.counts.removed.entry(ZERO_DENOMINATOR.into());
                *removed.or_default() += 1;
                continue;
            }
            let real = involution.is_ok().then(|| root.is_real());
            set.solutions.push(self.solution(root, paths, real));
        }
        let solutions = &set.solutions;
        let sum = |singular: bool| {
            let of_kind = solutions.iter().filter(|s| s.singular == singular);
            of_kind.map(|s| s.multiplicity).sum::<u64>()
        };
        set.paths = PathCounts {
            total: u64::from(roots.degree),
            finite: sum(false),
            singular: sum(true),
            removed: set.removed.len() as u64,
            positive_dimensional: Some(0),
            excess: Some(0),
            highest_precision_bits: set.paths.by_precision.keys().copied().max().unwrap_or(0),
            by_precision: std::mem::take(&mut set.paths.by_precision),
            ..PathCounts::default()
        };
        assert_eq!(
            set.paths.sum(),
            set.paths.total,
            "every root is in one class"
        );
        let count = |holds: &dyn Fn(&Solution) -> bool| {
            let counted = set.solutions.iter().filter(|s| holds(s));
            counted.count() as u64
        };
        set.counts = SolutionCounts {
            distinct: count(&|_| true),
            nonsingular: count(&|s| !s.singular),
            singular: count(&|s| s.singular),
            real: involution.is_ok().then(|| count(&|s| s.real == Some(true))),
            real_reason: involution.err().map(|reason| reason.to_string()),
            with_multiplicity: sum(false) + sum(true),
            positive_dimensional: Some(false),
            sharpened: self.is_sharpened.then(|| SharpenedCounts {
                digits: self.digits,
                solutions: count(&|_| true),
                by_deflation: count(&|s| s.singular),
            }),
            complete: Completeness::Yes,
            complete_reason: Some(
                "as many roots as the degree of the equations' greatest common divisor".to_string(),
            ),
            removed: std::mem::take(&mut set.counts.removed),
            ..SolutionCounts::default()
        };
        set
    }

    fn solution(&self, root: &UnivariateRoot, paths: Vec<u64>, real: Option<bool>) -> Solution {
        // Doubles below 1e-308 have fewer digits, or none.
        let has_more = self.digits > DIGITS_OF_DOUBLES || !has_double(&root.value, root.rounded);
        let singular = root.multiplicity > 1;
        let accuracy = match has_more {
            true => root.error + last_digit(self.digits),
            false => root.error + ROUNDING,
        };
        Solution {
            variables: NamedValues(vec![NamedValue {
                name: self.system.variables[0].clone(),
                value: root.rounded,
                digits: has_more.then(|| complex_text(&root.value, self.digits)),
            }]),
            multiplicity: u64::from(root.multiplicity),
            cycles: vec![root.multiplicity],
            real,
            singular,
            // With all digits the equations are less than at the rounded root.
            residual: match has_more {
                true => root.residual.min(accuracy),
                false => root.residual,
            },
            condition: root.condition,
            accuracy,
            precision_bits: root.precision_bits,
            class: None,
            paths,
            certificate: None,
            // A square-free factor has a multiple root as a simple one.
            deflations: self.is_sharpened.then_some(u32::from(singular)),
            undecided: false,
        }
    }
}

/// A root as an end of as many paths as its multiplicity.
fn end_of(root: &UnivariateRoot) -> ExactEnd {
    ExactEnd {
        values: vec![root.rounded],
        multiplicity: root.multiplicity,
        residual: root.residual,
        condition: root.condition,
        accuracy: root.error + ROUNDING,
        precision_bits: root.precision_bits,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::any_algorithm::AnyAlgorithm;
    use crate::run_locally::run_locally;
    use crate::solve::PathAlgorithm;
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
        assert_eq!(plan.start, StartKind::OneUnknown);
        let restored = AnyAlgorithm::restore(&plan.algorithm.snapshot()).expect("a snapshot");
        assert_eq!(restored, plan.algorithm);
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        assert!(plan.algorithm.progress().done);
        let set = sets.expect("roots").remove(0);
        assert_eq!(set.paths.sum(), set.paths.total);
        assert_eq!(Some(set.paths.total), plan.paths);
        set
    }

    #[test]
    fn counts_add_up_and_the_exact_count_agrees() {
        let set = solve(
            "(x-1)^7*(x+2)^3*(x^2+1)^2*(x-5)/(x-1)^2",
            &SolveOptions::default(),
        );
        let paths = &set.paths;
        let classes = (paths.total, paths.finite, paths.singular, paths.removed);
        assert_eq!(classes, (15, 1, 7, 7));
        let counts = &set.counts;
        assert_eq!((counts.distinct, counts.with_multiplicity), (4, 8));
        assert_eq!(
            (counts.real, counts.removed[ZERO_DENOMINATOR]),
            (Some(2), 1)
        );
        assert!(set.settled() && counts.complete == Completeness::Yes);
        let set = solve("x^3 - 3*x + 2", &SolveOptions::default());
        assert!(set.settled() && set.counts.exact_count.is_some_and(|count| count.agrees));
        let results = planned("x^3 - 3*x + 2", &SolveOptions::default());
        let results = results.algorithm.renumbered_results();
        assert_eq!(results.map(|results| results.len()), Some(3));
    }

    /// Doubles end at 1e-308; the digits of a root do not.
    #[test]
    fn roots_below_the_doubles_have_digits() {
        for (text, distinct) in [
            ("x = 1e-350", 1),
            ("x^2 = 1e-700", 2),
            ("x*(x - 1) = 1e-400", 2),
        ] {
            let set = solve(text, &SolveOptions::default());
            assert!(set.settled(), "{text}");
            assert_eq!(
                (set.counts.distinct, set.counts.real),
                (distinct, Some(distinct))
            );
            let digits = |solution: &Solution| solution.variables.0[0].digits.clone();
            let small = set.solutions.iter().filter_map(digits).next().expect(text);
            let exponent = small[0].rsplit_once('e').map(|(_, exponent)| exponent);
            assert!(
                matches!(exponent, Some("-350" | "-400")),
                "{text}: {small:?}"
            );
        }
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
        let set = solve("(x^2 - 2)*(x - 3)^2", &options);
        assert_eq!(
            (set.counts.certified, set.counts.certified_real),
            (Some(2), Some(2))
        );
        let digits: Vec<_> = set
            .solutions
            .iter()
            .map(|s| s.variables.0[0].digits.clone())
            .collect();
        let expected = [
            "-1.41421356237309504880168872421",
            "1.41421356237309504880168872421",
            "3.00000000000000000000000000000",
        ];
        assert_eq!(
            digits,
            expected.map(|re| Some([re.to_string(), "0".to_string()]))
        );
        let sharpened = set.counts.sharpened.expect("digits were asked for");
        assert_eq!((sharpened.solutions, sharpened.by_deflation), (3, 1));
    }

    #[test]
    fn rounded_coefficients_say_no_more_than_they_hold() {
        let mut options = SolveOptions::default();
        options.tracking.settings.data_accuracy = 1e-9;
        let set = solve("x^2 - 2.00000001*x + 1.00000001", &options);
        assert!(
            set.warnings.len() == 1 && set.warnings[0].contains("accuracy"),
            "{set:?}"
        );
        let set = solve("x^2 - 2.12345678*x - 1.00000001", &options);
        assert!(set.warnings.is_empty());
        // A root that is infinite within the accuracy, and equations that have a common root only nearly.
        for text in [
            "1.2345678e-60*x^2 + x - 1",
            "x - 1.2345678\n2*x - 2.4691356",
        ] {
            assert_ne!(planned(text, &options).start, StartKind::OneUnknown);
        }
    }

    #[test]
    fn what_is_asked_of_paths_is_left_to_paths() {
        let named = SolveOptions {
            method: SolveMethod::TotalDegree,
            ..SolveOptions::default()
        };
        assert_eq!(planned("x^2 - 2", &named).start, StartKind::TotalDegree);
        for text in ["x^2 - sqrt(2)", "x^2 - y\ny - 3", "x^2 - 2\nx^2 - 3"] {
            assert_ne!(
                planned(text, &SolveOptions::default()).start,
                StartKind::OneUnknown
            );
        }
        let long = format!("x - 1{}", "0".repeat(400));
        assert_ne!(
            planned(&long, &SolveOptions::default()).start,
            StartKind::OneUnknown
        );
    }
}
