//! A mechanism that is kept ready: lines of targets as `cognate mechanism serve` answers them, and poses as numbers.

use crate::commands::mechanism::read::{Read, described, wrong};
use crate::commands::mechanism::serve::{answer_lines, asked};
use crate::error::{ClientError, Exit};
use crate::mechanism::arguments::MechanismServe;
use crate::remedy::misunderstood;
use clap::{Args, FromArgMatches};
use cognate_kinematics::mechanism::pose::{Pose, ReadPose};
use cognate_mechanism_solver::postures::Postures;
use cognate_mechanism_solver::prepared_mechanism::PreparedMechanism;
use num_complex::Complex64;

/// A mechanism, ready for poses or inputs.
pub struct Arm {
    arguments: MechanismServe,
    read: Read,
    prepared: PreparedMechanism<'static>,
}

/// The real postures of an arm for several poses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmAnswer {
    /// Values of all joints, posture by posture: radians and lengths, joints in the order of the file.
    pub joints: Vec<f64>,
    /// Number of postures before each pose, and of all: the postures of pose k are those from `offsets[k]` to
    /// `offsets[k + 1]`.
    pub offsets: Vec<usize>,
    /// Whether the answer for each pose is settled.
    pub settled: Vec<bool>,
}

impl Arm {
    /// Reads a mechanism in any format and prepares it. `options` are those of `cognate mechanism serve`, without the file.
    pub fn open(mechanism: &[u8], options: &[String]) -> Result<Self, ClientError> {
        let words = ["cognate", "mechanism", "serve"];
        let command = clap::Command::new("cognate mechanism serve").no_binary_name(true);
        // A file is demanded by the command line; the content stands for it.
        let typed = options.iter().map(String::as_str).chain(["mechanism"]);
        let matches = MechanismServe::augment_args(command).try_get_matches_from(typed);
        let arguments = matches
            .and_then(|matches| MechanismServe::from_arg_matches(&matches))
            .map_err(|refused| misunderstood(&refused, &words, options))?;
        let read = Read::of_content("mechanism", mechanism.to_vec(), &arguments.mechanism)?;
        let (question, options) = asked(&arguments, &read)?;
        let mechanism = read.mechanism.clone();
        let prepared = PreparedMechanism::owning(mechanism, &question, &options);
        Ok(Self {
            prepared: prepared.map_err(|e| described(&e))?,
            arguments,
            read,
        })
    }

    /// Number of the joints of a posture.
    pub fn joints(&self) -> usize {
        self.read.mechanism.values().len()
    }

    /// Warnings for the user about the mechanism.
    pub fn warnings(&self) -> &[String] {
        &self.prepared.preparation().warnings
    }

    /// Answers lines of JSON, a line each; the exit code is that of the worst answer.
    pub fn answer_lines(&self, lines: &[u8]) -> Result<(Exit, String), ClientError> {
        let input = std::io::Cursor::new(lines.to_vec());
        let mut output = Vec::new();
        let exit = answer_lines(
            &self.arguments,
            &self.read,
            &self.prepared,
            input,
            &mut output,
        );
        let exit = exit.map_err(|e| ClientError::Local(format!("memory cannot be read: {e}")))?;
        Ok((exit, String::from_utf8_lossy(&output).into_owned()))
    }

    /// The real postures for these poses, each a matrix of 4 by 4 numbers by rows.
    ///
    /// # Errors
    /// When a matrix is no pose; none of them is answered then.
    pub fn inverse(&self, matrices: &[[f64; 16]]) -> Result<ArmAnswer, ClientError> {
        if self.arguments.forward {
            return Err(wrong(
                "poses",
                "it was prepared for values of inputs (--forward)",
            ));
        }
        let poses: Result<Vec<Pose>, ClientError> = (0..)
            .zip(matrices)
            .map(|(number, matrix)| {
                pose(matrix).map_err(|why| wrong(&format!("pose {number}"), why))
            })
            .collect();
        let answers = self.prepared.inverse(&poses?);
        let answers = answers.map_err(|e| described(&e))?;
        let mut answer = ArmAnswer {
            offsets: vec![0],
            ..ArmAnswer::default()
        };
        for postures in &answers {
            self.add(&mut answer, postures);
        }
        Ok(answer)
    }

    fn add(&self, answer: &mut ArmAnswer, postures: &Postures) {
        let listed =
            postures
                .positions
                .iter()
                .filter(|position| match self.arguments.within_limits {
                    true => position.within_limits() == Some(true),
                    false => position.is_real,
                });
        let mut count = 0;
        for position in listed {
            let values = position.configuration.values.iter();
            answer.joints.extend(values.map(|(_, value)| value.real()));
            count += 1;
        }
        let before = answer.offsets.last().copied().unwrap_or_default();
        answer.offsets.push(before + count);
        answer.settled.push(postures.settled);
    }
}

/// The pose of a matrix by rows, whose last row is 0 0 0 1.
fn pose(matrix: &[f64; 16]) -> Result<Pose, String> {
    if matrix.iter().any(|number| !number.is_finite()) {
        return Err("expected finite numbers".to_owned());
    }
    if matrix[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(format!(
            "expected the last row 0 0 0 1, found {:?}",
            &matrix[12..]
        ));
    }
    let row = |k: usize| [matrix[4 * k], matrix[4 * k + 1], matrix[4 * k + 2]];
    let position = [3, 7, 11].map(|k| Complex64::from(matrix[k]));
    let read = ReadPose::of_rows([row(0), row(1), row(2)], position)?;
    Ok(read.pose)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARM: &[u8] =
        b"theta,d,a,alpha,type\n0,0.2,0,90,revolute\n0,0,0.5,0,revolute\n0,0,0.4,0,revolute\n\
        0,0.1,0,90,revolute\n0,0.1,0,-90,revolute\n0,0.08,0,0,revolute\n";
    const POSE: [f64; 16] = [
        0.0, 0.0, 1.0, 0.4, 1.0, 0.0, 0.0, 0.3, 0.0, 1.0, 0.0, 0.35, 0.0, 0.0, 0.0, 1.0,
    ];

    #[test]
    fn eight_postures_and_none_of_a_pose_that_is_too_far() {
        let arm = Arm::open(ARM, &["--no-cache".to_owned()]).expect("an arm");
        let mut far = POSE;
        far[3] = 100.0;
        let answer = arm.inverse(&[POSE, far, POSE]).expect("poses");
        assert_eq!(answer.offsets, [0, 8, 8, 16]);
        assert_eq!(answer.joints.len(), 16 * arm.joints());
        assert_eq!(answer.joints[..48], answer.joints[48..]);
        assert_eq!(answer.settled, [true; 3]);
    }

    #[test]
    fn lines_are_answered_and_mistakes_are_named() {
        let arm = Arm::open(ARM, &["--no-cache".to_owned()]).expect("an arm");
        let line = b"{\"position\": [0.4, 0.3, 0.35], \"quaternion\": [0.5, 0.5, 0.5, 0.5]}\n";
        let (exit, text) = arm.answer_lines(line).expect("memory");
        assert_eq!(exit, Exit::Solved, "{text}");
        assert!(text.contains("\"real\":8"), "{text}");
        let mut skew = POSE;
        skew[0] = 0.5;
        let error = arm.inverse(&[POSE, skew]).expect_err("no rotation");
        assert!(error.to_string().contains("pose 1"), "{error}");
        let error = Arm::open(ARM, &["--nocache".to_owned()])
            .err()
            .expect("no option");
        assert!(error.to_string().contains("--no-cache"), "{error}");
    }
}
