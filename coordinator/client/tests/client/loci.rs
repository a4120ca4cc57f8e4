//! `cognate intersect`, `singular-locus`, `real-points` and `exceptional` as processes: JSON, files that are a set again,
//! exit codes.

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
    let real_points_output = cognate(
        &["real-points"],
        &[&circle],
        &["--format", "json", "--output", &to],
    );
    assert_eq!(
        real_points_output.status.code(),
        Some(0),
        "{real_points_output:?}"
    );
    let real_points = json(&real_points_output);
    assert_eq!(real_points["components"][0]["has_real_points"], true);
    let csv = std::fs::read_to_string(real.join("samples.csv")).expect("points are there");
    assert!(
        csv.starts_with("component,") && csv.lines().count() >= 3,
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

/// Exceptional sets of a family: dimension, degree, dimension of the solutions over it.
fn exceptional(folder: &TempDir, family: &str, options: &[&str]) -> (Vec<[u64; 3]>, Value) {
    let file = folder.path().join("family.json");
    std::fs::write(&file, family).expect("the folder is writable");
    let output = cognate(&["exceptional", "--format", "json"], &[&file], options);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let answer = json(&output);
    assert_eq!(answer["settled"], true);
    let sets = answer["exceptional"]["sets"].as_array().expect("a list");
    let numbers = |set: &Value| {
        ["dimension", "degree", "fibre_dimension"].map(|field| set[field].as_u64().unwrap())
    };
    (sets.iter().map(numbers).collect(), answer)
}

/// A value of a parameter, real and imaginary part, at the general point of a set.
fn value(set: &Value, parameter: &str) -> [f64; 2] {
    [0, 1].map(|part| set["point"][parameter][part].as_f64().unwrap())
}

/// Lines x = a t + b, y = c t + d, z = t on x^2 + y^2 = z^2 + 1: two rulings, each a conic
/// (../shared/systems/quadric_rulings).
#[test]
fn lines_on_a_quadric_are_exceptional() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = r#"{"variables": ["t"], "parameters": ["a", "b", "c", "d"],
        "equations": ["(a*t + b)^2 + (c*t + d)^2 - t^2 - 1"]}"#;
    let to = folder.path().join("found").display().to_string();
    let options = ["--fibre-dimension", "1", "--output", &to];
    let (sets, answer) = exceptional(&folder, family, &options);
    assert_eq!(sets, [[1, 2, 1], [1, 2, 1]]);
    for set in answer["exceptional"]["sets"].as_array().unwrap() {
        let [a, b, c, d] = ["a", "b", "c", "d"].map(|name| {
            let [re, im] = value(set, name);
            num_complex::Complex64::new(re, im)
        });
        let left = [a * a + c * c - 1.0, a * b + c * d, b * b + d * d - 1.0];
        assert!(left.iter().all(|z| z.norm_sqr() < 1e-20), "{left:?}");
    }
    // The last product is a set that can be asked.
    let products = answer["exceptional"]["products"].as_array().unwrap().len();
    let product = folder.path().join(format!("found/copies_{products}"));
    let member = cognate(&["certify"], &[&product], &["--format", "json"]);
    assert_eq!(member.status.code(), Some(0), "{member:?}");
}

/// Planar four-bars whose crank is locked at the point (p, P) and which move all the same: two circles coincide, so that
/// the crank's end is the other fixed point and coupler and rocker are of one length, the kites; or both lengths are 0
/// and two isotropic lines coincide.
#[test]
fn kites_are_exceptional_among_locked_four_bars() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = r#"{"variables": ["x", "X"], "parameters": ["p", "P", "A", "B"],
        "equations": ["(x - p)*(X - P) - A", "(x - 1)*(X - 1) - B"]}"#;
    let (sets, answer) = exceptional(&folder, family, &["--fibre-dimension", "1"]);
    assert_eq!(sets, [[1, 1, 1]; 3]);
    let is = |set: &Value, parameter: &str, other: [f64; 2]| {
        let parameter_value = value(set, parameter);
        parameter_value
            .iter()
            .zip(other)
            .all(|(x, y)| (x - y).abs() < 1e-9)
    };
    let exceptional_sets = answer["exceptional"]["sets"].as_array().unwrap();
    let kites = exceptional_sets.iter().filter(|set| {
        is(set, "p", [1.0, 0.0]) && is(set, "P", [1.0, 0.0]) && is(set, "A", value(set, "B"))
    });
    let lines = exceptional_sets.iter().filter(|set| {
        let one = is(set, "p", [1.0, 0.0]) != is(set, "P", [1.0, 0.0]);
        one && is(set, "A", [0.0; 2]) && is(set, "B", [0.0; 2])
    });
    assert_eq!((kites.count(), lines.count()), (1, 2));
}

/// Planar four-bars with ground 1, crank a, rocker b and coupler c in which the half tangents of both angles stay in
/// proportion, s = m t (x = t^2): parallelograms (a = b, c = 1 or -1, m = 1) and the same as antiparallelograms,
/// (a - 1) m = a + 1; kites (b = -1, c = a or -a, m = 0); and those with a = 0, two with m = 0, two with b = 0.
#[test]
fn parallelograms_and_kites_are_exceptional_among_four_bars() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = r#"{"variables": ["x"], "parameters": ["a", "b", "c", "m"],
        "definitions": {"B": "(a + b + 1)^2 - c^2", "C": "(a + b - 1)^2 - c^2"},
        "equations": ["((a - b + 1)^2 - c^2)*m^2*x^2 + (B + C*m^2 - 8*a*b*m)*x + (a - b - 1)^2 - c^2"]}"#;
    let (sets, answer) = exceptional(&folder, family, &["--fibre-dimension", "1"]);
    assert_eq!(sets.len(), 10);
    let exceptional_sets = answer["exceptional"]["sets"].as_array().unwrap();
    let mut kinds = [0; 4];
    for (set, numbers) in exceptional_sets.iter().zip(&sets) {
        let [a, b, c, m] = ["a", "b", "c", "m"].map(|name| {
            let [re, im] = value(set, name);
            num_complex::Complex64::new(re, im)
        });
        let zero = |z: num_complex::Complex64| z.norm_sqr() < 1e-18;
        let (kind, degree) = match () {
            () if zero(a) => (3, 1),
            () if zero(m) && zero(b + 1.0) && zero(c * c - a * a) => (2, 1),
            () if zero(a - b) && zero(c * c - 1.0) && zero(m - 1.0) => (0, 1),
            () if zero(a - b) && zero(c * c - 1.0) && zero((a - 1.0) * m - a - 1.0) => (1, 2),
            () => panic!("{set}"),
        };
        assert_eq!(numbers, &[1, degree, 1]);
        kinds[kind] += 1;
    }
    assert_eq!(kinds, [2, 2, 2, 4]);
}

/// Of the 27 lines on the cubic of Fermat those that are not in a plane z = constant.
#[test]
fn eighteen_lines_on_the_cubic_of_fermat_are_exceptional() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = r#"{"variables": ["t"], "parameters": ["a", "b", "c", "d"],
        "equations": ["(a*t + b)^3 + (c*t + d)^3 + t^3 - 1"]}"#;
    let (sets, _) = exceptional(&folder, family, &["--fibre-dimension", "1"]);
    assert_eq!(sets, [[0, 1, 1]; 18]);
}

/// Two linear equations without constants: solutions are lines where the determinant is 0, a plane where all is 0.
#[test]
fn exceptional_sets_lie_in_one_another() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let family = r#"{"variables": ["x", "y"], "parameters": ["a", "b", "c", "d"],
        "equations": ["a*x + b*y", "c*x + d*y"]}"#;
    let (lines, _) = exceptional(&folder, family, &["--fibre-dimension", "1"]);
    assert_eq!(lines, [[3, 2, 1], [0, 1, 2]]);
    let (planes, answer) = exceptional(&folder, family, &["--fibre-dimension", "2"]);
    assert_eq!(planes, [[0, 1, 2]]);
    let set = &answer["exceptional"]["sets"][0];
    assert_eq!(value(set, "a"), [0.0; 2]);
    // No value of a parameter makes a square vanish everywhere.
    let none = r#"{"variables": ["x"], "parameters": ["a"], "equations": ["x^2 - a"]}"#;
    let (none, _) = exceptional(&folder, none, &["--fibre-dimension", "1", "--copies", "2"]);
    assert!(none.is_empty());
}

#[test]
fn what_is_no_family_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = |family: &str, options: &[&str], reason: &str| {
        let file = folder.path().join("family.json");
        std::fs::write(&file, family).expect("the folder is writable");
        let output = cognate(&["exceptional"], &[&file], options);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(reason), "{said}");
    };
    let family = r#"{"variables": ["x"], "parameters": ["a"], "equations": ["a*x"]}"#;
    let one = ["--fibre-dimension", "1"];
    let alone = r#"{"variables": ["x"], "equations": ["x^2 - 1"]}"#;
    refused(alone, &one, "family.json: has no parameters");
    refused(
        family,
        &["--fibre-dimension", "2"],
        "the family has 1 variables",
    );
    refused(
        family,
        &["--fibre-dimension", "1", "--copies", "3"],
        "2 are always enough",
    );
    let quotient = r#"{"variables": ["x"], "parameters": ["a"], "equations": ["x/a - 1"]}"#;
    refused(quotient, &one, "divides by an expression with variables");
    let homogeneous = r#"{"variables": ["x", "y"], "groups": [["x", "y"]], "homogeneous": true,
        "parameters": ["a"], "equations": ["a*x - y"]}"#;
    refused(
        homogeneous,
        &one,
        "homogeneous groups are not in this version",
    );
}
