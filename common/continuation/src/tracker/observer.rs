//! Events of one path for tests, tables and plots; the tracker itself prints nothing.

use num_complex::Complex64;
use serde::Serialize;

/// One attempted step of a path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepEvent {
    /// Phase of the path.
    pub phase: &'static str,
    /// t to which the step should lead.
    pub t: Complex64,
    /// Length of the step in t.
    pub step: f64,
    /// Whether the step was accepted.
    pub accepted: bool,
    /// First Newton correction, relative: the predictor's error.
    pub predictor_error: f64,
    /// Second Newton correction, relative.
    pub correction: f64,
    /// Bits of the arithmetic that it was tried in.
    pub precision_bits: u32,
    /// The point after the step: normalised homogeneous coordinates, group after group.
    pub point: Vec<Complex64>,
}

/// Is told of every attempted step.
pub trait Observer {
    /// Takes one attempted step of the path with this index.
    fn step(&mut self, origin: u64, event: StepEvent);
}

/// An observer that keeps every event.
#[derive(Clone, Debug, Default)]
pub struct Recorder(pub Vec<StepEvent>);

impl Observer for Recorder {
    fn step(&mut self, _: u64, event: StepEvent) {
        self.0.push(event);
    }
}
