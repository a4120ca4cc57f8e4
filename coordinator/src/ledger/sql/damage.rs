//! Damage: what the storage engine said of pages that are not what it wrote.
//!
//! Whoever meets a damaged page notes it here; health asks. A file that is damaged stays so until somebody restores
//! a copy of the ledger, so that nothing is ever taken back.

use crate::ledger::LedgerError;
use std::sync::{Arc, OnceLock};

/// The first word on damage. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Damage(Arc<OnceLock<String>>);

impl Damage {
    /// Remembers an error if it says that the file is damaged.
    pub fn note(&self, error: &LedgerError) {
        if let LedgerError::Malformed(why) = error {
            // Said again, the first word stays.
            let _ = self.0.set(why.clone());
        }
    }

    /// An error once something was noted.
    pub fn refuse(&self) -> Result<(), LedgerError> {
        match self.0.get() {
            Some(why) => Err(LedgerError::Malformed(why.clone())),
            None => Ok(()),
        }
    }

    /// What was noted, as a sentence.
    pub fn noted(&self) -> Option<String> {
        self.refuse().err().map(|error| error.to_string())
    }
}
