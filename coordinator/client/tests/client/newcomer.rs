//! The first hour of a new user: names of columns, whole tables, words beside numbers, a service that only begins.

use super::program::{cognate, text};
use cognate_client::connection::{Connection, Target};
use cognate_client::error::ClientError;
use cognate_worker::transport::connect::CredentialFiles;
use serde_json::Value;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A UR5e.
const ARM: &str = "# angles: deg\nname,theta,d,a,alpha\npan,0,0.1625,0,90\nlift,0,0,-0.425,0\nelbow,0,0,-0.3922,0\n\
    wrist1,0,0.1333,0,90\nwrist2,0,0.0997,0,-90\nwrist3,0,0.0996,0,0\n";

/// A file of a temporary folder.
fn written(folder: &tempfile::TempDir, name: &str, content: &str) -> String {
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("it is writable");
    path.display().to_string()
}

/// Standard output of a command that ends well.
fn answer(arguments: &[&str]) -> String {
    let output = cognate(arguments);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{arguments:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

#[test]
fn points_of_components_have_the_names_of_the_unknowns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let set = folder.path().join("set").display().to_string();
    answer(&["decompose", "-e", "a^2 + b^2 = 1", "--output", &set]);
    let header = |arguments: &[&str]| {
        let rows = answer(&[arguments, &["--format", "csv"]].concat());
        let mut lines = rows.lines().map(str::to_owned);
        let header = lines.next().expect("a header");
        let cells = header.split(',').count();
        assert!(lines.all(|line| line.split(',').count() == cells), "{rows}");
        header
    };
    assert_eq!(
        header(&["sample", &set, "--count", "3", "--real"]),
        "component,a,b"
    );
    let complex = header(&["sample", &set, "--count", "3"]);
    assert_eq!(complex, "component,a_re,a_im,b_re,b_im");
    assert_eq!(header(&["real-points", &set]), "component,a,b");
}

/// A table in a pipe has every column, and no cell is cut.
#[test]
fn tables_in_a_pipe_are_whole() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = written(&folder, "arm.csv", ARM);
    let joints = ["pan", "lift", "elbow", "wrist1", "wrist2", "wrist3"];
    let values: Vec<String> = joints
        .iter()
        .map(|joint| format!("{joint}=12.3456"))
        .collect();
    let set = values.iter().flat_map(|value| ["--set", value]);
    let arguments: Vec<&str> = ["mechanism", "forward", &arm]
        .into_iter()
        .chain(set)
        .collect();
    let table = answer(&arguments);
    assert!(!table.contains('…') && !table.contains("..."), "{table}");
    for column in ["wrist3", "qx", "qy", "qz", "condition"] {
        assert!(table.contains(column), "{column}: {table}");
    }
    let heads = table
        .lines()
        .filter(|line| line.trim_start().starts_with("#  "));
    assert!(heads.count() >= 2, "blocks begin with the number: {table}");
}

/// Joint values that are typed as a line of numbers are those of `--set`.
#[test]
fn forward_takes_joint_values_as_a_line_of_numbers() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = written(&folder, "arm.csv", ARM);
    let rows = |inputs: &[&str]| {
        let command = ["mechanism", "forward", &arm, "--format", "csv"];
        answer(&[&command[..], inputs].concat())
    };
    let joints = [
        "pan=-20",
        "lift=-60",
        "elbow=70",
        "wrist1=-30",
        "wrist2=40",
        "wrist3=15",
    ];
    let set: Vec<&str> = joints.iter().flat_map(|value| ["--set", value]).collect();
    let expected = rows(&set);
    assert_eq!(rows(&["--inputs", "-20 -60 70 -30 40 15"]), expected);
    assert_eq!(rows(&["--inputs", "-20, -60, 70, -30, 40, 15"]), expected);
}

#[test]
fn a_pose_out_of_reach_is_called_so() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = written(&folder, "arm.csv", ARM);
    let table = answer(&["mechanism", "inverse", &arm, "--pose", "9 9 9 1 0 0 0"]);
    assert!(
        table
            .contains("no position to show: the pose is out of reach; all 8 positions are complex"),
        "{table}"
    );
}

/// At its home a UR5e has one posture, which several solutions of the equations stand for.
#[test]
fn singular_postures_add_up_to_their_count() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = written(&folder, "arm.csv", ARM);
    let home = "0 -0.2329 1.0794 0 0 0.7071067811865475 -0.7071067811865475";
    let table = answer(&["mechanism", "inverse", &arm, "--pose", home]);
    let number_after = |words: &str| {
        let rest = table
            .split(words)
            .nth(1)
            .unwrap_or_else(|| panic!("{words}: {table}"));
        let number = rest.split_whitespace().next().expect("a number");
        number.parse::<u64>().expect("a number")
    };
    let shown = number_after("is singular, counted");
    assert_eq!(shown + number_after("the other"), 8, "{table}");
}

#[test]
fn residuals_are_those_of_the_digits() {
    let line = answer(&[
        "solve",
        "-e",
        "x^3 - 2*x - 5",
        "--digits",
        "50",
        "--real",
        "--format",
        "jsonl",
    ]);
    let solution: Value = serde_json::from_str(&line).expect("one object");
    let residual = solution["residual"].as_f64().expect("a number");
    assert!(residual < 1e-49, "{line}");
}

#[test]
fn points_beside_a_curve_are_left_out_by_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let set = folder.path().join("set").display().to_string();
    let circle_and_point = [
        "-e",
        "(x^2 + y^2 - 1)*(x - 3) = 0",
        "-e",
        "(x^2 + y^2 - 1)*(y - 3) = 0",
    ];
    answer(&[&["decompose", "--output", &set], &circle_and_point[..]].concat());
    let curve: Value =
        serde_json::from_str(&answer(&["real-curve", &set, "--format", "json"])).expect("JSON");
    assert_eq!(curve["settled"], true, "{curve}");
    assert_eq!(curve["components"].as_array().map(Vec::len), Some(1));
    let warning = curve["warnings"][0].as_str().unwrap_or_default();
    assert!(
        warning.contains("0.1 (dimension 0)") && warning.contains("cognate real-points"),
        "{curve}"
    );
}

#[test]
fn settings_of_bertini_are_followed_or_named_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let system = "INPUT\nvariable_group x, y; function f; f = x^2 + y^2 - 1;\nEND;\n";
    let config = "CONFIG\nTrackType: 1;\nFinalTol: 1e-3;\nOdePredictor: 5;\nMaxNorm: 1e5;\nEND;\n";
    let file = written(&folder, "curve.bertini", &format!("{config}{system}"));
    let decomposition: Value =
        serde_json::from_str(&answer(&["decompose", &file, "--format", "json"])).expect("JSON");
    let warnings: Vec<&str> = decomposition["warnings"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(
        warnings[0]
            .ends_with("the settings OdePredictor, MaxNorm have no meaning here and are ignored"),
        "{warnings:?}"
    );
    assert!(warnings[1].contains("FinalTol 1e-3"), "{warnings:?}");
    let plain = written(&folder, "plain.bertini", &format!("CONFIG\nEND;\n{system}"));
    let decomposition: Value =
        serde_json::from_str(&answer(&["decompose", &plain, "--format", "json"])).expect("JSON");
    assert_eq!(decomposition["warnings"].as_array().map(Vec::len), Some(0));
}

/// A process that ends with its test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A command that is typed on the line after the coordinator waits until it listens.
#[test]
fn a_command_waits_for_a_coordinator_that_begins() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let address = format!("unix:{}", folder.path().join("socket").display());
    let target = Target::read(&address, &CredentialFiles::default()).expect("an address");
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let nobody = runtime.block_on(Connection::open_at_once(&target));
    assert!(
        matches!(nobody, Err(ClientError::Absent { .. })),
        "{nobody:?}"
    );
    let mut command = Command::new(env!("CARGO_BIN_EXE_cognate"));
    command.args(["coordinator", "--listen", &address]);
    command
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let begins = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(300));
        Running(command.spawn().expect("the program starts"))
    });
    // Only a program that hangs takes two minutes.
    let opened = runtime.block_on(Connection::open_within(Duration::from_secs(120), &target));
    let _coordinator = begins.join().expect("it has begun");
    assert!(opened.is_ok(), "{opened:?}");
}

/// Coordinates of very different sizes: 1 beside 1e20 is known to all its digits, as a concentration of 1e-20 is, and
/// neither is shown as 0.
#[test]
fn small_coordinates_that_are_known_are_shown() {
    let spread = answer(&["solve", "-e", "x*y = 1e20", "-e", "x = y*1e-20"]);
    for (x, y) in [("1", "1e20"), ("-1", "-1e20")] {
        let is_row = |line: &str| line.split_whitespace().rev().take(2).eq([y, x]);
        assert!(spread.lines().any(is_row), "{spread}");
    }
    let tiny = answer(&["solve", "-e", "x = 1e-20"]);
    assert!(tiny.lines().any(|line| line.ends_with("1e-20")), "{tiny}");
}
