//! A worker is killed in the middle: the same solutions, bit for bit.

use cognate_protocol::v1::JobProgress;
use cognate_tests::builders::katsura;
use cognate_tests::client::{Answer, Client, Submission, accepted, has_ended, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::processes::PATIENCE;
use std::sync::OnceLock;
use std::time::Duration;

/// 2048 paths: some seconds of work for one thread at one lane.
pub fn problem() -> Submission {
    Submission::of(katsura(11))
}

/// Slow, so that there is a middle.
pub fn slow_worker() -> WorkerOptions {
    WorkerOptions {
        threads: 1,
        lane_width: Some(1),
        ..WorkerOptions::default()
    }
}

/// Short leases and many chunks.
pub fn nervous() -> CoordinatorOptions {
    CoordinatorOptions {
        lease: Some(Duration::from_secs(2)),
        chunk_paths: Some(32),
        ..CoordinatorOptions::default()
    }
}

/// The problem with two slow workers, some of whose chunks are done.
pub fn begun(cluster: &mut Cluster) -> (Client, String) {
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    let client = cluster.client();
    let job = client.submit(&problem());
    client.progress_once(&job, "some chunks are done", |p| accepted(p) >= 100);
    (client, job)
}

/// A job that does not go on for longer than a lease: workers lose their chunks and keep what they have found.
pub fn stuck(client: &Client, job: &str) -> JobProgress {
    std::thread::sleep(Duration::from_secs(4));
    let stuck = client.progress(job).expect("it still answers");
    assert!(
        !has_ended(&stuck) && accepted(&stuck) < total(&stuck),
        "{stuck:?}"
    );
    stuck
}

/// Answer of the problem without any fault.
pub fn quiet_answer() -> &'static Answer {
    static ANSWER: OnceLock<Answer> = OnceLock::new();
    ANSWER.get_or_init(|| {
        let cluster = Cluster::with_workers(1);
        let answer = cluster.client().solve(&problem());
        assert_eq!(answer.counts.paths_total, 2048);
        assert_eq!(answer.counts.solutions_distinct, 2048);
        cluster.stop();
        answer
    })
}

#[test]
fn a_killed_worker_leaves_no_trace() {
    let expected = quiet_answer();
    let mut cluster = Cluster::start(nervous());
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    let client = cluster.client();
    let job = client.submit(&problem());
    let before = client.progress_once(&job, "some chunks are done", |p| accepted(p) >= 100);
    cluster.workers[0].kill();
    assert!(
        accepted(&before) < total(&before),
        "there was a middle: {before:?}"
    );
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    cluster.workers.remove(0);
    cluster.stop();
}

#[test]
fn all_workers_are_killed_and_another_one_comes() {
    let expected = quiet_answer();
    let mut cluster = Cluster::start(nervous());
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    let client = cluster.client();
    let job = client.submit(&problem());
    client.progress_once(&job, "some chunks are done", |p| accepted(p) >= 100);
    for worker in &mut cluster.workers {
        worker.kill();
    }
    cluster.workers.clear();
    let dead = client.progress(&job).expect("the coordinator is there");
    assert!(
        accepted(&dead) < total(&dead),
        "there was a middle: {dead:?}"
    );
    cluster.add_worker(&WorkerOptions::default());
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    cluster.stop();
}

#[test]
fn a_drained_worker_gives_back_at_once() {
    // The lease is longer than the test waits, so waiting for its end would be noticed.
    let options = CoordinatorOptions {
        lease: Some(Duration::from_secs(3600)),
        chunk_paths: Some(256),
        ..CoordinatorOptions::default()
    };
    let mut cluster = Cluster::start(options);
    cluster.add_worker(&slow_worker());
    let client = cluster.client();
    let job = client.submit(&problem());
    let leased = |p: &cognate_protocol::v1::JobProgress| p.stages.iter().any(|s| s.leased > 0);
    client.progress_once(&job, "a chunk is leased", leased);
    let mut drained = cluster.workers.remove(0);
    drained.terminate();
    let status = drained.wait(PATIENCE);
    assert_eq!(status.code(), Some(0), "it ends well");
    let after = client.progress(&job).expect("the coordinator is there");
    assert!(!leased(&after), "everything is given back: {after:?}");
    cluster.add_worker(&WorkerOptions::default());
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *quiet_answer(),
        "the same answer, bit for bit"
    );
    cluster.stop();
}
