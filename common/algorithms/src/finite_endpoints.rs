//! FiniteEndpoints: what a finished solve hands to the stages that close it.

use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::tracker::settings::Settings;
use num_complex::Complex64;

/// The finite endpoints of a finished solve.
#[derive(Clone, Debug, PartialEq)]
pub struct FiniteEndpoints {
    /// A homotopy that ends at the parameters of each target.
    pub homotopy: HomotopyKind,
    /// Seed of the solve, from which combinations of equations are made if there are more equations than unknowns.
    pub seed: u64,
    /// The settings that its paths were tracked with.
    pub settings: Settings,
    /// Nonsingular endpoints, in the order of the targets.
    pub regular: Vec<FiniteEndpoint>,
    /// One endpoint of each singular point that is not known to lie on a positive-dimensional set.
    pub singular: Vec<FiniteEndpoint>,
}

/// One endpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct FiniteEndpoint {
    /// Number of the target.
    pub target: u64,
    /// Number of the path that ended there, as in the solution sets.
    pub path: u64,
    /// Values of the variables.
    pub values: Vec<Complex64>,
}
