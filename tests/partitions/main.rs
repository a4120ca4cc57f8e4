//! Partitions: ten workers join and leave at random, each in a network of its own, and wires are cut for a
//! while. Every answer must be that of a quiet run, bit for bit.
//!
//! `target/release/partitions [--seconds 30] [--seed 1] [--katsura 11] [--bits 53] [--lease-ms 3000]`: jobs in
//! turn for this time, the last to its end. Needs Linux and a user who may make network namespaces; is skipped
//! elsewhere, with the reason.

use cognate_protocol::v1::Precision;
use cognate_protocol::v1::precision::Kind;
use cognate_tests::arguments::{number, options, or_exit};
use cognate_tests::builders::katsura;
use cognate_tests::client::{Submission, accepted, has_ended, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::dice::Dice;
use cognate_tests::namespaces::Network;
use cognate_tests::processes::{PATIENCE, Process};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Workers, each at a place of its own.
const PLACES: usize = 10;
const ADDRESS: &str = "10.77.0.1:7654";
const JOB_PATIENCE: Duration = Duration::from_secs(3600);

struct Wanted {
    seconds: u64,
    seed: u64,
    katsura: usize,
    bits: Option<u32>,
    lease: Duration,
}

fn wanted() -> Result<Wanted, String> {
    let mut wanted = Wanted {
        seconds: 30,
        seed: 1,
        katsura: 11,
        bits: None,
        lease: Duration::from_secs(3),
    };
    for (word, value) in options()? {
        match word.as_str() {
            "--seconds" => wanted.seconds = number(&word, &value)?,
            "--seed" => wanted.seed = number(&word, &value)?,
            "--katsura" => wanted.katsura = number(&word, &value)?,
            "--bits" => wanted.bits = Some(number(&word, &value)?),
            "--lease-ms" => wanted.lease = Duration::from_millis(number(&word, &value)?),
            _ => {
                return Err(format!(
                    "{word}: expected --seconds N, --seed N, --katsura N, --bits N or --lease-ms N"
                ));
            }
        }
    }
    Ok(wanted)
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

/// Processes of the run, and the wires that are cut, with the end of each cut.
struct Scene {
    cluster: Cluster,
    network: Network,
    workers: Vec<Option<Process>>,
    cut: Vec<Option<Instant>>,
    joined: u64,
    left: u64,
    killed: u64,
    cuts: u64,
}

impl Scene {
    fn start(wanted: &Wanted, network: Network) -> Self {
        let cluster = Cluster::start(CoordinatorOptions {
            lease: Some(wanted.lease),
            chunk_paths: Some(32),
            listen: vec![ADDRESS.to_owned()],
            within: network.within_hub(),
            ..CoordinatorOptions::default()
        });
        Self {
            cluster,
            network,
            workers: (0..PLACES).map(|_| None).collect(),
            cut: vec![None; PLACES],
            joined: 0,
            left: 0,
            killed: 0,
            cuts: 0,
        }
    }

    fn join(&mut self, place: usize) {
        self.joined += 1;
        let options = WorkerOptions {
            coordinator: Some(format!("http://{ADDRESS}")),
            within: self.network.within(place),
            ..WorkerOptions::default()
        };
        self.workers[place] = Some(self.cluster.start_worker(&options));
    }

    /// One thing happens at one place.
    fn happen(&mut self, dice: &mut Dice) {
        let place = dice.below(PLACES as u64) as usize;
        match (dice.below(5), self.workers[place].take()) {
            (0..=2, worker) if self.cut[place].is_none() => {
                self.workers[place] = worker;
                self.network.set_wire(place, false);
                // Shorter than a lease, or longer.
                let time = Duration::from_millis(300 + dice.below(6000));
                self.cut[place] = Some(Instant::now() + time);
                self.cuts += 1;
            }
            (_, None) => self.join(place),
            (3, Some(mut worker)) => {
                worker.kill();
                self.killed += 1;
            }
            (_, Some(mut worker)) => {
                worker.terminate();
                // It gives back what it has, where it is heard; where not, nobody waits for it.
                if self.cut[place].is_none() {
                    worker.wait(PATIENCE);
                }
                self.left += 1;
            }
        }
    }

    fn mend(&mut self, every_wire: bool) {
        for place in 0..PLACES {
            if self.cut[place].is_some_and(|until| every_wire || Instant::now() >= until) {
                self.network.set_wire(place, true);
                self.cut[place] = None;
            }
        }
    }
}

fn main() -> ExitCode {
    let wanted = or_exit(wanted());
    let Some(network) = Network::new(PLACES) else {
        return ExitCode::SUCCESS;
    };
    let quiet = {
        let cluster = Cluster::with_workers(2);
        let client = cluster.client();
        let job = client.submit(&problem(&wanted));
        client.wait_until_solved_for(&job, JOB_PATIENCE);
        let answer = client.answer(&job);
        cluster.stop();
        answer
    };
    let mut scene = Scene::start(&wanted, network);
    let mut dice = Dice(wanted.seed);
    for place in 0..PLACES / 2 {
        scene.join(place);
    }
    let begin = Instant::now();
    let (mut jobs, mut paths) = (0, 0);
    while begin.elapsed() < Duration::from_secs(wanted.seconds) {
        let client = scene.cluster.client();
        let job = client.submit(&problem(&wanted));
        let mut next = Instant::now();
        loop {
            let progress = client.progress(&job).expect("the coordinator answers");
            if has_ended(&progress) {
                break;
            }
            if Instant::now() >= next {
                scene.happen(&mut dice);
                next = Instant::now() + Duration::from_millis(100 + dice.below(700));
            }
            scene.mend(false);
            assert!(begin.elapsed() < JOB_PATIENCE, "{progress:?}");
            std::thread::sleep(Duration::from_millis(20));
        }
        client.wait_until_solved(&job);
        assert!(
            client.answer(&job) == quiet,
            "job {job} has another answer than in a quiet network (seed {})",
            wanted.seed
        );
        let end = client.progress(&job).expect("the job is known");
        assert_eq!(accepted(&end), total(&end));
        (jobs, paths) = (jobs + 1, paths + total(&end));
    }
    scene.mend(true);
    let Scene {
        cluster,
        network,
        workers,
        joined,
        left,
        killed,
        cuts,
        ..
    } = scene;
    for mut worker in workers.into_iter().flatten() {
        worker.terminate();
        worker.wait(PATIENCE);
    }
    cluster.stop();
    drop(network);
    println!(
        "{jobs} jobs, {paths} paths in {:.0} s: each answer as in a quiet network, bit for bit",
        begin.elapsed().as_secs_f64()
    );
    println!(
        "  ten places: workers joined {joined} times, left {left} times, were killed {killed} times; \
         wires were cut {cuts} times"
    );
    ExitCode::SUCCESS
}
