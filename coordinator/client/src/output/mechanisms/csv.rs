//! Positions of a mechanism as CSV: a row for each that is real, with all digits; angles in the unit that is shown.

use super::listing::{Finished, Listing, Sink};
use super::view::{View, pose_columns, pose_numbers};
use crate::error::ClientError;
use cognate_mechanism_solver::postures::{Position, Postures};

/// The real positions of targets. `solution` counts the positions of a target from 1, as in the table.
pub struct Positions<'a> {
    view: View<'a>,
    sink: Sink,
    has_header: bool,
}

impl<'a> Positions<'a> {
    /// Nothing is written before the names of joints are known: those of the first position that there is.
    pub fn new(view: View<'a>, sink: Sink) -> Self {
        Self {
            view,
            sink,
            has_header: false,
        }
    }

    fn header(&mut self, first: Option<&Position>) -> Result<(), ClientError> {
        self.has_header = true;
        let mut names = vec!["target".to_owned(), "solution".to_owned()];
        let values = first.iter().flat_map(|p| &p.configuration.values);
        names.extend(values.map(|(name, _)| quoted(name)));
        names.extend(pose_columns(&self.view).iter().map(|name| (*name).into()));
        names.extend(KNOWN.map(String::from));
        self.sink.write(&format!("{}\n", names.join(",")))
    }
}

/// Columns of the properties of a position.
const KNOWN: [&str; 6] = [
    "singular",
    "certified",
    "within_limits",
    "violated",
    "condition",
    "residual",
];

impl Listing for Positions<'_> {
    fn target(&mut self, index: u64, answer: &Postures) -> Result<(), ClientError> {
        if let (false, Some(first)) = (self.has_header, answer.positions.first()) {
            self.header(Some(first))?;
        }
        let listed = answer.positions.iter();
        let listed = listed.filter(|p| p.is_real && self.view.lists(p));
        for (k, position) in listed.enumerate() {
            let mut row = vec![(index + 1).to_string(), (k + 1).to_string()];
            row.extend(cells(&self.view, position));
            self.sink.write(&format!("{}\n", row.join(",")))?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _: &Finished<'_>) -> Result<(), ClientError> {
        if !self.has_header {
            self.header(None)?;
        }
        self.sink.finish()
    }
}

fn cells(view: &View<'_>, position: &Position) -> Vec<String> {
    let values = position.configuration.values.iter();
    let mut cells: Vec<String> = values.map(|(_, v)| view.value(v).to_string()).collect();
    match &position.configuration.output {
        Some(pose) => cells.extend(pose_numbers(view, pose).iter().map(f64::to_string)),
        None => cells.extend(pose_columns(view).iter().map(|_| String::new())),
    }
    cells.push(position.is_singular.to_string());
    let said = |verdict: Option<bool>| verdict.map_or(String::new(), |is| is.to_string());
    cells.push(said(position.certified));
    cells.push(said(position.within_limits()));
    cells.push(quoted(&position.violated.join(" ")));
    cells.push(position.condition.to_string());
    cells.push(position.configuration.residual.to_string());
    cells
}

/// A name as a cell.
pub(super) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        return format!("\"{}\"", name.replace('"', "\"\""));
    }
    name.to_owned()
}
