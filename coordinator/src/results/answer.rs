//! StoredAnswer: the answer of a finished job as it is kept, each kind as an object of a kind of its own.

use super::store::{RecordKind, Store, StoreError};
use cognate_algorithms::Answer;
use cognate_algorithms::answer::IsolatedSolutions;
use cognate_continuation::start_points::Digest;
use cognate_solutions::solution_set::SolutionSet;
use cognate_solutions::witness::{self, Decomposition};
use serde::{Deserialize, Serialize};

/// Solution sets as objects.
const SOLUTIONS: RecordKind = RecordKind(b"CGNSOL09");

/// Answers of large jobs as objects.
const LARGE: RecordKind = RecordKind(b"CGNLRG08");

/// Decompositions as objects.
const DECOMPOSITION: RecordKind = RecordKind(b"CGNDEC09");

/// Answers of components as objects.
const ANSWER: RecordKind = RecordKind(b"CGNANS01");

/// Answer of a job of which not all paths are held in memory (see `solutions::streamed`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LargeAnswer {
    /// Paths that are held in memory, ascending. The ends of the others are read from their results.
    pub held: Vec<u64>,
    /// Counts of all paths and solutions of the held paths, for each target.
    pub sets: Vec<SolutionSet>,
}

/// Answer of a job, as it is read back from the store.
#[derive(Clone, Debug, PartialEq)]
pub enum StoredAnswer {
    /// Isolated solutions, one set for each target.
    Isolated(Vec<SolutionSet>),
    /// Isolated solutions of which not all are in the object.
    Large(LargeAnswer),
    /// Components.
    Decomposition(Decomposition),
    /// Answer to a question about components.
    Question(witness::Answer),
}

impl StoredAnswer {
    /// Keeps an answer.
    pub async fn put(answer: Answer, store: &Store) -> Result<Digest, StoreError> {
        match answer {
            Answer::Isolated(IsolatedSolutions { sets, held, .. }) => match held {
                Some(held) => store.put_record(&LARGE, LargeAnswer { held, sets }).await,
                None => store.put_record(&SOLUTIONS, sets).await,
            },
            Answer::Decomposition(decomposition) => {
                store.put_record(&DECOMPOSITION, decomposition).await
            }
            Answer::Question(asked) => store.put_record(&ANSWER, asked.answer).await,
        }
    }

    /// Reads an answer of whatever kind.
    pub async fn get(store: &Store, digest: Digest) -> Result<Self, StoreError> {
        Ok(if store.is_of_kind(&LARGE, digest).await? {
            Self::Large(store.record(&LARGE, digest).await?)
        } else if store.is_of_kind(&DECOMPOSITION, digest).await? {
            Self::Decomposition(store.record(&DECOMPOSITION, digest).await?)
        } else if store.is_of_kind(&ANSWER, digest).await? {
            Self::Question(store.record(&ANSWER, digest).await?)
        } else {
            Self::Isolated(store.record(&SOLUTIONS, digest).await?)
        })
    }

    /// The answer of a large job; `None` of any other, which is not read.
    pub async fn large(store: &Store, digest: Digest) -> Result<Option<LargeAnswer>, StoreError> {
        Ok(match store.is_of_kind(&LARGE, digest).await? {
            true => Some(store.record(&LARGE, digest).await?),
            false => None,
        })
    }

    /// Description of the answer, for clients that want another kind of answer.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Isolated(_) | Self::Large(_) => "no decomposition: it has no witness points",
            Self::Decomposition(_) => {
                "a decomposition: it has witness points, and no list of solutions or paths"
            }
            Self::Question(_) => "a question to components: its answer is its summary",
        }
    }
}
