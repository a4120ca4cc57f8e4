//! Bad input: exit code 2, one clear message that says where, and the service still up.

use cognate_tests::builders::square_root_of_two;
use cognate_tests::client::Submission;
use cognate_tests::cluster::Cluster;
use cognate_tests::processes::cognate;
use std::process::{Command, Output};

/// An input whose INPUT section is this.
fn input(body: &str) -> Vec<u8> {
    format!("CONFIG\nEND;\nINPUT\n{body}\nEND;\n").into_bytes()
}

/// Name, content, and words that the message must have.
fn cases() -> Vec<(&'static str, Vec<u8>, Vec<&'static str>)> {
    let many = |count: usize| {
        let names: Vec<String> = (0..count).map(|k| format!("x{k}")).collect();
        let equations: Vec<String> = (0..count).map(|k| format!("f{k} = x{k}^2 - 1;")).collect();
        let functions: Vec<String> = (0..count).map(|k| format!("f{k}")).collect();
        let (names, functions) = (names.join(", "), functions.join(", "));
        input(&format!(
            "variable_group {names};\nfunction {functions};\n{}",
            equations.join("\n")
        ))
    };
    vec![
        ("empty", Vec::new(), vec!["empty"]),
        (
            "unknown_name",
            input("variable_group x;\nfunction f;\nf = x^2 + y;"),
            vec!["y", ":6:"],
        ),
        (
            "missing_bracket",
            input("variable_group x;\nfunction f;\nf = (x^2 - 2;"),
            vec![":6:", ")"],
        ),
        ("no_equation", input("variable_group x;"), vec!["equation"]),
        (
            "constant_equation",
            input("variable_group x;\nfunction f, g;\nf = x^2 - 2;\ng = 3;"),
            vec!["`g`", "contains none"],
        ),
        (
            "binary_junk",
            (0..4096u32)
                .map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8)
                .collect(),
            vec!["binary_junk"],
        ),
        (
            "too_few_equations",
            input("variable_group x, y;\nfunction f;\nf = x^2 - y;"),
            vec!["not in this version", "Add one equation"],
        ),
        ("too_large", many(1001), vec!["VARIABLES"]),
        (
            "too_high",
            input("variable_group x;\nfunction f;\nf = x^1000001 - 2;"),
            vec!["EXPONENT"],
        ),
    ]
}

/// Exit code 2, nothing on standard output, one message with these words.
fn check(what: &str, output: &Output, words: &[&str]) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{what}: {message}");
    assert!(output.stdout.is_empty(), "{what}: {:?}", output.stdout);
    let errors = message
        .lines()
        .filter(|line| line.starts_with("error"))
        .count();
    assert_eq!(errors, 1, "{what}: one message: {message}");
    assert!(
        message.lines().count() <= 6,
        "{what}: a short one: {message}"
    );
    for word in words {
        assert!(message.contains(word), "{what}: no `{word}` in: {message}");
    }
    assert!(!message.contains("panicked"), "{what}: {message}");
}

#[test]
fn bad_files_are_refused_and_the_service_stays_up() {
    let mut cluster = Cluster::with_workers(1);
    let client = cluster.client();
    for (name, content, words) in cases() {
        let file = cluster.folder().join(name);
        std::fs::write(&file, &content).unwrap();
        let file = file.display().to_string();
        check(name, &cluster.command(&["submit", &file]), &words);
        let solve = cluster.command(&["solve", &file, "--format", "json"]);
        check(name, &solve, &words);

        // The coordinator refuses the submission also without our client in front.
        if let Ok(text) = String::from_utf8(content) {
            let refusal = client.try_submit(&Submission::of(text)).expect_err(name);
            let refused = [
                tonic::Code::InvalidArgument,
                tonic::Code::ResourceExhausted,
                tonic::Code::Unimplemented,
            ];
            assert!(refused.contains(&refusal.code()), "{name}: {refusal:?}");
            assert!(!refusal.message().is_empty(), "{name}");
        }
    }
    let missing = cluster.command(&["submit", "no-such-file"]);
    check("missing file", &missing, &["no-such-file"]);
    assert!(cluster.coordinator.is_alive());
    let answer = client.solve(&Submission::of(square_root_of_two()));
    assert_eq!(answer.counts.solutions_distinct, 2);
    cluster.stop();
}

#[test]
fn wrong_usage_has_code_two() {
    for arguments in [
        &["no-such-command"][..],
        &["solve"],
        &["worker", "--coordinator", "nowhere"],
        &["worker", "--coordinator", "h:1", "--lane-width", "3"],
        &["coordinator", "--ledger", "redis:x"],
        &["coordinator", "--listen", "0.0.0.0:0"],
    ] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut command = Command::new(cognate());
        command.current_dir(folder.path()).args(arguments);
        let output = command.output().expect("cognate can be started");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains("error"), "{arguments:?}: {message}");
    }
}
