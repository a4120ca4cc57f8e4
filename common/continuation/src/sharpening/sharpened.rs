//! Sharpened: a point with many digits, or why there is none.

use cognate_numeric::rational::ComplexRational;
use serde::{Deserialize, Serialize};

/// More decimal digits than these are not asked for.
pub const MOST_DIGITS: u32 = 1000;

/// A point that solves all equations to the digits that were asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sharpened {
    /// Values of the variables, dyadic, each to the digits that were asked for and a few more; in a
    /// homogeneous group the largest is 1.
    pub values: Vec<ComplexRational>,
    /// The last Newton correction, relative to each coordinate: the error is smaller.
    pub accuracy: f64,
    /// How often the equations were deflated until the point was a regular solution: 0 for one of
    /// theirs, and less than its multiplicity.
    pub deflations: u32,
    /// Bits of the arithmetic that sufficed.
    pub precision_bits: u32,
}

/// Why a point was not sharpened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Unsharpened {
    /// The point has the wrong number of coordinates, or some that are not finite.
    DamagedPoint,
    /// Neither the equations nor what was made of them by deflation has a regular solution there.
    NotRegular,
    /// Newton's method leaves the point: there may be no solution near it.
    NewtonLeaves,
}

impl Unsharpened {
    /// The reason in words, for people.
    pub fn describe(self) -> &'static str {
        match self {
            Self::DamagedPoint => "the point is damaged",
            Self::NotRegular => "no deflation makes it a regular solution",
            Self::NewtonLeaves => "Newton's method leaves it",
        }
    }
}

/// The outcome of one attempt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Sharpening {
    /// The point.
    Sharpened(Box<Sharpened>),
    /// None, and why.
    Unsharpened(Unsharpened),
}

impl Sharpened {
    /// True when its parts belong together: read from outside, it may be anything.
    pub fn is_sound(&self) -> bool {
        self.accuracy >= 0.0 && self.accuracy < 1.0
    }
}
