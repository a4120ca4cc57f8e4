//! paths.parquet: every path of a job with its verdict and its facts, a row each.

use super::files::unnamed;
use super::parquet::{Table, Values};
use crate::error::ClientError;
use cognate_protocol::v1;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Rows of a row group: some megabytes in memory.
const GROUP_ROWS: usize = 50_000;

/// The table of paths that is being written.
pub struct Paths {
    path: PathBuf,
    /// The file until it is whole.
    part: Option<NamedTempFile>,
    table: Option<Table<BufWriter<File>>>,
    rows: Vec<v1::ClassifiedPath>,
    coordinates: usize,
}

impl Paths {
    /// A table in this file.
    pub fn new(path: PathBuf) -> Self {
        Self {
            path,
            part: None,
            table: None,
            rows: vec![],
            coordinates: 0,
        }
    }

    /// Adds a path.
    pub fn path(&mut self, row: v1::ClassifiedPath) -> Result<(), ClientError> {
        self.rows.push(row);
        if self.rows.len() < GROUP_ROWS {
            return Ok(());
        }
        self.write_group().map_err(|e| cannot_write(&self.path, e))
    }

    /// Writes the remaining rows, and the footer.
    pub fn finish(mut self) -> Result<(), ClientError> {
        let written = self.write_group().and_then(|()| match self.table {
            Some(table) => table.finish(),
            None => Ok(()),
        });
        let (path, part) = (&self.path, self.part);
        let named = written.and_then(|()| match part {
            Some(part) => part.persist(path).map(drop).map_err(|e| e.error),
            None => Ok(()),
        });
        named.map_err(|e| cannot_write(&self.path, e))
    }

    fn write_group(&mut self) -> io::Result<()> {
        let rows = std::mem::take(&mut self.rows);
        // The first group says how many coordinates an endpoint has.
        let table = match &mut self.table {
            Some(table) => table,
            none => {
                let endpoints = rows.iter().filter_map(|r| r.result.as_ref());
                self.coordinates = endpoints.map(|r| r.endpoint.len() / 2).max().unwrap_or(0);
                let folder = self.path.parent().unwrap_or(Path::new("."));
                let part = self.part.insert(unnamed(folder)?);
                let file = BufWriter::new(part.reopen()?);
                none.insert(Table::new(file, columns(&[], self.coordinates))?)
            }
        };
        if rows.is_empty() {
            return Ok(());
        }
        let columns = columns(&rows, self.coordinates);
        let values: Vec<Values> = columns.into_iter().map(|(_, values)| values).collect();
        table.group(&values)
    }
}

fn cannot_write(path: &Path, source: io::Error) -> ClientError {
    ClientError::File {
        action: "cannot write",
        path: path.to_path_buf(),
        source,
    }
}

/// Names and values of all columns.
fn columns(rows: &[v1::ClassifiedPath], coordinates: usize) -> Vec<(String, Values)> {
    let none = v1::EndedPath::default();
    let results: Vec<&v1::EndedPath> = rows
        .iter()
        .map(|r| r.result.as_ref().unwrap_or(&none))
        .collect();
    let int =
        |value: fn(&v1::EndedPath) -> i64| Values::Int(results.iter().map(|r| value(r)).collect());
    let double = |value: fn(&v1::EndedPath) -> f64| {
        Values::Double(results.iter().map(|r| value(r)).collect())
    };
    let count = |value: fn(&v1::Counts) -> u32| {
        let counts = results.iter().map(|r| r.counts.unwrap_or_default());
        Values::Int(counts.map(|c| value(&c).into()).collect())
    };
    let classes = rows
        .iter()
        .map(|r| word(r.class().as_str_name(), "PATH_CLASS_"));
    let outcomes = results
        .iter()
        .map(|r| word(r.outcome().as_str_name(), "PATH_OUTCOME_"));
    let solutions = rows.iter().map(|r| r.solution.map(whole));
    let windings = results.iter().map(|r| r.winding_number.map(i64::from));
    let mut columns: Vec<(String, Values)> = [
        ("path", int(|r| whole(r.origin))),
        ("class", Values::Text(classes.collect())),
        ("solution", Values::OptionalInt(solutions.collect())),
        ("outcome", Values::Text(outcomes.collect())),
        ("attempt", int(|r| r.attempt.into())),
        ("residual", double(|r| r.residual)),
        ("condition", double(|r| r.condition)),
        ("accuracy", double(|r| r.accuracy)),
        ("winding_number", Values::OptionalInt(windings.collect())),
        ("precision_bits", int(|r| r.precision_bits.into())),
        ("t_re", double(|r| r.t.unwrap_or_default().re)),
        ("t_im", double(|r| r.t.unwrap_or_default().im)),
        ("steps", count(|c| c.steps)),
        ("rejections", count(|c| c.rejections)),
        ("evaluations", count(|c| c.evaluations)),
        ("exchanges", count(|c| c.exchanges)),
        ("turns", count(|c| c.turns)),
    ]
    .map(|(name, values)| (name.to_string(), values))
    .into();
    for part in 0..2 * coordinates {
        let name = format!(
            "endpoint_{}_{}",
            part / 2,
            if part % 2 == 0 { "re" } else { "im" }
        );
        let values = results
            .iter()
            .map(|r| r.endpoint.get(part).copied().unwrap_or(f64::NAN));
        columns.push((name, Values::Double(values.collect())));
    }
    columns
}

/// A name of the wire in small letters, without what all such names begin with.
fn word(name: &str, prefix: &str) -> String {
    name.trim_start_matches(prefix).to_lowercase()
}

/// A count; none of ours is beyond 2^63.
fn whole(n: u64) -> i64 {
    i64::try_from(n).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_has_a_value_for_every_path() {
        let row = |origin: u64, endpoint: Vec<f64>| v1::ClassifiedPath {
            result: Some(v1::EndedPath {
                origin,
                endpoint,
                outcome: v1::PathOutcome::StepTooSmall.into(),
                winding_number: (origin > 0).then_some(2),
                ..Default::default()
            }),
            class: v1::PathClass::AtInfinity.into(),
            solution: None,
        };
        let rows = [row(0, vec![1.0, 2.0, 3.0, 4.0]), row(1, vec![])];
        let columns = columns(&rows, 2);
        let find = |name: &str| {
            let named_column = columns.iter().find(|(n, _)| n == name);
            named_column
                .unwrap_or_else(|| panic!("no column {name}"))
                .1
                .clone()
        };
        assert_eq!(columns.len(), 21);
        assert_eq!(find("path"), Values::Int(vec![0, 1]));
        assert_eq!(find("class"), Values::Text(vec!["at_infinity".into(); 2]));
        assert_eq!(
            find("outcome"),
            Values::Text(vec!["step_too_small".into(); 2])
        );
        assert_eq!(
            find("winding_number"),
            Values::OptionalInt(vec![None, Some(2)])
        );
        let Values::Double(last) = find("endpoint_1_im") else {
            panic!("coordinates are doubles");
        };
        assert!(last[0] == 4.0 && last[1].is_nan());
    }
}
