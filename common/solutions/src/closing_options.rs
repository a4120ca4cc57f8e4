//! ClosingOptions: what follows once the isolated solutions of a solve are found.

/// Options for the steps after the solutions are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClosingOptions {
    /// Whether the solutions are certified.
    pub certify: bool,
    /// Decimal digits of the solutions; `None`: those of the precision in which paths are tracked.
    pub digits: Option<u32>,
    /// Whether isolated singular solutions are brought to their digits by deflation.
    pub deflate: bool,
    /// Whether the answer rests on the paths alone: the solutions are not counted by elimination over a prime field,
    /// neither at the end nor to leave paths unfollowed.
    pub no_exact_count: bool,
    /// Whether points of least residual are looked for from the ends of excess paths, where the equations have no common
    /// solution: all paths are then followed to their ends.
    pub approximate: bool,
}
