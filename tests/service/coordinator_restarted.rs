//! The coordinator is killed in the middle and started again on its ledger: the job goes on.

use crate::worker_lost::{nervous, problem, quiet_answer, slow_worker};
use cognate_tests::client::{Client, accepted, total};
use cognate_tests::cluster::Cluster;
use std::collections::{HashMap, HashSet};

/// `job/stage/chunk` of a line that names a lease `job/stage/chunk/epoch`.
fn chunk_of(line: &str) -> Option<&str> {
    let lease = line.split("lease=").nth(1)?.split_whitespace().next()?;
    lease.rsplit_once('/').map(|(chunk, _)| chunk)
}

/// No worker began a chunk after it, or another worker, had been told that it is accepted. A
/// worker's log is in the order of time; between workers only the epochs could tell.
fn check_not_tracked_again(cluster: &Cluster) {
    let mut accepted_by = HashMap::new();
    for (number, worker) in cluster.workers.iter().enumerate() {
        let log = worker.log();
        let mut accepted = HashSet::new();
        for line in log.lines() {
            let Some(chunk) = chunk_of(line) else {
                continue;
            };
            if line.contains("accepted") {
                let before = accepted_by.insert(chunk.to_owned(), number);
                assert_eq!(before, None, "{chunk} was accepted twice");
                accepted.insert(chunk.to_owned());
            } else if line.contains("tracking") {
                assert!(
                    !accepted.contains(chunk),
                    "{chunk} was tracked after it was accepted"
                );
            }
        }
    }
    assert!(
        accepted_by.len() >= 64,
        "{} chunks are in the logs",
        accepted_by.len()
    );
}

fn accepted_paths(client: &Client) -> u64 {
    client
        .workers()
        .iter()
        .map(|worker| worker.accepted_paths)
        .sum()
}

#[test]
fn a_job_outlives_its_coordinator_twice() {
    let expected = quiet_answer();
    let mut cluster = Cluster::start(nervous());
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    let job = cluster.client().submit(&problem());
    for threshold in [100, 800] {
        let client = cluster.client();
        let before =
            client.progress_once(&job, "some chunks are done", |p| accepted(p) >= threshold);
        assert!(
            accepted(&before) < total(&before),
            "there was a middle: {before:?}"
        );
        cluster.kill_coordinator();
        cluster.restart_coordinator();
        let after = cluster.client().progress(&job).expect("the job is known");
        assert!(
            accepted(&after) >= accepted(&before),
            "what was accepted stays accepted"
        );
    }
    let client = cluster.client();
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    let end = client.progress(&job).expect("the job is known");
    let counted = accepted_paths(&client);
    assert_eq!(
        counted,
        total(&end),
        "each path was accepted from one worker, once"
    );
    check_not_tracked_again(&cluster);
    cluster.stop();
}

#[test]
fn a_finished_job_is_read_again_as_it_was() {
    let mut cluster = Cluster::with_workers(2);
    let client = cluster.client();
    let job = client.submit(&problem());
    client.wait_until_solved(&job);
    let live = client.answer(&job);
    let live_summary = cluster.command(&["results", &job, "--format", "json"]);
    cluster.kill_coordinator();
    cluster.restart_coordinator();
    assert!(
        cluster.client().answer(&job) == live,
        "replayed state equals live state"
    );
    let replayed = cluster.command(&["results", &job, "--format", "json"]);
    assert_eq!(
        replayed.stdout, live_summary.stdout,
        "to the letter, times included"
    );
    cluster.stop();
}
