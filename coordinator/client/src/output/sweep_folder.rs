//! The folder of --output of a sweep: summary.json, targets.csv, and solutions.jsonl, which is written as solutions come.

use super::files::{Written, cannot_write, create, make_folder};
use super::json;
use super::sweep::Sweep;
use crate::connection::Connection;
use crate::error::ClientError;
use cognate_solutions::solution::Solution;
use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::{Range, RangeTo};
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

    /// Writes a solution at this target.
    pub fn solution(&mut self, solution: &Solution, index: usize) -> Result<(), ClientError> {
        self.lines.write(&line(solution, index))
    }

    /// Writes the lines of targets before this one that were put aside.
    pub fn spilled(
        &mut self,
        spill: &mut Spill,
        before: RangeTo<usize>,
    ) -> Result<(), ClientError> {
        while let Some(text) = spill.next(before)? {
            self.lines.write(&text)?;
        }
        Ok(())
    }

    /// Completes the files.
    pub fn finish(self, sweep: &Sweep) -> Result<(), ClientError> {
        self.lines.finish()?;
        let mut table = create(&self.path, "targets.csv")?;
        for line in sweep.csv() {
            table.write(&line)?;
        }
        table.finish()?;
        let mut summary = create(&self.path, "summary.json")?;
        summary.write_json(sweep)?;
        summary.finish()
    }
}

fn line(solution: &Solution, index: usize) -> String {
    let target = u32::try_from(index).ok();
    format!("{}\n", json::solution_line(solution, target))
}

/// Lines of targets that were solved by themselves, in a file without a name until the lines around them are written.
#[derive(Default)]
pub struct Spill {
    file: Option<std::fs::File>,
    end: u64,
    /// For each target the place of its lines.
    places: BTreeMap<usize, Range<u64>>,
}

impl Spill {
    /// Puts the solutions of a job aside.
    pub async fn take(
        &mut self,
        connection: &mut Connection,
        job: &str,
        index: usize,
    ) -> Result<(), ClientError> {
        let begin = self.end;
        connection
            .solutions(job, |solution, _| {
                self.push(&line(&solution, index))?;
                Ok(true)
            })
            .await?;
        self.places.insert(index, begin..self.end);
        Ok(())
    }

    fn push(&mut self, text: &str) -> Result<(), ClientError> {
        let failed = |e| cannot_write(&std::env::temp_dir(), e);
        let file = match &mut self.file {
            Some(file) => file,
            None => self.file.insert(tempfile::tempfile().map_err(failed)?),
        };
        file.write_all(text.as_bytes()).map_err(failed)?;
        self.end += text.len() as u64;
        Ok(())
    }

    /// The lines of the first target that is left before this one.
    fn next(&mut self, before: RangeTo<usize>) -> Result<Option<String>, ClientError> {
        let Some(first) = self.places.first_entry() else {
            return Ok(None);
        };
        if !before.contains(first.key()) {
            return Ok(None);
        }
        let place = first.remove();
        let mut text = String::new();
        if let Some(file) = &mut self.file {
            let failed = |e| cannot_write(&std::env::temp_dir(), e);
            file.seek(SeekFrom::Start(place.start)).map_err(failed)?;
            let mut part = file.take(place.end - place.start);
            part.read_to_string(&mut text).map_err(failed)?;
        }
        Ok(Some(text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_were_put_aside_come_in_the_order_of_their_targets() {
        let mut spill = Spill::default();
        for (index, text) in [(3, "three\nthree\n"), (5, "five\n")] {
            let begin = spill.end;
            spill.push(text).expect("a temporary file");
            spill.places.insert(index, begin..spill.end);
        }
        let mut next = |before| spill.next(..before).expect("it can be read");
        assert_eq!(next(3), None);
        assert_eq!(next(4).as_deref(), Some("three\nthree\n"));
        assert_eq!(next(5), None);
        assert_eq!(next(9).as_deref(), Some("five\n"));
        assert_eq!(next(9), None);
    }
}
