//! Helper unknowns: unknowns beside those that were typed, which make equations with roots and angles polynomial.
//!
//! A root is an unknown h with the equation h^q = radicand, an angle a pair c, s with c^2 + s^2 = 1. The polynomial
//! equations have all roots of a radicand; a solution with another than the one that was typed is on a false branch.

use crate::expression::NodeId;

/// The name under which points of false branches are counted.
pub const FALSE_BRANCH: &str = "false branch";

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
}
