//! Solution, verdict and counts to their messages.

use crate::v1;
use cognate_solutions::classification::Verdict;
use cognate_solutions::solution::Solution;
use cognate_solutions::summary::{PathCounts, SolutionCounts};

/// One solution, at this target.
pub fn solution(s: &Solution, target: u32) -> v1::Solution {
    v1::Solution {
        variables: s
            .variables
            .0
            .iter()
            .map(|v| v1::VariableValue {
                name: v.name.clone(),
                re: v.value.re,
                im: v.value.im,
                re_digits: v.digits.as_ref().map(|[re, _]| re.clone()),
                im_digits: v.digits.as_ref().map(|[_, im]| im.clone()),
            })
            .collect(),
        multiplicity: s.multiplicity,
        cycles: s.cycles.clone(),
        real: s.real,
        singular: s.singular,
        residual: s.residual,
        condition: s.condition,
        accuracy: s.accuracy,
        precision_bits: s.precision_bits,
        class: s.class,
        paths: s.paths.clone(),
        degenerate: Vec::new(),
        certificate: s.certificate.as_ref().map(|certificate| {
            serde_json::to_string(certificate).expect("a certificate has only names and numbers")
        }),
        target,
        deflations: s.deflations,
        undecided: s.undecided,
    }
}

/// The class of a path.
pub fn class(verdict: Verdict) -> v1::PathClass {
    match verdict {
        Verdict::Failed => v1::PathClass::Failed,
        Verdict::AtInfinity => v1::PathClass::AtInfinity,
        Verdict::ExcessSolution => v1::PathClass::Excess,
        Verdict::PositiveDimensional => v1::PathClass::PositiveDimensional,
        Verdict::Singular => v1::PathClass::Singular,
        Verdict::Finite => v1::PathClass::Finite,
        Verdict::Undecided => v1::PathClass::Undecided,
        Verdict::WithinDataAccuracy => v1::PathClass::WithinDataAccuracy,
        Verdict::Removed => v1::PathClass::Removed,
    }
}

/// The counts that every client wants.
pub fn counts(paths: &PathCounts, solutions: &SolutionCounts) -> v1::SummaryCounts {
    v1::SummaryCounts {
        paths_total: paths.total,
        paths_finite: paths.finite,
        paths_singular: paths.singular,
        paths_positive_dimensional: paths.positive_dimensional,
        paths_excess: paths.excess,
        paths_at_infinity: paths.at_infinity,
        paths_failed: paths.failed,
        paths_retracked: paths.retracked,
        solutions_distinct: solutions.distinct,
        solutions_nonsingular: solutions.nonsingular,
        solutions_singular: solutions.singular,
        solutions_real: solutions.real,
        solutions_with_multiplicity: solutions.with_multiplicity,
        paths_undecided: paths.undecided,
        paths_within_data_accuracy: paths.within_data_accuracy,
        solutions_undecided: solutions.undecided,
        paths_removed: paths.removed,
    }
}
