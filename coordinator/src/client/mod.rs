//! The command-line client: arguments, one connection, commands, output.

pub mod error;
pub mod output;
