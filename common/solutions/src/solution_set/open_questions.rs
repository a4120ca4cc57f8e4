//! OpenQuestions: the points and paths of a solution set about which the digits do not decide.
//!
//! In: the counts of the set and the points in doubt. Out: the warnings that a reader of the set gets, and the
//! reasons why it is not known to be complete.

use crate::failed_path::FailedPath;
use crate::summary::{PathCounts, SolutionCounts};
use crate::weak_evidence::WeakEvidence;
use std::collections::BTreeMap;

/// Reasons for paths whose verdicts rest on weak evidence.
const AT_INFINITY: &str =
    "at infinity as far as several sheets together show: solutions may be among their ends";
const ON_SETS: &str = "on a positive-dimensional set, which is seen with too few paths or digits";
const MULTIPLE: &str =
    "at multiple points, which may be several points beyond the digits of the paths";

/// The facts about a solution set that leave a question open.
pub(super) struct OpenQuestions<'a> {
    pub(super) paths: &'a PathCounts,
    pub(super) counts: &'a SolutionCounts,
    pub(super) weak_evidence: &'a WeakEvidence,
    /// The paths that failed, ascending.
    pub(super) failed: &'a [FailedPath],
    /// First paths of the points of which it is not known whether a denominator is 0 there.
    pub(super) doubtful_denominators: &'a [u64],
    /// First paths of the points of which it is not known whether a root is on a false branch.
    pub(super) doubtful_branches: &'a [u64],
}

impl OpenQuestions<'_> {
    /// Reasons why solutions may be missing, each with its number of paths or points.
    pub(super) fn reasons(&self) -> Vec<String> {
        let mut reasons = self.reasons_of_paths();
        reasons.extend(self.reasons_of_points());
        reasons
    }

    fn reasons_of_paths(&self) -> Vec<String> {
        let paths = self.paths;
        let &WeakEvidence {
            at_infinity,
            on_sets,
            multiple,
        } = self.weak_evidence;
        [
            reason(paths.failed, "path", "failed"),
            reason(
                paths.crossings_found - paths.crossings_resolved,
                "path crossing",
                "not resolved",
            ),
            reason(at_infinity, "path", AT_INFINITY),
            reason(on_sets, "path", ON_SETS),
            reason(multiple, "path", MULTIPLE),
            reason(
                self.decided_by_precision_limit(),
                "path",
                "finite or at infinity only by the limit of the precision",
            ),
            reason(
                paths.within_data_accuracy,
                "path",
                "to infinity as far as the accuracy of the data tells",
            ),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    fn reasons_of_points(&self) -> Vec<String> {
        [
            reason(
                self.counts.undecided,
                "singular point",
                "of which it is not known whether isolated",
            ),
            reason(
                self.counts.doubtful_multiplicity,
                "singular point",
                "of doubtful multiplicity",
            ),
            reason(
                self.counts.without_conjugate,
                "solution",
                "without a conjugate, which is one, too",
            ),
            reason(
                self.doubtful_denominators.len() as u64,
                "point",
                "of which it is not known whether a denominator is 0",
            ),
            reason(
                self.doubtful_branches.len() as u64,
                "point",
                "of which it is not known whether a root is on a false branch",
            ),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Warnings for the reader of the set, in the order of its points, crossings and paths.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut warnings = self.warnings_of_points();
        warnings.extend(self.warnings_of_paths());
        warnings
    }

    fn warnings_of_points(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let undecided = self.counts.undecided;
        if undecided > 0 {
            warnings.push(format!(
                "whether {} singular point{}, at which {} path{} end{}, {} isolated is not decided: \
                 if not, no solution but a positive-dimensional set is there",
                undecided,
                plural(undecided as usize),
                self.paths.undecided,
                plural(self.paths.undecided as usize),
                if self.paths.undecided == 1 { "s" } else { "" },
                if undecided == 1 { "is" } else { "are" },
            ));
        }
        if self.counts.without_conjugate > 0 {
            warnings.push(format!(
                "the conjugates of {} solution{} are not among the solutions: these are wrong, or those are missing",
                self.counts.without_conjugate,
                plural(self.counts.without_conjugate as usize),
            ));
        }
        if !self.doubtful_denominators.is_empty() {
            warnings.push(format!(
                "at {} point{} (first paths: {}) a denominator is so near to 0 that digits do not tell whether it is: \
                 if so, no solution is there",
                self.doubtful_denominators.len(),
                plural(self.doubtful_denominators.len()),
                first_paths(self.doubtful_denominators),
            ));
        }
        if !self.doubtful_branches.is_empty() {
            warnings.push(format!(
                "at {} point{} (first paths: {}) digits do not tell which root of a radicand is there: if another than the \
                 one that is meant, no solution is there",
                self.doubtful_branches.len(),
                plural(self.doubtful_branches.len()),
                first_paths(self.doubtful_branches),
            ));
        }
        warnings
    }

    fn warnings_of_paths(&self) -> Vec<String> {
        let paths = self.paths;
        let mut warnings = Vec::new();
        if paths.crossings_found > paths.crossings_resolved {
            warnings.push(format!(
                "{} crossing{} of paths could not be resolved: solutions may be missing",
                paths.crossings_found - paths.crossings_resolved,
                plural((paths.crossings_found - paths.crossings_resolved) as usize),
            ));
        }
        if paths.failed > 0 {
            let mut reasons = BTreeMap::<_, Vec<u64>>::new();
            for failed in self.failed {
                reasons.entry(failed.reason).or_default().push(failed.path);
            }
            for (reason, failed) in reasons {
                warnings.push(format!(
                    "{} path{} failed ({}): {}",
                    failed.len(),
                    plural(failed.len()),
                    reason.describe(),
                    first_paths(&failed),
                ));
            }
        }
        let by_limit = self.decided_by_precision_limit();
        if by_limit > 0 {
            warnings.push(format!(
                "{} path{} finite or at infinity only by the limit of the precision",
                by_limit,
                if by_limit == 1 { " is" } else { "s are" },
            ));
        }
        warnings
    }

    /// Paths decided by the limit of the precision alone: those of weak evidence have reasons of their own.
    fn decided_by_precision_limit(&self) -> u64 {
        self.paths.decided_by_precision_limit - self.weak_evidence.paths()
    }
}

/// The warning about singular endpoints whose winding numbers contradict the number of paths there.
pub(super) fn winding_numbers_do_not_fit(endpoints: usize, first_path: u64) -> String {
    format!(
        "at {} singular endpoint{} (first of path {}) the winding numbers do not fit the \
         number of paths that end there; multiplicities are numbers of paths",
        endpoints,
        plural(endpoints),
        first_path,
    )
}

/// The warning about isolated singular points, by their first paths, whose dual spaces have another multiplicity.
pub(super) fn multiplicities_are_not_confirmed(points: &[u64]) -> String {
    format!(
        "at {} isolated singular point{} the number of paths is not confirmed by the \
         multiplicity of the dual space (first paths: {}): solutions may have been taken for one",
        points.len(),
        plural(points.len()),
        first_paths(points),
    )
}

/// A count with its noun; `None` for 0.
fn reason(count: u64, noun: &str, predicate: &str) -> Option<String> {
    (count > 0).then(|| format!("{count} {noun}{} {predicate}", plural(count as usize)))
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// The first ten paths of a list, with an ellipsis for the others.
fn first_paths(paths: &[u64]) -> String {
    const SHOWN: usize = 10;
    let mut list: Vec<String> = paths.iter().take(SHOWN).map(u64::to_string).collect();
    if paths.len() > SHOWN {
        list.push("...".into());
    }
    list.join(", ")
}
