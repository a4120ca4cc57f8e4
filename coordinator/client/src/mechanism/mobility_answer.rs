//! Mobility answer: freedoms at a configuration, and the effect of changing a number of the file on them.

use cognate_mechanism_solver::local::mobility::Mobility;
use cognate_mechanism_solver::local::number_effects::NumberEffect;

/// The answer for one configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct MobilityAnswer {
    /// The freedoms.
    pub mobility: Mobility,
    /// The effect of each number, where that was asked.
    pub why: Option<Vec<NumberEffect>>,
}

impl MobilityAnswer {
    /// Whether nothing is in doubt.
    pub fn is_settled(&self) -> bool {
        let mut effects = self.why.iter().flatten();
        self.mobility.is_settled() && effects.all(|effect| effect.keeps.is_some())
    }

    /// Doubts about the answer, a sentence each.
    pub fn doubts(&self) -> Vec<String> {
        if !self.mobility.is_settled() {
            return vec![self.mobility.reason.clone()];
        }
        let effects = self.why.iter().flatten();
        let open = effects.filter(|effect| effect.keeps.is_none());
        open.map(|effect| format!("{}: {}", effect.number.name, effect.reason))
            .collect()
    }
}
