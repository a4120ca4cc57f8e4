//! `cognate fsck`: compares the ledger of a service with the results that are stored.

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
    let inspection = data.inspect().await.map_err(|e| failed(&e))?;
    let repaired = match a.repair {
        true => Some(Repaired {
            tracked: data
                .track_lost_chunks(&inspection)
                .await
                .map_err(|e| failed(&e))?,
            removed: data.repair(&inspection).await.map_err(|e| failed(&e))?,
        }),
        false => None,
    };
    let text = match a.format {
        Format::Json => json(&inspection, repaired),
        Format::Table => table(&inspection, repaired),
    };
    output::print(&text)?;
    let tracked = repaired.map_or(0, |repaired| repaired.tracked);
    Ok(Exit::of_settled(inspection.faults.len() as u64 == tracked))
}

/// Result of a repair.
#[derive(Clone, Copy)]
struct Repaired {
    /// Number of chunks whose results were lost and have been restored.
    tracked: u64,
    /// Unreferenced objects that were removed.
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

/// A coordinator that serves nobody, for inspecting ledger and results.
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

/// The error of a command whose ledger or results failed.
pub fn failed(error: &CoordinatorError) -> ClientError {
    ClientError::Local(error.to_string())
}

fn json(inspection: &Inspection, repaired: Option<Repaired>) -> String {
    let amount = |stored: Amount| json!({ "objects": stored.objects, "bytes": stored.bytes });
    let names = |jobs: &[JobId]| jobs.iter().map(JobId::to_string).collect::<Vec<_>>();
    let faults = inspection.faults.iter().map(|fault| {
        json!({
            "job": fault.job.to_string(),
            "object": fault.is,
            "message": fault.what,
            "missing": fault.missing,
            "tracked_again": fault.tracked_again,
        })
    });
    let files = inspection.unfinished.iter();
    let answer = json!({
        "sound": inspection.is_sound(),
        "jobs": inspection.jobs,
        "checked": inspection.checked,
        "faults": faults.collect::<Vec<_>>(),
        "unnamed": inspection.unnamed.map(amount),
        "trash": amount(inspection.trash),
        "deleted_jobs": names(&inspection.deleted_jobs),
        "unknown_jobs": names(&inspection.unknown_jobs),
        "unfinished_files": files.map(|(file, _)| file.display().to_string()).collect::<Vec<_>>(),
        "removed": repaired.map(|repaired| amount(repaired.removed)),
        "repaired_chunks": repaired.map(|repaired| repaired.tracked),
    });
    format!("{answer}\n")
}

fn table(inspection: &Inspection, repaired: Option<Repaired>) -> String {
    let missing = inspection
        .faults
        .iter()
        .filter(|fault| fault.missing)
        .count();
    let retracked = inspection.faults.iter().filter(|fault| fault.tracked_again);
    let bytes =
        |amount: Amount| format!("{}  ({} bytes)", count(amount.objects), count(amount.bytes));
    let retracked = retracked.count();
    let rows = [
        ("jobs", count(inspection.jobs)),
        ("objects that rows name", count(inspection.checked)),
        ("  missing", count(missing as u64)),
        (
            "  damaged",
            count((inspection.faults.len() - missing) as u64),
        ),
        ("  tracked again by itself", count(retracked as u64)),
        (
            "objects that nothing names",
            inspection
                .unnamed
                .map_or_else(|| "not known".to_owned(), bytes),
        ),
        ("objects in the trash", bytes(inspection.trash)),
        (
            "deleted jobs with results",
            count(inspection.deleted_jobs.len() as u64),
        ),
        (
            "unknown jobs with results",
            count(inspection.unknown_jobs.len() as u64),
        ),
        (
            "unfinished files",
            count(inspection.unfinished.len() as u64),
        ),
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
    for fault in inspection.faults.iter().take(LISTED) {
        let _ = writeln!(text, "job {}: {}: {}", fault.job, fault.is, fault.what);
    }
    if inspection.faults.len() > LISTED {
        let more = counted((inspection.faults.len() - LISTED) as u64, "fault");
        let _ = writeln!(text, "... and {more} more: --format json lists all");
    }
    text
}
