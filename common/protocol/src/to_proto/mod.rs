//! Conversion outwards: it cannot fail.

pub mod path;
pub mod problem;
pub mod question;
pub mod solution;

use crate::v1;
use cognate_continuation::start_points::{Digest, StoredPoints};
use num_complex::Complex64;

/// A digest as bytes.
pub fn digest(digest: Digest) -> bytes::Bytes {
    bytes::Bytes::copy_from_slice(&digest.0)
}

fn complex(z: &Complex64) -> v1::Complex {
    v1::Complex { re: z.re, im: z.im }
}

fn complexes(values: &[Complex64]) -> Vec<v1::Complex> {
    values.iter().map(complex).collect()
}

fn pairs(values: &[Complex64]) -> Vec<f64> {
    values.iter().flat_map(|z| [z.re, z.im]).collect()
}

/// Points.
pub fn points(points: &StoredPoints) -> v1::Points {
    v1::Points {
        dimension: small(points.dimension),
        coordinates: pairs(&points.coordinates),
    }
}

/// Indices of a checked system are small.
fn small(index: usize) -> u32 {
    u32::try_from(index).expect("a checked system has fewer than 2^32 of anything")
}
