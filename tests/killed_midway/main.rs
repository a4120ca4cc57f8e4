//! Killed midway: a large polyhedral solve on two workers, of which one is killed (-9) on each leg, and
//! the coordinator too. Every path must have its class, memory must stay flat; a report says what it was.
//!
//! `cargo run --release -p cognate-tests --bin killed_midway -- [--cyclic 10] [--seed 1]`

use cognate_protocol::v1::{JobProgress, SummaryCounts};
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
/// Time without a newly accepted result after which the test gives up.
const PATIENCE: Duration = Duration::from_secs(600);

/// Settings of the program.
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
#[derive(Default)]
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

/// A kill that happens once on a leg of the solve.
struct Kill {
    leg: usize,
    /// The kill waits until one in `one_in` paths of the leg is accepted.
    one_in: u64,
    victim: Victim,
}

/// One worker on each leg, and the coordinator on the second leg.
const KILLS: [Kill; 3] = [
    Kill {
        leg: 0,
        one_in: 4,
        victim: Victim::Worker,
    },
    Kill {
        leg: 1,
        one_in: 4,
        victim: Victim::Worker,
    },
    Kill {
        leg: 1,
        one_in: 2,
        victim: Victim::Coordinator,
    },
];

/// A process that is killed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Victim {
    Worker,
    Coordinator,
}

impl Victim {
    /// Kills one such process and starts another.
    fn replace(self, cluster: &mut Cluster) {
        match self {
            Victim::Coordinator => {
                cluster.kill_coordinator();
                cluster.restart_coordinator();
            }
            Victim::Worker => {
                cluster.workers.remove(0).kill();
                cluster.add_worker(&WorkerOptions::default());
            }
        }
    }

    fn name(self) -> &'static str {
        match self {
            Victim::Coordinator => "the coordinator",
            Victim::Worker => "a worker",
        }
    }
}

/// Memory and kills until the end of the job.
#[derive(Default)]
struct Course {
    coordinator_memory: Memory,
    /// Memory of the largest worker.
    worker_memory: Memory,
    /// For each of [`KILLS`], whether it happened.
    killed: [bool; 3],
}

impl Course {
    /// Carries out each kill that is due.
    fn kill(&mut self, cluster: &mut Cluster, progress: &JobProgress, begin: Instant) {
        let seconds = begin.elapsed().as_secs_f64();
        for (number, kill) in KILLS.iter().enumerate() {
            let Some(stage) = progress
                .stages
                .get(kill.leg)
                .filter(|_| !self.killed[number])
            else {
                continue;
            };
            if stage.accepted * kill.one_in < stage.total || stage.accepted == stage.total {
                continue;
            }
            self.killed[number] = true;
            println!(
                "{seconds:.1} s: {} killed (-9) after {} of {} paths of leg {}",
                kill.victim.name(),
                stage.accepted,
                stage.total,
                kill.leg + 1
            );
            kill.victim.replace(cluster);
        }
    }
}

/// Follows a job to its end, with all kills.
fn follow(job: &str, cluster: &mut Cluster, begin: Instant) -> Course {
    let mut course = Course::default();
    let mut last = (Instant::now(), 0);
    loop {
        std::thread::sleep(Duration::from_millis(200));
        let memory = cluster.coordinator.memory_bytes();
        course.coordinator_memory.seen.push(memory);
        let workers = cluster.workers.iter().map(|w| w.memory_bytes());
        course.worker_memory.seen.extend(workers.max());
        let Ok(progress) = cluster.client().progress(job) else {
            continue;
        };
        if has_ended(&progress) {
            return course;
        }
        let done = accepted(&progress);
        if done > last.1 {
            last = (Instant::now(), done);
        }
        assert!(last.0.elapsed() < PATIENCE, "nothing new: {progress:?}");
        course.kill(cluster, &progress, begin);
    }
}

/// Prints classes of paths and solutions.
fn print_counts(counts: &SummaryCounts) {
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
    let course = follow(&job, &mut cluster, begin);
    let took = begin.elapsed().as_secs_f64();
    let client = cluster.client();
    client.wait_until_solved(&job);
    let counts = client.counts(&job);
    let answer = client.answer(&job);
    println!(
        "\ncyclic-{}, seed {}, {took:.1} s",
        wanted.size, wanted.seed
    );
    print_counts(&counts);
    println!(
        "  largest memory in each quarter, MiB: coordinator {}; a worker {}",
        course.coordinator_memory.quarters(),
        course.worker_memory.quarters()
    );
    let all_in_classes = paths_in_classes(&counts) == counts.paths_total
        && answer.paths.len() as u64 == counts.paths_total
        && answer.paths.iter().all(|path| path.class != 0);
    cluster.stop();
    let published = named.finite_solutions;
    if let Some(solutions) = published {
        println!("  published: {solutions} solutions");
    }
    let good = all_in_classes
        && counts.paths_failed == 0
        && published.is_none_or(|solutions| solutions == counts.solutions_nonsingular)
        && course.killed == [true; 3];
    if !good {
        println!(
            "  NOT AS PROMISED: all named {all_in_classes}, faults {:?}",
            course.killed
        );
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
