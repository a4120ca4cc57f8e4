//! Workers by shared memory: results equal to those by gRPC, bit for bit, also if a process is killed; and gRPC where
//! there is no shared memory.

use crate::worker_lost::{nervous, problem, quiet_answer, slow_worker};
use cognate_tests::client::{accepted, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::processes::until;
use cognate_tests::skip::skip;
use std::time::Duration;

/// Whether the coordinator offers shared memory here; where not, why is printed.
fn offered(cluster: &Cluster) -> bool {
    let log = cluster.coordinator.log();
    match log.lines().find(|line| line.contains("no shared memory")) {
        None => true,
        Some(line) => {
            skip(line);
            false
        }
    }
}

fn by(transport: &'static str) -> WorkerOptions {
    WorkerOptions {
        transport: Some(transport),
        ..slow_worker()
    }
}

#[test]
fn two_by_shared_memory_and_one_by_grpc_solve_one_job() {
    let mut cluster = Cluster::start(nervous());
    if !offered(&cluster) {
        return;
    }
    for transport in ["auto", "shared-memory", "grpc"] {
        cluster.add_worker(&by(transport));
    }
    let client = cluster.client();
    let ways = || {
        let mut ways: Vec<_> = client
            .workers()
            .into_iter()
            .map(|worker| worker.transport)
            .collect();
        ways.sort();
        ways
    };
    let wanted = ["grpc", "shared-memory", "shared-memory"];
    until("all three are there", || (ways() == wanted).then_some(()));
    // A worker that the machine lets wait may get nothing of a single job.
    until("all three have worked", || {
        let job = client.submit(&problem());
        client.wait_until_solved(&job);
        assert!(
            client.answer(&job) == *quiet_answer(),
            "the same answer, bit for bit"
        );
        let workers = client.workers();
        workers
            .iter()
            .all(|worker| worker.accepted_paths > 0)
            .then_some(())
    });
    assert_eq!(ways(), wanted);
    cluster.stop();
}

#[test]
fn killed_workers_leave_nothing_in_the_way() {
    let mut cluster = Cluster::start(nervous());
    if !offered(&cluster) {
        return;
    }
    for _ in 0..2 {
        cluster.add_worker(&by("shared-memory"));
    }
    let client = cluster.client();
    let job = client.submit(&problem());
    for threshold in [100, 500] {
        let before =
            client.progress_once(&job, "some chunks are done", |p| accepted(p) >= threshold);
        assert!(accepted(&before) < total(&before), "{before:?}");
        let mut killed = cluster.workers.remove(0);
        // The others may have done all that was done.
        until("it works by shared memory", || {
            killed.log().contains("by shared memory").then_some(())
        });
        killed.kill();
        cluster.add_worker(&by("shared-memory"));
    }
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *quiet_answer(),
        "the same answer, bit for bit"
    );
    until("the last one works by shared memory", || {
        let log = cluster.workers[1].log();
        log.contains("by shared memory").then_some(())
    });
    cluster.stop();
}

#[test]
fn workers_outlive_their_coordinator_and_meet_the_next() {
    let mut cluster = Cluster::start(nervous());
    if !offered(&cluster) {
        return;
    }
    cluster.add_worker(&by("shared-memory"));
    let job = cluster.client().submit(&problem());
    let some = |p: &cognate_protocol::v1::JobProgress| accepted(p) >= 100;
    cluster
        .client()
        .progress_once(&job, "some chunks are done", some);
    cluster.kill_coordinator();
    cluster.restart_coordinator();
    let client = cluster.client();
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *quiet_answer(),
        "the same answer, bit for bit"
    );
    let log = || cluster.workers[0].log();
    let ended = "shared memory ended; on by gRPC";
    assert!(log().contains(ended), "{}", log());
    // It looks for it again after a pause, which may be longer than the job.
    until("shared memory again, with the next coordinator", || {
        (log().matches("by shared memory").count() >= 2).then_some(())
    });
    cluster.stop();
}

#[test]
fn whoever_is_stopped_and_goes_on_keeps_shared_memory() {
    let mut cluster = Cluster::start(nervous());
    if !offered(&cluster) {
        return;
    }
    cluster.add_worker(&by("shared-memory"));
    until("it works by shared memory", || {
        let log = cluster.workers[0].log();
        log.contains("by shared memory").then_some(())
    });
    // Both wait for a bell meanwhile.
    for _ in 0..5 {
        for process in [&mut cluster.coordinator, &mut cluster.workers[0]] {
            process.freeze();
            std::thread::sleep(Duration::from_millis(50));
            process.thaw();
        }
    }
    let client = cluster.client();
    assert!(client.solve(&problem()) == *quiet_answer());
    for process in [&cluster.coordinator, &cluster.workers[0]] {
        let log = process.log();
        assert!(!log.contains("shared memory ended"), "{log}");
    }
    assert_eq!(client.workers()[0].transport, "shared-memory");
    cluster.stop();
}

#[test]
fn where_dev_shm_is_too_full_work_goes_by_grpc() {
    let mut cluster = Cluster::start(CoordinatorOptions {
        least_free_mib: Some(1 << 40),
        ..CoordinatorOptions::default()
    });
    cluster.add_worker(&WorkerOptions {
        transport: Some("shared-memory"),
        ..WorkerOptions::default()
    });
    let client = cluster.client();
    let job = client.submit(&problem());
    client.wait_until_solved(&job);
    assert!(client.answer(&job) == *quiet_answer());
    assert_eq!(client.workers()[0].transport, "grpc");
    let why = "MiB are wanted";
    let log = cluster.coordinator.log();
    assert!(log.contains(why), "the coordinator says why: {log}");
    let log = cluster.workers[0].log();
    assert!(log.contains("no shared memory; by gRPC"), "{log}");
    cluster.stop();
}
