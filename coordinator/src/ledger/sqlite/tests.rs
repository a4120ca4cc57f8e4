//! What only a ledger in a file can get wrong: reopening, versions, speed.

use super::{MIGRATIONS, SCHEMA_VERSION, SqliteLedger};
use crate::ledger::clock::{ManualClock, SystemClock};
use crate::ledger::conformance::*;
use crate::ledger::rows::*;
use crate::ledger::{Ledger, LedgerError};
use std::path::Path;
use std::sync::Arc;

async fn open(clock: Arc<ManualClock>) -> (SqliteLedger, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let ledger = SqliteLedger::open(&folder.path().join("ledger"), clock)
        .await
        .expect("an empty ledger opens");
    (ledger, folder)
}

ledger_conformance!(sqlite, open);

async fn reopen(path: &Path) -> Result<SqliteLedger, LedgerError> {
    SqliteLedger::open(path, Arc::new(SystemClock::default())).await
}

#[tokio::test]
async fn what_was_acknowledged_is_there_after_reopening() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ledger");
    let ledger = reopen(&path).await.unwrap();
    let job = ledger.submit(request("r"), new_job("t", 1)).await.unwrap();
    let row = ledger.job(job.job).await.unwrap();
    ledger.close().await;
    let refused = ledger.submit(request("s"), new_job("t", 1)).await;
    assert!(matches!(refused, Err(LedgerError::Closed)));
    let again = reopen(&path).await.unwrap();
    assert_eq!(again.job(job.job).await.unwrap(), row);
    let twice = again.submit(request("r"), new_job("t", 1)).await.unwrap();
    assert!(!twice.is_new);
}

#[tokio::test]
async fn later_and_foreign_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ledger");
    let ledger = reopen(&path).await.unwrap();
    ledger
        .writer
        .write(|c, _| {
            Box::pin(async move {
                sqlx::query("UPDATE ledger SET schema_version = 999")
                    .execute(c)
                    .await?;
                Ok(())
            })
        })
        .await
        .unwrap();
    ledger.close().await;
    let refused = reopen(&path).await.err().expect("it is refused");
    assert!(matches!(refused, LedgerError::TooNew { found: 999, .. }));
    let path = folder.path().join("text");
    std::fs::write(
        &path,
        "this is no database, whatever its name says\n".repeat(99),
    )
    .unwrap();
    assert!(reopen(&path).await.is_err());
}

/// A released schema never changes: a ledger of that version must still open.
#[test]
fn the_schema_of_version_1_is_what_it_was() {
    let hash = blake3::hash(MIGRATIONS[0].as_bytes()).to_hex();
    assert_eq!(SCHEMA_VERSION as usize, MIGRATIONS.len());
    assert_eq!(&hash[..16], "0d7a7ee043c8b187", "add a migration instead");
}

/// Measured, not asserted: `cargo test --release -p cognate-coordinator -- --ignored --nocapture speed`.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn speed_of_lease_and_complete() {
    let folder = tempfile::tempdir().unwrap();
    let ledger = Arc::new(reopen(&folder.path().join("ledger")).await.unwrap());
    let job = ledger
        .submit(request("r"), new_job("t", 1))
        .await
        .unwrap()
        .job;
    let who = coordinator("c");
    let epoch = ledger.steward(job, &who, 600_000).await.unwrap().unwrap();
    let open = Advance {
        open: vec![stage(0, 1_000_000, 1_000_000)],
        ..Advance::default()
    };
    ledger.advance(job, epoch, open).await.unwrap();
    for workers in [1, 32] {
        let begin = std::time::Instant::now();
        let each = 6400 / workers / 4;
        let tasks = (0..workers).map(|w| {
            let ledger = Arc::clone(&ledger);
            tokio::spawn(async move {
                for k in 0..each {
                    let mut wanted = wants(&format!("w{w}"), &format!("{workers}-{k}"), 1);
                    wanted.sizing.most_items = 10;
                    let lease = ledger.lease(wanted).await.unwrap()[0].clone();
                    let object = result(lease.items, 1, 100_000);
                    let done = ledger.complete(lease.lease, object).await.unwrap();
                    assert_eq!(done, Completion::Accepted);
                }
            })
        });
        for task in tasks.collect::<Vec<_>>() {
            task.await.unwrap();
        }
        let rate = (each * workers) as f64 / begin.elapsed().as_secs_f64();
        println!("{workers} workers: {rate:.0} lease + complete a second");
    }
}
