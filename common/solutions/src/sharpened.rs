//! Solutions with the digits that a stage of sharpening found for them.

use crate::solution_set::SolutionSet;
use crate::summary::SharpenedCounts;
use cognate_continuation::sharpening::{Sharpened, Sharpening, Unsharpened};
use cognate_numeric::decimal_text::complex_text;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Decimal digits that a double holds; it does not hold all numbers with one digit more.
pub const DIGITS_OF_DOUBLES: u32 = 16;

/// Bound for half a unit of the last of `digits` decimal digits, relative to the number.
pub fn last_digit(digits: u32) -> f64 {
    let text = format!("5e-{digits}");
    text.parse().expect("a decimal number")
}

/// Result of the attempt to sharpen one point; `None` where the attempt itself was lost with its worker.
pub type Attempt = Option<Sharpening>;

/// Replaces the values of the solutions by sharper ones.
///
/// `attempt` gives the result at the endpoint of a path; outer `None` where no attempt was asked for. `digits` are
/// those that were asked for.
pub fn sharpen(set: &mut SolutionSet, digits: u32, attempt: &dyn Fn(u64) -> Option<Attempt>) {
    let mut counts = SharpenedCounts {
        digits,
        ..SharpenedCounts::default()
    };
    let mut left: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    let mut not_multiple = Vec::new();
    for solution in &mut set.solutions {
        let mut of_paths = solution.paths.iter().map(|&path| attempt(path));
        let reason = match of_paths.find_map(|outcome| outcome) {
            None => continue,
            Some(None) => "the attempt was given up: workers died of it",
            Some(Some(Sharpening::Unsharpened(reason))) => reason.describe(),
            Some(Some(Sharpening::Sharpened(sharpened))) => {
                if sharpened.values.len() == solution.variables.0.len() {
                    if solution.multiplicity > 1 && sharpened.deflations == 0 {
                        not_multiple.push(solution.paths[0]);
                    }
                    counts.solutions += 1;
                    counts.by_deflation += u64::from(sharpened.deflations > 0);
                    let Sharpened {
                        values,
                        accuracy,
                        deflations,
                        precision_bits,
                    } = *sharpened;
                    for (variable, exact) in solution.variables.0.iter_mut().zip(&values) {
                        variable.value = Complex64::new(exact.re.to_f64(), exact.im.to_f64());
                        let more = digits > DIGITS_OF_DOUBLES;
                        variable.digits = more.then(|| complex_text(exact, digits));
                    }
                    solution.accuracy = accuracy.max(match digits > DIGITS_OF_DOUBLES {
                        true => 0.0,
                        false => f64::EPSILON,
                    });
                    // The equations at the sharper point are less than what the last step has removed.
                    solution.residual = solution.residual.min(solution.accuracy);
                    solution.precision_bits = solution.precision_bits.max(precision_bits);
                    solution.deflations = Some(deflations);
                    continue;
                }
                Unsharpened::DamagedPoint.describe()
            }
        };
        left.entry(reason).or_default().push(solution.paths[0]);
    }
    for (reason, paths) in left {
        set.warnings.push(format!(
            "{} solution{} not brought to {digits} digits, because {reason}; the first is that of \
             path {}",
            paths.len(),
            if paths.len() == 1 { " was" } else { "s were" },
            paths[0],
        ));
    }
    if let Some(first) = not_multiple.first() {
        set.warnings.push(format!(
            "where {} solution{} said to be multiple, there is a simple one with {digits} digits: \
             several may lie there, close together; the first is that of path {first}",
            not_multiple.len(),
            if not_multiple.len() == 1 {
                " is"
            } else {
                "s are"
            },
        ));
    }
    set.counts.sharpened = Some(counts);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::classification::Tolerances;
    use crate::solution_set::History;
    use crate::test_results::{isolated, regular};
    use cognate_numeric::rational::{ComplexRational, Rational};
    use cognate_systems::formats::read;

    #[test]
    fn digits_replace_doubles_and_what_has_none_is_named() {
        let text = "CONFIG\nEND;\nINPUT\nvariable_group x; function f; \
                    f = (x^2 - 1/9)*(x - 3)^2*(x - 4);\nEND;\n";
        let system = read("test", text.as_bytes()).unwrap().system;
        let results = [
            regular(0, &[(1.0, 0.0), (0.25, 0.0)]),
            isolated(1, &[(0.25, 0.0), (0.75, 0.0)], 2, &[0], 2),
            isolated(2, &[(0.25, 0.0), (0.75, 0.0)], 2, &[0], 2),
            regular(3, &[(1.0, 0.0), (-0.25, 0.0)]),
            regular(4, &[(0.25, 0.0), (1.0, 0.0)]),
        ];
        let (history, tolerances) = (History::default(), Tolerances::default());
        let mut set = SolutionSet::new(&system, &[], &results, &history, &tolerances, 1);
        let third = ComplexRational::real((Rational::from(1) << 100) / 3);
        let third = ComplexRational::real(third.re.floor() >> 100);
        let sharpened = |values: Vec<ComplexRational>, deflations| {
            Sharpening::Sharpened(Box::new(Sharpened {
                values,
                accuracy: 1e-25,
                deflations,
                precision_bits: 300,
            }))
        };
        sharpen(&mut set, 20, &|path| match path {
            0 => Some(Some(sharpened(vec![third.clone()], 0))),
            1 => Some(Some(sharpened(vec![ComplexRational::real(3)], 1))),
            3 => Some(Some(Sharpening::Unsharpened(Unsharpened::NewtonLeaves))),
            4 => Some(None),
            _ => None,
        });
        let digits = |k: usize| set.solutions[k].variables.0[0].digits.clone();
        assert_eq!(digits(0).unwrap(), ["0.33333333333333333333", "0"]);
        assert_eq!(digits(1).unwrap(), ["3.0000000000000000000", "0"]);
        assert_eq!((digits(2), digits(3)), (None, None));
        assert_eq!(set.solutions[0].variables.0[0].value.re, 1.0 / 3.0);
        let residuals = [0, 2].map(|k| set.solutions[k].residual);
        assert!(
            residuals[0] <= 1e-25 && residuals[1] > 1e-25,
            "{residuals:?}"
        );
        let deflations: Vec<_> = set.solutions.iter().map(|s| s.deflations).collect();
        assert_eq!(deflations, [Some(0), Some(1), None, None]);
        assert_eq!(set.solutions[1].precision_bits, 300);
        let counts = set.counts.sharpened.as_ref().unwrap();
        assert_eq!(
            (counts.digits, counts.solutions, counts.by_deflation),
            (20, 2, 1)
        );
        let named = |what: &str| set.warnings.iter().any(|w| w.contains(what));
        assert!(named(
            "Newton's method leaves it; the first is that of path 3"
        ));
        assert!(named("workers died of it"));
    }
}
