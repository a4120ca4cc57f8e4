//! Load: many small jobs by many clients at once, beside one large job, on one coordinator (SQLite)
//! with two workers. Nothing may be lost and every count must be right; what it cost is reported.
//!
//! `cargo run --release -p cognate-tests --bin load -- [--jobs 60] [--clients 6] [--quartics 6] [--at-once 1]`:
//! the large job has 4^quartics paths (0: none); each client keeps `--at-once` of its jobs going.

use cognate_systems::named::{cyclic, katsura, noon};
use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::client::{Client, accepted};
use cognate_tests::cluster::Cluster;
use cognate_tests::subjects::Subject;
use cognate_tests::systems::shared;
use std::collections::VecDeque;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Longest time of the large job.
const PATIENCE: Duration = Duration::from_secs(3600);
/// Largest wait of the median small job, on a machine without other work.
const MEDIAN: Duration = Duration::from_secs(2);
/// Largest wait of the median small job on a machine with other work, as a multiple of the time of a small job that is
/// alone.
const TIMES_ALONE: u32 = 20;
/// Largest growth of the coordinator's memory while the small jobs pass, in bytes.
const GROWTH: u64 = 128 << 20;
/// Interval between two looks at the coordinator's memory.
const SAMPLE: Duration = Duration::from_millis(250);

/// Settings of the program.
struct Wanted {
    jobs: u64,
    clients: u64,
    quartics: usize,
    at_once: u64,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        jobs: 60,
        clients: 6,
        quartics: 6,
        at_once: 1,
    };
    for (word, value) in options()? {
        match word.as_str() {
            "--jobs" => wanted.jobs = number(&word, &value)?,
            "--clients" => wanted.clients = number(&word, &value)?,
            "--quartics" => wanted.quartics = number(&word, &value)?,
            "--at-once" => wanted.at_once = number(&word, &value)?,
            _ => {
                return Err(format!(
                    "{word}: expected --jobs N, --clients N, --quartics N or --at-once N"
                ));
            }
        }
    }
    Ok(wanted)
}

fn small() -> Vec<Subject> {
    vec![
        Subject::new("3-RPR", &shared("three_rpr_real6"), 6),
        Subject::new("five poses", &shared("burmester_five_poses_real4"), 4),
        Subject::named("katsura-4", &katsura(4)),
        Subject::named("noon-3", &noon(3)),
        Subject::named("cyclic-5", &cyclic(5)),
    ]
}

/// Observation of one small job by one client.
struct Seen {
    /// Time from the call that submits the job until it is solved, by the service's own record of the rest.
    wait: Duration,
    right: bool,
}

/// One client: its jobs, some of them going at once.
fn client(address: &str, subjects: &[Subject], jobs: Vec<u64>, at_once: u64) -> Vec<Seen> {
    let client = Client::connect(address).expect("the coordinator answers");
    let mut to_do = jobs.into_iter();
    let mut going = VecDeque::new();
    let mut seen = Vec::new();
    loop {
        while going.len() < at_once.max(1) as usize
            && let Some(number) = to_do.next()
        {
            let subject = &subjects[number as usize % subjects.len()];
            let begin = Instant::now();
            let job = client.submit(&subject.submission(number));
            going.push_back((subject, job, begin.elapsed()));
        }
        let Some((subject, job, submitting)) = going.pop_front() else {
            return seen;
        };
        let right = client.end(&job).map(|end| {
            let counts = client.counts(&job);
            let wait = submitting + Duration::from_secs_f64(end.elapsed_seconds);
            let right = subject.is_right(&counts) && counts.paths_failed == 0;
            if !right {
                println!("  NOT RIGHT: {} in job {job}: {counts:?}", subject.name);
            }
            Seen { wait, right }
        });
        match right {
            Ok(one) => seen.push(one),
            Err(status) => println!("  LOST: {} in job {job}: {status}", subject.name),
        }
    }
}

/// The median wait for a small job that is alone.
fn alone(address: &str, subjects: &[Subject]) -> Duration {
    let few = (2_000_000..2_000_000 + subjects.len() as u64).collect();
    let seen = client(address, subjects, few, 1);
    let mut waits: Vec<Duration> = seen.iter().map(|one| one.wait).collect();
    waits.sort_unstable();
    waits.get(waits.len() / 2).copied().unwrap_or_default()
}

/// The percentile `percent` of the values; 0 of nothing.
fn percentile(sorted: &[Duration], percent: usize) -> f64 {
    let at = sorted.len() * percent / 100;
    let at = sorted.get(at.min(sorted.len().saturating_sub(1)));
    at.map_or(0.0, Duration::as_secs_f64)
}

fn mib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// The clients and the coordinator while small jobs pass.
struct Passage {
    seen: Vec<Seen>,
    /// Bytes that the coordinator held, from time to time.
    memory: Vec<u64>,
}

/// Submits all small jobs by all clients at once.
fn pass_small_jobs(wanted: &Wanted, cluster: &Cluster, subjects: &[Subject]) -> Passage {
    let coordinator = &cluster.coordinator;
    let small_done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let clients: Vec<_> = (0..wanted.clients.max(1))
            .map(|k| {
                let jobs = (0..wanted.jobs).filter(|n| n % wanted.clients.max(1) == k);
                let (jobs, address) = (jobs.collect(), cluster.address());
                let at_once = wanted.at_once;
                scope.spawn(move || client(&address, subjects, jobs, at_once))
            })
            .collect();
        let memory = scope.spawn(|| {
            let mut memory = Vec::new();
            while !small_done.load(Ordering::Relaxed) {
                memory.push(coordinator.memory_bytes());
                std::thread::sleep(SAMPLE);
            }
            memory
        });
        let joined = clients.into_iter().flat_map(|client| client.join());
        let seen: Vec<Seen> = joined.flatten().collect();
        small_done.store(true, Ordering::Relaxed);
        Passage {
            seen,
            memory: memory.join().unwrap_or_default(),
        }
    })
}

/// The large job beside the small ones.
struct LargeJob {
    subject: Subject,
    job: String,
}

impl LargeJob {
    /// Submits the job and waits until its first paths are accepted.
    fn begin(quartics: usize, client: &Client) -> Self {
        let subject = Subject::quartics(quartics);
        let job = client.submit(&subject.submission(1));
        client.progress_once(&job, "the large job has begun", |p| accepted(p) > 0);
        Self { subject, job }
    }

    /// Paths that are accepted by this time.
    fn accepted(&self, client: &Client) -> u64 {
        let progress = client.progress(&self.job);
        progress.map_or(0, |progress| accepted(&progress))
    }

    /// Waits for the end, prints a report, and returns whether every count is right. `begin`: when the small jobs began;
    /// `going`: the paths that were accepted when the small jobs were done.
    fn ends_right(&self, cluster: &Cluster, client: &Client, begin: Instant, going: u64) -> bool {
        client.wait_until_solved_for(&self.job, PATIENCE);
        let counts = client.counts(&self.job);
        let right = self.subject.is_right(&counts) && counts.paths_failed == 0;
        println!(
            "  the large job: {} of {} paths when the small ones were done, {:.1} s from the first \
             small one to its end, {}; coordinator {:.0} MiB at its end",
            going,
            counts.paths_total,
            begin.elapsed().as_secs_f64(),
            if right { "right" } else { "NOT RIGHT" },
            mib(cluster.coordinator.memory_bytes())
        );
        if !right {
            println!("  {counts:?}");
        }
        right
    }
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    let cluster = Cluster::with_workers(2);
    let subjects = small();
    let watching = cluster.client();
    // Each system is solved once before the measurement, so that everything that is loaded once is loaded.
    for (number, subject) in subjects.iter().enumerate() {
        let job = watching.submit(&subject.submission(1_000_000 + number as u64));
        watching.wait_until_solved(&job);
    }
    let alone = alone(&cluster.address(), &subjects);
    let large = (wanted.quartics > 0).then(|| LargeJob::begin(wanted.quartics, &watching));
    let coordinator = &cluster.coordinator;
    let (begin, cpu) = (Instant::now(), coordinator.cpu_seconds());
    let Passage { seen, memory } = pass_small_jobs(&wanted, &cluster, &subjects);
    let took = begin.elapsed().as_secs_f64();
    let cpu = coordinator.cpu_seconds() - cpu;
    let large_going = large.as_ref().map(|large| large.accepted(&watching));
    let right = seen.iter().filter(|one| one.right).count() as u64;
    let mut waits: Vec<Duration> = seen.iter().map(|one| one.wait).collect();
    waits.sort_unstable();
    println!(
        "{} small jobs by {} clients, {} of each at once: {right} right, {} lost, {took:.1} s",
        wanted.jobs,
        wanted.clients,
        wanted.at_once,
        wanted.jobs - seen.len() as u64
    );
    println!(
        "  wait: {:.2} s (median), {:.2} s (95 of 100), {:.2} s (longest); a small job alone {:.2} s",
        percentile(&waits, 50),
        percentile(&waits, 95),
        percentile(&waits, 100),
        alone.as_secs_f64()
    );
    let jobs = wanted.jobs.max(1) as f64;
    println!(
        "  coordinator: {:.1} ms of CPU a small job{}",
        1e3 * cpu / jobs,
        large.as_ref().map_or("", |_| ", the large one's with it")
    );
    // A tenth of the samples for what is held from the first jobs on.
    let first = memory.get(memory.len() / 10).copied().unwrap_or(0);
    let most = memory.iter().copied().max().unwrap_or(0);
    println!(
        "  coordinator: {:.0} MiB after a tenth of that time, {:.0} MiB at most, {:.0} MiB at its end",
        mib(first),
        mib(most),
        mib(memory.last().copied().unwrap_or(0))
    );
    let mut good = right == wanted.jobs;
    let bound = MEDIAN.max(alone * TIMES_ALONE).as_secs_f64();
    if percentile(&waits, 50) > bound {
        println!("  NOT AS PROMISED: the median is above {bound:.2} s");
        good = false;
    }
    if most > first + GROWTH {
        println!("  NOT AS PROMISED: the coordinator's memory grows");
        good = false;
    }
    if let (Some(large), Some(going)) = (&large, large_going) {
        good &= large.ends_right(&cluster, &watching, begin, going);
    }
    cluster.stop();
    if good {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
