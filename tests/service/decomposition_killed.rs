//! A worker and a coordinator are killed in the middle of a decomposition: the same components, byte for byte.

use crate::questions_killed::{
    ATTEMPTS, SET, answer, check, check_and_look, components, listed, submission,
};
use crate::worker_lost::{nervous, slow_worker};
use cognate_protocol::submission::{Decompose, Options};
use cognate_protocol::v1;
use cognate_protocol::v1::JobProgress;
use cognate_solutions::closing_options::ClosingOptions;
use cognate_solutions::witness::{KnownComponents, Method};
use cognate_tests::client::{Submission, has_ended};
use cognate_tests::cluster::{Cluster, CoordinatorOptions};
use std::collections::BTreeSet;

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

#[test]
fn kills_leave_no_trace_in_a_decomposition() {
    let summary = check_and_look(&problem(), [20, 60], &SET, &|cluster, job| {
        let paths = cluster.command(&["explain", job]);
        assert!(
            String::from_utf8_lossy(&paths.stdout)
                .contains("dimension 1: 4 components of degree 6"),
            "{paths:?}"
        );
        let refused = cluster.command(&["results", "no-such-job"]);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    });
    assert_eq!(listed(&summary), EXPECTED);
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
    let known_components = KnownComponents {
        equations: 1,
        components: components(&text("f", first)),
        parameters: Vec::new(),
    };
    let options = Options {
        decompose: Some(Decompose {
            known: Some(known_components),
            ..Decompose::default()
        }),
        ..Options::default()
    };
    let extended = submission(text("f, g, h", &format!("{first} {others}")), options);
    let summary = check(&extended, [10, 40], &SET);
    assert_eq!(listed(&summary), EXPECTED);
}

/// A worker and the coordinator are killed in a stage of each kind that has many items: local dimensions, derivatives,
/// certificates, and paths where there are enough.
#[test]
fn kills_leave_no_trace_in_any_kind_of_stage() {
    // Four double planes, which five planes cut in 20 double lines.
    let planes = |names: [&str; 3], count: u32| {
        let [x, y, z] = names;
        let plane = |k: u32| format!("({x} + {}*{y} - {z} - {})", k + 2, 2 * k + 1);
        (0..count).map(plane).collect::<Vec<_>>().join("*")
    };
    let text = format!(
        "CONFIG\nEND;\nINPUT\nvariable_group x, y, z; function f, g; f = ({})^2; g = {};\nEND;\n",
        planes(["x", "y", "z"], 4),
        planes(["z", "x", "y"], 5)
    );
    let options = Options {
        decompose: Some(Decompose {
            method: Some(Method::Equations),
            ..Decompose::default()
        }),
        closings: ClosingOptions {
            certify: true,
            ..ClosingOptions::default()
        },
        ..Options::default()
    };
    let undisturbed = submission(text, options);
    let quiet = Cluster::with_workers(1);
    let job = quiet.client().submit(&undisturbed);
    quiet.client().wait_until_solved(&job);
    let expected = answer(&quiet, &job, &SET);
    quiet.stop();
    assert_eq!(listed(&expected.0), vec![(1, 1); 20]);

    let mut cluster = Cluster::start(CoordinatorOptions {
        chunk_paths: Some(1),
        ..nervous()
    });
    for _ in 0..2 {
        cluster.add_worker(&slow_worker());
    }
    // Stages of paths are over before anybody looks: those of other cases have more of them.
    let kinds = [
        "whether singular endpoints are isolated",
        "derivatives of witness points",
        "certifying",
    ];
    let mut struck = BTreeSet::new();
    for attempt in 0..ATTEMPTS {
        if kinds.iter().all(|&kind| struck.contains(kind)) {
            break;
        }
        let killed_submission = Submission {
            request_id: format!("killed-in-every-kind-of-stage-{attempt}"),
            ..undisturbed.clone()
        };
        let job = cluster.client().submit(&killed_submission);
        strike_each_kind(&mut cluster, &job, &mut struck);
        cluster.client().wait_until_solved(&job);
        let killed_answer = answer(&cluster, &job, &SET);
        assert!(killed_answer == expected, "the same, byte for byte");
    }
    for kind in kinds {
        assert!(struck.contains(kind), "{struck:?}");
    }
    cluster.stop();
}

/// Kills a worker and the coordinator once in the middle of each kind of stage that is not in `struck`, and adds the
/// kind. A stage that is over between two looks is missed.
fn strike_each_kind(cluster: &mut Cluster, job: &str, struck: &mut BTreeSet<String>) {
    loop {
        let open_stage = |progress: &JobProgress| {
            let is_open = |stage: &&v1::StageProgress| {
                (1..stage.total).contains(&stage.accepted) && !struck.contains(&stage.purpose)
            };
            let stage = progress.stages.iter().find(is_open);
            stage.map(|stage| stage.purpose.clone())
        };
        let holds = |progress: &JobProgress| has_ended(progress) || open_stage(progress).is_some();
        let mut purpose = None;
        let what = "a stage of another kind, or the end";
        cluster.disturb_once(job, what, holds, |cluster, middle| {
            purpose = open_stage(middle);
            if purpose.is_some() {
                cluster.workers.remove(0).kill();
                cluster.kill_coordinator();
                cluster.restart_coordinator();
                cluster.add_worker(&slow_worker());
            }
        });
        let Some(purpose) = purpose else { return };
        struck.insert(purpose);
    }
}
