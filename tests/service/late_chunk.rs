//! A worker stands still with a job's last chunks: an idle one does them, too, and the job ends long
//! before the lease does.

use crate::worker_lost::{problem, quiet_answer, slow_worker};
use cognate_tests::client::{accepted, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions};
use cognate_tests::processes::PATIENCE;
use std::time::{Duration, Instant};

/// Length of a lease: a worker keeps its chunk for this time without a word.
const LEASE: Duration = Duration::from_secs(300);

#[test]
fn a_worker_that_stands_still_does_not_hold_up_the_end() {
    let expected = quiet_answer();
    let mut cluster = Cluster::start(CoordinatorOptions {
        lease: Some(LEASE),
        chunk_paths: Some(32),
        ..CoordinatorOptions::default()
    });
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    let client = cluster.client();
    let job = client.submit(&problem());
    let before = client.progress_once(&job, "some chunks are done", |p| accepted(p) >= 500);
    assert!(
        accepted(&before) < total(&before),
        "there was a middle: {before:?}"
    );
    let begin = Instant::now();
    cluster.workers[0].freeze();
    let held = client.progress_once(&job, "only its chunks are left, or nothing", |p| {
        p.stages.iter().all(|s| s.ready == 0)
    });
    client.wait_until_solved(&job);
    let took = begin.elapsed();
    println!(
        "ended {:.1} s after the worker stood still",
        took.as_secs_f64()
    );
    assert!(took < LEASE / 2, "{took:?}, while {held:?}");
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    let explained = cluster.command(&["explain", &job]);
    let explained = String::from_utf8_lossy(&explained.stdout).into_owned();
    let late = explained.lines().find(|line| line.starts_with("late: "));
    let late = late.unwrap_or_else(|| panic!("chunks were given twice: {explained}"));
    println!("{late}");

    // It wakes up, reports what others have done, and is as good as new.
    cluster.workers[0].thaw();
    let mut other = cluster.workers.remove(1);
    other.terminate();
    other.wait(PATIENCE);
    assert!(client.solve(&problem()) == *expected);
    assert!(client.answer(&job) == *expected, "nothing came too late");
    cluster.stop();
}
