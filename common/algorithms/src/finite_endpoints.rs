//! FiniteEndpoints: what a finished solve hands to the stages that close it.

use cognate_continuation::homotopies::HomotopyKind;
use cognate_continuation::tracker::settings::Settings;
use num_complex::Complex64;

/// The finite endpoints of a finished solve.
#[derive(Clone, Debug, PartialEq)]
pub struct FiniteEndpoints {
    /// A homotopy that ends at the parameters of each target.
    pub homotopy: HomotopyKind,
    /// Its seed, from which combinations of equations are made where there are too many.
    pub seed: u64,
    /// The settings that its paths were tracked with.
    pub settings: Settings,
    /// The nonsingular ones, target by target.
    pub regular: Vec<FiniteEndpoint>,
    /// Of each singular point that is not known to lie on a positive-dimensional set one.
    pub singular: Vec<FiniteEndpoint>,
}

/// One endpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct FiniteEndpoint {
    /// At which target.
    pub target: u64,
    /// Which path ended there, as the solution sets name it.
    pub path: u64,
    /// Values of the variables.
    pub values: Vec<Complex64>,
}
