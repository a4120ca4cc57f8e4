//! Notation: the notations of systems, as they are typed.

use clap::ValueEnum;
use cognate_systems::formats::Format;

/// The notations that `cognate convert` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Notation {
    /// Bertini-classic input
    Bertini,
    /// PHCpack's format
    Phcpack,
    /// Our own JSON
    Json,
    /// Macaulay2: a ring and an ideal
    Macaulay2,
    /// Maple: lists of variables and of polynomials
    Maple,
    /// Singular: a ring and an ideal
    Singular,
    /// msolve: variables, characteristic, polynomials, multiplied out
    Msolve,
    /// Equations, one a line
    Plain,
}

impl Notation {
    /// The notation itself.
    pub fn format(self) -> Format {
        match self {
            Self::Bertini => Format::Bertini,
            Self::Phcpack => Format::Phcpack,
            Self::Json => Format::Json,
            Self::Macaulay2 => Format::Macaulay2,
            Self::Maple => Format::Maple,
            Self::Singular => Format::Singular,
            Self::Msolve => Format::Msolve,
            Self::Plain => Format::Plain,
        }
    }
}
