//! TargetRecord: what is known of one target's paths besides their results.

use super::criteria::Criteria;
use crate::progress::VerdictCounts;
use cognate_continuation::path_result::PathResult;
use cognate_continuation::tracker::outcome::{Failure, PathOutcome};
use cognate_solutions::classification::{Decision, Verdict};
use cognate_solutions::path_crossing::{CrossingRecord, broken_cycles, coincidences, crossings};
use cognate_solutions::streamed::StreamedCounts;
use serde::{Deserialize, Serialize};

/// Meetings of paths, repetitions and verdicts of one target.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct TargetRecord {
    pub crossings: CrossingRecord,
    /// Results that came in the place of earlier ones.
    pub retracked: u64,
    pub verdicts: VerdictCounts,
}

impl TargetRecord {
    /// Brings all verdicts up to date; returns the paths to track again, in no order, some of them twice.
    ///
    /// `tracked`: the target's results that are held; `streamed`: its paths that are not.
    pub fn judge(
        &mut self,
        tracked: &[PathResult],
        streamed: Option<&StreamedCounts>,
        criteria: &Criteria,
    ) -> Vec<u64> {
        let results = &*criteria.with_images(tracked);
        let decisions: Vec<Decision> = results.iter().map(|r| criteria.decide(r)).collect();
        self.meet(results, &decisions, criteria);
        self.verdicts = VerdictCounts::default();
        if let Some(streamed) = streamed {
            self.verdicts.finite = streamed.finite;
            self.verdicts.at_infinity = streamed.at_infinity;
        }
        let mut suspects = Vec::new();
        for (result, decision) in tracked.iter().zip(&decisions) {
            self.verdicts.count(decision.verdict);
            if decision.verdict == Verdict::Failed && can_be_helped(result.outcome) {
                suspects.push(result.origin.0);
            }
        }
        suspects.extend(self.crossings.paths().map(|path| criteria.tracked(path)));
        // Where a path failed it may be what a cycle lacks, and where paths are left out too.
        if self.verdicts.failed == 0 && criteria.first.homotopy.takes_all_paths() {
            let singular = |place: usize| decisions[place].verdict.may_be_multiple();
            let (shape, tolerances) = (&criteria.shape, &criteria.tolerances);
            let points = coincidences(results, shape, tolerances, criteria.first.seed, singular);
            for members in points {
                let broken = broken_cycles(results, &members).into_iter();
                let paths = broken.map(|place| criteria.tracked(results[place].origin.0));
                suspects.extend(paths);
            }
        }
        suspects
    }

    /// Brings the record of meetings up to date.
    fn meet(&mut self, results: &[PathResult], decisions: &[Decision], criteria: &Criteria) {
        let (shape, tolerances) = (&criteria.shape, &criteria.tolerances);
        let meetings = crossings(results, decisions, shape, tolerances, criteria.first.seed);
        let paths = |members: &Vec<usize>| members.iter().map(|&m| results[m].origin.0).collect();
        self.crossings.update(meetings.iter().map(paths).collect());
    }
}

/// Whether tracking a failed path more carefully can make it succeed.
pub(crate) fn can_be_helped(outcome: PathOutcome) -> bool {
    match outcome {
        PathOutcome::Failed(failure) => match failure {
            Failure::StepTooSmall | Failure::TooManySteps | Failure::EndgameUnsettled => true,
            Failure::InvalidStartPoint | Failure::KilledItsWorker => false,
        },
        // It failed by its result: damaged, or a crossing.
        PathOutcome::Regular
        | PathOutcome::Singular
        | PathOutcome::Diverging
        | PathOutcome::PutAside => true,
    }
}
