//! Boundaries of workspaces in the plane, with known answers: those of `tests/motions`, and others beside their sources here.

use cognate_kinematics::mechanism::exact::Angle;
use cognate_kinematics::mechanism::{Mechanism, ReadOptions, read};
use cognate_mechanism_solver::AnswerOptions;
use cognate_mechanism_solver::workspace::{Boundary, Cause, ReachedPoint, boundary, workspace};
use num_complex::Complex64;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::PathBuf;

fn of_text(text: &Value) -> Mechanism {
    let content = text.to_string().into_bytes();
    read("mechanism.json", &content, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn tree(instance: &str, file: &str) -> Value {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/motions");
    let path = root.join(instance).join(file);
    let content = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&content).expect("JSON")
}

fn bounded(mechanism: &Mechanism, angle: Option<Angle>, within_limits: bool) -> Boundary {
    let options = AnswerOptions::default();
    let answer = boundary(mechanism, (angle, within_limits), &[], &options);
    let answer = answer.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(answer.doubt, None, "{answer:?}");
    check_samples(mechanism, angle, &answer);
    answer
}

/// Points that draw a curve are on it, and there are enough of them.
fn check_samples(mechanism: &Mechanism, angle: Option<Angle>, answer: &Boundary) {
    for drawn in answer.curves.iter().flatten() {
        let circle = drawn.curve.circle;
        let place = format!("{} {angle:?} {circle:?}", mechanism.name);
        assert!(drawn.samples.len() > 20, "{place}");
        for [x, y] in &drawn.samples {
            assert!(
                circle.beyond(Complex64::new(*x, *y)).abs() < 1e-12,
                "{place}"
            );
        }
    }
}

fn asked(mechanism: &Mechanism, points: &[[f64; 3]]) -> Vec<ReachedPoint> {
    let answers = workspace(mechanism, points, None, &AnswerOptions::default());
    answers.unwrap_or_else(|e| panic!("{e}"))
}

/// Radii and centres of the circles, in their order.
fn circles(answer: &Boundary, which: impl Fn(&Cause) -> bool) -> Vec<[f64; 3]> {
    let curves = answer.curves.as_ref().unwrap_or_else(|e| panic!("{e}"));
    let curves = curves.iter().filter(|drawn| which(&drawn.curve.cause));
    let circles = curves.map(|drawn| drawn.curve.circle);
    let mut circles: Vec<[f64; 3]> = circles
        .map(|c| [c.center.re, c.center.im, c.radius])
        .collect();
    circles.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    circles
}

fn near(value: f64, expected: f64, relative: f64) {
    assert!(
        (value - expected).abs() < relative * expected,
        "{value} {expected}"
    );
}

/// Checks the fields of the instance against the expected ones.
fn check_instance(instance: &str, within_limits: bool) {
    let meta = tree(instance, "meta.json");
    let expected = &meta["expected"];
    let angle = expected["orientation"].as_f64().map(Angle::of_radians);
    let answer = bounded(
        &of_text(&tree(instance, "mechanism.json")),
        angle,
        within_limits,
    );
    let expected = &expected["workspace"];
    if let Some(listed) = expected["circles"].as_array() {
        let number = |v: &Value| v.as_f64().expect("a number");
        let circle = |c: &Value| {
            [
                number(&c["center"][0]),
                number(&c["center"][1]),
                number(&c["radius"]),
            ]
        };
        let mut listed: Vec<[f64; 3]> = listed.iter().map(circle).collect();
        listed.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        let circles = circles(&answer, |_| true);
        assert_eq!(circles.len(), listed.len(), "{instance} {circles:?}");
        for (circle, listed) in circles.iter().flatten().zip(listed.iter().flatten()) {
            assert!((circle - listed).abs() < 1e-9, "{instance} {circles:?}");
        }
    }
    let curves = answer.curves.as_ref().expect("curves");
    let bounding = || {
        curves
            .iter()
            .filter(|drawn| drawn.on_boundary == Some(true))
    };
    if let Some(outer) = expected["outer_boundary"].as_array() {
        let radii: Vec<f64> = bounding().map(|drawn| drawn.curve.circle.radius).collect();
        assert_eq!(radii.len(), outer.len(), "{instance} {radii:?}");
        for radius in outer.iter().filter_map(Value::as_f64) {
            assert!(
                radii.iter().any(|r| (r - radius).abs() < 1e-9),
                "{instance} {radii:?}"
            );
        }
    }
    if let Some(causes) = expected["boundary_from"].as_array() {
        let has = |limits: bool| {
            bounding().any(|drawn| matches!(drawn.curve.cause, Cause::Limit(_)) == limits)
        };
        for cause in causes {
            assert!(has(cause == "limit"), "{instance} {cause}");
        }
    }
    if let Some(area) = expected["area"].as_f64() {
        near(*answer.area.as_ref().expect("an area"), area, 1e-9);
    }
    if let Some(area) = expected["area_within_limits"]["value"].as_f64() {
        let relative = expected["area_within_limits"]["relative_tolerance"].as_f64();
        near(
            *answer.area.as_ref().expect("an area"),
            area,
            relative.expect("a tolerance"),
        );
    }
    if let Some(most) = expected["max_postures"].as_u64() {
        assert_eq!(answer.max_postures, Ok(most), "{instance}");
    }
}

#[test]
fn boundaries_are_those_of_the_instances() {
    check_instance("planar_3r", false);
    check_instance("planar_2r_limits", true);
    check_instance("five_bar_workspace", false);
    check_instance("three_rpr", true);
}

#[test]
fn the_most_postures_of_an_arm_in_space_are_those_of_the_instances() {
    for instance in ["cuspidal_3r", "not_cuspidal_3r"] {
        let most = tree(instance, "meta.json")["expected"]["workspace"]["max_postures"].as_u64();
        let answer = bounded(&of_text(&tree(instance, "mechanism.json")), None, false);
        assert!(
            most.is_some() && answer.max_postures.ok() == most,
            "{instance}"
        );
        assert!(answer.curves.is_err() && answer.area.is_err(), "{instance}");
    }
}

/// Number of a joint from 1, and its limits in degrees.
type Limit = (usize, [f64; 2]);

/// A chain of turns along the x-axis.
fn chain(lengths: &[f64], limits: &[Limit]) -> Value {
    let place = |k: usize| [lengths[..k].iter().sum::<f64>(), 0.0];
    let link = |k: usize| format!("l{k}");
    let joint = |k: usize| json!({"name": format!("q{}", k + 1), "type": "R", "links": [link(k), link(k + 1)], "point": place(k)});
    let count = lengths.len();
    let ranges = limits
        .iter()
        .map(|(k, range)| (format!("q{k}"), json!(range)));
    json!({"space": "planar", "links": (0..=count).map(link).collect::<Vec<_>>(),
        "joints": (0..count).map(joint).collect::<Vec<_>>(),
        "output": {"link": link(count), "point": place(count)},
        "limits": Value::Object(ranges.collect())})
}

/// A five-bar of unequal arms whose output is the joint between the rods.
fn five_bar(limits: &Value) -> Value {
    let tip = [0.9787765526521498, 1.5727655265214986];
    json!({"space": "planar", "links": ["ground", "left", "left_rod", "right_rod", "right"], "joints": [
        {"name": "A0", "type": "R", "links": ["ground", "left"], "point": [0, 0]},
        {"name": "A", "type": "R", "links": ["left", "left_rod"], "point": ["-7/25", "24/25"]},
        {"name": "C", "type": "R", "links": ["left_rod", "right_rod"], "point": tip},
        {"name": "B", "type": "R", "links": ["right_rod", "right"], "point": [1.72, 0.76]},
        {"name": "B0", "type": "R", "links": ["right", "ground"], "point": [1.3, 0.2]}],
        "inputs": ["A0", "B0"], "output": {"link": "right_rod", "point": tip}, "limits": limits})
}

/// Arms of 1 and 7/5 about (0, 0), of 7/10 and 11/10 about (13/10, 1/5). Areas: 8,000,000 vertical chords of the meet of two
/// rings; with limits 36,000,000 cells by the cosine rule, good to 0.1 %.
#[test]
fn a_five_bar_of_unequal_arms() {
    let free = bounded(&of_text(&five_bar(&json!({}))), None, true);
    near(free.area.clone().expect("an area"), 7.086928521, 1e-8);
    assert_eq!(free.max_postures, Ok(4));
    let radii: Vec<f64> = circles(&free, |_| true).iter().map(|c| c[2]).collect();
    for (radius, expected) in radii.iter().zip([0.4, 2.4, 0.4, 1.8]) {
        near(*radius, expected, 1e-9);
    }
    let limits = json!({"A0": [-30, 80], "B": [20, 150]});
    let limited = of_text(&five_bar(&limits));
    let within = bounded(&limited, None, true);
    near(within.area.clone().expect("an area"), 0.786790, 2e-3);
    assert_eq!(within.max_postures, Ok(4));
    // Without --within-limits the limits bound nothing.
    assert_eq!(bounded(&limited, None, false), free);
    let between = bounded(&of_text(&five_bar(&json!({"C": [-40, 40]}))), None, true);
    assert!(
        between
            .curves
            .is_err_and(|reason| reason.contains("limits of C"))
    );
    assert!(between.area.is_err());
}

/// Rings about a_i - R b_i between the differences and the sums of cranks and rods; 4,000,000 vertical chords of their meet.
#[test]
fn a_platform_on_cranks() {
    let leg = |k: usize, center: [f64; 2], length: f64, rod: f64| {
        json!({"name": format!("L{k}"), "type": "RRR", "rod": rod, "to": format!("B{k}"),
            "crank": {"center": center, "zero": [1, 0], "length": length}})
    };
    let platform = of_text(&json!({"space": "planar", "platform": {
        "base": {"A": [0, 0]},
        "moving": {"B1": [-0.4, -0.2], "B2": [0.5, -0.3], "B3": [0.1, 0.6]},
        "legs": [leg(1, [0.0, 0.0], 1.1, 1.3), leg(2, [2.5, 0.0], 0.9, 1.5), leg(3, [1.1, 2.2], 1.2, 1.0)]}}));
    let answer = bounded(&platform, Some(Angle::of_degrees(25.0)), false);
    near(answer.area.clone().expect("an area"), 5.599906488, 1e-8);
    assert_eq!(answer.max_postures, Ok(8));
    assert_eq!(
        circles(&answer, |cause| *cause == Cause::Singularity).len(),
        6
    );
}

/// The platform of `motions/three_rpr` with other limits at another angle; 4,000,000 vertical chords of the meet of three rings.
#[test]
fn a_platform_on_struts_at_another_angle() {
    let mut text = tree("three_rpr", "mechanism.json");
    text["limits"] = json!({"L1": [0.8, 2.4], "L2": [0.7, 2.2], "L3": [0.9, 2.5]});
    let answer = bounded(&of_text(&text), Some(Angle::of_degrees(-50.0)), true);
    near(answer.area.clone().expect("an area"), 2.283415579, 1e-8);
    assert_eq!(answer.max_postures, Ok(1));
    let free = bounded(&of_text(&text), Some(Angle::of_degrees(-50.0)), false);
    assert_eq!(free.curves, Ok(Vec::new()));
    assert!(
        free.area
            .is_err_and(|reason| reason.contains("any distance"))
    );
    assert_eq!(free.max_postures, Ok(1));
    text["platform"]["legs"][1] = json!({"name": "L2", "type": "PRR", "to": "B2", "rod": 2,
        "slider": {"origin": [3, 0], "direction": [0, 1]}});
    text["limits"] = json!({});
    let sliding = bounded(&of_text(&text), Some(Angle::ZERO), false);
    assert!(
        sliding
            .curves
            .is_err_and(|reason| reason.contains("L2 has a slider"))
    );
    assert!(sliding.area.is_err());
}

/// Links 6/5 and 7/10; 36,000,000 cells by the cosine rule, good to 0.1 %.
#[test]
fn an_arm_of_two_links_with_limits() {
    let text = chain(&[1.2, 0.7], &[(1, [-40.0, 70.0]), (2, [-110.0, 100.0])]);
    let answer = bounded(&of_text(&text), None, true);
    near(answer.area.clone().expect("an area"), 2.914932, 2e-3);
    assert_eq!(answer.max_postures, Ok(2));
    // Both ends of symmetric limits give the same circle.
    let symmetric = of_text(&chain(&[1.2, 0.7], &[(2, [-90.0, 90.0])]));
    assert_eq!(
        circles(&bounded(&symmetric, None, true), |cause| *cause
            != Cause::Singularity)
        .len(),
        1
    );
    // A limit of a whole turn is none.
    let text = chain(&[1.2, 0.7], &[(1, [-180.0, 180.0])]);
    let answer = bounded(&of_text(&text), None, true);
    near(
        answer.area.clone().expect("an area"),
        PI * (1.9 * 1.9 - 0.25),
        1e-12,
    );
    assert_eq!(circles(&answer, |_| true).len(), 2);
}

/// Links 1, 4/5, 3/5; 1,000,000 cells, of each 1401 turns of the first link and the cosine rule; good to 0.3 %.
#[test]
fn an_arm_of_three_links_with_limits() {
    let limits = [(1, [-60.0, 80.0]), (2, [-100.0, 40.0]), (3, [20.0, 120.0])];
    let answer = bounded(&of_text(&chain(&[1.0, 0.8, 0.6], &limits)), None, true);
    near(answer.area.clone().expect("an area"), 6.817213, 5e-3);
    assert!(
        answer
            .max_postures
            .is_err_and(|reason| reason.contains("infinitely many"))
    );
}

/// By hand: half a turn of a chain that is stretched rigidly sweeps half a ring; two limits leave a sector.
#[test]
fn sectors_of_rings() {
    let text = chain(
        &[1.0, 1.0, 1.0],
        &[(1, [0.0, 90.0]), (2, [0.0, 0.0]), (3, [0.0, 90.0])],
    );
    let answer = bounded(&of_text(&text), None, true);
    // The tip turns about (2, 0) from radius 3 to sqrt(5), and all that by a quarter turn: in polar coordinates about the base
    // the area is the quarter turn times the half of 9 - 5; the two ends of the sector are equal arcs.
    near(answer.area.clone().expect("an area"), PI, 1e-9);
}

/// Places of the tip at random postures within limits are reached within limits, also of four links.
#[test]
fn postures_within_limits_reach_their_points() {
    let arms: [(&[f64], &[Limit]); 5] = [
        (
            &[1.0, 0.8, 0.6],
            &[(1, [-60.0, 80.0]), (2, [-100.0, 40.0]), (3, [20.0, 120.0])],
        ),
        (&[1.0, 0.8, 0.6], &[(2, [30.0, 50.0])]),
        (&[0.5, 1.3, 0.6], &[(1, [10.0, 20.0]), (3, [-5.0, 5.0])]),
        (
            &[1.0, 0.8, 0.6, 0.5],
            &[
                (1, [-10.0, 30.0]),
                (2, [-50.0, -20.0]),
                (3, [40.0, 70.0]),
                (4, [-90.0, -60.0]),
            ],
        ),
        (
            &[1.0, 1.0, 0.3, 0.4],
            &[(2, [90.0, 180.0]), (4, [0.0, 45.0])],
        ),
    ];
    let mut state = 1u64;
    let mut part = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for (lengths, limits) in arms {
        let arm = of_text(&chain(lengths, limits));
        for _ in 0..200 {
            let (mut turn, mut tip) = (0.0, Complex64::default());
            for (k, length) in lengths.iter().enumerate() {
                let range = limits.iter().find(|(joint, _)| *joint == k + 1);
                let [low, high] = range.map_or([-180.0, 180.0], |(_, range)| *range);
                turn += low + part() * (high - low);
                let [c, s] = Angle::of_degrees(turn).direction;
                tip += Complex64::new(c, s) * *length;
            }
            let answer = asked(&arm, &[[tip.re, tip.im, 0.0]]).remove(0);
            assert_eq!(
                answer.reachable_within_limits,
                Some(true),
                "{lengths:?} {tip} {answer:?}"
            );
            assert_eq!(answer.doubts(true).count(), 0);
        }
    }
}

/// By hand: the numbers are exact, so that neither border nor base is in doubt.
#[test]
fn two_links_are_decided_by_exact_numbers() {
    let arm = of_text(&chain(&[1.0, 0.8], &[(2, [-90.0, 0.0])]));
    let answers = asked(
        &arm,
        &[
            [1.8, 0.0, 0.0],
            [0.0, -0.2, 0.0],
            [0.0, 1.9, 0.0],
            [0.2, 0.1, 0.0],
        ],
    );
    let counts: Vec<_> = answers
        .iter()
        .map(|a| (a.postures, a.within_limits))
        .collect();
    assert_eq!(
        counts,
        [
            (Some(1), Some(1)),
            (Some(1), Some(0)),
            (Some(0), Some(0)),
            (Some(2), Some(0))
        ]
    );
    // Equal links fold onto each other: the point of the first joint has infinitely many postures.
    let arm = |limits: [f64; 2]| of_text(&chain(&[0.7, 0.7], &[(2, limits)]));
    let answer = asked(&arm([-90.0, 180.0]), &[[0.0; 3]]).remove(0);
    let is_infinite =
        |a: &ReachedPoint| a.reachable == Some(true) && a.postures.is_none() && a.doubt.is_none();
    assert!(is_infinite(&answer) && answer.within_limits.is_none());
    assert_eq!(answer.reachable_within_limits, Some(true));
    let answer = asked(&arm([-90.0, 90.0]), &[[0.0; 3]]).remove(0);
    assert!(is_infinite(&answer));
    assert_eq!(
        (answer.within_limits, answer.reachable_within_limits),
        (Some(0), Some(false))
    );
}

/// The product of two arms in closed form says what the assemblies of the linkage that is held at the point say: with limits of
/// the joint between the rods it is these that are counted.
#[test]
fn arms_of_a_five_bar_have_the_postures_of_the_linkage() {
    let by_arms = of_text(&five_bar(&json!({"A0": [-30, 80], "B": [20, 150]})));
    let by_assemblies = of_text(&five_bar(
        &json!({"A0": [-30, 80], "B": [20, 150], "C": [-180, 180]}),
    ));
    let points: Vec<[f64; 3]> = (0..80u8)
        .map(|k| {
            [
                f64::from(k % 10) * 0.43 - 1.9,
                f64::from(k / 10) * 0.47 - 1.7,
                0.0,
            ]
        })
        .collect();
    let short = |answers: Vec<ReachedPoint>| -> Vec<_> {
        answers
            .iter()
            .map(|a| (a.postures, a.within_limits, a.reachable_within_limits))
            .collect()
    };
    let arms = short(asked(&by_arms, &points));
    assert_eq!(arms, short(asked(&by_assemblies, &points)));
    assert!(arms.iter().any(|a| a.1 > Some(0)) && arms.iter().any(|a| a.0 == Some(0)));
}

/// Linkages of other kinds have no boundary here, and say why; their points are answered as before.
#[test]
fn other_outputs_have_no_boundary() {
    let mut text = five_bar(&json!({}));
    text["output"]["point"] = json!([0.5, 1.5]);
    let mechanism = of_text(&text);
    let answer = bounded(&mechanism, None, false);
    assert!(answer.curves.is_err() && answer.area.is_err() && answer.max_postures.is_err());
    assert!(asked(&mechanism, &[[0.5, 1.5, 0.0]])[0].reachable == Some(true));
    let single = bounded(&of_text(&chain(&[1.0], &[])), None, false);
    assert!(
        single
            .curves
            .is_err_and(|reason| reason.contains("one joint"))
    );
}

/// A ring that is thinner than limits are met leaves the area in doubt, and says so.
#[test]
fn curves_that_are_too_near_are_in_doubt() {
    let mut text = tree("three_rpr", "mechanism.json");
    text["limits"] = json!({"L1": [1, 1.00000001], "L2": [0.7, 2.2], "L3": [0.9, 2.5]});
    let options = AnswerOptions::default();
    let answer = boundary(&of_text(&text), (Some(Angle::ZERO), true), &[], &options);
    let answer = answer.unwrap_or_else(|e| panic!("{e}"));
    assert!(answer.area.is_err_and(|reason| reason.contains("in doubt")));
    assert!(answer.doubt.is_some_and(|doubt| doubt.contains("too near")));
    let curves = answer.curves.unwrap_or_else(|e| panic!("{e}"));
    assert!(curves.iter().any(|drawn| drawn.on_boundary.is_none()));
}

/// Joints at limits can leave a link without length between two joints, here where the second link folds onto the first: the
/// area is settled.
#[test]
fn links_that_fold_onto_each_other_are_no_doubt() {
    let limits = [(1, [-180.0, 45.0]), (2, [-180.0, 120.0]), (4, [30.0, 45.0])];
    let answer = bounded(&of_text(&chain(&[1.0, 1.0, 1.0, 2.0], &limits)), None, true);
    assert!(answer.area.is_ok());
}
