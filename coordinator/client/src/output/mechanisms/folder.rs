//! The folder of --output: the answer without positions, a table of real positions, and all that are listed as lines.

use super::csv::Positions;
use super::json::{Lines, Object};
use super::listing::{Listing, Sink};
use super::path::{self, ShownPath};
use super::view::View;
use crate::error::ClientError;
use crate::output::files::{create, make_folder, write_file};
use std::path::Path;

/// What writes `summary.json`, `solutions.csv` and `configurations.jsonl`.
pub fn listings<'a>(
    view: View<'a>,
    content: &[u8],
    folder: &Path,
) -> Result<[Box<dyn Listing + 'a>; 3], ClientError> {
    make_folder(folder)?;
    let file = |name| Ok::<Sink, ClientError>(Sink::File(create(folder, name)?));
    Ok([
        Box::new(Object::new(view, content, false, file("summary.json")?)?),
        Box::new(Positions::new(view, file("solutions.csv")?)),
        Box::new(Lines::new(view, file("configurations.jsonl")?)),
    ])
}

/// Writes `summary.json` and `trajectory.csv`.
pub fn write_path(shown: &ShownPath<'_>, folder: &Path) -> Result<(), ClientError> {
    make_folder(folder)?;
    write_file(folder, "summary.json", &path::json(shown))?;
    write_file(folder, "trajectory.csv", &path::csv(shown))
}
