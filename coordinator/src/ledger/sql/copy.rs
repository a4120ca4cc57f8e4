//! A copy of a ledger in a file, as of one moment, also while a coordinator writes to it.

use crate::ledger::LedgerError;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection as _};
use std::path::Path;
use std::time::Duration;

/// Copies the ledger in a file into a file that is not there yet. What is committed when this is called is in the
/// copy (SQLite, "VACUUM INTO": one read transaction).
pub async fn copy(from: &Path, to: &Path) -> Result<(), LedgerError> {
    let options = SqliteConnectOptions::new()
        .filename(from)
        .busy_timeout(Duration::from_secs(10));
    let mut connection = options.connect().await?;
    let copied = sqlx::query("VACUUM INTO ?")
        .bind(to.display().to_string())
        .execute(&mut connection)
        .await;
    // An error of the copy says more than an error of closing.
    let closed = connection.close().await;
    copied?;
    closed?;
    std::fs::File::open(to)
        .and_then(|file| file.sync_all())
        .map_err(|error| LedgerError::Storage(error.to_string()))
}
