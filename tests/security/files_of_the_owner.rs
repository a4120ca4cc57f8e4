//! Whatever a coordinator writes is readable for its user alone, whatever the mask of its shell (row 20).

use cognate_tests::builders::square_root_of_two;
use cognate_tests::client::Submission;
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

/// Files and folders below this one that others than their user may read, write or enter.
fn open_to_others(folder: &Path, open_paths: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let Ok(about) = entry.metadata() else {
            continue;
        };
        if about.permissions().mode() & 0o077 != 0 {
            open_paths.push(entry.path());
        }
        if about.is_dir() {
            open_to_others(&entry.path(), open_paths);
        }
    }
}

#[test]
fn ledger_and_results_are_of_their_user_alone() {
    let data = tempfile::TempDir::new().expect("a temporary folder");
    let service = data.path().join("service");
    std::fs::create_dir(&service).expect("there is room");
    let words = ["sh", "-c", "umask 0; exec \"$@\"", "sh"];
    let mut cluster = Cluster::start(CoordinatorOptions {
        data: Some(service.clone()),
        within: words.map(str::to_owned).to_vec(),
        ..CoordinatorOptions::default()
    });
    cluster.add_worker(&WorkerOptions::default());
    let client = cluster.client();
    client.solve(&Submission::of(square_root_of_two()));
    let mut open_paths = Vec::new();
    open_to_others(&service, &mut open_paths);
    assert!(open_paths.is_empty(), "others may read {open_paths:?}");
    let socket = cluster.folder().join("coordinator.sock");
    let mode = std::fs::metadata(socket).expect("it listens").permissions();
    assert_eq!(mode.mode() & 0o077, 0, "others may connect");
    assert!(service.join("ledger.db").is_file() && service.join("results/jobs").is_dir());
    cluster.stop();
}
