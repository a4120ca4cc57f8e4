//! Progress: how far a solve is, for people and for clients.

use cognate_continuation::work::{Stage, StageId, Work};
use cognate_solutions::classification::Verdict;
use serde::{Deserialize, Serialize};
use std::iter::Sum;

/// One stage of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StageProgress {
    /// Number of the stage within the job.
    pub id: StageId,
    /// Kind of work done with the items.
    pub work: Work,
    /// 0 for the first tracking, then 1, 2, ...
    pub attempt: u16,
    /// Number of items.
    pub items: u64,
    /// True when its results have been taken in.
    pub absorbed: bool,
}

impl StageProgress {
    /// Progress of a stage that is open.
    ///
    /// # Panics
    /// When the stage's items cannot be counted: a plan has only stages whose items can be counted.
    pub(crate) fn of(stage: &Stage) -> Self {
        Self {
            id: stage.id,
            work: stage.work,
            attempt: stage.attempt,
            items: stage
                .items()
                .expect("a plan has only stages whose items can be counted"),
            absorbed: false,
        }
    }
}

/// Paths by their verdicts so far. They may be tracked again and change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VerdictCounts {
    /// Nonsingular and finite.
    pub finite: u64,
    /// Singular, finite and isolated.
    pub singular: u64,
    /// Singular and finite; isolated or not is not known yet.
    pub undecided: u64,
    /// Paths of another class within the accuracy of the decimals that were given.
    pub within_data_accuracy: u64,
    /// Paths that ended on positive-dimensional solution sets.
    pub positive_dimensional: u64,
    /// Paths that ended at infinity.
    pub at_infinity: u64,
    /// Solutions only of the combinations of equations that are tracked.
    pub excess: u64,
    /// Failed.
    pub failed: u64,
}

impl VerdictCounts {
    /// One more path with this verdict.
    pub fn count(&mut self, verdict: Verdict) {
        *match verdict {
            Verdict::Finite => &mut self.finite,
            Verdict::Singular => &mut self.singular,
            Verdict::Undecided => &mut self.undecided,
            Verdict::WithinDataAccuracy => &mut self.within_data_accuracy,
            Verdict::AtInfinity => &mut self.at_infinity,
            Verdict::PositiveDimensional => &mut self.positive_dimensional,
            Verdict::ExcessSolution => &mut self.excess,
            // Decided when all paths have ended.
            Verdict::Removed => &mut self.finite,
            Verdict::Failed => &mut self.failed,
        } += 1;
    }
}

impl Sum for VerdictCounts {
    fn sum<I: Iterator<Item = Self>>(counts_of_targets: I) -> Self {
        counts_of_targets.fold(Self::default(), |sum, one| Self {
            finite: sum.finite + one.finite,
            singular: sum.singular + one.singular,
            undecided: sum.undecided + one.undecided,
            within_data_accuracy: sum.within_data_accuracy + one.within_data_accuracy,
            positive_dimensional: sum.positive_dimensional + one.positive_dimensional,
            at_infinity: sum.at_infinity + one.at_infinity,
            excess: sum.excess + one.excess,
            failed: sum.failed + one.failed,
        })
    }
}

/// Progress of a solve.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// Description of the present step, in a few words.
    pub description: String,
    /// All stages so far.
    pub stages: Vec<StageProgress>,
    /// Paths of absorbed stages by their verdicts.
    pub paths: VerdictCounts,
    /// True when all is known.
    pub done: bool,
}

/// Marks a stage as absorbed; what is known of it.
///
/// # Panics
/// When the stage is not open.
pub(crate) fn absorb(stages: &mut [StageProgress], id: StageId) -> StageProgress {
    let open = stages
        .iter_mut()
        .find(|progress| progress.id == id && !progress.absorbed);
    let stage = open.expect("only an open stage is absorbed");
    stage.absorbed = true;
    *stage
}

/// The number of the first of these stages; 0 before it is open.
pub(crate) fn first_id(stages: &[StageProgress]) -> StageId {
    stages.first().map_or(StageId(0), |stage| stage.id)
}
