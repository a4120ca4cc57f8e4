//! Conversion outwards: it cannot fail.

pub mod path;
pub mod problem;
pub mod question;
pub mod solution;

use crate::v1;
use cognate_continuation::start_points::Digest;
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
