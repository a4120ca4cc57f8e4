//! Mechanisms: from points that a person gives, and solutions that the service finds, to linkages
//! that can be built. Knows no service: equations and numbers only.
//!
//! In reading order: points and angles of the plane; a linkage and its type; what driving it does;
//! what it is worth; the nine-point problem, from points to classes of linkages; its sisters: five poses
//! of a body, five points with the angles of the crank, five pairs of angles, and mixtures of poses and points;
//! chains of two or three joints in space.
//!
//! ```
//! use cognate_kinematics::linkage::{Linkage, Mobility, Side};
//! use num_complex::Complex64;
//!
//! let at = |x: f64, y: f64| Complex64::new(x, y);
//! let linkage = Linkage {
//!     pivots: [at(0.0, 0.0), at(4.0, 0.0)],
//!     joints: [at(0.0, 1.0), at(3.0, 2.8)],
//!     point: at(1.0, 3.0),
//! };
//! let mobility = linkage.lengths().mobility();
//! assert_eq!(mobility, Mobility::CrankRocker(Side::A));
//! assert_eq!(mobility.circuits(), 2);
//! ```
#![forbid(unsafe_code)]

pub mod assessment;
pub mod body_guidance;
pub mod compile;
pub mod coupler_curve;
pub mod design;
pub mod drive;
mod four_unknowns;
pub mod function_generation;
pub mod import;
pub mod linkage;
pub mod mechanism;
pub mod nine_point;
pub mod path_timing;
pub mod plane;
pub mod polygon;
pub mod poses_and_points;
pub mod real_arm;
pub mod shape;
#[cfg(test)]
mod simulation;
pub mod spatial_dyads;
#[cfg(test)]
mod test_linkages;
pub mod timed_poses;
