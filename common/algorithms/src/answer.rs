//! Answer: what a finished solve has found, of whatever kind.

use crate::monodromy::counts::LoopCounts;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::witness::{self, Decomposition, TrackedPaths};
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Answer of a finished solve. A new kind of answer is a variant here, one of `StoredAnswer` and one of `AnySummary` in
/// the coordinator, which define how it is stored and reported, and one of `Summary` in `solution.proto`.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Isolated solutions.
    Isolated(IsolatedSolutions),
    /// The irreducible components of all dimensions that were asked for.
    Decomposition(Arc<Decomposition>),
    /// Answer to a question about known components.
    Question(AnsweredQuestion),
}

/// The isolated solutions of one system, or of several members of a family.
#[derive(Clone, Debug, PartialEq)]
pub struct IsolatedSolutions {
    /// Solution sets, one for each target.
    pub sets: Vec<SolutionSet>,
    /// Counts and parameters of the loops, if loops found the solutions.
    pub loops: Option<FoundByLoops>,
    /// Paths that a solve holds, ascending, if it does not hold all (see `solutions::streamed`): only their solutions
    /// are in the sets; all are counted there.
    pub held: Option<Vec<u64>>,
}

/// Solutions that loops found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundByLoops {
    /// Loops and paths.
    pub counts: LoopCounts,
    /// The parameters of the solutions, by name; empty where there are several targets.
    pub parameters: BTreeMap<String, Complex64>,
}

/// A question to components with its answer.
#[derive(Clone, Debug, PartialEq)]
pub struct AnsweredQuestion {
    /// Names of the unknowns, in the order of the coordinates of points.
    pub unknowns: Vec<String>,
    /// The answer.
    pub answer: witness::Answer,
    /// Doubts in words; empty if all is settled.
    pub doubts: Vec<String>,
    /// Paths that were tracked, counted without repetitions.
    pub paths: TrackedPaths,
}

impl From<Vec<SolutionSet>> for Answer {
    fn from(sets: Vec<SolutionSet>) -> Self {
        Self::Isolated(IsolatedSolutions {
            sets,
            loops: None,
            held: None,
        })
    }
}

impl Answer {
    /// The isolated solutions, one set for each target; none of an answer of another kind.
    pub fn into_sets(self) -> Vec<SolutionSet> {
        match self {
            Self::Isolated(isolated) => isolated.sets,
            Self::Decomposition(_) | Self::Question(_) => Vec::new(),
        }
    }
}
