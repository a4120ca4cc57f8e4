//! Certification: a proof that one box holds exactly one solution, or why there is none.
//!
//! [`Certificate`] is what is proved, [`Krawczyk`] proves it for points near solutions,
//! [`CertificationStage`] is that as the work of a stage. Nothing here compares two points: whether
//! certified solutions are distinct or real is `solutions`' business.

mod candidate;
mod certificate;
mod chart;
mod in_lanes;
mod krawczyk;
mod limits;
mod multiple_precision;
mod proved;
mod stage;

pub use candidate::Candidate;
pub use certificate::{Certificate, Certification, Uncertified};
pub use krawczyk::Krawczyk;
pub use multiple_precision::MOST_BITS;
pub use stage::{CertificationStage, certified_system};
