//! Arguments that many commands have: how an answer is shown, how cautiously paths are followed.

use super::connection::Target;
use super::embedded::Embedded;
use super::error::ClientError;
use super::output::axes::AxisOf;
use clap::{Args, ValueEnum};
use cognate_protocol::DEFAULT_ADDRESS;
use cognate_worker::transport::connect::CredentialFiles;
use std::path::PathBuf;

/// How results are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A table for people
    #[default]
    Table,
    /// One JSON object on standard output, nothing else there
    Json,
}

/// How solutions, points and components are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum AnswerFormat {
    /// A table for people
    #[default]
    Table,
    /// One JSON object with the counts on standard output, nothing else there
    Json,
    /// A JSON object on a line for each solution, component, point or linkage, nothing else
    Jsonl,
    /// A line with the names of columns, then a row for each solution, component, point or linkage
    Csv,
}

/// How many rows a table lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The first of them.
    First(usize),
    /// All of them.
    All,
}

/// A number of rows, as typed.
pub fn shown(text: &str) -> Result<Shown, String> {
    match text {
        "all" => Ok(Shown::All),
        number => number
            .parse()
            .map(Shown::First)
            .map_err(|_| "expected a number of rows, or all".to_owned()),
    }
}

/// How progress is shown, on standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ProgressForm {
    /// A bar on a terminal, else a line every few seconds, or nothing with --format json
    #[default]
    Auto,
    /// A JSON object on a line whenever something has changed
    Json,
    /// Nothing
    None,
}

/// Named settings of the tracker, as typed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PresetName {
    /// Tighter steps, slower, fewest path jumps
    Careful,
    /// The settings with which the known answers are checked
    #[default]
    Default,
    /// Faster, more path jumps for the crossing check to repair
    Fast,
    /// Fastest; for experiments
    Reckless,
}

/// Files and format of the answer.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArguments {
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: AnswerFormat,
    /// How many rows a table lists [default: what fits the terminal, and 1000 where there is none]
    #[arg(long, value_name = "N|all", value_parser = shown)]
    pub show: Option<Shown>,
    /// Also write summary.json, solutions.jsonl, paths.parquet and Bertini's files here
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// The two coordinates that a drawing of curves shows; none where curves are not drawn.
    #[arg(skip)]
    pub axes: Vec<AxisOf>,
}

/// A running coordinator, or one of the command's own with local workers.
#[derive(Clone, Debug, Args)]
pub struct OwnOrRunning {
    /// A running coordinator: http://HOST:PORT or unix:PATH [default: one of its own, with local workers]
    #[arg(long, value_name = "URL", help_heading = "Service")]
    pub coordinator: Option<String>,
    /// Token and certificates.
    #[command(flatten)]
    pub credentials: CredentialFiles,
    /// Local worker processes [default: none for a tenth of a second, then 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=256), conflicts_with = "coordinator", help_heading = "Service")]
    pub workers: Option<u32>,
    /// Threads of each worker [default: cores / workers]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), conflicts_with = "coordinator", help_heading = "Service")]
    pub threads: Option<u32>,
}

impl OwnOrRunning {
    /// Where the running coordinator is, if one was named.
    pub fn running(&self) -> Result<Option<Target>, ClientError> {
        let named = self.coordinator.as_deref();
        named
            .map(|at| Target::read(at, &self.credentials))
            .transpose()
    }

    /// Starts one of its own.
    pub async fn start(&self) -> Result<Embedded, ClientError> {
        Embedded::start(self.workers, self.threads).await
    }
}

/// Which coordinator is asked.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Service")]
pub struct ServiceArguments {
    /// The coordinator's address: http://HOST:PORT or unix:PATH; of several, with commas between, the first that answers
    #[arg(long, value_name = "URL", env = "COGNATE_COORDINATOR", default_value_t = format!("http://{DEFAULT_ADDRESS}"))]
    pub coordinator: String,
    /// Token and certificates.
    #[command(flatten)]
    pub credentials: CredentialFiles,
}

impl ServiceArguments {
    /// The coordinator that receives the calls, with the credentials.
    pub fn target(&self) -> Result<Target, ClientError> {
        Target::read(&self.coordinator, &self.credentials)
    }
}

/// Options that choose how progress is shown while a job runs.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct ProgressArguments {
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t)]
    pub progress: ProgressForm,
}
