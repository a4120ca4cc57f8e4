//! Scene: the processes of a run, and the faults that are done to them.

use crate::evil_worker::{self, Evil};
use crate::fault::Fault;
use crate::spoilt_results::spoil;
use crate::wanted::Wanted;
use cognate_tests::client::{Client, accepted, has_ended};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::database::Database;
use cognate_tests::dice::Dice;
use cognate_tests::processes::{Process, until};
use cognate_tests::storage::Storage;
use std::cell::Cell;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Longest time, after a fault and the length of a lease, until work goes on. A machine with other work may break this
/// promise now and then, so it holds for the median fault.
pub const PROMISED: Duration = Duration::from_secs(3);
/// Time that one of several coordinators stands still: longer than its right to drive a job, 5 s.
const STANDSTILL: Duration = Duration::from_secs(6);
/// The server of the results is away for this time.
const STORAGE_AWAY: Duration = Duration::from_secs(2);
/// Paths of a chunk.
pub const CHUNK: u64 = 32;
/// Workers that are kept alive.
pub const WORKERS: usize = 3;

/// Prefix of the results in a bucket.
const PREFIX: &str = "chaos";

fn options(
    wanted: &Wanted,
    ledger: Option<String>,
    storage: Option<&Storage>,
) -> CoordinatorOptions {
    CoordinatorOptions {
        results: storage.map(|storage| storage.address(PREFIX)),
        environment: storage.map(Storage::environment).unwrap_or_default(),
        lease: Some(wanted.lease),
        chunk_paths: Some(CHUNK),
        audit_percent: u32::from(wanted.evil_workers),
        ledger,
        ..CoordinatorOptions::default()
    }
}

/// All processes: one coordinator or two, and workers that know both.
pub struct Scene {
    cluster: Cluster,
    second: Option<(Process, String)>,
    storage: Option<Storage>,
    lease: Duration,
    /// Workers that do evil, of which one of each kind is there.
    pub evil: Vec<(Evil, Process)>,
    /// Results that were damaged or lost: job and file.
    pub spoilt: Vec<String>,
    /// Logs of workers that are gone.
    logs: Vec<String>,
}

impl Scene {
    /// Starts them, with as many workers as are kept alive.
    pub fn start(wanted: &Wanted, database: Option<&Database>, storage: Option<Storage>) -> Self {
        let ledger = database.map(Database::url);
        let cluster = Cluster::start(options(wanted, ledger, storage.as_ref()));
        let second = (wanted.coordinators == 2).then(|| cluster.second_coordinator());
        let mut scene = Self {
            cluster,
            second,
            storage,
            lease: wanted.lease,
            evil: Vec::new(),
            spoilt: Vec::new(),
            logs: Vec::new(),
        };
        for _ in 0..WORKERS {
            scene.add_worker();
        }
        scene
    }

    fn add_worker(&mut self) {
        self.cluster.add_worker(&WorkerOptions {
            lane_width: Some(1),
            second: self.second.as_ref().map(|(_, address)| address.clone()),
            ..WorkerOptions::default()
        });
    }

    /// Where the coordinators listen.
    fn addresses(&self) -> String {
        let first = self.cluster.address();
        match &self.second {
            Some((_, second)) => format!("{first},{second}"),
            None => first,
        }
    }

    /// Starts a worker of each kind that does evil, where none is there or it gets no more work.
    pub fn add_evil_workers(&mut self) {
        for kind in Evil::ALL {
            let there =
                |(other, process): &mut (Evil, Process)| *other == kind && process.is_alive();
            if !self.evil.iter_mut().any(there) {
                let number = self.evil.len();
                let words = ["evil-worker".to_owned(), kind.to_string(), self.addresses()];
                let log = format!("evil-{number}");
                let process = Process::start_again(self.cluster.folder(), &log, &words);
                self.evil.push((kind, process));
            }
        }
    }

    /// Logs of the coordinators.
    fn said(&self) -> String {
        let second = self.second.as_ref().map(|(process, _)| process.log());
        self.cluster.coordinator.log() + &second.unwrap_or_default()
    }

    /// Workers that do evil, have had chunks enough, and are named nowhere; and those whose forged reports were accepted.
    pub fn unnamed(&self) -> Vec<String> {
        let said = self.said();
        let warnings: Vec<&str> = said.lines().filter(|line| line.contains("WARN")).collect();
        let mut wrong = Vec::new();
        for (kind, process) in &self.evil {
            let (name, log) = (evil_worker::name(*kind, process.id()), process.log());
            let said = |what: &str| {
                let lines = log.lines().filter_map(|line| line.strip_prefix(what));
                lines.map(str::to_owned).collect::<BTreeSet<String>>()
            };
            let leases = said(Evil::LEASED);
            let chunks = leases.len();
            if chunks >= kind.found_out_after() && !warnings.iter().any(|line| line.contains(&name))
            {
                wrong.push(format!("{name} is not named"));
            }
            for lease in said(Evil::BELIEVED).difference(&leases) {
                wrong.push(format!("{name}: {}{lease}", Evil::BELIEVED));
            }
        }
        wrong
    }

    /// A client of the first coordinator (0) or of the second.
    pub fn client(&self, which: usize) -> Client {
        match &self.second {
            Some((_, address)) if which == 1 => until("the second coordinator answers", || {
                Client::connect(address)
            }),
            _ => self.cluster.client(),
        }
    }

    /// Number of the other coordinator if there are two; else 0.
    fn other(&self, which: usize) -> usize {
        if self.second.is_some() { 1 - which } else { 0 }
    }

    fn coordinator(&mut self, which: usize) -> &mut Process {
        match &mut self.second {
            Some((process, _)) if which == 1 => process,
            _ => &mut self.cluster.coordinator,
        }
    }

    fn restart(&mut self, which: usize) {
        if which == 1 {
            self.second = Some(self.cluster.second_coordinator());
        } else {
            self.cluster.restart_coordinator();
        }
    }

    /// Makes this go wrong while `job` runs; how long it took until the job went on.
    pub fn suffer(
        &mut self,
        fault: Fault,
        job: &str,
        dice: &mut Dice,
        database: Option<&Database>,
    ) -> Duration {
        let which = dice.below(1 + u64::from(self.second.is_some())) as usize;
        let victim = dice.below(WORKERS as u64) as usize;
        let before = self.client(0).progress(job).map_or(0, |p| accepted(&p));
        let mut since = Instant::now();
        match fault {
            Fault::KillWorker => {
                let mut killed = self.cluster.workers.remove(victim);
                killed.kill();
                self.logs.push(killed.log());
                self.add_worker();
            }
            Fault::FreezeWorker => {
                self.cluster.workers[victim].freeze();
                std::thread::sleep(self.lease + Duration::from_millis(500));
                self.cluster.workers[victim].thaw();
            }
            // Of two coordinators the other goes on alone, before the first is there again.
            Fault::KillCoordinator if self.second.is_some() => {
                self.coordinator(which).kill();
                let took = self.goes_on(self.other(which), job, before, since);
                self.restart(which);
                return took;
            }
            Fault::KillCoordinator => {
                self.coordinator(which).kill();
                self.restart(which);
            }
            Fault::FreezeCoordinator if self.second.is_some() => {
                self.coordinator(which).freeze();
                let took = self.goes_on(self.other(which), job, before, since);
                std::thread::sleep(STANDSTILL.saturating_sub(since.elapsed()));
                self.coordinator(which).thaw();
                return took;
            }
            Fault::FreezeCoordinator => {
                self.coordinator(which).freeze();
                std::thread::sleep(Duration::from_secs(1));
                self.coordinator(which).thaw();
                since = Instant::now();
            }
            Fault::KillDatabase => {
                if let Some(database) = database {
                    database.kill_and_start();
                    since = Instant::now();
                }
            }
            Fault::KillStorage => {
                if let Some(storage) = &self.storage {
                    storage.kill();
                    std::thread::sleep(STORAGE_AWAY);
                    storage.start_again();
                    since = Instant::now();
                }
            }
            Fault::SpoilResults => {
                let folder = || self.cluster.folder().join("results");
                let files = self.storage.as_ref().map(|storage| storage.files(PREFIX));
                let results = files.unwrap_or_else(folder);
                let (said, name) = spoil(&results, job, dice);
                println!("  {said}");
                self.spoilt.extend(name.map(|name| format!("{job}/{name}")));
                return Duration::ZERO;
            }
        }
        self.goes_on(0, job, before, since)
    }

    /// Waits until another chunk is accepted or the job has ended; how long that took. Where it takes
    /// longer than promised, says what there was to see meanwhile.
    fn goes_on(&self, which: usize, job: &str, before: u64, since: Instant) -> Duration {
        let client = self.client(which);
        let told = Cell::new(self.lease + Duration::from_secs(1));
        client.progress_once(job, "work goes on", |p| {
            if since.elapsed() > told.get() {
                told.set(told.get() + Duration::from_secs(1));
                for stage in p.stages.iter().filter(|s| s.accepted < s.total) {
                    println!(
                        "  {:.1} s: stage {} has {} items ready, {} with workers, {} done",
                        since.elapsed().as_secs_f64(),
                        stage.stage,
                        stage.ready,
                        stage.leased,
                        stage.accepted
                    );
                }
            }
            has_ended(p) || accepted(p) > before
        });
        let took = since.elapsed();
        if took > self.lease + PROMISED {
            self.show_logs();
        }
        took
    }

    /// The last lines of all logs.
    fn show_logs(&self) {
        let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
        println!("  later than promised; load {}", load.trim());
        let second = self.second.iter().map(|(process, _)| process);
        let coordinators = std::iter::once(&self.cluster.coordinator).chain(second);
        for process in coordinators.chain(&self.cluster.workers) {
            let log = process.log();
            let lines: Vec<&str> = log.lines().collect();
            for line in &lines[lines.len().saturating_sub(25)..] {
                println!("    {}: {line}", process.name());
            }
        }
    }

    /// Stops all; the logs of all honest workers.
    pub fn stop(mut self) -> Vec<String> {
        let mut logs = self.logs;
        logs.extend(self.cluster.workers.iter().map(Process::log));
        if let Some((process, _)) = &mut self.second {
            process.terminate();
            process.wait(cognate_tests::processes::PATIENCE);
        }
        self.cluster.stop();
        logs
    }
}
