//! Sharpened: a point with many digits, or why there is none.

use cognate_numeric::rational::ComplexRational;
use cognate_systems::scaling::{Scaling, exact_times};
use cognate_systems::system::VariableGroup;
use serde::{Deserialize, Serialize};

/// Most decimal digits that can be asked for.
pub const MOST_DIGITS: u32 = 1000;

/// A point that solves all equations to the digits that were asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sharpened {
    /// Values of the variables, dyadic, each to the digits that were asked for and a few more; in a
    /// homogeneous group the largest is 1.
    pub values: Vec<ComplexRational>,
    /// The last Newton correction, relative to each coordinate: the error is smaller.
    pub accuracy: f64,
    /// Number of deflations until the point was a regular solution: 0 for a regular solution of the equations, and less
    /// than its multiplicity.
    pub deflations: u32,
    /// Bits of the arithmetic that sufficed.
    pub precision_bits: u32,
}

/// Reason why a point was not sharpened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Unsharpened {
    /// The point has the wrong number of coordinates, or some that are not finite.
    DamagedPoint,
    /// Neither the equations nor their deflations have a regular solution there.
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
    /// The sharpened point.
    Sharpened(Box<Sharpened>),
    /// No sharpened point, and the reason.
    Unsharpened(Unsharpened),
}

impl Sharpened {
    /// The point in the variables, from the unknowns that are tracked. In a homogeneous group what
    /// is 1 stays 1: all values stay dyadic.
    pub(super) fn in_variables(mut self, scaling: &Scaling, groups: &[VariableGroup]) -> Self {
        if scaling.is_none() {
            return self;
        }
        for group in groups {
            let ones = group.variables.iter().filter(|_| group.homogeneous);
            let fixed = ones.copied().find(|&v| self.values[v].is_one());
            let of_fixed = fixed.map_or(0, |v| scaling.exponent(v));
            for &v in &group.variables {
                let exponent = i64::from(scaling.exponent(v) - of_fixed);
                self.values[v] = exact_times(&self.values[v], exponent);
            }
        }
        self
    }

    /// True when its parts belong together: read from outside, it may be anything.
    pub fn is_sound(&self) -> bool {
        self.accuracy >= 0.0 && self.accuracy < 1.0
    }
}
