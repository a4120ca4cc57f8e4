//! Candidate: a point that may be near a solution.

use num_complex::Complex64;

/// An approximate solution for which the certification is to prove that exactly one solution is near.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// Values of all parameters.
    pub parameters: &'a [Complex64],
    /// Values of all variables; in homogeneous groups up to a factor.
    pub point: &'a [Complex64],
}
