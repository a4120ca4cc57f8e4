//! Rows on standard output: whatever they cannot say stands on standard error, and standard output has rows alone.

use super::program::text;
use std::path::Path;
use std::process::{Command, Output};

fn cognate(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command.args(arguments).current_dir(folder);
    command.output().expect("the program starts")
}

/// Checks the number of rows and the words beside them, in both formats with rows.
fn check(folder: &Path, arguments: &[&str], rows: usize, said: &[&str]) {
    for (format, head) in [("csv", 1), ("jsonl", 0)] {
        let output = cognate(folder, &[arguments, &["--format", format]].concat());
        let (out, beside) = (text(&output.stdout), text(&output.stderr));
        assert_eq!(out.lines().count(), rows + head, "{arguments:?}: {out}");
        // Long lines are wrapped.
        let line = beside.split_whitespace().collect::<Vec<_>>().join(" ");
        for words in said {
            assert!(line.contains(words), "{arguments:?} {format}: {beside}");
        }
        assert_eq!(
            beside.is_empty(),
            said.is_empty(),
            "{arguments:?}: {beside}"
        );
    }
}

#[test]
fn sets_and_points_without_a_row_are_said_beside_the_solutions() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let set = "a positive-dimensional solution set: `cognate decompose FILE` finds it";
    let sine = ["solve", "-e", "sin(x)^2 + cos(x)^2 = 1"];
    check(
        folder.path(),
        &sine,
        0,
        &["note: no isolated solution, but", set],
    );
    let plane = ["solve", "-e", "x*(x - 1) = 0", "-e", "x*(y - 2) = 0"];
    check(
        folder.path(),
        &plane,
        1,
        &["note: and also a positive-dimensional"],
    );
    let quotient = ["solve", "-e", "(x^2 - 1)/(x - 1) = 0"];
    check(
        folder.path(),
        &quotient,
        1,
        &["note: 1 point removed (", "no solutions"],
    );
    check(folder.path(), &["solve", "-e", "x^2 = 4"], 2, &[]);
}

#[test]
fn sets_at_targets_and_warnings_are_said_beside_the_solutions_of_a_family() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = "parameters: p\nx*(x - 1) = 0\nx*(y - 2) = p*(y - 2)\n";
    std::fs::write(folder.path().join("family.txt"), family).expect("writable");
    let targets = ["solve", "family.txt", "--targets", "p=2,1,3"];
    check(
        folder.path(),
        &targets,
        5,
        &["a positive-dimensional solution set at target 1"],
    );
}

#[test]
fn an_empty_list_of_components_or_real_points_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path();
    for format in ["csv", "jsonl"] {
        let none = [
            "decompose",
            "-e",
            "x = 1",
            "-e",
            "x = 2",
            "--format",
            format,
        ];
        let output = cognate(path, &none);
        assert_eq!(text(&output.stdout), "", "{format}");
        assert!(text(&output.stderr).contains("note: no components in the dimensions"));
    }
    let imaginary = ["decompose", "-e", "x^2 + y^2 = -1", "--output", "set"];
    assert_eq!(cognate(path, &imaginary).status.code(), Some(0));
    let output = cognate(path, &["real-points", "set", "--format", "csv"]);
    assert_eq!(text(&output.stdout), "component,x,y\n");
    assert!(text(&output.stderr).contains("component 1.1 has no real points"));
}

#[test]
fn poses_out_of_reach_and_sets_of_postures_are_said_beside_positions() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path();
    let arm = "# angles: deg\nname,theta,d,a,alpha\nfirst,0,0,1,0\nsecond,0,0,1,0\n";
    std::fs::write(path.join("arm.csv"), arm).expect("writable");
    let poses = "x,y,z\n1,1,0\n5,0,0\n0,0,0\n";
    std::fs::write(path.join("poses.csv"), poses).expect("writable");
    let inverse = ["mechanism", "inverse", "arm.csv", "--task", "position"];
    let to = ["--poses", "poses.csv", "--format", "csv"];
    let output = cognate(path, &[&inverse[..], &to].concat());
    let beside = text(&output.stderr);
    assert!(beside.contains("no real position at target 2"), "{beside}");
    assert!(
        beside.contains("3.1 is one of a set of dimension 1"),
        "{beside}"
    );
    let alone = ["--pose", "5 0 0", "--format", "csv"];
    let output = cognate(path, &[&inverse[..], &alone].concat());
    let beside = text(&output.stderr);
    assert!(
        beside.contains("no position to show: the pose is out of reach"),
        "{beside}"
    );
    assert_eq!(text(&output.stdout).lines().count(), 1);
}
