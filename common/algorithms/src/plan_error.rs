//! PlanError: why there is no plan, in words for the person who gave the system.

use crate::limits::{MAX_PATHS, MAX_STREAMED_PATHS};
use crate::monodromy::trace::NoTraceTest;
use crate::start_kind::StartKind;
use crate::start_pair::StartPairError;
use cognate_numeric::counted::counted;
use cognate_solutions::symmetry::SymmetryError;
use cognate_systems::polynomial::PolynomialError;

/// Reason why there is no plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// Underdetermined.
    #[error(
        "{} for {}, so that no solution is isolated: \
         `cognate decompose FILE` finds the curves, surfaces, ... of solutions. Add {} to ask for points of the \
         solution set (random linear ones: a slice, whose solutions are as many as the set's degree), or fix as many \
         variables",
        counted(*.equations, "equation"),
        counted(*.unknowns, "unknown"),
        match .unknowns.saturating_sub(*.equations) {
            1 => "one equation".to_string(),
            n => format!("{n} equations"),
        }
    )]
    FewerEquations {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns: variables, less one for each homogeneous group.
        unknowns: usize,
    },
    /// The equations are not what they should be.
    #[error(transparent)]
    Polynomial(#[from] PolynomialError),
    /// An equation among parameters.
    #[error(
        "not in this version: `{0}` is an equation among the parameters; parameters must be free \
         to move, since the homotopy takes a random complex detour that leaves any constrained set"
    )]
    ConstrainedParameters(String),
    /// Parameters without values.
    #[error("the system has parameters ({names}) and no values for them: give target parameters")]
    ParametersWithoutValues {
        /// Names of the parameters.
        names: String,
    },
    /// The wrong number of values.
    #[error("{what} have {}, but the system has {}", counted(*.found, "value"), counted(*.expected, "parameter"))]
    ParameterCount {
        /// Name of the parameter values: at the start, or at a target.
        what: &'static str,
        /// Number of given values.
        found: usize,
        /// Number of parameters.
        expected: usize,
    },
    /// Infinite or not a number.
    #[error("{what} have a value that is no finite number")]
    NotFinite {
        /// Name of the parameter values: at the start, or at a target.
        what: &'static str,
    },
    /// Several targets can only be reached from solved parameters.
    #[error(
        "{0} sets of target parameters need start solutions and start parameters; without them \
         one set can be solved at a time"
    )]
    SeveralTargets(usize),
    /// `given` without anything given.
    #[error("the start `given` needs start solutions")]
    NoStartPoints,
    /// An object without points.
    #[error("there is no start solution among the start solutions")]
    EmptyStart,
    /// Start solutions of another space.
    #[error(
        "the start solutions have {}, but the system has {}",
        counted(*.found, "coordinate"),
        counted(*.expected, "variable")
    )]
    StartDimension {
        /// Number of given coordinates.
        found: usize,
        /// Number of variables.
        expected: usize,
    },
    /// Start solutions of what?
    #[error("start solutions need start parameters, at which they solve the system")]
    NoStartParameters,
    /// Nothing to deform.
    #[error(
        "start solutions are for systems with parameters or a path variable; this one has neither"
    )]
    NothingToDeform,
    /// Start parameters without solutions there.
    #[error("start parameters need start solutions")]
    StartParametersAlone,
    /// No parameters, and none can be made of the coefficients.
    #[error(
        "the start `monodromy` makes loops in the space of parameters; this system has no \
         parameters, and its coefficients cannot serve: {0}"
    )]
    NoCoefficientFamily(String),
    /// Completeness cannot be tested.
    #[error("there is no trace test for this family: {0}")]
    NoTraceTest(NoTraceTest),
    /// A homotopy is one path, no family.
    #[error(
        "the start `monodromy` is for families with parameters, not for a homotopy with a path variable"
    )]
    MonodromyOfHomotopy,
    /// No start pair is given, and none was found.
    #[error(
        "the start `monodromy` needs one solution and its parameters (start solutions and start \
         parameters), since {0}"
    )]
    NoStartPair(#[from] StartPairError),
    /// Generators that cannot be followed.
    #[error(transparent)]
    Symmetry(#[from] SymmetryError),
    /// A homotopy of the user's own has no start system of ours.
    #[error("a system with a path variable is a homotopy: it needs its start solutions")]
    HomotopyWithoutStart,
    /// Too large.
    #[error(
        "not in this version: the {start} start has {} paths, more than the limit of {MAX_PATHS} \
         paths of one solve ({MAX_STREAMED_PATHS} by degrees where nothing needs all of them in memory){instead}",
        .number.map_or("2^64 or more".to_string(), |n| n.to_string())
    )]
    TooManyPaths {
        /// Start that has too many paths.
        start: StartKind,
        /// Number of paths, if it fits into 64 bits.
        number: Option<u64>,
        /// Other starts that would do, as an end of the sentence; empty if none is known.
        instead: String,
    },
    /// Too many ways to count.
    #[error(
        "not in this version: counting the choices of a start by {groups} groups takes too long"
    )]
    TooManyGroups {
        /// Number of groups.
        groups: usize,
    },
    /// Mixed cells cannot be had.
    #[error("the polyhedral start cannot be used: {0}")]
    NoMixedCells(String),
    /// No linear-product start.
    #[error("there is no linear-product start: {0}")]
    NoLinearProduct(String),
    /// Sets are for one start only.
    #[error("sets of variables go with the start `linear-product` or `auto` only")]
    SetsWithoutLinearProduct,
    /// A product of projective spaces has no total degree.
    #[error("a total-degree start needs one homogeneous group or only affine ones")]
    TotalDegreeNeedsOneGroup,
    /// The count by groups is 0.
    #[error(
        "the multihomogeneous Bezout number of these variable groups is 0: there is no isolated \
         solution, or the groups are not meant"
    )]
    NoPaths,
}

/// A mixed volume, where as many paths can be followed.
pub(crate) fn checked_volume(volume: u64) -> Result<u64, PlanError> {
    match volume {
        0 => {
            let why = "the mixed volume is 0: a system with these monomials has no isolated \
                       solution unless its coefficients are special";
            Err(PlanError::NoMixedCells(why.into()))
        }
        number if number > MAX_PATHS => Err(PlanError::TooManyPaths {
            start: StartKind::Polyhedral,
            number: Some(number),
            instead: String::new(),
        }),
        number => Ok(number),
    }
}
