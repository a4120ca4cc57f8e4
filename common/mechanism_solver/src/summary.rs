//! Summary of all targets of a question, updated as their answers come.

use super::postures::Postures;
use super::preparation::Preparation;

/// Summary of the targets that were answered so far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Number of the targets.
    pub targets: u64,
    /// Warnings for the user, about the mechanism and its targets.
    pub warnings: Vec<String>,
    /// Whether every count is settled.
    pub settled: bool,
}

impl Summary {
    /// Before the first target.
    pub fn of(preparation: &Preparation) -> Self {
        Self {
            targets: 0,
            warnings: preparation.warnings.clone(),
            settled: preparation.settled,
        }
    }

    /// Takes up the answer for the next target.
    pub fn note(&mut self, answer: &Postures) {
        self.targets += 1;
        self.settled &= answer.settled;
        let of_target = |warning: &String| format!("target {}: {warning}", self.targets);
        self.warnings.extend(answer.warnings.iter().map(of_target));
    }
}
