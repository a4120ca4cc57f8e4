//! How one path is followed: settings, state, steps, outcome.

pub mod outcome;
pub mod settings;
