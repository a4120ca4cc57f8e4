//! Tools: parts of the coordinator that a drive uses, and errors of its steps.

use crate::chunks::leasing::Policy;
use crate::ledger::identity::{ChunkId, CoordinatorId, Epoch, JobId};
use crate::ledger::{Ledger, LedgerError};
use crate::results::store::{Store, StoreError};

/// Parts of the coordinator that a drive uses.
pub struct Tools<'a> {
    /// The ledger.
    pub ledger: &'a dyn Ledger,
    /// The store of objects.
    pub store: &'a Store,
    /// Name of the coordinator that drives.
    pub who: &'a CoordinatorId,
    /// Policy of the service.
    pub policy: &'a Policy,
}

impl Tools<'_> {
    /// Keeps the right to drive a job; false once it is lost.
    pub async fn renew_right(&self, job: JobId, epoch: Epoch) -> Result<bool, LedgerError> {
        let duration = self.policy.steward_ms;
        let right = self.ledger.steward(job, self.who, duration).await?;
        Ok(right == Some(epoch))
    }
}

/// Why a step of a drive was not made.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The ledger refused or failed.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
    /// An object could not be written or read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The results of a chunk are lost, though they were accepted.
    #[error("the results of {chunk:?} are lost: {why}")]
    LostResults {
        /// The chunk.
        chunk: ChunkId,
        /// Error of the store.
        why: String,
    },
    /// The job's state cannot be read back.
    #[error("the job's state cannot be read: {0}")]
    State(String),
}

impl DriveError {
    /// True where another steward, or nobody, drives the job now.
    pub fn is_fenced(&self) -> bool {
        matches!(self, Self::Ledger(LedgerError::Fenced(_)))
    }

    /// True where an object is lost that the step needs.
    pub fn is_loss(&self) -> bool {
        match self {
            Self::Store(error) => error.is_loss(),
            Self::LostResults { .. } => true,
            Self::Ledger(_) | Self::State(_) => false,
        }
    }

    /// True where trying again later cannot help: the job ends with this reason.
    pub fn is_permanent(&self) -> bool {
        match self {
            Self::Ledger(LedgerError::Damaged(_) | LedgerError::TooLarge(_)) | Self::State(_) => {
                true
            }
            Self::Ledger(_) | Self::LostResults { .. } => false,
            Self::Store(error) => error.is_permanent(),
        }
    }
}
