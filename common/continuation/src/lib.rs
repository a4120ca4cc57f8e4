//! How one path is followed: start systems, homotopies, the tracker, endgames.
//!
//! In the order of a path's life: [`work`] says what is asked, [`prepared_work`] and
//! [`stage`] prepare it, [`chart`] and [`homotopies`] make the program, [`start_systems`] and
//! [`start_points`] the beginning; [`predictor`], [`step_control`] and [`tracker`]
//! follow the path, [`endgames`] bring it to t = 0, [`path_result`] is what is left;
//! [`asked_system`] holds it against all equations that are asked, [`local_dimension`] says
//! whether it is isolated, [`sharpening`] brings it to more digits, [`certification`] proves what is
//! there; these look at the [`points_at_targets`] of a stage. [`projection`] tells points apart by numbers.
//! `examples/two_conics.rs` is a whole solve in thirty lines.
#![forbid(unsafe_code)]

pub mod asked_system;
pub mod certification;
pub mod chart;
pub mod endgames;
pub mod homotopies;
pub mod local_dimension;
pub mod path_result;
pub mod points_at_targets;
pub mod predictor;
pub mod prepared_work;
pub mod projection;
mod refine;
pub mod sharpening;
pub mod stage;
pub mod start_points;
pub mod start_systems;
pub mod step_control;
pub mod tracker;
pub mod work;
