//! Audit log: calls of clients and their outcomes.
//!
//! The log has one entry for each submission, cancellation, deletion and upload, and for each refused call of any
//! caller. Entries go to the log under the target `audit` and, where one is named, to a file of one JSON object a
//! line, which is only ever appended to.

use super::caller::Caller;
use super::error::code_name;
use serde::Serialize;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;
use tonic::Code;

/// Where entries go. Clones write to the same file.
#[derive(Clone, Debug, Default)]
pub struct AuditLog(Option<Arc<LogFile>>);

#[derive(Debug)]
struct LogFile {
    path: PathBuf,
    file: Mutex<File>,
}

/// An entry, as it stands in the file.
#[derive(Serialize)]
struct Line<'a> {
    unix_ms: u64,
    who: &'a str,
    credential: &'a str,
    tenant: Option<&'a str>,
    peer: &'a str,
    call: &'a str,
    job: Option<&'a str>,
    outcome: &'a str,
    why: Option<&'a str>,
}

/// A call and its outcome, as written to the log.
#[derive(Clone, Copy, Debug)]
pub struct Entry<'a> {
    /// Name of the call: `Submit`, or the path of a call that this service does not know.
    pub call: &'a str,
    /// Job that the call is about, if any.
    pub job: Option<&'a str>,
    /// gRPC code of the answer.
    pub code: Code,
    /// Message of the refusal; `None` where the call was not refused.
    pub why: Option<&'a str>,
}

fn open(path: &Path) -> std::io::Result<File> {
    // The log names people and addresses, so only this user may read it.
    let mut options = OpenOptions::new();
    options.append(true).create(true).mode(0o600).open(path)
}

impl AuditLog {
    /// Entries go to this file, too, which is made where it is missing.
    pub fn to_file(path: &Path) -> std::io::Result<Self> {
        Ok(Self(Some(Arc::new(LogFile {
            path: path.to_owned(),
            file: Mutex::new(open(path)?),
        }))))
    }

    /// Opens the file again: it may have been moved away to begin a new one.
    pub fn reopen(&self) {
        let Some(log) = &self.0 else {
            return;
        };
        match open(&log.path) {
            Ok(fresh) => *log.file.lock().unwrap_or_else(PoisonError::into_inner) = fresh,
            Err(error) => {
                tracing::error!(file = %log.path.display(), %error, "the audit log stays where it was");
            }
        }
    }

    /// Writes an entry.
    pub fn record(&self, caller: &Caller, entry: Entry<'_>) {
        let outcome = code_name(entry.code);
        let tenant = caller.tenant.as_ref().map(|tenant| tenant.as_str());
        let (who, credential) = (caller.name.as_str(), caller.credential.0.as_str());
        let Entry { call, job, why, .. } = entry;
        tracing::info!(target: "audit", who, credential, tenant, peer = caller.peer, call, job, outcome, why);
        let Some(log) = &self.0 else {
            return;
        };
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let line = Line {
            unix_ms: since.map_or(0, |since| since.as_millis() as u64),
            who,
            credential,
            tenant,
            peer: &caller.peer,
            call,
            job,
            outcome,
            why,
        };
        let mut text =
            serde_json::to_string(&line).expect("texts and numbers can be written as JSON");
        text.push('\n');
        let mut file = log.file.lock().unwrap_or_else(PoisonError::into_inner);
        // In one write: lines of several writers do not mix.
        if let Err(error) = file.write_all(text.as_bytes()) {
            tracing::error!(file = %log.path.display(), %error, "the audit log could not be written");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn entries_are_lines_of_json_for_the_owner_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("audit.jsonl");
        let log = AuditLog::to_file(&path).unwrap();
        let caller = Caller::untold("local", "127.0.0.1:9");
        let entry = |code, why| Entry {
            call: "Cancel",
            job: Some("00"),
            code,
            why,
        };
        log.record(&caller, entry(Code::Ok, None));
        // Moved away and begun again, as log rotation does.
        let old = folder.path().join("audit.1");
        std::fs::rename(&path, &old).unwrap();
        log.reopen();
        log.record(&caller, entry(Code::NotFound, Some("a \"quoted\"\nline")));
        for (path, outcome) in [(&old, "OK"), (&path, "NOT_FOUND")] {
            let text = std::fs::read_to_string(path).unwrap();
            assert_eq!(text.lines().count(), 1, "{text}");
            let line: serde_json::Value = serde_json::from_str(&text).unwrap();
            assert_eq!(line["outcome"], outcome);
            assert_eq!(line["who"], "local");
            let mode = std::fs::metadata(path).unwrap().permissions().mode();
            assert_eq!(mode & 0o777, 0o600);
        }
    }
}
