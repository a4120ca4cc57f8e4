//! Health: whether the ledger answers and the results are there.
//!
//! Looked at every second. While something is wrong nothing is leased, and whoever asks for the health of
//! the services hears that they do not serve; that the process lives is another question.

use crate::ledger::Ledger;
use crate::results::store::Store;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::time::timeout;

/// A ledger or a store that answers later than this is in trouble.
const PATIENCE: Duration = Duration::from_secs(10);

/// What is wrong with the parts that a coordinator stands on.
#[derive(Debug, Default)]
pub struct Health {
    troubles: Mutex<Vec<String>>,
}

impl Health {
    fn lock(&self) -> MutexGuard<'_, Vec<String>> {
        self.troubles.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is wrong, one sentence each; nothing while all is well.
    pub fn troubles(&self) -> Vec<String> {
        self.lock().clone()
    }

    /// Whether something is wrong.
    pub fn is_troubled(&self) -> bool {
        !self.lock().is_empty()
    }

    /// Looks at both, and says when something changes.
    pub async fn examine(&self, ledger: &dyn Ledger, store: &Store) {
        let mut troubles: Vec<String> = ledger.damage().into_iter().collect();
        match timeout(PATIENCE, ledger.jobs(1)).await {
            Ok(Ok(_)) => {}
            Ok(Err(error)) => troubles.push(error.to_string()),
            Err(_) => troubles.push("the ledger does not answer".to_owned()),
        }
        let store = store.clone();
        // A file system that hangs must not hang the runtime.
        let runtime = tokio::runtime::Handle::current();
        let looked = tokio::task::spawn_blocking(move || runtime.block_on(store.is_there()));
        match timeout(PATIENCE, looked).await {
            Ok(Ok(Ok(()))) => {}
            Ok(Ok(Err(error))) => troubles.push(error.to_string()),
            Ok(Err(_)) | Err(_) => troubles.push("the result store does not answer".to_owned()),
        }
        let before = std::mem::replace(&mut *self.lock(), troubles.clone());
        if before != troubles {
            match troubles.is_empty() {
                true => tracing::info!("ledger and results are there again"),
                false => tracing::error!(?troubles, "no chunk is given out until this is mended"),
            }
        }
    }
}
