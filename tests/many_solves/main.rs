//! Many solves: the same systems over and over on one warm coordinator with two workers, each time
//! with another seed. Every count must be the published one every time; a table says what it took.
//!
//! `cargo run --release -p cognate-tests --bin many_solves -- [--solves 1000] [--hard 100] [--large 3]`

use cognate_protocol::v1::SummaryCounts;
use cognate_systems::named::{cyclic, eco, katsura, noon};
use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::client::Client;
use cognate_tests::cluster::Cluster;
use cognate_tests::subjects::Subject;
use cognate_tests::systems::shared;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Groups of systems, each with the number of solves.
fn groups(wanted: &Wanted) -> [(u64, Vec<Subject>); 3] {
    [
        (
            wanted.solves,
            vec![
                Subject::named("katsura-6", &katsura(6)),
                Subject::named("cyclic-5", &cyclic(5)),
                Subject::named("noon-4", &noon(4)),
                Subject::new("3-RPR", &shared("three_rpr_real6"), 6),
                Subject::new("Stewart-Gough", &shared("stewart_gough_dietmaier"), 40),
                Subject::new("6R, 8 quadrics", &shared("six_revolute_puma560_tm8"), 16),
                Subject::new("five poses", &shared("burmester_five_poses_real4"), 4),
            ],
        ),
        (
            wanted.hard,
            vec![
                Subject::named("cyclic-7", &cyclic(7)),
                Subject::named("eco-8", &eco(8)),
            ],
        ),
        (
            wanted.large,
            vec![Subject::named("katsura-17", &katsura(17))],
        ),
    ]
}

/// How often each is solved: few times where nothing is said.
struct Wanted {
    solves: u64,
    hard: u64,
    large: u64,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        solves: 20,
        hard: 2,
        large: 0,
    };
    for (word, value) in options()? {
        let number = number(&word, &value)?;
        match word.as_str() {
            "--solves" => wanted.solves = number,
            "--hard" => wanted.hard = number,
            "--large" => wanted.large = number,
            _ => {
                return Err(format!(
                    "{word}: expected --solves N, --hard N or --large N"
                ));
            }
        }
    }
    Ok(wanted)
}

/// Sums over all solves of one system.
#[derive(Default)]
struct Tally {
    solves: u64,
    paths: u64,
    retracked: u64,
    failed: u64,
    /// Seeds with another count, or with paths that are in no class.
    wrong: Vec<u64>,
    took: Duration,
}

impl Tally {
    fn take(&mut self, seed: u64, subject: &Subject, counts: &SummaryCounts) {
        self.solves += 1;
        self.paths += counts.paths_total;
        self.retracked += counts.paths_retracked;
        self.failed += counts.paths_failed;
        if !subject.is_right(counts) {
            self.wrong.push(seed);
        }
    }
}

fn solve(client: &Client, subject: &Subject, times: u64) -> Tally {
    let mut tally = Tally::default();
    let begin = Instant::now();
    for seed in 1..=times {
        let job = client.submit(&subject.submission(seed));
        client.wait_until_solved(&job);
        tally.take(seed, subject, &client.counts(&job));
    }
    tally.took = begin.elapsed();
    tally
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    let cluster = Cluster::with_workers(2);
    let client = cluster.client();
    println!(
        "system          solutions  solves  right      paths  failed  tracked again  ms a solve"
    );
    let mut good = true;
    for (times, subjects) in groups(&wanted) {
        for subject in subjects.iter().filter(|_| times > 0) {
            let tally = solve(&client, subject, times);
            println!(
                "{:<15} {:>9}  {:>6} {:>6} {:>10}  {:>6}  {:>13}  {:>10.1}",
                subject.name,
                subject.solutions,
                tally.solves,
                tally.solves - tally.wrong.len() as u64,
                tally.paths,
                tally.failed,
                tally.retracked,
                tally.took.as_secs_f64() * 1e3 / times as f64
            );
            if !tally.wrong.is_empty() {
                println!("  NOT RIGHT with seeds {:?}", tally.wrong);
            }
            good &= tally.wrong.is_empty() && tally.failed == 0;
        }
    }
    cluster.stop();
    if good {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
