//! Support code that the tests share.
#![deny(unsafe_code)]

pub mod any_bytes;
pub mod arguments;
pub mod builders;
pub mod client;
pub mod close_paths;
pub mod cluster;
#[allow(unsafe_code)]
pub mod coverage;
pub mod database;
pub mod dice;
pub mod families;
pub mod limited;
pub mod measures;
pub mod namespaces;
pub mod planted;
pub mod processes;
pub mod server;
pub mod six_revolute;
pub mod skip;
pub mod storage;
pub mod subjects;
pub mod systems;
pub mod tally;
