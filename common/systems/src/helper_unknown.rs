//! Helper unknowns: unknowns beside those that were typed, which make equations with roots and angles polynomial.
//!
//! A root is an unknown h with the equation h^q = radicand, an angle a pair c, s with c^2 + s^2 = 1. The polynomial
//! equations have all roots of a radicand; a solution with another than the one that was typed is on a false branch. Where an
//! angle occurs as x and as x/2, the pair is that of x/2: other multiples are polynomials in it.

use crate::expression::NodeId;

/// The name under which points of false branches are counted.
pub const FALSE_BRANCH: &str = "false branch";

/// Largest power of pi in the unit of an angle.
pub const MOST_PI_POWER: u32 = 8;

/// An unknown, or a pair of them, that stands for functions of others.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Helper {
    /// A root of an expression.
    Root(RootUnknown),
    /// Cosine and sine of an angle.
    Angle(AngleUnknowns),
}

/// An unknown whose power is a radicand.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct RootUnknown {
    /// Index of the unknown.
    pub variable: usize,
    /// The power of the unknown that is the radicand; at least 2.
    pub degree: u32,
    /// The radicand, which may hold helpers and denominators.
    pub radicand: NodeId,
    /// The root that is meant.
    pub branch: Branch,
}

impl RootUnknown {
    /// The function that the unknown stands for, of a radicand with this text.
    pub fn function(&self, radicand: &str) -> String {
        match (self.branch, self.degree) {
            (Branch::Real, _) => format!("cbrt({radicand})"),
            (Branch::Principal, 2) => format!("sqrt({radicand})"),
            (Branch::Principal, degree) => format!("({radicand})^(1/{degree})"),
        }
    }
}

/// Choice of one root of a radicand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Branch {
    /// The principal one: its argument is above -pi/q and at most pi/q.
    Principal,
    /// The real root of a real radicand, the principal one of any other.
    Real,
}

/// The unknowns that stand for an angle.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct AngleUnknowns {
    /// Name of the angle as it was typed.
    pub name: String,
    /// Index of the unknown that is its cosine; it stands where the angle stood.
    pub cosine: usize,
    /// Index of the unknown that is its sine.
    pub sine: usize,
    /// Unit in which the angle was typed.
    pub unit: AngleUnit,
}

/// Unit of an angle: pi to some power, divided by an integer; radians are 1, degrees pi/180. Cosine and sine are those of
/// the typed angle times the unit.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct AngleUnit {
    /// The integer, at least 1.
    pub denominator: u32,
    /// The power of pi.
    pub pi_power: i32,
}

impl AngleUnit {
    /// Radians.
    pub const RADIAN: Self = Self {
        denominator: 1,
        pi_power: 0,
    };

    /// An angle of this name times the unit: `x`, `x/2`, `x*pi/180`.
    pub fn times(&self, name: &str) -> String {
        let mut text = name.to_owned();
        for _ in 0..self.pi_power {
            text.push_str("*pi");
        }
        for _ in self.pi_power..0 {
            text.push_str("/pi");
        }
        if self.denominator > 1 {
            text.push_str(&format!("/{}", self.denominator));
        }
        text
    }
}
