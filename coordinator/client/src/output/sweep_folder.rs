//! The folder of --output of a sweep: summary.json, targets.csv, and solutions.jsonl, which is written as solutions come.

use super::files::{Written, create, make_folder};
use super::listed::Listed;
use super::sweep::Sweep;
use crate::error::ClientError;
use std::path::{Path, PathBuf};

/// A folder that is being filled.
pub struct SweepFolder {
    path: PathBuf,
    lines: Written,
}

impl SweepFolder {
    /// Makes the folder where it does not exist.
    pub fn create(path: &Path) -> Result<Self, ClientError> {
        make_folder(path)?;
        Ok(Self {
            path: path.to_path_buf(),
            lines: create(path, "solutions.jsonl")?,
        })
    }

    /// Writes a solution that is shown.
    pub fn line(&mut self, listed: &Listed) -> Result<(), ClientError> {
        self.lines.write(&listed.line())
    }

    /// Completes the files.
    pub fn finish(self, sweep: &Sweep) -> Result<(), ClientError> {
        self.lines.finish()?;
        write_table(&self.path, sweep)?;
        let mut summary = create(&self.path, "summary.json")?;
        summary.write_json(sweep)?;
        summary.finish()
    }
}

/// Writes targets.csv into a folder.
pub fn write_table(folder: &Path, sweep: &Sweep) -> Result<(), ClientError> {
    let mut table = create(folder, "targets.csv")?;
    for line in sweep.csv() {
        table.write(&line)?;
    }
    table.finish()
}
