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

/// The shift of one joint of a planar loop must be 0 so that the loop can be assembled: no equation of its motion has the
/// open number.
#[test]
fn open_numbers_that_no_equation_has_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("shifted.json");
    let joints = r#"[{"name": "q1", "a": 3, "alpha": 0}, {"name": "q2", "a": 2, "alpha": 0, "d": "?"},
        {"name": "q3", "a": "5/2", "alpha": 0}, {"name": "q4", "a": 2, "alpha": 0}]"#;
    let text = format!(r#"{{"name": "shifted", "loop": {{"joints": {joints}}}}}"#);
    std::fs::write(&file, text).expect("a file");
    let arguments = ["mechanism", "exceptional", file.to_str().expect("a name")];
    let run = cognate(&arguments);
    assert_eq!(run.status.code(), Some(2), "{run:?}");
    let error = String::from_utf8_lossy(&run.stderr);
    assert!(error.contains("do not contain"), "{error}");
}
