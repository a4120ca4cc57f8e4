//! Units: which powers of two give a system's coefficients ordinary sizes.

mod centre;
mod fit;
mod magnitudes;

pub use centre::about_centre;
pub use fit::{Fit, fit, scaling_of};
