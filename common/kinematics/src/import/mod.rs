//! Mechanisms from files of other programs: URDF, tables of Denavit and Hartenberg.

pub mod dh;
mod dh_variable;
pub mod urdf;
mod xml_limits;
