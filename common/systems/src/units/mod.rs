//! Units: which powers of two give a system's coefficients ordinary sizes.

mod fit;
mod magnitudes;

pub use fit::{Fit, fit, scaling_of};
