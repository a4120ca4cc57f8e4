//! `cognate fsck`: what a service remembers, held against what is there.

use crate::arguments::{DataArguments, Format, Fsck};
use crate::error::{ClientError, Exit};
use crate::output;
use crate::output::text::{count, counted};
use cognate_coordinator::chunks::leasing::Policy;
use cognate_coordinator::config::LedgerPlace;
use cognate_coordinator::coordinator::inspection::Inspection;
use cognate_coordinator::coordinator::{Coordinator, CoordinatorError};
use cognate_coordinator::ledger::Ledger;
use cognate_coordinator::ledger::clock::SystemClock;
use cognate_coordinator::ledger::identity::{CoordinatorId, JobId};
use cognate_coordinator::ledger::sql::SqlLedger;
use cognate_coordinator::results::place::ResultsPlace;
use cognate_coordinator::results::store::Store;
use cognate_coordinator::results::trash::Amount;
use serde_json::json;
use std::fmt::Write;
use std::sync::Arc;

/// Faults that are listed in a table; all of them are in the JSON.
const LISTED: usize = 20;

/// Inspects, and repairs if asked.
pub async fn run(a: &Fsck) -> Result<Exit, ClientError> {
    let place = place(&a.data)?;
    let data = open(&place, &results(&a.data)?).await?;
    let found = data.inspect().await.map_err(|e| failed(&e))?;
    let repaired = match a.repair {
        true => Some(Repaired {
            tracked: data
                .track_lost_chunks(&found)
                .await
                .map_err(|e| failed(&e))?,
            removed: data.repair(&found).await.map_err(|e| failed(&e))?,
        }),
        false => None,
    };
    let text = match a.format {
        Format::Json => json(&found, repaired),
        Format::Table => table(&found, repaired),
    };
    output::print(&text)?;
    let tracked = repaired.map_or(0, |repaired| repaired.tracked);
    Ok(Exit::of_settled(found.faults.len() as u64 == tracked))
}

/// What a repair did.
#[derive(Clone, Copy)]
struct Repaired {
    /// Number of chunks whose results were lost, and are there again.
    tracked: u64,
    /// Objects that nothing names, which are removed.
    removed: Amount,
}

/// The ledger that is meant, which must be there.
pub fn place(data: &DataArguments) -> Result<LedgerPlace, ClientError> {
    let wrong = |message: String| ClientError::Input {
        origin: "--ledger".into(),
        message,
    };
    let place = data.ledger.parse().map_err(|e| wrong(format!("{e}")))?;
    match &place {
        LedgerPlace::Sqlite(path) if !path.is_file() => {
            Err(wrong(format!("there is no file {}", path.display())))
        }
        LedgerPlace::Memory => Err(wrong("a ledger in memory ends with its process".into())),
        LedgerPlace::Sqlite(_) | LedgerPlace::Postgres(_) => Ok(place),
    }
}

/// The results that are meant.
pub fn results(data: &DataArguments) -> Result<ResultsPlace, ClientError> {
    data.results.parse().map_err(|e| ClientError::Input {
        origin: "--results".into(),
        message: format!("{e}"),
    })
}

/// A coordinator that serves nobody: what can be asked of ledger and results.
pub async fn open(
    place: &LedgerPlace,
    results: &ResultsPlace,
) -> Result<Arc<Coordinator>, ClientError> {
    let ledger = match place {
        LedgerPlace::Sqlite(path) => {
            SqlLedger::sqlite(path, Arc::new(SystemClock::default())).await
        }
        LedgerPlace::Postgres(url) => SqlLedger::postgres(url, None).await,
        LedgerPlace::Memory => unreachable!("no command is given one"),
    };
    let ledger: Arc<dyn Ledger> = Arc::new(ledger.map_err(|e| failed(&e.into()))?);
    let store = Store::open(results, false).await;
    let store = store.map_err(|e| failed(&e.into()))?;
    let who = CoordinatorId::new("inspection").expect("it is a name");
    Ok(Coordinator::new(ledger, store, who, Policy::default()))
}

/// What ledger or results could not be asked.
pub fn failed(error: &CoordinatorError) -> ClientError {
    ClientError::Local(error.to_string())
}

fn json(found: &Inspection, repaired: Option<Repaired>) -> String {
    let amount = |of: Amount| json!({ "objects": of.objects, "bytes": of.bytes });
    let names = |jobs: &[JobId]| jobs.iter().map(JobId::to_string).collect::<Vec<_>>();
    let faults = found.faults.iter().map(|fault| {
        json!({
            "job": fault.job.to_string(),
            "object": fault.is,
            "message": fault.what,
            "missing": fault.missing,
            "tracked_again": fault.tracked_again,
        })
    });
    let files = found.unfinished.iter();
    let answer = json!({
        "sound": found.is_sound(),
        "jobs": found.jobs,
        "checked": found.checked,
        "faults": faults.collect::<Vec<_>>(),
        "unnamed": found.unnamed.map(amount),
        "trash": amount(found.trash),
        "deleted_jobs": names(&found.deleted_jobs),
        "unknown_jobs": names(&found.unknown_jobs),
        "unfinished_files": files.map(|(file, _)| file.display().to_string()).collect::<Vec<_>>(),
        "removed": repaired.map(|repaired| amount(repaired.removed)),
        "repaired_chunks": repaired.map(|repaired| repaired.tracked),
    });
    format!("{answer}\n")
}

fn table(found: &Inspection, repaired: Option<Repaired>) -> String {
    let missing = found.faults.iter().filter(|fault| fault.missing).count();
    let again = found.faults.iter().filter(|fault| fault.tracked_again);
    let bytes = |of: Amount| format!("{}  ({} bytes)", count(of.objects), count(of.bytes));
    let again = again.count();
    let rows = [
        ("jobs", count(found.jobs)),
        ("objects that rows name", count(found.checked)),
        ("  missing", count(missing as u64)),
        ("  damaged", count((found.faults.len() - missing) as u64)),
        ("  tracked again by itself", count(again as u64)),
        (
            "objects that nothing names",
            found.unnamed.map_or_else(|| "not known".to_owned(), bytes),
        ),
        ("objects in the trash", bytes(found.trash)),
        (
            "deleted jobs with results",
            count(found.deleted_jobs.len() as u64),
        ),
        (
            "unknown jobs with results",
            count(found.unknown_jobs.len() as u64),
        ),
        ("unfinished files", count(found.unfinished.len() as u64)),
    ];
    let mut text = String::new();
    // Writing to a text does not fail.
    for (name, value) in rows {
        let _ = writeln!(text, "{name:<28}{value}");
    }
    if let Some(Repaired { tracked, removed }) = repaired {
        let _ = writeln!(text, "{:<28}{}", "tracked again now", count(tracked));
        let _ = writeln!(text, "{:<28}{}", "removed now", bytes(removed));
    }
    for fault in found.faults.iter().take(LISTED) {
        let _ = writeln!(text, "job {}: {}: {}", fault.job, fault.is, fault.what);
    }
    if found.faults.len() > LISTED {
        let more = counted((found.faults.len() - LISTED) as u64, "fault");
        let _ = writeln!(text, "... and {more} more: --format json lists all");
    }
    text
}
