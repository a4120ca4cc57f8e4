//! Options of an answer, and facts about a mechanism that are known before its targets.

use super::start_positions::StartPositions;
use cognate_kinematics::compile::Family;
use std::path::PathBuf;

/// How targets are answered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnswerOptions {
    /// Seed of everything random.
    pub seed: u64,
    /// Proofs of the solutions.
    pub certify: bool,
    /// Paths to all targets, also where an arm has a closed form.
    pub paths_only: bool,
    /// The folder of prepared mechanisms; nothing is kept without one.
    pub cache: Option<PathBuf>,
    /// Values of all joints, radians and lengths, in the order of the mechanism: the positions that are nearest to them come
    /// first, and of a set of postures the nearest is shown. Empty where no values are preferred.
    pub near: Vec<f64>,
    /// Threads side by side; 0 stands for as many as there are cores. The answer does not depend on them.
    pub threads: usize,
}

/// Facts about a mechanism that are known before its targets, with warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct Preparation {
    /// The family, with the number of its general member.
    pub family: Family,
    /// Names of the inputs that targets give.
    pub inputs: Vec<String>,
    /// Positions of this mechanism at a general target; `None` where it was not prepared.
    pub here: Option<u64>,
    /// Why that is less than the family's number; empty where it is not.
    pub reason: String,
    /// Whether the prepared mechanism was found in the cache.
    pub from_cache: bool,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Whether the number of positions is settled.
    pub settled: bool,
}

impl Preparation {
    /// Takes over what preparing has found.
    pub fn note(&mut self, start: &StartPositions) {
        self.here = Some(start.count);
        self.from_cache = start.from_cache;
        self.settled &= start.settled;
        self.warnings.extend(start.warnings.iter().cloned());
        let Some(expected) = self.family.expected else {
            return;
        };
        if start.count < expected {
            let others = &start.others;
            let rest = if others.is_empty() {
                String::new()
            } else {
                format!(", {others}")
            };
            self.reason = format!("special: {} of {expected}{rest}", start.count);
        } else if start.count > expected {
            self.settled = false;
            self.warnings.push(format!(
                "{} positions were found where the family has {expected} ({})",
                start.count, self.family.source
            ));
        }
    }
}
