//! Answers for thousands of poses, written while they come: every form says the same.

use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Number of poses: more than twice the number that is held at a time.
const POSES: usize = 2100;

fn cognate(arguments: &[&str], poses: &Path) -> String {
    let arm = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/mechanisms/arm_generic/arm.json");
    let output = Command::new(env!("CARGO_BIN_EXE_cognate"))
        .args(["mechanism", "inverse"])
        .arg(arm)
        .arg("--poses")
        .arg(poses)
        .arg("--no-cache")
        .args(arguments)
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).expect("text")
}

/// Places on a line within the arm's reach, turned further and further.
fn poses() -> String {
    let mut text = "x,y,z,qw,qx,qy,qz\n".to_owned();
    for k in 0..POSES {
        let s = k as f64 / POSES as f64;
        let length = (0.84 + s * s).sqrt();
        let [w, x, y, z] = [0.8, 0.4, s, 0.2].map(|c| c / length);
        let _ = writeln!(
            text,
            "{},{},0.1,{w},{x},{y},{z}",
            0.9 * s - 0.4,
            0.3 - 0.5 * s
        );
    }
    text
}

fn counts(target: &Value) -> [u64; 2] {
    let counts = &target["configurations"];
    ["complex", "real"].map(|name| counts[name].as_u64().expect("a number"))
}

#[test]
fn thousands_of_poses_are_shown_alike_in_every_form() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("poses.csv");
    std::fs::write(&file, poses()).expect("written");
    let written = folder.path().join("out");
    let there = written.to_str().expect("a name");
    let answer: Value =
        serde_json::from_str(&cognate(&["--format", "json", "--output", there], &file))
            .expect("JSON");
    let targets = answer["targets"].as_array().expect("targets");
    assert_eq!(
        (targets.len(), &answer["settled"]),
        (POSES, &Value::Bool(true))
    );
    for (index, target) in targets.iter().enumerate() {
        assert_eq!(target["index"].as_u64(), Some(index as u64));
        let [complex, real] = counts(target);
        let listed = target["solutions"].as_array().expect("solutions").len() as u64;
        assert_eq!((complex, real), (16, listed), "pose {index}");
    }
    let real: u64 = targets.iter().map(|target| counts(target)[1]).sum();
    assert!(real > POSES as u64);

    let summary = std::fs::read_to_string(written.join("summary.json")).expect("written");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    let lines = std::fs::read_to_string(written.join("configurations.jsonl")).expect("written");
    let lines = lines
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    assert!(lines.eq(targets.iter().cloned()));
    let same = summary["targets"].as_array().expect("targets").iter();
    assert!(same.map(counts).eq(targets.iter().map(counts)));

    let rows = cognate(&["--format", "csv"], &file);
    let solutions = std::fs::read_to_string(written.join("solutions.csv")).expect("written");
    assert_eq!(rows, solutions);
    assert!(
        rows.starts_with("target,solution,q1,q2,q3,q4,q5,q6,x,y,z,"),
        "{rows:.80}"
    );
    assert_eq!(rows.lines().count() as u64, real + 1);

    // A table that a person can read: a row for all targets with the same counts.
    let table = cognate(&["--threads", "1"], &file);
    assert!(table.lines().count() < 100, "{table}");
    let mut grouped = 0;
    let rows = table
        .lines()
        .skip_while(|line| !line.contains("targets  first"));
    for row in rows.skip(1).take_while(|line| !line.trim().is_empty()) {
        let cells: Vec<String> = row.split_whitespace().map(|s| s.replace(',', "")).collect();
        let number = |k: usize| cells[k].parse::<u64>().expect("a number");
        let first = number(1) as usize;
        assert_eq!(counts(&targets[first - 1]), [number(2), number(3)], "{row}");
        grouped += number(0);
    }
    assert_eq!(grouped, POSES as u64, "{table}");
    let more = format!("{} more", real - 64);
    assert!(table.replace(',', "").contains(&more), "{table}");
}

/// A URDF in macros is what the program xacro makes of it, where that is installed.
#[test]
#[cfg(unix)]
fn a_urdf_in_macros_is_expanded_by_xacro() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("it is writable");
        path
    };
    let plain = "<robot name=\"a\"><link name=\"base\"/><link name=\"tip\"/><joint name=\"swing\" type=\"continuous\">\
        <parent link=\"base\"/><child link=\"tip\"/><axis xyz=\"0 0 1\"/></joint></robot>";
    let expanded = write("expanded.urdf", plain);
    let macros = write(
        "arm.xacro",
        "<robot name=\"a\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:include filename=\"b\"/></robot>",
    );
    let info = |path: &std::ffi::OsStr| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_cognate"));
        command
            .args(["mechanism", "info"])
            .arg(&macros)
            .env("PATH", path);
        command.output().expect("the program starts")
    };
    let without = info("/nowhere".as_ref());
    assert_eq!(without.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&without.stderr).contains("install xacro"));
    let program = write(
        "xacro",
        &format!(
            "#!/bin/sh\n[ \"$2\" = {} ] && exec cat {}\n",
            macros.display(),
            expanded.display()
        ),
    );
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("it is ours");
    let mut path = folder.path().as_os_str().to_owned();
    path.push(":/usr/bin:/bin");
    let with = info(&path);
    assert_eq!(
        with.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&with.stderr)
    );
    assert!(String::from_utf8_lossy(&with.stdout).contains("swing"));
    std::fs::write(&program, "#!/bin/sh\necho undefined property >&2; exit 2\n")
        .expect("it is ours");
    let failed = info(&path);
    assert_eq!(failed.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&failed.stderr).contains("undefined property"));
}
