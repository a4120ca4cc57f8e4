//! Checked conversion inwards: every field, every length, every index.

mod expression_graph;
mod method;
mod options;
pub mod path;
pub mod problem;
pub mod question;
pub mod solution;
mod system;

use crate::error::{ProtocolError, within_limit};
use crate::limits;
use crate::v1;
use cognate_continuation::start_points::{Digest, StoredPoints};
use num_complex::Complex64;

/// A digest, 32 bytes long.
pub fn digest(field: &str, bytes: &[u8]) -> Result<Digest, ProtocolError> {
    bytes.try_into().map(Digest).map_err(|_| {
        ProtocolError::invalid(
            field,
            format!("{} bytes", bytes.len()),
            "a digest of 32 bytes",
        )
    })
}

/// A number that a message leaves out where it has none.
fn required<T>(field: &str, value: Option<T>) -> Result<T, ProtocolError> {
    value.ok_or_else(|| ProtocolError::missing(field))
}

/// Pairs of doubles as complex numbers, not necessarily finite.
fn pairs(field: &str, doubles: &[f64]) -> Result<Vec<Complex64>, ProtocolError> {
    if !doubles.len().is_multiple_of(2) {
        return Err(ProtocolError::invalid(
            field,
            format!("{} doubles", doubles.len()),
            "real and imaginary part of every coordinate",
        ));
    }
    let pairs = doubles.chunks_exact(2);
    Ok(pairs.map(|z| Complex64::new(z[0], z[1])).collect())
}

/// An element of a list, as it stands in the names of fields.
fn at(field: &str, index: usize) -> String {
    format!("{field}[{index}]")
}

/// Complex numbers, all finite.
fn complexes(field: &str, m: &[v1::Complex]) -> Result<Vec<Complex64>, ProtocolError> {
    let values: Vec<_> = m.iter().map(|z| Complex64::new(z.re, z.im)).collect();
    finite(field, &values)?;
    Ok(values)
}

/// The first coordinate that is not finite.
fn finite(field: &str, values: &[Complex64]) -> Result<(), ProtocolError> {
    match values.iter().position(|z| !z.is_finite()) {
        None => Ok(()),
        Some(i) => Err(ProtocolError::invalid(
            format!("{field}[{i}]"),
            values[i],
            "finite numbers",
        )),
    }
}

/// Points, all coordinates finite.
pub fn points(m: &v1::Points) -> Result<StoredPoints, ProtocolError> {
    within_limit("dimension", m.dimension as usize, limits::COORDINATES)?;
    let coordinates = pairs("coordinates", &m.coordinates)?;
    let dimension = m.dimension as usize;
    if dimension == 0 || !coordinates.len().is_multiple_of(dimension) {
        return Err(ProtocolError::invalid(
            "coordinates",
            format!("{} coordinates", coordinates.len()),
            format!("a multiple of the dimension {dimension}, which is not 0"),
        ));
    }
    finite("coordinates", &coordinates)?;
    Ok(StoredPoints {
        dimension,
        coordinates,
    })
}
