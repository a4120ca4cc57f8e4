//! The command-line client: arguments, one connection, commands, output.
//!
//! `main` parses, runs one command, and turns its result into an exit code.
#![forbid(unsafe_code)]

pub mod arguments;
pub mod commands;
pub mod common_arguments;
pub mod config_file;
pub mod connection;
mod correction;
pub mod embedded;
pub mod error;
pub mod fleet;
mod foreign_notation;
pub mod in_process;
mod input_lines;
pub mod interruption;
pub mod mechanism;
mod notation;
pub mod objective;
mod other_files;
mod other_words;
pub mod output;
pub mod problem;
pub mod problem_arguments;
pub mod remedy;
pub mod selection;
pub mod sets;
pub mod shell_arguments;
mod standard_input;
pub mod synthesis;
mod system_source;
mod text_change;

use self::mechanism::arguments::MechanismCommand;
use arguments::{Arguments, Command};
use clap::Parser;
use clap::error::ErrorKind;
use error::{ClientError, Exit};
use futures::future::LocalBoxFuture;
use interruption::unless_interrupted;
use remedy::TypedLine;
use std::process::ExitCode;

/// A command that was started.
enum Started {
    /// The command has ended; a worker has a runtime and exit codes of its own.
    Ended(ExitCode),
    /// The command has ended with this result.
    Done(Result<Exit, ClientError>),
    /// The command talks to a service, or is one, and stops in an orderly way of its own.
    Orderly(LocalBoxFuture<'static, Result<Exit, ClientError>>),
    /// The command talks to a service, and may be dropped at any moment.
    Droppable(LocalBoxFuture<'static, Result<Exit, ClientError>>),
}

/// Every command, and how it runs.
fn start(command: Command) -> Started {
    use Started::{Done, Droppable, Ended, Orderly};
    use commands::*;
    match command {
        Command::Worker(a) => Ended(worker::run(a)),
        Command::Info(a) => Done(info::run(&a)),
        Command::Convert(a) => Done(convert::run(&a)),
        Command::Completions(a) => Done(completions::completions(&a)),
        Command::Man(a) => Done(completions::manual(&a)),
        Command::Path(a) => Done(path::run(&a)),
        Command::Mechanism(MechanismCommand::Motion(a)) => {
            Orderly(Box::pin(async move { mechanism::motion::run(&a).await }))
        }
        Command::Mechanism(MechanismCommand::Exceptional(a)) => {
            Orderly(Box::pin(
                async move { mechanism::exceptional::run(&a).await },
            ))
        }
        Command::Mechanism(MechanismCommand::Singularities(a)) if a.at.is_none() => {
            Orderly(Box::pin(async move { mechanism::loci::run(&a).await }))
        }
        Command::Mechanism(a) => Done(mechanism::run(&a)),
        Command::Coordinator(a) => Orderly(Box::pin(async move { coordinator::run(&a).await })),
        Command::Solve(a) => Orderly(Box::pin(async move { solve::run(&a).await })),
        Command::Serve => Orderly(Box::pin(serve::run())),
        Command::Decompose(a) => Orderly(Box::pin(async move { decompose::run(&a).await })),
        Command::Exceptional(a) => Orderly(Box::pin(async move { exceptional::run(&a).await })),
        Command::Synthesize(a) => Orderly(Box::pin(async move { synthesize::run(&a).await })),
        Command::Member(a) => Orderly(Box::pin(async move { question::member(&a).await })),
        Command::Sample(a) => Orderly(Box::pin(async move { question::sample(&a).await })),
        Command::Project(a) => Orderly(Box::pin(async move { question::project(&a).await })),
        Command::Multidegree(a) => {
            Orderly(Box::pin(async move { question::multidegree(&a).await }))
        }
        Command::Mobility(a) => Orderly(Box::pin(async move { question::mobility(&a).await })),
        Command::Certify(a) => Orderly(Box::pin(async move { question::certify(&a).await })),
        Command::RealCurve(a) => Orderly(Box::pin(async move { question::real_curve(&a).await })),
        Command::RealSurface(a) => {
            Orderly(Box::pin(async move { question::real_surface(&a).await }))
        }
        Command::RealPoints(a) => Orderly(Box::pin(async move { question::real_points(&a).await })),
        Command::Intersect(a) => Orderly(Box::pin(async move { intersect::run(&a).await })),
        Command::SingularLocus(a) => {
            Orderly(Box::pin(async move { question::singular_locus(&a).await }))
        }
        Command::Submit(a) => Droppable(Box::pin(async move { submit::run(&a).await })),
        Command::Watch(a) => Droppable(Box::pin(async move { watch::run(&a).await })),
        Command::Results(a) => Droppable(Box::pin(async move { results::run(&a).await })),
        Command::Explain(a) => Droppable(Box::pin(async move { explain::run(&a).await })),
        Command::Cancel(a) => Droppable(Box::pin(async move { cancel::run(&a).await })),
        Command::Fsck(a) => Droppable(Box::pin(async move { fsck::run(&a).await })),
        Command::Backup(a) => Droppable(Box::pin(async move { backup::run(&a).await })),
        Command::Delete(a) => Droppable(Box::pin(async move { delete::run(&a).await })),
        Command::Jobs(a) => Droppable(Box::pin(async move { jobs::run(&a).await })),
        Command::Workers(a) => Droppable(Box::pin(async move { workers::run(&a).await })),
        Command::Top(a) => Droppable(Box::pin(async move { top::run(&a).await })),
        Command::Fleet(a) => Droppable(Box::pin(async move { fleet::run(&a).await })),
    }
}

/// The `cognate` command.
pub fn main() -> ExitCode {
    let typed = TypedLine::new(std::env::args_os());
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(refusal) => return not_parsed(&refusal, &typed),
    };
    let ended = match start(arguments.command) {
        Started::Ended(code) => return code,
        Started::Done(ended) => ended,
        Started::Orderly(running) => in_runtime(running),
        Started::Droppable(running) => in_runtime(unless_interrupted(running)),
    };
    let exit = match &ended {
        Ok(exit) => *exit,
        Err(e) => {
            eprintln!("error: {e}");
            if let Some(line) = typed.remedy(e) {
                eprintln!("{line}");
            }
            e.exit()
        }
    };
    ExitCode::from(exit as u8)
}

/// Shows help where it was asked for, else why the arguments are refused.
fn not_parsed(refusal: &clap::Error, typed: &TypedLine) -> ExitCode {
    if !refusal.use_stderr() {
        refusal.exit();
    }
    if typed.is_empty() {
        eprint!("{}", remedy::five_things());
    } else if refusal.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        refusal.exit();
    } else {
        let color = console::colors_enabled_stderr();
        eprint!("{}", typed.misunderstood(refusal, color));
    }
    ExitCode::from(Exit::BadInput as u8)
}

/// Runs a command that talks to a service, or is one.
fn in_runtime(
    running: impl Future<Output = Result<Exit, ClientError>>,
) -> Result<Exit, ClientError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(|e| ClientError::Local(format!("the runtime could not be started: {e}")))?;
    runtime.block_on(running)
}
