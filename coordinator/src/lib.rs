//! The server of paths and its command-line client.
#![forbid(unsafe_code)]

pub mod chunks;
pub mod client;
pub mod ledger;
