//! The wire: generated messages, checked conversions, digests.
//!
//! [`v1`] is generated from `proto/`; [`from_proto`] checks every field on its
//! way in, [`to_proto`] cannot fail. [`submission`] is what a client asks for, [`option_misfit`] what of it does not go together,
//! [`file_settings`] what a file's settings mean for it,
//! [`client_json`] how clients show answers, [`decoded_size`] what a message takes in memory, [`digest`] names a system by its content, [`records`] is the form in which
//! results are stored and hashed, [`stage_bytes`] that in which stages are stored.
#![forbid(unsafe_code)]

pub mod client_json;
pub mod decoded_size;
pub mod digest;
pub mod error;
pub mod file_settings;
mod flat_result;
pub mod from_proto;
pub mod limits;
pub mod option_misfit;
pub mod records;
pub mod stage_bytes;
pub mod submission;
pub mod to_proto;

/// Messages and services, generated from `proto/`.
#[allow(missing_docs, clippy::all, rustdoc::all)]
pub mod v1 {
    tonic::include_proto!("cognate.v1");
}

/// The encoded descriptor set of all messages and services, for reflection.
pub const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/cognate.v1.bin"));

/// The address that a coordinator listens on unless told otherwise.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:7654";

/// Grows when coordinators and workers of two versions cannot work together.
pub const PROTOCOL_VERSION: u32 = 2;
