//! The folder of --output: the answer without positions, a table of real positions, all that are listed as lines, and a page
//! on which the real ones can be seen.

use super::csv::Positions;
use super::drawing::{self, Pages};
use super::json::{Lines, Object};
use super::listing::{Listing, Sink};
use super::path::{self, ShownPath};
use super::view::View;
use crate::error::ClientError;
use crate::output::files::{create, make_folder, write_file};
use std::path::Path;

/// Writers of `summary.json`, `solutions.csv`, `configurations.jsonl`, `page.json` and `page.html`.
pub fn listings<'a>(
    view: View<'a>,
    content: &[u8],
    folder: &Path,
) -> Result<[Box<dyn Listing + 'a>; 4], ClientError> {
    make_folder(folder)?;
    let file = |name| Ok::<Sink, ClientError>(Sink::File(create(folder, name)?));
    Ok([
        Box::new(Object::new(view, content, false, file("summary.json")?)?),
        Box::new(Positions::new(view, file("solutions.csv")?)),
        Box::new(Lines::new(view, file("configurations.jsonl")?)),
        Box::new(Pages::new(view, folder)),
    ])
}

/// Writes `summary.json`, `trajectory.csv`, `page.json` and `page.html`.
pub fn write_path(shown: &ShownPath<'_>, folder: &Path) -> Result<(), ClientError> {
    make_folder(folder)?;
    write_file(folder, "summary.json", &path::json(shown))?;
    write_file(folder, "trajectory.csv", &path::csv(shown))?;
    drawing::write_path(shown, folder)
}
