//! Reports and pulls that are sent again: a lost reply changes nothing.

use crate::tracking_by_hand::HandWorker;
use cognate_continuation::item_result::ItemResult;
use cognate_protocol::to_proto;
use cognate_protocol::v1::Verdict;
use cognate_tests::builders::katsura;
use cognate_tests::client::{Submission, accepted};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};

fn small_chunks() -> CoordinatorOptions {
    CoordinatorOptions {
        lease: None,
        chunk_paths: Some(4),
        ..CoordinatorOptions::default()
    }
}

#[test]
fn a_report_counts_once_and_another_one_is_noticed() {
    let mut cluster = Cluster::start(small_chunks());
    let client = cluster.client();
    let job = client.submit(&Submission::of(katsura(4)));
    let mut worker = HandWorker::new(&client, "hand");
    let lease = worker.lease();
    let repeated_lease = worker.pull_again().leases.pop().expect("the same answer");
    assert_eq!(
        (&repeated_lease.id, repeated_lease.count),
        (&lease.id, lease.count)
    );
    assert!(worker.renew(&lease));
    let results = worker.track(&lease);
    assert_eq!(results.len() as u64, lease.count);

    // A report that makes no sense changes nothing.
    assert_eq!(worker.report(&lease, &results[1..]), Verdict::Invalid);
    let mut older = lease.clone();
    older.id.as_mut().expect("an id").epoch += 1;
    assert_eq!(worker.report(&older, &results), Verdict::Stale);
    let done = || accepted(&client.progress(&job).expect("the job is known"));
    assert_eq!(done(), 0);

    assert_eq!(worker.report(&lease, &results), Verdict::Accepted);
    assert_eq!(done(), lease.count);
    for _ in 0..3 {
        assert_eq!(worker.report(&lease, &results), Verdict::AlreadyAccepted);
    }
    assert_eq!(done(), lease.count, "counted once");
    let mut others = results.clone();
    let ItemResult::Track(path) = &mut others[0] else {
        panic!("{:?}", others[0]);
    };
    path.residual *= 1.5;
    assert_eq!(worker.report(&lease, &others), Verdict::HashDiffers);
    assert!(!worker.renew(&lease), "a finished chunk is nobody's");
    assert_eq!(
        done(),
        0,
        "what a worker that contradicts itself did is done again"
    );

    cluster.add_worker(&WorkerOptions::default());
    client.wait_until_solved(&job);
    let answer = client.answer(&job);
    assert_eq!(answer.counts.solutions_distinct, 16);
    for (index, result) in results.iter().enumerate() {
        let path = &answer.paths[lease.first as usize + index];
        let reported = result.path().map(to_proto::path::ended_path);
        assert_eq!(path.result, reported, "another worker has the same bits");
    }
    cluster.stop();
}

#[test]
fn a_report_survives_the_coordinator() {
    let mut cluster = Cluster::start(small_chunks());
    let client = cluster.client();
    let job = client.submit(&Submission::of(katsura(4)));
    let mut worker = HandWorker::new(&client, "hand");
    let lease = worker.lease();
    let results = worker.track(&lease);
    assert_eq!(worker.report(&lease, &results), Verdict::Accepted);
    cluster.kill_coordinator();
    cluster.restart_coordinator();
    // As a worker whose reply was lost with the coordinator.
    let client = cluster.client();
    let worker = HandWorker::new(&client, "hand");
    assert_eq!(worker.report(&lease, &results), Verdict::AlreadyAccepted);
    let progress = client.progress(&job).expect("the job is known");
    assert_eq!(accepted(&progress), lease.count);
    cluster.stop();
}

#[test]
fn a_worker_of_another_revision_gets_nothing() {
    let cluster = Cluster::start(small_chunks());
    let client = cluster.client();
    client.submit(&Submission::of(katsura(4)));
    let worker = HandWorker::new(&client, "other");
    let mut other = HandWorker::machine();
    other.numerics_revision += 1;
    assert!(
        worker.pull_as(1, other).leases.is_empty(),
        "its results would have other bits"
    );
    let mut older = HandWorker::machine();
    older.protocol_version += 1;
    let response = worker.pull_as(2, older);
    assert!(response.leases.is_empty());
    assert!(!response.refused.is_empty(), "and it is told why");
    cluster.stop();
}
