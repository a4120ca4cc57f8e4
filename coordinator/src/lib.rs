//! The server of paths and its command-line client.
#![forbid(unsafe_code)]

pub mod api;
pub mod chunks;
pub mod client;
pub mod config;
pub mod intake;
pub mod ledger;
pub mod signals;
pub mod transport;
