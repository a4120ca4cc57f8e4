//! Witness sets: solution sets of every dimension, by the points that general linear slices cut out of them.
//!
//! [`witness_set`] is one irreducible component, or what could not be told apart; [`evidence`] says what
//! the claim rests on; [`decomposition`] is all of them, with counts that add up in each dimension; [`method`] how they were found.
//! [`family`] says what components of a general member of a family become at other values of its parameters.
//! [`bertini`] writes and reads the files of Bertini; [`known_components`] are cut by further equations; [`question`] is what can be asked about them afterwards, [`answer`] what is said then, with [`real_curve`] and [`real_surface`] among it.
//! (Sommese, Wampler: The Numerical Solution of Systems of Polynomials, 2005, chapters 13 and 15.)

pub mod answer;
pub mod bertini;
pub mod decomposition;
pub mod evidence;
pub mod family;
pub mod known_components;
pub mod method;
pub mod question;
pub mod real_curve;
pub mod real_surface;
pub mod topology;
pub mod witness_set;

pub use answer::Answer;
pub use decomposition::{Decomposition, Dimension, RemovedComponent, TrackedPaths};
pub use evidence::{Doubt, Evidence, Proof, Trace};
pub use family::{CarriedComponent, Family};
pub use known_components::KnownComponents;
pub use method::{Method, Verification};
pub use question::Question;
pub use witness_set::{ComponentId, Irreducible, Multiplicity, WitnessSet, sharing_slices};
