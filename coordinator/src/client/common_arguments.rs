//! Arguments that many commands have: how an answer is shown, how cautiously paths are followed.

use clap::{Args, ValueEnum};
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
    /// What the known answers are checked with
    #[default]
    Default,
    /// Faster, more path jumps for the crossing check to repair
    Fast,
    /// Fastest; for experiments
    Reckless,
}

/// Where the answer goes.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArguments {
    /// How the answer is shown
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// Also write summary.json, solutions.jsonl, paths.parquet and Bertini's files here
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// What is seen while a job runs.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct ProgressArguments {
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t)]
    pub progress: ProgressForm,
}
