//! Units: which powers of two give a system's coefficients ordinary sizes.

mod fit;
mod magnitudes;

pub use fit::{coefficient_range, scaling_of};
