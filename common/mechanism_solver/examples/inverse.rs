//! All postures of an arm for a pose, in its own process: `cargo run --release -p cognate-mechanism-solver --example inverse`.

use cognate_kinematics::compile::{Problem, Question};
use cognate_kinematics::mechanism::{ReadOptions, pose::Pose, read};
use cognate_mechanism_solver::{AnswerOptions, Postures, PreparedMechanism};
use std::error::Error;

/// Six revolute joints in Denavit and Hartenberg's parameters: degrees and metres.
const ARM: &[u8] =
    b"theta,d,a,alpha,type\n0,0.2,0,90,revolute\n0,0,0.5,0,revolute\n0,0,0.4,0,revolute\n\
    0,0.1,0,90,revolute\n0,0.1,0,-90,revolute\n0,0.08,0,0,revolute\n";

/// All postures with the tool turned by 120 degrees about the diagonal of the axes, its origin at this place.
fn postures(place: [f64; 3]) -> Result<Postures, Box<dyn Error>> {
    let arm = read("arm.csv", ARM, &ReadOptions::default())?;
    // Once for an arm; then any number of poses.
    let question = Question::of(Problem::Inverse);
    let prepared = PreparedMechanism::new(&arm, &question, &AnswerOptions::default())?;
    let pose = Pose::real([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], place);
    Ok(prepared.inverse(&[pose])?.remove(0))
}

fn main() -> Result<(), Box<dyn Error>> {
    let postures = postures([0.4, 0.3, 0.35])?;
    assert!(
        postures.settled,
        "something is in doubt: {:?}",
        postures.warnings
    );
    assert_eq!((postures.counts.complex, postures.counts.real), (8, 8));
    for posture in postures
        .positions
        .iter()
        .filter(|position| position.is_real)
    {
        let joints = posture.configuration.values.iter();
        let degrees: Vec<String> = joints
            .map(|(_, value)| format!("{:9.3}", value.real().to_degrees()))
            .collect();
        println!("{}", degrees.join(" "));
    }
    Ok(())
}

#[test]
fn the_arm_reaches_the_place_in_eight_postures() {
    main().expect("the example runs");
}
