//! A ledger that is cut, or empty beside full results, is said and not believed (rows 15 and 22).

use cognate_tests::builders::square_root_of_two;
use cognate_tests::client::Submission;
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::processes::{PATIENCE, until};
use std::fs::File;

/// Cuts a file to `bytes` bytes.
fn cut(file: &std::path::Path, bytes: u64) {
    let opened = File::options().write(true).open(file);
    let cut = opened.and_then(|file| file.set_len(bytes));
    cut.expect("the ledger can be cut");
}

#[test]
fn a_ledger_that_is_cut_gives_nothing_out_and_says_so() {
    let mut cluster = Cluster::start(CoordinatorOptions::default());
    let first = cluster
        .client()
        .submit(&Submission::of(square_root_of_two()));
    // A new process has nothing of the ledger in memory.
    cluster.coordinator.terminate();
    cluster.coordinator.wait(PATIENCE);
    cluster.restart_coordinator();
    let client = cluster.client();
    // Damage to the file alone would be no loss: newer data stand beside it.
    for file in ["ledger.db", "ledger.db-wal"] {
        cut(&cluster.folder().join(file), 100);
    }
    let log = until("the coordinator says what is wrong", || {
        let log = cluster.coordinator.log();
        log.contains("no chunk is given out until this is mended")
            .then_some(log)
    });
    assert!(log.contains("malformed") || log.contains("not a database") || log.contains("disk"));
    let refused = client.try_submit(&Submission::of(square_root_of_two()));
    let refused = refused.expect_err("nothing can be remembered");
    println!("a submission hears: {refused}");
    let explained = cluster.command(&["explain", &first]);
    assert_ne!(explained.status.code(), Some(0), "{explained:?}");
}

#[test]
fn an_empty_ledger_beside_results_is_warned_of() {
    let mut cluster = Cluster::start(CoordinatorOptions::default());
    cluster.add_worker(&WorkerOptions::default());
    let client = cluster.client();
    client.solve(&Submission::of(square_root_of_two()));
    cluster.kill_coordinator();
    let ledger = cluster.folder().join("ledger.db");
    cut(&ledger, 0);
    for more in ["db-wal", "db-shm"] {
        let _ = std::fs::remove_file(ledger.with_extension(more));
    }
    cluster.restart_coordinator();
    until("the coordinator warns", || {
        let log = cluster.coordinator.log();
        log.contains("the ledger knows of no job, and there are results")
            .then_some(())
    });
}
