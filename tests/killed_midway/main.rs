//! Killed midway: a large polyhedral solve on two workers, of which one is killed (-9) on each leg, and
//! the coordinator too. Every path must have its class, memory must stay flat; a report says what it was.
//!
//! `cargo run --release -p cognate-tests --bin killed_midway -- [--cyclic 10] [--seed 1]`

use cognate_systems::formats::{self, FileSettings, Format};
use cognate_systems::named::cyclic;
use cognate_tests::arguments;
use cognate_tests::client::{Submission, accepted, has_ended};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::subjects::paths_in_classes;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// How long a lease lasts here.
const LEASE: Duration = Duration::from_secs(5);
/// Give up when nothing new is accepted for so long.
const PATIENCE: Duration = Duration::from_secs(600);

/// What is asked for.
struct Wanted {
    size: u64,
    seed: u64,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted { size: 10, seed: 1 };
    for (option, value) in arguments::options()? {
        let number = arguments::number(&option, &value)?;
        match option.as_str() {
            "--cyclic" => wanted.size = number,
            "--seed" => wanted.seed = number,
            _ => return Err(format!("{option}: expected --cyclic N or --seed N")),
        }
    }
    match wanted.size {
        3..=11 => Ok(wanted),
        size => Err(format!("--cyclic {size}: expected 3 to 11")),
    }
}

/// Bytes that were held from time to time in the run.
struct Memory {
    seen: Vec<u64>,
}

impl Memory {
    /// MiB at the largest in each quarter of the run.
    fn quarters(&self) -> String {
        let size = self.seen.len().div_ceil(4).max(1);
        let largest = self.seen.chunks(size).map(|quarter| {
            let most = quarter.iter().max().copied().unwrap_or(0);
            format!("{}", most >> 20)
        });
        largest.collect::<Vec<_>>().join(", ")
    }
}

fn main() -> ExitCode {
    let wanted = arguments::or_exit(wanted());
    let named = cyclic(wanted.size as usize);
    let text = formats::write(Format::Bertini, &named.system, &FileSettings::default());
    let mut submission = Submission::of(text.expect("systems of our own can be written"));
    submission.options.seed = Some(wanted.seed);
    submission.options.start = cognate_protocol::v1::StartKind::Polyhedral.into();
    let mut cluster = Cluster::start(CoordinatorOptions {
        lease: Some(LEASE),
        ..CoordinatorOptions::default()
    });
    for _ in 0..2 {
        cluster.add_worker(&WorkerOptions::default());
    }
    let begin = Instant::now();
    let job = cluster.client().submit(&submission);
    println!("submitted after {:.1} s", begin.elapsed().as_secs_f64());
    let mut memory = [Memory { seen: vec![] }, Memory { seen: vec![] }];
    let mut killed = [false; 3];
    let mut last = (Instant::now(), 0);
    loop {
        std::thread::sleep(Duration::from_millis(200));
        memory[0].seen.push(cluster.coordinator.memory_bytes());
        let workers = cluster.workers.iter().map(|w| w.memory_bytes());
        memory[1].seen.extend(workers.max());
        let Ok(progress) = cluster.client().progress(&job) else {
            continue;
        };
        if has_ended(&progress) {
            break;
        }
        let done = accepted(&progress);
        if done > last.1 {
            last = (Instant::now(), done);
        }
        assert!(last.0.elapsed() < PATIENCE, "nothing new: {progress:?}");
        let seconds = begin.elapsed().as_secs_f64();
        // One worker on each leg, the coordinator on the second.
        for (leg, part, fault) in [(0, 4, 0), (1, 4, 1), (1, 2, 2)] {
            let Some(stage) = progress.stages.get(leg).filter(|_| !killed[fault]) else {
                continue;
            };
            if stage.accepted * part < stage.total || stage.accepted == stage.total {
                continue;
            }
            killed[fault] = true;
            let of = format!(
                "{} of {} paths of leg {}",
                stage.accepted,
                stage.total,
                leg + 1
            );
            if fault == 2 {
                println!("{seconds:.1} s: the coordinator killed (-9) after {of}");
                cluster.kill_coordinator();
                cluster.restart_coordinator();
            } else {
                println!("{seconds:.1} s: a worker killed (-9) after {of}");
                cluster.workers.remove(0).kill();
                cluster.add_worker(&WorkerOptions::default());
            }
        }
    }
    let took = begin.elapsed().as_secs_f64();
    let client = cluster.client();
    client.wait_until_solved(&job);
    let counts = client.counts(&job);
    let answer = client.answer(&job);
    println!(
        "\ncyclic-{}, seed {}, {took:.1} s",
        wanted.size, wanted.seed
    );
    println!(
        "  {} paths: {} finite, {} singular, {} on positive-dimensional sets, {} undecided, {} within the accuracy of the data, {} at infinity, {} failed",
        counts.paths_total,
        counts.paths_finite,
        counts.paths_singular,
        counts.paths_positive_dimensional.unwrap_or(0),
        counts.paths_undecided,
        counts.paths_within_data_accuracy,
        counts.paths_at_infinity,
        counts.paths_failed
    );
    println!(
        "  {} nonsingular solutions, {} singular; {} paths tracked again",
        counts.solutions_nonsingular, counts.solutions_singular, counts.paths_retracked
    );
    println!(
        "  largest memory in each quarter, MiB: coordinator {}; a worker {}",
        memory[0].quarters(),
        memory[1].quarters()
    );
    let named_all = paths_in_classes(&counts) == counts.paths_total
        && answer.paths.len() as u64 == counts.paths_total
        && answer.paths.iter().all(|path| path.class != 0);
    cluster.stop();
    let known = named.finite_solutions;
    if let Some(known) = known {
        println!("  published: {known} solutions");
    }
    let good = named_all
        && counts.paths_failed == 0
        && known.is_none_or(|known| known == counts.solutions_nonsingular)
        && killed == [true; 3];
    if !good {
        println!("  NOT AS PROMISED: all named {named_all}, faults {killed:?}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
