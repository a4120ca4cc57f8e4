//! Positions of mechanisms: a mechanism is prepared once, then any number of poses or inputs is answered by paths that are
//! followed in this process.
//!
//! [`PreparedMechanism`] holds the equations and the positions of a general complex member of the mechanism's family
//! ([`start_positions`]), from which a parameter homotopy leads to each target; [`Postures`] is the answer for one target,
//! every path counted; [`closed_form`] answers most arms without paths; [`follow`](follow::follow) joins the answers along a path of targets to branches and proves folds;
//! [`families`] solves general members of families anew and compares their number with the published one; [`cache`] keeps
//! start positions on disk; [`local`] says how a mechanism moves near one configuration,
//! [`workspace`] which points its output reaches.
//!
//! ```
//! use cognate_kinematics::compile::{Problem, Question};
//! use cognate_kinematics::mechanism::{ReadOptions, pose::Pose, read};
//! use cognate_mechanism_solver::{AnswerOptions, PreparedMechanism};
//!
//! let table = b"theta,d,a,alpha,type\n0,0.2,0,90,revolute\n0,0,0.5,0,revolute\n0,0,0.4,0,revolute\n\
//!     0,0.1,0,90,revolute\n0,0.1,0,-90,revolute\n0,0.08,0,0,revolute\n";
//! let arm = read("arm.csv", table, &ReadOptions::default()).expect("a table of six revolute joints");
//! let question = Question::of(Problem::Inverse);
//! let prepared = PreparedMechanism::new(&arm, &question, &AnswerOptions::default()).expect("it can be prepared");
//! let pose = Pose::real([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0.4, 0.3, 0.35]);
//! let postures = &prepared.inverse(&[pose]).expect("one answer for one pose")[0];
//! assert!(postures.settled && postures.counts.sum() == postures.counts.complex);
//! ```
#![forbid(unsafe_code)]

pub mod approximate;
mod arm_loop;
pub mod cache;
pub mod closed_form;
pub mod families;
pub mod follow;
mod followed_paths;
pub mod local;
mod parallel;
pub mod point_arm;
pub mod postures;
pub mod preparation;
pub mod prepared_mechanism;
mod self_motion;
mod special_pose;
pub mod start_positions;
pub mod summary;
pub mod sweep;
pub mod workspace;

pub use postures::Postures;
pub use preparation::AnswerOptions;
pub use prepared_mechanism::PreparedMechanism;
