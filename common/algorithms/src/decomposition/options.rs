//! DecompositionOptions: what decides how a system is decomposed.

use crate::retried_stage::MAX_RETRIES;
use cognate_continuation::tracker::settings::Settings;
use cognate_solutions::classification::Tolerances;

/// Everything that decides how a system is decomposed, besides the system.
#[derive(Clone, Debug, PartialEq)]
pub struct DecompositionOptions {
    /// Seed of everything random.
    pub seed: u64,
    /// How paths are tracked.
    pub settings: Settings,
    /// How verdicts are reached.
    pub tolerances: Tolerances,
    /// How often a path is tracked again at most.
    pub max_retries: u16,
    /// Whether paths on the sets of higher dimension confirm what dual spaces and moved slices call junk; else
    /// they are asked only where these are not clear.
    pub confirm_junk: bool,
    /// Loops in a row that bring no points together before points stay apart.
    pub idle_loops: u32,
}

impl Default for DecompositionOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            settings: Settings::default(),
            tolerances: Tolerances::default(),
            max_retries: MAX_RETRIES,
            confirm_junk: true,
            idle_loops: 12,
        }
    }
}
