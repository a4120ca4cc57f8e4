//! `cognate delete`: jobs go with all that only they need, also where the coordinator is killed in the middle.

use cognate_tests::builders::{katsura, square_root_of_two};
use cognate_tests::client::{Answer, Submission};
use cognate_tests::cluster::{Cluster, CoordinatorOptions, WorkerOptions};
use cognate_tests::processes::{cognate, until};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

fn cluster() -> Cluster {
    let mut cluster = Cluster::start(CoordinatorOptions {
        chunk_paths: Some(4),
        garbage: Some(Duration::from_millis(500)),
        ..CoordinatorOptions::default()
    });
    cluster.add_worker(&WorkerOptions::default());
    cluster
}

/// All files in a folder and in those in it.
fn files(folder: &Path) -> Vec<String> {
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        match entry.path().is_dir() {
            true => paths.extend(files(&entry.path())),
            false => paths.push(entry.path().display().to_string()),
        }
    }
    paths
}

/// Waits until nothing is left of all jobs but the file that marks the folder.
fn until_empty(results: &Path) {
    until("nothing is left of the deleted jobs", || {
        let left = files(results);
        (left.len() == 1 && left[0].ends_with("cognate-results")).then_some(())
    });
}

#[test]
fn deleted_jobs_take_what_only_they_need() {
    let cluster = cluster();
    let client = cluster.client();
    let results = cluster.folder().join("results");
    let solve = |text: &str| {
        let job = client.submit(&Submission::of(text));
        client.wait_until_solved(&job);
        job
    };
    let (first, second) = (solve(&katsura(5)), solve(&katsura(5)));
    let kept = solve(&square_root_of_two());
    let answers = [client.answer(&second), client.answer(&kept)];
    let deleted = cluster.command(&["delete", &first, "0123456789abcdef", "--format", "json"]);
    let said = String::from_utf8_lossy(&deleted.stderr);
    assert_eq!(deleted.status.code(), Some(2), "{said}");
    assert!(said.contains("0123456789abcdef"), "{said}");
    let said: Value = serde_json::from_slice(&deleted.stdout).expect("one object a job");
    assert_eq!(said["job"], first.as_str());
    assert!(
        said["chunks"].as_u64() >= Some(8) && said["bytes"].as_u64() > Some(0),
        "{said}"
    );
    assert!(!results.join("jobs").join(&first).exists());
    let shown = cluster.command(&["results", &first]);
    assert_eq!(shown.status.code(), Some(2));
    // The other has the same system, stages and solutions.
    std::thread::sleep(Duration::from_secs(3));
    assert!(client.answer(&second) == answers[0] && client.answer(&kept) == answers[1]);
    let second_deletion = cluster.command(&["delete", &first]);
    assert_eq!(second_deletion.status.code(), Some(0));
    let said = String::from_utf8_lossy(&second_deletion.stdout);
    assert!(said.contains("had been deleted before"), "{said}");

    // One that goes on is refused, unless it may be cancelled.
    let goes_on = client.submit(&Submission::of(katsura(12)));
    let refused = cluster.command(&["delete", &goes_on]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(said.contains("--cancel-first"), "{said}");
    let rest = ["delete", "--cancel-first", &goes_on, &second, &kept];
    let deleted = cluster.command(&rest);
    assert_eq!(deleted.status.code(), Some(0));
    until_empty(&results);
    cluster.stop();
}

#[test]
fn a_coordinator_that_is_killed_while_it_deletes_leaves_whole_jobs_or_none() {
    let mut cluster = cluster();
    let results = cluster.folder().join("results");
    let client = cluster.client();
    let jobs: Vec<String> = (0..12)
        .map(|_| client.submit(&Submission::of(katsura(6))))
        .collect();
    for job in &jobs {
        client.wait_until_solved(job);
    }
    let answer: Answer = client.answer(&jobs[0]);
    let mut partly = 0;
    for pause in [40, 10, 90] {
        let mut delete = Command::new(cognate())
            .arg("delete")
            .args(&jobs)
            .env("COGNATE_COORDINATOR", cluster.address())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("cognate can be started");
        std::thread::sleep(Duration::from_millis(pause));
        cluster.kill_coordinator();
        delete.wait().expect("it ends");
        cluster.restart_coordinator();
        let client = cluster.client();
        let left: Vec<&String> = jobs.iter().filter(|j| client.progress(j).is_ok()).collect();
        println!(
            "after {pause} ms: {} of {} jobs are left",
            left.len(),
            jobs.len()
        );
        partly += usize::from(!left.is_empty() && left.len() < jobs.len());
        for job in left {
            assert!(client.answer(job) == answer, "what is left is whole");
        }
    }
    println!("{partly} of 3 kills were in the middle");
    let deleted = cluster.command(
        &std::iter::once("delete")
            .chain(jobs.iter().map(String::as_str))
            .collect::<Vec<_>>(),
    );
    assert_eq!(deleted.status.code(), Some(0));
    until_empty(&results);
    cluster.stop();
}
