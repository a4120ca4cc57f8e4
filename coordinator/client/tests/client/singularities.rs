//! `cognate mechanism singularities` without `--at` as a process: loci with answers known by hand.
//!
//! A four-bar is singular for its input where the two other links lie on one line: the cosine rule gives two positions for
//! each of straight and folded. Of a six-bar the closed form is that of its four-bar, and of the dyad on it.

use crate::program::{cognate, text};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The conic of the platform at 20 degrees: coefficients of x^2, x y, y^2, x, y and 1, from six values of the determinant of the
/// legs' lines.
const CONIC: [f64; 6] = [
    -0.35250006764630337,
    -0.09091957579341127,
    -0.17763331237331356,
    1.0,
    0.30298768501097145,
    -0.4053673735941024,
];
/// Values of inputs agree within this.
const ANGLE: f64 = 1e-9;

fn instance(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/motions");
    root.join(name).join("mechanism.json")
}

/// The answer to a question about a mechanism's file; settled, or the test fails.
fn answer(file: &Path, options: &[&str]) -> Value {
    let file = file.display().to_string();
    let words = [
        &["mechanism", "singularities", &file][..],
        options,
        &["--format", "json"],
    ];
    let output = cognate(&words.concat());
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{file}: {said}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{file}: {e}: {said}"))
}

fn written(folder: &TempDir, content: &Value) -> PathBuf {
    let file = folder.path().join("mechanism.json");
    std::fs::write(&file, content.to_string()).expect("the folder is writable");
    file
}

/// Holds the numbers of an answer against those that are known: dimension, complex and real positions.
fn check_isolated(answer: &Value, [dimension, complex, real]: [i64; 3]) {
    assert_eq!(answer["dimension"], dimension, "{answer:#}");
    let isolated = json!({"complex": complex, "real": real});
    assert_eq!(answer["isolated"], isolated, "{answer:#}");
    assert_eq!(answer["settled"], true, "{answer:#}");
}

/// Dimension and degree of each component.
fn components(answer: &Value) -> Vec<[u64; 2]> {
    let list = answer["components"].as_array().expect("components").iter();
    let number = |c: &Value, field: &str| c[field].as_u64().expect("a number");
    list.map(|c| [number(c, "dimension"), number(c, "degree")])
        .collect()
}

/// Values of one input at the real positions, in order.
fn real_inputs(answer: &Value, name: &str) -> Vec<f64> {
    let solutions = answer["solutions"].as_array().expect("solutions").iter();
    let values = solutions.filter_map(|solution| solution["inputs"][name].as_f64());
    values.collect()
}

fn check_values(given: &[f64], expected: &[f64]) {
    assert_eq!(given.len(), expected.len(), "{given:?}");
    for (x, y) in given.iter().zip(expected) {
        assert!((x - y).abs() < ANGLE, "{given:?}, expected {expected:?}");
    }
}

#[test]
fn dead_centres_of_a_four_bar_are_where_the_other_links_are_on_one_line() {
    let file = instance("dead_centres");
    let inputs = answer(&file, &["--inputs"]);
    check_isolated(&inputs, [0, 4, 4]);
    let meta = std::fs::read(file.with_file_name("meta.json")).expect("the instance is there");
    let meta: Value = serde_json::from_slice(&meta).expect("JSON");
    let expected = meta["expected"]["real_inputs"]["B0"].as_array();
    let expected = expected.expect("values").iter().filter_map(Value::as_f64);
    check_values(&real_inputs(&inputs, "B0"), &expected.collect::<Vec<f64>>());
    let joints = inputs["solutions"][0]["joints"]
        .as_object()
        .expect("joints");
    assert_eq!(joints.len(), 4, "{inputs:#}");
}

#[test]
fn a_slider_crank_driven_by_its_slider_stands_dead_where_crank_and_rod_are_on_the_line_of_the_slider()
 {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = written(
        &folder,
        &json!({
            "name": "slider-crank", "space": "planar", "links": ["ground", "crank", "rod", "slider"],
            "joints": [
                {"name": "A0", "type": "R", "links": ["ground", "crank"], "point": [0, 0]},
                {"name": "A", "type": "R", "links": ["crank", "rod"], "point": [0, 3]},
                {"name": "B", "type": "R", "links": ["rod", "slider"], "point": [4, 0]},
                {"name": "S", "type": "P", "links": ["ground", "slider"], "point": [4, 0], "direction": [1, 0]},
            ],
            "inputs": ["S"], "output": "crank",
        }),
    );
    let inputs = answer(&file, &["--inputs"]);
    check_isolated(&inputs, [0, 4, 4]);
    // The joint S counts from 4, and the pin is at -8, -2, 2 and 8.
    check_values(&real_inputs(&inputs, "S"), &[-12.0, -6.0, -2.0, 4.0]);
    // Driven by its crank it would stand dead where the rod is at right angles to the line, for which it is too long.
    check_isolated(&answer(&file, &["--inputs", "--input", "A0"]), [0, 4, 0]);
}

#[test]
fn where_modes_meet_a_linkage_is_singular_and_points_count_once() {
    let parallelogram = instance("antiparallelogram");
    check_isolated(&answer(&parallelogram, &["--inputs"]), [0, 2, 2]);
    check_isolated(&answer(&instance("kite"), &["--inputs"]), [0, 2, 2]);
}

#[test]
fn a_mode_that_an_input_does_not_move_is_singular_as_a_whole() {
    // Where crank and coupler of the kite coincide they turn, and the rocker stands.
    let rocker = answer(&instance("kite"), &["--inputs", "--input", "B0"]);
    check_isolated(&rocker, [1, 2, 2]);
    assert_eq!(components(&rocker), [[1, 2]], "{rocker:#}");
    assert_eq!(rocker["components"][0]["whole_mode"], true, "{rocker:#}");
}

#[test]
fn five_bars_are_singular_on_curves_of_four_bars() {
    let file = instance("five_bar_singular");
    // Rods in line, straight or folded: two links less one; an arm straight or folded: the same for each arm.
    let inputs = answer(&file, &["--inputs"]);
    check_isolated(&inputs, [1, 0, 0]);
    assert_eq!(components(&inputs), [[1, 6]; 2], "{inputs:#}");
    let outputs = answer(&file, &["--outputs"]);
    check_isolated(&outputs, [1, 0, 0]);
    assert_eq!(components(&outputs), [[1, 6]; 4], "{outputs:#}");
}

#[test]
fn a_chain_of_three_links_is_singular_where_it_lies_on_a_line() {
    let outputs = answer(&instance("planar_3r"), &["--outputs"]);
    check_isolated(&outputs, [1, 0, 0]);
    assert_eq!(components(&outputs), [[1, 2]; 4], "{outputs:#}");
    // All joints are driven: nothing is left to move.
    check_isolated(&answer(&instance("planar_3r"), &["--inputs"]), [-1, 0, 0]);
}

#[test]
fn a_six_bar_is_singular_with_its_four_bar_or_with_its_dyad() {
    // Four dead centres of the four-bar with two places of the dyad each, and two circles around the lever's pivot that
    // the coupler curve, of degree 6 and three times through the circular points, meets in 6 points each.
    let file = instance("stephenson_three");
    let inputs = answer(&file, &["--inputs"]);
    // The two real ones are the ends of the interval of one circuit, on which the dyad reaches.
    check_isolated(&inputs, [0, 20, 2]);
    // The motion is a curve of genus 7 (a double cover of one of genus 1, with 12 branch points), on which the lever has each
    // place 6 times: 2 * 7 - 2 + 2 * 6 branch points (Riemann and Hurwitz).
    let lever = answer(&file, &["--inputs", "--input", "D0"]);
    assert_eq!(lever["isolated"]["complex"], 24, "{lever:#}");
}

#[test]
fn a_six_bar_with_a_dyad_between_two_moving_links_has_sixteen_dead_centres() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let joint = |name: &str, links: [&str; 2], point: [f64; 2]| json!({"name": name, "type": "R", "links": links, "point": point});
    let watt = json!({
        "name": "Watt I", "space": "planar",
        "links": ["ground", "crank", "coupler", "rocker", "front", "back"],
        "joints": [
            joint("A0", ["ground", "crank"], [0.0, 0.0]),
            joint("A", ["crank", "coupler"], [-1.0, 1.5]),
            joint("B", ["coupler", "rocker"], [2.0, 3.0]),
            joint("B0", ["ground", "rocker"], [3.0, 0.0]),
            joint("C", ["coupler", "front"], [1.0, 4.0]),
            joint("E", ["front", "back"], [2.5, 3.5]),
            joint("D", ["back", "rocker"], [4.0, 2.5]),
        ],
        "inputs": ["A0"], "output": "front",
    });
    // Of the four-bar 4 with two places of the dyad each. The dyad is straight or folded where the angle of coupler and
    // rocker has one of two values each, in which the four-bar assembles twice.
    let inputs = answer(&written(&folder, &watt), &["--inputs"]);
    assert_eq!(inputs["isolated"]["complex"], 16, "{inputs:#}");
}

#[test]
fn where_loops_lose_rank_an_output_is_in_doubt() {
    let content = std::fs::read(instance("antiparallelogram")).expect("the instance is there");
    let mut rocker: Value = serde_json::from_slice(&content).expect("JSON");
    rocker["output"] = json!("rocker");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = written(&folder, &rocker).display().to_string();
    let words = ["mechanism", "singularities", &file, "--outputs"];
    let output = cognate(&[&words[..], &["--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(answer["settled"], false, "{answer:#}");
}

/// The determinant of a Scotch yoke driven by its crank is a number.
#[test]
fn a_scotch_yoke_has_no_dead_centres() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = written(
        &folder,
        &json!({
            "name": "Scotch yoke", "space": "planar", "links": ["ground", "crank", "block", "yoke"],
            "joints": [
                {"name": "A0", "type": "R", "links": ["ground", "crank"], "point": [0, 0]},
                {"name": "A", "type": "R", "links": ["crank", "block"], "point": [0.6, 0.8]},
                {"name": "V", "type": "P", "links": ["block", "yoke"], "direction": [0, 1]},
                {"name": "H", "type": "P", "links": ["yoke", "ground"], "direction": [1, 0]},
            ],
            "inputs": ["A0"],
        }),
    );
    check_isolated(&answer(&file, &["--inputs"]), [-1, 0, 0]);
}

/// Of similar triangles at home the lines of the legs pass through one point, wherever the platform is.
#[test]
fn a_platform_of_similar_triangles_is_singular_in_every_position_of_one_orientation() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let leg = |name: &str, from: &str, to: &str| json!({"name": name, "type": "RPR", "from": from, "to": to});
    let file = written(
        &folder,
        &json!({"name": "similar", "space": "planar", "platform": {
            "base": {"A": [0, 0], "B": [2, 0], "C": [1, 2]},
            "moving": {"a": [0, 0], "b": [1, 0], "c": [0.5, 1]},
            "legs": [leg("L1", "A", "a"), leg("L2", "B", "b"), leg("L3", "C", "c")],
        }}),
    );
    let locus = answer(&file, &["--inputs", "--orientation", "0"]);
    assert_eq!(components(&locus), [[2, 1]], "{locus:#}");
    assert_eq!(locus["components"][0]["whole_mode"], true, "{locus:#}");
}

#[test]
fn a_platform_of_held_orientation_is_singular_on_a_conic() {
    let file = instance("three_rpr");
    let locus = answer(&file, &["--inputs", "--orientation", "0.3490658503988659"]);
    check_isolated(&locus, [1, 0, 0]);
    assert_eq!(components(&locus), [[1, 2]], "{locus:#}");
    let samples = locus["curves"][0]["samples"].as_array().expect("samples");
    assert!(samples.len() >= 20, "{locus:#}");
    for sample in samples {
        let [x, y] = [0, 1].map(|i| sample[i].as_f64().expect("a number"));
        let monomials = [x * x, x * y, y * y, x, y, 1.0];
        let terms = || CONIC.iter().zip(monomials).map(|(a, m)| a * m);
        let size: f64 = terms().map(f64::abs).sum();
        assert!(terms().sum::<f64>().abs() < 1e-9 * size, "{sample}");
    }
    let surface = answer(&file, &["--inputs"]);
    assert_eq!(surface["dimension"], 2, "{surface:#}");
}

#[test]
fn loci_that_are_not_answered_are_refused_with_what_to_type() {
    let file = |name: &str| instance(name).display().to_string();
    let [five_bar, kite, puma, platform] =
        ["five_bar_singular", "kite", "puma", "three_rpr"].map(file);
    for (words, said) in [
        (vec![&*five_bar, "--inputs", "--input", "A0"], "--input"),
        (
            vec![&*kite, "--inputs", "--input", "A0", "--input", "B0"],
            "too many",
        ),
        (
            vec![&*kite, "--inputs", "--orientation", "0.3"],
            "leave it out",
        ),
        (vec![&*puma, "--outputs"], "--at FILE"),
        (vec![&*platform, "--outputs"], "--inputs"),
        (
            vec![&*platform, "--inputs", "--orientation", "much"],
            "an angle",
        ),
    ] {
        let words = [&["mechanism", "singularities"][..], &words].concat();
        let output = cognate(&words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        let error = text(&output.stderr);
        assert!(error.contains(said), "{words:?}: {error}");
    }
}

/// Arms of three joints: the known answers of `tests/motions`, and an arm for which nothing is decided.
#[test]
fn cusps_of_arms_of_three_joints_are_those_of_the_instances() {
    for (name, cusps, cuspidal) in [("cuspidal_3r", 4, true), ("not_cuspidal_3r", 0, false)] {
        let answer = answer(&instance(name), &["--outputs"]);
        assert_eq!(answer["dimension"], 2, "{answer:#}");
        assert_eq!(answer["cusps"], cusps, "{answer:#}");
        assert_eq!(answer["cuspidal"], cuspidal, "{answer:#}");
        assert_eq!(answer["cusp_places"].as_array().map(Vec::len), Some(cusps));
    }
}

/// Three axes through one point: all positions are singular, which leaves the question of cusps without an answer.
#[test]
fn an_arm_without_critical_values_has_no_verdict() {
    let folder = TempDir::new().expect("a folder");
    let turn =
        |name: &str, twist: i64| json!({"name": name, "type": "R", "a": 0, "alpha": twist, "d": 0});
    let joints = [turn("q1", -90), turn("q2", 90), turn("q3", 0)];
    let file = written(
        &folder,
        &json!({"space": "spatial", "angles": "deg", "serial": {"convention": "standard", "joints": joints},
            "output": {"link": "link3", "point": [0, 0, 1]}}),
    );
    let file = file.display().to_string();
    let output = cognate(&[
        "mechanism",
        "singularities",
        &file,
        "--outputs",
        "--format",
        "json",
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(
        (&answer["dimension"], &answer["cuspidal"]),
        (&json!(3), &Value::Null)
    );
    assert_eq!(answer["settled"], false);
}
