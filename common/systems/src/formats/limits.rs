//! Limits: how large an input may be. Every reader refuses what is larger,
//! and the error names the limit; all of them stand here and nowhere else.

/// A named bound on something that an input holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    /// The name that errors give.
    pub name: &'static str,
    /// Plural noun for the things that are counted.
    pub what: &'static str,
    /// The largest number that is accepted.
    pub value: u64,
}

const fn limit(name: &'static str, what: &'static str, value: u64) -> Limit {
    Limit { name, what, value }
}

/// Size of a problem, symmetry or degenerate file; the largest real one known to us has 1 MB.
pub const FILE_BYTES: Limit = limit("FILE_BYTES", "bytes in a file", 16 << 20);
/// Size of a file with start solutions or parameters: about 10^6 points of 8 coordinates.
pub const POINT_FILE_BYTES: Limit =
    limit("POINT_FILE_BYTES", "bytes in a file of points", 512 << 20);
/// Sets of values of the parameters in one solve.
pub const TARGETS: Limit = limit("TARGETS", "sets of target parameters", 1_000_000);
/// Values in all sets of target parameters together; one takes 16 bytes.
pub const TARGET_VALUES: Limit = limit(
    "TARGET_VALUES",
    "values in all sets of target parameters",
    20_000_000,
);
/// Variables of a system; linear algebra here is dense.
pub const VARIABLES: Limit = limit("VARIABLES", "variables", 1_000);
/// Equations of a system.
pub const EQUATIONS: Limit = limit("EQUATIONS", "equations", 1_000);
/// Parameters of a system.
pub const PARAMETERS: Limit = limit("PARAMETERS", "parameters", 10_000);
/// Different subexpressions of a system; a node takes about 200 bytes.
pub const NODES: Limit = limit("NODES", "different subexpressions", 1_000_000);
/// Numbers, names and operations written in a file.
pub const OPERATIONS: Limit = limit("OPERATIONS", "numbers, names and operations", 4_000_000);
/// Numbers, names and operations in one expression: a file of 1 MB, the largest real one known to us, has no more. A
/// longer expression is refused while it is read, before a graph is made of it.
pub const EXPRESSION_OPERATIONS: Limit = limit(
    "EXPRESSION_OPERATIONS",
    "numbers, names and operations in one expression",
    1_000_000,
);
/// Brackets, signs and powers that are open at one place.
pub const NESTING: Limit = limit("NESTING", "levels of nesting", 10_000);
/// Arrays and objects that are open at one place of a JSON text.
pub const JSON_NESTING: Limit = limit("JSON_NESTING", "levels of nesting in JSON", 32);
/// Values of a JSON text; one takes about 64 bytes.
pub const JSON_VALUES: Limit = limit("JSON_VALUES", "values in JSON", 4_000_000);
/// Absolute value of an exponent, numerator and denominator of a rational one.
pub const EXPONENT: Limit = limit("EXPONENT", "as exponent", 100_000);
/// Degree of an equation.
pub const DEGREE: Limit = limit("DEGREE", "as degree of an equation", 100_000);
/// Digits of a number.
pub const NUMBER_DIGITS: Limit = limit("NUMBER_DIGITS", "digits of a number", 10_000);
/// Power of ten of a number in scientific notation; double precision ends at 308.
pub const NUMBER_EXPONENT: Limit = limit("NUMBER_EXPONENT", "as power of ten of a number", 10_000);
/// Bits of an exact constant, numerators and denominators together.
pub const CONSTANT_BITS: Limit = limit("CONSTANT_BITS", "bits of an exact constant", 1 << 17);
/// Bits of all exact constants that are used or computed while reading: bounds
/// the time of hostile files too, to about a second.
pub const TOTAL_CONSTANT_BITS: Limit = limit(
    "TOTAL_CONSTANT_BITS",
    "bits of all exact constants",
    1 << 30,
);
