//! Chaos: jobs on real processes while workers, coordinators and the database are killed or stand
//! still at random. Every answer must be the undisturbed one, bit for bit; a report says what it cost.
//!
//! `cargo run --release -p cognate-tests --bin chaos -- [--seconds 30] [--seed 1] [--ledger sqlite|postgres]
//! [--katsura 11] [--bits 53] [--pause-ms 500-2000] [--lease-ms 2000]`: jobs in turn for so long, the
//! last to its end.

use cognate_protocol::v1::Precision;
use cognate_protocol::v1::precision::Kind;
use cognate_tests::arguments::{number, options as arguments, or_exit};
use cognate_tests::builders::katsura;
use cognate_tests::client::{Answer, Submission, accepted, has_ended, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::database::Database;
use std::fmt;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Work must go on so long after a fault and the length of a lease: three seconds are promised, and
/// two more are left to a machine with other work.
const GOES_ON: Duration = Duration::from_secs(5);
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
}

impl Fault {
    const ALL: [Self; 5] = [
        Self::KillWorker,
        Self::FreezeWorker,
        Self::KillCoordinator,
        Self::FreezeCoordinator,
        Self::KillDatabase,
    ];
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::KillWorker => "a worker killed (-9)",
            Self::FreezeWorker => "a worker stopped for longer than its lease",
            Self::KillCoordinator => "the coordinator killed (-9)",
            Self::FreezeCoordinator => "the coordinator stopped for a second",
            Self::KillDatabase => "the database server killed (-9)",
        })
    }
}

/// The same faults for the same seed (splitmix64: Steele, Lea, Flood 2014).
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % bound
    }
}

/// What is asked for.
struct Wanted {
    seconds: u64,
    seed: u64,
    postgres: bool,
    /// Which of Katsura's systems: 2^n paths.
    katsura: usize,
    /// Precision of the tracking; None: as much as each path needs.
    bits: Option<u32>,
    /// Least and greatest pause between two faults, in milliseconds.
    pause_ms: (u64, u64),
    /// How long a lease lasts.
    lease: Duration,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        seconds: 30,
        seed: 1,
        postgres: false,
        katsura: 11,
        bits: None,
        pause_ms: (500, 2000),
        lease: Duration::from_secs(2),
    };
    for (word, value) in arguments()? {
        match word.as_str() {
            "--seconds" => wanted.seconds = number(&word, &value)?,
            "--seed" => wanted.seed = number(&word, &value)?,
            "--ledger" if value == "sqlite" => wanted.postgres = false,
            "--ledger" if value == "postgres" => wanted.postgres = true,
            "--katsura" => wanted.katsura = number(&word, &value)?,
            "--bits" => wanted.bits = Some(number(&word, &value)?),
            "--lease-ms" => wanted.lease = Duration::from_millis(number(&word, &value)?),
            "--pause-ms" => wanted.pause_ms = range(&value)?,
            _ => {
                return Err(format!(
                    "{word} {value}: expected --seconds N, --seed N, --ledger sqlite|postgres, \
                     --katsura N, --bits N, --pause-ms LEAST-GREATEST or --lease-ms N"
                ));
            }
        }
    }
    Ok(wanted)
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

fn worker() -> WorkerOptions {
    WorkerOptions {
        lane_width: Some(1),
        ..WorkerOptions::default()
    }
}

fn options(wanted: &Wanted, ledger: Option<String>) -> CoordinatorOptions {
    CoordinatorOptions {
        lease: Some(wanted.lease),
        chunk_paths: Some(CHUNK),
        ledger,
        ..CoordinatorOptions::default()
    }
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    let database = match wanted.postgres.then(Database::start) {
        Some(None) => return ExitCode::SUCCESS,
        Some(Some(database)) => Some(database),
        None => None,
    };
    let began = Instant::now();
    let quiet = quiet_answer(&problem(&wanted));
    println!(
        "without faults: {} paths, {:.0} s",
        quiet.counts.paths_total,
        began.elapsed().as_secs_f64()
    );
    let mut cluster = Cluster::start(options(&wanted, database.as_ref().map(Database::url)));
    let mut logs = Vec::new();
    for _ in 0..WORKERS {
        cluster.add_worker(&worker());
    }
    let mut dice = Dice(wanted.seed);
    let (mut jobs, mut paths) = (0, 0);
    let mut faults: Vec<(Fault, Duration)> = Vec::new();
    let begin = Instant::now();
    let (least, greatest) = wanted.pause_ms;
    while begin.elapsed() < Duration::from_secs(wanted.seconds) {
        // Another request each time, or it would be the same job.
        let job = cluster.client().submit(&problem(&wanted));
        loop {
            let pause = Duration::from_millis(least + dice.below(greatest - least));
            let next = Instant::now() + pause;
            let mut ended = false;
            while Instant::now() < next && !ended {
                let now = cluster.client().progress(&job);
                ended = now.is_ok_and(|p| has_ended(&p));
                std::thread::sleep(Duration::from_millis(50));
            }
            if ended {
                break;
            }
            let fault = loop {
                let fault = Fault::ALL[dice.below(5) as usize];
                if fault != Fault::KillDatabase || database.is_some() {
                    break fault;
                }
            };
            let before = cluster.client().progress(&job).map_or(0, |p| accepted(&p));
            let victim = dice.below(WORKERS as u64) as usize;
            let mut since = Instant::now();
            match fault {
                Fault::KillWorker => {
                    let mut killed = cluster.workers.remove(victim);
                    killed.kill();
                    logs.push(killed.log());
                    cluster.add_worker(&worker());
                }
                Fault::FreezeWorker => {
                    cluster.workers[victim].freeze();
                    std::thread::sleep(wanted.lease + Duration::from_millis(500));
                    cluster.workers[victim].thaw();
                }
                Fault::KillCoordinator => {
                    cluster.kill_coordinator();
                    cluster.restart_coordinator();
                }
                Fault::FreezeCoordinator => {
                    cluster.coordinator.freeze();
                    std::thread::sleep(Duration::from_secs(1));
                    cluster.coordinator.thaw();
                    since = Instant::now();
                }
                Fault::KillDatabase => {
                    if let Some(database) = &database {
                        database.kill_and_start();
                        since = Instant::now();
                    }
                }
            }
            // Going again: another chunk is accepted, or the job has ended.
            let client = cluster.client();
            client.progress_once(&job, "work goes on", |p| {
                has_ended(p) || accepted(p) > before
            });
            faults.push((fault, since.elapsed()));
            println!("{fault}: on after {:.2} s", since.elapsed().as_secs_f64());
        }
        let client = cluster.client();
        client.wait_until_solved(&job);
        assert!(
            client.answer(&job) == quiet,
            "job {job} has another answer than without faults (seed {})",
            wanted.seed
        );
        let end = client.progress(&job).expect("the job is known");
        assert_eq!(accepted(&end), total(&end));
        (jobs, paths) = (jobs + 1, paths + total(&end));
    }
    logs.extend(cluster.workers.iter().map(|worker| worker.log()));
    cluster.stop();
    report(&wanted, begin.elapsed(), jobs, paths, &faults, &logs)
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

fn report(
    wanted: &Wanted,
    took: Duration,
    jobs: u64,
    paths: u64,
    faults: &[(Fault, Duration)],
    logs: &[String],
) -> ExitCode {
    let ledger = if wanted.postgres {
        "PostgreSQL"
    } else {
        "SQLite"
    };
    println!(
        "\nChaos on {ledger}, seed {}, {:.0} s",
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
    let limit = wanted.lease + GOES_ON;
    let late = faults.iter().filter(|(_, time)| *time > limit).count();
    if again > bound || late > 0 || begun < paths {
        println!("  NOT AS PROMISED: {late} faults took longer than {limit:?}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
