//! Arms whose postures have a closed form: the same postures as by paths, at poses at random, of arms that are built and of arms
//! at random; and arms that have none are answered as before.

use cognate_kinematics::compile::{Problem, Question};
use cognate_kinematics::mechanism::chain::{Chain, JointValue};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Body, Mechanism, ReadOptions, read};
use cognate_mechanism_solver::postures::{Position, Postures, Route};
use cognate_mechanism_solver::{AnswerOptions, PreparedMechanism};
use cognate_numeric::random::{Purpose, RandomStream};

/// A row of an arm: d, a, alpha in degrees.
type Row = (f64, f64, f64);

const WRIST: &str = "spherical wrist";
const SHOULDER: &str = "spherical shoulder";
const PARALLEL: &str = "axes 2, 3 and 4 parallel";
const MIRRORED: &str = "axes 3, 4 and 5 parallel";

/// Rows of vendors and textbooks: lengths in metres, angles in degrees.
#[rustfmt::skip]
const ARMS: [(&str, &str, [Row; 6]); 12] = [
    ("UR3", PARALLEL, [(0.1519, 0.0, 90.0), (0.0, -0.24365, 0.0), (0.0, -0.21325, 0.0), (0.11235, 0.0, 90.0), (0.08535, 0.0, -90.0), (0.0819, 0.0, 0.0)]),
    ("UR5e", PARALLEL, [(0.1625, 0.0, 90.0), (0.0, -0.425, 0.0), (0.0, -0.3922, 0.0), (0.1333, 0.0, 90.0), (0.0997, 0.0, -90.0), (0.0996, 0.0, 0.0)]),
    ("UR10e", PARALLEL, [(0.1807, 0.0, 90.0), (0.0, -0.6127, 0.0), (0.0, -0.57155, 0.0), (0.17415, 0.0, 90.0), (0.11985, 0.0, -90.0), (0.11655, 0.0, 0.0)]),
    ("PUMA 560", WRIST, [(0.0, 0.0, 90.0), (0.0, 0.4318, 0.0), (0.15, 0.0203, -90.0), (0.4318, 0.0, 90.0), (0.0, 0.0, -90.0), (0.0, 0.0, 0.0)]),
    ("IRB 140", WRIST, [(0.352, 0.07, -90.0), (0.0, 0.36, 0.0), (0.0, 0.0, -90.0), (0.38, 0.0, 90.0), (0.0, 0.0, -90.0), (0.065, 0.0, 0.0)]),
    ("IRB 1600", WRIST, [(0.4865, 0.15, -90.0), (0.0, 0.475, 0.0), (0.0, 0.0, -90.0), (0.6, 0.0, 90.0), (0.0, 0.0, -90.0), (0.065, 0.0, 0.0)]),
    ("KR 6", WRIST, [(0.4, 0.025, -90.0), (0.0, 0.455, 0.0), (0.0, 0.035, -90.0), (0.42, 0.0, 90.0), (0.0, 0.0, -90.0), (0.08, 0.0, 0.0)]),
    ("PiPER", WRIST, [(0.123, 0.0, -90.0), (0.0, 0.28503, 0.0), (0.0, -0.02198, 90.0), (0.25075, 0.0, -90.0), (0.0, 0.0, 90.0), (0.091, 0.0, 0.0)]),
    ("Staubli TX90", WRIST, [(0.478, 0.05, -90.0), (0.0, 0.425, 0.0), (0.05, 0.0, 90.0), (0.425, 0.0, -90.0), (0.0, 0.0, 90.0), (0.1, 0.0, 0.0)]),
    ("Doosan M0609", WRIST, [(0.135, 0.0, -90.0), (0.0062, 0.411, 0.0), (0.0, 0.0, 90.0), (0.368, 0.0, -90.0), (0.0, 0.0, 90.0), (0.121, 0.0, 0.0)]),
    ("LR Mate 200iD", WRIST, [(0.0, 0.05, -90.0), (0.0, 0.33, 180.0), (0.0, 0.035, -90.0), (-0.335, 0.0, 90.0), (0.0, 0.0, -90.0), (-0.08, 0.0, 180.0)]),
    ("Jaco spherical", WRIST, [(0.2755, 0.0, 90.0), (0.0, 0.41, 180.0), (-0.0098, 0.0, 90.0), (-0.3111, 0.0, 90.0), (0.0, 0.0, 90.0), (-0.2638, 0.0, 180.0)]),
];

/// Arms that have no closed form: wrists with an offset, and a twist of 60 degrees.
#[rustfmt::skip]
const WITHOUT: [(&str, [Row; 6]); 3] = [
    ("CRX-10iA", [(0.0, 0.0, -90.0), (0.0, 0.54, 0.0), (0.0, 0.0, -90.0), (0.54, 0.0, 90.0), (-0.15, 0.0, -90.0), (0.16, 0.0, 0.0)]),
    ("Jaco", [(0.2755, 0.0, 90.0), (0.0, 0.41, 180.0), (-0.0098, 0.0, 90.0), (-0.2501, 0.0, 60.0), (-0.0856, 0.0, 60.0), (-0.2028, 0.0, 180.0)]),
    ("xArm6", [(0.267, 0.0, -90.0), (0.0, 0.28949, 0.0), (0.0, 0.0775, -90.0), (0.3425, 0.0, 90.0), (0.0, 0.076, -90.0), (0.097, 0.0, 0.0)]),
];

/// The arm with these rows; joint k begins at k times `start` degrees.
fn arm(rows: &[Row], start: i32) -> Mechanism {
    let mut table = String::from("# convention: standard\n# angles: deg\ntheta,d,a,alpha\n");
    for (k, (d, a, alpha)) in (0..).zip(rows) {
        table.push_str(&format!("{},{d},{a},{alpha}\n", start * k));
    }
    let options = ReadOptions::default();
    read("arm.csv", table.as_bytes(), &options).expect("a table of this test")
}

fn chain(arm: &Mechanism) -> &Chain {
    match &arm.body {
        Body::Chain(chain) => chain,
        _ => panic!("a table is a chain"),
    }
}

fn poses(chain: &Chain, count: usize) -> Vec<Pose> {
    let mut random = RandomStream::new(11, Purpose::Test, 48);
    let mut turn = || JointValue::of_real(3.1 * (2.0 * random.uniform() - 1.0), true);
    let mut values = || -> Vec<JointValue> { (0..chain.joints.len()).map(|_| turn()).collect() };
    let mut poses: Vec<Pose> = (0..count).map(|_| chain.tool_pose(&values())).collect();
    // Beyond the reach all postures are complex.
    let far = poses.iter_mut().step_by(7);
    far.for_each(|pose| pose.position[0] *= 1.5);
    poses
}

/// The largest difference of cosines and sines, in parts of their size.
fn apart(one: &Position, other: &Position) -> f64 {
    let values = |position: &Position| position.configuration.values.clone();
    let pairs = values(one).into_iter().zip(values(other));
    let differences = pairs.map(|((_, a), (_, b))| match (a, b) {
        (JointValue::Turn(c, s), JointValue::Turn(x, y)) => {
            let size = (c.norm_sqr() + s.norm_sqr()).max(1.0);
            ((c - x).norm_sqr() + (s - y).norm_sqr()) / size
        }
        _ => f64::INFINITY,
    });
    differences.fold(0.0, f64::max).sqrt()
}

/// Whether two answers have the same counts and the same positions.
fn compare(name: &str, by_form: &Postures, by_paths: &Postures) {
    assert!(by_form.settled && by_paths.settled, "{name}");
    assert_eq!(by_form.counts, by_paths.counts, "{name}");
    assert_eq!(by_form.positions.len(), by_paths.positions.len(), "{name}");
    for position in &by_form.positions {
        let alike = by_paths.positions.iter();
        let alike = alike.filter(|other| other.is_real == position.is_real);
        let nearest = alike
            .map(|other| apart(position, other))
            .fold(f64::INFINITY, f64::min);
        assert!(
            nearest < 1e-9,
            "{name}: {nearest:e}, condition {:e}",
            position.condition
        );
        assert!(position.configuration.residual < 1e-9, "{name}");
        if position.is_real {
            assert!(position.configuration.residual < 1e-12, "{name}");
        }
    }
}

/// Answers poses by the closed form and by paths; almost all by the closed form of this kind.
fn check(name: &str, kind: &str, rows: &[Row], lock: Option<(&str, f64)>, count: usize) {
    let mechanism = arm(rows, 10);
    let question = Question {
        locks: lock
            .iter()
            .map(|(joint, x)| ((*joint).to_owned(), *x))
            .collect(),
        ..Question::of(Problem::Inverse)
    };
    let folder = tempfile::tempdir().expect("a folder");
    let options = AnswerOptions {
        cache: Some(folder.path().to_owned()),
        ..AnswerOptions::default()
    };
    let paths_only = AnswerOptions {
        paths_only: true,
        ..options.clone()
    };
    let prepared = PreparedMechanism::new(&mechanism, &question, &options);
    let prepared = prepared.unwrap_or_else(|e| panic!("{name}: {e}"));
    let by_paths = PreparedMechanism::new(&mechanism, &question, &paths_only);
    let by_paths = by_paths.unwrap_or_else(|e| panic!("{name}: {e}"));
    let poses = poses(chain(&mechanism), count);
    let answers = prepared
        .inverse(&poses)
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    let others = by_paths
        .inverse(&poses)
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut closed = 0;
    for (answer, other) in answers.iter().zip(&others) {
        match answer.route {
            Route::ClosedForm(route) => {
                assert_eq!(route, kind, "{name}");
                closed += 1;
            }
            route => assert_eq!(route, other.route, "{name}"),
        }
        assert!(matches!(other.route, Route::Paths | Route::Loop), "{name}");
        compare(name, answer, other);
    }
    println!("{name}: {closed} of {count} poses by {kind}");
    assert!(
        closed + 2 + count / 20 >= count,
        "{name}: {closed} of {count}"
    );
}

fn count() -> usize {
    match std::env::var_os("COGNATE_LONG") {
        Some(_) => 2000,
        None => 24,
    }
}

#[test]
fn arms_that_are_built_have_the_same_postures_by_their_closed_form() {
    for (name, kind, rows) in ARMS {
        check(name, kind, &rows, None, count());
    }
}

/// The arm from its hand to its base: the same axes in the other order.
fn mirrored(rows: &[Row; 6]) -> [Row; 6] {
    std::array::from_fn(|k| match k {
        5 => (0.1, 0.0, 0.0),
        _ => {
            let (_, a, alpha) = rows[4 - k];
            let d = if k == 0 { 0.2 } else { rows[5 - k].0 };
            (d, a, alpha)
        }
    })
}

/// Among them a KR 6, of which axes 3 and 6 seen from its hand lie in one plane in every posture.
#[test]
fn mirrored_arms_have_the_same_postures_by_their_closed_form() {
    for place in [1, 3, 6, 8] {
        let (name, kind, rows) = ARMS[place];
        let kind = if kind == WRIST { SHOULDER } else { MIRRORED };
        check(
            &format!("{name}, mirrored"),
            kind,
            &mirrored(&rows),
            None,
            count(),
        );
    }
}

/// Spherical wrists behind three axes in general position, and parallel axes between others.
#[test]
fn arms_at_random_have_the_same_postures_by_their_closed_form() {
    let mut random = RandomStream::new(12, Purpose::Test, 48);
    let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
    for n in 0..4 {
        let mut row = || (between(-0.3, 0.3), between(0.1, 0.5), between(30.0, 150.0));
        let mut wrist: [Row; 6] = std::array::from_fn(|_| row());
        wrist[3].1 = 0.0;
        (wrist[4].0, wrist[4].1) = (0.0, 0.0);
        check(&format!("wrist {n}"), WRIST, &wrist, None, count());
        check(
            &format!("shoulder {n}"),
            SHOULDER,
            &mirrored(&wrist),
            None,
            count(),
        );
        let mut parallel: [Row; 6] = std::array::from_fn(|_| row());
        parallel[1].2 = 0.0;
        parallel[2].2 = if n % 2 == 0 { 0.0 } else { 180.0 };
        check(&format!("parallel {n}"), PARALLEL, &parallel, None, count());
        check(
            &format!("parallel {n}, mirrored"),
            MIRRORED,
            &mirrored(&parallel),
            None,
            count(),
        );
    }
}

/// A redundant arm whose third joint is held has a spherical wrist, one whose last joint is held a spherical shoulder: the rows
/// come from its axes.
#[test]
fn arms_with_a_joint_that_is_held_have_closed_forms() {
    let iiwa = [
        (0.36, 0.0, -90.0),
        (0.0, 0.0, 90.0),
        (0.42, 0.0, 90.0),
        (0.0, 0.0, -90.0),
        (0.4, 0.0, -90.0),
        (0.0, 0.0, 90.0),
        (0.126, 0.0, 0.0),
    ];
    check("iiwa", WRIST, &iiwa, Some(("q3", 0.3)), count());
    let panda = [
        (0.333, 0.0, -90.0),
        (0.0, 0.0, 90.0),
        (0.316, 0.0825, 90.0),
        (0.0, -0.0825, -90.0),
        (0.384, 0.0, 90.0),
        (0.0, 0.088, 90.0),
        (0.107, 0.0, 0.0),
    ];
    check("Panda", SHOULDER, &panda, Some(("q7", 0.7)), count());
}

/// The answers for poses of an arm; an error names it.
fn inverse(
    name: &str,
    mechanism: &Mechanism,
    poses: &[Pose],
    options: &AnswerOptions,
) -> Vec<Postures> {
    let question = Question::of(Problem::Inverse);
    let prepared = PreparedMechanism::new(mechanism, &question, options);
    let prepared = prepared.unwrap_or_else(|e| panic!("{name}: {e}"));
    let answers = prepared.inverse(poses);
    answers.unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Proofs that begin at postures of the closed form are those that begin at ends of paths.
#[test]
fn postures_of_a_closed_form_are_proved() {
    for place in [1, 3] {
        let (name, kind, rows) = ARMS[place];
        let mechanism = arm(&rows, 10);
        let poses = poses(chain(&mechanism), 12);
        let answers = |paths_only| {
            let options = AnswerOptions {
                paths_only,
                certify: true,
                ..AnswerOptions::default()
            };
            inverse(name, &mechanism, &poses, &options)
        };
        for (answer, other) in answers(false).iter().zip(&answers(true)) {
            assert_eq!(answer.route, Route::ClosedForm(kind), "{name}");
            assert_eq!(answer.counts.certified_real, Some(answer.counts.real));
            compare(name, answer, other);
        }
    }
}

#[test]
fn arms_without_a_closed_form_are_answered_by_paths() {
    for (name, rows) in WITHOUT {
        let mechanism = arm(&rows, 10);
        let poses = poses(chain(&mechanism), 4);
        for answer in inverse(name, &mechanism, &poses, &AnswerOptions::default()) {
            assert!(
                answer.settled && matches!(answer.route, Route::Paths | Route::Loop),
                "{name}"
            );
        }
    }
}

/// Poses as people choose them: wherever the closed form answers, paths answer the same; wherever it does not, they do.
#[test]
fn special_poses_have_the_same_answers() {
    let step = match std::env::var_os("COGNATE_LONG") {
        Some(_) => 1,
        None => 61,
    };
    for place in [1, 3, 6] {
        let (name, _, rows) = ARMS[place];
        let mechanism = arm(&rows, 0);
        let poses: Vec<Pose> = (0..729)
            .step_by(step)
            .map(|n| {
                let turn = |k| {
                    let degrees = [-90.0, 0.0, 90.0][n / 3usize.pow(k) % 3];
                    JointValue::of_real(f64::to_radians(degrees), true)
                };
                let values: Vec<JointValue> = (0..6).map(turn).collect();
                chain(&mechanism).tool_pose(&values)
            })
            .collect();
        let answers = |paths_only| {
            let options = AnswerOptions {
                paths_only,
                ..AnswerOptions::default()
            };
            inverse(name, &mechanism, &poses, &options)
        };
        for (answer, other) in answers(false).iter().zip(&answers(true)) {
            match answer.route {
                Route::ClosedForm(_) => compare(name, answer, other),
                _ => assert_eq!(answer, other, "{name}"),
            }
        }
    }
}
