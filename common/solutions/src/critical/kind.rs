//! Kind of a real critical point, by the inertia of the second derivatives.

use cognate_numeric::linear_algebra::symmetric_eigenvalues::symmetric_eigenvalues;
use serde::{Deserialize, Serialize};

/// An eigenvalue of the second derivatives counts as 0 below this fraction of the largest: what the digits of a point and of
/// its multipliers leave of them.
const ZERO_EIGENVALUE: f64 = 1e-8;

/// Kind of a real critical point, by the second derivatives along the solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A strict local minimum.
    Minimum,
    /// A strict local maximum.
    Maximum,
    /// A critical point that is neither a local minimum nor a local maximum.
    Saddle,
    /// The second derivatives do not tell, or the equations are singular.
    Degenerate,
}

impl Kind {
    /// Kind of a point with gradient 0, where `rows` are the second derivatives by all unknowns and no equation
    /// restricts the unknowns.
    pub fn of_second_derivatives(rows: &[Vec<f64>]) -> Self {
        match inertia(rows) {
            Some((_, 0)) => Self::Minimum,
            Some((0, _)) => Self::Maximum,
            Some(_) => Self::Saddle,
            None => Self::Degenerate,
        }
    }

    /// Word for the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
            Self::Saddle => "saddle",
            Self::Degenerate => "degenerate",
        }
    }
}

/// Numbers of positive and negative eigenvalues of the symmetric matrix with these rows; `None` where one counts as 0.
pub(super) fn inertia(rows: &[Vec<f64>]) -> Option<(usize, usize)> {
    let eigenvalues = symmetric_eigenvalues(rows);
    let largest = eigenvalues
        .iter()
        .fold(0.0f64, |largest, value| largest.max(value.abs()));
    let tiny = ZERO_EIGENVALUE * largest;
    let positive = eigenvalues.iter().filter(|value| **value > tiny).count();
    let negative = eigenvalues.iter().filter(|value| **value < -tiny).count();
    (positive + negative == rows.len()).then_some((positive, negative))
}
