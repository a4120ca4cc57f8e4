//! NotCounted: why the solutions of a system are not counted without following paths.

/// Reason why there is no count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotCounted {
    /// The system has more unknowns than a monomial holds.
    #[error("the system has too many unknowns")]
    Unknowns,
    /// The system has a path variable, or a value is no number.
    #[error("the parameters have no values at which solutions can be counted")]
    Parameters,
    /// Terms that take too much, or no polynomial.
    #[error("the equations have too many terms")]
    Terms,
    /// Higher than a monomial holds.
    #[error("the degrees of the equations are too high")]
    Degree,
    /// A number without a residue.
    #[error("a number in the equations has no residue")]
    Constants,
    /// The budget is spent.
    #[error("a count takes too much")]
    Operations,
    /// Each of the linear forms has one value at several solutions, or is too special at a multiple one.
    #[error("no linear form that was tried tells the solutions apart")]
    NotSeparated,
    /// Rounding and general values leave more equations than unknowns no common solution.
    #[error(
        "the equations are more than the unknowns, and not all numbers in them are exact and rational"
    )]
    NotExact,
}
