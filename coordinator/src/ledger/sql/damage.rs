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
        if matches!(error, LedgerError::Malformed(_)) {
            // Said again, the first word stays.
            let _ = self.0.set(error.to_string());
        }
    }

    /// What was noted.
    pub fn noted(&self) -> Option<String> {
        self.0.get().cloned()
    }
}
