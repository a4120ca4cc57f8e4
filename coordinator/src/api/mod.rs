//! The services: decode, one call inwards, encode.

pub mod error;
