//! DecompositionOptions: what decides how a system is decomposed.

use crate::retried_stage::MAX_RETRIES;
use cognate_continuation::tracker::settings::Settings;
use cognate_solutions::classification::Tolerances;
use cognate_solutions::witness::{KnownComponents, Method};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Everything that decides how a system is decomposed, besides the system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecompositionOptions {
    /// Seed of everything random.
    pub seed: u64,
    /// Values of the parameters, where the system has some.
    pub parameters: Vec<Complex64>,
    /// Dimensions of the components that are wanted; `None`: all. Sets of higher dimension are found then, to
    /// tell junk, and not split.
    pub dimensions: Option<RangeInclusive<u32>>,
    /// Method for the witness points; `None`: equation by equation, and by the cascade where that leaves doubts.
    pub method: Option<Method>,
    /// Whether a second way is compared with the first.
    pub verify: bool,
    /// Whether witness points are proved, and which unions of them are no components.
    pub certify: bool,
    /// Whether the points of a dimension are split into components; else they are one set, of which it is said
    /// whether points are missing.
    pub split: bool,
    /// Settings of the path tracker.
    pub settings: Settings,
    /// Tolerances of the verdicts about endpoints.
    pub tolerances: Tolerances,
    /// Most repetitions of a path.
    pub max_retries: u16,
    /// Whether paths on the sets of higher dimension confirm what dual spaces and moved slices call junk; else
    /// they are asked only where these are not clear.
    pub confirm_junk: bool,
    /// Loops in a row that bring no points together before points stay apart.
    pub idle_loops: u32,
    /// Whether units are found that suit the coefficients; else the variables are tracked as they are.
    pub own_units: bool,
    /// Components that the other equations cut; `None`: none is known.
    pub known: Option<KnownComponents>,
}

impl Default for DecompositionOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            parameters: Vec::new(),
            dimensions: None,
            method: None,
            verify: false,
            certify: false,
            split: true,
            settings: Settings::default(),
            tolerances: Tolerances::default(),
            max_retries: MAX_RETRIES,
            confirm_junk: true,
            idle_loops: 12,
            own_units: true,
            known: None,
        }
    }
}
