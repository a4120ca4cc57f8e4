//! How mechanisms move, with known answers: `tests/motions`. `meta.json` of each instance says what is expected, and by which
//! independent programs that was found.

use cognate_kinematics::mechanism::configuration::{GivenConfiguration, configurations};
use cognate_kinematics::mechanism::{Mechanism, ReadOptions, read};
use cognate_mechanism_solver::local::mobility::{Mobility, mobility};
use serde_json::{Value, json};
use std::path::PathBuf;

fn content(instance: &str, file: &str) -> Vec<u8> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/motions");
    let path = root.join(instance).join(file);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn of_text(text: &Value) -> Mechanism {
    let content = text.to_string().into_bytes();
    read("mechanism.json", &content, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn tree(instance: &str, file: &str) -> Value {
    serde_json::from_slice(&content(instance, file)).expect("JSON")
}

fn given(mechanism: &Mechanism, at: &Value) -> Vec<GivenConfiguration> {
    let content = at.to_string().into_bytes();
    configurations("at.json", &content, mechanism, mechanism.degrees)
        .unwrap_or_else(|e| panic!("{e}"))
}

fn mobilities(mechanism: &Mechanism, at: &Value) -> Vec<Mobility> {
    let each = given(mechanism, at);
    let each = each.iter().map(|given| mobility(mechanism, given, 1));
    each.map(|answer| answer.unwrap_or_else(|e| panic!("{e}")))
        .collect()
}

/// Holds answers against those of the instance: the first lengths, as many as both have.
fn check(instance: &str, answers: &[Mobility]) {
    let expected = &tree(instance, "meta.json")["expected"]["points"];
    let expected = expected.as_array().expect("points");
    assert_eq!(answers.len(), expected.len(), "{instance}");
    for (k, (answer, expected)) in answers.iter().zip(expected).enumerate() {
        let place = format!("{instance} {k}: {answer:?}");
        assert_eq!(
            json!(answer.infinitesimal),
            expected["infinitesimal"],
            "{place}"
        );
        assert_eq!(json!(answer.local), expected["local"], "{place}");
        assert_eq!(
            json!(answer.multiplicity),
            expected["multiplicity"],
            "{place}"
        );
        let lengths = expected["dimensions_by_order"].as_array().expect("lengths");
        let pairs = answer.dimensions_by_order.iter().zip(lengths);
        assert!(pairs.clone().count() >= 4, "{place}");
        for (found, expected) in pairs {
            assert_eq!(json!(found), *expected, "{place}");
        }
    }
}

const MOBILITIES: [&str; 7] = [
    "change_points",
    "cusp",
    "k33_on_a_circle",
    "shaky_line",
    "shaky_third_order",
    "shaky_two_freedoms",
    "switching_point",
];

#[test]
fn mobility_is_that_of_the_instances() {
    for instance in MOBILITIES {
        let mechanism = of_text(&tree(instance, "mechanism.json"));
        let answers = mobilities(&mechanism, &tree(instance, "at.json"));
        assert!(
            answers
                .iter()
                .all(|answer| answer.is_exact && answer.is_settled())
        );
        check(instance, &answers);
    }
}
