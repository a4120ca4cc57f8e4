//! Motions of mechanisms with known answers: `tests/motions`. `meta.json` of each instance holds the expected answer,
//! and names the independent programs that found it.

use cognate_kinematics::compile::singular_positions::SingularKind;
use cognate_kinematics::mechanism::configuration::{GivenConfiguration, configurations};
use cognate_kinematics::mechanism::exact::{Angle, Number};
use cognate_kinematics::mechanism::targets::points;
use cognate_kinematics::mechanism::{Mechanism, ReadOptions, Space, read};
use cognate_mechanism_solver::AnswerOptions;
use cognate_mechanism_solver::local::mobility::{Mobility, mobility};
use cognate_mechanism_solver::local::singularity::singularity;
use cognate_mechanism_solver::workspace::workspace;
use num_complex::Complex64;
use serde_json::{Value, json};
use std::path::PathBuf;

fn content(instance: &str, file: &str) -> Vec<u8> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/motions");
    let path = root.join(instance).join(file);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn of_text(text: &Value) -> Mechanism {
    let content = text.to_string().into_bytes();
    read("mechanism.json", &content, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn tree(instance: &str, file: &str) -> Value {
    serde_json::from_slice(&content(instance, file)).expect("JSON")
}

fn given(mechanism: &Mechanism, at: &Value) -> Vec<GivenConfiguration> {
    let content = at.to_string().into_bytes();
    configurations("at.json", &content, mechanism, mechanism.degrees)
        .unwrap_or_else(|e| panic!("{e}"))
}

fn mobilities(mechanism: &Mechanism, at: &Value) -> Vec<Mobility> {
    let each = given(mechanism, at);
    let each = each.iter().map(|given| mobility(mechanism, given, 1));
    each.map(|answer| answer.unwrap_or_else(|e| panic!("{e}")))
        .collect()
}

/// Holds answers against those of the instance: the first lengths, as many as both have.
fn check(instance: &str, answers: &[Mobility]) {
    let expected = &tree(instance, "meta.json")["expected"]["points"];
    let expected = expected.as_array().expect("points");
    assert_eq!(answers.len(), expected.len(), "{instance}");
    for (k, (answer, expected)) in answers.iter().zip(expected).enumerate() {
        let place = format!("{instance} {k}: {answer:?}");
        assert_eq!(
            json!(answer.infinitesimal),
            expected["infinitesimal"],
            "{place}"
        );
        assert_eq!(json!(answer.local), expected["local"], "{place}");
        assert_eq!(
            json!(answer.multiplicity),
            expected["multiplicity"],
            "{place}"
        );
        let lengths = expected["dimensions_by_order"].as_array().expect("lengths");
        let pairs = answer.dimensions_by_order.iter().zip(lengths);
        assert!(pairs.clone().count() >= 4, "{place}");
        for (dimension, expected) in pairs {
            assert_eq!(json!(dimension), *expected, "{place}");
        }
    }
}

const MOBILITIES: [&str; 7] = [
    "change_points",
    "cusp",
    "k33_on_a_circle",
    "shaky_line",
    "shaky_third_order",
    "shaky_two_freedoms",
    "switching_point",
];

#[test]
fn mobility_is_that_of_the_instances() {
    for instance in MOBILITIES {
        let mechanism = of_text(&tree(instance, "mechanism.json"));
        let answers = mobilities(&mechanism, &tree(instance, "at.json"));
        assert!(
            answers
                .iter()
                .all(|answer| answer.is_exact && answer.is_settled())
        );
        check(instance, &answers);
    }
}

/// Checks the singularities of the instance against the expected ones.
fn check_singularities(instance: &str, kind: &str, unit: Option<bool>) {
    let mechanism = of_text(&tree(instance, "mechanism.json"));
    let content = content(instance, "at.json");
    let degrees = unit.unwrap_or(mechanism.degrees);
    let given = configurations("at.json", &content, &mechanism, degrees).expect("configurations");
    let asked = match kind {
        "inputs" => SingularKind::Inputs(mechanism.inputs.clone()),
        _ => SingularKind::Outputs,
    };
    let meta = tree(instance, "meta.json");
    let expected = meta["expected"][kind]["points"].as_array().expect("points");
    assert_eq!(given.len(), expected.len(), "{instance}");
    for (k, (given, expected)) in given.iter().zip(expected).enumerate() {
        let answer = singularity(&mechanism, given, &asked, 1).unwrap_or_else(|e| panic!("{e}"));
        let place = format!("{instance} {kind} {k}: {answer:?}");
        assert_eq!(json!(answer.is_singular), expected["singular"], "{place}");
        for (field, value) in [
            ("everywhere", json!(answer.is_everywhere)),
            ("rank_loss", json!(answer.rank_loss)),
            ("classes", json!(answer.classes)),
        ] {
            assert!(expected.get(field).is_none_or(|e| *e == value), "{place}");
        }
    }
}

#[test]
fn singularities_are_those_of_the_instances() {
    check_singularities("five_bar_singular", "inputs", None);
    check_singularities("five_bar_singular", "outputs", None);
    check_singularities("hexapod", "inputs", None);
    check_singularities("three_rpr", "inputs", None);
    check_singularities("two_four_bars", "inputs", None);
    check_singularities("similar_hexagons", "inputs", None);
    check_singularities("puma", "outputs", Some(false));
    check_singularities("planar_3r", "outputs", None);
    check_singularities("cuspidal_3r", "outputs", Some(false));
    check_singularities("not_cuspidal_3r", "outputs", Some(false));
}

#[test]
fn points_are_reached_as_the_instances_say() {
    check_points(&[
        "planar_3r",
        "planar_2r_limits",
        "delta",
        "five_bar_workspace",
        "three_rpr",
    ]);
}

#[test]
fn arms_of_three_joints_reach_points_as_the_instances_say() {
    check_points(&["cuspidal_3r", "not_cuspidal_3r"]);
}

/// Points of the instances are reached as is expected of them.
fn check_points(instances: &[&str]) {
    for instance in instances {
        let mechanism = of_text(&tree(instance, "mechanism.json"));
        let is_planar = mechanism.space == Space::Planar;
        let places = points("points.json", &content(instance, "points.json"), is_planar);
        let places = places.unwrap_or_else(|e| panic!("{e}"));
        let expected = &tree(instance, "meta.json")["expected"];
        let orientation = expected["orientation"].as_f64().map(Angle::of_radians);
        let options = AnswerOptions::default();
        let answers = workspace(&mechanism, &places, orientation, &options);
        let answers = answers.unwrap_or_else(|e| panic!("{e}"));
        let expected = expected["workspace"]["points"].as_array().expect("points");
        assert_eq!(answers.len(), expected.len(), "{instance}");
        for (k, (answer, expected)) in answers.iter().zip(expected).enumerate() {
            let place = format!("{instance} {k}: {answer:?}");
            // Of instances that count postures within limits, a point is reachable within them.
            let reachable = match expected.get("within_limits") {
                Some(_) => answer.reachable_within_limits,
                None => answer.reachable,
            };
            for (field, value) in [
                ("reachable", json!(reachable)),
                ("postures", json!(answer.postures)),
                ("within_limits", json!(answer.within_limits)),
            ] {
                assert!(expected.get(field).is_none_or(|e| *e == value), "{place}");
            }
        }
    }
}

/// A mechanism with its points turned by the angle of cosine 3/5 and sine 4/5, and made larger.
fn moved(mechanism: &Value, factor: i64) -> Value {
    let mut mechanism = mechanism.clone();
    for joint in mechanism["joints"].as_array_mut().expect("joints") {
        for (field, factor) in [("point", factor), ("direction", 1)] {
            let Some(place) = joint.get(field) else {
                continue;
            };
            let text = |k: usize| match &place[k] {
                Value::String(text) => format!("({text})"),
                number => format!("({number})"),
            };
            let (x, y) = (text(0), text(1));
            joint[field] = json!([
                format!("{factor}*(3*{x}-4*{y})/5"),
                format!("{factor}*(4*{x}+3*{y})/5"),
            ]);
        }
    }
    mechanism
}

/// Configurations with shifts made larger.
fn larger(at: &Value, factor: i64) -> Value {
    let mut at = at.clone();
    for configuration in at.as_array_mut().expect("a list") {
        for (_, value) in configuration["joints"].as_object_mut().expect("joints") {
            if let Value::String(text) = value {
                *value = json!(format!("{factor}*({text})"));
            }
        }
    }
    at
}

#[test]
fn mobility_depends_neither_on_place_nor_on_size() {
    for instance in ["change_points", "cusp", "switching_point"] {
        let (mechanism, at) = (tree(instance, "mechanism.json"), tree(instance, "at.json"));
        for factor in [1, 1000] {
            let moved = of_text(&moved(&mechanism, factor));
            check(instance, &mobilities(&moved, &larger(&at, factor)));
        }
    }
}

/// With doubles in the place of exact numbers the answer is the same where it is one: never another.
#[test]
fn rounded_configurations_have_the_same_mobility_or_none() {
    let rounded = |at: &Value, digits: i32| {
        let mut at = at.clone();
        for configuration in at.as_array_mut().expect("a list") {
            for (_, value) in configuration["joints"].as_object_mut().expect("joints") {
                let Some(pair) = value.as_array() else {
                    continue;
                };
                let number = |v: &Value| match v {
                    Value::String(text) => Number::read(text).expect("a number").to_f64(),
                    number => number.as_f64().expect("a number"),
                };
                let direction = Complex64::new(number(&pair[0]), number(&pair[1]));
                let angle = Angle::of_direction(direction).radians;
                let unit = 10f64.powi(digits);
                *value = json!((angle * unit).round() / unit);
            }
        }
        at
    };
    for instance in ["change_points", "switching_point"] {
        let (mechanism, at) = (tree(instance, "mechanism.json"), tree(instance, "at.json"));
        let mechanism = of_text(&mechanism);
        check(instance, &mobilities(&mechanism, &rounded(&at, 15)));
        let exact = mobilities(&mechanism, &at);
        for (coarse, exact) in mobilities(&mechanism, &rounded(&at, 7)).iter().zip(exact) {
            assert!(
                !coarse.is_settled() || coarse.local == exact.local,
                "{coarse:?}"
            );
        }
    }
}

#[test]
fn what_does_not_close_is_no_configuration() {
    let mechanism = of_text(&tree("change_points", "mechanism.json"));
    let open = json!({"joints": {"A0": 0.1, "A": 0, "B": 0, "B0": 0}});
    let turned = json!({"joints": {"A0": [-1, 0], "A": 0, "B": 0, "B0": 0}});
    for at in [open, turned] {
        let answer = mobility(&mechanism, &given(&mechanism, &at)[0], 1);
        assert!(answer.is_err_and(|e| e.contains("does not close")));
    }
    let content = json!({"joints": {"A0": 0}}).to_string();
    let error = configurations("at.json", content.as_bytes(), &mechanism, false)
        .expect_err("joints are missing");
    assert!(error.to_string().contains("\"A\" is missing"), "{error}");
}

/// A parallelogram in space moves with one freedom although counting says -2.
#[test]
fn overconstrained_loops_have_their_freedom() {
    let arm = json!({"space": "spatial", "links": ["g", "a", "b", "c"], "joints": [
        {"name": "A", "type": "R", "links": ["g", "a"], "point": [0, 0, 0], "axis": [0, 0, 1]},
        {"name": "B", "type": "R", "links": ["a", "b"], "point": [1, 0, 0], "axis": [0, 0, 1]},
        {"name": "C", "type": "R", "links": ["b", "c"], "point": [1, 1, 0], "axis": [0, 0, 1]},
        {"name": "D", "type": "R", "links": ["c", "g"], "point": [0, 1, 0], "axis": [0, 0, 1]}]});
    let linkage = of_text(&arm);
    let answer = mobility(&linkage, &GivenConfiguration::Home, 1).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        (answer.infinitesimal, answer.local),
        (Some(1), Some(1)),
        "{answer:?}"
    );
    assert!(answer.is_exact && answer.dimensions_by_order.starts_with(&[1, 2, 3, 4, 5]));
}

/// A body on a turn and on a ball on its axis turns: the ground is no part of a strut that spins.
#[test]
fn a_ball_on_the_axis_of_a_turn_leaves_it_free() {
    let door = json!({"links": ["ground", "door"], "joints": [
        {"name": "R", "type": "R", "links": ["ground", "door"], "point": [0, 0, 0], "axis": [0, 0, 1]},
        {"name": "S", "type": "S", "links": ["ground", "door"], "point": [0, 0, 3]}]});
    let door = of_text(&door);
    assert_eq!(door.graph().idle, 0);
    let answer = mobility(&door, &GivenConfiguration::Home, 1).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(answer.local, Some(1), "{answer:?}");
}
