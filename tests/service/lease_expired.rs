//! A worker stands still for longer than its lease: another one takes over, its late report is stale.

use crate::tracking_by_hand::HandWorker;
use crate::worker_lost::{problem, quiet_answer, slow_worker};
use cognate_protocol::v1::Verdict;
use cognate_tests::builders::katsura;
use cognate_tests::client::{Submission, accepted, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::processes::PATIENCE;
use std::time::Duration;

#[test]
fn a_frozen_worker_is_replaced_and_goes_on_when_it_wakes() {
    let expected = quiet_answer();
    let mut cluster = Cluster::start(CoordinatorOptions {
        lease: Some(Duration::from_secs(1)),
        chunk_paths: Some(64),
        ..CoordinatorOptions::default()
    });
    cluster.add_worker(&slow_worker());
    let client = cluster.client();
    let job = client.submit(&problem());
    let before = client.progress_once(&job, "some chunks are done", |p| accepted(p) >= 100);
    assert!(
        accepted(&before) < total(&before),
        "there was a middle: {before:?}"
    );
    cluster.workers[0].freeze();
    cluster.add_worker(&WorkerOptions::default());
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );

    // It wakes with leases that are long over, leaves them alone, and is as good as new.
    cluster.workers[0].thaw();
    let mut other = cluster.workers.remove(1);
    other.terminate();
    other.wait(PATIENCE);
    assert_eq!(
        client
            .solve(&Submission::of(katsura(3)))
            .counts
            .solutions_distinct,
        8
    );
    assert!(
        client.answer(&job) == *expected,
        "nothing of it came too late"
    );
    cluster.stop();
}

#[test]
fn a_late_report_is_stale() {
    let mut cluster = Cluster::start(CoordinatorOptions {
        lease: Some(Duration::from_millis(500)),
        chunk_paths: Some(4),
        ..CoordinatorOptions::default()
    });
    let client = cluster.client();
    let job = client.submit(&Submission::of(katsura(4)));
    let mut late = HandWorker::new(&client, "late");
    let lease = late.lease();
    let results = late.track(&lease);
    std::thread::sleep(Duration::from_millis(1500));
    assert!(!late.renew(&lease), "the lease is over");
    // The chunk is free again; a report under the old lease is refused.
    assert_eq!(late.report(&lease, &results), Verdict::Stale);
    let progress = client.progress(&job).expect("the job is known");
    assert_eq!(accepted(&progress), 0);
    cluster.add_worker(&WorkerOptions::default());
    client.wait_until_solved(&job);
    let answer = client.answer(&job);
    assert_eq!(
        late.report(&lease, &results),
        Verdict::Stale,
        "also after the end"
    );
    assert!(client.answer(&job) == answer);
    cluster.stop();
}
