//! Embedded: a coordinator in this process and workers beside it, for one problem.
//!
//! Everything lives in a folder of its own and ends with this value: workers are
//! killed when it is dropped, and give up by themselves within seconds when the
//! process that holds it is gone.

use super::error::ClientError;
use cognate_coordinator::chunks::leasing::Policy;
use cognate_coordinator::config::{Config, LedgerPlace, ListenAddress, Rules};
use cognate_coordinator::server::{RunningServer, Server};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;
use tempfile::TempDir;
use tokio::process::{Child, Command};

/// A worker without its coordinator ends after so many seconds: the process that started it is gone.
const ORPHAN_SECONDS: &str = "2";

/// Lines of a worker's log that are shown when it died.
const LOG_LINES: usize = 12;

/// A coordinator and its workers.
pub struct Embedded {
    server: RunningServer,
    workers: Vec<Worker>,
    folder: TempDir,
}

/// One worker process, and where its log is.
struct Worker {
    child: Child,
    log: PathBuf,
}

/// Names of the temporary folders begin so.
const PREFIX: &str = "cognate-";
/// A folder that is younger may belong to a solve that begins.
const SWEPT_AFTER: Duration = Duration::from_secs(60);

impl Embedded {
    /// Starts a coordinator on a socket in a new folder, and workers of the same program.
    pub async fn start(workers: u32, threads: Option<u32>) -> Result<Self, ClientError> {
        Self::start_with_page(workers, threads, None).await
    }

    /// The same, with a page for browsers at this address.
    pub async fn start_with_page(
        workers: u32,
        threads: Option<u32>,
        page: Option<&str>,
    ) -> Result<Self, ClientError> {
        sweep(&std::env::temp_dir());
        let folder = tempfile::Builder::new()
            .prefix(PREFIX)
            .tempdir()
            .map_err(|e| local("a temporary folder could not be made", &e))?;
        let config = Config {
            listen: vec![ListenAddress::Unix(socket(folder.path()))],
            page: page.map(str::to_owned),
            ledger: LedgerPlace::Memory,
            results: None,
            rules: Rules {
                policy: Policy {
                    // All workers are this process's own, on one machine: to compare them shows nothing.
                    audit_percent: 0,
                    ..Policy::default()
                },
                ..Rules::default()
            },
            ..Config::default()
        };
        let server = Server::start(config)
            .await
            .map_err(|e| local("the coordinator could not be started", &e))?;
        let program = std::env::current_exe()
            .map_err(|e| local("this program could not be found to start workers", &e))?;
        let threads = threads.unwrap_or_else(|| {
            let cores = std::thread::available_parallelism().map_or(1, |n| n.get() as u32);
            (cores / workers).max(1)
        });
        let mut embedded = Self {
            server,
            workers: vec![],
            folder,
        };
        for number in 1..=workers {
            let worker = embedded.worker(&program, number, threads)?;
            embedded.workers.push(worker);
        }
        Ok(embedded)
    }

    fn worker(&self, program: &Path, number: u32, threads: u32) -> Result<Worker, ClientError> {
        let log = self.folder.path().join(format!("worker-{number}.log"));
        let failed = |e| local("a worker could not be started", &e);
        let file = std::fs::File::create(&log).map_err(failed)?;
        let child = Command::new(program)
            .arg("worker")
            .args(["--coordinator", &self.address()])
            .args(["--threads", &threads.to_string()])
            .args(["--give-up-after", ORPHAN_SECONDS])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(file)
            .kill_on_drop(true)
            .spawn()
            .map_err(failed)?;
        Ok(Worker { child, log })
    }

    /// Where the coordinator listens.
    pub fn address(&self) -> String {
        format!("unix:{}", socket(self.folder.path()).display())
    }

    /// Address of the page for browsers, where one was asked for.
    pub fn page(&self) -> Option<&str> {
        self.server.page.as_deref()
    }

    /// Returns when no worker is left, with the end of the last one's log.
    pub async fn abandoned(&mut self) -> ClientError {
        let mut last = None;
        for worker in &mut self.workers {
            // A worker whose end cannot be seen counts as gone, too.
            let status = worker.child.wait().await.ok();
            last = Some((status, &worker.log));
        }
        let Some((status, log)) = last else {
            return ClientError::Local("there are no workers".into());
        };
        let how = status.map_or_else(|| "unknown".into(), |s| s.to_string());
        let log = std::fs::read_to_string(log).unwrap_or_default();
        let lines: Vec<&str> = log.lines().collect();
        let tail = lines[lines.len().saturating_sub(LOG_LINES)..].join("\n  ");
        ClientError::Local(format!("all workers have ended ({how}):\n  {tail}"))
    }

    /// Stops the workers, then the coordinator; the folder goes with it.
    pub async fn stop(mut self) {
        for worker in &mut self.workers {
            // Paths are pure and the job is over: there is nothing to wait for.
            let _ = worker.child.kill().await;
        }
        self.server.shutdown().await;
    }
}

/// Removes what solves left that were killed: folders of ours with a socket that nobody answers on.
fn sweep(folder: &Path) {
    let left = |path: &Path| {
        let own = std::fs::symlink_metadata(path)?;
        let is_old = own.modified()?.elapsed().is_ok_and(|age| age > SWEPT_AFTER);
        let is_own = own.is_dir() && own.uid() == rustix::process::getuid().as_raw();
        let refused = || {
            let answer = std::os::unix::net::UnixStream::connect(socket(path));
            answer.is_err_and(|e| e.kind() == std::io::ErrorKind::ConnectionRefused)
        };
        Ok::<_, std::io::Error>(is_old && is_own && refused())
    };
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_named = entry.file_name().to_string_lossy().starts_with(PREFIX);
        if is_named && left(&entry.path()).unwrap_or(false) {
            // Somebody else may sweep, too.
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

fn socket(folder: &Path) -> PathBuf {
    folder.join("coordinator.sock")
}

fn local(what: &str, e: &dyn std::error::Error) -> ClientError {
    ClientError::Local(format!("{what}: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    #[test]
    fn what_killed_solves_left_is_swept_and_nothing_else() {
        let all = tempfile::tempdir().unwrap();
        let make = |name: &str, age: u64| {
            let folder = all.path().join(name);
            std::fs::create_dir(&folder).unwrap();
            let listener = std::os::unix::net::UnixListener::bind(socket(&folder)).unwrap();
            let then = SystemTime::now() - Duration::from_secs(age);
            std::fs::File::open(&folder)
                .unwrap()
                .set_modified(then)
                .unwrap();
            (folder, listener)
        };
        let (killed, listener) = make("cognate-killed", 100);
        drop(listener);
        let (begins, listener) = make("cognate-begins", 0);
        drop(listener);
        let (lives, _listener) = make("cognate-lives", 100);
        let (other, listener) = make("other", 100);
        drop(listener);
        sweep(all.path());
        assert!(!killed.exists());
        assert!(begins.exists() && lives.exists() && other.exists());
    }
}
