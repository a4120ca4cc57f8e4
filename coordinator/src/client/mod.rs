//! The command-line client: arguments, one connection, commands, output.
//!
//! `main` parses, refuses what is not in this version, runs one command, and
//! turns what came of it into an exit code.

pub mod arguments;
pub mod commands;
pub mod connection;
pub mod error;
pub mod not_yet;
pub mod output;
pub mod problem;
