//! `cognate fsck` and `cognate backup`: beside a running coordinator, with faults that are planted.

use cognate_tests::builders::{katsura, square_root_of_two};
use cognate_tests::client::{Submission, accepted, total};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

const DATA: [&str; 4] = ["--ledger", "sqlite:ledger.db", "--results", "results"];

/// Output of `fsck`, which must end with this code.
fn fsck(cluster: &Cluster, more: &[&str], code: i32) -> Value {
    let arguments = [&["fsck", "--format", "json"], more].concat();
    let output = cluster.command(&arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{errors}");
    serde_json::from_slice(&output.stdout).expect("one object")
}

fn a_file_in(folder: &Path) -> PathBuf {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .expect("it is there")
        .map(|entry| entry.expect("it can be read").path())
        .collect();
    entries.sort();
    entries.swap_remove(0)
}

#[test]
fn planted_faults_are_found_and_litter_is_removed() {
    let mut cluster = Cluster::start(CoordinatorOptions {
        chunk_paths: Some(8),
        ..CoordinatorOptions::default()
    });
    cluster.add_worker(&WorkerOptions::default());
    let client = cluster.client();
    let job = client.submit(&Submission::of(katsura(5)));
    client.wait_until_solved(&job);
    let small = client.submit(&Submission::of(square_root_of_two()));
    client.wait_until_solved(&small);
    let said = fsck(&cluster, &DATA, 0);
    assert_eq!(
        (&said["sound"], &said["jobs"]),
        (&true.into(), &2.into()),
        "{said}"
    );
    let checked = said["checked"].as_u64().expect("a number");
    assert!(checked >= 4 + 2 * 5, "{said}");

    // The results of one chunk, one byte of another one's, an object of nobody's, results of a job that is not in
    // the ledger, and what a writer left that was killed.
    let results = cluster.folder().join("results");
    let of_job = results.join("jobs").join(&job);
    fs::remove_file(a_file_in(&of_job)).unwrap();
    let flipped = a_file_in(&of_job);
    let mut bytes = fs::read(&flipped).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&flipped, bytes).unwrap();
    let digest = "ab".repeat(32);
    fs::create_dir_all(results.join("objects/ab")).unwrap();
    let nobodys = results.join("objects/ab").join(&digest);
    fs::write(&nobodys, "litter").unwrap();
    let unknown = results.join("jobs/0123456789abcdef");
    fs::create_dir(&unknown).unwrap();
    fs::write(unknown.join("0.0-8.1"), "litter").unwrap();
    let unfinished = results.join("objects/ab/cdef#1");
    fs::write(&unfinished, "half").unwrap();
    let then = SystemTime::now() - Duration::from_secs(7200);
    fs::File::options()
        .write(true)
        .open(&unfinished)
        .unwrap()
        .set_modified(then)
        .unwrap();
    let said = fsck(&cluster, &DATA, 1);
    let faults = said["faults"].as_array().expect("a list");
    let missing = faults
        .iter()
        .filter(|fault| fault["missing"] == true)
        .count();
    assert_eq!((faults.len(), missing), (2, 1), "{said}");
    assert!(
        faults.iter().all(|fault| fault["job"] == job.as_str()),
        "{said}"
    );
    assert_eq!(said["unknown_jobs"][0], "0123456789abcdef", "{said}");
    let litter = said["unnamed"]["objects"].as_u64().expect("a number");
    assert!(litter >= 1, "{said}");
    assert_eq!(
        said["unfinished_files"].as_array().map(Vec::len),
        Some(1),
        "{said}"
    );
    assert!(
        nobodys.exists() && unfinished.exists() && unknown.exists(),
        "nothing is changed"
    );

    let table = cluster.command(&[&["fsck"], &DATA[..]].concat());
    assert!(String::from_utf8_lossy(&table.stdout).contains("damaged"));
    let lost = client.paths(&job).expect_err("results are lost");
    assert_eq!(lost.code(), tonic::Code::DataLoss, "{lost}");

    // The results that were lost are those of pure paths (attack N of the third attack on the service, 2026-11).
    let said = fsck(&cluster, &[&DATA[..], &["--repair"]].concat(), 0);
    assert_eq!(said["repaired_chunks"], 2, "{said}");
    assert!(said["removed"]["objects"].as_u64() >= Some(2), "{said}");
    assert!(!nobodys.exists() && !unfinished.exists() && !unknown.exists());
    let said = fsck(&cluster, &DATA, 0);
    assert_eq!(said["unnamed"]["objects"], 0, "{said}");
    assert_eq!(said["trash"]["objects"], litter, "{said}");
    assert_eq!(said["checked"], checked, "{said}");
    assert!(
        client.answer(&small).counts.paths_total == 2,
        "the other job is whole"
    );
    assert_eq!(client.paths(&job).expect("they are there again").len(), 32);

    // A ledger that does not exist is not created.
    let none = ["fsck", "--ledger", "sqlite:none.db", "--results", "results"];
    assert_eq!(cluster.command(&none).status.code(), Some(2));
    assert!(!cluster.folder().join("none.db").exists());
    cluster.stop();
}

#[test]
fn a_copy_taken_in_the_middle_of_a_job_goes_on_to_the_same_answer() {
    let options = || CoordinatorOptions {
        chunk_paths: Some(16),
        ..CoordinatorOptions::default()
    };
    let mut cluster = Cluster::start(options());
    let slow = WorkerOptions {
        lane_width: Some(1),
        ..WorkerOptions::default()
    };
    cluster.add_worker(&slow);
    let client = cluster.client();
    let done = client.submit(&Submission::of(katsura(5)));
    client.wait_until_solved(&done);
    let job = client.submit(&Submission::of(katsura(10)));
    client.progress_once(&job, "some chunks are done", |p| accepted(p) >= 64);
    let backup = cluster.command(&[&["backup", "copy"], &DATA[..]].concat());
    let said = String::from_utf8_lossy(&backup.stdout);
    let errors = String::from_utf8_lossy(&backup.stderr);
    assert_eq!(backup.status.code(), Some(0), "{said}{errors}");
    println!("{said}");
    let second_backup = cluster.command(&[&["backup", "copy"], &DATA[..]].concat());
    assert_eq!(
        second_backup.status.code(),
        Some(2),
        "a copy is not written over"
    );
    client.wait_until_solved(&job);
    let answers = [client.answer(&done), client.answer(&job)];

    let mut copy = Cluster::start(CoordinatorOptions {
        data: Some(cluster.folder().join("copy")),
        ..options()
    });
    let client = copy.client();
    let at = client.progress(&job).expect("the job is known");
    println!("the copy has {} of {} paths", accepted(&at), total(&at));
    assert!(accepted(&at) >= 64 && accepted(&at) < total(&at));
    copy.add_worker(&WorkerOptions::default());
    client.wait_until_solved(&job);
    assert!(client.answer(&done) == answers[0]);
    assert!(
        client.answer(&job) == answers[1],
        "the same answer, bit for bit"
    );
    copy.stop();
    cluster.stop();
}
