//! `cognate decompose` as a process: its JSON, its files, its exit codes.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A parabola, a line and a point.
const UNION: &str = "CONFIG\nEND;\nINPUT\nvariable_group x, y;\nfunction f, g;\n\
    curves = (y - x^2)*(x + 2*y - 1);\nf = curves*(x - 3);\ng = curves*(y - 5);\nEND;\n";

fn decompose(folder: &Path, text: &str, options: &[&str]) -> Output {
    let file = folder.join("system.bertini");
    std::fs::write(&file, text).expect("the folder is writable");
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command.arg("decompose").arg(&file).args(options);
    command.output().expect("the program starts")
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// Dimension and degree of each component.
fn components(summary: &Value) -> Vec<(u64, u64)> {
    let list = summary["decomposition"]["components"].as_array();
    let dimension_and_degree = |c: &Value| (c["dimension"].as_u64(), c["degree"].as_u64());
    let list = list.expect("a list").iter();
    list.map(|c| {
        (
            dimension_and_degree(c).0.expect("a number"),
            dimension_and_degree(c).1.expect("a number"),
        )
    })
    .collect()
}

#[test]
fn the_ways_agree_and_say_what_they_cost() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for method in ["auto", "cascade", "equations", "slices"] {
        let options = ["--method", method, "--verify", "--format", "json"];
        let output = decompose(folder.path(), UNION, &options);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let summary = json(&output);
        assert_eq!(components(&summary), [(1, 2), (1, 1), (0, 1)], "{method}");
        let second = &summary["decomposition"]["verification"];
        assert_eq!(second["agrees"], true, "{method}: {second}");
        let first_method = &summary["problem"]["method"];
        assert!(*first_method != second["method"] && (method == "auto" || first_method == method));
        let first = &summary["decomposition"]["components"][0];
        assert_eq!(first["self_conjugate"], true);
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    let file = folder.path().join("system.bertini");
    let info = command
        .arg("info")
        .arg(&file)
        .args(["--decompose", "--format", "json"]);
    let costs = json(&info.output().expect("the program starts"));
    assert_eq!(costs["dimensions"], serde_json::json!([0, 1]));
    assert!(costs["paths"]["equations"].as_u64() < costs["paths"]["cascade"].as_u64());
}

#[test]
fn components_stand_in_the_answer_and_in_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path().join("here");
    let files = here.display().to_string();
    let options = ["--seed", "1", "--format", "json", "--output", &files];
    let output = decompose(folder.path(), UNION, &options);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = json(&output);
    assert_eq!(components(&summary), [(1, 2), (1, 1), (0, 1)]);
    assert_eq!(
        summary["decomposition"]["by_dimension"]["1"]["complete"],
        "yes"
    );
    assert_eq!(summary["problem"]["seed"], 1);
    let read = |name: &str| std::fs::read_to_string(here.join(name)).expect(name);
    let written: Value = serde_json::from_str(&read("summary.json")).expect("JSON");
    assert_eq!(written, summary);
    let points = read("witness_points.jsonl");
    assert_eq!(points.lines().count(), 2 + 1 + 1);
    for line in points.lines() {
        let point: Value = serde_json::from_str(line).expect("JSON");
        let value = |name: &str| -> num_complex::Complex64 {
            serde_json::from_value(point["variables"][name].clone()).expect("a number")
        };
        let (x, y) = (value("x"), value("y"));
        let distance = match point["component"].as_str().expect("a name") {
            "1.1" => (y - x * x).norm_sqr(),
            "1.2" => (x + 2.0 * y - 1.0).norm_sqr(),
            _ => (x - 3.0).norm_sqr() + (y - 5.0).norm_sqr(),
        };
        assert!(distance < 1e-20, "{line}");
    }
    let kept: Value = serde_json::from_str(&read("decomposition.json")).expect("JSON");
    assert_eq!(
        kept["components"][0]["slice"].as_array().map(Vec::len),
        Some(1)
    );
    // Another number of workers gives the same answer, except for the fields that name the job, the time and the
    // workers.
    let options = ["--seed", "1", "--format", "json", "--workers", "1"];
    let mut alone = json(&decompose(folder.path(), UNION, &options));
    for varies in ["job", "time", "workers"] {
        alone[varies] = summary[varies].clone();
    }
    assert_eq!(alone, summary);
    let options = ["--seed", "1", "--format", "json", "--dimension", "1"];
    let lines = json(&decompose(folder.path(), UNION, &options));
    assert_eq!(components(&lines), [(1, 2), (1, 1)]);
    assert_eq!(lines["settled"], true);
}

#[test]
fn proofs_stand_beside_evidence() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let options = ["--certify", "--seed", "1", "--format", "json"];
    let output = decompose(folder.path(), UNION, &options);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = json(&output);
    assert_eq!(components(&summary), [(1, 2), (1, 1), (0, 1)]);
    for (place, unions) in [(0, 1), (1, 0), (2, 0)] {
        let component = &summary["decomposition"]["components"][place];
        let proof = &component["evidence"]["proof"];
        assert_eq!(component["certified"], component["degree"]);
        assert_eq!(proof["distinct"], component["degree"]);
        assert_eq!(
            (&proof["irreducible"], &proof["unions"]),
            (&true.into(), &unions.into())
        );
        // Two equations cut out the point; of the curves a combination of them is proved.
        assert_eq!(proof["all_equations"], place == 2);
    }
    let output = decompose(folder.path(), UNION, &["--certify", "--seed", "1"]);
    let said = String::from_utf8_lossy(&output.stdout);
    let expected = [
        "proved:   4 of 4 witness points alone in boxes",
        "3 of 3 components are irreducible",
        "evidence: that no witness point is missing",
    ];
    for part in expected {
        assert!(said.contains(part), "{part}: {said}");
    }
    let plain = json(&decompose(folder.path(), UNION, &options[1..]));
    assert!(plain["decomposition"]["components"][0]["certified"].is_null());
}

#[test]
fn what_cannot_be_decomposed_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = |text: &str, options: &[&str], reason: &str| {
        let output = decompose(folder.path(), text, options);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(reason), "{said}");
        assert!(output.stdout.is_empty(), "{output:?}");
    };
    refused(
        UNION,
        &["--dimension", "2"],
        "components have dimensions 0 to 1",
    );
    refused(
        UNION,
        &["--dimension", "2..1"],
        "expected a dimension such as 1",
    );
    let family =
        "CONFIG\nEND;\nINPUT\nvariable_group x, y; parameter p; function f; f = x*y - p;\nEND;\n";
    refused(
        family,
        &[],
        "parameters (p) and no values for them: --targets",
    );
    let nothing = "CONFIG\nEND;\nINPUT\nvariable_group x, y; function f; f = (x + y)^2 - x^2 - 2*x*y - y^2;\nEND;\n";
    refused(nothing, &[], "every equation is identically 0");
}

#[test]
fn parameters_get_their_values() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family =
        "CONFIG\nEND;\nINPUT\nvariable_group x, y; parameter p; function f; f = x*y - p;\nEND;\n";
    for (value, expected) in [("0", vec![(1, 1), (1, 1)]), ("3", vec![(1, 2)])] {
        let file = folder.path().join("values");
        std::fs::write(&file, format!("{{\"p\": {value}}}")).expect("the folder is writable");
        let file = file.display().to_string();
        let options = [
            "--target-parameters",
            &file,
            "--format",
            "json",
            "--seed",
            "2",
        ];
        let output = decompose(folder.path(), family, &options);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert_eq!(components(&json(&output)), expected);
    }
}

/// A decomposition goes on with further equations, as one of all of them; a file that is no equation of the system is
/// refused.
#[test]
fn equations_are_added_to_a_decomposition() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
        command
            .args(arguments)
            .output()
            .expect("the program starts")
    };
    let code = |output: &Output| output.status.code();
    let said = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();
    let whole = decompose(folder.path(), UNION, &["--output", &place("union")]);
    assert_eq!(code(&whole), Some(0), "{whole:?}");
    let added = "CONFIG\nEND;\nINPUT\nvariable_group y, x;\nfunction h;\nh = (x - 3)*(x + 2*y - 1);\nEND;\n";
    std::fs::write(place("added"), added).expect("the folder is writable");
    let resumed = [
        "decompose",
        "--resume",
        &place("union"),
        "--add",
        &place("added"),
    ];
    let to = ["--verify", "--format", "json", "--output", &place("more")];
    let output = run(&[&resumed[..], &to].concat());
    assert_eq!(code(&output), Some(0), "{output:?}");
    let summary = json(&output);
    // The line stays, and so does the point (3, 5); of the parabola (3, 9) is left, and points on the line are junk.
    assert_eq!(components(&summary), [(1, 1), (0, 1), (0, 1)]);
    assert_eq!(summary["decomposition"]["verification"]["agrees"], true);
    assert_eq!(summary["problem"]["equations"], 3);
    // The decomposition that was written can be read and resumed again.
    let extended_decomposition = run(&[
        "decompose",
        "--resume",
        &place("more"),
        "--add",
        &place("added"),
    ]);
    assert_eq!(
        code(&extended_decomposition),
        Some(0),
        "{extended_decomposition:?}"
    );
    // A locus is no decomposition; nor is one of which not all dimensions were asked.
    let locus = run(&[
        "singular-locus",
        &place("more"),
        "--component",
        "1.1",
        "--output",
        &place("locus"),
    ]);
    assert_eq!(code(&locus), Some(0), "{locus:?}");
    let refused = run(&[
        "decompose",
        "--resume",
        &place("locus"),
        "--add",
        &place("added"),
    ]);
    assert_eq!(code(&refused), Some(2), "{refused:?}");
    assert!(said(&refused).contains("locus"), "{refused:?}");
    let curves = decompose(
        folder.path(),
        UNION,
        &["--dimension", "1", "--output", &place("curves")],
    );
    assert_eq!(code(&curves), Some(0), "{curves:?}");
    let some = [
        "decompose",
        "--resume",
        &place("curves"),
        "--add",
        &place("added"),
    ];
    let refused = run(&some);
    assert_eq!(code(&refused), Some(2), "{refused:?}");
    assert!(said(&refused).contains("1 to 1"), "{refused:?}");
    let enough = run(&[&some[..], &["--dimension", "1"]].concat());
    assert_eq!(code(&enough), Some(0), "{enough:?}");
    for wrong in [
        &["decompose", "--resume", &place("union")][..],
        &["decompose", &place("added"), "--add", &place("added")],
        &[&resumed[..], &["--seed", "3"]].concat(),
        &[&resumed[..], &["--method", "cascade"]].concat(),
    ] {
        let refused = run(wrong);
        assert_eq!(code(&refused), Some(2), "{wrong:?}: {refused:?}");
    }
}
