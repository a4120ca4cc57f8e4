//! `cognate-worker`: read the configuration, connect, run, drain on signal.
#![forbid(unsafe_code)]

use clap::Parser;
use cognate_worker::config::Arguments;
use std::process::ExitCode;

/// Tracks paths for a coordinator.
#[derive(Parser)]
#[command(name = "cognate-worker", version)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

fn main() -> ExitCode {
    let command = Command::parse();
    cognate_worker::log::to_standard_error(command.arguments.log_format);
    ExitCode::from(cognate_worker::command::execute(command.arguments))
}
