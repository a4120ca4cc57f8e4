//! Stage and Work: what is asked of workers. A chunk is a range of a stage's items.
//!
//! Pure data: it travels to workers, who build everything else from it and the system.

use crate::homotopies::HomotopyKind;
use crate::start_points::{Digest, StartPoints};
use crate::start_systems::polyhedral::branches::BRANCHES;
use crate::tracker::settings::Settings;
use serde::{Deserialize, Serialize};

/// A stage's number within its job, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct StageId(pub u32);

/// The kind of work that a worker does with each item of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Work {
    /// Track the path of each start point to its end.
    Track,
    /// Prove that there is exactly one solution near each point.
    Certify,
    /// Find out whether the endpoints that are the start points are isolated (see
    /// `local_dimension`); they lie at the end of the homotopy.
    LocalDimension,
    /// Bring each point to this many decimal digits as a solution, by deflation where it is multiple.
    Sharpen {
        /// Number of decimal digits, from 1 to [`crate::sharpening::MOST_DIGITS`].
        digits: u32,
    },
    /// Count the mixed cells of each branch (see `start_systems::polyhedral::branches`); the items
    /// are the branches of the start points.
    CountMixedCells,
    /// Find out how each witness point moves, to the second order, when the parameters leave the start for the
    /// target (see `bend`).
    Bend,
}

impl Work {
    /// True where each item is a path that is tracked, so that the `outcome` of its result says how the path ended. The
    /// items of all other kinds are points or branches; in their results `outcome` is unused.
    pub fn tracks_paths(self) -> bool {
        match self {
            Self::Track => true,
            Self::Certify
            | Self::LocalDimension
            | Self::Sharpen { .. }
            | Self::CountMixedCells
            | Self::Bend => false,
        }
    }

    /// True where `PreparedCheck::doubtful` tells right results from wrong ones, at least regular ends among ends.
    pub fn has_checkable_results(self) -> bool {
        match self {
            Self::Track | Self::Certify | Self::Sharpen { .. } => true,
            Self::LocalDimension | Self::CountMixedCells | Self::Bend => false,
        }
    }
}

/// One kind of work over the start points of one homotopy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Number of the stage within its job.
    pub id: StageId,
    /// Digest under which the system of the stage is stored; `None` where it is the system of the job.
    pub system: Option<Digest>,
    /// Kind of work that is done with each item.
    pub work: Work,
    /// The homotopy: its start, its targets and the way between them.
    pub homotopy: HomotopyKind,
    /// Start points of the paths.
    pub start_points: StartPoints,
    /// Settings of the tracker.
    pub settings: Settings,
    /// Seed of everything random in the homotopy. Tracking a path again keeps it.
    pub seed: u64,
    /// 0 for the first time that the paths are tracked, then 1, 2, ...
    pub attempt: u16,
}

impl Stage {
    /// A stage of the system of the job that has no number yet: a job numbers its stages when it opens them.
    pub fn new(
        work: Work,
        homotopy: HomotopyKind,
        start_points: StartPoints,
        settings: Settings,
        seed: u64,
    ) -> Self {
        Self {
            id: StageId(0),
            system: None,
            work,
            homotopy,
            start_points,
            settings,
            seed,
            attempt: 0,
        }
    }

    /// Describes the purpose of the stage to the user.
    pub fn purpose(&self) -> String {
        match (self.work, self.attempt) {
            (Work::Track, 0) if self.homotopy == HomotopyKind::Toric => {
                "tracking to a generic system".to_owned()
            }
            (Work::Track, 0) => "tracking".to_owned(),
            (Work::Track, attempt) => format!("tracking again, more carefully ({attempt})"),
            (Work::Certify, _) => "certifying".to_owned(),
            (Work::LocalDimension, _) => "whether singular endpoints are isolated".to_owned(),
            (Work::Sharpen { digits }, _) => format!("bringing solutions to {digits} digits"),
            (Work::CountMixedCells, _) => "counting mixed cells".to_owned(),
            (Work::Bend, _) => "derivatives of witness points".to_owned(),
        }
    }

    /// Number of items of the stage; `None` when they are more than fit in 64 bits.
    pub fn items(&self) -> Option<u64> {
        match self.work {
            Work::LocalDimension => return self.start_points.count(),
            Work::CountMixedCells => return Some(BRANCHES),
            Work::Track | Work::Certify | Work::Sharpen { .. } | Work::Bend => {}
        }
        match (&self.homotopy, &self.start_points) {
            // An item of a repetition is named by its index among all targets and starts.
            (_, StartPoints::Selected { indices, .. }) => Some(indices.len() as u64),
            (homotopy, starts) => starts.count()?.checked_mul(homotopy.targets()),
        }
    }

    /// The index of item `item` in the stage that first started its path.
    pub fn origin(&self, item: u64) -> u64 {
        self.start_points.origin(item)
    }
}
