//! Health: whether ledger and result store can be used.
//!
//! Both are checked every second. While one of them is in trouble, nothing is leased, and the health service reports
//! that the services do not serve. The process itself counts as alive.

use crate::ledger::Ledger;
use crate::results::store::Store;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::time::timeout;

/// Time after which a ledger or a store that has not answered counts as being in trouble.
const PATIENCE: Duration = Duration::from_secs(10);

/// Troubles of the ledger and the result store.
#[derive(Debug, Default)]
pub struct Health {
    troubles: Mutex<Vec<String>>,
}

impl Health {
    fn lock(&self) -> MutexGuard<'_, Vec<String>> {
        self.troubles.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Descriptions of the troubles, one sentence each; empty while there are none.
    pub fn troubles(&self) -> Vec<String> {
        self.lock().clone()
    }

    /// Whether something is wrong.
    pub fn is_troubled(&self) -> bool {
        !self.lock().is_empty()
    }

    /// Checks ledger and store, and logs a change.
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
