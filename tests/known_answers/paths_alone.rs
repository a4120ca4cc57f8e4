//! Answers of the paths alone: without an exact count what they do not show is a doubt, and never a settled wrong answer.
//!
//! The systems were answered wrongly in silence where the count could not look: behind a factor pi, an irrational
//! number, homogeneous groups or a high degree.

use crate::check::solve;
use cognate_algorithms::plan::{ClosingOptions, SolveMethod, SolveOptions};
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution_set::SolutionSet;
use cognate_tests::systems::written;

fn options(no_exact_count: bool, seed: u64) -> SolveOptions {
    SolveOptions {
        seed,
        closings: ClosingOptions {
            no_exact_count,
            ..ClosingOptions::default()
        },
        ..SolveOptions::default()
    }
}

fn answer(text: &str, options: &SolveOptions) -> SolutionSet {
    let mut sets = solve(&written(text), options, &|_| None).1;
    let set = sets.remove(0);
    assert_eq!(set.paths.sum(), set.paths.total, "{text}");
    set
}

/// Distinct solutions, and with multiplicity; with the count and without, the answer is this one, or not settled.
fn never_silent(text: &str, expected: [u64; 2], seeds: u64) {
    for no_exact_count in [false, true] {
        for seed in 1..=seeds {
            let set = answer(text, &options(no_exact_count, seed));
            let counts = &set.counts;
            let right = [counts.distinct, counts.with_multiplicity] == expected
                && counts.positive_dimensional != Some(true);
            assert!(
                right || !set.settled(),
                "seed {seed}, count {}: {counts:?} {:?}",
                !no_exact_count,
                set.paths
            );
            let complete = counts.complete == Completeness::Yes;
            assert!(right || !complete, "seed {seed}: {counts:?}");
            assert_eq!(set.no_exact_count.is_none(), counts.exact_count.is_some());
        }
    }
}

/// Right and settled, with the count and without.
fn always_right(text: &str, expected: [u64; 2], seeds: u64) {
    for no_exact_count in [false, true] {
        for seed in 1..=seeds {
            let set = answer(text, &options(no_exact_count, seed));
            let counts = &set.counts;
            let actual_counts = [counts.distinct, counts.with_multiplicity];
            let count = !no_exact_count;
            assert_eq!(
                actual_counts, expected,
                "seed {seed}, count {count}: {text}"
            );
            assert!(
                set.settled(),
                "seed {seed}, count {count}: {:?}",
                set.warnings
            );
        }
    }
}

/// Two conics after y -> y - 2 x^6: four simple real points of norm at most 42, and 140 paths that meet at infinity
/// without closing.
#[test]
fn solutions_beside_a_cluster_at_infinity_are_not_lost_in_silence() {
    let conics = "variable_group x, y; function f, g; \
        f = Pi*(-20*x^12 + 12*x^7 + 20*x^6*y - 10*x^6 + 8*x^2 - 6*x*y - 5*y^2 + 5*x + 5*y - 1); \
        g = -4*x^12 - 10*x^7 + 4*x^6*y + 12*x^6 - 8*x^2 + 5*x*y - y^2 + 8*x - 6*y + 8;";
    never_silent(conics, [4, 4], 1);
}

/// github sympy/sympy#22839: y^159 = 70/67.
#[test]
fn two_terms_of_high_degree_are_solved_by_mixed_cells() {
    let powers = "variable_group x, y; function f, g; f = x*y^5 - 67; g = x*y^164 - 70;";
    always_right(powers, [159, 159], 2);
    let planted = "variable_group x, y; function f, g; \
        f = -71 + 61*x^3*y^17; g = 75 + 55*x^27*y^2 + 85*x^11*y^16;";
    always_right(planted, [453, 453], 1);
    let thin = "variable_group x, y; function f, g; f = 6*y^6 - 20; g = 92 - 33*x^48*y^112 - 63*x^59*y^133;";
    always_right(thin, [354, 354], 1);
}

/// The third solution has norm 1e18.
#[test]
fn what_is_far_is_not_infinite() {
    for first in ["x - y - sqrt(2)", "Pi*(x - y - 2)", "x - y - 2"] {
        for factor in ["1e-15", "1e-16", "1e-18"] {
            let far = format!(
                "variable_group x, y; function f, g; f = {first}; g = {factor}*y^3 - x^2 + 2;"
            );
            always_right(&far, [3, 3], 3);
        }
    }
}

/// x + 3 is 3e12 and 1e12/3: both ends are 1e-12 from infinity, and as far from each other.
#[test]
fn far_solutions_close_to_infinity_are_two() {
    let far = "variable_group x, y; function f, g; f = 1 - 10/3*(x + 3)*y^2 + (x + 3)^2*y^4; g = 1/1000000 + y;";
    always_right(far, [2, 2], 5);
}

/// Of a random combination of two of the three equations the point has multiplicity 4.
#[test]
fn a_multiple_point_has_the_multiplicity_of_all_equations() {
    let fat = "function f, g, h; f = x^2; g = x*y; h = y^2;";
    always_right(&format!("hom_variable_group x, y, w; {fat}"), [1, 3], 3);
    always_right(&format!("variable_group x, y; {fat}"), [1, 3], 3);
}

/// A circle, a tangent and y = 3.3e-8 twice have no point in common. Random combinations of two of these equations have two
/// regular points beside their common double point, 1e-8 from being solutions of all three.
#[test]
fn points_beside_a_double_point_of_combinations_are_no_solutions() {
    for c in ["1/30000000", "3333333333333/100000000000000000000"] {
        let equations = format!("function f, g, h; f = x^2 + y^2 - 1; g = x - 1; h = (y - {c})^2;");
        let system = format!("variable_group x, y; {equations}");
        for seed in 1..=5 {
            let mut options = options(true, seed);
            options.tracking.settings.exact_data = true;
            let set = answer(&system, &options);
            assert!(set.settled(), "seed {seed}: {:?}", set.warnings);
            assert_eq!((set.counts.distinct, set.paths.excess), (0, Some(2)));
        }
    }
}

/// Beyond the digits of the paths.
#[test]
fn points_nearer_than_all_digits_are_not_one_in_silence() {
    let pair =
        "variable_group x, y; function f, g; f = Pi*((x - 1)^2 - 1/10^60); g = y^2 - 3*x - 1;";
    never_silent(pair, [4, 4], 2);
    let luke = "variable_group x, y, z; function f, g, h; f = Pi*((1e100*y^2 + x^2 + z^2 - 1)*x); \
        g = (y^2 + x^2 + z^2 - 1)*y; h = x + 2*y - 3*z - 1;";
    never_silent(luke, [5, 9], 2);
}

/// Six points, each equation rounded to 16 digits: exactly taken they have no solution.
#[test]
fn rounded_equations_are_not_counted_where_they_are_more_than_the_unknowns() {
    let points = "variable_group x, y; function f1, f2, f3, f4; \
        f1 = 0.1969764537995005*x^3 - 0.1969764537995005*x^2*y + 0.1969764537995005*x*y^2 + 0.09458615768819123*y^3 \
        + 0.3939529075990011*x^2 + 1.265935307408729*x*y + 0.2758502794624807*y^2 - 1.166666666666667*x \
        - 0.9933107384944702*y - 2.333333333333333; \
        f2 = 0.3093137254901961*x^3 - 0.3093137254901961*x^2*y + 0.6186274509803922*x*y^2 + 0.07720588235294118*y^3 \
        + 0.3093137254901961*x^2 + 1.537867647058824*x*y + 0.1715686274509804*y^2 - 1.785294117647059*x \
        - 1.132352941176471*y - 2.333333333333333; \
        f3 = 0.2297648772367873*x^3 + 0.2297648772367873*x^2*y - 0.4595297544735747*x*y^2 + 0.1312682064086559*y^3 \
        + 0.4595297544735747*x^2 + 0.5315361007074491*x*y + 0.4959425717852684*y^2 - 1.166666666666667*x \
        - 0.6998543487307533*y - 2.333333333333333; \
        f4 = 0.2571087633516692*x^3 - 0.7713262900550074*x^2*y - 0.2571087633516692*x*y^2 + 0.005704473354870631*y^3 \
        + 2.333333333333333*x*y - 0.01589103291713961*y^2 - 1.22890654559213*x - 0.2550714514392153*y \
        - 0.4009429843709072;";
    let set = answer(points, &options(false, 1));
    assert_eq!((set.counts.distinct, set.counts.real), (6, Some(6)));
    assert!(set.settled(), "{:?}", set.warnings);
    let reason = set.no_exact_count.expect("no count of rounded numbers");
    assert!(
        reason.contains("not all numbers in them are exact"),
        "{reason}"
    );
}

/// Two parabolas of one axis touch at infinity.
#[test]
fn a_cluster_at_infinity_makes_completeness_unknown_where_no_count_is_made() {
    let parabolas = "variable_group x, y; function f, g; f = y - x^2; g = y + x^2 + x - 2;";
    for (no_exact_count, complete) in [(false, Completeness::Yes), (true, Completeness::NotKnown)] {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            ..options(no_exact_count, 1)
        };
        let set = answer(parabolas, &options);
        assert_eq!((set.paths.finite, set.paths.at_infinity), (2, 2));
        assert!(set.settled());
        assert_eq!(
            set.counts.complete, complete,
            "{:?}",
            set.counts.complete_reason
        );
    }
}

/// The point at infinity is double: beside it, at a homogenising coordinate of 1e-9, its equations are rounding and their
/// Jacobian has a condition number below the limit of regular ends. (planted, series 63, system 1440)
#[test]
fn a_point_beside_a_double_point_at_infinity_is_no_finite_solution() {
    let system = "variable_group x, y; function f, g; f = x^2 + 4; g = x*y - 5*x - 7;";
    let seeds = std::iter::once(1_831_350_843).chain(1..=100);
    for seed in seeds {
        let options = SolveOptions {
            method: SolveMethod::TotalDegree,
            ..options(true, seed)
        };
        let set = answer(system, &options);
        let right = set.counts.distinct == 2 && set.counts.real == Some(0);
        assert!(right, "seed {seed}: {:?}", set.counts);
    }
}
