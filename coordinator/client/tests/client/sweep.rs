//! A family at many values of its parameters, by `solve FAMILY --targets ..` alone.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// x^3 + p x + q: three real solutions where 4 p^3 + 27 q^2 < 0, a double one where it is 0.
const CUBIC: &str = "parameters: p, q\nx^3 + p*x + q = 0\n";

/// Runs `cognate solve FILE` in a folder that also has the cache.
fn solve(folder: &Path, family: &str, arguments: &[&str]) -> Output {
    let file = folder.join("family.txt");
    std::fs::write(&file, family).expect("the folder is writable");
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command
        .arg("solve")
        .arg(&file)
        .args(arguments)
        .current_dir(folder)
        .env("XDG_CACHE_HOME", folder.join("cache"));
    command.output().expect("the program starts")
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("no JSON: {output:?}"))
}

/// At each target: distinct, singular and real solutions, and whether the number of real ones changes.
fn rows(summary: &Value) -> Vec<(u64, u64, Option<u64>, bool)> {
    let targets = summary["targets"].as_array().expect("a list of targets");
    let row = |target: &Value| {
        let counts = &target["solutions"];
        let number = |name: &str| counts[name].as_u64();
        (
            number("distinct").unwrap_or(99),
            number("singular").unwrap_or(99),
            number("real"),
            target["changes"] == true,
        )
    };
    targets.iter().map(row).collect()
}

#[test]
fn a_family_is_solved_once_and_followed_to_every_target() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let typed = ["--targets", "p=-3", "--targets", "q=-3,-2,0,2,3"];
    let to = ["--format", "json", "--output", "here"];
    let output = solve(folder, CUBIC, &[&typed[..], &to].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = json(&output);
    let expected = [
        (3, 0, Some(1), false),
        (2, 1, Some(2), true),
        (3, 0, Some(3), true),
        (2, 1, Some(2), true),
        (3, 0, Some(1), true),
    ];
    assert_eq!(rows(&summary), expected);
    assert_eq!(summary["settled"], true);
    let family = &summary["family"];
    let family = [&family["solutions"], &family["source"], &family["settled"]];
    assert_eq!(family, [&Value::from(3), &"solved".into(), &true.into()]);
    assert_eq!(summary["targets"][1]["parameters"]["q"][0], -2.0);
    // The files have the same.
    let read = |name: &str| std::fs::read_to_string(folder.join("here").join(name)).expect(name);
    assert_eq!(
        read("targets.csv").lines().nth(2),
        Some("-3,-2,2,1,1,2,,true")
    );
    let lines = read("solutions.jsonl");
    let targets = lines.lines().map(|line| {
        let line: Value = serde_json::from_str(line).expect("a line is an object");
        line["target"].as_u64().expect("a target")
    });
    let targets: Vec<u64> = targets.collect();
    assert_eq!(targets, [0, 0, 0, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4]);
    let kept: Value = serde_json::from_str(&read("summary.json")).expect("one object");
    assert_eq!(kept["targets"], summary["targets"]);
    // The family is kept, and its solutions have all bits.
    let output = solve(folder, CUBIC, &[&typed[..], &["--format", "json"]].concat());
    let cached_summary = json(&output);
    assert_eq!(cached_summary["family"]["source"], "cache");
    assert_eq!(cached_summary["targets"], summary["targets"]);
    // Another seed has other general values.
    let other = ["--format", "json", "--seed", "3"];
    let output = solve(folder, CUBIC, &[&typed[..], &other].concat());
    assert_eq!(json(&output)["family"]["source"], "solved");
    assert_eq!(rows(&json(&output)), expected);
}

#[test]
fn targets_are_files_of_every_form_and_both_names() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    for (name, text) in [
        ("lists.json", r#"{"p": -3, "q": [-3, 0, 3]}"#),
        (
            "objects.json",
            r#"[{"p": -3, "q": -3}, {"p": -3, "q": 0}, {"p": -3, "q": 3}]"#,
        ),
        ("table.csv", "q,p\n-3,-3\n0,-3\n3,-3+0*I\n"),
    ] {
        std::fs::write(folder.join(name), text).expect("the folder is writable");
        for option in ["--targets", "--target-parameters"] {
            let output = solve(folder, CUBIC, &[option, name, "--format", "json"]);
            assert_eq!(output.status.code(), Some(0), "{name}: {output:?}");
            let real: Vec<Option<u64>> = rows(&json(&output)).iter().map(|row| row.2).collect();
            assert_eq!(real, [Some(1), Some(3), Some(1)], "{name}");
        }
    }
    // The table is for people.
    let output = solve(
        folder,
        CUBIC,
        &["--targets", "p=-3", "--targets", "q=-3,0,3"],
    );
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        table.contains("3 targets; the number of real solutions changes 2 times"),
        "{table}"
    );
    // One target is an ordinary solve.
    let one = ["--targets", "p=-3", "--targets", "q=0", "--format", "json"];
    let summary = json(&solve(folder, CUBIC, &one));
    assert_eq!(summary["solutions"]["distinct"], 3);
    assert_eq!(summary["paths"]["total"], 3);
}

/// x^2 = p and x^3 = q have a common solution where p^3 = q^2 only: nothing is followed from general values.
#[test]
fn a_family_that_is_no_base_is_solved_target_by_target() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = "parameters: p, q\nx^2 = p\nx^3 = q\n";
    std::fs::write(folder.path().join("t.csv"), "p,q\n1,1\n4,9\n4,8\n").expect("writable");
    let arguments = ["--targets", "t.csv", "--format", "json", "--output", "here"];
    let output = solve(folder.path(), family, &arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = json(&output);
    assert_eq!(summary["family"]["source"], "each target by itself");
    let distinct: Vec<u64> = rows(&summary).iter().map(|row| row.0).collect();
    assert_eq!(distinct, [1, 0, 1]);
    let lines = std::fs::read_to_string(folder.path().join("here/solutions.jsonl"));
    assert_eq!(lines.expect("lines").lines().count(), 2);
}

#[test]
fn what_is_wrong_with_targets_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (arguments, expected) in [
        (
            &["--targets", "p=1,2"][..],
            "--targets:1:1: expected a value for `q` too",
        ),
        (
            &["--targets", "p=1,2", "--targets", "r=1"],
            "expected the name of a parameter (p, q), found `r`",
        ),
        (&["--targets", "p=linspace(0,1,2000000)"], "limit TARGETS"),
        (&["--targets", "nowhere.csv"], "cannot read nowhere.csv"),
    ] {
        let output = solve(folder.path(), CUBIC, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
}

/// Start solutions that are given are followed in one job; its summary has the fields of a sweep, too.
#[test]
fn given_start_solutions_are_followed_in_one_job() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let start = r#"{"p": [-1, 0.5], "q": [0.25, 1]}"#;
    std::fs::write(folder.join("start.json"), start).expect("writable");
    let arguments = ["--targets", "start.json", "--output", "base"];
    assert_eq!(solve(folder, CUBIC, &arguments).status.code(), Some(0));
    let output = solve(
        folder,
        CUBIC,
        &[
            "--start-solutions",
            "base/solutions.jsonl",
            "--start-parameters",
            "start.json",
            "--target-parameters",
            "p=-3",
            "--targets",
            "q=-1,1",
            "--where",
            "x > 0",
            "--output",
            "here",
            "--format",
            "json",
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = json(&output);
    assert_eq!(summary["problem"]["start"], "given");
    assert_eq!(summary["family"]["source"], "given");
    assert_eq!(summary["family"]["solutions"], 3);
    let target = &summary["targets"][1];
    assert_eq!(target["paths"]["total"], 3);
    assert_eq!(target["parameters"]["q"], serde_json::json!([1.0, 0.0]));
    assert_eq!(target["selected"]["count"], 2);
    assert_eq!(target["changes"], true);
    assert_eq!(target["settled"], true);
    let table = std::fs::read_to_string(folder.join("here/targets.csv")).expect("written");
    assert_eq!(table.lines().nth(2), Some("-3,1,3,3,0,3,2,true"), "{table}");
    // The table has a row for each target, where all solutions stood together (2026-11-30); values may be typed.
    let first = ["--targets", "p=-3, q=1", "--output", "typed"];
    assert_eq!(solve(folder, CUBIC, &first).status.code(), Some(0));
    let solutions = ["--start-solutions", "typed/solutions.jsonl"];
    let values = [
        "--start-parameters",
        "p=-3, q=1",
        "--targets",
        "p=-3",
        "--targets",
        "q=-1,1",
    ];
    let output = solve(folder, CUBIC, &[&solutions[..], &values].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    let source = "3 start solutions, followed to each target: as many as the start points lead to";
    let first = table.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        first.contains(source) && first.contains("1 -3 1 3 3 0"),
        "{table}"
    );
    let wrong = [
        "--start-parameters",
        "p=-3, q=1,2",
        "--targets",
        "p=-3, q=2",
    ];
    let output = solve(folder, CUBIC, &[&solutions[..], &wrong].concat());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
}

/// A start system that was named was refused with several targets (2026-11-30).
#[test]
fn the_family_is_solved_by_the_start_that_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let targets = ["--targets", "p=-3", "--targets", "q=-1,0,3"];
    let start = ["--start", "polyhedral", "--format", "json"];
    let output = solve(folder.path(), CUBIC, &[&targets[..], &start].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = json(&output);
    assert_eq!(summary["family"]["settled"], true);
    assert_eq!(summary["targets"][2]["solutions"]["real"], 1);
}

/// One positive solution where q < 0, two where q is between 0 and 2, none beyond; x = 0 is one at q = 0.
#[test]
fn solutions_at_targets_are_selected_sorted_and_printed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let targets = ["--targets", "p=-3", "--targets", "q=-1,0,1,2,3"];
    let selection = ["--where", "x > 0", "--sort", "-x"];
    let to = ["--format", "json", "--output", "here"];
    let output = solve(folder, CUBIC, &[&targets[..], &selection, &to].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = json(&output);
    let row = |index: usize| {
        let target = &summary["targets"][index];
        let selected = &target["selected"];
        let sure = selected["on_border"] == 0 && selected["undecided"] == 0;
        (selected["count"].as_u64(), sure, target["changes"] == true)
    };
    let expected = [
        (Some(1), true, false),
        (Some(1), true, false),
        (Some(2), true, true),
        (Some(1), true, true),
        (Some(0), true, true),
    ];
    assert_eq!([0, 1, 2, 3, 4].map(row), expected);
    let read = |name: &str| std::fs::read_to_string(folder.join("here").join(name)).expect(name);
    assert_eq!(
        read("targets.csv").lines().nth(3),
        Some("-3,1,3,3,0,3,2,true")
    );
    // Rows of standard output are those of the folder.
    let rows = ["--format", "jsonl"];
    let lines = solve(folder, CUBIC, &[&targets[..], &selection, &rows].concat());
    assert_eq!(
        String::from_utf8_lossy(&lines.stdout),
        read("solutions.jsonl")
    );
    let rows = ["--format", "csv"];
    let csv = solve(folder, CUBIC, &[&targets[..], &selection, &rows].concat());
    let csv = String::from_utf8_lossy(&csv.stdout).into_owned();
    let mut lines = csv.lines();
    assert_eq!(
        lines.next(),
        Some("x,multiplicity,real,singular,on_border,target,p,q")
    );
    let cells: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let at: Vec<&str> = cells.iter().map(|row| row[5]).collect();
    assert_eq!(at, ["0", "1", "2", "2", "3"]);
    let value = |row: usize| cells[row][0].parse::<f64>().expect("a number");
    assert!(value(2) > value(3), "{csv}");
    assert_eq!(cells[4][6..], ["-3.0", "2.0"]);
    // Values that are not real have two columns.
    let complex = [
        "--targets",
        "p=-3",
        "--targets",
        "q=1,2*I",
        "--format",
        "csv",
    ];
    let csv = solve(folder, CUBIC, &complex);
    let csv = String::from_utf8_lossy(&csv.stdout).into_owned();
    let expected = "x_re,x_im,multiplicity,real,singular,target,p,q_re,q_im\n";
    assert!(csv.starts_with(expected), "{csv}");
    assert_eq!(csv.lines().count(), 7, "{csv}");
    // A family of which nothing can be followed.
    let family = "parameters: p, q\nx^2 = p\nx^3 = q\n";
    let arguments = [
        "--targets",
        "p=1,4",
        "--targets",
        "q=1,-8",
        "--positive",
        "--format",
        "json",
    ];
    let summary = json(&solve(folder, family, &arguments));
    let counts: Vec<Option<u64>> = (0..4)
        .map(|k| summary["targets"][k]["selected"]["count"].as_u64())
        .collect();
    assert_eq!(counts, [Some(1), Some(0), Some(0), Some(0)]);
}

/// 0.1 and 1/3 are no doubles: beside them the double root is two roots 7e-9 apart.
#[test]
fn values_are_the_numbers_that_were_typed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let rows_of = |family: &str, targets: &str| {
        let output = solve(folder, family, &["--targets", targets, "--format", "json"]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let counts = rows(&json(&output)).into_iter();
        counts
            .map(|(distinct, singular, real, _)| (distinct, singular, real))
            .collect::<Vec<_>>()
    };
    let tenth = "parameters: p\nx^2 - 2*x + 10*p = 0\n";
    assert_eq!(
        rows_of(tenth, "p=0.1,0.2"),
        [(1, 1, Some(1)), (2, 0, Some(0))]
    );
    let third = "parameters: p\nx^2 - 2*x + 3*p = 0\ny = x + 1\n";
    assert_eq!(
        rows_of(third, "p=linspace(0, 1, 4)"),
        [
            (2, 0, Some(2)),
            (1, 1, Some(1)),
            (2, 0, Some(0)),
            (2, 0, Some(0))
        ]
    );
    let output = solve(
        folder,
        "parameters: p\nx^2 - 2*x + 3*p = 0\n",
        &["--targets", "p=1/3", "--format", "json"],
    );
    let solutions = &json(&output)["solutions"];
    assert_eq!([&solutions["distinct"], &solutions["singular"]], [1, 1]);
}

/// One solution is near (-1/a, 1/a^2).
#[test]
fn solutions_far_out_at_some_targets_are_not_at_infinity() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = "parameters: a\na*x^3 + x^2 = 4\ny = x^2\n";
    let targets = ["--targets", "a=1e-8,1e-14,0,1", "--format", "json"];
    let output = solve(folder.path(), family, &targets);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let distinct: Vec<u64> = rows(&json(&output)).iter().map(|row| row.0).collect();
    assert_eq!(distinct, [3, 3, 2, 3]);
}
