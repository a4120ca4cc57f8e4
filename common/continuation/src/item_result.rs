//! ItemResult: what is known of one item of a stage when its work is done. The noun that leaves this crate.
//!
//! One variant for each kind of [`Work`]: a path that was tracked, or a point or branch of which something was
//! found out. Facts only, so that two executions of one item can be compared bit for bit.

use crate::bend::Bend;
use crate::certification::Certification;
use crate::path_result::{Coordinates, LocalDimension, PathIndex, PathResult};
use crate::sharpening::Sharpening;
use crate::start_systems::polyhedral::branches::BranchCount;
use crate::tracker::outcome::{Failure, PathOutcome};
use crate::work::Work;
use cognate_numeric::precision::DOUBLE;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// The result of one item, by the kind of work that was done with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ItemResult {
    /// A path to its end.
    Track(PathResult),
    /// Whether exactly one solution is proved near a point, in the values of the variables.
    Certify(PointResult<Certification>),
    /// Whether an endpoint is isolated, in homogeneous coordinates of the chart; nothing where the chart misses
    /// it, which has probability 0.
    LocalDimension(PointResult<LocalDimension>),
    /// A point with more digits, in the values of the variables.
    Sharpen(PointResult<Sharpening>),
    /// The mixed cells of a branch; the origin is the branch, and the point says nothing.
    CountMixedCells(PointResult<BranchCount>),
    /// Velocity and acceleration of a witness point as the parameters move, in the values of the variables; nothing
    /// where Newton's method does not settle at the point.
    Bend(PointResult<Box<Bend>>),
}

/// Result of work at one point or branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointResult<Fact> {
    /// The item, by its index in the stage that it was first an item of.
    pub origin: PathIndex,
    /// Attempt of the stage that did the work.
    pub attempt: u16,
    /// The point that was given; empty for an item that ended its workers.
    pub point: Vec<Complex64>,
    /// Largest |F_i| at the point, each equation and each group scaled to 1; infinite where unknown.
    pub residual: f64,
    /// Condition number of the Jacobian at the point; infinite where unknown.
    pub condition: f64,
    /// Estimated error of the point, relative to its largest coordinate; infinite where unknown.
    pub accuracy: f64,
    /// Highest precision used, in bits.
    pub precision_bits: u32,
    /// The fact that the work found at the point.
    pub finding: Finding<Fact>,
}

/// Outcome of the work on one item.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Finding<Fact> {
    /// The work found this fact.
    Found(Fact),
    /// The question has no answer at this point.
    Nothing,
    /// No worker survived the item.
    KilledItsWorker,
}

impl<Fact> PointResult<Fact> {
    /// A fact about a point of which nothing else is known.
    pub fn new(origin: PathIndex, attempt: u16, point: Vec<Complex64>, fact: Option<Fact>) -> Self {
        Self {
            origin,
            attempt,
            point,
            residual: f64::INFINITY,
            condition: f64::INFINITY,
            accuracy: f64::INFINITY,
            precision_bits: DOUBLE,
            finding: fact.map_or(Finding::Nothing, Finding::Found),
        }
    }

    fn killed(origin: PathIndex, attempt: u16) -> Self {
        Self {
            finding: Finding::KilledItsWorker,
            ..Self::new(origin, attempt, Vec::new(), None)
        }
    }

    /// The fact, where there is one.
    pub fn fact(&self) -> Option<&Fact> {
        match &self.finding {
            Finding::Found(fact) => Some(fact),
            Finding::Nothing | Finding::KilledItsWorker => None,
        }
    }

    /// The fact alone, where there is one.
    pub fn into_fact(self) -> Option<Fact> {
        match self.finding {
            Finding::Found(fact) => Some(fact),
            Finding::Nothing | Finding::KilledItsWorker => None,
        }
    }
}

impl ItemResult {
    /// The result of an item that no worker survived.
    pub fn killed_its_worker(work: Work, origin: PathIndex, attempt: u16) -> Self {
        match work {
            Work::Track => Self::Track(PathResult {
                t: Complex64::new(1.0, 0.0),
                ..PathResult::untracked(
                    origin.0,
                    attempt,
                    PathOutcome::Failed(Failure::KilledItsWorker),
                    Vec::new(),
                )
            }),
            Work::Certify => Self::Certify(PointResult::killed(origin, attempt)),
            Work::LocalDimension => Self::LocalDimension(PointResult::killed(origin, attempt)),
            Work::Sharpen { .. } => Self::Sharpen(PointResult::killed(origin, attempt)),
            Work::CountMixedCells => Self::CountMixedCells(PointResult::killed(origin, attempt)),
            Work::Bend => Self::Bend(PointResult::killed(origin, attempt)),
        }
    }

    /// True where it is the result of an item of this kind of work.
    pub fn is_of(&self, work: Work) -> bool {
        match self {
            Self::Track(_) => work == Work::Track,
            Self::Certify(_) => work == Work::Certify,
            Self::LocalDimension(_) => work == Work::LocalDimension,
            Self::Sharpen(_) => matches!(work, Work::Sharpen { .. }),
            Self::CountMixedCells(_) => work == Work::CountMixedCells,
            Self::Bend(_) => work == Work::Bend,
        }
    }

    /// The item, by its index in the stage that it was first an item of.
    pub fn origin(&self) -> PathIndex {
        match self {
            Self::Track(path) => path.origin,
            Self::Certify(point) => point.origin,
            Self::LocalDimension(point) => point.origin,
            Self::Sharpen(point) => point.origin,
            Self::CountMixedCells(branch) => branch.origin,
            Self::Bend(point) => point.origin,
        }
    }

    /// The attempt of its stage.
    pub fn attempt(&self) -> u16 {
        match self {
            Self::Track(path) => path.attempt,
            Self::Certify(point) => point.attempt,
            Self::LocalDimension(point) => point.attempt,
            Self::Sharpen(point) => point.attempt,
            Self::CountMixedCells(branch) => branch.attempt,
            Self::Bend(point) => point.attempt,
        }
    }

    /// The path, where the item is one.
    pub fn path(&self) -> Option<&PathResult> {
        match self {
            Self::Track(path) => Some(path),
            Self::Certify(_)
            | Self::LocalDimension(_)
            | Self::Sharpen(_)
            | Self::CountMixedCells(_)
            | Self::Bend(_) => None,
        }
    }

    /// The path of an item of a stage that tracks.
    ///
    /// # Panics
    /// Where the item is no path. A caller that feeds a solve from outside has compared results with their stage
    /// ([`Self::is_of`]).
    pub fn into_path(self) -> PathResult {
        match self {
            Self::Track(path) => path,
            other => panic!("a stage that tracks has paths, not {other:?}"),
        }
    }
}

impl From<PathResult> for ItemResult {
    fn from(path: PathResult) -> Self {
        Self::Track(path)
    }
}

/// An item as a path without steps: how results of all kinds begin on the wire and in records.
impl<Fact> PointResult<Fact> {
    /// The point as the end of a path that was not tracked, with this outcome unless it ended its workers.
    pub fn as_untracked(&self, outcome: PathOutcome) -> PathResult {
        let killed = matches!(self.finding, Finding::KilledItsWorker);
        PathResult {
            t: Complex64::new(if killed { 1.0 } else { 0.0 }, 0.0),
            endpoint: Coordinates::Double(self.point.clone()),
            residual: self.residual,
            condition: self.condition,
            accuracy: self.accuracy,
            precision_bits: self.precision_bits,
            ..PathResult::untracked(
                self.origin.0,
                self.attempt,
                match killed {
                    true => PathOutcome::Failed(Failure::KilledItsWorker),
                    false => outcome,
                },
                Vec::new(),
            )
        }
    }

    /// Builds the result back from the path that [`Self::as_untracked`] made of it.
    pub fn from_untracked(path: PathResult, fact: Option<Fact>) -> Self {
        let Coordinates::Double(point) = path.endpoint;
        Self {
            origin: path.origin,
            attempt: path.attempt,
            point,
            residual: path.residual,
            condition: path.condition,
            accuracy: path.accuracy,
            precision_bits: path.precision_bits,
            finding: match (path.outcome, fact) {
                (PathOutcome::Failed(_), _) => Finding::KilledItsWorker,
                (_, Some(fact)) => Finding::Found(fact),
                (_, None) => Finding::Nothing,
            },
        }
    }
}
