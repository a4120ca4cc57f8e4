//! Numbers of a file that take a freedom away when they are changed alone: answers that follow from known facts about a
//! linkage, the source beside each.

use cognate_kinematics::mechanism::configuration::{GivenConfiguration, configurations};
use cognate_kinematics::mechanism::{Mechanism, ReadOptions, read};
use cognate_mechanism_solver::local::mobility::mobility;
use cognate_mechanism_solver::local::number_effects::{NumberEffect, number_effects};
use serde_json::{Value, json};
use std::path::PathBuf;

fn instance(name: &str) -> Value {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/motions");
    let path = root.join(name).join("mechanism.json");
    let content = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&content).expect("JSON")
}

fn mechanism(tree: &Value) -> Mechanism {
    let content = tree.to_string().into_bytes();
    read("mechanism.json", &content, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Effects at a configuration, `null` being home, for a mechanism with `freedoms` freedoms.
fn effects(tree: &Value, at: &Value, freedoms: Option<usize>) -> Vec<NumberEffect> {
    let mechanism = mechanism(tree);
    let given = match at {
        Value::Null => GivenConfiguration::Home,
        at => {
            let content = at.to_string().into_bytes();
            let given = configurations("at.json", &content, &mechanism, mechanism.degrees);
            given.unwrap_or_else(|e| panic!("{e}"))[0].clone()
        }
    };
    let local = mobility(&mechanism, &given, 1).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(local.local, freedoms, "{local:?}");
    number_effects(&mechanism, &given, &local, 1).unwrap_or_else(|e| panic!("{e}"))
}

fn names(effects: &[NumberEffect], keeps: Option<bool>) -> Vec<&str> {
    let chosen = effects.iter().filter(|effect| effect.keeps == keeps);
    chosen.map(|effect| effect.number.name.as_str()).collect()
}

/// All numbers have this effect.
fn check_all(effects: &[NumberEffect], keeps: bool, assembles: bool) {
    assert!(!effects.is_empty());
    for effect in effects {
        assert_eq!(effect.keeps, Some(keeps), "{effect:?}");
        assert_eq!(effect.assembles, Some(assembles), "{effect:?}");
    }
}

fn bennett_at() -> Value {
    json!({"joints": {"q1": [0, 1], "q2": ["-24/25", "7/25"], "q3": [0, -1], "q4": ["-24/25", "-7/25"]}})
}

/// Bennett 1903: opposite sides and twists equal, sin(alpha)/a = sin(beta)/b, no offsets; other loops of four do not move, and in
/// general cannot be assembled (Delassus 1922: there are no others without parallel axes).
#[test]
fn every_number_of_a_bennett_linkage_takes_its_freedom() {
    let number_effects = effects(&instance("bennett"), &bennett_at(), Some(1));
    assert_eq!(number_effects.len(), 12);
    check_all(&number_effects, false, false);
}

/// Both kinds of rows say the same linkage: in the modified convention length and twist stand one row later.
#[test]
fn modified_rows_have_the_effects_of_standard_ones() {
    let mut tree = instance("bennett");
    tree["loop"]["convention"] = json!("modified");
    let rows = tree["loop"]["joints"].as_array_mut().expect("rows");
    let normals: Vec<[Value; 2]> = rows
        .iter()
        .map(|r| [r["a"].clone(), r["alpha"].clone()])
        .collect();
    for (k, row) in rows.iter_mut().enumerate() {
        let [a, alpha] = normals[(k + 3) % 4].clone();
        (row["a"], row["alpha"]) = (a, alpha);
    }
    // The normal before the first joint stands in the base now: the joint values are the same.
    let number_effects = effects(&tree, &bennett_at(), Some(1));
    assert_eq!(
        (number_effects.len(), number_effects[1].number.name.as_str()),
        (12, "q1.a")
    );
    check_all(&number_effects, false, false);
}

/// A four-bar of the plane moves whatever its lengths are.
#[test]
fn no_number_of_a_planar_four_bar_takes_its_freedom() {
    let number_effects = effects(&instance("four_bar_crank_rocker"), &Value::Null, Some(1));
    assert_eq!(number_effects.len(), 8);
    check_all(&number_effects, true, true);
}

/// A spatial four-bar with four parallel axes: points may move, axes may not (a loop of four turns moves only if all
/// axes are parallel, if all meet in a point, or if it is Bennett's; Delassus 1922).
#[test]
fn an_axis_that_tilts_takes_the_freedom_of_a_four_bar_in_space() {
    let joint = |name: &str, links: [&str; 2], point: [i32; 3]| json!({"name": name, "type": "R", "links": links, "point": point, "axis": [0, 0, 1]});
    let tree = json!({"space": "spatial", "links": ["g", "a", "b", "c"], "joints": [
        joint("A", ["g", "a"], [0, 0, 0]), joint("B", ["a", "b"], [1, 2, 0]),
        joint("C", ["b", "c"], [4, 3, 0]), joint("D", ["c", "g"], [5, 0, 0])]});
    let number_effects = effects(&tree, &Value::Null, Some(1));
    assert_eq!(number_effects.len(), 24);
    let tilts = |name: &&str| name.ends_with("axis.0") || name.ends_with("axis.1");
    let fewer = names(&number_effects, Some(false));
    assert_eq!(fewer.len(), 8, "{fewer:?}");
    assert!(fewer.iter().all(tilts), "{fewer:?}");
    assert_eq!(names(&number_effects, Some(true)).len(), 16);
    // At home it closes whatever the axes are.
    assert!(
        number_effects
            .iter()
            .all(|effect| effect.assembles == Some(true))
    );
}

/// Three equal parallel cranks: a platform on three cranks of other lengths is rigid.
#[test]
fn every_number_of_three_equal_cranks_takes_their_freedom() {
    let number_effects = effects(&instance("three_equal_cranks"), &Value::Null, Some(1));
    assert_eq!(number_effects.len(), 12);
    check_all(&number_effects, false, true);
}

/// Links of three equal cranks in their own coordinates: here one length changes by itself, and the rest is rigid
/// elsewhere.
#[test]
fn the_length_of_a_third_crank_takes_the_freedom() {
    let joint = |name: &str, first: &str, at: [i32; 2], second: &str, to: [&str; 2]| json!({"name": name, "type": "R", "links": [first, second], "in": {first: {"point": at}, second: {"point": to}}});
    let zero = ["0", "0"];
    let tree = json!({"space": "planar", "links": ["g", "c1", "c2", "c3", "p"], "joints": [
        joint("A1", "g", [0, 0], "c1", zero), joint("A2", "g", [2, 0], "c2", zero), joint("A3", "g", [3, 1], "c3", zero),
        joint("B1", "c1", [1, 0], "p", zero), joint("B2", "c2", [1, 0], "p", ["2", "0"]), joint("B3", "c3", [1, 0], "p", ["3", "1"])]});
    let back = json!(["3/5", "-4/5"]);
    let turn = json!(["3/5", "4/5"]);
    let at =
        json!({"joints": {"A1": turn, "A2": turn, "A3": turn, "B1": back, "B2": back, "B3": back}});
    let number_effects = effects(&tree, &at, Some(1));
    assert_eq!(number_effects.len(), 24);
    assert!(names(&number_effects, Some(false)).contains(&"B3.in.c3.point.0"));
    for effect in &number_effects {
        assert_eq!(effect.keeps, Some(false), "{effect:?}");
        // Across a crank a pivot changes its length to the second order only: what closes then is not decided.
        let is_across = effect.number.name.contains(".in.c") && effect.number.name.ends_with(".1");
        let assembles = (!is_across).then_some(false);
        assert_eq!(effect.assembles, assembles, "{effect:?}");
    }
}

/// Sarrus 1853: two groups of three parallel axes. Points may move across axes and along them; axes may not tilt.
#[test]
fn tilted_axes_take_the_freedom_of_sarrus() {
    let number_effects = effects(&instance("sarrus"), &Value::Null, Some(1));
    assert_eq!(number_effects.len(), 36);
    for effect in &number_effects {
        let name = &effect.number.name;
        let is_along = match &name[..1] {
            "a" => name.ends_with(".0"),
            _ => name.ends_with(".1"),
        };
        let keeps = name.contains("point") || is_along;
        assert_eq!(effect.keeps, Some(keeps), "{effect:?}");
    }
}

/// A slider C on a line through O, joined to O by two dyads O-A-C and O-B-C, each of two equal links. With C in O both cranks
/// turn freely, by angles a and b from the slider's line. With |OA| - |AC| = e, C stands at about e / cos a, but the other dyad
/// lets C leave O only where cos b = 0. A point O of the first dyad that leaves the line by d holds sin a = 4/5 to the first order
/// in d, as at the configuration, and leaves b free.
#[test]
fn numbers_of_two_dyads_take_one_freedom_or_open_them() {
    let at = json!({"joints": {"s": "-6/5", "OA": [1, 0], "A": ["7/25", "-24/25"], "AC": ["7/25", "24/25"],
        "OB": ["63/65", "-16/65"], "B": ["7/25", "24/25"], "BC": ["33/65", "-56/65"]}});
    let number_effects = effects(&instance("switching_point"), &at, Some(2));
    assert_eq!(names(&number_effects, None).len(), 0);
    assert_eq!(
        names(&number_effects, Some(true)),
        ["s.direction.0", "A.point.1", "B.point.1"]
    );
    let opens = |effect: &&NumberEffect| effect.assembles == Some(false);
    let opens: Vec<&str> = number_effects
        .iter()
        .filter(opens)
        .map(|x| x.number.name.as_str())
        .collect();
    for name in ["A.point.0", "AC.point.0", "B.point.0", "BC.point.0"] {
        assert!(opens.contains(&name), "{opens:?}");
    }
    for name in ["OA.point.1", "AC.point.1"] {
        let effect = number_effects
            .iter()
            .find(|x| x.number.name == name)
            .expect("a number");
        assert_eq!(
            (effect.keeps, effect.assembles),
            (Some(false), Some(true)),
            "{effect:?}"
        );
    }
}

/// A platform on three equal cranks that stands on another one: two freedoms, of which every number takes one.
#[test]
fn every_number_of_two_stages_takes_one_of_two_freedoms() {
    let joint = |name: &str, links: [&str; 2], point: [&str; 2]| json!({"name": name, "type": "R", "links": links, "point": point});
    let mut joints = Vec::new();
    for (x, name) in ["0", "2", "7/2"].into_iter().zip(["1", "2", "3"]) {
        let y = if name == "3" { 1 } else { 0 };
        let [low, high] = [format!("c{name}"), format!("d{name}")];
        let at = |right: &str, up: &str| [format!("{x}+{right}"), format!("{y}+{up}")];
        for (letter, links, point) in [
            ("A", ["g", &low], at("0", "0")),
            ("B", [&low, "p"], at("3/5", "4/5")),
            ("C", ["p", &high], at("1", "1")),
            ("D", [&high, "q"], at("17/13", "25/13")),
        ] {
            let point = point.each_ref().map(String::as_str);
            joints.push(joint(&format!("{letter}{name}"), links, point));
        }
    }
    let tree = json!({"space": "planar", "links": ["g", "c1", "c2", "c3", "p", "d1", "d2", "d3", "q"], "joints": joints});
    let number_effects = effects(&tree, &Value::Null, Some(2));
    assert_eq!(number_effects.len(), 24);
    check_all(&number_effects, false, true);
}

/// Five parallel equal bars let a body shift in two directions, and have rank 3 wherever it does; five other bars leave one freedom.
#[test]
fn every_number_of_five_parallel_bars_takes_one_of_two_freedoms() {
    let points =
        json!({"1": [0, 0, 0], "2": [1, 0, 0], "3": [0, 1, 0], "4": [2, 3, 0], "5": [3, 1, 1]});
    let legs: Vec<Value> = (1..=5)
        .map(|k| json!({"name": format!("L{k}"), "type": "SS", "from": k.to_string(), "to": k.to_string(), "length": 1}))
        .collect();
    let tree = json!({"platform": {"base": points, "moving": points, "legs": legs}});
    let at = json!({"pose": {"position": [0, 0, 1]}});
    let number_effects = effects(&tree, &at, Some(2));
    assert_eq!(number_effects.len(), 35);
    assert_eq!(
        (
            number_effects[0].number.name.as_str(),
            number_effects[34].number.name.as_str()
        ),
        ("base.1.0", "L5.length")
    );
    let fewer = names(&number_effects, Some(false));
    assert_eq!(fewer.len(), 35, "{:?}", names(&number_effects, None));
}

/// Four bars of a platform in the plane that are equal and parallel, two of them enough to hold its direction: each number of
/// base, platform and bars takes the freedom.
#[test]
fn every_number_of_four_parallel_bars_takes_the_freedom() {
    let points = json!({"1": [0, 0], "2": [1, 0], "3": [0, 1], "4": [2, 3]});
    let legs: Vec<Value> = (1..=4)
        .map(|k| json!({"name": format!("L{k}"), "type": "RR", "from": k.to_string(), "to": k.to_string(), "length": 1}))
        .collect();
    let tree =
        json!({"space": "planar", "platform": {"base": points, "moving": points, "legs": legs}});
    let at = json!({"pose": {"position": [0, 1]}});
    let number_effects = effects(&tree, &at, Some(1));
    assert_eq!(number_effects.len(), 20);
    let fewer = names(&number_effects, Some(false));
    assert_eq!(fewer.len(), 20, "{number_effects:#?}");
}

/// A point between two others on their line is held by two bars: a double position.
#[test]
fn a_rigid_framework_closes_with_other_lengths() {
    let tree = json!({"space": "planar", "framework": {"points": ["A", "B", "C"], "fixed": ["A", "B"], "bars": [
        {"between": ["A", "B"], "length": 2, "name": "base"}, {"between": ["A", "C"], "length": 1}, {"between": ["B", "C"], "length": 1}]}});
    let at = json!({"points": {"A": [0, 0], "B": [2, 0], "C": [1, 0]}});
    // It splits into two, complex ones where the bars get shorter.
    check_all(&effects(&tree, &at, Some(0)), true, true);
}

/// Rounded numbers: the freedoms are in doubt, and so is every effect.
#[test]
fn what_is_in_doubt_stays_in_doubt() {
    let mut tree = instance("bennett");
    tree["loop"]["joints"][1]["a"] = json!(1.15384615);
    let number_effects = effects(&tree, &bennett_at(), None);
    assert_eq!(names(&number_effects, None).len(), 12);
    assert!(
        number_effects
            .iter()
            .all(|effect| effect.reason.starts_with("in doubt"))
    );
}
