//! AnyAlgorithm: one type for every algorithm, which can be written down and read back.

use crate::certified_solve::CertifiedSolve;
use crate::closing_stage::FiniteEndpoints;
use crate::completeness::{Complete, Completeness};
use crate::decomposition::DecompositionSolve;
use crate::monodromy::MonodromySolve;
use crate::monodromy::counts::LoopCounts;
use crate::parameter_solve::ParameterSolve;
use crate::polyhedral_solve::PolyhedralSolve;
use crate::regeneration_solve::RegenerationSolve;
use crate::sharpened_solve::SharpenedSolve;
use crate::zero_dimensional_solve::ZeroDimensionalSolve;
use crate::{Next, PathAlgorithm, Progress};
use cognate_continuation::path_result::PathResult;
use cognate_continuation::work::StageId;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::witness::Decomposition;
use cognate_systems::system::System;
use serde::{Deserialize, Serialize};

/// Version of the snapshots; another is not read.
const VERSION: u8 = 14;

/// Every algorithm that a plan can choose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum AnyAlgorithm {
    /// All isolated solutions of one system.
    ZeroDimensional(ZeroDimensionalSolve),
    /// From solved parameters to others.
    Parameter(ParameterSolve),
    /// From one solution of a family to all.
    Monodromy(Box<MonodromySolve>),
    /// Any of them, and the proof of what it found.
    Certified(Box<CertifiedSolve>),
    /// Any of them, and its solutions with more digits.
    Sharpened(Box<SharpenedSolve>),
    /// All isolated solutions of one system, from mixed cells.
    Polyhedral(Box<PolyhedralSolve>),
    /// All regular solutions of one system, equation by equation.
    Regeneration(Box<RegenerationSolve>),
    /// All components of one system.
    Decomposition(Box<DecompositionSolve>),
}

/// Why a snapshot cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// It was written by another version.
    #[error("the snapshot has version {found}, this program reads version {VERSION}")]
    Version {
        /// The version that it names.
        found: u8,
    },
    /// It is no snapshot, or not all of one.
    #[error("the snapshot is damaged: {0}")]
    Damaged(String),
}

impl AnyAlgorithm {
    /// The state that [`PathAlgorithm::snapshot`] wrote.
    pub fn restore(snapshot: &[u8]) -> Result<Self, RestoreError> {
        match snapshot.split_first() {
            None => Err(RestoreError::Damaged("it is empty".into())),
            Some((&VERSION, bytes)) => postcard::from_bytes(bytes)
                .map_err(|error| RestoreError::Damaged(error.to_string())),
            Some((&found, _)) => Err(RestoreError::Version { found }),
        }
    }

    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        postcard::to_extend(self, vec![VERSION]).expect("memory takes every byte")
    }

    /// The same with another limit of repetitions.
    #[must_use]
    pub fn with_max_retries(self, max_retries: u16) -> Self {
        match self {
            Self::ZeroDimensional(solve) => {
                Self::ZeroDimensional(solve.with_max_retries(max_retries))
            }
            Self::Parameter(solve) => Self::Parameter(solve.with_max_retries(max_retries)),
            Self::Monodromy(solve) => {
                Self::Monodromy(Box::new(solve.with_max_retries(max_retries)))
            }
            Self::Certified(solve) => {
                Self::Certified(Box::new(solve.with_max_retries(max_retries)))
            }
            Self::Sharpened(solve) => {
                Self::Sharpened(Box::new(solve.with_max_retries(max_retries)))
            }
            Self::Polyhedral(solve) => {
                Self::Polyhedral(Box::new(solve.with_max_retries(max_retries)))
            }
            Self::Regeneration(solve) => {
                Self::Regeneration(Box::new(solve.with_max_retries(max_retries)))
            }
            Self::Decomposition(solve) => {
                Self::Decomposition(Box::new(solve.with_max_retries(max_retries)))
            }
        }
    }

    fn get(&self) -> &dyn PathAlgorithm {
        match self {
            Self::ZeroDimensional(solve) => solve,
            Self::Parameter(solve) => solve,
            Self::Monodromy(solve) => &**solve,
            Self::Certified(solve) => &**solve,
            Self::Sharpened(solve) => &**solve,
            Self::Polyhedral(solve) => &**solve,
            Self::Regeneration(solve) => &**solve,
            Self::Decomposition(solve) => &**solve,
        }
    }

    /// The solve by monodromy, if it is one, certified or not.
    pub fn monodromy(&self) -> Option<&MonodromySolve> {
        match self {
            Self::Monodromy(solve) => Some(&**solve),
            Self::Certified(solve) => solve.solve().monodromy(),
            Self::Sharpened(solve) => solve.solve().monodromy(),
            Self::ZeroDimensional(_)
            | Self::Parameter(_)
            | Self::Polyhedral(_)
            | Self::Regeneration(_)
            | Self::Decomposition(_) => None,
        }
    }

    /// The decomposition that was found, where it is one and `next` has said `Done`.
    pub fn decomposition(&self) -> Option<&Decomposition> {
        match self {
            Self::Decomposition(solve) => solve.decomposition(),
            _ => None,
        }
    }

    /// How loops have come along, in a solve by monodromy.
    pub fn loops(&self) -> Option<&LoopCounts> {
        self.monodromy().map(MonodromySolve::counts)
    }

    /// The last results of all paths by the numbers that people see, where a stage counts its
    /// paths by others, or not all of them.
    pub fn renumbered_results(&self) -> Option<Vec<PathResult>> {
        match self {
            Self::Polyhedral(solve) => Some(solve.results()),
            Self::Regeneration(solve) => Some(solve.results()),
            Self::Certified(solve) => solve.solve().renumbered_results(),
            Self::Sharpened(solve) => solve.solve().renumbered_results(),
            Self::ZeroDimensional(solve) => solve.paths().results_with_images(),
            Self::Parameter(_) | Self::Monodromy(_) | Self::Decomposition(_) => None,
        }
    }

    /// The stage whose paths the answer counts; stages before it only prepared it.
    pub fn counted_stage(&self) -> StageId {
        self.monodromy()
            .map_or(StageId(0), MonodromySolve::counted_stage)
    }

    /// The solve whose plain paths need not be held (see `solutions::plain`), where it is such a one.
    pub fn large(&self) -> Option<&ZeroDimensionalSolve> {
        match self {
            Self::ZeroDimensional(solve) if solve.paths().can_leave_out() => Some(solve),
            _ => None,
        }
    }

    /// The same, to tell it about them.
    pub fn large_mut(&mut self) -> Option<&mut ZeroDimensionalSolve> {
        match self {
            Self::ZeroDimensional(solve) if solve.paths().can_leave_out() => Some(solve),
            _ => None,
        }
    }

    fn get_mut(&mut self) -> &mut dyn PathAlgorithm {
        match self {
            Self::ZeroDimensional(solve) => solve,
            Self::Parameter(solve) => solve,
            Self::Monodromy(solve) => &mut **solve,
            Self::Certified(solve) => &mut **solve,
            Self::Sharpened(solve) => &mut **solve,
            Self::Polyhedral(solve) => &mut **solve,
            Self::Regeneration(solve) => &mut **solve,
            Self::Decomposition(solve) => &mut **solve,
        }
    }
}

/// Whether loops found all: what a trace test says, or `known`, what the loops say of themselves.
fn judge_loops(loops: &LoopCounts, known: Option<&Completeness>, set: &mut SolutionSet) {
    let settled = set.settled();
    let counts = &mut set.counts;
    let (complete, why) = match (&loops.trace_test, known) {
        (Some(test), _) if !test.complete => {
            let why = "a trace test says that some are missing";
            (Complete::No, why.to_string())
        }
        (_, Some(known)) if settled => (known.complete, known.reason.clone()),
        _ => return,
    };
    (counts.complete, counts.complete_reason) = (complete, Some(why));
}

impl PathAlgorithm for AnyAlgorithm {
    fn next(&mut self) -> Next {
        self.get_mut().next()
    }
    fn absorb(&mut self, stage: StageId, results: &mut dyn Iterator<Item = PathResult>) {
        self.get_mut().absorb(stage, results);
    }
    fn failure(&self) -> Option<String> {
        self.get().failure()
    }
    fn progress(&self) -> Progress {
        self.get().progress()
    }
    fn snapshot(&self) -> Vec<u8> {
        self.to_bytes()
    }
    fn solution_sets(&self, system: &System) -> Vec<SolutionSet> {
        let mut sets = self.get().solution_sets(system);
        if let Some(loops) = self.loops() {
            let known = self.completeness();
            for set in &mut sets {
                judge_loops(loops, known.as_ref(), set);
            }
        }
        sets
    }
    fn completeness(&self) -> Option<Completeness> {
        self.get().completeness()
    }
    fn finite_endpoints(&self) -> Option<FiniteEndpoints> {
        self.get().finite_endpoints()
    }
}
