//! Sweep: the postures of a redundant chain, at values of a joint that is held.

use super::postures::{Counts, Postures, Route};
use super::preparation::{AnswerOptions, Preparation};
use super::prepared_mechanism::PreparedMechanism;
use cognate_kinematics::compile::formulation::joint_names;
use cognate_kinematics::compile::{Question, Target};
use cognate_kinematics::mechanism::{Mechanism, MechanismError};

/// Most values of a joint.
pub const MOST_SAMPLES: usize = 1000;

/// A mechanism that is prepared at each value of a joint.
pub struct Sweep<'m> {
    joint: String,
    /// The values, each with the prepared mechanism, or the reason why there is none.
    samples: Vec<(f64, Result<PreparedMechanism<'m>, MechanismError>)>,
    /// Facts that are known before the targets, at the first value that could be prepared.
    preparation: Preparation,
}

/// Values of a joint from one limit to the other, both among them; where it has none, of a turn from -180 degrees on, once
/// around. An error where there is no such joint, or a shift has no limits.
pub fn sample_values(
    mechanism: &Mechanism,
    joint: &str,
    samples: usize,
) -> Result<Vec<f64>, MechanismError> {
    let kinds = mechanism.values();
    let Some((_, is_angle)) = kinds.iter().find(|(name, _)| name == joint) else {
        return Err(mechanism.error(format!(
            "--sweep {joint}: there is no such joint; {}",
            joint_names(mechanism)
        )));
    };
    if !(1..=MOST_SAMPLES).contains(&samples) {
        return Err(mechanism.error(format!(
            "--samples {samples}: expected between 1 and {MOST_SAMPLES}"
        )));
    }
    let pi = std::f64::consts::PI;
    let (first, step) = match mechanism.limits_of(joint) {
        Some([low, high]) => (low, (high - low) / (samples.max(2) - 1) as f64),
        None if *is_angle => (-pi, 2.0 * pi / samples as f64),
        None => {
            return Err(mechanism.error(format!(
                "--sweep {joint}: a joint that shifts needs limits in the file"
            )));
        }
    };
    Ok((0..samples).map(|k| first + step * k as f64).collect())
}

impl<'m> Sweep<'m> {
    /// Prepares a question with this joint held at each of these values. An error where none of them can be prepared.
    pub fn new(
        mechanism: &'m Mechanism,
        question: &Question,
        options: &AnswerOptions,
        (joint, values): (&str, &[f64]),
    ) -> Result<Self, MechanismError> {
        let prepared = |value: &f64| {
            let mut question = question.clone();
            question.locks.push((joint.to_owned(), *value));
            (
                *value,
                PreparedMechanism::new(mechanism, &question, options),
            )
        };
        let samples: Vec<_> = values.iter().map(prepared).collect();
        let mut prepared = samples.iter().flat_map(|(_, prepared)| prepared);
        let Some(preparation) = prepared.next().map(|first| first.preparation().clone()) else {
            let error = samples.into_iter().find_map(|(_, prepared)| prepared.err());
            return Err(error.unwrap_or_else(|| mechanism.error("no value of the joint is given")));
        };
        Ok(Self {
            joint: joint.to_owned(),
            samples,
            preparation,
        })
    }

    /// How many values the joint has.
    pub fn samples(&self) -> usize {
        self.samples.len()
    }

    /// Facts that are known before the targets, at the first value that could be prepared.
    pub fn preparation(&self) -> &Preparation {
        &self.preparation
    }

    /// The answers for targets: of each target one for each value of the joint, in their order.
    pub fn solve(&self, targets: &[Target]) -> Result<Vec<Postures>, MechanismError> {
        let mut by_sample = Vec::new();
        for (value, prepared) in &self.samples {
            let mut answers = match prepared {
                Ok(prepared) => prepared.solve(targets)?,
                Err(error) => targets
                    .iter()
                    .map(|target| not_prepared(target, error))
                    .collect(),
            };
            for answer in &mut answers {
                answer.held = vec![(self.joint.clone(), *value)];
            }
            by_sample.push(answers.into_iter());
        }
        let mut answers = Vec::new();
        for _ in targets {
            answers.extend(by_sample.iter_mut().filter_map(Iterator::next));
        }
        Ok(answers)
    }
}

/// The answer for a target where the mechanism could not be prepared.
fn not_prepared(target: &Target, error: &MechanismError) -> Postures {
    Postures {
        target: target.clone(),
        held: Vec::new(),
        counts: Counts::default(),
        positions: Vec::new(),
        sets: Vec::new(),
        settled: false,
        warnings: vec![error.message.clone()],
        route: Route::None,
    }
}
