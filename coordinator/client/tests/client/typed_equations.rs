//! Equations that are typed, in a file and with `-e`: the same system, and mistakes with their places.

use super::program::{cognate, text};
use serde_json::Value;

/// x^2 + y^2 = 5 and x y = 2 have the solutions (1, 2), (2, 1), (-1, -2) and (-2, -1).
#[test]
fn typed_equations_are_solved_and_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("two.txt");
    std::fs::write(
        &file,
        "# a circle and a hyperbola\nx^2 + y^2 = 5\nx*y = 2\n",
    )
    .expect("it is writable");
    let file = file.display().to_string();
    let typed = ["-e", "x^2 + y^2 = 5", "-e", "x*y = 2"];
    for source in [&typed[..], &[&file]] {
        let output = cognate(&[&["solve", "--format", "json"], source].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
        assert_eq!(summary["solutions"]["real"], 4);
        let output = cognate(&[&["convert", "--to", "plain"], source].concat());
        assert_eq!(
            text(&output.stdout),
            "unknowns: x, y\nx^2 + y^2 - 5 = 0\nx*y - 2 = 0\n"
        );
    }
    let output = cognate(&["decompose", "-e", "x*y = 0", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let components = summary["decomposition"]["components"]
        .as_array()
        .map(Vec::len);
    assert_eq!(components, Some(2));
    assert_eq!(
        cognate(&["info", "-e", "-x + 1 = 0"]).status.code(),
        Some(0)
    );
}

#[test]
fn mistakes_in_typed_equations_are_named() {
    for (arguments, expected) in [
        (
            &["-e", "x = 1", "-e", "2 x + y = 3"][..],
            "-e:2:3: expected an operator",
        ),
        (&["-e", "x = 1", "two.txt"], "cannot be used with"),
        (&[], "required"),
        (&["-e", ""], "at least one equation"),
    ] {
        let output = cognate(&[&["solve"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = text(&output.stderr);
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
}

/// sqrt(x) + sqrt(x + 3) is sqrt(3) at x = 0, which the digits of eight decimals put on a false branch.
#[test]
fn rounded_values_of_parameters_are_doubted_as_those_in_equations() {
    let typed = ["-e", "sqrt(x) + sqrt(x + 3) = 1.73205080"];
    let equation = ["-e", "parameters: c", "-e", "sqrt(x) + sqrt(x + 3) = c"];
    let with = |value: &'static str| [&equation[..], &["--targets", value]].concat();
    for (arguments, code) in [
        (typed.to_vec(), 1),
        (with("c=1.73205080"), 1),
        (with("c=2"), 0),
    ] {
        let output = cognate(&[&["solve"], &arguments[..]].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    }
}

/// The leading coefficient is 0 for the number that was meant.
#[test]
fn a_coefficient_that_may_be_0_is_named_with_its_place() {
    let equation = "(1.4142135623730950^2 - 2)*x^3 + x^2 = 4";
    let output = cognate(&["solve", "-e", equation]);
    let said = text(&output.stderr) + &text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("column 23: this constant"), "{said}");
}

/// x^2 = 2 is solved without paths; the starts that have some are named.
#[test]
fn a_start_without_paths_has_no_path_to_show() {
    let path = ["path", "-e", "x^2 = 2", "--index", "0"];
    let output = cognate(&path);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let expected = "--index: the one-unknown start solves this problem without paths; --start total-degree has 2 paths";
    assert!(said.contains(expected), "{said}");
    let output = cognate(&[&path[..], &["--start", "total-degree"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// An objective and conditions are written where the notation has words for them, and else named.
#[test]
fn what_a_notation_cannot_say_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("arc.txt");
    std::fs::write(&file, "x^2 + y^2 = 1\nminimize: x + y\nwhere: x > 0\n")
        .expect("it is writable");
    let file = file.display().to_string();
    let output = cognate(&["convert", &file, "--to", "plain"]);
    assert_eq!(text(&output.stderr), "");
    let expected = "unknowns: x, y\nx^2 + y^2 - 1 = 0\nwhere: x > 0\nminimize: x + y\n";
    assert_eq!(text(&output.stdout), expected);
    let said = text(&cognate(&["convert", &file, "--to", "bertini"]).stderr);
    for part in [
        "the condition x > 0 is left out",
        "minimize: x + y is left out",
    ] {
        assert!(said.contains(part), "{said}");
    }
}
