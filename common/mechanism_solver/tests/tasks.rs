//! Tasks: parts of poses for chains with fewer joints than a pose has freedoms, and arms of three turns and three shifts. The
//! postures that are expected come from formulas for these arms.

use cognate_kinematics::compile::{Problem, Question, Target};
use cognate_kinematics::mechanism::chain::{Chain, JointValue};
use cognate_kinematics::mechanism::exact::Angle;
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::task::Task;
use cognate_kinematics::mechanism::{Body, Mechanism, ReadOptions, read};
use cognate_mechanism_solver::follow::follow;
use cognate_mechanism_solver::follow::samples::samples;
use cognate_mechanism_solver::sweep::{Sweep, sample_values};
use cognate_mechanism_solver::{AnswerOptions, Postures, PreparedMechanism};
use cognate_numeric::random::{Purpose, RandomStream};

fn arm(table: &str) -> Mechanism {
    let text = format!("# angles: deg\n# convention: standard\ntype,theta,d,a,alpha\n{table}");
    read("arm.csv", text.as_bytes(), &ReadOptions::default()).expect("a table of this test")
}

fn chain(arm: &Mechanism) -> &Chain {
    match &arm.body {
        Body::Chain(chain) => chain,
        _ => panic!("a table is a chain"),
    }
}

fn answers(arm: &Mechanism, task: Task, poses: &[Pose]) -> Vec<Postures> {
    let question = Question {
        task,
        ..Question::of(Problem::Inverse)
    };
    let prepared = PreparedMechanism::new(arm, &question, &AnswerOptions::default());
    let prepared = prepared.unwrap_or_else(|e| panic!("{}: {e}", task.name()));
    prepared
        .inverse(poses)
        .unwrap_or_else(|e| panic!("{}: {e}", task.name()))
}

/// Joint values at random: turns in (-180, 180) degrees, shifts in (0, 1).
fn random_values(chain: &Chain, random: &mut RandomStream) -> Vec<JointValue> {
    let joints = chain.joints.iter();
    joints
        .map(|joint| {
            let x = random.uniform();
            match joint.is_angle {
                true => JointValue::of_real((2.0 * x - 1.0) * 3.1, true),
                false => JointValue::of_real(x, false),
            }
        })
        .collect()
}

/// The part of a pose that a task gives, as numbers.
fn part(task: Task, pose: &Pose) -> Vec<f64> {
    let completed = task.completed(pose).expect("a pose with a yaw");
    let position = completed.position.map(|x| x.re);
    let column = |j: usize| completed.column(j).map(|x| x.re);
    match task {
        Task::Pose => [position, column(0), column(2)].concat(),
        Task::Position => position.to_vec(),
        Task::Pointing => [position, column(2)].concat(),
        Task::XyzYaw | Task::Planar => [position, column(0)].concat(),
    }
}

const LEG: &str = "R,0,0.1,0.05,90\nR,0,0,0.3,0\nR,0,0.02,0.28,0\n";
const GENERAL_LEG: &str = "R,0,0.1,0.05,70\nR,0,0.07,0.3,-50\nR,0,0.02,0.28,0\n";
const SCARA: &str = "R,0,0.4,0.225,0\nR,0,0,0.275,180\nP,0,0,0,0\nR,0,0.05,0,0\n";
const TILTED_SCARA: &str = "R,0,0.4,0.225,20\nR,0,0,0.275,180\nP,0,0,0,0\nR,0,0.05,0.04,35\n";
const FIVE: &str = "R,0,0.3,0.05,90\nR,0,0,0.4,0\nR,0,0,0.35,0\nR,0,0,0,90\nR,0,0.1,0.04,30\n";
const GENERAL_FIVE: &str =
    "R,0,0.3,0.05,80\nR,0,0.1,0.4,15\nR,0,0.05,0.35,-40\nR,0,0.1,0.06,90\nR,0,0.1,0.07,30\n";
const PLANAR: &str = "R,0,0,0.5,0\nR,0,0,0.4,0\nR,0,0,0.2,0\n";
const PORTAL: &str = "P,0,0,0,-90\nP,-90,0,0,-90\nP,0,0,0,0\n";
const GANTRY: &str =
    "P,0,0,0,-90\nP,-90,0,0,-90\nP,0,0,0,0\nR,0,0.1,0,90\nR,0,0,0,-90\nR,0,0.08,0,0\n";
const MIXED: &str =
    "P,0,0,0,60\nR,20,0.1,0.2,70\nP,-90,0,0.1,-80\nP,0,0,0,40\nR,0,0.1,0.05,90\nR,0,0.3,0.1,-60\n";
/// Axes that three joints lie apart are in one plane in every posture: all solutions of the equations are singular.
const CYLINDER: &str = "R,0,0,0,0\nP,0,0.2,0,-90\nP,0,0.1,0,0\n";
const CYLINDER_YAW: &str = "R,0,0,0,0\nP,0,0.2,0,-90\nP,0,0.1,0,90\nR,0,0,0,0\n";
const CYLINDER_POINTING: &str =
    "R,0,0,0,0\nP,0,0.2,0,-90\nP,0,0.1,0,0\nR,0,0,0,-90\nR,-90,0,0,-90\n";
const CYLINDER_WRIST: &str =
    "R,0,0,0,0\nP,0,0.2,0,-90\nP,0,0.1,0,0\nR,0,0,0,-90\nR,-90,0,0,-90\nR,0,0.1,0,0\n";

/// The posture that makes a target is among its postures, all of which have the part that is asked for; and there are as many,
/// complex ones too, as the arm's formulas have: two at a hip and two at a knee, two elbows, two flips of a wrist.
#[test]
fn the_posture_that_makes_a_target_is_answered_for_every_task() {
    let mut random = RandomStream::new(3, Purpose::Test, 45);
    for (table, task, complex) in [
        (LEG, Task::Position, 4),
        (GENERAL_LEG, Task::Position, 4),
        (SCARA, Task::XyzYaw, 2),
        (SCARA, Task::Pose, 2),
        (TILTED_SCARA, Task::XyzYaw, 0),
        (FIVE, Task::Pointing, 0),
        (GENERAL_FIVE, Task::Pointing, 0),
        (PLANAR, Task::Planar, 2),
        (PORTAL, Task::Position, 1),
        (GANTRY, Task::Pose, 2),
        (MIXED, Task::Pose, 2),
        (CYLINDER, Task::Position, 2),
        (CYLINDER_YAW, Task::XyzYaw, 2),
        (CYLINDER_POINTING, Task::Pointing, 0),
        (CYLINDER_WRIST, Task::Pose, 4),
    ] {
        let arm = arm(table);
        let chain = chain(&arm);
        let made_by: Vec<Vec<JointValue>> =
            (0..6).map(|_| random_values(chain, &mut random)).collect();
        let poses: Vec<Pose> = made_by.iter().map(|v| chain.tool_pose(v)).collect();
        for ((values, pose), answer) in made_by.iter().zip(&poses).zip(answers(&arm, task, &poses))
        {
            let said = format!(
                "{table}{}: {:?} {:?}",
                task.name(),
                answer.counts,
                answer.warnings
            );
            assert!(answer.settled, "{said}");
            if complex > 0 {
                assert_eq!(answer.counts.complex, complex, "{said}");
            }
            let real: Vec<_> = answer.positions.iter().filter(|p| p.is_real).collect();
            let wanted = part(task, pose);
            for position in &real {
                let output = position.configuration.output.expect("a tool");
                let apart = wanted
                    .iter()
                    .zip(part(task, &output))
                    .map(|(a, b)| (a - b).abs());
                let apart = apart.fold(0.0, f64::max);
                assert!(
                    apart < 1e-9 && position.condition.is_finite(),
                    "{said}: {apart:.1e}"
                );
            }
            let is_it = |position: &&&cognate_mechanism_solver::postures::Position| {
                let pairs = position.configuration.values.iter().zip(values);
                pairs.fold(0.0f64, |most, ((_, a), b)| {
                    let apart = (a.real() - b.real()).abs();
                    most.max(apart.min((apart - 2.0 * std::f64::consts::PI).abs()))
                }) < 1e-8
            };
            assert!(
                real.iter().any(|p| is_it(&p)),
                "{said}: the posture is missing"
            );
        }
    }
}

/// Postures of an arm that its loop alone answers are proved, and followed along a path.
#[test]
fn postures_by_the_loop_alone_are_proved_and_followed() {
    let arm = arm(CYLINDER_WRIST);
    let options = AnswerOptions {
        certify: true,
        ..AnswerOptions::default()
    };
    let prepared = PreparedMechanism::new(&arm, &Question::of(Problem::Inverse), &options);
    let prepared = prepared.unwrap_or_else(|e| panic!("{e}"));
    let tool = |values: [f64; 6]| {
        let values = values.into_iter().zip(&chain(&arm).joints);
        let values = values.map(|(x, joint)| JointValue::of_real(x, joint.is_angle));
        chain(&arm).tool_pose(&values.collect::<Vec<_>>())
    };
    let poses = [
        [0.5, 0.1, 0.2, 0.4, 0.7, -0.3],
        [0.6, 0.12, 0.2, 0.4, 0.8, -0.3],
    ]
    .map(tool);
    for answer in prepared.inverse(&poses).expect("answers") {
        assert_eq!(answer.counts.certified_real, Some(4), "{:?}", answer.counts);
    }
    let path = follow(
        &prepared,
        samples(&poses.map(Target::Pose), Some(3), 1.0, &[]),
    );
    let path = path.unwrap_or_else(|e| panic!("{e}"));
    assert!(path.settled, "{:?}", path.warnings);
    assert_eq!(path.branches.len(), 4);
    assert!(path.branches.iter().all(|b| b.positions.len() == 3));
}

/// A target that cannot be answered is refused by name or is not real; nothing settled is missing.
#[test]
fn targets_that_a_chain_cannot_have_are_told() {
    let leg = arm(LEG);
    let far = answers(&leg, Task::Position, &[Pose::shift(2.0, 0.0, 0.0)]);
    assert_eq!(far[0].counts.real, 0, "{:?}", far[0].counts);
    assert!(
        far[0].warnings.iter().any(|w| w.contains("does not reach")),
        "{:?}",
        far[0]
    );
    let question = |task| Question {
        task,
        ..Question::of(Problem::Inverse)
    };
    let five = arm(FIVE);
    let refused =
        PreparedMechanism::new(&five, &question(Task::Position), &AnswerOptions::default());
    let message = refused
        .err()
        .expect("five joints for three freedoms")
        .to_string();
    assert!(
        message.contains("lock joints") && message.contains("position"),
        "{message}"
    );
    let rolls = arm("R,0,0.3,0.05,90\nR,0,0,0.4,0\nR,0,0,0.35,0\nR,0,0,0,90\nR,0,0.1,0,0\n");
    let refused =
        PreparedMechanism::new(&rolls, &question(Task::Pointing), &AnswerOptions::default());
    let message = refused
        .err()
        .expect("joint 5 is the tool's turn")
        .to_string();
    assert!(message.contains("--lock q5=0"), "{message}");
    let upright = Pose::of_roll_pitch_yaw([0.0, 90.0, 0.0].map(Angle::of_degrees));
    let scara = arm(SCARA);
    let prepared =
        PreparedMechanism::new(&scara, &question(Task::XyzYaw), &AnswerOptions::default());
    let error = prepared
        .expect("it can be prepared")
        .inverse(&[upright])
        .expect_err("no yaw");
    assert!(error.to_string().contains("yaw"), "{error}");
}

/// A stretched leg has one posture twice, and an aligned wrist of a gantry a set along which the first and the last turn.
#[test]
fn special_targets_of_tasks_are_answered() {
    let leg = arm("R,0,0.1,0,90\nR,0,0,0.3,0\nR,0,0,0.28,0\n");
    let stretched = [0.4, 0.3, 0.0].map(|x| JointValue::of_real(x, true));
    let pose = chain(&leg).tool_pose(&stretched);
    let answer = &answers(&leg, Task::Position, &[pose])[0];
    assert!(answer.settled, "{:?} {:?}", answer.counts, answer.warnings);
    let singular: Vec<_> = answer.positions.iter().filter(|p| p.is_real).collect();
    assert!(
        singular.len() == 2
            && singular
                .iter()
                .all(|p| p.is_singular && p.multiplicity == 2)
    );
    let gantry = arm(GANTRY);
    let values: Vec<JointValue> = [0.3, 0.5, 0.2, 0.4, 0.0, -0.9]
        .into_iter()
        .zip(&chain(&gantry).joints)
        .map(|(x, joint)| JointValue::of_real(x, joint.is_angle))
        .collect();
    let answer = &answers(&gantry, Task::Pose, &[chain(&gantry).tool_pose(&values)])[0];
    assert!(answer.settled, "{:?} {:?}", answer.counts, answer.warnings);
    assert_eq!(answer.sets.len(), 1, "{:?}", answer.sets);
    assert_eq!(answer.sets[0].joints, ["q4", "q6"]);
}

/// Every posture that is listed has the yaw that is asked for, those of sets too. Of an arm in a vertical plane whose pitch is
/// free, both the part of the set that has the yaw and the part that points the opposite way are on one curve; of an arm whose
/// tool can point up, postures that do so have no yaw.
#[test]
fn every_listed_posture_has_the_yaw() {
    let palletizer = "R,0,0.4,0.1,90\nR,0,0,0.5,0\nR,0,0,0.5,0\nR,0,0,0.1,-90\n";
    let upright = "R,0,0,0.17,0\nR,0,0,0.26,90\nR,0,-0.2,0.22,0\nR,0,0,0.05,90\n";
    let shifts = "P,0,0,0,-90\nP,-90,0,0,-90\nP,0,0,0,0\nR,0,0,0.05,0\n";
    let at = [
        -0.1444717615265736,
        0.6289990899981357,
        0.005224586302379208,
    ];
    let up = [
        -0.4139735071881941,
        0.25806029738262115,
        -0.15896515777800788,
    ];
    for (table, position, yaw, real, sets) in [
        (palletizer, at, -77.06436892470246, 0, 4),
        (upright, up, -77.89793134160855, 1, 0),
        (shifts, [0.1, 0.2, 0.3], 90.0, 0, 1),
        (shifts, [0.1, 0.2, 0.3], 30.0, 0, 0),
    ] {
        let arm = arm(table);
        let yaw = Angle::of_degrees(yaw);
        let pose = Task::XyzYaw.pose_of(&position, yaw);
        let pose = pose.expect("numbers of this test");
        let answer = &answers(&arm, Task::XyzYaw, &[pose])[0];
        let said = format!("{table}: {:?} {:?}", answer.counts, answer.warnings);
        assert!(answer.settled, "{said}");
        assert_eq!(answer.counts.real, real, "{said}");
        assert_eq!(answer.sets.len(), sets, "{said}");
        for position in answer.positions.iter().filter(|p| p.is_real) {
            let values = position.configuration.values.iter();
            let values: Vec<JointValue> = values.map(|(_, value)| *value).collect();
            let tool = chain(&arm).tool_pose(&values);
            let apart = part(Task::XyzYaw, &tool);
            let apart = apart.iter().zip(part(Task::XyzYaw, &pose));
            let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-9, "{said}: {apart:.1e}");
        }
        for set in &answer.sets {
            let half_a_turn = |(name, span): &(String, f64)| {
                !name.starts_with("pitch") || *span < 1.01 * std::f64::consts::PI
            };
            assert!(set.spans.iter().all(half_a_turn), "{said}: {:?}", set.spans);
        }
    }
}

/// The point that a file names as output counts: of an arm's last link, of a link of a loop, and of a platform, both ways.
#[test]
fn the_point_of_an_output_counts() {
    let read = |text: &str| {
        read("m.json", text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
    };
    let prepared = |mechanism, problem| {
        PreparedMechanism::new(mechanism, &Question::of(problem), &AnswerOptions::default())
            .unwrap_or_else(|e| panic!("{e}"))
    };
    let output = |answers: &[Postures]| {
        answers[0].positions[0]
            .configuration
            .output
            .expect("an output")
    };
    let arm = |rest: &str| {
        let joints =
            r#"[{"name": "q1", "a": 0.3, "alpha": 40}, {"name": "q2", "a": 0.2, "d": 0.1}]"#;
        read(&format!(
            r#"{{"angles": "deg", "serial": {{"joints": {joints}{rest}}}"#
        ))
    };
    let by_tool = arm(r#", "tool": {"position": [0.1, 0.2, 0.3]}}"#);
    let by_output = arm(r#"}, "output": {"link": "link2", "point": [0.1, 0.2, 0.3]}"#);
    let poses = [&by_tool, &by_output].map(|arm| {
        let answers = prepared(arm, Problem::Forward).forward(&[vec![0.3, -0.8]]);
        output(&answers.expect("a closed form"))
    });
    assert_eq!(poses[0], poses[1]);

    let platform = read(
        r#"{"space": "planar", "platform": {"base": {"A": [0, 0], "B": [2, 0], "C": [1, 2]},
            "moving": {"a": [0, 0], "b": [1, 0], "c": [0.4, 0.8]},
            "legs": [{"name": "L1", "from": "A", "to": "a", "type": "RPR"}, {"name": "L2", "from": "B", "to": "b", "type": "RPR"},
                     {"name": "L3", "from": "C", "to": "c", "type": "RPR"}]},
            "output": {"link": "platform", "point": [0.5, 0.25]}}"#,
    );
    let [c, s] = Angle::of_degrees(20.0).direction;
    let pose = Pose {
        position: [0.9.into(), 0.6.into(), 0.0.into()],
        ..Pose::about_z(c.into(), s.into())
    };
    let inverse = prepared(&platform, Problem::Inverse)
        .inverse(&[pose])
        .expect("a closed form");
    let lengths: Vec<f64> = inverse[0].positions[0]
        .configuration
        .values
        .iter()
        .map(|(_, v)| v.real())
        .collect();
    // The first leg ends at the body's origin, which is the output's place less the turned point.
    let origin = [0.9 - 0.5 * c + 0.25 * s, 0.6 - 0.5 * s - 0.25 * c];
    assert!((lengths[0] - (origin[0] * origin[0] + origin[1] * origin[1]).sqrt()).abs() < 1e-12);
    let forward = prepared(&platform, Problem::Forward)
        .forward(&[lengths])
        .expect("positions");
    let outputs = forward[0]
        .positions
        .iter()
        .filter_map(|p| p.configuration.output);
    let nearest = outputs
        .map(|other| other.distance(&pose, 1.0))
        .fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-9, "{nearest:.1e}");
}

/// A redundant arm at values of one of its joints: as many answers, each with that joint's value.
#[test]
fn a_joint_of_a_redundant_arm_is_swept() {
    let table = "R,0,0.34,0,-90\nR,0,0,0,90\nR,0,0.4,0,90\nR,0,0,0,-90\nR,0,0.4,0,-90\nR,0,0,0,90\nR,0,0.126,0,0\n";
    let iiwa = arm(table);
    let values: Vec<JointValue> = [0.3, 0.5, -0.4, -1.1, 0.7, 0.9, 0.2]
        .into_iter()
        .map(|x| JointValue::of_real(x, true))
        .collect();
    let pose = chain(&iiwa).tool_pose(&values);
    let at = sample_values(&iiwa, "q3", 8).expect("a joint that turns");
    assert!(at.len() == 8 && (at[4]).abs() < 1e-15);
    let question = Question::of(Problem::Inverse);
    let sweep =
        Sweep::new(&iiwa, &question, &AnswerOptions::default(), ("q3", &at)).expect("an arm");
    let answers = sweep
        .solve(&[Target::Pose(pose), Target::Pose(pose)])
        .expect("answers");
    assert_eq!(answers.len(), 16);
    for (answer, value) in answers.iter().zip(at.iter().chain(&at)) {
        assert_eq!(answer.held, [("q3".to_owned(), *value)]);
        for position in answer.positions.iter().filter(|p| p.is_real) {
            let (_, q3) = &position.configuration.values[2];
            assert!(
                (q3.real() - value).abs() < 1e-12 || (q3.real().abs() - value.abs()).abs() < 1e-12
            );
        }
    }
    assert!(answers.iter().any(|answer| answer.counts.real > 0));
    let none = sample_values(&iiwa, "q9", 8).expect_err("no such joint");
    assert!(none.to_string().contains("q1, q2"), "{none}");
}
