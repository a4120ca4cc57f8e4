//! From a file to a result, as a person types it: submit, watch, results, and the embedded solve.

use cognate_tests::builders::{example, square_root_of_two};
use cognate_tests::cluster::Cluster;
use cognate_tests::processes::cognate;
use serde_json::Value;
use std::process::{Command, Output};

fn text(output: &[u8]) -> String {
    String::from_utf8_lossy(output).into_owned()
}

/// Standard output of a command that must end with this code.
fn expect(output: &Output, code: i32) -> String {
    let (out, errors) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(code), "{out}\n{errors}");
    out
}

/// Checks what every summary promises, and the counts of this problem.
fn check(summary: &Value, paths: u64, nonsingular: u64, real: u64) {
    let counts = &summary["paths"];
    let classes = [
        "finite",
        "singular",
        "positive_dimensional",
        "undecided",
        "within_data_accuracy",
        "excess",
        "at_infinity",
        "failed",
    ];
    let sum: u64 = classes
        .iter()
        .map(|class| counts[class].as_u64().unwrap_or(0))
        .sum();
    assert_eq!(counts["total"], paths, "{summary:#}");
    assert_eq!(sum, paths, "every path is counted once: {counts:#}");
    assert_eq!(counts["failed"], 0, "{counts:#}");
    assert_eq!(
        summary["solutions"]["nonsingular"], nonsingular,
        "{summary:#}"
    );
    assert_eq!(summary["solutions"]["real"], real, "{summary:#}");
}

#[test]
fn a_platform_is_solved_by_a_coordinator_and_two_workers() {
    let cluster = Cluster::with_workers(2);
    let file = cluster.folder().join("platform.bertini");
    std::fs::write(&file, example("stewart_gough_dietmaier.bertini")).unwrap();
    let file = file.display().to_string();

    let job = expect(&cluster.command(&["submit", &file]), 0);
    let job = job.trim();
    assert!(
        !job.is_empty() && !job.contains(char::is_whitespace),
        "the id alone: {job:?}"
    );
    expect(&cluster.command(&["watch", job]), 0);
    let summary = expect(&cluster.command(&["results", job, "--format", "json"]), 0);
    let summary: Value = serde_json::from_str(&summary).expect("one JSON object, nothing else");
    check(&summary, 128, 40, 40);
    let workers = summary["workers"].as_array().expect("a list of workers");
    let tracked: u64 = workers
        .iter()
        .filter_map(|worker| worker["paths"].as_u64())
        .sum();
    assert!(tracked >= 128, "{workers:?}");
    assert_eq!(workers.len(), 2, "both took part: {workers:?}");

    let folder = cluster.folder().join("out");
    let folder = folder.display().to_string();
    let table = expect(&cluster.command(&["results", job, "--output", &folder]), 0);
    assert!(table.contains("40"), "{table}");
    let lines = std::fs::read_to_string(format!("{folder}/solutions.jsonl")).unwrap();
    let mut nonsingular = 0;
    for line in lines.lines() {
        let solution: Value = serde_json::from_str(line).expect("a line is an object");
        let variables = solution["variables"].as_object().expect("named values");
        assert_eq!(variables.len(), 8);
        if solution["singular"] == false {
            nonsingular += 1;
            assert_eq!(solution["real"], true, "{line}");
        }
    }
    assert_eq!(nonsingular, 40);
    for command in [&["jobs"][..], &["workers"], &["explain", job]] {
        let shown = expect(&cluster.command(command), 0);
        assert!(!shown.trim().is_empty(), "{command:?} shows nothing");
    }
    cluster.stop();
}

#[test]
fn one_request_is_one_job() {
    let cluster = Cluster::with_workers(1);
    let file = cluster.folder().join("root.bertini");
    std::fs::write(&file, square_root_of_two()).unwrap();
    let file = file.display().to_string();
    let submit = ["submit", &file, "--request-id", "the-same"];
    let first = expect(&cluster.command(&submit), 0);
    assert_eq!(first, expect(&cluster.command(&submit), 0));
    let other = expect(&cluster.command(&["submit", &file]), 0);
    assert_ne!(first, other, "another request is another job");
    expect(&cluster.command(&["watch", other.trim()]), 0);
    cluster.stop();
}

#[test]
fn a_cancelled_job_ends_with_its_code() {
    // No worker: it would wait for ever.
    let cluster = Cluster::with_workers(0);
    let file = cluster.folder().join("root.bertini");
    std::fs::write(&file, square_root_of_two()).unwrap();
    let job = expect(
        &cluster.command(&["submit", &file.display().to_string()]),
        0,
    );
    expect(&cluster.command(&["cancel", job.trim()]), 0);
    expect(&cluster.command(&["watch", job.trim()]), 4);
    expect(&cluster.command(&["watch", "no-such-job"]), 2);
    cluster.stop();
}

#[test]
fn without_a_coordinator_the_code_is_three() {
    let output = Command::new(cognate())
        .args(["jobs", "--coordinator", "unix:/no/such/socket"])
        .output()
        .expect("cognate can be started");
    expect(&output, 3);
    assert!(text(&output.stderr).contains("/no/such/socket"));
}

#[test]
fn solve_brings_its_own_service() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let solve = |file: &str, content: &str, more: &[&str]| {
        std::fs::write(folder.path().join(file), content).unwrap();
        let mut command = Command::new(cognate());
        command
            .current_dir(folder.path())
            .args(["solve", file, "--format", "json"]);
        let output = command.args(more).output().expect("cognate can be started");
        let summary = expect(&output, 0);
        serde_json::from_str::<Value>(&summary).expect("one JSON object, nothing else")
    };
    check(&solve("root.bertini", &square_root_of_two(), &[]), 2, 2, 2);
    let platform = example("stewart_gough_dietmaier.bertini");
    check(
        &solve("platform.bertini", &platform, &["--workers", "2"]),
        128,
        40,
        40,
    );
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 2, "nothing is left behind: {left:?}");
}

#[test]
fn sets_of_a_linear_product_are_taken_as_they_are_given() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    for name in ["noon_5.bertini", "noon_5_sets.json"] {
        std::fs::write(place(name), example(name)).unwrap();
    }
    let (file, sets) = (place("noon_5.bertini"), place("noon_5_sets.json"));
    let run = |arguments: &[&str]| {
        let mut command = Command::new(cognate());
        command.args(arguments);
        command.output().expect("cognate can be started")
    };
    let info = expect(
        &run(&["info", &file, "--sets", &sets, "--format", "json"]),
        0,
    );
    let info: Value = serde_json::from_str(&info).expect("one JSON object");
    assert_eq!(info["linear_product"], 233, "{info:#}");
    assert_eq!(info["choice"], "linear-product", "{info:#}");
    let summary = expect(
        &run(&["solve", &file, "--sets", &sets, "--format", "json"]),
        0,
    );
    let summary: Value = serde_json::from_str(&summary).expect("one JSON object");
    assert_eq!(summary["problem"]["start"], "linear-product");
    assert_eq!(summary["paths"]["total"], 233, "{summary:#}");
    assert_eq!(summary["solutions"]["nonsingular"], 233, "{summary:#}");

    // x1*x2^2 is not in {x1} {x1, x3, x4, x5} {x2, x3, x4, x5}.
    let wrong = example("noon_5_sets.json").replacen("\"x2\", \"x3\"", "\"x1\", \"x3\"", 1);
    let other = place("wrong.json");
    std::fs::write(&other, wrong).unwrap();
    for command in ["info", "solve"] {
        let output = run(&[command, &file, "--sets", &other]);
        expect(&output, 2);
        let message = text(&output.stderr);
        assert!(message.contains("the equation f1"), "{message}");
        assert!(message.contains("monomial x1*x2^2"), "{message}");
    }
    let output = run(&["solve", &file, "--start", "polyhedral", "--sets", &sets]);
    expect(&output, 2);
    assert!(text(&output.stderr).contains("--sets"));
}
