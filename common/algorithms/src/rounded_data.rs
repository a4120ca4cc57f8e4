//! Rounded data: solutions whose number, or being real, depends on digits beyond the accuracy of the given decimals.

use cognate_numeric::counted::counted;
use cognate_solutions::completeness::Completeness;
use cognate_solutions::solution::Solution;
use cognate_solutions::solution_set::SolutionSet;
use cognate_systems::expression::differentiate::below;
use cognate_systems::expression::{Node, NodeId};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Two solutions are near where they are apart by at most this multiple of the error that each may have: condition numbers
/// are estimates.
const NEAR: f64 = 8.0;
/// Part of its size by which other digits move a solution that is warned of.
const MOVES: f64 = 0.1;

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
    // Where a coefficient may be 0 that is said: see `doubt_coefficient`.
    if data_accuracy == 0.0 || data_accuracy >= 1.0 {
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
        return;
    }
    let moves = |solution: &&Solution| {
        !solution.singular && 2.0 * solution.condition * data_accuracy > MOVES
    };
    let count = set.solutions.iter().filter(moves).count();
    if count > 0 {
        set.warnings.push(format!(
            "{} may move by a tenth of the largest coordinate and more with other digits beyond the accuracy of the given \
             decimals",
            counted(count as u64, "solution"),
        ));
    }
}

/// Doubts an answer to equations of which a coefficient may be 0, which says how many solutions there are.
///
/// `data_accuracy`: relative accuracy to which the equations' coefficients are known, 1 where one may be 0.
pub(crate) fn doubt_coefficient(set: &mut SolutionSet, data_accuracy: f64) {
    if data_accuracy < 1.0 {
        return;
    }
    let warning = "a coefficient is a difference of rounded decimals that is no larger than their error: with other \
                   digits it may be 0, and the number of solutions another one";
    set.counts.complete = Completeness::No;
    set.counts.complete_reason = Some(warning.to_owned());
    set.warnings.push(warning.to_owned());
}

/// Doubts an answer without solutions where some equations hold fewer unknowns than they are: rounded equations have a
/// common solution only nearly, and paths to it leave for infinity.
///
/// `data_accuracy`: relative accuracy to which the equations' coefficients are known, 0 where they are exact.
pub(crate) fn doubt_overdetermined_part(
    set: &mut SolutionSet,
    system: &System,
    data_accuracy: f64,
) {
    let counts = &mut set.counts;
    let is_empty = counts.distinct == 0 && counts.positive_dimensional != Some(true);
    if data_accuracy == 0.0 || !is_empty || system.groups.iter().any(|group| group.homogeneous) {
        return;
    }
    let Some(part) = OverdeterminedPart::of(system) else {
        return;
    };
    let warning = format!(
        "{} hold no unknowns but {}: with other digits beyond the accuracy of the given decimals they may have a common \
         solution",
        counted(part.equations as u64, "equation"),
        part.unknowns.join(", "),
    );
    counts.complete = match set.paths.at_infinity {
        0 => Completeness::No,
        _ => Completeness::NotKnown,
    };
    counts.complete_reason = Some(warning.clone());
    set.paths.within_data_accuracy += std::mem::take(&mut set.paths.at_infinity);
    set.paths.decided_by_exact_count = 0;
    set.warnings.push(warning);
}

/// Equations that hold fewer unknowns than they are.
struct OverdeterminedPart {
    equations: usize,
    unknowns: Vec<String>,
}

impl OverdeterminedPart {
    /// The first such part of a system: not each of its equations can have an unknown of its own (Hall 1935).
    fn of(system: &System) -> Option<Self> {
        let mut matching = Matching {
            unknowns: system
                .equations
                .iter()
                .map(|&root| unknowns_in(system, root))
                .collect(),
            equation_of: vec![None; system.variables.len()],
            is_seen: Vec::new(),
        };
        let is_unmatched = |&equation: &usize| {
            matching.is_seen = vec![false; system.variables.len()];
            !matching.takes(equation)
        };
        (0..system.equations.len()).find(is_unmatched)?;
        let names = system.variables.iter().zip(&matching.is_seen);
        let unknowns: Vec<String> = names
            .filter(|(_, is_seen)| **is_seen)
            .map(|(name, _)| name.clone())
            .collect();
        Some(Self {
            equations: unknowns.len() + 1,
            unknowns,
        })
    }
}

/// Indices of the unknowns in an equation.
fn unknowns_in(system: &System, root: NodeId) -> Vec<usize> {
    let nodes = below(&system.expressions, &[root]).into_iter();
    let unknown = |id| match system.expressions.node(id) {
        Node::Variable(variable) => Some(*variable as usize),
        _ => None,
    };
    nodes.filter_map(unknown).collect()
}

/// Equations and unknowns in pairs, by augmenting paths (Kuhn 1955).
struct Matching {
    /// The unknowns in each equation.
    unknowns: Vec<Vec<usize>>,
    /// The equation of each unknown, where it has one.
    equation_of: Vec<Option<usize>>,
    /// The unknowns that were tried for the last equation.
    is_seen: Vec<bool>,
}

impl Matching {
    /// Gives an equation an unknown, and other ones to equations that make way; false where there is none.
    fn takes(&mut self, equation: usize) -> bool {
        for place in 0..self.unknowns[equation].len() {
            let unknown = self.unknowns[equation][place];
            if std::mem::replace(&mut self.is_seen[unknown], true) {
                continue;
            }
            if self.equation_of[unknown].is_none_or(|other| self.takes(other)) {
                self.equation_of[unknown] = Some(equation);
                return true;
            }
        }
        false
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

/// Whether another of the points, which are sorted by [`first`], is near a point.
fn has_neighbour(points: &[Point], k: usize) -> bool {
    let point = &points[k];
    let radius = NEAR * point.error;
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
    use cognate_solutions::solution_set::SolutionSet;
    use cognate_systems::formats::plain::typed;
    use cognate_systems::formats::read;
    use cognate_systems::system::System;

    /// Options for equations whose decimals are known to this accuracy.
    fn rounded(data_accuracy: f64) -> SolveOptions {
        let mut options = SolveOptions::default();
        options.tracking.settings.data_accuracy = data_accuracy;
        options
    }

    /// Equations as they are typed.
    fn system(text: &str) -> System {
        typed("test", text).expect("equations").system
    }

    fn answer(system: &System, options: &SolveOptions) -> SolutionSet {
        let mut plan = plan(system, options).expect("a plan");
        let sets = run_locally(&plan.system, &mut plan.algorithm, &|_| None, 8);
        sets.expect("a set").remove(0)
    }

    /// Number of solutions and warnings of a text, whose decimals are known to this accuracy.
    fn solve(text: &str, data_accuracy: f64) -> (u64, Vec<String>) {
        let system = read("test", text.as_bytes()).expect("equations").system;
        let set = answer(&system, &rounded(data_accuracy));
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

    /// Two equations hold x alone, and sqrt(2) has more digits.
    #[test]
    fn an_overdetermined_part_without_a_solution_is_doubted() {
        let answer_to = |text: &str, data_accuracy: f64| {
            let system = read("test", text.as_bytes()).expect("equations").system;
            answer(&system, &rounded(data_accuracy))
        };
        for rest in ["y + z = 1", "y*z = 2\ny + z^2 + w = 1"] {
            let text = format!("x^2 = 2\nx = 1.4142135624\n{rest}");
            let set = answer_to(&text, 4e-11);
            assert!(!set.settled() && set.counts.distinct == 0, "{set:?}");
            let warning = set.warnings.last().expect("a warning");
            assert!(
                warning.starts_with("2 equations hold no unknowns but x:"),
                "{warning}"
            );
            assert_eq!(set.paths.sum(), set.paths.total);
            assert!(answer_to(&text, 0.0).settled());
        }
        let parallel = answer_to("x + y = 1.23456789\nx + y = 2.23456789", 4e-9);
        assert!(parallel.settled(), "{parallel:?}");
    }

    /// sqrt(3 x - 1) is 1e-8 i for the digits of 1/3, and sqrt(x) is -8e-9: another digit makes both 0 or more.
    #[test]
    fn a_false_branch_within_the_accuracy_of_the_data_is_doubted() {
        for (text, data_accuracy) in [
            ("sqrt(3*x - 1) + y = 1\nx = 0.3333333333333333", 1.5e-16),
            ("sqrt(x) + sqrt(x + 3) = 1.73205080", 2.9e-9),
        ] {
            let set = answer(&system(text), &rounded(data_accuracy));
            assert!(!set.settled(), "{text}: {set:?}");
            assert_eq!(set.counts.doubtful_denominators, 1, "{text}: {set:?}");
        }
    }

    /// The denominator is 0 for the number that was meant, sqrt(2).
    #[test]
    fn a_denominator_that_other_digits_make_zero_is_doubted() {
        let text = "(x^2 - 2.000000000)/(x - 1.4142135624) = 3";
        for (data_accuracy, doubts) in [(4e-11, 1), (0.0, 0)] {
            let set = answer(&system(text), &rounded(data_accuracy));
            assert_eq!(set.counts.doubtful_denominators, doubts, "{set:?}");
        }
    }

    /// Whole segments of solutions, one of whose ends in complex numbers is on a false branch.
    #[test]
    fn sets_on_branches_are_not_removed() {
        for text in [
            "abs(x) + abs(x - 1/3) = 1/3",
            "sqrt(x^2 - 2*x + 1) = x - 1",
            "abs(x) + abs(y) = 1\nx - y = 1",
        ] {
            for seed in 1..5 {
                let options = SolveOptions {
                    seed,
                    ..SolveOptions::default()
                };
                let set = answer(&system(text), &options);
                assert_eq!(
                    set.counts.positive_dimensional,
                    Some(true),
                    "{text}: {set:?}"
                );
            }
        }
    }

    /// The second line is 0.43682.. times the first but for the rounding of its digits.
    #[test]
    fn equations_that_depend_on_each_other_but_for_rounding_are_warned_of() {
        let lines = "5.4365637*x + 6.0544529*y = 11.491017\n2.3748894*x + 2.6448060*y = 5.0196954";
        let (distinct, warnings) = solve(lines, 2.5e-8);
        assert_eq!(distinct, 1);
        assert!(warnings[0].contains("may move by a tenth"), "{warnings:?}");
    }

    /// The coefficient is 0 for the number that was meant, and x is 7e15 for the digits of it.
    #[test]
    fn a_coefficient_within_the_error_of_its_decimals_is_doubted() {
        for text in [
            "(1.4142135623730950^2 - 2)*x^3 + x^2 = 4",
            "(0.1 + 0.2 - 0.30000000000000004)*x^2 + x = 1",
            "(0.1 + 0.2 - 0.30000000000000004)*x^2 + x = y\ny^2 = 3",
        ] {
            let problem = typed("test", text).expect(text);
            assert_eq!(problem.warnings.len(), 1, "{:?}", problem.warnings);
            for (data_accuracy, is_settled) in
                [(problem.settings.data_accuracy, false), (0.0, true)]
            {
                let set = answer(&problem.system, &rounded(data_accuracy));
                assert_eq!(set.settled(), is_settled, "{text}: {set:?}");
                assert!(set.counts.distinct >= 1, "{text}: {set:?}");
            }
        }
    }

    #[test]
    fn distant_solutions_of_rounded_data_are_not_warned_of() {
        let secant = "x^2 + y^2 = 1\ny = 1.23456789012345 - x";
        assert_eq!(solve(secant, 4e-15), (2, Vec::new()));
    }
}
