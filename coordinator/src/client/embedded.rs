//! Embedded: a coordinator in this process and workers beside it, for one problem.
//!
//! Everything lives in a folder of its own and ends with this value: workers are
//! killed when it is dropped, and give up by themselves within seconds when the
//! process that holds it is gone.

use super::error::ClientError;
use crate::config::{Config, LedgerPlace, ListenAddress};
use crate::server::{RunningServer, Server};
use std::path::{Path, PathBuf};
use std::process::Stdio;
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

impl Embedded {
    /// Starts a coordinator on a socket in a new folder, and workers of the same program.
    pub async fn start(workers: u32, threads: Option<u32>) -> Result<Self, ClientError> {
        let folder = tempfile::Builder::new()
            .prefix("cognate-")
            .tempdir()
            .map_err(|e| local("a temporary folder could not be made", &e))?;
        let config = Config {
            listen: vec![ListenAddress::Unix(socket(folder.path()))],
            ledger: LedgerPlace::Memory,
            results: None,
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

fn socket(folder: &Path) -> PathBuf {
    folder.join("coordinator.sock")
}

fn local(what: &str, e: &dyn std::error::Error) -> ClientError {
    ClientError::Local(format!("{what}: {e}"))
}
