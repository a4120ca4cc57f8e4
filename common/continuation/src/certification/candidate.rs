//! Candidate: a point that may be near a solution.

use num_complex::Complex64;

/// What is to be proved to be near exactly one solution.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// Values of all parameters.
    pub parameters: &'a [Complex64],
    /// Values of all variables; in homogeneous groups up to a factor.
    pub point: &'a [Complex64],
}
