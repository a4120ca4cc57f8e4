//! Chaos: jobs on real processes while workers, coordinators and the database are killed or stand
//! still at random, results are damaged or lost, and workers do evil. Every answer must be the undisturbed
//! one, bit for bit, and every worker that does evil must be named; a report gives the cost.
//!
//! `cargo run --release -p cognate-tests --bin chaos -- [--seconds 30] [--seed 1] [--ledger sqlite|postgres]
//! [--results folder|s3] [--coordinators 1] [--katsura 11] [--bits 53] [--pause-ms 500-2000] [--lease-ms 2000] [--jobs N]
//! [--storage-faults yes] [--evil-workers yes]`: jobs in turn for this time, or this number of jobs, the last to its
//! end.

mod evil_worker;
mod fault;
mod found;
mod scene;
mod spoilt_results;
mod wanted;

use cognate_protocol::v1::Precision;
use cognate_protocol::v1::precision::Kind;
use cognate_tests::arguments::or_exit;
use cognate_tests::builders::katsura;
use cognate_tests::client::{Answer, Submission, accepted, has_ended, total};
use cognate_tests::cluster::Cluster;
use cognate_tests::database::Database;
use cognate_tests::dice::Dice;
use cognate_tests::storage::Storage;
use fault::Fault;
use found::{Found, report};
use scene::Scene;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use wanted::{Wanted, wanted};

/// Longest time of a job.
const LONGEST: Duration = Duration::from_secs(4 * 3600);

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

/// A fault that can happen in this run.
fn possible_fault(wanted: &Wanted, dice: &mut Dice, database: Option<&Database>) -> Fault {
    loop {
        let fault = Fault::ALL[dice.below(Fault::ALL.len() as u64) as usize];
        let possible = match fault {
            Fault::KillDatabase => database.is_some(),
            Fault::KillStorage => wanted.bucket,
            Fault::SpoilResults => wanted.storage_faults,
            _ => true,
        };
        if possible {
            return fault;
        }
    }
}

/// Lets faults happen until a job has ended: each fault with the time until work goes on.
fn disturb(
    wanted: &Wanted,
    scene: &mut Scene,
    dice: &mut Dice,
    database: Option<&Database>,
    job: &str,
) -> Vec<(Fault, Duration)> {
    let (least, greatest) = wanted.pause_ms;
    let mut faults = Vec::new();
    loop {
        let pause = Duration::from_millis(least + dice.below(greatest - least));
        let next = Instant::now() + pause;
        let mut ended = false;
        while Instant::now() < next && !ended {
            let progress = scene.client(0).progress(job);
            ended = progress.is_ok_and(|p| has_ended(&p));
            std::thread::sleep(Duration::from_millis(50));
        }
        if ended {
            return faults;
        }
        let fault = possible_fault(wanted, dice, database);
        let took = scene.suffer(fault, job, dice, database);
        faults.push((fault, took));
        println!("{fault}: on after {:.2} s", took.as_secs_f64());
    }
}

/// Whether the paths of a solved job can be listed.
enum PathList {
    Whole,
    Damaged,
}

/// Compares the answer of a solved job with the undisturbed one.
fn compare(wanted: &Wanted, scene: &Scene, job: &str, quiet: &Answer) -> PathList {
    let client = scene.client(0);
    let mut solutions = Vec::new();
    client.each_solution(job, |solution| solutions.push(solution));
    let mut same = solutions == quiet.solutions && client.counts(job) == quiet.counts;
    let path_list = match client.paths(job) {
        Ok(paths) => {
            same &= paths == quiet.paths;
            PathList::Whole
        }
        // A result that is damaged after its stage has ended cannot be computed again: the message names it.
        Err(status) => {
            let named = |spoilt: &String| status.message().contains(spoilt.as_str());
            assert!(scene.spoilt.iter().any(named), "no paths: {status}");
            println!("  its paths: {}", status.message());
            PathList::Damaged
        }
    };
    assert!(
        same,
        "job {job} has another answer than without faults (seed {})",
        wanted.seed
    );
    path_list
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
    let storage = match wanted.bucket.then(Storage::start) {
        Some(None) => return ExitCode::SUCCESS,
        Some(Some(storage)) => Some(storage),
        None => None,
    };
    let began = Instant::now();
    let quiet = quiet_answer(&problem(&wanted));
    println!(
        "without faults: {} paths, {:.0} s",
        quiet.counts.paths_total,
        began.elapsed().as_secs_f64()
    );
    let mut scene = Scene::start(&wanted, database, storage);
    let mut dice = Dice(wanted.seed);
    let (mut jobs, mut paths, mut without_paths) = (0, 0, 0);
    let mut faults: Vec<(Fault, Duration)> = Vec::new();
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(wanted.seconds) && jobs < wanted.jobs {
        if wanted.evil_workers {
            scene.add_evil_workers();
        }
        // Another request each time, or it would be the same job.
        let job = scene.client(0).submit(&problem(&wanted));
        let job_began = Instant::now();
        faults.extend(disturb(&wanted, &mut scene, &mut dice, database, &job));
        let client = scene.client(0);
        client.wait_until_solved(&job);
        without_paths += match compare(&wanted, &scene, &job, &quiet) {
            PathList::Whole => 0,
            PathList::Damaged => 1,
        };
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
    let run = Found {
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
    report(&wanted, &run)
}
