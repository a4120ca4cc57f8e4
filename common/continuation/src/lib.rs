//! How one path is followed: start systems, homotopies, the tracker, endgames.
#![forbid(unsafe_code)]

pub mod homotopies;
pub mod path_result;
pub mod start_points;
pub mod start_systems;
pub mod tracker;
pub mod work;
