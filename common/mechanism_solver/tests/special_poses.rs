//! Arms at poses as people choose them: joints at right angles, elbows stretched, wrists aligned. The posture that makes a
//! pose is known: it is among the answers, within the accuracy of a singular one, or on a set that is answered; or the
//! answer is in doubt.

use cognate_kinematics::compile::{Problem, Question, Target};
use cognate_kinematics::mechanism::chain::{Chain, JointValue};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Body, Mechanism, ReadOptions, read};
use cognate_kinematics::real_arm::RealArm;
use cognate_mechanism_solver::follow::samples::samples;
use cognate_mechanism_solver::follow::{BranchEnd, follow};
use cognate_mechanism_solver::postures::Postures;
use cognate_mechanism_solver::{AnswerOptions, PreparedMechanism};
use cognate_numeric::random::{Purpose, RandomStream};

/// A row of an arm.
type Row = (char, f64, f64, f64);
/// An arm that is tried: its name, its rows, and a joint that is held by its number and value in degrees.
type Tried<'a> = (&'a str, &'a [Row], Option<(usize, f64)>);

/// Rows of vendors and textbooks: type, d or its beginning, a, alpha; lengths in metres, angles in degrees.
const ARMS: [(&str, [Row; 6]); 8] = [
    (
        "UR5e",
        [
            ('R', 0.1625, 0.0, 90.0),
            ('R', 0.0, -0.425, 0.0),
            ('R', 0.0, -0.3922, 0.0),
            ('R', 0.1333, 0.0, 90.0),
            ('R', 0.0997, 0.0, -90.0),
            ('R', 0.0996, 0.0, 0.0),
        ],
    ),
    (
        "UR10e",
        [
            ('R', 0.1807, 0.0, 90.0),
            ('R', 0.0, -0.6127, 0.0),
            ('R', 0.0, -0.57155, 0.0),
            ('R', 0.17415, 0.0, 90.0),
            ('R', 0.11985, 0.0, -90.0),
            ('R', 0.11655, 0.0, 0.0),
        ],
    ),
    (
        "PUMA 560",
        [
            ('R', 0.0, 0.0, 90.0),
            ('R', 0.0, 0.4318, 0.0),
            ('R', 0.15, 0.0203, -90.0),
            ('R', 0.4318, 0.0, 90.0),
            ('R', 0.0, 0.0, -90.0),
            ('R', 0.0, 0.0, 0.0),
        ],
    ),
    (
        "IRB 140",
        [
            ('R', 0.352, 0.07, -90.0),
            ('R', 0.0, 0.36, 0.0),
            ('R', 0.0, 0.0, -90.0),
            ('R', 0.38, 0.0, 90.0),
            ('R', 0.0, 0.0, -90.0),
            ('R', 0.065, 0.0, 0.0),
        ],
    ),
    (
        "KR 6",
        [
            ('R', 0.4, 0.025, -90.0),
            ('R', 0.0, 0.455, 0.0),
            ('R', 0.0, 0.035, -90.0),
            ('R', 0.42, 0.0, 90.0),
            ('R', 0.0, 0.0, -90.0),
            ('R', 0.08, 0.0, 0.0),
        ],
    ),
    (
        "Stanford",
        [
            ('R', 0.412, 0.0, -90.0),
            ('R', 0.154, 0.0, 90.0),
            ('P', 0.3, 0.0, 0.0),
            ('R', 0.0, 0.0, -90.0),
            ('R', 0.0, 0.0, 90.0),
            ('R', 0.263, 0.0, 0.0),
        ],
    ),
    (
        "CRX-10iA",
        [
            ('R', 0.0, 0.0, -90.0),
            ('R', 0.0, 0.54, 0.0),
            ('R', 0.0, 0.0, -90.0),
            ('R', 0.54, 0.0, 90.0),
            ('R', -0.15, 0.0, -90.0),
            ('R', 0.16, 0.0, 0.0),
        ],
    ),
    (
        "Jaco",
        [
            ('R', 0.2755, 0.0, 90.0),
            ('R', 0.0, 0.41, 180.0),
            ('R', -0.0098, 0.0, 90.0),
            ('R', -0.2501, 0.0, 60.0),
            ('R', -0.0856, 0.0, 60.0),
            ('R', -0.2028, 0.0, 180.0),
        ],
    ),
];

/// Arms of the long run.
#[rustfmt::skip]
const MORE_ARMS: [(&str, [Row; 6]); 9] = [
    ("UR3", [('R', 0.1519, 0.0, 90.0), ('R', 0.0, -0.24365, 0.0), ('R', 0.0, -0.21325, 0.0), ('R', 0.11235, 0.0, 90.0), ('R', 0.08535, 0.0, -90.0), ('R', 0.0819, 0.0, 0.0)]),
    ("IRB 1600", [('R', 0.4865, 0.15, -90.0), ('R', 0.0, 0.475, 0.0), ('R', 0.0, 0.0, -90.0), ('R', 0.6, 0.0, 90.0), ('R', 0.0, 0.0, -90.0), ('R', 0.065, 0.0, 0.0)]),
    ("xArm6", [('R', 0.267, 0.0, -90.0), ('R', 0.0, 0.28949, 0.0), ('R', 0.0, 0.0775, -90.0), ('R', 0.3425, 0.0, 90.0), ('R', 0.0, 0.076, -90.0), ('R', 0.097, 0.0, 0.0)]),
    ("PiPER", [('R', 0.123, 0.0, -90.0), ('R', 0.0, 0.28503, 0.0), ('R', 0.0, -0.02198, 90.0), ('R', 0.25075, 0.0, -90.0), ('R', 0.0, 0.0, 90.0), ('R', 0.091, 0.0, 0.0)]),
    ("Staubli TX90", [('R', 0.478, 0.05, -90.0), ('R', 0.0, 0.425, 0.0), ('R', 0.05, 0.0, 90.0), ('R', 0.425, 0.0, -90.0), ('R', 0.0, 0.0, 90.0), ('R', 0.1, 0.0, 0.0)]),
    ("Motoman HC10", [('R', 0.275, 0.0, 90.0), ('R', 0.0, 0.7, 0.0), ('R', 0.0, 0.0, 90.0), ('R', 0.5, 0.0, -90.0), ('R', 0.162, 0.0, 90.0), ('R', 0.13, 0.0, 0.0)]),
    ("Doosan M0609", [('R', 0.135, 0.0, -90.0), ('R', 0.0062, 0.411, 0.0), ('R', 0.0, 0.0, 90.0), ('R', 0.368, 0.0, -90.0), ('R', 0.0, 0.0, 90.0), ('R', 0.121, 0.0, 0.0)]),
    ("LR Mate 200iD", [('R', 0.0, 0.05, -90.0), ('R', 0.0, 0.33, 180.0), ('R', 0.0, 0.035, -90.0), ('R', -0.335, 0.0, 90.0), ('R', 0.0, 0.0, -90.0), ('R', -0.08, 0.0, 180.0)]),
    ("Jaco spherical", [('R', 0.2755, 0.0, 90.0), ('R', 0.0, 0.41, 180.0), ('R', -0.0098, 0.0, 90.0), ('R', -0.3111, 0.0, 90.0), ('R', 0.0, 0.0, 90.0), ('R', -0.2638, 0.0, 180.0)]),
];
/// Redundant arms with a joint that is held: its number and value in degrees.
#[rustfmt::skip]
const REDUNDANT: [(&str, [Row; 7], (usize, f64)); 3] = [
    ("iiwa 14", [('R', 0.36, 0.0, -90.0), ('R', 0.0, 0.0, 90.0), ('R', 0.42, 0.0, 90.0), ('R', 0.0, 0.0, -90.0), ('R', 0.4, 0.0, -90.0), ('R', 0.0, 0.0, 90.0), ('R', 0.126, 0.0, 0.0)], (2, 30.0)),
    ("Panda", [('R', 0.333, 0.0, -90.0), ('R', 0.0, 0.0, 90.0), ('R', 0.316, 0.0825, 90.0), ('R', 0.0, -0.0825, -90.0), ('R', 0.384, 0.0, 90.0), ('R', 0.0, 0.088, 90.0), ('R', 0.107, 0.0, 0.0)], (6, 45.0)),
    ("Gen3", [('R', -0.2848, 0.0, 90.0), ('R', -0.0118, 0.0, 90.0), ('R', -0.4208, 0.0, 90.0), ('R', -0.0128, 0.0, 90.0), ('R', -0.3143, 0.0, 90.0), ('R', 0.0, 0.0, 90.0), ('R', -0.1674, 0.0, 180.0)], (2, 0.0)),
];

fn arm(rows: &[Row]) -> Mechanism {
    let mut table = String::from("# convention: standard\n# angles: deg\ntype,theta,d,a,alpha\n");
    for (kind, d, a, alpha) in rows {
        table.push_str(&format!("{kind},0,{d},{a},{alpha}\n"));
    }
    let options = ReadOptions::default();
    read("arm.csv", table.as_bytes(), &options).expect("a table of this test")
}

fn inverse() -> Question {
    Question::of(Problem::Inverse)
}

fn chain(arm: &Mechanism) -> &Chain {
    match &arm.body {
        Body::Chain(chain) => chain,
        _ => panic!("a table is a chain"),
    }
}

/// Numbers of poses, by the kind of answer.
#[derive(Debug, Default)]
struct Tally {
    regular: usize,
    singular: usize,
    on_sets: usize,
    in_doubt: Vec<String>,
    wrong: Vec<String>,
}

impl Tally {
    fn note(&mut self, chain: &Chain, made_by: &[JointValue], pose: &Pose, answer: &Postures) {
        let arm = RealArm::of(chain);
        let real = answer.positions.iter().filter(|p| p.is_real);
        let mut nearest = f64::INFINITY;
        let (mut at_regular, mut at_singular) = (false, false);
        for position in real {
            let values: Vec<JointValue> =
                position.configuration.values.iter().map(|v| v.1).collect();
            let apart = arm.distance(&values, made_by);
            nearest = nearest.min(apart);
            at_regular |= !position.is_singular && apart < 1e-6;
            at_singular |= position.is_singular && apart < 1e-4;
            let gap = arm.gap_at(&values, pose);
            if gap > 1e-9 {
                self.wrong
                    .push(format!("{made_by:?}: an answer is {gap} away"));
            }
        }
        let on_set = answer.sets.iter().any(|set| {
            let moved = set.posture.configuration.values.iter();
            let names = moved.map(|(name, value)| (name.to_string(), *value));
            let fixed = names
                .zip(made_by)
                .filter(|((name, _), _)| !set.joints.contains(name));
            let mut apart = fixed.map(|((_, value), made)| arm.distance(&[value], &[*made]));
            apart.all(|x| x < 1e-4)
        });
        if at_regular {
            self.regular += 1;
        } else if at_singular {
            self.singular += 1;
        } else if on_set {
            self.on_sets += 1;
        }
        if !answer.settled {
            let said = format!("{:?} {:?}", answer.counts, answer.warnings);
            self.in_doubt.push(said);
        } else if !(at_regular || at_singular || on_set) {
            let degrees: Vec<f64> = made_by.iter().map(|v| v.real().to_degrees()).collect();
            self.wrong.push(format!(
                "{degrees:.2?}: nearest {nearest}: {:?} {}",
                answer.counts,
                answer.sets.len()
            ));
        }
    }
}

/// Counts of the answers at the poses of these postures. If the arm has a seventh joint it is held: by number, in
/// degrees.
fn tally(name: &str, rows: &[Row], held: Option<(usize, f64)>, postures: &[[f64; 6]]) -> Tally {
    let mechanism = arm(rows);
    let chain = chain(&mechanism);
    let lock = |(k, degrees): (usize, f64)| (chain.joints[k].name.clone(), degrees.to_radians());
    let question = Question {
        locks: held.map(lock).into_iter().collect(),
        ..inverse()
    };
    let prepared = PreparedMechanism::new(&mechanism, &question, &AnswerOptions::default());
    let prepared = prepared.unwrap_or_else(|e| panic!("{name}: {e}"));
    let values = |degrees: &[f64; 6]| -> Vec<JointValue> {
        let mut degrees = degrees.to_vec();
        if let Some((k, value)) = held {
            degrees.insert(k, value);
        }
        let joints = chain.joints.iter().zip(degrees);
        joints
            .map(|(joint, x)| match joint.is_angle {
                true => JointValue::of_real(x.to_radians(), true),
                false => JointValue::of_real(0.1 + x / 900.0, false),
            })
            .collect()
    };
    let made_by: Vec<Vec<JointValue>> = postures.iter().map(values).collect();
    let poses: Vec<Pose> = made_by
        .iter()
        .map(|values| chain.tool_pose(values))
        .collect();
    let answers = prepared
        .inverse(&poses)
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut tally = Tally::default();
    for ((made_by, pose), answer) in made_by.iter().zip(&poses).zip(&answers) {
        tally.note(chain, made_by, pose, answer);
    }
    tally
}

/// Of the 729 postures with joints at -90, 0 and 90 degrees every `step`-th.
fn right_angles(step: usize) -> Vec<[f64; 6]> {
    let digits =
        |n: usize| std::array::from_fn(|k| [-90.0, 0.0, 90.0][n / 3usize.pow(k as u32) % 3]);
    (0..729).step_by(step).map(digits).collect()
}

/// Wrists and elbows at special angles, the other joints anywhere.
fn aligned(count: usize) -> Vec<[f64; 6]> {
    let mut random = RandomStream::new(5, Purpose::Test, 44);
    let mut angle = || 360.0 * random.uniform() - 180.0;
    let posture = |n: usize| {
        let mut posture: [f64; 6] = std::array::from_fn(|_| angle());
        for (bit, joint) in [(1, 2), (2, 4), (4, 3)] {
            if n & bit != 0 {
                posture[joint] = if n & 8 == 0 { 0.0 } else { 90.0 };
            }
        }
        posture
    };
    (0..count).map(posture).collect()
}

/// Every 41st of the 729 postures at right angles, and 25 that are aligned; `COGNATE_LONG` takes all, and 416, of more arms.
#[test]
fn the_posture_that_makes_a_special_pose_is_answered() {
    let step = match std::env::var_os("COGNATE_LONG") {
        Some(_) => 1,
        None => 41,
    };
    let mut arms: Vec<Tried<'_>> = Vec::new();
    arms.extend(ARMS.iter().map(|(name, rows)| (*name, &rows[..], None)));
    let redundant = REDUNDANT.iter();
    let redundant = redundant.map(|(name, rows, held)| (*name, &rows[..], Some(*held)));
    match step {
        1 => {
            arms.extend(
                MORE_ARMS
                    .iter()
                    .map(|(name, rows)| (*name, &rows[..], None)),
            );
            arms.extend(redundant);
        }
        _ => arms.extend(redundant.take(1)),
    }
    for (name, rows, held) in arms {
        for postures in [right_angles(step), aligned(400 / step + 16)] {
            let tally = tally(name, rows, held, &postures);
            let answered = tally.regular + tally.singular + tally.on_sets;
            assert!(tally.wrong.is_empty(), "{name}: {:#?}", tally.wrong);
            // Of arms with a joint that is held one pose in twenty may be in doubt.
            let doubts = if held.is_some() {
                postures.len() / 20 + 1
            } else {
                0
            };
            assert!(
                tally.in_doubt.len() <= doubts,
                "{name}: {:#?}",
                tally.in_doubt
            );
            assert!(answered + doubts >= postures.len(), "{name}: {tally:?}");
            println!(
                "{name}: {} poses; regular {}, singular {}, on sets {}, in doubt {}",
                postures.len(),
                tally.regular,
                tally.singular,
                tally.on_sets,
                tally.in_doubt.len()
            );
        }
    }
}

/// The sets of an aligned wrist: joints 4 and 6 turn together, once around; and the tool sideways, where axes 3 and 6 are
/// parallel and all eight postures are regular.
#[test]
fn sets_and_regular_postures_are_told_apart() {
    let (_, puma) = ARMS[2];
    let mechanism = arm(&puma);
    let chain = chain(&mechanism);
    let values =
        |degrees: [f64; 6]| degrees.map(|x: f64| JointValue::of_real(x.to_radians(), true));
    let options = AnswerOptions {
        certify: true,
        ..AnswerOptions::default()
    };
    let prepared = PreparedMechanism::new(&mechanism, &inverse(), &options).expect("a PUMA");
    let aligned = chain.tool_pose(&values([20.0, -50.0, 30.0, 40.0, 0.0, -70.0]));
    let sideways = chain.tool_pose(&values([0.0, -30.0, 60.0, 90.0, 90.0, 35.0]));
    let answers = prepared.inverse(&[aligned, sideways]).expect("two poses");
    let counts = &answers[0].counts;
    assert!(
        answers[0].settled && answers[0].sets.len() == 1,
        "{counts:?}"
    );
    assert_eq!((counts.complex, counts.positive_dimensional), (6, 2));
    let set = &answers[0].sets[0];
    assert_eq!((set.dimension, set.is_closed, set.paths), (1, true, 2));
    assert_eq!(set.joints, ["q4", "q6"]);
    for (_, span) in &set.spans {
        assert!(
            (span / (2.0 * std::f64::consts::PI) - 1.0).abs() < 1e-9,
            "{span}"
        );
    }
    let counts = &answers[1].counts;
    assert!(answers[1].settled, "{counts:?}");
    assert_eq!(
        (counts.complex, counts.certified_real),
        (8, Some(counts.real))
    );
    assert!(counts.real >= 4 && answers[1].positions.iter().all(|p| p.condition < 1e3));
}

/// Straight lines of the tool, two of each arm (30 with `COGNATE_LONG`): a branch ends where two meet at a fold, and
/// nowhere else.
#[test]
fn branches_along_straight_lines_are_not_cut() {
    let lines = match std::env::var_os("COGNATE_LONG") {
        Some(_) => 30,
        None => 2,
    };
    let mut random = RandomStream::new(7, Purpose::Test, 45);
    let mut uniform = || 2.0 * random.uniform() - 1.0;
    for (name, rows) in [ARMS[0], ARMS[2], ARMS[3], ARMS[4]] {
        let mechanism = arm(&rows);
        let chain = chain(&mechanism);
        let prepared = PreparedMechanism::new(&mechanism, &inverse(), &AnswerOptions::default());
        let prepared = prepared.unwrap_or_else(|e| panic!("{name}: {e}"));
        for line in 0..lines {
            let turn = |_| JointValue::of_real(std::f64::consts::PI * uniform(), true);
            let values: Vec<JointValue> = (0..6).map(turn).collect();
            let from = chain.tool_pose(&values);
            let mut to = from;
            for x in &mut to.position {
                *x += 0.05 * uniform();
            }
            let keys = [Target::Pose(from), Target::Pose(to)];
            let path = follow(&prepared, samples(&keys, Some(20), 1.0, &[]));
            let path = path.unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(path.settled, "{name}, line {line}: {:?}", path.warnings);
            let ends = path.branches.iter().flat_map(|branch| branch.ends);
            let at_folds = ends.filter(|end| matches!(end, BranchEnd::Fold(_))).count();
            assert_eq!(at_folds, 2 * path.folds.len(), "{name}, line {line}");
        }
    }
}

/// A SCARA with an aligned wrist along a whole line: no posture is isolated, and the path says so.
#[test]
fn a_path_on_which_no_posture_is_isolated_is_not_settled() {
    let table = "# convention: standard\n# angles: deg\ntype,theta,d,a,alpha\nR,0,0.4,0.225,0\nR,0,0,0.275,180\nP,0,0,0,0\n\
        R,0,-0.1,0,90\nR,0,0,0,-90\nR,0,0.08,0,0\n";
    let arm = read("scara.csv", table.as_bytes(), &ReadOptions::default()).expect("a table");
    let prepared = PreparedMechanism::new(&arm, &inverse(), &AnswerOptions::default());
    let prepared = prepared.unwrap_or_else(|e| panic!("{e}"));
    let tool = |values: [f64; 6]| {
        let joints = values.into_iter().zip(&chain(&arm).joints);
        let values: Vec<JointValue> = joints
            .map(|(x, joint)| JointValue::of_real(x, joint.is_angle))
            .collect();
        Target::Pose(chain(&arm).tool_pose(&values))
    };
    let keys = [
        [0.4, 0.7, 0.1, 0.3, 0.0, 0.2],
        [0.5, 0.6, 0.12, 0.3, 0.0, 0.2],
    ]
    .map(tool);
    let path = follow(&prepared, samples(&keys, Some(3), 1.0, &[]));
    let path = path.unwrap_or_else(|e| panic!("{e}"));
    assert!(path.branches.is_empty() && !path.settled);
    let said = path.warnings.join("; ");
    assert!(said.contains("at 3 of 3 samples"), "{said}");
}

/// Chains of one to five joints at poses that they reach, and at one that they do not: a SCARA has two postures, elbow left
/// and right, a planar arm of three turns two; the first five turns of a KR 6 have no freedom left for another.
#[test]
fn short_chains_have_their_postures() {
    let scara = "type,theta,d,a,alpha\nR,0,0.4,0.225,0\nR,0,0,0.275,180\nP,0,0,0,0\nR,0,0.05,0,0\n";
    let planar = "type,theta,d,a,alpha\nR,0,0,0.5,0\nR,0,0,0.4,0\nR,0,0,0.2,0\n";
    let five = "type,theta,d,a,alpha\nR,0,0.4,0.025,-90\nR,0,0,0.455,0\nR,0,0,0.035,-90\nR,0,0.42,0,90\nR,0,0,0.08,-90\n";
    let one = "type,theta,d,a,alpha\nR,0,0.4,0.225,30\n";
    let random = || RandomStream::new(3, Purpose::Test, 47);
    for (name, table, expected) in [
        ("SCARA", scara, 2),
        ("planar", planar, 2),
        ("five", five, 1),
        ("one", one, 1),
    ] {
        let table = format!("# convention: standard\n# angles: deg\n{table}");
        let mechanism = read("arm.csv", table.as_bytes(), &ReadOptions::default());
        let mechanism = mechanism.unwrap_or_else(|e| panic!("{name}: {e}"));
        let chain = chain(&mechanism);
        let prepared = PreparedMechanism::new(&mechanism, &inverse(), &AnswerOptions::default());
        let prepared = prepared.unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut random = random();
        let mut values = || -> Vec<JointValue> {
            let joints = chain.joints.iter();
            joints
                .map(|joint| JointValue::of_real(0.2 + 0.8 * random.uniform(), joint.is_angle))
                .collect()
        };
        let mut made_by: Vec<Vec<JointValue>> = (0..10).map(|_| values()).collect();
        if name == "SCARA" {
            // Stretched.
            made_by[9][1] = JointValue::of_real(0.0, true);
        }
        let mut poses: Vec<Pose> = made_by.iter().map(|v| chain.tool_pose(v)).collect();
        let mut away = poses[0];
        away.position[0] += 3.0;
        poses.push(away);
        let answers = prepared
            .inverse(&poses)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let none = &answers[10];
        assert!(
            none.warnings
                .iter()
                .any(|warning| warning.contains("does not reach")),
            "{name}"
        );
        assert!(
            none.settled && none.counts.real == 0,
            "{name}: {:?} {:?}",
            none.counts,
            none.warnings
        );
        for ((made_by, pose), answer) in made_by.iter().zip(&poses).zip(&answers) {
            let mut tally = Tally::default();
            tally.note(chain, made_by, pose, answer);
            let is_stretched = name == "SCARA" && made_by[1].real() == 0.0;
            let count = if is_stretched {
                tally.singular
            } else {
                tally.regular
            };
            assert!(tally.wrong.is_empty() && count == 1, "{name}: {tally:?}");
            if is_stretched {
                continue;
            }
            assert!(
                answer.settled,
                "{name}: {:?} {:?}",
                answer.counts, answer.warnings
            );
            assert!(
                answer.counts.real <= expected && answer.counts.real > 0,
                "{name}: {:?}",
                answer.counts
            );
        }
        let most = answers.iter().map(|answer| answer.counts.real).max();
        assert_eq!(most, Some(expected), "{name}");
    }
}
