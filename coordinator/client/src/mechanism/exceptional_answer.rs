//! Exceptional answer: sets of values of open numbers over which more moves than in general.

/// A number that a file leaves open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FreeNumber {
    /// Name of the number.
    pub name: String,
    /// Whether only its square occurs, so that it is given positive.
    pub is_squared: bool,
}

/// A value of an open number.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// The value.
    pub number: f64,
    /// The short fraction or root that it is to rounding.
    pub exact: Option<String>,
}

/// Values over which more moves than in general.
#[derive(Clone, Debug, PartialEq)]
pub struct ExceptionalSet {
    /// Dimension of the set of values.
    pub dimension: u64,
    /// Freedoms at a general point of it.
    pub mobility: u64,
    /// Degree of the set of values.
    pub degree: Option<u64>,
    /// The points, of a set of dimension 0: values in the order of the open numbers.
    pub values: Vec<Vec<Value>>,
    /// Expressions that are 0 on a line.
    pub equations: Vec<String>,
}

/// The answer.
#[derive(Clone, Debug, PartialEq)]
pub struct ExceptionalAnswer {
    /// Name of the mechanism.
    pub name: String,
    /// The open numbers.
    pub free: Vec<FreeNumber>,
    /// Freedoms for general values; -1 where it cannot be assembled for them.
    pub generic: i64,
    /// The sets.
    pub sets: Vec<ExceptionalSet>,
    /// Components over single values that are not real.
    pub not_real: u64,
    /// Why the answer is not settled.
    pub doubts: Vec<String>,
}
