//! `cognate mechanism exceptional` as a process, with known answers: `tests/motions`.

use crate::motion::{answer, expected};
use crate::program::cognate;
use serde_json::Value;

/// Numbers are equal to this.
const EQUAL: f64 = 1e-9;

/// A number, or a fraction in a string.
fn number(value: &Value) -> f64 {
    match value.as_str().and_then(|text| text.split_once('/')) {
        Some((numerator, denominator)) => {
            let [n, d]: [f64; 2] = [numerator, denominator].map(|x| x.parse().expect("a number"));
            n / d
        }
        None => value
            .as_f64()
            .unwrap_or_else(|| panic!("a number: {value}")),
    }
}

/// Every set that is expected, and no other.
fn check(instance: &str) {
    let meta = expected(instance);
    let (answer, code) = answer(instance, meta["command"].as_str().expect("a command"));
    assert_eq!(code, Some(0), "{answer:#}");
    let expected = &meta["expected"];
    assert_eq!(answer["free"], expected["free"]);
    assert_eq!(
        answer["generic"]["mobility"],
        expected["generic"]["mobility"]
    );
    let [sets, wanted] = [&answer["sets"], &expected["sets"]].map(|s| s.as_array().expect("sets"));
    assert_eq!(sets.len(), wanted.len(), "{answer:#}");
    for (set, wanted) in sets.iter().zip(wanted) {
        for field in ["dimension", "mobility", "equations"] {
            let claimed = wanted.get(field);
            assert!(
                claimed.is_none_or(|claimed| *claimed == set[field]),
                "{field}: {answer:#}"
            );
        }
        let Some(values) = wanted["values"].as_array() else {
            continue;
        };
        assert_eq!(
            set["values"].as_array().expect("values").len(),
            values.len()
        );
        for (value, wanted) in set["values"].as_array().expect("values").iter().zip(values) {
            for (name, wanted) in wanted.as_object().expect("values by name") {
                let difference = number(&value[name]) - number(wanted);
                assert!(difference.abs() < EQUAL, "{name}: {answer:#}");
            }
        }
    }
}

/// A platform on two equal parallel cranks and a third one moves where that has their length.
#[test]
fn a_third_crank_has_one_length() {
    check("free_crank");
}

/// Bennett's condition (1903) from a closed 4R with two open lengths.
#[test]
fn bennett_s_condition() {
    check("bennett_family");
}

/// The answer for a file with this text.
fn answer_for(text: &str) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mechanism.json");
    std::fs::write(&file, text).expect("a file");
    let file = file.to_str().expect("a name");
    let run = cognate(&["mechanism", "exceptional", file, "--format", "json"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    serde_json::from_slice(&run.stdout).expect("JSON")
}

/// Shifts along parallel axes of a planar loop add up to 0 so that it can be assembled: no angle is in that equation.
#[test]
fn shifts_of_parallel_axes_add_up_to_zero() {
    let with_shifts = |first: &str| {
        let joints = r#"{"name": "q2", "a": 2, "alpha": 0, "d": "?"}, {"name": "q3", "a": "5/2", "alpha": 0},
            {"name": "q4", "a": 2, "alpha": 0}"#;
        let first = format!(r#"{{"name": "q1", "a": 3, "alpha": 0, "d": {first}}}"#);
        answer_for(&format!(
            r#"{{"name": "shifted", "loop": {{"joints": [{first}, {joints}]}}}}"#
        ))
    };
    let one = with_shifts("\"-1/4\"");
    assert_eq!(one["generic"]["mobility"], -1, "{one:#}");
    assert_eq!(one["sets"].as_array().map(Vec::len), Some(1), "{one:#}");
    assert_eq!(one["sets"][0]["mobility"], 1, "{one:#}");
    assert_eq!(one["sets"][0]["exact"][0]["q2.d"], "1/4", "{one:#}");
    let two = with_shifts("\"?\"");
    assert_eq!(two["sets"][0]["dimension"], 1, "{two:#}");
    assert_eq!(two["sets"][0]["equations"][0], "q1.d + q2.d", "{two:#}");
}

/// Two bars with one name have one length, and a number of a joint's point is named by the joint.
#[test]
fn open_numbers_have_names() {
    let joint = |name: &str, links: &str, point: &str| {
        format!(r#"{{"name": "{name}", "type": "R", "links": {links}, "point": {point}}}"#)
    };
    let joints = [
        joint("A0", r#"["g", "c"]"#, "[0, 0]"),
        joint("A", r#"["c", "k"]"#, r#"["?", 1]"#),
        joint("B", r#"["k", "r"]"#, "[5, 2]"),
        joint("B0", r#"["r", "g"]"#, "[4, 0]"),
    ];
    let answer = answer_for(&format!(
        r#"{{"name": "four bars", "space": "planar", "links": ["g", "c", "k", "r"], "joints": [{}]}}"#,
        joints.join(", ")
    ));
    assert_eq!(
        answer["free"],
        serde_json::json!(["A.point.0"]),
        "{answer:#}"
    );
}
