//! A large job: millions of made-up path results through a real coordinator, whose memory is measured.
//!
//! `target/release/large_job [--degree 20] [--memory-mib 0]`: four equations of this degree, so degree^4
//! paths (57: 10,556,001). Nobody tracks them: threads of this program pull chunks and report roots of
//! unity. Two paths of a hundred go to infinity, one of 10,000 fails and one of 50,000 ends where the one
//! before does, until they are tracked again; every count is checked at the end, and every solution and
//! every path is asked for. With `--memory-mib` the coordinator may take no more. Results: `large_job/report.md`.

use cognate_numeric::roots_of_unity::roots_of_unity;
use cognate_protocol::v1::worker_api_client::WorkerApiClient;
use cognate_protocol::{from_proto, v1};
use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::client::{Client, Submission, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions};
use num_complex::Complex64;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tonic::transport::Channel;

type Calls = WorkerApiClient<Channel>;

/// Paths of a chunk.
const CHUNK: u64 = 10_000;
/// Threads that make results up.
const WORKERS: usize = 2;
const VARIABLES: u64 = 4;
/// Longest time of the job.
const PATIENCE: Duration = Duration::from_secs(4 * 3600);

/// Whether a path ends at infinity in the results that are made up.
fn is_at_infinity(path: u64) -> bool {
    path % 100 >= 98
}

fn fails_at_first(path: u64) -> bool {
    path % 10_000 == 5
}

fn meets_at_first(path: u64) -> bool {
    path % 50_000 == 40_011
}

/// One of the solutions of a^d = b^d = c^d = d^d = 1 by the digits of its path, homogenising coordinate first: the
/// coordinator looks at the ends that it is told of.
fn point(path: u64, roots: &[Complex64]) -> Vec<f64> {
    let mut point = vec![1.0, 0.0];
    let (mut digits, degree) = (path, roots.len() as u64);
    for _ in 0..VARIABLES {
        let root = roots[(digits % degree) as usize];
        point.extend([root.re, root.im]);
        digits /= degree;
    }
    point
}

fn result(path: u64, attempt: u32, roots: &[Complex64]) -> v1::PathResult {
    let outcome = if is_at_infinity(path) {
        v1::PathOutcome::Diverging
    } else if fails_at_first(path) && attempt == 0 {
        v1::PathOutcome::StepTooSmall
    } else {
        v1::PathOutcome::Regular
    };
    let place = if meets_at_first(path) && attempt == 0 {
        path - 1
    } else {
        path
    };
    v1::PathResult {
        origin: path,
        attempt,
        outcome: outcome.into(),
        endpoint: point(place, roots),
        t: Some(v1::Complex { re: 0.0, im: 0.0 }),
        residual: 1e-16,
        condition: 10.0 + (path % 97) as f64,
        // A path that is clearly at infinity has no accuracy.
        accuracy: if is_at_infinity(path) {
            f64::INFINITY
        } else {
            1e-15
        },
        precision_bits: 53,
        counts: Some(v1::Counts {
            steps: 40 + (path % 13) as u32,
            evaluations: 130 + (path % 31) as u32,
            ..v1::Counts::default()
        }),
        ..v1::PathResult::default()
    }
}

/// Pulls, makes up and reports until there is nothing more to do.
fn work(address: &str, name: &str, roots: &[Complex64], done: &AtomicBool) {
    let client = Client::connect(address).expect("the coordinator answers");
    let info = |mut client: v1::client_api_client::ClientApiClient<Channel>| async move {
        client.get_server_info(v1::GetServerInfoRequest {}).await
    };
    let info = client
        .call(info)
        .expect("the coordinator answers")
        .into_inner();
    let identity = || {
        Some(v1::WorkerIdentity {
            worker: name.to_owned(),
            session: format!("{name}-1"),
        })
    };
    let mut sequence = 0;
    while !done.load(Ordering::Relaxed) {
        sequence += 1;
        let request = v1::PullRequest {
            identity: identity(),
            sequence,
            free_slots: 1,
            wait_ms: 500,
            machine: Some(v1::Machine {
                version: "made up".to_owned(),
                protocol_version: info.protocol_version,
                numerics_revision: info.numerics_revision,
                instruction_set: "none".to_owned(),
                lane_width: 1,
                threads: 1,
                host: "here".to_owned(),
                transport: "grpc".to_owned(),
            }),
        };
        let pulled = client.call_as_worker(|mut c: Calls| async move { c.pull(request).await });
        for lease in pulled.expect("an answer").into_inner().leases {
            let id = lease.id.clone().expect("a lease has an id");
            let request = v1::GetStageRequest {
                job: id.job,
                stage: id.stage,
            };
            let get = |mut c: Calls| async move { c.get_stage(request).await };
            let stage = client.call_as_worker(get).expect("a stage").into_inner();
            let stage = from_proto::path::stage(&stage).expect("a stage");
            let attempt = u32::from(stage.attempt);
            let items = lease.first..lease.first + lease.count;
            let report = v1::ReportRequest {
                identity: identity(),
                chunks: vec![v1::ChunkReport {
                    lease: lease.id,
                    results: items
                        .map(|k| result(stage.origin(k), attempt, roots))
                        .collect(),
                    cpu_nanoseconds: 1_000_000_000,
                    wall_nanoseconds: 1_000_000_000,
                }],
            };
            let report = |mut c: Calls| async move { c.report(report).await };
            let verdicts = client
                .call_as_worker(report)
                .expect("an answer")
                .into_inner();
            let verdict = verdicts.verdicts[0].verdict();
            assert_eq!(verdict, v1::Verdict::Accepted, "{:?}", verdicts.verdicts);
        }
    }
}

/// The number of paths with a property.
fn count(paths: u64, property: impl Fn(u64) -> bool) -> u64 {
    (0..paths).filter(|&path| property(path)).count() as u64
}

/// A part of the run, with its time and the coordinator's memory.
struct Phase {
    what: &'static str,
    seconds: f64,
    /// The coordinator's largest memory from its start to the end of the phase, in MiB.
    peak_mib: u64,
}

/// The phases of a run, in their order.
struct Phases<'a> {
    cluster: &'a Cluster,
    began: Instant,
    ended: Vec<Phase>,
}

impl Phases<'_> {
    /// Ends a phase and begins the next.
    fn end(&mut self, what: &'static str) {
        let seconds = self.began.elapsed().as_secs_f64();
        let peak_mib = self.cluster.coordinator.peak_memory_bytes() >> 20;
        println!("{what}: {seconds:.1} s, {peak_mib} MiB at most so far");
        self.ended.push(Phase {
            what,
            seconds,
            peak_mib,
        });
        self.began = Instant::now();
    }

    /// Prints a table, and returns the coordinator's largest memory in MiB.
    fn table(&self, paths: u64) -> u64 {
        println!("\n| paths | phase | s | coordinator's memory at most, MiB |\n|---|---|---|---|");
        for Phase {
            what,
            seconds,
            peak_mib,
        } in &self.ended
        {
            println!("| {paths} | {what} | {seconds:.1} | {peak_mib} |");
        }
        self.ended.iter().map(|p| p.peak_mib).max().unwrap_or(0)
    }
}

/// The command line.
struct Wanted {
    degree: u64,
    /// The coordinator may take no more; 0: no bound.
    memory_mib: u64,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        degree: 20,
        memory_mib: 0,
    };
    for (word, value) in options()? {
        match word.as_str() {
            "--degree" => wanted.degree = number(&word, &value)?,
            "--memory-mib" => wanted.memory_mib = number(&word, &value)?,
            _ => return Err(format!("{word}: expected --degree N or --memory-mib N")),
        }
    }
    Ok(wanted)
}

/// Reports every path of a job until it is solved, and returns their number.
fn solve(job: &str, client: &Client, roots: &[Complex64], phases: &mut Phases<'_>) -> u64 {
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for worker in 0..WORKERS {
            let (address, done) = (phases.cluster.address(), &done);
            scope.spawn(move || work(&address, &format!("made-up-{worker}"), roots, done));
        }
        let first = |p: &v1::JobProgress| p.stages.first().is_some_and(|s| s.accepted == s.total);
        let reported = client.progress_for(job, "all is reported", PATIENCE, first);
        phases.end("reported");
        let next = |p: &v1::JobProgress| p.stages.len() > 1;
        client.progress_for(job, "the first stage is absorbed", PATIENCE, next);
        phases.end("absorbed");
        client.wait_until_solved_for(job, PATIENCE);
        phases.end("solved");
        done.store(true, Ordering::Relaxed);
        total(&reported)
    })
}

/// Whether the counts of a job are those of its made-up results.
fn counts_are_right(job: &str, client: &Client, paths: u64) -> bool {
    let counts = client.counts(job);
    let infinite = count(paths, is_at_infinity);
    let retracked = count(paths, fails_at_first) + 2 * count(paths, meets_at_first);
    let expected = [
        ("paths", counts.paths_total, paths),
        ("at infinity", counts.paths_at_infinity, infinite),
        ("finite", counts.paths_finite, paths - infinite),
        ("failed", counts.paths_failed, 0),
        ("tracked again", counts.paths_retracked, retracked),
        ("solutions", counts.solutions_distinct, paths - infinite),
    ];
    let mut good = true;
    for (what, counted, expected) in expected {
        if counted != expected {
            println!("NOT RIGHT: {counted} {what}, not {expected}");
            good = false;
        }
    }
    good
}

/// Whether the streams of solutions and of paths are whole, in order and right.
fn streams_are_right(
    job: &str,
    client: &Client,
    paths: u64,
    roots: &[Complex64],
    phases: &mut Phases<'_>,
) -> bool {
    let mut good = true;
    let (mut solutions, mut next) = (0, 0);
    client.each_solution(job, |solution| {
        solutions += 1;
        // By their first paths, each at its place.
        good &= solution.paths.first().is_some_and(|&path| path >= next);
        next = solution.paths.first().map_or(0, |path| path + 1);
    });
    phases.end("solutions streamed");
    let (mut answered, mut numbered) = (0, 0);
    client.each_path(job, |path| {
        let end = path.result.unwrap_or_default();
        good &= end.origin == answered && end.endpoint == point(answered, roots);
        good &= path.solution == (!is_at_infinity(answered)).then_some(numbered);
        numbered += u64::from(path.solution.is_some());
        answered += 1;
    });
    phases.end("paths streamed");
    if solutions != paths - count(paths, is_at_infinity) || answered != paths {
        println!("NOT RIGHT: {solutions} solutions and {answered} paths streamed");
        good = false;
    }
    good
}

fn main() -> ExitCode {
    let Wanted { degree, memory_mib } = or_exit(wanted());
    let roots = roots_of_unity(u32::try_from(degree).expect("a degree"));
    let cluster = Cluster::start(CoordinatorOptions {
        chunk_paths: Some(CHUNK),
        ..CoordinatorOptions::default()
    });
    let mut problem = Submission::of(format!(
        "variable_group a, b, c, d; function f, g, h, k;
         f = a^{degree} - 1; g = b^{degree} - 1; h = c^{degree} - 1; k = d^{degree} - 1;"
    ));
    problem.options.start = v1::StartKind::TotalDegree.into();
    let client = cluster.client();
    let mut phases = Phases {
        cluster: &cluster,
        began: Instant::now(),
        ended: Vec::new(),
    };
    phases.end("started");
    let job = client.submit(&problem);
    let paths = solve(&job, &client, &roots, &mut phases);
    let mut good = counts_are_right(&job, &client, paths);
    good &= streams_are_right(&job, &client, paths, &roots, &mut phases);
    let most = phases.table(paths);
    if memory_mib > 0 && most > memory_mib {
        println!("NOT AS PROMISED: {most} MiB, not {memory_mib}");
        good = false;
    }
    cluster.stop();
    if good {
        println!("all counts, solutions and paths are right");
        ExitCode::SUCCESS
    } else {
        println!("NOT RIGHT");
        ExitCode::FAILURE
    }
}
