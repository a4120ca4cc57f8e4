//! `cognate mechanism synthesize --approximate` as a process, with known answers: `tests/motions`. `meta.json` of each
//! instance holds the expected answer, and names the independent programs that found it.

use crate::motion::{answer, expected};
use crate::program::{cognate, text};
use serde_json::Value;

/// Numbers are equal to this, relative.
const EQUAL: f64 = 1e-6;

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("a number: {value}"))
}

fn is_near(value: &Value, expected: &Value, relative: f64) -> bool {
    let (value, expected) = (number(value), number(expected));
    (value - expected).abs() <= relative * expected.abs()
}

fn minima<'a>(answer: &'a Value, list: &str) -> Vec<&'a Value> {
    let entries = answer[list].as_array().expect("a list").iter();
    entries.filter(|entry| entry["kind"] == "minimum").collect()
}

/// The command of an instance with more words.
fn solved(instance: &str, more: &str) -> (Value, Value) {
    let meta = expected(instance);
    let command = format!("{} {more}", meta["command"].as_str().expect("a command"));
    let (answer, code) = answer(instance, &command);
    assert_eq!(code, Some(0), "{answer:#}");
    (answer, meta["expected"].clone())
}

#[test]
fn dyads_for_eight_poses() {
    let (answer, expected) = solved("eight_poses", "");
    assert_eq!(answer["objective"], expected["objective"]);
    assert_eq!(answer["method"], "stationary");
    assert_eq!(
        answer["stationary"]["complex"],
        expected["stationary"]["complex"]
    );
    let minima = minima(&answer, "dyads");
    let dyads = expected["dyads"].as_array().expect("dyads");
    assert_eq!(minima.len(), dyads.len());
    for (dyad, expected) in minima.into_iter().zip(dyads) {
        for field in ["error", "length"] {
            assert!(
                is_near(&dyad[field], &expected[field], EQUAL),
                "{dyad} {expected}"
            );
        }
        for field in ["pivot", "moving"] {
            for k in 0..2 {
                assert!(
                    is_near(&dyad[field][k], &expected[field][k], EQUAL),
                    "{dyad} {expected}"
                );
            }
        }
    }
}

#[test]
fn a_function_generator_for_seven_pairs() {
    let (answer, expected) = solved("seven_pairs", "");
    assert_eq!(answer["objective"], expected["objective"]);
    let minima = minima(&answer, "linkages");
    assert_eq!(
        minima.len() as u64,
        expected["minima"].as_u64().expect("a number")
    );
    let relative = number(&expected["relative_tolerance"]);
    assert!(
        is_near(&minima[0]["error"], &expected["error"], relative),
        "{answer:#}"
    );
    for (field, value) in expected["reference"].as_object().expect("fields") {
        assert!(
            is_near(&minima[0][field], value, EQUAL),
            "{field}: {answer:#}"
        );
    }
}

/// The least error is at most that of another program's local search.
#[test]
fn a_path_through_twelve_points() {
    let (answer, expected) = solved("twelve_points", "");
    assert_eq!(answer["objective"], expected["objective"]);
    assert_eq!(answer["method"], "refined");
    let best = minima(&answer, "linkages")[0];
    let relative = number(&expected["relative_tolerance"]);
    assert!(
        number(&best["error"]) <= (1.0 + relative) * number(&expected["error"]),
        "{best}"
    );
}

#[test]
fn what_can_be_met_exactly_is_refused_with_the_command_to_type() {
    let folder = tempfile::tempdir().expect("a folder");
    let linkage = folder.path().join("four_bar.json");
    let points = folder.path().join("points.csv");
    let instance = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/motions/twelve_points/mechanism.json"
    );
    std::fs::copy(instance, &linkage).expect("a copy");
    std::fs::write(&points, "x,y\n0,0\n1,0\n1,1\n").expect("a file");
    let [linkage, points] = [linkage, points].map(|path| path.display().to_string());
    let words = ["mechanism", "synthesize", &linkage, "--points", &points];
    for (more, said) in [
        (&[][..], "--approximate"),
        (&["--approximate"][..], "cognate synthesize nine-point"),
    ] {
        let words: Vec<&str> = words.iter().chain(more).copied().collect();
        let output = cognate(&words);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            text(&output.stderr).contains(said),
            "{}",
            text(&output.stderr)
        );
    }
}
