//! General point: one that no equation of a user has a special place for.

use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};

/// Denominator of the coordinates.
const DENOMINATOR: f64 = 1024.0;

/// The real coordinates of a general point, between -1 and 1: the same for each number of unknowns.
pub(super) fn general_point(unknowns: usize) -> Vec<ComplexRational> {
    let mut stream = RandomStream::new(0, Purpose::Probe, 1);
    let coordinate = |_| {
        let numerator = (stream.unit().re * DENOMINATOR).round() as i64;
        ComplexRational::real(Rational::from((numerator, DENOMINATOR as i64)))
    };
    (0..unknowns).map(coordinate).collect()
}
