//! Mechanisms with known answers, from their files to positions: `tests/mechanisms`, three seeds each.
//!
//! `meta.json` of each instance holds the expected answer and names the independent programs that found it.

use cognate_kinematics::compile::{Configuration, Problem, Question, Target};
use cognate_kinematics::mechanism::chain::JointValue;
use cognate_kinematics::mechanism::targets::PoseForm;
use cognate_kinematics::mechanism::{
    Body, Mechanism, MechanismError, ReadOptions, Space, read, targets,
};
use cognate_kinematics::shape::Shape;
use cognate_mechanism_solver::follow::samples::{Sample, samples};
use cognate_mechanism_solver::follow::{BranchEnd, Path, follow};
use cognate_mechanism_solver::postures::Postures;
use cognate_mechanism_solver::preparation::{AnswerOptions, Preparation};
use cognate_mechanism_solver::prepared_mechanism::PreparedMechanism;
use cognate_mechanism_solver::summary::Summary;
use serde_json::Value;
use std::f64::consts::PI;
use std::path::PathBuf;

/// Three seeds, or as many as the variable SEEDS says.
fn seeds() -> std::ops::RangeInclusive<u64> {
    let wanted = std::env::var("SEEDS").ok().and_then(|n| n.parse().ok());
    1..=wanted.unwrap_or(3)
}

fn content(instance: &str, file: &str) -> Vec<u8> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/mechanisms");
    let path = root.join(instance).join(file);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn json(instance: &str, file: &str) -> Value {
    serde_json::from_slice(&content(instance, file)).unwrap()
}

fn mechanism(instance: &str, file: &str) -> Mechanism {
    read(file, &content(instance, file), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn question(problem: Problem) -> Question {
    Question::of(problem)
}

/// The answers for all targets, with their summary.
#[derive(Debug)]
struct Answer {
    preparation: Preparation,
    targets: Vec<Postures>,
    warnings: Vec<String>,
    settled: bool,
}

/// Answers a question; without targets there is one, with nothing given.
fn answer(
    mechanism: &Mechanism,
    question: &Question,
    targets: &[Target],
    options: &AnswerOptions,
) -> Result<Answer, MechanismError> {
    let prepared = PreparedMechanism::new(mechanism, question, options)?;
    let lone = [Target::Inputs(Vec::new())];
    let targets = match targets {
        [] => prepared.solve(&lone)?,
        targets => prepared.solve(targets)?,
    };
    let mut summary = Summary::of(prepared.preparation());
    targets.iter().for_each(|target| summary.note(target));
    Ok(Answer {
        preparation: prepared.preparation().clone(),
        targets,
        warnings: summary.warnings,
        settled: summary.settled,
    })
}

/// All seeds; each target of each must have these numbers of complex and real positions.
fn check(
    name: &str,
    mechanism: &Mechanism,
    question: &Question,
    targets: &[Target],
    expected: &[(u64, u64)],
) -> Vec<Answer> {
    let mut wrong = String::new();
    let mut answers = Vec::new();
    for seed in seeds() {
        let options = AnswerOptions {
            seed,
            ..AnswerOptions::default()
        };
        let mechanism_answer =
            answer(mechanism, question, targets, &options).unwrap_or_else(|e| panic!("{e}"));
        let counts: Vec<(u64, u64)> = mechanism_answer
            .targets
            .iter()
            .map(|t| (t.counts.complex, t.counts.real))
            .collect();
        if counts != expected || !mechanism_answer.settled {
            let target_counts: Vec<_> =
                mechanism_answer.targets.iter().map(|t| &t.counts).collect();
            wrong += &format!(
                "\n{name}, seed {seed}: {target_counts:?} instead of {expected:?}; {:?} {}",
                mechanism_answer.warnings, mechanism_answer.preparation.reason
            );
        }
        for target in &mechanism_answer.targets {
            for position in &target.positions {
                let residual = position.configuration.residual;
                if residual > 1e-9 {
                    wrong += &format!("\n{name}, seed {seed}: a loop stays open by {residual:e}");
                }
                if position.is_real {
                    for joint in joints_in_the_air(mechanism, &position.configuration) {
                        wrong += &format!("\n{name}, seed {seed}: {joint} is drawn apart");
                    }
                }
            }
        }
        answers.push(mechanism_answer);
    }
    assert!(wrong.is_empty(), "{wrong}");
    answers
}

/// Joints of the drawing at which nothing of another body ends.
fn joints_in_the_air(mechanism: &Mechanism, position: &Configuration) -> Vec<String> {
    let shape = Shape::of(mechanism);
    let poses = shape.poses(position);
    let place = |body: usize, point: [f64; 3]| -> [f64; 3] {
        let pose =
            poses[body].unwrap_or_else(|| panic!("{} stands nowhere", shape.bodies[body].name));
        pose.point(point.map(Into::into)).map(|c| c.re)
    };
    let rods = shape.rods.iter().flatten().copied();
    let segments = shape.bodies.iter().enumerate().flat_map(|(b, body)| {
        let ends = body.segments.iter().flatten();
        ends.map(move |end| (b, *end))
    });
    let ends: Vec<(usize, [f64; 3])> = rods.chain(segments).collect();
    let near = |p: [f64; 3], q: [f64; 3]| p.iter().zip(q).all(|(x, y)| (x - y).abs() < 1e-6);
    let apart = shape.joints.iter().enumerate().filter(|(_, joint)| {
        let here = place(joint.body, joint.point);
        let is_other = |(body, point): &&(usize, [f64; 3])| {
            (*body != joint.body || *point != joint.point) && near(here, place(*body, *point))
        };
        let at_rod = |rod: &[(usize, [f64; 3]); 2]| rod.contains(&(joint.body, joint.point));
        !shape.rods.iter().any(at_rod) && ends.iter().find(is_other).is_none()
    });
    apart
        .map(|(k, joint)| format!("joint {k} of {}", shape.bodies[joint.body].name))
        .collect()
}

fn poses(instance: &str, mechanism: &Mechanism) -> Vec<Target> {
    let rows = targets::poses(
        "poses.json",
        &content(instance, "poses.json"),
        PoseForm::whole(mechanism.space, mechanism.degrees),
    );
    rows.unwrap_or_else(|e| panic!("{e}"))
        .into_iter()
        .map(|read| Target::Pose(read.pose))
        .collect()
}

fn inputs(instance: &str, file: &str, mechanism: &Mechanism, names: &[String]) -> Vec<Target> {
    let kinds = mechanism.values();
    let angle = |name: &String| kinds.iter().any(|(n, a)| n == name && *a);
    let names: Vec<(String, bool)> = names.iter().map(|n| (n.clone(), angle(n))).collect();
    let rows = targets::inputs(file, &content(instance, file), &names, mechanism.degrees);
    rows.unwrap_or_else(|e| panic!("{e}"))
        .into_iter()
        .map(Target::Inputs)
        .collect()
}

/// The real joint values of a target.
fn real_values(target: &Postures) -> Vec<Vec<f64>> {
    let real = target.positions.iter().filter(|p| p.is_real);
    real.map(|p| {
        p.configuration
            .values
            .iter()
            .map(|(_, v)| v.real())
            .collect()
    })
    .collect()
}

/// The largest difference of two lists of angles.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let turn = 2.0 * PI;
    let one = |(x, y): (&f64, &f64)| {
        let d = (x - y).rem_euclid(turn);
        d.min(turn - d)
    };
    a.iter().zip(b).map(one).fold(0.0, f64::max)
}

fn check_arm(instance: &str, file: &str, lock: Option<(&str, f64)>) {
    let meta = json(instance, "meta.json");
    let mechanism = mechanism(instance, file);
    let targets = poses(instance, &mechanism);
    let expected = match lock {
        Some(_) => meta["expected"]["with_lock"].clone(),
        None => meta["expected"].clone(),
    };
    let real: Vec<u64> = match expected["real_by_pose"].as_array() {
        Some(list) => list.iter().map(|n| n.as_u64().unwrap()).collect(),
        None => vec![expected["real"].as_u64().unwrap()],
    };
    let complex = expected["complex"].as_u64().unwrap_or(8);
    let wanted: Vec<(u64, u64)> = real.iter().map(|r| (complex, *r)).collect();
    let question = Question {
        locks: lock.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect(),
        ..question(Problem::Inverse)
    };
    let answers = check(instance, &mechanism, &question, &targets, &wanted);
    let postures = json(instance, "configurations.json");
    let postures = postures.as_array().unwrap();
    // A list a pose, or one list for the only pose.
    let nested = postures[0][0].is_array();
    for answer in &answers {
        for (i, target) in answer.targets.iter().enumerate() {
            let list = if nested {
                &postures[i]
            } else {
                &Value::Array(postures.clone())
            };
            let posture_values = real_values(target);
            for posture in list.as_array().unwrap() {
                let wanted: Vec<f64> = posture
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|x| x.as_f64().unwrap())
                    .collect();
                let nearest = posture_values
                    .iter()
                    .map(|f| apart(f, &wanted))
                    .fold(f64::INFINITY, f64::min);
                assert!(
                    nearest < 1e-5,
                    "{instance}, pose {i}: {wanted:?} is not among {posture_values:?}"
                );
            }
        }
    }
}

#[test]
fn a_general_arm_has_sixteen_postures() {
    check_arm("arm_generic", "arm.json", None);
}

#[test]
fn manseur_and_doty_have_sixteen_real_postures() {
    check_arm("arm_manseur_doty", "arm.json", None);
}

#[test]
fn the_puma_has_eight() {
    check_arm("arm_puma560", "arm.json", None);
}

#[test]
fn the_ur10e_has_eight() {
    check_arm("arm_ur10e", "arm.urdf", None);
}

#[test]
fn the_calibrated_ur10e_has_sixteen() {
    check_arm("arm_ur10e_calibrated", "arm.urdf", None);
}

#[test]
fn a_redundant_arm_wants_a_lock_and_has_eight_with_it() {
    let instance = "arm_7r_iiwa";
    let arm = mechanism(instance, "arm.urdf");
    let targets = poses(instance, &arm);
    let refused = answer(
        &arm,
        &question(Problem::Inverse),
        &targets,
        &AnswerOptions::default(),
    );
    let message = refused.unwrap_err().to_string();
    for word in ["redundant", "7", "--lock"] {
        assert!(message.contains(word), "{message}");
    }
    check_arm(instance, "arm.urdf", Some(("joint_3", 0.3)));
}

fn check_forward(
    instance: &str,
    file: &str,
    inputs_file: &str,
    drive: Option<&[&str]>,
    expected: (u64, u64),
) {
    let mechanism = mechanism(instance, file);
    let names: Vec<String> = match drive {
        Some(names) => names.iter().map(|n| (*n).to_owned()).collect(),
        None => mechanism.inputs.clone(),
    };
    let targets = inputs(instance, inputs_file, &mechanism, &names);
    let question = Question {
        inputs: Some(names),
        ..question(Problem::Forward)
    };
    check(instance, &mechanism, &question, &targets, &[expected]);
}

#[test]
fn platforms_in_the_plane_assemble_in_six_ways() {
    check_forward("three_rpr", "platform.json", "inputs.json", None, (6, 2));
    check_forward("three_rrr", "platform.json", "inputs.json", None, (6, 4));
}

#[test]
fn a_general_platform_assembles_in_forty_ways() {
    check_forward(
        "stewart_generic",
        "platform.json",
        "inputs.json",
        None,
        (40, 4),
    );
}

#[test]
fn an_octahedral_platform_assembles_in_sixteen_ways() {
    check_forward(
        "stewart_octahedral",
        "platform.json",
        "inputs.json",
        None,
        (16, 8),
    );
}

#[test]
fn a_delta_robot_has_two_places_and_eight_postures() {
    check_forward("delta", "platform.json", "inputs.json", None, (2, 2));
    let delta = mechanism("delta", "platform.json");
    let targets = poses("delta", &delta);
    check(
        "delta",
        &delta,
        &question(Problem::Inverse),
        &targets,
        &[(8, 8)],
    );
}

#[test]
fn a_spherical_platform_assembles_in_eight_ways() {
    check_forward(
        "spherical_3rrr",
        "mechanism.json",
        "inputs.json",
        None,
        (8, 4),
    );
}

#[test]
fn a_spatial_four_bar_has_two_positions_and_an_idle_spin() {
    check_forward("rssr", "mechanism.json", "inputs.json", None, (2, 2));
    let rssr = mechanism("rssr", "mechanism.json");
    let graph = rssr.graph();
    assert_eq!(
        (rssr.gruebler(), graph.idle, rssr.expected_mobility()),
        (Some(2), 1, Some(1))
    );
}

/// The output of a linkage in space may be a point of a link.
#[test]
fn a_point_of_a_link_in_space_is_the_output() {
    let text = String::from_utf8(content("rssr", "mechanism.json")).expect("a text");
    let with_point = text.replace(
        "\"output\": \"rocker\"",
        "\"output\": {\"link\": \"rocker\", \"point\": [0.5, \"1/3\", -2]}",
    );
    assert_ne!(with_point, text);
    let read = |text: &str| read("rssr.json", text.as_bytes(), &ReadOptions::default());
    let linkage = read(&with_point).unwrap_or_else(|e| panic!("{e}"));
    let names = linkage.inputs.clone();
    let targets = inputs("rssr", "inputs.json", &linkage, &names);
    let asked = question(Problem::Forward);
    let answers = answer(&linkage, &asked, &targets, &AnswerOptions::default());
    let answers = answers.unwrap_or_else(|e| panic!("{e}"));
    let mut positions = answers.targets.iter().flat_map(|target| &target.positions);
    assert!(positions.clone().count() > 0);
    assert!(positions.all(|position| {
        let output = position.configuration.output.expect("the output");
        let mut bodies = position.configuration.bodies.iter();
        let (_, rocker) = bodies
            .find(|(name, _)| **name == *"rocker")
            .expect("a body");
        let point = rocker.point([0.5, 1.0 / 3.0, -2.0].map(Into::into));
        let gap = (0..3).map(|i| (output.position[i] - point[i]).norm_sqr());
        output.rotation == rocker.rotation && gap.fold(0.0, f64::max) < 1e-28
    }));
}

#[test]
fn a_six_bar_depends_on_what_drives_it() {
    check_forward(
        "stephenson",
        "mechanism.json",
        "inputs_A0.json",
        Some(&["A0"]),
        (4, 4),
    );
    check_forward(
        "stephenson",
        "mechanism.json",
        "inputs_D0.json",
        Some(&["D0"]),
        (6, 2),
    );
}

#[test]
fn wunderlichs_framework_has_sixteen_realisations() {
    let framework = mechanism("framework_k33", "framework.json");
    assert_eq!(framework.gruebler(), Some(0));
    check(
        "framework_k33",
        &framework,
        &question(Problem::Forward),
        &[],
        &[(16, 8)],
    );
}

#[test]
fn a_rigid_loop_has_sixteen_assemblies() {
    let rigid = mechanism("closed_6r", "mechanism.json");
    assert_eq!(rigid.gruebler(), Some(0));
    check(
        "closed_6r",
        &rigid,
        &question(Problem::Forward),
        &[],
        &[(16, 2)],
    );
}

/// Mechanisms that only move are counted, and refused where inputs would be needed.
#[test]
fn loops_that_move_are_counted() {
    for (instance, gruebler) in [
        ("bennett", -2),
        ("bricard_line_symmetric", 0),
        ("bricard_orthogonal", 0),
        ("sarrus", 0),
        ("parallelogram", 1),
        ("rhombus", 1),
    ] {
        let moving_loop = mechanism(instance, "mechanism.json");
        assert_eq!(moving_loop.gruebler(), Some(gruebler), "{instance}");
    }
    let bennett = mechanism("bennett", "mechanism.json");
    let refused = answer(
        &bennett,
        &question(Problem::Forward),
        &[],
        &AnswerOptions::default(),
    );
    assert!(refused.unwrap_err().to_string().contains("motion"));
}

#[test]
fn screws_are_refused_with_the_reason() {
    let text = content("helical", "mechanism.json");
    let message = read("mechanism.json", &text, &ReadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("is H") && message.contains("not algebraic"),
        "{message}"
    );
    assert!(
        message.starts_with("mechanism.json:11: joints[0].type: joint screw"),
        "{message}"
    );
}

/// Numbers between -1 and 1.
fn dice(seed: u64) -> impl FnMut() -> f64 {
    use cognate_numeric::random::{Purpose, RandomStream};
    let mut stream = RandomStream::new(seed, Purpose::Test, 0);
    move || 2.0 * stream.uniform() - 1.0
}

fn random_arm(draw: &mut impl FnMut() -> f64, shifts: &[usize]) -> Mechanism {
    let rows: Vec<String> = (1..=6)
        .map(|i| {
            let kind = if shifts.contains(&i) { "P" } else { "R" };
            let [a, d] = [draw(), draw()].map(|x| (x * 500.0).round() / 1000.0);
            let [alpha, theta] = [draw(), draw()].map(|x| (x * 3000.0).round() / 1000.0);
            format!("{{\"name\": \"q{i}\", \"type\": \"{kind}\", \"a\": {a}, \"d\": {d}, \"alpha\": {alpha}, \"theta\": {theta}}}")
        })
        .collect();
    let text = format!(
        "{{\"angles\": \"rad\", \"serial\": {{\"joints\": [{}]}}}}",
        rows.join(", ")
    );
    read("random.json", text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Inverse of forward contains the start; forward of inverse is the pose (by the residual); sixteen always.
/// `MECHANISMS` says how many arms.
#[test]
fn inverse_of_forward_contains_the_start() {
    let wanted = std::env::var("MECHANISMS").ok();
    let arms = wanted.map_or(12, |n| n.parse().expect("MECHANISMS is a number"));
    for seed in 0..arms {
        let mut draw = dice(seed);
        let arm = random_arm(&mut draw, &[]);
        let starts: Vec<Vec<f64>> = (0..3)
            .map(|_| (0..6).map(|_| 3.0 * draw()).collect())
            .collect();
        let Body::Chain(chain) = &arm.body else {
            unreachable!("a chain was written")
        };
        let values = |start: &Vec<f64>| -> Vec<JointValue> {
            start
                .iter()
                .map(|x| JointValue::of_real(*x, true))
                .collect()
        };
        let targets: Vec<Target> = starts
            .iter()
            .map(|s| Target::Pose(chain.tool_pose(&values(s))))
            .collect();
        let options = AnswerOptions {
            seed,
            ..AnswerOptions::default()
        };
        let mechanism_answer =
            answer(&arm, &question(Problem::Inverse), &targets, &options).unwrap();
        assert_eq!(
            mechanism_answer.preparation.here,
            Some(16),
            "arm {seed}: {}",
            mechanism_answer.preparation.reason
        );
        assert!(
            mechanism_answer.settled,
            "arm {seed}: {:?}",
            mechanism_answer.warnings
        );
        for (start, target) in starts.iter().zip(&mechanism_answer.targets) {
            assert_eq!(target.counts.complex, 16, "arm {seed}: {:?}", target.counts);
            let posture_values = real_values(target);
            let nearest = posture_values
                .iter()
                .map(|q| apart(q, start))
                .fold(f64::INFINITY, f64::min);
            assert!(
                nearest < 1e-6,
                "arm {seed}: {start:?} is not among {posture_values:?}"
            );
            let worst = target
                .positions
                .iter()
                .map(|p| p.configuration.residual)
                .fold(0.0, f64::max);
            assert!(worst < 1e-9, "arm {seed}: {worst:e}");
        }
    }
}

/// One platform described as a platform and as links and joints: two rules, and the positions are equal.
#[test]
fn two_rules_give_the_same_positions() {
    let platform = mechanism("three_rrr", "platform.json");
    let [a1, a2, a3] = [[0.0, 0.0], [2.5, 0.1], [0.9, 2.2]];
    let cranks = [0.9, 0.8, 1.0];
    let rods = [1.539795, 2.127633, 0.671773];
    let heads = [[-0.4, -0.2], [0.7, -0.1], [0.1, 0.6]];
    let mut joints = Vec::new();
    let mut links = vec!["ground".to_owned(), "platform".to_owned()];
    for k in 0..3 {
        let n = k + 1;
        links.extend([format!("crank{n}"), format!("rod{n}")]);
        let [x, y] = [a1, a2, a3][k];
        let [p, q] = heads[k];
        let (crank, rod) = (cranks[k], rods[k]);
        joints.push(format!(
            "{{\"name\": \"th{n}\", \"type\": \"R\", \"links\": [\"ground\", \"crank{n}\"], \
             \"in\": {{\"ground\": {{\"point\": [{x}, {y}]}}, \"crank{n}\": {{\"point\": [0, 0]}}}}}}"
        ));
        joints.push(format!(
            "{{\"name\": \"b{n}\", \"type\": \"R\", \"links\": [\"crank{n}\", \"rod{n}\"], \
             \"in\": {{\"crank{n}\": {{\"point\": [{crank}, 0]}}, \"rod{n}\": {{\"point\": [0, 0]}}}}}}"
        ));
        joints.push(format!(
            "{{\"name\": \"c{n}\", \"type\": \"R\", \"links\": [\"rod{n}\", \"platform\"], \
             \"in\": {{\"rod{n}\": {{\"point\": [{rod}, 0]}}, \"platform\": {{\"point\": [{p}, {q}]}}}}}}"
        ));
    }
    let links: Vec<String> = links.iter().map(|l| format!("\"{l}\"")).collect();
    let text = format!(
        "{{\"space\": \"planar\", \"angles\": \"rad\", \"links\": [{}], \"joints\": [{}], \
         \"inputs\": [\"th1\", \"th2\", \"th3\"], \"output\": \"platform\"}}",
        links.join(", "),
        joints.join(", ")
    );
    let linkage = read("linkage.json", text.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(
        (linkage.space, linkage.gruebler()),
        (Space::Planar, Some(3))
    );
    let names = platform.inputs.clone();
    let targets = inputs("three_rrr", "inputs.json", &platform, &names);
    let options = AnswerOptions {
        seed: 1,
        ..AnswerOptions::default()
    };
    let outputs = |mechanism: &Mechanism| -> Vec<[f64; 3]> {
        let mechanism_answer =
            answer(mechanism, &question(Problem::Forward), &targets, &options).unwrap();
        assert_eq!(
            (
                mechanism_answer.targets[0].counts.complex,
                mechanism_answer.settled
            ),
            (6, true),
            "{:?}",
            mechanism_answer.warnings
        );
        let positions = mechanism_answer.targets[0]
            .positions
            .iter()
            .filter(|p| p.is_real);
        let mut outputs: Vec<[f64; 3]> = positions
            .map(|p| p.configuration.output.unwrap())
            .map(|o| [o.position[0].re, o.position[1].re, o.rotation[1][0].re])
            .collect();
        outputs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        outputs
    };
    let (first, second) = (outputs(&platform), outputs(&linkage));
    assert_eq!((first.len(), second.len()), (4, 4));
    for (a, b) in first.iter().zip(&second) {
        let apart = a
            .iter()
            .zip(b)
            .map(|(x, y)| (x - y).abs())
            .fold(0.0, f64::max);
        assert!(apart < 1e-8, "{a:?} and {b:?}");
    }
}

/// One shift leaves sixteen postures, two eight, wherever they are in the chain; the start is among them.
#[test]
fn chains_with_shifts_reach_their_poses() {
    for (seed, shifts, expected) in [
        (1, &[3][..], 16),
        (2, &[1], 16),
        (3, &[6], 16),
        (4, &[2, 3], 8),
        (5, &[1, 3], 8),
        (6, &[2, 4, 6], 2),
    ] {
        let mut draw = dice(100 + seed);
        let arm = random_arm(&mut draw, shifts);
        let start: Vec<f64> = (0..6).map(|_| draw()).collect();
        let Body::Chain(chain) = &arm.body else {
            unreachable!("a chain was written")
        };
        let joints = start.iter().zip(&chain.joints);
        let values: Vec<JointValue> = joints
            .map(|(x, j)| JointValue::of_real(*x, j.is_angle))
            .collect();
        let targets = [Target::Pose(chain.tool_pose(&values))];
        let options = AnswerOptions {
            seed,
            ..AnswerOptions::default()
        };
        let asked = answer(&arm, &question(Problem::Inverse), &targets, &options);
        let mechanism_answer = match asked {
            Ok(mechanism_answer) => mechanism_answer,
            Err(e) => {
                assert!(
                    shifts.len() == 3 && e.to_string().contains("three apart"),
                    "{e}"
                );
                continue;
            }
        };
        assert_eq!(
            (mechanism_answer.preparation.here, mechanism_answer.settled),
            (Some(expected), true),
            "{shifts:?}: {:?}",
            mechanism_answer.warnings
        );
        let positions = mechanism_answer.targets[0]
            .positions
            .iter()
            .filter(|p| p.is_real);
        let nearest = positions
            .map(|p| {
                let pairs = p.configuration.values.iter().zip(&start);
                pairs
                    .map(|((_, v), x)| (v.real() - x).abs())
                    .fold(0.0, f64::max)
            })
            .fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-6, "{shifts:?}: {nearest}");
    }
}

/// An entry of the cache equals the solution that was found, with all bits; a damaged entry is named and made again.
#[test]
fn a_prepared_mechanism_is_kept_and_checked() {
    let instance = "arm_puma560";
    let arm = mechanism(instance, "arm.json");
    let targets = poses(instance, &arm);
    let folder = tempfile::tempdir().unwrap();
    let options = AnswerOptions {
        seed: 3,
        cache: Some(folder.path().to_owned()),
        ..AnswerOptions::default()
    };
    let ask = || answer(&arm, &question(Problem::Inverse), &targets, &options).unwrap();
    let first = ask();
    assert!(!first.preparation.from_cache && first.warnings.is_empty());
    let second = ask();
    assert!(second.preparation.from_cache, "{:?}", second.warnings);
    assert_eq!(first.targets, second.targets);
    assert_eq!(first.preparation.reason, second.preparation.reason);
    let entries: Vec<PathBuf> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    let [entry] = &entries[..] else {
        panic!("one mechanism was prepared: {entries:?}");
    };
    let content = std::fs::read_to_string(entry).unwrap();
    std::fs::write(entry, content.replacen("0.", "0.1", 1)).unwrap();
    let third = ask();
    assert!(!third.preparation.from_cache);
    assert!(
        third.warnings[0].contains("damaged"),
        "{:?}",
        third.warnings
    );
    assert_eq!(first.targets, third.targets);
    assert!(ask().preparation.from_cache, "it was made again");
    let other = AnswerOptions { seed: 4, ..options };
    let other = answer(&arm, &question(Problem::Inverse), &targets, &other).unwrap();
    assert!(
        !other.preparation.from_cache,
        "another seed has another member"
    );
}

/// An answer to a target depends neither on threads nor on neighbours.
#[test]
fn a_target_has_one_answer_in_any_company() {
    let instance = "arm_generic";
    let arm = mechanism(instance, "arm.json");
    let seven = poses(instance, &arm);
    let many: Vec<Target> = seven.iter().cycle().take(70).cloned().collect();
    let ask = |targets: &[Target], threads: usize| {
        let options = AnswerOptions {
            seed: 1,
            threads,
            ..AnswerOptions::default()
        };
        answer(&arm, &question(Problem::Inverse), targets, &options).unwrap()
    };
    let together = ask(&many, 2);
    for (k, target) in seven.iter().enumerate() {
        let alone = ask(std::slice::from_ref(target), 1);
        assert_eq!(alone.targets[0], together.targets[k], "pose {k}");
        assert_eq!(alone.targets[0], together.targets[63 + k], "pose {k} again");
    }
}

fn follow_path(mechanism: &Mechanism, problem: Problem, samples: Vec<Sample>) -> Path {
    let options = AnswerOptions {
        seed: 1,
        ..AnswerOptions::default()
    };
    let asked = Question {
        inputs: (problem == Problem::Forward).then(|| mechanism.inputs.clone()),
        ..question(problem)
    };
    let prepared =
        PreparedMechanism::new(mechanism, &asked, &options).unwrap_or_else(|e| panic!("{e}"));
    follow(&prepared, samples).unwrap_or_else(|e| panic!("{e}"))
}

/// Ground 4, crank 3, coupler and rocker 2.5 each: stretched where the crank stands upright, since 3, 4, 5 is a
/// right-angled triangle. There both assemblies vanish, and come back on the way back.
#[test]
fn a_four_bar_folds_where_it_is_stretched() {
    let text = r#"{"space": "planar", "angles": "rad", "links": ["ground", "crank", "coupler", "rocker"], "joints": [
        {"name": "A0", "type": "R", "links": ["ground", "crank"], "in": {"ground": {"point": [0, 0]}, "crank": {"point": [0, 0]}}},
        {"name": "A", "type": "R", "links": ["crank", "coupler"], "in": {"crank": {"point": [3, 0]}, "coupler": {"point": [0, 0]}}},
        {"name": "B", "type": "R", "links": ["coupler", "rocker"], "in": {"coupler": {"point": [2.5, 0]}, "rocker": {"point": [2.5, 0]}}},
        {"name": "B0", "type": "R", "links": ["rocker", "ground"], "in": {"rocker": {"point": [0, 0]}, "ground": {"point": [4, 0]}}}],
        "inputs": ["A0"], "output": "coupler"}"#;
    let linkage = read("four_bar.json", text.as_bytes(), &ReadOptions::default()).unwrap();
    let keys = [0.5, 2.0, 0.5].map(|x| Target::Inputs(vec![x]));
    let path = follow_path(
        &linkage,
        Problem::Forward,
        samples(&keys, Some(41), 1.0, &[true]),
    );
    assert!(path.settled, "{:?}", path.warnings);
    assert_eq!((path.branches.len(), path.folds.len()), (4, 2));
    let at = 20.0 * (PI / 2.0 - 0.5) / 1.5;
    for (fold, expected, vanish) in [(0, at, true), (1, 40.0 - at, false)] {
        let fold = &path.folds[fold];
        assert!((fold.at - expected).abs() < 1e-2, "{fold:?}, {expected}");
        assert_eq!((fold.vanish, fold.branches.len()), (vanish, 2));
    }
    for branch in &path.branches {
        let from_path = branch
            .ends
            .iter()
            .filter(|e| **e == BranchEnd::Path)
            .count();
        assert_eq!(from_path, 1, "{branch:?}");
    }
}

/// A path of a general arm and back: what ends does so at a proved fold, and each branch comes back as it went.
#[test]
fn branches_of_an_arm_end_at_proved_folds_only() {
    let instance = "arm_generic";
    let arm = mechanism(instance, "arm.json");
    let seven = poses(instance, &arm);
    let keys = [seven[1].clone(), seven[6].clone()];
    let there = samples(&keys, Some(21), 1.0, &[]);
    let back = there[..4].iter().rev();
    let both: Vec<Sample> = there[..5].iter().chain(back).cloned().collect();
    let path = follow_path(&arm, Problem::Inverse, both);
    assert!(path.settled, "{:?}", path.warnings);
    assert!(path.changes.is_empty(), "{:?}", path.changes);
    assert_eq!(path.folds.len(), 2, "{:?}", path.folds);
    assert!(path.folds.iter().all(|f| f.error.is_some_and(|e| e < 1e-6)));
    let real = |k: usize| path.answers[k].counts.real as usize;
    let mut through = vec![0; path.samples.len()];
    for branch in &path.branches {
        assert!(!branch.ends.contains(&BranchEnd::Unknown));
        (branch.first..=branch.last()).for_each(|k| through[k] += 1);
    }
    for (k, through) in through.into_iter().enumerate() {
        assert_eq!(
            through,
            real(k),
            "each position is on one branch: sample {k}"
        );
    }
    let whole = path.branches.iter().filter(|b| b.positions.len() == 9);
    assert_eq!(whole.count(), 2);
}

#[test]
fn loops_whose_rows_leap_are_not_followed() {
    let arm = random_arm(&mut dice(5), &[]);
    let asked = question(Problem::Forward);
    let prepared = PreparedMechanism::new(&arm, &asked, &AnswerOptions::default()).unwrap();
    let refused = follow(&prepared, Vec::new()).unwrap_err().to_string();
    assert!(refused.contains("closed form"), "{refused}");
}
