//! A worker and a coordinator are killed in the middle of a decomposition: the same components, byte for byte.

use crate::questions_killed::{SET, check, check_and_look, components, listed, submission};
use cognate_protocol::submission::{Decompose, Options};
use cognate_protocol::v1;
use cognate_solutions::witness::KnownComponents;
use cognate_tests::client::Submission;

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
    let known = KnownComponents {
        equations: 1,
        components: components(&text("f", first)),
        parameters: Vec::new(),
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
