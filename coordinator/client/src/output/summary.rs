//! Meaning of a summary for the user: the open questions, and the exit code.

use super::text::counted;
use crate::error::{ClientError, Exit};
use cognate_solutions::completeness::Completeness;
use cognate_summary::AnySummary;
use cognate_summary::solve::Summary;

/// The JSON object that the service gives, typed.
pub fn read(json: &str) -> Result<Summary, ClientError> {
    serde_json::from_str(json)
        .map_err(|e| ClientError::GaveUp(format!("its summary is not what was agreed: {e}")))
}

/// The JSON object of a job of either kind, typed.
pub fn read_any(json: &str) -> Result<AnySummary, ClientError> {
    AnySummary::read(json)
        .map_err(|e| ClientError::GaveUp(format!("its summary is not what was agreed: {e}")))
}

/// Doubts that keep the answer from being settled, in words; empty if all is settled.
pub fn open_questions(summary: &Summary) -> Vec<String> {
    let paths = &summary.paths;
    let mut open = vec![];
    if paths.failed > 0 {
        open.push(format!("{} failed", counted(paths.failed, "path")));
    }
    let unresolved = paths
        .crossings_found
        .saturating_sub(paths.crossings_resolved);
    if unresolved > 0 {
        let crossings = counted(unresolved, "path crossing");
        open.push(format!("{crossings} not resolved"));
    }
    if paths.decided_by_precision_limit > 0 {
        let by_limit = counted(paths.decided_by_precision_limit, "path");
        open.push(format!(
            "{by_limit} finite or at infinity only by the limit of the precision"
        ));
    }
    if summary.solutions.undecided > 0 {
        open.push(format!(
            "{} to a singular point of which it is not known whether it is isolated",
            counted(paths.undecided, "path")
        ));
    }
    if paths.within_data_accuracy > 0 {
        let within = counted(paths.within_data_accuracy, "path");
        open.push(format!(
            "{within} to infinity as far as the accuracy of the decimals tells (--exact follows them)"
        ));
    }
    let doubtful = summary.solutions.doubtful_multiplicity;
    if doubtful > 0 {
        let points = counted(doubtful, "singular point");
        open.push(format!(
            "{points} at which another number of paths ends than its multiplicity"
        ));
    }
    let alone = summary.solutions.without_conjugate;
    if alone > 0 {
        let solutions = counted(alone, "solution");
        open.push(format!(
            "{solutions} without a conjugate, which is one, too"
        ));
    }
    let denominators = summary.solutions.doubtful_denominators;
    if denominators > 0 {
        let points = counted(denominators, "point");
        open.push(format!(
            "{points} at which a denominator may be 0, or a root on a false branch: digits do not tell"
        ));
    }
    open.extend(summary.classes.doubt.clone());
    let exact = &summary.solutions.exact_count;
    if exact.as_ref().is_some_and(|count| !count.agrees) {
        open.push("another number of solutions by an exact count".into());
    }
    if summary.solutions.complete == Completeness::No {
        let reason = summary.solutions.complete_reason.as_deref();
        let reason = reason.map_or(String::new(), |reason| format!(": {reason}"));
        open.push(format!("solutions are missing{reason}"));
    }
    if open.is_empty() && !summary.settled {
        open.push("a count of one of the targets".into());
    }
    open
}

/// The exit code that this answer has.
pub fn exit(summary: &Summary) -> Exit {
    if summary.settled {
        Exit::Solved
    } else {
        Exit::Unsettled
    }
}
