//! A worker and a coordinator are killed in the middle of a decomposition: the same components, byte for byte.

use crate::questions_killed::{SET, check, components, listed, submission};
use crate::worker_lost::{nervous, slow_worker};
use cognate_protocol::submission::{Decompose, Options};
use cognate_protocol::v1;
use cognate_solutions::witness::KnownComponents;
use cognate_tests::client::{Submission, accepted, has_ended};
use cognate_tests::cluster::{Cluster, CoordinatorOptions};
use serde_json::Value;

/// Components of the system.
const EXPECTED: [(u64, u64); 6] = [(2, 2), (1, 3), (1, 1), (1, 1), (1, 1), (0, 1)];

/// A quadric surface, a cubic curve, three lines and a point: 236 paths in three dimensions.
fn problem() -> Submission {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/decomposition/systems");
    let file = format!("{folder}/nid_illustrative/system.bertini");
    let mut submission =
        Submission::of(std::fs::read_to_string(file).expect("the system is there"));
    submission.options.method = Some(v1::options::Method::Decompose(v1::Decompose::default()));
    submission
}

/// The files of a finished job that have no time and no worker in them.
fn files(cluster: &Cluster, job: &str) -> [String; 2] {
    let folder = cluster.folder().join("components");
    let output = folder.display().to_string();
    let shown = cluster.command(&["results", job, "--format", "json", "--output", &output]);
    assert_eq!(shown.status.code(), Some(0), "{shown:?}");
    let summary: Value = serde_json::from_slice(&shown.stdout).expect("one JSON object");
    assert_eq!(listed(&summary), EXPECTED);
    SET.map(|name| std::fs::read_to_string(folder.join(name)).expect("the file is there"))
}

#[test]
fn kills_leave_no_trace_in_a_decomposition() {
    let quiet = Cluster::with_workers(1);
    let job = quiet.client().submit(&problem());
    quiet.client().wait_until_solved(&job);
    let expected = files(&quiet, &job);
    let refused = quiet.command(&["results", "no-such-job"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    quiet.stop();

    let mut cluster = Cluster::start(CoordinatorOptions {
        chunk_paths: Some(4),
        ..nervous()
    });
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    let job = cluster.client().submit(&problem());
    let client = cluster.client();
    let before = client.progress_once(&job, "some paths are done", |p| accepted(p) >= 20);
    assert!(!has_ended(&before), "there was a middle: {before:?}");
    cluster.workers[0].kill();
    let before = client.progress_once(&job, "more paths are done", |p| accepted(p) >= 60);
    assert!(!has_ended(&before), "there was a middle: {before:?}");
    drop(client);
    cluster.kill_coordinator();
    cluster.restart_coordinator();
    cluster.client().wait_until_solved(&job);
    assert!(files(&cluster, &job) == expected, "the same, byte for byte");
    let paths = cluster.command(&["explain", &job]);
    assert!(
        String::from_utf8_lossy(&paths.stdout).contains("dimension 1: 4 components of degree 6"),
        "{paths:?}"
    );
    cluster.workers.remove(0);
    cluster.stop();
}

/// The components of the first equation, which two others cut.
#[test]
fn kills_leave_no_trace_where_equations_are_added() {
    let sphere = "s = x^2 + y^2 + z^2 - 1;";
    let first = "f = (y - x^2)*s*(x - 1/2);";
    let others = "g = (z - x^3)*s*(y - 1/2); h = (y - x^2)*(z - x^3)*s*(z - 1/2);";
    let text = |names: &str, equations: &str| {
        format!(
            "CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function {names}; {sphere} {equations}\nEND;\n"
        )
    };
    let known = KnownComponents {
        equations: 1,
        components: components(&text("f", first)),
    };
    let options = Options {
        decompose: Some(Decompose {
            known: Some(known),
            ..Decompose::default()
        }),
        ..Options::default()
    };
    let extended = submission(text("f, g, h", &format!("{first} {others}")), options);
    let summary = check(&extended, [10, 40], &SET);
    assert_eq!(listed(&summary), EXPECTED);
}
