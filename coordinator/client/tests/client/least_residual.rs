//! `solve --approximate`: points of least residual of more equations than unknowns, which are no solutions. The expected
//! numbers are by hand, or of scipy's `least_squares` from many starts.

use super::program::{cognate, text};
use serde_json::Value;

/// The summary of equations, one a text, with these further words.
fn summary(equations: &[&str], more: &[&str]) -> Value {
    let mut arguments = vec!["solve", "--format", "json"];
    for equation in equations {
        arguments.extend(["-e", equation]);
    }
    arguments.extend(more);
    let output = cognate(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// Checks the points, each with its coordinates and after them its residual, to 2e-7.
fn check(equations: &[&str], expected: &[&[f64]]) {
    let summary = summary(equations, &["--approximate"]);
    assert_eq!(summary["solutions"]["distinct"], 0);
    assert_eq!(summary["approximate_reason"], Value::Null, "{summary}");
    let points = summary["approximate"].as_array().expect("a list");
    assert_eq!(points.len(), expected.len(), "{points:?}");
    for expected in expected {
        let is_it = |point: &&Value| {
            let names = point["variables"].as_object().expect("names").values();
            let mut numbers: Vec<f64> = names.map(|z| z[0].as_f64().expect("a number")).collect();
            numbers.extend(point["residual"].as_f64());
            numbers.len() == expected.len()
                && numbers
                    .iter()
                    .zip(*expected)
                    .all(|(a, b)| (a - b).abs() < 2e-7)
        };
        let point = points.iter().find(is_it);
        let paths = point.and_then(|point| point["paths"].as_array());
        let paths = paths.unwrap_or_else(|| panic!("{expected:?} is not in {points:?}"));
        assert!(!paths.is_empty());
    }
}

#[test]
fn known_points_of_least_residual() {
    check(&["x = 0", "x = 1"], &[&[0.5, 0.5f64.sqrt()]]);
    check(
        &["x = 0", "y = 0", "x + y = 1.5"],
        &[&[0.5, 0.5, 0.75f64.sqrt()]],
    );
    let circles_and_line = [
        "(x - 1.1)^2 + y^2 = 2.25",
        "x^2 + (y - 1)^2 = 1.31",
        "x + y = 1.9",
    ];
    check(
        &circles_and_line,
        &[&[0.906_460_9, 1.462_527_4, 0.548_319_5]],
    );
    let three_circles = [
        "x^2 + y^2 = 4.02",
        "(x - 2)^2 + y^2 = 3.97",
        "(x - 1)^2 + 2*y^2 = 6.9",
    ];
    let (x, y, residual) = (1.011_618_8, 1.816_106_6, 0.525_472_6);
    check(&three_circles, &[&[x, y, residual], &[x, -y, residual]]);
    // Values of parameters are as good as numbers.
    let line = summary(
        &["parameters: a, b", "x = a", "2*x = b"],
        &["--targets", "a=1, b=7", "--approximate"],
    );
    let x = line["approximate"][0]["variables"]["x"][0].as_f64();
    assert!(x.is_some_and(|x| (x - 3.0).abs() < 1e-12), "{line}");
}

#[test]
fn what_has_no_such_points_says_why() {
    let reason = |equations: &[&str]| {
        let summary = summary(equations, &["--approximate"]);
        assert_eq!(summary["approximate"], Value::Array(Vec::new()));
        summary["approximate_reason"].to_string()
    };
    assert!(reason(&["x = 1", "2*x = 2"]).contains("common solutions"));
    assert!(reason(&["x^2 = 2"]).contains("no more equations than unknowns"));
    let unasked = summary(&["x = 0", "x = 1"], &[]);
    assert_eq!(unasked["approximate"], Value::Null);
    let family = "parameters: a; x = a; x = 1";
    let several = ["solve", "-e", family, "--approximate"];
    let several = cognate(&[&several[..], &["--targets", "a=1,2"]].concat());
    assert_eq!(several.status.code(), Some(2));
    assert!(text(&several.stderr).contains("--approximate: goes with one set of parameters"));
    let objective = ["solve", "-e", "x = 0", "-e", "x = 1", "--approximate"];
    let objective = cognate(&[&objective[..], &["--minimize", "x"]].concat());
    assert_eq!(objective.status.code(), Some(2));
    assert!(text(&objective.stderr).contains("--approximate: does not go with an objective"));
}

#[test]
fn the_table_lists_them_apart() {
    let output = cognate(&["solve", "-e", "x = 0", "-e", "x = 1", "--approximate"]);
    let table = text(&output.stdout);
    assert!(table.starts_with("equations: 0 solutions"), "{table}");
    assert!(table.contains("Approximate points"), "{table}");
    assert!(
        table.contains("residual 0.70710678 at x = 0.5 (1 path)"),
        "{table}"
    );
    let rows = cognate(&[
        "solve",
        "-e",
        "x = 0",
        "-e",
        "x = 1",
        "--approximate",
        "--format",
        "jsonl",
    ]);
    assert_eq!(text(&rows.stdout), "");
}
