//! Arms of three joints that place a point: cusps of the critical values, whether a posture changes without a singularity, and
//! the largest number of postures.
//!
//! With the first joint free, distance from its axis and height are functions of the second and third joint
//! ([`plane_map`]). Critical values are those at which the determinant of this map is 0; [`cusps`] counts their cusps. The
//! postures at a place are the roots of a polynomial ([`posture_polynomial`]).

pub mod changes;
pub mod contracted_lines;
pub mod cusps;
mod equations;
mod joint_polynomial;
pub mod most_postures;
pub mod plane_map;
pub mod posture_polynomial;
mod torus_roots;

pub use changes::{PostureChanges, posture_changes};
pub use most_postures::{MostPostures, most_postures};
