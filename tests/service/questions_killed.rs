//! A worker and a coordinator are killed in the middle of an intersection, a singular locus, a search for real points, a
//! real curve and a real surface: the same answer, byte for byte.

use crate::worker_lost::{nervous, slow_worker};
use cognate_algorithms::decomposition::{DecompositionOptions, DecompositionSolve, run_locally};
use cognate_protocol::submission::{Asked, Options};
use cognate_protocol::to_proto;
use cognate_protocol::v1::JobProgress;
use cognate_solutions::witness::question::{CurveWish, SecondSet};
use cognate_solutions::witness::{Question, WitnessSet};
use cognate_systems::formats;
use cognate_tests::client::{Submission, accepted, has_ended};
use cognate_tests::cluster::{Cluster, CoordinatorOptions};
use serde_json::Value;

/// Seed of the components and of the questions to them.
const SEED: u64 = 5;
/// Jobs of one test at most, until each disturbance met a job in its middle.
pub const ATTEMPTS: u32 = 20;

fn input(equations: &str) -> String {
    format!("CONFIG\nEND;\nINPUT\nvariable_group x, y, z; {equations}\nEND;\n")
}

/// The components of a system.
pub fn components(text: &str) -> Vec<WitnessSet> {
    let system = formats::read("test", text.as_bytes()).expect("a system");
    let options = DecompositionOptions {
        seed: SEED,
        ..DecompositionOptions::default()
    };
    let solve = DecompositionSolve::new(&system.system, &options).expect("a decomposition");
    let decomposition = run_locally(solve, 8).expect("components");
    assert!(decomposition.settled(), "{decomposition:?}");
    decomposition.components
}

/// A text with options, and the seed of the components.
pub fn submission(text: String, options: Options) -> Submission {
    let options = Options {
        seed: Some(SEED),
        ..options
    };
    let mut submission = Submission::of(text);
    submission.options = to_proto::problem::options(&options);
    submission
}

fn asked(text: String, components: Vec<WitnessSet>, question: Question) -> Submission {
    let question = Some(Asked {
        components,
        question,
    });
    let options = Options {
        question,
        ..Options::default()
    };
    submission(text, options)
}

/// The answer without times and workers, and the files with components or points.
pub fn answer(cluster: &Cluster, job: &str, files: &[&str]) -> (Value, Vec<String>) {
    let folder = cluster.folder().join(format!("answer-{job}"));
    let output = folder.display().to_string();
    let shown = cluster.command(&["results", job, "--format", "json", "--output", &output]);
    assert_eq!(shown.status.code(), Some(0), "{shown:?}");
    let mut summary: Value = serde_json::from_slice(&shown.stdout).expect("one JSON object");
    let summary_fields = summary.as_object_mut().expect("a summary");
    for other in ["job", "time", "workers"] {
        summary_fields.remove(other);
    }
    let read = |name: &&str| std::fs::read_to_string(folder.join(name)).expect("the file is there");
    (summary, files.iter().map(read).collect())
}

/// Asks undisturbed, then with a worker killed where these many items are done, and the coordinator where those are.
pub fn check(submission: &Submission, kills: [u64; 2], files: &[&str]) -> Value {
    check_and_look(submission, kills, files, &|_, _| ())
}

/// Checks as [`check`] does. When the job is solved, `look` is given the disturbed service and the job.
pub fn check_and_look(
    submission: &Submission,
    kills: [u64; 2],
    files: &[&str],
    look: &dyn Fn(&Cluster, &str),
) -> Value {
    let quiet = Cluster::with_workers(1);
    let job = quiet.client().submit(submission);
    quiet.client().wait_until_solved(&job);
    let expected = answer(&quiet, &job, files);
    quiet.stop();

    let mut cluster = Cluster::start(CoordinatorOptions {
        chunk_paths: Some(4),
        ..nervous()
    });
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    let job = disturbed_job(&mut cluster, submission, kills);
    let killed_answer = answer(&cluster, &job, files);
    assert!(killed_answer == expected, "the same, byte for byte");
    look(&cluster, &job);
    cluster.stop();
    expected.0
}

/// The job of this submission, after a worker was killed where `kills[0]` items were accepted, and the coordinator
/// where `kills[1]` were. A job that ends between two looks is submitted again.
fn disturbed_job(cluster: &mut Cluster, submission: &Submission, kills: [u64; 2]) -> String {
    for attempt in 0..ATTEMPTS {
        let killed_submission = Submission {
            request_id: format!("{}-killed-{attempt}", submission.request_id),
            ..submission.clone()
        };
        let job = cluster.client().submit(&killed_submission);
        let mut ended = false;
        for (kill, items) in kills.into_iter().enumerate() {
            let reached =
                |progress: &JobProgress| has_ended(progress) || accepted(progress) >= items;
            cluster.disturb_once(&job, "some items are done", reached, |cluster, middle| {
                ended |= has_ended(middle);
                match kill {
                    _ if ended => {}
                    0 => cluster.workers.remove(0).kill(),
                    _ => cluster.kill_coordinator(),
                }
            });
        }
        if !ended {
            cluster.restart_coordinator();
            cluster.client().wait_until_solved(&job);
            return job;
        }
        cluster.add_worker(&slow_worker());
    }
    panic!("each of {ATTEMPTS} jobs ended before it was disturbed twice");
}

/// The files of components.
pub const SET: [&str; 2] = ["decomposition.json", "witness_points.jsonl"];

/// Dimension and degree of each component.
pub fn listed(summary: &Value) -> Vec<(u64, u64)> {
    let list = summary["decomposition"]["components"].as_array();
    let number = |v: &Value| v.as_u64().expect("a number");
    let list = list.expect("a list").iter();
    list.map(|c| (number(&c["dimension"]), number(&c["degree"])))
        .collect()
}

/// A torus and a sextic surface, as two sets and as a set and an equation: a curve of degree 24.
#[test]
fn kills_leave_no_trace_in_an_intersection() {
    let torus = "f = (x^2 + y^2 + z^2 + 3)^2 - 16*(x^2 + y^2);";
    let sextic = "g = x^6 + y^6 + 2*z^6 - x*y*z - x - 2;";
    let both = input(&format!("function f, g; {torus} {sextic}"));
    let first = components(&input(&format!("function f; {torus}")));
    let second = components(&input(&format!("function g; {sextic}")));
    for others in [second, Vec::new()] {
        let question = Question::Intersect(SecondSet {
            own: 1,
            from: 1,
            components: others,
        });
        let submission = asked(both.clone(), first.clone(), question);
        let summary = check(&submission, [20, 50], &SET);
        assert_eq!(listed(&summary), [(1, 24)]);
    }
}

/// Kummer's surface with tetrahedral symmetry (mu^2 = 2): 16 nodes, of which none is at infinity.
#[test]
fn kills_leave_no_trace_in_a_singular_locus() {
    let planes = "p = 1 - z - r*x; q = 1 - z + r*x; s = 1 + z + r*y; t = 1 + z - r*y;";
    let text = input(&format!(
        "function f; r = 2^0.5; {planes} f = (x^2 + y^2 + z^2 - 2)^2 - 5*p*q*s*t;"
    ));
    let surface = components(&text);
    let submission = asked(text, surface, Question::SingularLocus);
    // The question has 84 items.
    let summary = check(&submission, [20, 60], &SET);
    assert_eq!(listed(&summary), [(0, 1); 16]);
}

/// A torus: critical points of the distance to a random point.
#[test]
fn kills_leave_no_trace_in_real_points() {
    let text = input("function f; f = (x^2 + y^2 + z^2 + 3)^2 - 16*(x^2 + y^2);");
    let torus = components(&text);
    let submission = asked(text, torus, Question::RealPoints);
    // The question has 66 items.
    let summary = check(&submission, [8, 36], &["samples.csv"]);
    assert_eq!(summary["components"][0]["has_real_points"], true);
}

/// A cubic with an oval and an arc.
#[test]
fn kills_leave_no_trace_in_a_real_curve() {
    let text = input("function f, g; f = y^2 - x*(x - 1)*(x + 1); g = z - x;");
    let curve = components(&text);
    let question = Question::RealCurve(CurveWish {
        samples: 1,
        ..CurveWish::default()
    });
    let submission = asked(text, curve, question);
    let summary = check(&submission, [8, 30], &["curve.json", "samples.csv"]);
    let counts = &summary["components"][0];
    assert_eq!(counts["closed_loops"], 1);
    assert_eq!(counts["unbounded_arcs"], 1);
}

#[test]
fn kills_leave_no_trace_in_a_real_surface() {
    let text = input("function f; f = x^2 + 2*y^2 + 3*z^2 - 1;");
    let ellipsoid = components(&text);
    let submission = asked(text, ellipsoid, Question::RealSurface { samples: 1 });
    let summary = check(&submission, [40, 200], &["surface.json", "surface.obj"]);
    assert_eq!(summary["components"][0]["euler"], 2);
}
