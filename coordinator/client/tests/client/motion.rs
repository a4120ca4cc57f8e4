//! `cognate mechanism motion` as a process, with known answers: `tests/motions`. `meta.json` of each instance holds the
//! expected answer, and names the independent programs that found it.

use crate::program::{cognate, text};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn folder(instance: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests");
    let motions = root.join("motions").join(instance);
    match motions.exists() {
        true => motions,
        false => root.join("mechanisms").join(instance),
    }
}

fn tree(path: &Path) -> Value {
    let content = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&content).expect("JSON")
}

/// Contents of `meta.json` of an instance.
pub fn expected(instance: &str) -> Value {
    tree(&folder(instance).join("meta.json"))
}

/// The answer of a command about an instance, and its exit code.
pub fn answer(instance: &str, command: &str) -> (Value, Option<i32>) {
    let folder = folder(instance);
    let path = |word: &str| match folder.join(word) {
        file if file.is_file() => file.display().to_string(),
        _ => word.to_owned(),
    };
    let words = command.split_whitespace().skip(1);
    let mut words: Vec<String> = words.map(path).collect();
    words.extend(["--format", "json"].map(String::from));
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let output = cognate(&words);
    let said = text(&output.stderr);
    let value = serde_json::from_slice(&output.stdout);
    let value = value.unwrap_or_else(|e| panic!("{instance}: {e}: {said}"));
    (value, output.status.code())
}

/// Given fields of components, as a sorted list of texts.
fn sorted(components: &Value, fields: &[String]) -> Vec<String> {
    let list = components.as_array().expect("components").iter();
    let claimed = |c: &Value| {
        let values: Vec<&Value> = fields.iter().map(|field| &c[field]).collect();
        json!(values).to_string()
    };
    let mut texts: Vec<String> = list.map(claimed).collect();
    texts.sort();
    texts
}

/// Common real positions of pairs of modes.
fn real_meetings(answer: &Value, wanted: impl Fn(&str, &str) -> bool) -> usize {
    let pairs = answer["meets"].as_array().expect("pairs").iter();
    let pairs = pairs.filter(|pair| {
        let id = |k: usize| pair[k].as_str().expect("a mode");
        wanted(id(0), id(1))
    });
    let points = pairs.flat_map(|pair| pair[2].as_array().into_iter().flatten());
    points.filter(|point| point["real"] == true).count()
}

/// Compares an answer with the expected one of the instance.
fn check(instance: &str) {
    let meta = expected(instance);
    let (answer, code) = answer(instance, meta["command"].as_str().expect("a command"));
    assert_eq!(code, Some(0), "{instance}: {answer:#}");
    let dimension = |id: &str| id.split('.').next().map(str::to_owned);
    for (field, expected) in meta["expected"].as_object().expect("fields") {
        let place = format!("{instance}, {field}: {answer:#}");
        match field.as_str() {
            "components" if expected.as_array().is_some_and(|c| !c.is_empty()) => {
                let first = expected[0].as_object().expect("claims");
                let fields: Vec<String> = first.keys().cloned().collect();
                let (expected, given) = (expected, &answer["components"]);
                assert_eq!(sorted(given, &fields), sorted(expected, &fields), "{place}");
            }
            "isolated" => {
                for (kind, number) in expected.as_object().expect("numbers") {
                    assert_eq!(answer["isolated"][kind], *number, "{place}");
                }
            }
            "meets_real_points" => {
                let real_points = real_meetings(&answer, |_, _| true);
                assert_eq!(json!(real_points), *expected, "{place}");
            }
            "meets_real_points_of_different_dimension" => {
                let real_points = real_meetings(&answer, |a, b| dimension(a) != dimension(b));
                assert_eq!(json!(real_points), *expected, "{place}");
            }
            "genus" | "other_paths" => {}
            _ => assert_eq!(answer[field], *expected, "{place}"),
        }
    }
}

#[test]
fn planar_linkages_fall_into_their_modes() {
    for instance in [
        "antiparallelogram",
        "kite",
        "four_bar_crank_rocker",
        "four_bar_triple_rocker",
        "parallelogram_of_roots",
        "five_bar",
        "three_equal_cranks",
        "seven_bar_roberts",
    ] {
        check(instance);
    }
}

#[test]
fn a_slider_on_two_dyads_changes_its_freedoms() {
    check("slider_two_dyads");
}

/// Holds degrees of paths of other points against those that are expected of the instance.
fn check_other_paths(instance: &str) {
    let meta = expected(instance);
    for other in meta["expected"]["other_paths"].as_array().expect("paths") {
        let path = other["path"].as_str().expect("a point");
        let file = folder(instance).join("mechanism.json");
        let file = file.display().to_string();
        let words = [
            "mechanism",
            "motion",
            &file,
            "--path",
            path,
            "--format",
            "json",
        ];
        let output = cognate(&words);
        let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let degree = &answer["components"][0]["path_degree"];
        assert_eq!(*degree, other["path_degree"], "{answer:#}");
    }
}

#[test]
fn a_six_bar_has_three_circuits_and_paths_of_two_degrees() {
    check("stephenson_three");
    check_other_paths("stephenson_three");
}

#[test]
fn a_six_bar_of_watt_has_four_circuits_and_paths_of_three_degrees() {
    check("watt");
    check_other_paths("watt");
}

/// Circuits of loops of six joints are followed in the unknowns of four, which determine the others.
#[test]
fn a_loop_of_six_joints_has_the_circuits_of_four() {
    check("sarrus");
}

/// By hand: both dyads have the same two lengths and their feet above each other, so that each is a double cover of the heights
/// with the same four branch points, lengths added or subtracted. Elbows alike or not are two modes. Each has a loop over
/// either interval of heights, and at the four branch points the modes meet.
#[test]
fn equal_dyads_of_a_sarrus_linkage_move_in_two_modes_on_two_circuits() {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/mechanisms/sarrus/mechanism.json");
    let file = file.display().to_string();
    let output = cognate(&["mechanism", "motion", &file, "--real", "--format", "json"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let modes = answer["components"].as_array().expect("components").iter();
    let circuits: Vec<&Value> = modes.map(|mode| &mode["circuits"]).collect();
    assert_eq!(circuits, [2, 2], "{answer:#}");
    assert_eq!(real_meetings(&answer, |_, _| true), 4, "{answer:#}");
    assert_eq!(answer["circuits"], 2, "{answer:#}");
}

#[test]
fn a_platform_on_legs_that_moves_is_one_curve_of_degree_28() {
    check("griffis_duffy_one");
}

#[test]
fn a_platform_of_congruent_triangles_moves_in_five_modes() {
    check("griffis_duffy_two");
}

#[test]
fn loops_in_space_move_by_their_dimensions_or_do_not_close() {
    for instance in [
        "bennett",
        "double_spherical",
        "general_four_r",
        "goldberg_five_r",
        "open_plane_and_sphere",
    ] {
        check(instance);
    }
}

#[test]
fn spherical_four_bars_have_one_mode_and_isograms_two() {
    check("spherical_four_bar");
    check("spherical_isogram");
}

#[test]
fn a_framework_of_square_roots_moves() {
    check("dixon_k33");
}

#[test]
fn open_numbers_are_swept() {
    let meta = tree(&folder("four_bar_sweep").join("meta.json"));
    let expected = &meta["expected"];
    let (answer, code) = answer("four_bar_sweep", meta["command"].as_str().expect("text"));
    assert_eq!(code, Some(0), "{answer:#}");
    assert_eq!(answer["free"], expected["free"]);
    let fields = ["dimension", "degree"].map(String::from);
    let swept = answer["values"].as_array().expect("a list");
    let wanted = expected["values"].as_array().expect("a list");
    assert_eq!(swept.len(), wanted.len());
    for (swept, wanted) in swept.iter().zip(wanted) {
        let [swept, wanted] = [swept, wanted].map(|each| sorted(&each["components"], &fields));
        assert_eq!(swept, wanted, "{answer:#}");
    }
}

/// Five-bars by their lengths: connected, and on two circuits (Kapovich and Millson 1995).
#[test]
fn circuits_of_five_bars_follow_from_their_lengths() {
    for (lengths, circuits) in [([4, 4, 4, 4, 5], 1), ([8, 8, 8, 2, 3], 2)] {
        let points = ["A", "B", "C", "D", "E"];
        let bar =
            |k: usize| json!({"between": [points[k], points[(k + 1) % 5]], "length": lengths[k]});
        let bars: Vec<Value> = (0..5).map(bar).collect();
        let content = json!({"space": "planar", "framework": {"points": points, "bars": bars, "fixed": ["A", "B"]}});
        let temporary = tempfile::tempdir().expect("a temporary folder");
        let file = temporary.path().join("five_bars.json");
        std::fs::write(&file, content.to_string()).expect("there is room");
        let file = file.to_str().expect("a name");
        let run = cognate(&["mechanism", "motion", file, "--real", "--format", "json"]);
        assert_eq!(run.status.code(), Some(0), "{run:?}");
        let answer: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        assert_eq!(answer["circuits"], circuits, "{answer:#}");
    }
}

/// A body on two balls turns about their line: that is no freedom by the rules, and said.
#[test]
fn a_body_on_two_balls_has_an_idle_spin() {
    let ball = |name: &str, point: [i64; 3]| json!({"name": name, "type": "S", "links": ["ground", "body"], "point": point});
    let content = json!({"links": ["ground", "body"], "joints": [ball("S1", [0, 0, 0]), ball("S2", [1, 2, 2])]});
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let file = temporary.path().join("two_balls.json");
    std::fs::write(&file, content.to_string()).expect("the folder is writable");
    let file = file.display().to_string();
    let refused = cognate(&["mechanism", "motion", &file]);
    assert_eq!(refused.status.code(), Some(2));
    let said = text(&refused.stderr);
    assert!(said.contains("1 idle spin"), "{said}");
    let info = cognate(&["mechanism", "info", &file]);
    let said = text(&info.stdout);
    assert!(!said.contains("cannot close"), "{said}");
    let words = ["mechanism", "mobility", &file, "--at", "home"];
    let table = cognate(&words);
    assert!(text(&table.stdout).contains("idle: 1 "));
    let output = cognate(&[&words[..], &["--format", "json"]].concat());
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&answer["local"], &answer["idle"]), (&json!(0), &json!(1)));
}

#[test]
fn what_cannot_be_asked_is_refused_with_what_to_type() {
    let kite = folder("kite").join("mechanism.json").display().to_string();
    let open = folder("four_bar_sweep").join("mechanism.json");
    let open = open.display().to_string();
    let arm = folder("arm_generic").join("arm.json").display().to_string();
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let values = temporary.path().join("values.json");
    std::fs::write(&values, r#"[{"b": 3, "d": 2}]"#).expect("the folder is writable");
    let values = values.display().to_string();
    for (words, said) in [
        (
            vec![&*kite, "--path", "lever 1 2"],
            "crank, coupler, rocker",
        ),
        (vec![&*kite, "--path", "crank"], "LINK x y [z]"),
        (vec![&*kite, "--sweep", &values], "write \"?\" in its place"),
        (
            vec![&*open, "--sweep", &values],
            "no number d is open; there are b, c",
        ),
        (vec![&*kite, "--lock", "A0=1"], "--lock"),
        (vec![&*arm], "write it as \"loop\""),
    ] {
        let words = [&["mechanism", "motion"][..], &words].concat();
        let output = cognate(&words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        let error = text(&output.stderr);
        assert!(error.contains(said), "{words:?}: {error}");
    }
}

/// Velocities of a leg of length 0 have no direction: the configuration was once called regular.
#[test]
fn a_leg_of_length_0_is_in_doubt() {
    let folder = tempfile::tempdir().expect("a folder");
    let [platform, at] = ["platform.json", "at.json"].map(|name| folder.path().join(name));
    let legs = ["A", "B", "C"]
        .map(|name| json!({"name": name, "type": "RPR", "from": name, "to": name.to_lowercase()}));
    let file = json!({"name": "three_rpr", "space": "planar", "platform": {
        "base": {"A": [0, 0], "B": [2, 0], "C": [1, 2]},
        "moving": {"a": [0, 0], "b": [1, 0], "c": [0.4, 0.8]},
        "legs": legs,
    }});
    std::fs::write(&platform, file.to_string()).expect("a file");
    let pose = json!({"pose": {"position": [0, 0], "angle": 0}});
    std::fs::write(&at, pose.to_string()).expect("a file");
    let [platform, at] = [platform, at].map(|path| path.display().to_string());
    let output = cognate(&[
        "mechanism",
        "singularities",
        &platform,
        "--inputs",
        "--at",
        &at,
        "--format",
        "json",
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(answer["points"][0]["singular"], Value::Null, "{answer:#}");
}
