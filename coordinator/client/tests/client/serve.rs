//! `cognate serve`: the answers of `cognate solve`, line by line.

use super::program::{cognate, text};
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Output, Stdio};

fn served(lines: &[Value]) -> (Output, Vec<Value>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command
        .arg("serve")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped());
    let mut program = command.spawn().expect("the program starts");
    let mut input = program.stdin.take().expect("a pipe was asked for");
    for line in lines {
        writeln!(input, "{line}").expect("the program reads");
    }
    drop(input);
    let output = program.wait_with_output().expect("the program ends");
    let answers = text(&output.stdout);
    let answers = answers
        .lines()
        .map(|line| serde_json::from_str(line).expect("a line is JSON"));
    let answers = answers.collect();
    (output, answers)
}

/// A summary without what differs from run to run.
fn lasting(mut summary: Value) -> Value {
    for name in ["job", "time", "workers"] {
        summary[name] = Value::Null;
    }
    summary
}

#[test]
fn an_answer_is_that_of_solve() {
    let cases: [&[&str]; 4] = [
        &["-e", "x^2 + y^2 = 5", "-e", "x*y = 2"],
        &["-e", "x^2 = 2", "--certify", "--digits", "30"],
        &[
            "-e",
            "x^3 - 3*x + 1",
            "-e",
            "y^2 - x",
            "--where",
            "x > 0",
            "--sort",
            "-y",
        ],
        &["-e", "x^2 + 3*y^2 = 1", "--minimize", "(x - 2)^2 + y^2"],
    ];
    let lines = cases.map(|arguments| json!({"arguments": arguments, "id": arguments.len()}));
    let (output, answers) = served(&lines);
    assert_eq!(
        (output.status.code(), answers.len()),
        (Some(0), cases.len())
    );
    for ((arguments, answer), line) in cases.iter().zip(&answers).zip(1..) {
        assert_eq!(
            (&answer["line"], &answer["id"]),
            (&json!(line), &json!(arguments.len()))
        );
        let solved = |format: &str| {
            let words = [&["solve", "--format", format], *arguments].concat();
            text(&cognate(&words).stdout)
        };
        let summary: Value = serde_json::from_str(&solved("json")).expect("a summary");
        assert_eq!(lasting(answer["summary"].clone()), lasting(summary));
        let rows = solved("jsonl");
        let rows: Vec<Value> = rows
            .lines()
            .map(|row| serde_json::from_str(row).expect("a row"))
            .collect();
        assert_eq!(answer["solutions"], json!(rows));
    }
}

#[test]
fn a_mistake_is_answered_and_the_next_line_too() {
    let lines = [
        json!({"arguments": ["-e", "x + $"]}),
        json!({"arguments": ["-e", "x = 1", "--certfy"], "id": "b"}),
        json!("nonsense"),
        json!({"arguments": ["--targets=-", "-e", "x = p"]}),
        json!({"arguments": ["-e", "x = 1", "--page"]}),
        json!({"arguments": ["-e", "x = p*1", "--targets", "p=1,2,3"]}),
        json!({"arguments": ["-e", "2*x = 1"], "id": {"a": [1]}}),
    ];
    let (output, answers) = served(&lines);
    assert_eq!(
        (output.status.code(), answers.len()),
        (Some(2), lines.len())
    );
    let (last, refused) = answers.split_last().expect("answers");
    for answer in refused {
        assert_eq!(answer["exit_code"], 2, "{answer}");
        assert!(
            answer["error"]
                .as_str()
                .is_some_and(|error| !error.contains("try:")),
            "{answer}"
        );
    }
    assert!(
        refused[0]["error"]
            .as_str()
            .is_some_and(|error| error.starts_with("-e:1:5: expected"))
    );
    assert!(
        refused[1]["error"]
            .as_str()
            .is_some_and(|error| error.contains("--certify"))
    );
    assert_eq!(refused[1]["id"], "b");
    assert_eq!(
        (&last["exit_code"], &last["id"]),
        (&json!(0), &json!({"a": [1]}))
    );
    assert_eq!(last["solutions"][0]["variables"]["x"], json!([0.5, 0.0]));
}

#[test]
fn progress_comes_between_the_answers() {
    let lines = [
        json!({"arguments": ["-e", "x^2 + y^2 = 5", "-e", "x*y = 2", "--progress", "json"], "id": 7}),
    ];
    let (_, answers) = served(&lines);
    let (last, before) = answers.split_last().expect("an answer");
    assert_eq!(last["exit_code"], 0);
    for line in before {
        assert_eq!(line["id"], 7);
        assert!(line["progress"].is_object(), "{line}");
    }
}
