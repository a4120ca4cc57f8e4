//! Settings: every number that decides a path, with unit, default, and where the default comes from.

use cognate_numeric::precision::rungs;
use serde::{Deserialize, Serialize};

/// Robust steps are half as long as the way to the nearest singularity: beta_1 in Telen, Van Barel,
/// Verschelde (2020), section 4.
const REACH: f64 = 0.5;

/// Settings of the tracker. The result of a path is a function of its settings, among other things.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Estimated error of an accepted point, relative to its largest coordinate.
    pub tolerance: f64,
    /// Largest first Newton correction after a prediction, relative to the largest coordinate.
    /// Larger is faster and jumps between paths more often; 1e-2 was seen to jump
    /// on the nine-point problem.
    pub predictor_tolerance: f64,
    /// Largest step in t.
    pub max_step: f64,
    /// Robust mode: longest step, as a part of the distance in t to the nearest singularity of the
    /// path as its Taylor series shows it; 0 switches the mode off.
    pub reach: f64,
    /// Smallest step, relative to the distance that is left to the next target in t.
    pub min_step: f64,
    /// Accepted and rejected steps of one path; one with 212 bits counts eight times, one with 424 bits sixteen times,
    /// and so on; twice as often in robust mode.
    pub max_steps: u32,
    /// |t| where the endgame begins.
    pub endgame_boundary: f64,
    /// Radius of the first turn around t = 0, for paths that do not end regularly before it.
    pub endgame_radius: f64,
    /// The endgame gives up below this radius.
    pub endgame_min_radius: f64,
    /// Most turns that may be needed until a path closes.
    pub max_winding_number: u32,
    /// Condition number above which an endpoint is left to the endgame for singular endpoints.
    pub singular_condition: f64,
    /// Relative accuracy at which a singular endpoint counts as settled.
    pub endgame_tolerance: f64,
    /// Relative accuracy of the system's decimal coefficients; 0 where there are none. With exact data also the
    /// least coefficient of an equation as a part of its largest, where they differ by many orders of magnitude.
    pub data_accuracy: f64,
    /// Whether what depends on digits of the coefficients beyond that accuracy is followed nevertheless.
    pub exact_data: bool,
    /// Paths whose endgame needs more bits are put aside, with 0 all that need an endgame: whether they must be followed
    /// further depends on what the others find.
    pub max_endgame_bits: u32,
    /// Bits of the arithmetic that a path begins in: 53 (double), 106 (double-double), or more.
    pub precision_bits: u32,
    /// Most bits of the arithmetic to which a path that lacks digits may go up.
    pub max_precision_bits: u32,
}

impl Settings {
    /// Relative error of the coefficients as they stand; 0 where they are exact.
    pub fn error_of_data(&self) -> f64 {
        if self.exact_data {
            0.0
        } else {
            self.data_accuracy
        }
    }
}

/// Relative accuracy of numbers that were rounded to doubles.
pub const ROUNDED_TO_DOUBLES: f64 = f64::EPSILON / 2.0;

/// A path that takes more steps follows noise, or is too near to another one.
const ENOUGH_STEPS: u32 = 20_000;

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-10,
            predictor_tolerance: 1e-4,
            max_step: 0.1,
            reach: 0.0,
            min_step: 1e-13,
            max_steps: ENOUGH_STEPS,
            endgame_boundary: 0.1,
            endgame_radius: 1e-3,
            endgame_min_radius: 1e-14,
            max_winding_number: 128,
            singular_condition: 1e8,
            endgame_tolerance: 1e-8,
            data_accuracy: 0.0,
            exact_data: false,
            max_endgame_bits: u32::MAX,
            precision_bits: 53,
            max_precision_bits: 1024,
        }
    }
}

/// Named settings; each names its trade.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Preset {
    /// A hundred times tighter prediction in robust mode: many times slower, fewest path jumps.
    Careful,
    /// The settings with which the known counts were checked.
    #[default]
    Default,
    /// Faster, more path jumps for the crossing check to repair.
    Fast,
    /// Fastest; for experiments only.
    Reckless,
}

impl Preset {
    /// The settings that the name stands for.
    pub fn settings(self) -> Settings {
        let default = Settings::default();
        match self {
            Self::Careful => Settings {
                predictor_tolerance: 1e-6,
                max_step: 0.05,
                reach: REACH,
                ..default
            },
            Self::Default => default,
            Self::Fast => Settings {
                predictor_tolerance: 1e-3,
                ..default
            },
            Self::Reckless => Settings {
                predictor_tolerance: 1e-2,
                max_step: 0.25,
                ..default
            },
        }
    }
}

impl Settings {
    /// Turns robust mode on, if it is off, and keeps the other settings.
    #[must_use]
    pub fn robust(self) -> Self {
        let reach = if self.reach > 0.0 { self.reach } else { REACH };
        Self { reach, ..self }
    }

    /// Settings for a path that is tracked again, `attempt` counted from 1: tighter each time, with four times as many
    /// steps up to what is enough, and from the second time on with twice the digits from the beginning.
    #[must_use]
    pub fn tightened(&self, attempt: u16) -> Self {
        let mut tighter = self.clone();
        for _ in 0..attempt {
            tighter.predictor_tolerance *= 0.01;
            tighter.max_step *= 0.5;
            let more = tighter.max_steps.saturating_mul(4).min(ENOUGH_STEPS);
            tighter.max_steps = tighter.max_steps.max(more);
        }
        if attempt >= 2 {
            let rung = rungs(self.precision_bits, self.max_precision_bits).nth(1);
            tighter.precision_bits = rung.unwrap_or(self.precision_bits);
        }
        tighter.predictor_tolerance = tighter.predictor_tolerance.max(1e-9);
        tighter
    }
}
