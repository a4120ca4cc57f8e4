//! Chaos: jobs on real processes while workers, coordinators and the database are killed or stand
//! still at random, results are damaged or lost, and workers do evil. Every answer must be the undisturbed
//! one, bit for bit, and every worker that does evil must be named; a report says what it cost.
//!
//! `cargo run --release -p cognate-tests --bin chaos -- [--seconds 30] [--seed 1] [--ledger sqlite|postgres]
//! [--coordinators 1] [--katsura 11] [--bits 53] [--pause-ms 500-2000] [--lease-ms 2000] [--jobs N]
//! [--storage-faults yes] [--evil-workers yes]`: jobs in turn for so long, or so many, the last to its end.

mod evil_worker;
mod spoilt_results;

use cognate_protocol::v1::Precision;
use cognate_protocol::v1::precision::Kind;
use cognate_tests::arguments::{number, options as arguments, or_exit};
use cognate_tests::builders::katsura;
use cognate_tests::client::{Answer, Client, Submission, accepted, has_ended, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::database::Database;
use cognate_tests::dice::Dice;
use cognate_tests::processes::{Process, until};
use evil_worker::Evil;
use spoilt_results::spoil;
use std::cell::Cell;
use std::fmt;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// What is promised: work goes on no longer than this after a fault and the length of a lease. A machine with
/// other work may break it now and then, so it is a promise about the median fault ...
const PROMISED: Duration = Duration::from_secs(3);
/// ... and none may take longer than this and the length of a lease, on any machine.
const GOES_ON: Duration = Duration::from_secs(30);
/// One of several coordinators stands still for longer than its right to drive a job, 5 s.
const STANDSTILL: Duration = Duration::from_secs(6);
/// No job takes longer.
const LONGEST: Duration = Duration::from_secs(4 * 3600);
/// Paths of a chunk.
const CHUNK: u64 = 32;
/// Workers that are kept alive.
const WORKERS: usize = 3;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    KillWorker,
    FreezeWorker,
    KillCoordinator,
    FreezeCoordinator,
    KillDatabase,
    SpoilResults,
}

impl Fault {
    const ALL: [Self; 6] = [
        Self::KillWorker,
        Self::FreezeWorker,
        Self::KillCoordinator,
        Self::FreezeCoordinator,
        Self::KillDatabase,
        Self::SpoilResults,
    ];
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::KillWorker => "a worker killed (-9)",
            Self::FreezeWorker => "a worker stopped for longer than its lease",
            Self::KillCoordinator => "a coordinator killed (-9)",
            Self::FreezeCoordinator => "a coordinator stopped for a while",
            Self::KillDatabase => "the database server killed (-9)",
            Self::SpoilResults => "the results of a chunk damaged or lost",
        })
    }
}

/// What is asked for.
struct Wanted {
    seconds: u64,
    seed: u64,
    postgres: bool,
    /// One, or two over one database.
    coordinators: usize,
    /// The end after so many jobs.
    jobs: u64,
    /// Which of Katsura's systems: 2^n paths.
    katsura: usize,
    /// Precision of the tracking; None: as much as each path needs.
    bits: Option<u32>,
    /// Least and greatest pause between two faults, in milliseconds.
    pause_ms: (u64, u64),
    /// How long a lease lasts.
    lease: Duration,
    /// Results are damaged and lost.
    storage_faults: bool,
    /// One worker of each kind that does evil is there, too.
    evil_workers: bool,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        seconds: 30,
        seed: 1,
        postgres: false,
        coordinators: 1,
        jobs: u64::MAX,
        katsura: 11,
        bits: None,
        pause_ms: (500, 2000),
        lease: Duration::from_secs(2),
        storage_faults: false,
        evil_workers: false,
    };
    for (word, value) in arguments()? {
        match word.as_str() {
            "--seconds" => wanted.seconds = number(&word, &value)?,
            "--seed" => wanted.seed = number(&word, &value)?,
            "--ledger" if value == "sqlite" => wanted.postgres = false,
            "--ledger" if value == "postgres" => wanted.postgres = true,
            "--coordinators" => wanted.coordinators = number(&word, &value)?,
            "--jobs" => wanted.jobs = number(&word, &value)?,
            "--katsura" => wanted.katsura = number(&word, &value)?,
            "--bits" => wanted.bits = Some(number(&word, &value)?),
            "--lease-ms" => wanted.lease = Duration::from_millis(number(&word, &value)?),
            "--pause-ms" => wanted.pause_ms = range(&value)?,
            "--storage-faults" => wanted.storage_faults = yes(&word, &value)?,
            "--evil-workers" => wanted.evil_workers = yes(&word, &value)?,
            _ => {
                return Err(format!(
                    "{word} {value}: expected --seconds N, --seed N, --ledger sqlite|postgres, \
                     --coordinators N, --jobs N, --katsura N, --bits N, --pause-ms LEAST-GREATEST, \
                     --lease-ms N, --storage-faults yes|no or --evil-workers yes|no"
                ));
            }
        }
    }
    match (wanted.coordinators, wanted.postgres) {
        (1, _) | (2, true) => Ok(wanted),
        (2, false) => Err("--coordinators 2: two of them need --ledger postgres".to_owned()),
        _ => Err("--coordinators: expected 1 or 2".to_owned()),
    }
}

fn yes(word: &str, value: &str) -> Result<bool, String> {
    match value {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err(format!("{word} {value}: expected yes or no")),
    }
}

/// `LEAST-GREATEST`.
fn range(text: &str) -> Result<(u64, u64), String> {
    let parsed = text.split_once('-').and_then(|(least, greatest)| {
        let range = (least.parse().ok()?, greatest.parse().ok()?);
        (range.0 < range.1).then_some(range)
    });
    parsed.ok_or_else(|| format!("--pause-ms {text}: expected two numbers, for instance 500-2000"))
}

fn problem(wanted: &Wanted) -> Submission {
    let mut problem = Submission::of(katsura(wanted.katsura));
    if let Some(bits) = wanted.bits {
        problem.options.precision = Some(Precision {
            kind: Some(Kind::Bits(bits)),
        });
    }
    problem
}

/// The answer where nothing happens.
fn quiet_answer(problem: &Submission) -> Answer {
    let cluster = Cluster::with_workers(2);
    let client = cluster.client();
    let job = client.submit(problem);
    client.wait_until_solved_for(&job, LONGEST);
    let answer = client.answer(&job);
    cluster.stop();
    answer
}

fn options(wanted: &Wanted, ledger: Option<String>) -> CoordinatorOptions {
    CoordinatorOptions {
        lease: Some(wanted.lease),
        chunk_paths: Some(CHUNK),
        audit_percent: u32::from(wanted.evil_workers),
        ledger,
        ..CoordinatorOptions::default()
    }
}

/// All processes: one coordinator or two, and workers that know both.
struct Scene {
    cluster: Cluster,
    second: Option<(Process, String)>,
    lease: Duration,
    /// Workers that do evil, of which one of each kind is there.
    evil: Vec<(Evil, Process)>,
    /// Results that were damaged or lost: job and file.
    spoilt: Vec<String>,
    /// Logs of workers that are gone.
    logs: Vec<String>,
}

impl Scene {
    fn start(wanted: &Wanted, database: Option<&Database>) -> Self {
        let cluster = Cluster::start(options(wanted, database.map(Database::url)));
        let second = (wanted.coordinators == 2).then(|| cluster.second_coordinator());
        let mut scene = Self {
            cluster,
            second,
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
    fn add_evil_workers(&mut self) {
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

    /// What the coordinators have said.
    fn said(&self) -> String {
        let second = self.second.as_ref().map(|(process, _)| process.log());
        self.cluster.coordinator.log() + &second.unwrap_or_default()
    }

    /// Workers that do evil, have had chunks, and are named nowhere; and those whose forged reports were accepted.
    fn unnamed(&self) -> Vec<String> {
        let said = self.said();
        let warnings: Vec<&str> = said.lines().filter(|line| line.contains("WARN")).collect();
        let mut wrong = Vec::new();
        for (kind, process) in &self.evil {
            let (name, log) = (evil_worker::name(*kind, process.id()), process.log());
            if log.contains("leased ") && !warnings.iter().any(|line| line.contains(&name)) {
                wrong.push(format!("{name} is not named"));
            }
            if log.contains(Evil::BELIEVED) {
                wrong.push(format!("{name}: {}", Evil::BELIEVED));
            }
        }
        wrong
    }

    /// A client of the first coordinator (0) or of the second.
    fn client(&self, which: usize) -> Client {
        match &self.second {
            Some((_, address)) if which == 1 => until("the second coordinator answers", || {
                Client::connect(address)
            }),
            _ => self.cluster.client(),
        }
    }

    /// Of two coordinators the other; of one itself.
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
    fn suffer(
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
            Fault::SpoilResults => {
                let results = self.cluster.folder().join("results");
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

    fn stop(mut self) -> Vec<String> {
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

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let Some(("evil-worker", words)) = words.split_first().map(|(w, rest)| (w.as_str(), rest)) {
        return evil_worker::execute(words);
    }
    let wanted = or_exit(wanted());
    let database = match wanted.postgres.then(Database::start) {
        Some(None) => return ExitCode::SUCCESS,
        Some(Some(database)) => Some(database),
        None => None,
    };
    let database = database.as_ref();
    let began = Instant::now();
    let quiet = quiet_answer(&problem(&wanted));
    println!(
        "without faults: {} paths, {:.0} s",
        quiet.counts.paths_total,
        began.elapsed().as_secs_f64()
    );
    let mut scene = Scene::start(&wanted, database);
    let mut dice = Dice(wanted.seed);
    let (mut jobs, mut paths, mut without_paths) = (0, 0, 0);
    let mut faults: Vec<(Fault, Duration)> = Vec::new();
    let begin = Instant::now();
    let (least, greatest) = wanted.pause_ms;
    while begin.elapsed() < Duration::from_secs(wanted.seconds) && jobs < wanted.jobs {
        if wanted.evil_workers {
            scene.add_evil_workers();
        }
        // Another request each time, or it would be the same job.
        let job = scene.client(0).submit(&problem(&wanted));
        let job_began = Instant::now();
        loop {
            let pause = Duration::from_millis(least + dice.below(greatest - least));
            let next = Instant::now() + pause;
            let mut ended = false;
            while Instant::now() < next && !ended {
                let now = scene.client(0).progress(&job);
                ended = now.is_ok_and(|p| has_ended(&p));
                std::thread::sleep(Duration::from_millis(50));
            }
            if ended {
                break;
            }
            let fault = loop {
                let fault = Fault::ALL[dice.below(6) as usize];
                let possible = match fault {
                    Fault::KillDatabase => database.is_some(),
                    Fault::SpoilResults => wanted.storage_faults,
                    _ => true,
                };
                if possible {
                    break fault;
                }
            };
            let took = scene.suffer(fault, &job, &mut dice, database);
            faults.push((fault, took));
            println!("{fault}: on after {:.2} s", took.as_secs_f64());
        }
        let client = scene.client(0);
        client.wait_until_solved(&job);
        let mut solutions = Vec::new();
        client.each_solution(&job, |solution| solutions.push(solution));
        let mut same = solutions == quiet.solutions && client.counts(&job) == quiet.counts;
        match client.paths(&job) {
            Ok(paths) => same &= paths == quiet.paths,
            // What is damaged after its stage has ended cannot be done again: it is named.
            Err(status) => {
                let named = |spoilt: &String| status.message().contains(spoilt.as_str());
                assert!(scene.spoilt.iter().any(named), "no paths: {status}");
                println!("  its paths: {}", status.message());
                without_paths += 1;
            }
        }
        assert!(
            same,
            "job {job} has another answer than without faults (seed {})",
            wanted.seed
        );
        let end = client.progress(&job).expect("the job is known");
        assert_eq!(accepted(&end), total(&end));
        (jobs, paths) = (jobs + 1, paths + total(&end));
        println!(
            "job {jobs}: {} paths in {:.0} s, as without faults bit for bit",
            total(&end),
            job_began.elapsed().as_secs_f64()
        );
    }
    let evil = scene.evil.len();
    let unnamed = scene.unnamed();
    let spoilt = scene.spoilt.len();
    let logs = scene.stop();
    let found = Found {
        took: begin.elapsed(),
        jobs,
        paths,
        faults,
        logs,
        evil,
        unnamed,
        spoilt,
        without_paths,
    };
    report(&wanted, &found)
}

/// What a run has seen.
struct Found {
    took: Duration,
    jobs: u64,
    paths: u64,
    /// Each with the time until work went on.
    faults: Vec<(Fault, Duration)>,
    /// Logs of the honest workers.
    logs: Vec<String>,
    /// How many workers did evil.
    evil: usize,
    /// What was wrong with how they were treated.
    unnamed: Vec<String>,
    /// How many results were damaged or lost.
    spoilt: usize,
    /// How many jobs have no list of paths because of it, and say so.
    without_paths: usize,
}

/// How many paths the workers began, by their logs.
fn begun(logs: &[String]) -> u64 {
    let range = |line: &str| -> Option<u64> {
        let items = line.split("items=").nth(1)?.split_whitespace().next()?;
        let (first, end) = items.split_once("..")?;
        Some(end.parse::<u64>().ok()? - first.parse::<u64>().ok()?)
    };
    let lines = logs.iter().flat_map(|log| log.lines());
    let lines = lines.filter(|line| line.contains("tracking lease="));
    lines.filter_map(range).sum()
}

fn report(wanted: &Wanted, found: &Found) -> ExitCode {
    let Found {
        took,
        jobs,
        paths,
        faults,
        logs,
        evil,
        unnamed,
        spoilt,
        without_paths,
    } = found;
    let paths = *paths;
    let ledger = if wanted.postgres {
        "PostgreSQL"
    } else {
        "SQLite"
    };
    println!(
        "\nChaos on {ledger}, {} coordinator(s), seed {}, {:.0} s",
        wanted.coordinators,
        wanted.seed,
        took.as_secs_f64()
    );
    println!("  {jobs} jobs, {paths} paths: each answer as without faults, bit for bit");
    for kind in Fault::ALL {
        let mut times: Vec<_> = faults.iter().filter(|f| f.0 == kind).map(|f| f.1).collect();
        times.sort_unstable();
        if let Some(longest) = times.last() {
            println!(
                "  {:>3} x {kind}: work went on after {:.2} s (median), {:.2} s (longest)",
                times.len(),
                times[times.len() / 2].as_secs_f64(),
                longest.as_secs_f64()
            );
        }
    }
    let begun = begun(logs);
    let again = begun.saturating_sub(paths);
    // Each worker holds two chunks; every fault may cost all that are held.
    let held = 2 * WORKERS as u64 * CHUNK;
    let bound = faults.len() as u64 * held + paths / 100;
    println!(
        "  {again} paths tracked again, {:.1} a fault; at most {bound} expected",
        again as f64 / faults.len().max(1) as f64
    );
    let promised = wanted.lease + PROMISED;
    let later = faults.iter().filter(|(_, time)| *time > promised).count();
    println!(
        "  {later} of {} faults took longer than {promised:?}",
        faults.len()
    );
    let limit = wanted.lease + GOES_ON;
    let late = faults.iter().filter(|(_, time)| *time > limit).count();
    if *evil > 0 {
        println!(
            "  {evil} workers that did evil; {} not named",
            unnamed.len()
        );
    }
    if *spoilt > 0 {
        println!(
            "  {spoilt} results damaged or lost; of {without_paths} jobs the paths cannot be listed, which is said"
        );
    }
    let mut broken = unnamed.clone();
    if late > 0 {
        broken.push(format!("{late} faults took longer than {limit:?}"));
    }
    if later > faults.len() / 2 {
        broken.push(format!(
            "most of {} faults took longer than {promised:?}",
            faults.len()
        ));
    }
    // What evil workers and damaged results cost is not theirs.
    let counts = !wanted.evil_workers && !wanted.storage_faults;
    if counts && again > bound {
        broken.push(format!("{again} paths were tracked again"));
    }
    if counts && begun < paths {
        broken.push(format!(
            "the logs show {begun} paths that were begun, of {paths}"
        ));
    }
    for what in &broken {
        println!("  NOT AS PROMISED: {what}");
    }
    match broken.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}
