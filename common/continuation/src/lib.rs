//! How one path is followed: start systems, homotopies, the tracker, endgames.
//!
//! In the order of a path's life: [`work`] says what is asked, [`prepared_work`] and
//! [`stage`] prepare it ([`prepared_family`] once for many targets, [`prepared_check`] to check reported
//! results), [`chart`] and [`homotopies`] make the program, [`start_systems`] and
//! [`start_points`] the beginning; [`predictor`], [`step_control`] and [`tracker`]
//! follow the path, [`endgames`] bring it to t = 0, [`path_result`] is what is left, one of the kinds of
//! [`item_result`];
//! [`asked_system`] holds it against all equations that are asked, [`local_dimension`] says
//! whether it is isolated, [`sharpening`] brings it to more digits, [`certification`] proves what is
//! there; [`bend`] says how it moves with its slice; these look at the [`points_at_targets`] of a stage. [`projection`] tells points apart by numbers.
//!
//! # A tour: two conics meet in four points
//!
//! ```
//! use cognate_continuation::homotopies::HomotopyKind;
//! use cognate_continuation::stage::PreparedStage;
//! use cognate_continuation::start_points::StartPoints;
//! use cognate_continuation::tracker::outcome::PathOutcome;
//! use cognate_continuation::tracker::settings::Settings;
//! use cognate_continuation::work::{Stage, Work};
//! use cognate_systems::{formats, polynomial};
//!
//! let text = "CONFIG END; INPUT variable_group x, y; function circle, hyperbola;
//!             circle = x^2 + y^2 - 5; hyperbola = x*y - 2; END;";
//! let system = formats::read("two conics", text.as_bytes())?.system;
//! // A stage says what is asked; it is pure data and could be sent to a worker.
//! let stage = Stage::new(
//!     Work::Track,
//!     HomotopyKind::StraightLine { parameters: Vec::new() },
//!     StartPoints::TotalDegree { degrees: polynomial::degrees(&system)?.total },
//!     Settings::default(),
//!     1,
//! );
//! let prepared = PreparedStage::new(&system, &stage, &|_| None)?;
//! // Two quadrics have four paths; eight may be followed at once.
//! let results = prepared.track(0..prepared.items(), 8);
//! let mut solutions = Vec::new();
//! for result in &results {
//!     assert_eq!(result.outcome, PathOutcome::Regular);
//!     // Ends are homogeneous: the first coordinate belongs to the affine chart.
//!     let end = result.endpoint.to_double();
//!     let (x, y) = (end[1] / end[0], end[2] / end[0]);
//!     solutions.push((x.re.round() as i32, y.re.round() as i32));
//! }
//! solutions.sort();
//! assert_eq!(solutions, [(-2, -1), (-1, -2), (1, 2), (2, 1)]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Homotopies and starts
//!
//! A homotopy is a program F(x; p) whose parameters p move ([`homotopies`]). Start points are made from their
//! index where a formula exists ([`start_systems`]), and are stored points elsewhere ([`start_points`]):
//!
//! | start | points | homotopy |
//! |---|---|---|
//! | total degree, groups, linear products | by index | straight line to the start system |
//! | mixed cells | by index, cell by cell | toric to a generic system, then straight line from it |
//! | slices (regeneration) | stored, level by level | a slice moves, then a product becomes an equation |
//! | solutions of another member of a family | stored | parameters |
//! | the user's | stored | the user's own path variable |
//!
//! # Robust mode
//!
//! With `reach` above 0 ([`tracker::settings`]) Taylor series of the path show where it goes (by Padé
//! approximants), where its nearest singularity lies, and how near the nearest other path is (Telen, Van Barel,
//! Verschelde 2020). Steps stay clear of both. A step after which another path is too near is taken back. Paths
//! that met are tracked again in this mode.
#![forbid(unsafe_code)]

pub mod asked_system;
pub mod bend;
pub mod certification;
pub mod chart;
pub mod endgames;
pub mod homotopies;
pub mod item_result;
pub mod local_dimension;
mod moved_parameters;
pub mod path_result;
pub mod points_at_targets;
pub mod predictor;
mod prepare_error;
pub mod prepared_check;
pub mod prepared_family;
pub mod prepared_items;
pub mod prepared_work;
pub mod projection;
mod refine;
pub mod sharpening;
pub mod stage;
mod start_fit;
pub mod start_points;
pub mod start_systems;
pub mod step_control;
pub mod tracker;
pub mod work;
