//! `cognate intersect`, `singular-locus` and `real-points` as processes: JSON, files that are a set again, exit codes.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

fn cognate(arguments: &[&str], paths: &[&Path], options: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command.args(arguments).args(paths).args(options);
    command.output().expect("the program starts")
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn written(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let file = folder.path().join(name);
    let text = format!("CONFIG\nEND;\nINPUT\n{text}\nEND;\n");
    std::fs::write(&file, text).expect("the folder is writable");
    file
}

/// The folder with the components of a system.
fn decomposed(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let file = written(folder, &format!("{name}.bertini"), text);
    let set = folder.path().join(name);
    let to = set.display().to_string();
    let output = cognate(&["decompose"], &[&file], &["--output", &to]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    set
}

fn components(summary: &Value) -> Vec<(u64, u64)> {
    let list = summary["decomposition"]["components"].as_array();
    let number = |v: &Value| v.as_u64().expect("a number");
    let list = list.expect("a list").iter();
    list.map(|c| (number(&c["dimension"]), number(&c["degree"])))
        .collect()
}

#[test]
fn an_intersection_is_a_set() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sphere = decomposed(
        &folder,
        "sphere",
        "variable_group x, y, z; function f; f = x^2 + y^2 + z^2 - 1;",
    );
    let plane = written(
        &folder,
        "plane.bertini",
        "variable_group x, y, z; function f; f = x + y;",
    );
    let circle = folder.path().join("circle");
    let to = circle.display().to_string();
    let output = cognate(
        &["intersect"],
        &[&sphere, &plane],
        &["--format", "json", "--output", &to],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(components(&json(&output)), [(1, 2)]);
    // The circle is asked, and cut by another plane, as a set.
    let other = decomposed(
        &folder,
        "other",
        "variable_group x, y, z; function g; g = 2*z - x + 1;",
    );
    let points = cognate(&["intersect"], &[&circle, &other], &["--format", "json"]);
    assert_eq!(points.status.code(), Some(0), "{points:?}");
    assert_eq!(components(&json(&points)), [(0, 1), (0, 1)]);
    let real = folder.path().join("real");
    let to = real.display().to_string();
    let found = cognate(
        &["real-points"],
        &[&circle],
        &["--format", "json", "--output", &to],
    );
    assert_eq!(found.status.code(), Some(0), "{found:?}");
    let found = json(&found);
    assert_eq!(found["components"][0]["has_real_points"], true);
    let csv = std::fs::read_to_string(real.join("samples.csv")).expect("points are there");
    assert!(
        csv.starts_with("component,re0,im0") && csv.lines().count() >= 3,
        "{csv}"
    );
}

#[test]
fn a_singular_locus_is_a_set() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = "variable_group x, y, z; function f; f = x^2 - y^2*z;";
    let umbrella = decomposed(&folder, "umbrella", text);
    let handle = folder.path().join("handle");
    let to = handle.display().to_string();
    let output = cognate(
        &["singular-locus"],
        &[&umbrella],
        &["--format", "json", "--output", &to],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(components(&json(&output)), [(1, 1)]);
    let points = folder.path().join("points.csv");
    std::fs::write(&points, "x,y,z\n0,0,7\n1,1,1\n").expect("the folder is writable");
    let points = points.display().to_string();
    let member = cognate(
        &["member"],
        &[&handle],
        &["--points", &points, "--format", "json"],
    );
    assert_eq!(member.status.code(), Some(0), "{member:?}");
    let member = json(&member);
    assert_eq!(member["points"][0]["on"][0], "1.1");
    assert_eq!(member["points"][1]["on"].as_array().map(Vec::len), Some(0));
}

#[test]
fn doubts_and_mistakes_have_their_exit_codes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let circle = "variable_group x, y; function f; f = (x^2 + y^2 - 1)^2;";
    let double = decomposed(&folder, "double", circle);
    let output = cognate(&["real-points"], &[&double], &[]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("multiple"));
    let strange = written(
        &folder,
        "strange.bertini",
        "variable_group x, w; function f; f = x*w;",
    );
    let output = cognate(&["intersect"], &[&double, &strange], &[]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.contains("strange.bertini") && said.contains("`w`"),
        "{said}"
    );
    let output = cognate(&["intersect"], &[&double, &strange], &["--other", "1.1"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let output = cognate(&["singular-locus"], &[&double], &["--component", "0.1"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
}
