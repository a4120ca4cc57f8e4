//! Lines that `explain` prints about an answer; each kind of answer has its own.

use super::AnySummary;
use super::solve::{MonodromyBlock, Summary};
use cognate_algorithms::monodromy::estimate::percent;
use cognate_numeric::counted::counted;

impl AnySummary {
    /// Facts about the answer as lines for the user.
    pub fn lines(&self) -> Vec<String> {
        match self {
            Self::Solve(summary) => summary.lines(),
            Self::Decomposition(summary) => summary.lines(),
            Self::Question(summary) => summary.lines(),
        }
    }
}

impl Summary {
    /// Paths, how solutions were found, what was done with them afterwards, failures and warnings.
    fn lines(&self) -> Vec<String> {
        let paths = &self.paths;
        let mut lines = vec![format!(
            "paths: {} finite, {} singular, {} on positive-dimensional sets, {} undecided (isolated or not), {} within the \
             accuracy of the data, {} excess (no solutions before randomisation), {} removed (where a denominator is 0, or on a false branch), \
             {} at infinity, {} failed; {} tracked again; {} crossings seen, {} came apart",
            paths.finite,
            paths.singular,
            paths
                .positive_dimensional
                .map_or("an unknown number".to_owned(), |n| n.to_string()),
            paths.undecided,
            paths.within_data_accuracy,
            paths.excess.unwrap_or(0),
            paths.removed,
            paths.at_infinity,
            paths.failed,
            paths.retracked,
            paths.crossings_found,
            paths.crossings_resolved
        )];
        lines.extend(self.monodromy.iter().flat_map(MonodromyBlock::lines));
        if let Some(certified) = self.solutions.certified {
            lines.push(format!(
                "certified: {certified} of {}, {} of them proved real",
                counted(self.solutions.nonsingular, "nonsingular solution"),
                self.solutions
                    .certified_real
                    .map_or("none".to_owned(), |n| n.to_string()),
            ));
        }
        if let Some(sharpened) = &self.solutions.sharpened {
            lines.push(format!(
                "sharpened: {} of {} to {} digits, {} of them by deflation",
                sharpened.solutions,
                counted(self.solutions.distinct, "solution"),
                sharpened.digits,
                sharpened.by_deflation
            ));
        }
        for (reason, count) in &self.failures {
            lines.push(format!("failed: {count} because {reason}"));
        }
        lines.extend(self.warnings.iter().map(|w| format!("warning: {w}")));
        lines
    }
}

impl MonodromyBlock {
    /// Lines about the solutions that loops found, and the estimate of the missing ones.
    fn lines(&self) -> Vec<String> {
        let loops = &self.loops;
        let mut lines = vec![format!(
            "monodromy: {} in {} by {}, the last {} without anything new; {} tracked for \
             them, {} lost; {} seen, {} came apart",
            counted(loops.solutions, "solution"),
            counted(loops.classes, "class"),
            counted(loops.loops, "loop"),
            loops.idle_loops,
            counted(loops.tracked, "path"),
            loops.lost,
            counted(loops.crossings_found, "crossing"),
            loops.crossings_resolved
        )];
        let shown = loops.mixing.is_shown(loops.classes);
        if let Some(estimate) = loops.estimate.as_ref().filter(|_| !shown) {
            lines.push(format!(
                "estimate: {} classes by capture and recapture; no probability is claimed, \
                 since loops are not seen to permute the known classes at random ({} of {} \
                 move some; {:.1} stay on average)",
                estimate
                    .likeliest
                    .map_or("an unknown number of".to_owned(), |n| n.to_string()),
                loops.mixing.moving,
                loops.mixing.loops,
                loops.mixing.fixed.unwrap_or(0.0)
            ));
        }
        if let Some(estimate) = loops.estimate.as_ref().filter(|_| shown) {
            lines.push(format!(
                "estimate: {} classes, all known with probability {}, by capture and \
                 recapture: N of them are likely as the product of (N)_r over places with r \
                 known, divided by that of (N)_c over edges with c pairs and by (N)_s with s \
                 at the start, (N)_k = N (N-1) ... (N-k+1) (after Hauenstein and Sherman \
                 2020); it takes for granted that {}",
                estimate
                    .likeliest
                    .map_or("an unknown number of".to_owned(), |n| n.to_string()),
                percent(estimate.confidence),
                estimate.assumption
            ));
        }
        lines
    }
}
