//! How a mechanism moves near one configuration: freedoms to each order, the local dimension, and singularities.
//!
//! A configuration gives [`Assembly`](assembly::Assembly): the conditions that close its loops, in coordinates that are 0 there. They are
//! evaluated as truncated power series over a [`Field`](field::Field): residues modulo a large prime where file and configuration
//! are exact, else doubles, whose ranks must have a clear gap. [`local_ring`] solves for as many coordinates as the first
//! order allows; what is left is the local ring (Wampler, Hauenstein, Sommese: Mechanism mobility and a local dimension
//! test, Mech. Mach. Theory 46, 2011).

pub mod assembly;
pub mod conditions;
pub mod field;
pub mod local_ring;
pub mod mobility;
pub mod moved_parts;
pub mod nearby;
pub mod number_effects;
pub mod ranks;
pub mod series;
pub mod singularity;
mod steps;
