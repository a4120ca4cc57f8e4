//! Values of parameters that differ from given ones by as much as rounding to doubles can make them differ.

use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// Values are moved by this part of themselves: four units of the last place of a double near 1.
const PART: f64 = 4.0 * f64::EPSILON;

/// The values, each moved by a fixed complex number of size [`PART`] times the value.
pub(crate) fn moved(values: &[Complex64]) -> Vec<Complex64> {
    let mut stream = RandomStream::new(0, Purpose::Probe, 1);
    let moved = |value: &Complex64| value + value * stream.unit() * PART;
    values.iter().map(moved).collect()
}
