//! Arms of three joints that place a point: cusps, changes of posture without a singularity, most postures.
//!
//! Expected numbers are those of `tests/benches/mechanisms/cusps.py`, which shares no code with the solver: the curve of zero determinant is
//! followed on a grid of the two turns, and changes of sign of (tangent x kernel) are counted; postures are the roots of a
//! resultant by a companion matrix, and parts of equal sign are joined on a grid.

use cognate_kinematics::mechanism::{Mechanism, ReadOptions, read};
use cognate_mechanism_solver::point_arm::changes::Reason;
use cognate_mechanism_solver::point_arm::plane_map::PlaneMap;
use cognate_mechanism_solver::point_arm::posture_polynomial::{Elimination, eliminated};
use cognate_mechanism_solver::point_arm::{most_postures, posture_changes};
use serde_json::{Value, json};
use std::path::PathBuf;

const SEED: u64 = 1;

fn of_text(text: &Value) -> Mechanism {
    let content = text.to_string().into_bytes();
    read("arm.json", &content, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// A file of an instance in `tests/motions`.
fn tree(instance: &str, file: &str) -> Value {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/motions");
    let path = folder.join(instance).join(file);
    let content = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&content).expect("JSON")
}

/// An arm of three turns by its lengths, twists in degrees and offsets.
fn arm(lengths: [f64; 3], twists: [f64; 2], offsets: [f64; 2]) -> Mechanism {
    let joint = |k: usize, twist: f64, offset: f64| json!({"name": format!("q{}", k + 1), "type": "R", "a": lengths[k], "alpha": twist, "d": offset});
    let joints = [
        joint(0, twists[0], 0.0),
        joint(1, twists[1], offsets[0]),
        joint(2, 0.0, offsets[1]),
    ];
    of_text(&json!({
        "space": "spatial",
        "angles": "deg",
        "serial": {"convention": "standard", "joints": joints},
        "output": {"link": "link3", "point": [0, 0, 0]}
    }))
}

/// An arm of which neighbouring axes are at right angles, with first length 1 and no offset of the last joint.
fn orthogonal(second: f64, third: f64, offset: f64) -> Mechanism {
    arm([1.0, second, third], [-90.0, 90.0], [offset, 0.0])
}

/// The answer is settled and as expected.
fn check(arm: &Mechanism, cusps: u64, cuspidal: bool, name: &str) -> Reason {
    let changes = posture_changes(arm, SEED).expect("an arm of three joints");
    assert!(changes.doubts.is_empty(), "{name}: {changes:?}");
    assert_eq!(changes.dimension, 2, "{name}: {changes:?}");
    assert_eq!(changes.cusps, Some(cusps), "{name}: {changes:?}");
    assert_eq!(changes.cuspidal, Some(cuspidal), "{name}: {changes:?}");
    changes.reason.expect("a settled answer has a reason")
}

fn check_most(arm: &Mechanism, postures: u64, name: &str) {
    let most = most_postures(arm).expect("an arm of three joints");
    assert_eq!(most.postures, Some(postures), "{name}: {most:?}");
}

#[test]
fn instances_have_their_cusps_and_postures() {
    for instance in ["cuspidal_3r", "not_cuspidal_3r"] {
        let expected = &tree(instance, "meta.json")["expected"];
        let outputs = &expected["outputs"];
        let arm = of_text(&tree(instance, "mechanism.json"));
        let cusps = outputs["cusps"].as_u64().expect("a number");
        let cuspidal = outputs["cuspidal"].as_bool().expect("a verdict");
        check(&arm, cusps, cuspidal, instance);
        let most = expected["workspace"]["max_postures"]
            .as_u64()
            .expect("a number");
        check_most(&arm, most, instance);
    }
}

/// The points of the instances have as many postures as the polynomial has real roots.
#[test]
fn points_have_the_postures_of_the_instances() {
    for instance in ["cuspidal_3r", "not_cuspidal_3r"] {
        let expected = &tree(instance, "meta.json")["expected"]["workspace"]["points"];
        let arm = of_text(&tree(instance, "mechanism.json"));
        let map = PlaneMap::of(&arm).expect("an arm of three joints");
        let Elimination::Polynomial(polynomial) = eliminated(&map) else {
            panic!("{instance}: the first two axes are neither parallel nor do they meet");
        };
        let points = tree(instance, "points.json");
        for (k, point) in points.as_array().expect("points").iter().enumerate() {
            let [x, y, z] =
                [0, 1, 2].map(|i| point["position"][i].as_f64().expect("a number") / map.size);
            let postures = polynomial.postures([x * x + y * y + z * z, z]);
            assert_eq!(postures, expected[k]["postures"].as_u64(), "{instance} {k}");
        }
    }
}

#[test]
fn orthogonal_arms_have_the_cusps_of_their_type() {
    for ([second, third, offset], cusps, most) in [
        ([2.0, 1.5, 1.0], 4, 4),
        ([0.5, 0.3, 0.2], 0, 2),
        ([2.0, 0.5, 0.5], 4, 4),
        ([2.0, 0.3, 2.0], 4, 4),
        ([3.0, 2.0, 1.0], 4, 4),
        ([0.2, 0.3, 1.5], 4, 4),
        ([1.5, 2.5, 0.5], 4, 4),
        ([2.0, 3.0, 0.3], 4, 4),
    ] {
        let name = format!("{second} {third} {offset}");
        let arm = orthogonal(second, third, offset);
        check(&arm, cusps, cusps > 0, &name);
        check_most(&arm, most, &name);
    }
}

/// Arms of which the point comes to the second axis, without cusps: it is not decided in this version, and said, that no posture
/// changes without a singularity.
#[test]
fn arms_that_reach_the_second_axis_without_cusps_are_in_doubt() {
    for [second, third, offset] in [[0.3, 1.5, 0.2], [0.5, 2.5, 0.3], [0.5, 0.7, 0.4]] {
        let arm = orthogonal(second, third, offset);
        let changes = posture_changes(&arm, SEED).expect("an arm of three joints");
        assert_eq!(
            (changes.cusps, changes.cuspidal),
            (Some(0), None),
            "{changes:?}"
        );
        assert_eq!(changes.doubts.len(), 1, "{changes:?}");
        check_most(&arm, 4, "an arm that reaches the second axis");
    }
}

#[test]
fn general_arms_have_the_cusps_that_following_the_curve_counts() {
    for (lengths, twists, offsets, cusps) in [
        ([1.36, 1.83, 1.62], [52.0, 62.0], [0.75, -0.99], 4),
        ([1.7, 1.66, 1.1], [62.0, 59.0], [-0.49, -0.11], 2),
        ([1.16, 1.24, 1.99], [131.0, 107.0], [0.98, -0.57], 4),
        ([0.57, 1.34, 0.37], [25.0, 92.0], [-0.07, 0.83], 0),
        ([1.37, 1.17, 1.14], [55.0, 22.0], [-0.62, 0.38], 2),
        ([0.64, 0.93, 0.31], [136.0, 42.0], [-0.46, 0.76], 4),
        ([1.17, 1.74, 1.39], [124.0, 33.0], [0.08, 0.02], 2),
        ([1.78, 0.91, 1.32], [28.0, 74.0], [-0.35, -0.7], 4),
    ] {
        let arm = arm(lengths, twists, offsets);
        check(&arm, cusps, cusps > 0, &format!("{lengths:?} {twists:?}"));
    }
}

/// P. Wenger 1997: arms with first or last two axes that are parallel or meet do not change posture without a singularity.
#[test]
fn simple_arms_are_not_cuspidal() {
    let parallel_first = arm([0.7, 1.1, 0.6], [0.0, 70.0], [0.2, 0.1]);
    let meeting_first = arm([0.0, 1.1, 0.6], [-90.0, 70.0], [0.2, 0.1]);
    let parallel_last = arm([0.3, 1.1, 0.9], [-60.0, 0.0], [0.1, 0.2]);
    let meeting_last = arm([0.8, 0.0, 0.9], [-60.0, 40.0], [0.1, 0.3]);
    for (name, arm, reason) in [
        ("parallel first", parallel_first, Reason::ThirdJointAlone),
        ("meeting first", meeting_first, Reason::ThirdJointAlone),
        ("parallel last", parallel_last, Reason::Even),
        ("meeting last", meeting_last, Reason::Even),
    ] {
        assert_eq!(check(&arm, 0, false, name), reason, "{name}");
    }
}

/// Shifts: cusps by paths alone. A shift and a turn about a skewed axis before it make a point of two postures, which one sign tells.
#[test]
fn arms_with_shifts_are_answered_too() {
    let arm = |kinds: [&str; 3]| {
        let rows = [
            [0.5, -60.0, 0.0, 0.0],
            [0.8, 70.0, 0.3, 10.0],
            [1.1, 0.0, 0.2, 0.0],
        ];
        let joint = |(k, kind): (usize, &str)| {
            let [a, alpha, d, theta] = rows[k];
            json!({"name": format!("q{k}"), "type": kind, "a": a, "alpha": alpha, "d": d, "theta": theta})
        };
        let joints: Vec<Value> = kinds.into_iter().enumerate().map(joint).collect();
        of_text(&json!({"space": "spatial", "angles": "deg",
            "serial": {"convention": "standard", "joints": joints}}))
    };
    assert_eq!(check(&arm(["R", "P", "P"]), 0, false, "RPP"), Reason::Even);
    assert_eq!(check(&arm(["P", "R", "R"]), 4, true, "PRR"), Reason::Cusp);
    let open = posture_changes(&arm(["R", "P", "R"]), SEED).expect("an arm of three joints");
    assert_eq!((open.cusps, open.cuspidal), (Some(0), None), "{open:?}");
}

#[test]
fn arms_without_a_curve_of_singular_positions_say_so() {
    let spherical = arm([0.0, 0.0, 0.0], [-90.0, 90.0], [0.0, 0.0]);
    let changes = posture_changes(&spherical, SEED).expect("an arm of three joints");
    assert_eq!((changes.dimension, changes.cuspidal), (3, None));
    assert!(!changes.doubts.is_empty());
    let gantry = of_text(&json!({
        "space": "spatial", "links": ["ground", "x", "y", "z"],
        "joints": [
            {"name": "X", "type": "P", "links": ["ground", "x"], "point": [0, 0, 0], "axis": [1, 0, 0]},
            {"name": "Y", "type": "P", "links": ["x", "y"], "point": [0, 0, 0], "axis": [0, 1, 0]},
            {"name": "Z", "type": "P", "links": ["y", "z"], "point": [0, 0, 0], "axis": [0, 0, 1]}],
        "inputs": ["X", "Y", "Z"], "output": {"link": "z", "point": [0, 0, 0]}
    }));
    let changes = posture_changes(&gantry, SEED).expect("three joints in series");
    assert_eq!((changes.dimension, changes.cuspidal), (-1, Some(false)));
}
