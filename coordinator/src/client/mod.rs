//! The command-line client: arguments, one connection, commands, output.
//!
//! `main` parses, refuses what is not in this version, runs one command, and
//! turns what came of it into an exit code.

pub mod arguments;
pub mod commands;
pub mod common_arguments;
pub mod config_file;
pub mod connection;
pub mod embedded;
pub mod error;
pub mod fleet;
pub mod mechanism;
pub mod not_yet;
pub mod output;
pub mod problem;
pub mod sets;
pub mod synthesis;

use arguments::{Arguments, Command};
use clap::Parser;
use error::{ClientError, Exit};
use std::process::ExitCode;
use tokio::signal::unix::{SignalKind, signal};

/// The `cognate` command.
pub fn main() -> ExitCode {
    let command = Arguments::parse().command;
    let ended = match not_yet::refuse(&command) {
        Err(e) => Err(e),
        // A worker has a runtime and an exit code of its own.
        Ok(()) => match command {
            Command::Worker(a) => return commands::worker::run(a),
            Command::Info(a) => commands::info::run(&a),
            Command::Convert(a) => commands::convert::run(&a),
            Command::Path(a) => commands::path::run(&a),
            Command::Mechanism(a) => commands::mechanism::run(&a),
            other => in_runtime(other),
        },
    };
    let exit = match &ended {
        Ok(exit) => *exit,
        Err(e) => {
            eprintln!("error: {e}");
            e.exit()
        }
    };
    ExitCode::from(exit as u8)
}

/// Runs a command that talks to a service, or is one.
fn in_runtime(command: Command) -> Result<Exit, ClientError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(|e| ClientError::Local(format!("the runtime could not be started: {e}")))?;
    runtime.block_on(async {
        match command {
            // These stop in an orderly way of their own.
            Command::Coordinator(a) => commands::coordinator::run(&a).await,
            Command::Solve(a) => commands::solve::run(&a).await,
            Command::Decompose(a) => commands::decompose::run(&a).await,
            Command::Synthesize(a) => commands::synthesize::run(&a).await,
            Command::Member(a) => commands::question::member(&a).await,
            Command::Sample(a) => commands::question::sample(&a).await,
            Command::Project(a) => commands::question::project(&a).await,
            Command::Multidegree(a) => commands::question::multidegree(&a).await,
            Command::Mobility(a) => commands::question::mobility(&a).await,
            Command::Certify(a) => commands::question::certify(&a).await,
            Command::RealCurve(a) => commands::question::real_curve(&a).await,
            other => tokio::select! {
                ended = one_shot(other) => ended,
                () = interrupted() => Err(ClientError::Interrupted),
            },
        }
    })
}

/// A command that may be dropped at any moment.
async fn one_shot(command: Command) -> Result<Exit, ClientError> {
    use commands::{cancel, explain, fleet, jobs, results, submit, watch, workers};
    match command {
        Command::Submit(a) => submit::run(&a).await,
        Command::Watch(a) => watch::run(&a).await,
        Command::Results(a) => results::run(&a).await,
        Command::Explain(a) => explain::run(&a).await,
        Command::Cancel(a) => cancel::run(&a).await,
        Command::Jobs(a) => jobs::run(&a).await,
        Command::Workers(a) => workers::run(&a).await,
        Command::Fleet(a) => fleet::run(&a).await,
        Command::Solve(_)
        | Command::Info(_)
        | Command::Convert(_)
        | Command::Path(_)
        | Command::Mechanism(_)
        | Command::Decompose(_)
        | Command::Member(_)
        | Command::Sample(_)
        | Command::Project(_)
        | Command::Multidegree(_)
        | Command::Mobility(_)
        | Command::RealCurve(_)
        | Command::Certify(_)
        | Command::Coordinator(_)
        | Command::Worker(_)
        | Command::Synthesize(_) => unreachable!("these were run before"),
    }
}

/// Returns when somebody wants this process to end.
pub async fn interrupted() {
    let waiting = (
        signal(SignalKind::interrupt()),
        signal(SignalKind::terminate()),
    );
    match waiting {
        (Ok(mut interrupt), Ok(mut terminate)) => {
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
            }
        }
        // Without handlers the signals end the process by themselves.
        _ => std::future::pending().await,
    }
}
