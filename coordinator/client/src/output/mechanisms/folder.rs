//! The folder of --output: the answer without positions, a table of real positions, and all that are listed as lines.

use super::path::{self, ShownPath};
use super::shown::Shown;
use super::{csv, json};
use crate::error::ClientError;
use crate::output::files::{make_folder, write_file};
use std::path::Path;

/// Writes `summary.json`, `solutions.csv` and `configurations.jsonl`.
pub fn write(shown: &Shown<'_>, folder: &Path) -> Result<(), ClientError> {
    make_folder(folder)?;
    write_file(folder, "summary.json", &json::summary(shown))?;
    let targets = &shown.answer.targets;
    write_file(
        folder,
        "solutions.csv",
        &csv::positions(&shown.view, targets),
    )?;
    let lines = targets.iter().enumerate();
    let lines = lines.map(|(i, t)| format!("{}\n", json::target(&shown.view, i, t)));
    write_file(folder, "configurations.jsonl", &lines.collect::<String>())
}

/// Writes `summary.json` and `trajectory.csv`.
pub fn write_path(shown: &ShownPath<'_>, folder: &Path) -> Result<(), ClientError> {
    make_folder(folder)?;
    write_file(folder, "summary.json", &path::json(shown))?;
    write_file(folder, "trajectory.csv", &path::csv(shown))
}
