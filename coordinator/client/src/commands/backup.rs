//! `cognate backup`: the ledger as of one moment, then the objects that it names.

use super::fsck::{failed, open, place, results};
use crate::arguments::Backup;
use crate::error::{ClientError, Exit};
use crate::output;
use crate::output::text::{count, counted};
use cognate_coordinator::config::LedgerPlace;
use cognate_coordinator::ledger::sql::copy::copy;
use cognate_coordinator::results::place::ResultsPlace;
use std::fs::File;
use std::io;
use std::path::Path;

/// Copies, then inspects the copy.
pub async fn run(a: &Backup) -> Result<Exit, ClientError> {
    let place = place(&a.data)?;
    let LedgerPlace::Sqlite(ledger) = &place else {
        return Err(ClientError::Input {
            origin: "--ledger".into(),
            message: "a ledger in PostgreSQL is copied by pg_dump, and after that the folder of the results"
                .into(),
        });
    };
    let ResultsPlace::Folder(folder) = results(&a.data)? else {
        return Err(ClientError::Input {
            origin: "--results".into(),
            message: "results in a bucket are copied by its own tools, after the ledger".into(),
        });
    };
    rustix::process::umask(rustix::fs::Mode::RWXG | rustix::fs::Mode::RWXO);
    let wrong = |path: &Path, source| ClientError::File {
        action: "cannot write",
        path: path.to_owned(),
        source,
    };
    // A folder that is there may hold another copy.
    std::fs::create_dir(&a.folder).map_err(|e| wrong(&a.folder, e))?;
    let (copied, to) = (a.folder.join("ledger.db"), a.folder.join("results"));
    // The ledger first: objects are written before their rows, and never change.
    copy(ledger, &copied).await.map_err(|e| failed(&e.into()))?;
    let files = copy_folder(&folder, &to).map_err(|e| wrong(&to, e))?;
    let copy = open(&LedgerPlace::Sqlite(copied), &to.into()).await?;
    let inspection = copy.inspect().await.map_err(|e| failed(&e))?;
    output::print(&format!(
        "{} of {} copied to {}; {} missing or damaged there\n",
        counted(files, "file"),
        match inspection.jobs {
            1 => "1 job is".to_owned(),
            jobs => format!("{} jobs are", count(jobs)),
        },
        a.folder.display(),
        match inspection.faults.len() {
            1 => "1 object is".to_owned(),
            faults => format!("{} objects are", count(faults as u64)),
        }
    ))?;
    Ok(Exit::of_settled(inspection.is_sound()))
}

/// Copies the files of a folder and of those in it, durably; the number of files.
fn copy_folder(from: &Path, to: &Path) -> io::Result<u64> {
    std::fs::create_dir_all(to)?;
    let mut files = 0;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        // A file that is still being written has no row yet.
        if entry.file_name().to_string_lossy().contains('#') {
            continue;
        }
        if entry.file_type()?.is_dir() {
            files += copy_folder(&entry.path(), &target)?;
            continue;
        }
        match std::fs::copy(entry.path(), &target) {
            Ok(_) => {
                File::open(&target)?.sync_all()?;
                files += 1;
            }
            // A coordinator has removed or renamed the file; missing files are named in the end.
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
    }
    File::open(to)?.sync_all()?;
    Ok(files)
}
