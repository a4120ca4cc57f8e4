//! Embedded: a coordinator in this process for one problem, and what works for it.
//!
//! Most problems are solved before a process could have been started. So a worker in this process begins, called
//! without a socket; a problem that lasts gets worker processes, which take over from it. Everything that these need
//! lives in a folder of its own and ends with this value: workers are killed when it is dropped, and give up by
//! themselves within seconds when the process that holds it is gone.

use super::connection::Target;
use super::error::ClientError;
use super::interruption::unless_interrupted;
use cognate_coordinator::chunks::leasing::Policy;
use cognate_coordinator::config::{Config, LedgerPlace, ListenAddress, Rules};
use cognate_coordinator::server::{RunningServer, Server};
use cognate_worker::transport::shared_memory::place::LEAST_FREE;
use cognate_worker::{config, shell};
use futures::future::select_all;
use std::fs::Permissions;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt, PermissionsExt};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};
use std::time::Duration;
use tempfile::TempDir;
use tokio::process::{Child, Command};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// Worker processes where no number is named.
const WORKERS: u32 = 2;

/// Time that the worker in this process works alone. It is as fast as a process, but a fault that ends it ends the
/// whole program.
const ALONE: Duration = Duration::from_millis(250);
/// Time that the worker in this process has to finish its chunks once it takes no new ones.
const FINISH: Duration = Duration::from_secs(20);

/// Seconds after which a worker without its coordinator ends: the process that started it is gone.
const ORPHAN_SECONDS: &str = "2";

/// Largest number of killed workers that are started again in one solve. A path that no worker survives kills three for
/// each size of its chunk, from 512 paths to 1, until it is given up (`Policy::suspicion_limit`, `split_into`).
const MOST_RESTARTS: u32 = 12;

/// Lines of a worker's log that are shown when it died.
const LOG_LINES: usize = 12;

/// A coordinator and its workers.
pub struct Embedded {
    server: RunningServer,
    /// The worker in this process.
    alone: Option<Alone>,
    wanted: u32,
    threads: u32,
    workers: Vec<Worker>,
    /// Worker processes that were started so far; they are numbered from 1.
    started: u32,
    folder: Option<TempDir>,
}

/// A worker in this process.
struct Alone {
    stop: CancellationToken,
    /// How it ended, once it has.
    ended: JoinHandle<Result<(), String>>,
}

/// A worker process with its log.
struct Worker {
    number: u32,
    child: Child,
    log: PathBuf,
}

/// How a worker process ended; nothing where that cannot be seen.
type End = Option<ExitStatus>;

/// Names of the temporary folders begin so.
const PREFIX: &str = "cognate-";
/// A folder that is younger may belong to a solve that begins.
const SWEPT_AFTER: Duration = Duration::from_secs(60);

impl Embedded {
    /// Starts a coordinator, and `workers` worker processes of this program. If no number is given, they are started by
    /// [`Self::tend`] once a worker in this process has worked for a while.
    pub async fn start(workers: Option<u32>, threads: Option<u32>) -> Result<Self, ClientError> {
        Self::start_with_page(workers, threads, None).await
    }

    /// Starts a coordinator with workers as [`Self::start`] does, and a page for browsers at the address `page`.
    pub async fn start_with_page(
        workers: Option<u32>,
        threads: Option<u32>,
        page: Option<&str>,
    ) -> Result<Self, ClientError> {
        let wanted = workers.unwrap_or(WORKERS);
        let threads = threads.unwrap_or_else(|| (cores() / wanted).max(1));
        let mut embedded = Self::without_workers(wanted, threads, page).await?;
        match workers {
            Some(_) => embedded.start_workers().await?,
            None => {
                let work_time = ALONE + FINISH;
                embedded.start_alone(Some(work_time));
            }
        }
        Ok(embedded)
    }

    /// Starts a coordinator with a worker in this process that works alone to the end: for programs of which no copy can
    /// be started as a worker. `threads`: of the worker, as many as there are cores if it is not given.
    pub async fn start_in_process(threads: Option<u32>) -> Result<Self, ClientError> {
        let threads = threads.unwrap_or_else(cores);
        let mut embedded = Self::without_workers(1, threads, None).await?;
        embedded.start_alone(None);
        Ok(embedded)
    }

    /// Starts a coordinator for `wanted` workers of `threads` threads each, and none of them.
    async fn without_workers(
        wanted: u32,
        threads: u32,
        page: Option<&str>,
    ) -> Result<Self, ClientError> {
        let config = Config {
            listen: vec![],
            shared_memory: None,
            page: page.map(str::to_owned),
            ledger: LedgerPlace::Memory,
            results: None,
            rules: Rules {
                policy: Policy {
                    // All workers are this process's own, on one machine: to compare them shows nothing.
                    audit_percent: 0,
                    unchecked_audit_percent: 0,
                    check_results: false,
                    ..Policy::default()
                },
                ..Rules::default()
            },
            ..Config::default()
        };
        let server = Server::start_in_process(config)
            .await
            .map_err(|e| local("the coordinator could not be started", &e))?;
        Ok(Self {
            server,
            alone: None,
            wanted,
            threads,
            workers: vec![],
            started: 0,
            folder: None,
        })
    }

    /// A worker in this process, with as many threads as the processes will have together; it works for this time, or to
    /// the end.
    fn start_alone(&mut self, work_time: Option<Duration>) {
        let config = config::Config {
            threads: self.wanted.saturating_mul(self.threads) as usize,
            wall_time: work_time,
            wind_up: FINISH,
            ..config::Config::new(vec![])
        };
        let stop = CancellationToken::new();
        let work = shell::run_in_process(config, self.server.services(), stop.clone());
        let ended = tokio::spawn(async {
            let ended = work.await.map(|_| ());
            ended.map_err(|error| error.to_string())
        });
        self.alone = Some(Alone { stop, ended });
    }

    /// Worker processes, on a socket in a new folder.
    async fn start_workers(&mut self) -> Result<(), ClientError> {
        sweep(&std::env::temp_dir());
        let folder = tempfile::Builder::new()
            .prefix(PREFIX)
            .permissions(Permissions::from_mode(0o700))
            .tempdir()
            .map_err(|e| local("a temporary folder could not be made", &e))?;
        let address = ListenAddress::Unix(socket(folder.path()));
        let listens = self.server.listen_at(&address).await;
        listens.map_err(|e| local("the coordinator could not be reached by workers", &e))?;
        self.server.offer_shared_memory(LEAST_FREE);
        self.folder = Some(folder);
        for _ in 0..self.wanted {
            self.start_worker()?;
        }
        Ok(())
    }

    /// Starts one more worker process, in the folder of the others.
    fn start_worker(&mut self) -> Result<(), ClientError> {
        let Some(folder) = &self.folder else {
            return Err(ClientError::Local("there is no folder for workers".into()));
        };
        let program = std::env::current_exe()
            .map_err(|e| local("this program could not be found to start workers", &e))?;
        let worker = self.worker(&program, folder.path(), self.started + 1)?;
        self.started = worker.number;
        self.workers.push(worker);
        Ok(())
    }

    fn worker(&self, program: &Path, folder: &Path, number: u32) -> Result<Worker, ClientError> {
        let log = folder.join(format!("worker-{number}.log"));
        let failed = |e| local("a worker could not be started", &e);
        // It names files and jobs of this user.
        let file = std::fs::File::options()
            .write(true)
            .create_new(true)
            .mode(0o600)
            .open(&log)
            .map_err(failed)?;
        let address = format!("unix:{}", socket(folder).display());
        let child = Command::new(program)
            .arg("worker")
            .args(["--coordinator", &address])
            .args(["--threads", &self.threads.to_string()])
            .args(["--give-up-after", ORPHAN_SECONDS])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(file)
            .kill_on_drop(true)
            .spawn()
            .map_err(failed)?;
        Ok(Worker { number, child, log })
    }

    /// Where calls go.
    pub fn target(&self) -> Target {
        Target::Here(self.server.services())
    }

    /// Address of the page for browsers, where one was asked for.
    pub fn page(&self) -> Option<&str> {
        self.server.page.as_deref()
    }

    /// Does this work while workers are tended; ends it where nobody works any more, or somebody interrupts it.
    pub async fn attend<T>(
        &mut self,
        work: impl Future<Output = Result<T, ClientError>>,
    ) -> Result<T, ClientError> {
        tokio::select! {
            ended = unless_interrupted(work) => ended,
            error = self.tend() => Err(error),
        }
    }

    /// Does this work, or ends it where the worker in this process has ended. No signal is caught.
    pub async fn attend_in_process<T>(
        &mut self,
        work: impl Future<Output = Result<T, ClientError>>,
    ) -> Result<T, ClientError> {
        let Some(alone) = &mut self.alone else {
            return Err(ClientError::Local("there are no workers".into()));
        };
        tokio::select! {
            done = work => done,
            ended = &mut alone.ended => {
                let reason = match ended {
                    Ok(Ok(())) => "it was told to stop".to_owned(),
                    Ok(Err(error)) => error,
                    Err(error) => error.to_string(),
                };
                Err(ClientError::Local(format!("the worker in this process has ended: {reason}")))
            }
        }
    }

    /// Has worker processes take over in time. Returns when nobody works any more, with the reason.
    async fn tend(&mut self) -> ClientError {
        if self.alone.is_some() {
            tokio::time::sleep(ALONE).await;
            if let Err(error) = self.start_workers().await {
                return error;
            }
        }
        self.abandoned().await
    }

    /// Starts workers again that are killed, so often at most. Returns when no worker is left, with the end of the last
    /// one's log.
    async fn abandoned(&mut self) -> ClientError {
        let mut restarts = 0;
        let mut last = None;
        while let Some((worker, end)) = self.first_to_end().await {
            let is_killed = end.is_some_and(|status| status.signal().is_some());
            if is_killed && restarts < MOST_RESTARTS {
                restarts += 1;
                eprintln!(
                    "warning: worker {} was killed ({}); another one is started in its place ({restarts} of at most \
                     {MOST_RESTARTS}), and what it held is done again",
                    worker.number,
                    how(end)
                );
                if let Err(error) = self.start_worker() {
                    return error;
                }
            }
            last = Some((worker, end));
        }
        let Some((worker, end)) = last else {
            return ClientError::Local("there are no workers".into());
        };
        let started_again = match restarts {
            0 => String::new(),
            1 => "; one was started again".to_owned(),
            several => format!("; {several} were started again"),
        };
        let log = std::fs::read_to_string(&worker.log).unwrap_or_default();
        let lines: Vec<&str> = log.lines().collect();
        let tail = lines[lines.len().saturating_sub(LOG_LINES)..].join("\n  ");
        let how = how(end);
        ClientError::Local(format!(
            "all workers have ended ({how}){started_again}:\n  {tail}"
        ))
    }

    /// The worker that ends first, which is removed from the others, and how it ended; nothing where there is none.
    async fn first_to_end(&mut self) -> Option<(Worker, End)> {
        let ends = self.workers.iter_mut();
        let ends: Vec<_> = ends.map(|worker| Box::pin(worker.child.wait())).collect();
        if ends.is_empty() {
            return None;
        }
        let (status, place, _) = select_all(ends).await;
        // A worker whose end cannot be seen counts as gone, too.
        Some((self.workers.remove(place), status.ok()))
    }

    /// Stops the workers, then the coordinator; the folder goes with it.
    pub async fn stop(mut self) {
        if let Some(alone) = self.alone.take() {
            alone.stop.cancel();
        }
        for worker in &mut self.workers {
            // Paths are pure and the job is over: there is nothing to wait for.
            let _ = worker.child.kill().await;
        }
        self.server.shutdown().await;
    }
}

/// How a worker process ended, in words.
fn how(end: End) -> String {
    end.map_or_else(|| "unknown".to_owned(), |status| status.to_string())
}

fn cores() -> u32 {
    std::thread::available_parallelism().map_or(1, |n| n.get() as u32)
}

/// Removes what solves left that were killed: folders of ours with a socket that nobody answers on.
fn sweep(folder: &Path) {
    let left = |path: &Path| {
        let metadata = std::fs::symlink_metadata(path)?;
        let is_old = metadata
            .modified()?
            .elapsed()
            .is_ok_and(|age| age > SWEPT_AFTER);
        let is_own = metadata.is_dir() && metadata.uid() == rustix::process::getuid().as_raw();
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
        let solve_folders = tempfile::tempdir().unwrap();
        let make = |name: &str, age: u64| {
            let folder = solve_folders.path().join(name);
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
        sweep(solve_folders.path());
        assert!(!killed.exists());
        assert!(begins.exists() && lives.exists() && other.exists());
    }
}
