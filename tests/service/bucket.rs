//! Results in a bucket of S3 whose server is killed in the middle: the service stands still, says why, loses nothing, and
//! goes on when the server is there again.

use crate::worker_lost::{begun, nervous, quiet_answer, stuck};
use cognate_tests::client::{accepted, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions};
use cognate_tests::processes::until;
use cognate_tests::storage::Storage;
use std::time::Duration;

#[test]
fn a_killed_server_of_the_results_stops_nothing_for_good() {
    let Some(storage) = Storage::start() else {
        return;
    };
    let expected = quiet_answer();
    let results = storage.address("one");
    let mut cluster = Cluster::start(CoordinatorOptions {
        results: Some(results.clone()),
        environment: storage.environment(),
        ..nervous()
    });
    let (client, job) = begun(&mut cluster);
    storage.kill();
    let words = format!("cannot use {results} for results");
    let explained = until("the job's explanation says why it stands still", || {
        let explained = cluster.command(&["explain", &job]);
        let text = String::from_utf8_lossy(&explained.stdout).into_owned();
        text.contains(&words).then_some(text)
    });
    assert!(explained.contains("nothing is given out"), "{explained}");
    assert!(cluster.coordinator.log().contains(&words));
    let stuck = stuck(&client, &job);
    // A coordinator that begins now does not take absent results for none.
    cluster.kill_coordinator();
    storage.start_again();
    cluster.restart_coordinator();
    let client = cluster.client();
    client.progress_once(&job, "more chunks are done", |p| {
        accepted(p) >= accepted(&stuck) + 100
    });
    storage.kill();
    std::thread::sleep(Duration::from_secs(1));
    storage.start_again();
    client.wait_until_solved(&job);
    assert!(
        client.answer(&job) == *expected,
        "the same answer, bit for bit"
    );
    let end = client.progress(&job).expect("the job is known");
    assert_eq!(accepted(&end), total(&end));

    let ledger = format!("sqlite:{}", cluster.folder().join("ledger.db").display());
    let fsck = cluster.command(&["fsck", "--ledger", &ledger, "--results", &results]);
    assert_eq!(fsck.status.code(), Some(0), "{fsck:?}");
    let other = storage.address("other");
    let refused = cluster.command(&["fsck", "--ledger", &ledger, "--results", &other]);
    assert_eq!(refused.status.code(), Some(3), "{refused:?}");
    let refused = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        refused.contains(&other) && refused.contains("cognate-results"),
        "{refused}"
    );
    let said = cluster.coordinator.log();
    for (name, value) in storage.environment() {
        let is_secret = name.contains("KEY");
        assert!(!is_secret || !said.contains(&value), "{name} is in the log");
    }
    cluster.stop();
}
