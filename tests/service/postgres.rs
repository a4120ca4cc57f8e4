//! Two coordinators over one PostgreSQL: either may be killed, and the server, too.

use crate::worker_lost::{nervous, problem, quiet_answer, slow_worker};
use cognate_tests::client::{Client, accepted, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::database::Database;
use std::time::Duration;

#[test]
fn coordinators_and_the_server_may_be_killed() {
    let Some(server) = Database::start() else {
        return;
    };
    let expected = quiet_answer();
    let mut cluster = Cluster::start(CoordinatorOptions {
        ledger: Some(server.url()),
        ..nervous()
    });
    let (mut second, second_address) = cluster.second_coordinator();
    for _ in 0..2 {
        cluster.add_worker(&WorkerOptions {
            second: Some(second_address.clone()),
            ..slow_worker()
        });
    }
    let job = cluster.client().submit(&problem());
    let other = Client::connect(&second_address).expect("the second one answers");
    let middle = |threshold| {
        let before =
            other.progress_once(&job, "some chunks are done", |p| accepted(p) >= threshold);
        assert!(accepted(&before) < total(&before), "{before:?}");
        accepted(&before)
    };
    middle(100);
    cluster.kill_coordinator();
    let before = middle(500);
    server.kill_and_start();
    other.wait_until_solved(&job);
    assert!(
        other.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    let after = other.progress(&job).expect("the job is known");
    assert!(accepted(&after) >= before && accepted(&after) == total(&after));
    let counted: u64 = other.workers().iter().map(|w| w.accepted_paths).sum();
    assert_eq!(counted, total(&after), "each path was accepted once");

    // The first coordinator comes back and knows all of it; a client uses the first coordinator that answers.
    cluster.restart_coordinator();
    assert!(cluster.client().answer(&job) == *expected);
    cluster.kill_coordinator();
    let both = format!("{},{second_address}", cluster.address());
    let shown = cluster.command(&["results", &job, "--format", "json", "--coordinator", &both]);
    assert_eq!(shown.status.code(), Some(0), "{shown:?}");
    // It waits for a server that comes up after it.
    server.kill();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(Duration::from_secs(2));
            server.start_again();
        });
        cluster.restart_coordinator();
    });
    assert!(cluster.client().answer(&job) == *expected);
    second.terminate();
    second.wait(cognate_tests::processes::PATIENCE);
    cluster.stop();
}
