//! FlatResult: a result of any kind as the fields that messages and records have, each of which only some
//! kinds fill.
//!
//! Which fields belong to which kind of work is said here, once for the wire and for what is stored.

use cognate_continuation::bend::Bend;
use cognate_continuation::certification::Certification;
use cognate_continuation::item_result::{ItemResult, PointResult};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::sharpening::Sharpening;
use cognate_continuation::start_systems::polyhedral::branches::BranchCount;
use cognate_continuation::tracker::outcome::PathOutcome;
use cognate_continuation::work::Work;

/// Fields of a result as a message or a record holds them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FlatResult {
    /// A path; for an item of another kind its point, as the end of a path without steps.
    pub path: PathResult,
    /// Facts proved about a point.
    pub certification: Option<Certification>,
    /// A point with more digits.
    pub sharpening: Option<Sharpening>,
    /// The mixed cells of a branch.
    pub mixed_cells: Option<BranchCount>,
    /// Motion of a point with the parameters.
    pub bend: Option<Box<Bend>>,
}

/// A result holds what belongs to another kind of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OtherKind;

impl From<PathResult> for FlatResult {
    fn from(path: PathResult) -> Self {
        Self {
            path,
            certification: None,
            sharpening: None,
            mixed_cells: None,
            bend: None,
        }
    }
}

impl From<&ItemResult> for FlatResult {
    fn from(result: &ItemResult) -> Self {
        match result {
            ItemResult::Track(path) => path.clone().into(),
            ItemResult::Certify(point) => Self {
                certification: point.fact().cloned(),
                ..point.as_untracked(PathOutcome::Regular).into()
            },
            ItemResult::LocalDimension(point) => PathResult {
                local_dimension: point.fact().cloned(),
                ..point.as_untracked(PathOutcome::Singular)
            }
            .into(),
            ItemResult::Sharpen(point) => Self {
                sharpening: point.fact().cloned(),
                ..point.as_untracked(PathOutcome::Regular).into()
            },
            ItemResult::CountMixedCells(branch) => Self {
                mixed_cells: branch.fact().copied(),
                ..branch.as_untracked(PathOutcome::Regular).into()
            },
            ItemResult::Bend(point) => Self {
                bend: point.fact().cloned(),
                ..point.as_untracked(PathOutcome::Regular).into()
            },
        }
    }
}

impl FlatResult {
    /// True where it holds what no tracker finds out.
    fn has_facts(&self) -> bool {
        self.certification.is_some()
            || self.path.local_dimension.is_some()
            || self.sharpening.is_some()
            || self.mixed_cells.is_some()
            || self.bend.is_some()
    }

    /// The result of an item of this kind of work; refused where it has facts of another kind.
    pub fn into_item(self, work: Work) -> Result<ItemResult, OtherKind> {
        if work == Work::Track {
            // The numbers of a failed path may be NaN, which is equal to nothing.
            return match self.has_facts() {
                true => Err(OtherKind),
                false => Ok(ItemResult::Track(self.path)),
            };
        }
        let whole = self.clone();
        let mut path = self.path;
        let item = match work {
            Work::Track => ItemResult::Track(path),
            Work::Certify => {
                ItemResult::Certify(PointResult::from_untracked(path, self.certification))
            }
            Work::LocalDimension => {
                let fact = path.local_dimension.take();
                ItemResult::LocalDimension(PointResult::from_untracked(path, fact))
            }
            Work::Sharpen { .. } => {
                ItemResult::Sharpen(PointResult::from_untracked(path, self.sharpening))
            }
            Work::CountMixedCells => {
                ItemResult::CountMixedCells(PointResult::from_untracked(path, self.mixed_cells))
            }
            Work::Bend => ItemResult::Bend(PointResult::from_untracked(path, self.bend)),
        };
        match Self::from(&item) == whole {
            true => Ok(item),
            false => Err(OtherKind),
        }
    }
}
