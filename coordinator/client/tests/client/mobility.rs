//! `cognate mechanism mobility --why` as a process.

use crate::motion::answer;
use crate::program::{cognate, text};
use serde_json::Value;
use std::path::Path;

fn file(instance: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/motions");
    root.join(instance)
        .join("mechanism.json")
        .display()
        .to_string()
}

/// Three equal parallel cranks move only because they are equal.
#[test]
fn it_is_said_which_numbers_take_the_freedom() {
    let command = "cognate mechanism mobility mechanism.json --at home --why";
    let (answer, code) = answer("three_equal_cranks", command);
    assert_eq!((code, &answer["settled"]), (Some(0), &Value::Bool(true)));
    let effects = answer["why"].as_array().expect("effects");
    assert_eq!(answer["points"][0]["why"], answer["why"]);
    assert_eq!(effects.len(), 12);
    for effect in effects {
        assert_eq!(
            (&effect["freedoms"], &effect["assembles"]),
            (&"fewer".into(), &true.into())
        );
    }
    assert_eq!(
        (&effects[2]["number"], &effects[2]["value"]),
        (&"B1.point.0".into(), &0.6.into())
    );
}

#[test]
fn numbers_are_listed_in_words() {
    let output = cognate(&[
        "mechanism",
        "mobility",
        &file("sarrus"),
        "--at",
        "home",
        "--why",
    ]);
    let said = text(&output.stdout);
    let words: Vec<&str> = said.split_whitespace().collect();
    let said = words.join(" ");
    assert!(
        said.contains(
            "Changed by itself, each of these takes the freedom away: a1.axis.1, a1.axis.2,"
        ),
        "{said}"
    );
    assert!(said.contains("These do not: a1.point.0,"), "{said}");
    assert_eq!(output.status.code(), Some(0));
    let without = cognate(&["mechanism", "mobility", &file("sarrus"), "--at", "home"]);
    assert!(!text(&without.stdout).contains("Changed"));
}
