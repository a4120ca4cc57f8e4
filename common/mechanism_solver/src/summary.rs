//! What is said of all targets of a question together, as their answers come.

use super::postures::Postures;
use super::preparation::Preparation;

/// What is known of the targets that were answered so far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// How many they are.
    pub targets: u64,
    /// What a person should know, of the mechanism and of its targets.
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
