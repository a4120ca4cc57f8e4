//! Damage: the storage engine's report of pages that are not what it wrote.
//!
//! The code that meets a damaged page notes it here, and the health check reads it. A damaged file stays damaged
//! until somebody restores a copy of the ledger, so the note is never withdrawn.

use crate::ledger::LedgerError;
use std::sync::{Arc, OnceLock};

/// First report of damage. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Damage(Arc<OnceLock<String>>);

impl Damage {
    /// Remembers an error if it reports a damaged file.
    pub fn note(&self, error: &LedgerError) {
        if let LedgerError::Malformed(why) = error {
            // A second report does not replace the first.
            let _ = self.0.set(why.clone());
        }
    }

    /// Returns an error once damage was noted.
    pub fn refuse(&self) -> Result<(), LedgerError> {
        match self.0.get() {
            Some(why) => Err(LedgerError::Malformed(why.clone())),
            None => Ok(()),
        }
    }

    /// The noted damage, as a sentence.
    pub fn noted(&self) -> Option<String> {
        self.refuse().err().map(|error| error.to_string())
    }
}
