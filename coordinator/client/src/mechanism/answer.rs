//! The answer to a question about a mechanism for all targets.

use super::preparation::{AnswerOptions, Preparation};
use super::solver::Solver;
use super::target_answer::TargetAnswer;
use cognate_kinematics::compile::{Question, Target};
use cognate_kinematics::mechanism::{Mechanism, MechanismError};

/// The answer for all targets.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// What is known before the targets.
    pub preparation: Preparation,
    /// The targets.
    pub targets: Vec<TargetAnswer>,
    /// What a person should know, of the mechanism and of its targets.
    pub warnings: Vec<String>,
    /// Whether every count is settled.
    pub settled: bool,
}

/// Answers a question for targets. Without inputs and poses there is one target, with nothing given.
pub fn answer(
    mechanism: &Mechanism,
    question: &Question,
    targets: &[Target],
    options: &AnswerOptions,
) -> Result<Answer, MechanismError> {
    let solver = Solver::new(mechanism, question, options)?;
    let lone = [Target::Inputs(Vec::new())];
    let targets = if targets.is_empty() {
        &lone[..]
    } else {
        targets
    };
    let found = solver.solve(targets)?;
    Ok(Answer::of(solver.preparation(), found))
}

impl Answer {
    /// The answer for targets of a prepared mechanism.
    pub fn of(preparation: &Preparation, targets: Vec<TargetAnswer>) -> Self {
        let mut warnings = preparation.warnings.clone();
        for (i, target) in targets.iter().enumerate() {
            let of_target = |warning: &String| format!("target {}: {warning}", i + 1);
            warnings.extend(target.warnings.iter().map(of_target));
        }
        Self {
            settled: preparation.settled && targets.iter().all(|t| t.settled),
            preparation: preparation.clone(),
            targets,
            warnings,
        }
    }
}
