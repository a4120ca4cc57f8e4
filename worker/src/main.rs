//! `cognate-worker`: read the configuration, connect, run, drain on signal.
#![forbid(unsafe_code)]

use clap::Parser;
use cognate_worker::config::Arguments;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// Tracks paths for a coordinator.
#[derive(Parser)]
#[command(name = "cognate-worker", version)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

fn main() -> ExitCode {
    let filter = EnvFilter::try_from_env("RUST_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .init();
    let command = Command::parse();
    ExitCode::from(cognate_worker::command::execute(command.arguments))
}
