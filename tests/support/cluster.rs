//! Cluster: a coordinator, its ledger on disk and some workers, as processes of one test.

use crate::client::{Client, JOB_PATIENCE, accepted};
use crate::processes::{PATIENCE, Process, until};
use cognate_protocol::v1::JobProgress;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Shortest and longest time for which workers go on between two looks at a job that waits for its disturbance.
const SHORTEST_PAUSE: Duration = Duration::from_millis(2);
const LONGEST_PAUSE: Duration = Duration::from_millis(200);

/// How the coordinator of a test differs from the default.
#[derive(Clone, Debug, Default)]
pub struct CoordinatorOptions {
    /// How long a lease lasts.
    pub lease: Option<Duration>,
    /// Every chunk has this many paths.
    pub chunk_paths: Option<u64>,
    /// Where the ledger is; else in a file of the test's folder.
    pub ledger: Option<String>,
    /// Where the results are; else in the same folder.
    pub results: Option<String>,
    /// Names and values in the environment of coordinators and of what [`Cluster::command`] runs.
    pub environment: Vec<(String, String)>,
    /// The folder of ledger and results; else the test's.
    pub data: Option<PathBuf>,
    /// Further addresses to listen on, without asking who calls.
    pub listen: Vec<String>,
    /// Where metrics are served: host and port.
    pub metrics: Option<String>,
    /// Words before the command (see `namespaces`).
    pub within: Vec<String>,
    /// Free memory in /dev/shm below which workers do not use it, in MiB.
    pub least_free_mib: Option<u64>,
    /// Percentage of chunks that are tracked by two workers. It is 0 by default, because tests that count do not expect
    /// them.
    pub audit_percent: u32,
    /// Largest number of operations in which planning counts mixed cells.
    pub counting_operations: Option<u64>,
    /// Time that objects stay in the trash, and the interval between two looks at everything.
    pub garbage: Option<Duration>,
}

impl CoordinatorOptions {
    /// The coordinator's configuration file.
    fn config(&self) -> String {
        // Tests run where little is free, too.
        let mib = self.least_free_mib.unwrap_or(16);
        let mut text = format!("shared_memory_least_free_mib = {mib}\n");
        text += &format!("[rules]\naudit_percent = {}\n", self.audit_percent);
        if let Some(lease) = self.lease {
            let seconds = lease.as_secs_f64();
            text += &format!("lease_seconds = {seconds:?}\nexpiry_interval_seconds = 0.1\n");
        }
        if let Some(operations) = self.counting_operations {
            text += &format!("counting_operations = {operations}\n");
        }
        if let Some(time) = self.garbage {
            let hours = time.as_secs_f64() / 3600.0;
            text += &format!("garbage_grace_hours = {hours:?}\n");
            text += &format!("garbage_interval_hours = {hours:?}\n");
        }
        if let Some(paths) = self.chunk_paths {
            // As much work as nobody has, but no more paths than these.
            text += &format!("[chunks]\nfirst_items = {paths}\nmost_items = {paths}\n");
            text += "shortest_ms = 1000000\nshared_ms = 1000000\nlongest_ms = 1000000\n";
        }
        text
    }
}

/// How a worker of a test differs from the default.
#[derive(Clone, Debug)]
pub struct WorkerOptions {
    /// Threads that track.
    pub threads: usize,
    /// Lanes of each.
    pub lane_width: Option<u32>,
    /// Transport of the worker; `None` leaves the choice to the worker.
    pub transport: Option<&'static str>,
    /// A second address to ask.
    pub second: Option<String>,
    /// The address to ask in place of the coordinator's socket.
    pub coordinator: Option<String>,
    /// Words before the command (see `namespaces`).
    pub within: Vec<String>,
}

impl Default for WorkerOptions {
    /// One thread: tests run beside one another.
    fn default() -> Self {
        Self {
            threads: 1,
            lane_width: None,
            transport: None,
            second: None,
            coordinator: None,
            within: Vec::new(),
        }
    }
}

/// A coordinator with its ledger, and workers.
pub struct Cluster {
    /// The coordinator's process.
    pub coordinator: Process,
    /// The workers' processes.
    pub workers: Vec<Process>,
    options: CoordinatorOptions,
    workers_started: usize,
    // The folder goes last: the processes use it until they end.
    folder: TempDir,
}

impl Cluster {
    /// Starts a coordinator on an empty ledger; it answers when this returns.
    ///
    /// # Panics
    /// When it does not answer.
    pub fn start(options: CoordinatorOptions) -> Self {
        let folder = TempDir::new().expect("a temporary folder");
        let coordinator = start_coordinator(folder.path(), "coordinator", &options);
        let cluster = Self {
            coordinator,
            workers: Vec::new(),
            options,
            workers_started: 0,
            folder,
        };
        cluster.client();
        cluster
    }

    /// A coordinator and some workers with default options.
    pub fn with_workers(workers: usize) -> Self {
        let mut cluster = Self::start(CoordinatorOptions::default());
        for _ in 0..workers {
            cluster.add_worker(&WorkerOptions::default());
        }
        cluster
    }

    /// Where the coordinator listens: a socket in the test's folder, the same after a restart.
    pub fn address(&self) -> String {
        address(self.folder.path(), "coordinator")
    }

    /// The test's folder.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Starts one more worker.
    pub fn add_worker(&mut self, options: &WorkerOptions) {
        let worker = self.start_worker(options);
        self.workers.push(worker);
    }

    /// Starts one more worker, which is the caller's to stop.
    pub fn start_worker(&mut self, options: &WorkerOptions) -> Process {
        self.workers_started += 1;
        let first = options.coordinator.clone();
        let first = first.unwrap_or_else(|| self.address());
        let mut arguments = vec![
            "worker".to_owned(),
            "--coordinator".to_owned(),
            match &options.second {
                Some(second) => format!("{first},{second}"),
                None => first,
            },
            "--threads".to_owned(),
            options.threads.to_string(),
        ];
        if let Some(width) = options.lane_width {
            arguments.extend(["--lane-width".to_owned(), width.to_string()]);
        }
        if let Some(transport) = options.transport {
            arguments.extend(["--transport".to_owned(), transport.to_owned()]);
        }
        let name = format!("worker-{}", self.workers_started);
        Process::start_within(&options.within, &[], self.folder.path(), &name, &arguments)
    }

    /// `kill -9` for the coordinator.
    pub fn kill_coordinator(&mut self) {
        self.coordinator.kill();
    }

    /// A new coordinator on the same ledger; it answers when this returns.
    ///
    /// # Panics
    /// When the old one still runs, or the new one does not answer.
    pub fn restart_coordinator(&mut self) {
        assert!(
            !self.coordinator.is_alive(),
            "the old one must be gone first"
        );
        self.coordinator = start_coordinator(self.folder.path(), "coordinator", &self.options);
        self.client();
    }

    /// A second coordinator on the same ledger and results, which must be a database's; and where
    /// it listens.
    ///
    /// # Panics
    /// When it does not answer.
    pub fn second_coordinator(&self) -> (Process, String) {
        let process = start_coordinator(self.folder.path(), "second", &self.options);
        let address = address(self.folder.path(), "second");
        until("the second coordinator answers", || {
            Client::connect(&address)
        });
        (process, address)
    }

    /// Does `disturb` at the first moment at which `holds` is true of the progress of the job. Workers stand still
    /// while progress is asked for and until the disturbance is done, so that a short stage is met in its middle
    /// whatever load the machine has.
    ///
    /// # Panics
    /// When it does not hold in time.
    pub fn disturb_once(
        &mut self,
        job: &str,
        what: &str,
        holds: impl Fn(&JobProgress) -> bool,
        disturb: impl FnOnce(&mut Self, &JobProgress),
    ) {
        let client = self.client();
        let begin = Instant::now();
        let (mut items, mut pause) = (0, SHORTEST_PAUSE);
        while begin.elapsed() < JOB_PATIENCE {
            self.workers.iter_mut().for_each(Process::freeze);
            let progress = client.progress(job).ok();
            if let Some(progress) = progress.as_ref().filter(|&progress| holds(progress)) {
                disturb(self, progress);
                self.workers.iter_mut().for_each(Process::thaw);
                return;
            }
            self.workers.iter_mut().for_each(Process::thaw);
            // On a busy machine a worker does nothing within a short pause.
            let present_items = progress.as_ref().map_or(0, accepted);
            pause = if present_items == items {
                LONGEST_PAUSE.min(2 * pause)
            } else {
                SHORTEST_PAUSE
            };
            items = present_items;
            std::thread::sleep(pause);
        }
        panic!("{what}: not within {JOB_PATIENCE:?}");
    }

    /// A client of the coordinator.
    ///
    /// # Panics
    /// When the coordinator does not answer.
    pub fn client(&self) -> Client {
        let address = self.address();
        until("the coordinator answers", || Client::connect(&address))
    }

    /// Runs `cognate` with these arguments and this coordinator, to its end.
    ///
    /// # Panics
    /// When it cannot be started.
    pub fn command(&self, arguments: &[&str]) -> Output {
        Command::new(crate::processes::cognate())
            .args(arguments)
            .env("COGNATE_COORDINATOR", self.address())
            .envs(self.options.environment.iter().cloned())
            .current_dir(self.folder.path())
            .output()
            .expect("cognate can be started")
    }

    /// Tells every process to stop and checks that each does so, with exit code 0.
    ///
    /// # Panics
    /// When one of them does not.
    pub fn stop(mut self) {
        for process in &mut self.workers {
            process.terminate();
            let status = process.wait(PATIENCE);
            assert_eq!(status.code(), Some(0), "a drained worker ends well");
        }
        self.coordinator.terminate();
        let status = self.coordinator.wait(PATIENCE);
        assert_eq!(status.code(), Some(0), "a stopped coordinator ends well");
    }
}

fn address(folder: &Path, name: &str) -> String {
    format!("unix:{}", folder.join(format!("{name}.sock")).display())
}

fn start_coordinator(folder: &Path, name: &str, options: &CoordinatorOptions) -> Process {
    let data = options.data.as_deref().unwrap_or(folder);
    let file = || format!("sqlite:{}", data.join("ledger.db").display());
    let results = || data.join("results").display().to_string();
    let mut arguments = vec![
        "coordinator".to_owned(),
        "--listen".to_owned(),
        address(folder, name),
        "--ledger".to_owned(),
        options.ledger.clone().unwrap_or_else(file),
        "--results".to_owned(),
        options.results.clone().unwrap_or_else(results),
    ];
    for address in &options.listen {
        arguments.extend(["--listen".to_owned(), address.clone()]);
    }
    if let Some(address) = &options.metrics {
        arguments.extend(["--metrics".to_owned(), address.clone()]);
    }
    if !options.listen.is_empty() {
        arguments.push("--insecure".to_owned());
    }
    let config = folder.join(format!("{name}.toml"));
    std::fs::write(&config, options.config()).expect("the test's folder is writable");
    arguments.extend(["--config".to_owned(), config.display().to_string()]);
    let (within, environment) = (&options.within, &options.environment);
    Process::start_within(within, environment, folder, name, &arguments)
}
