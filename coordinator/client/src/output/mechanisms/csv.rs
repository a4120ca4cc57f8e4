//! Positions of a mechanism as CSV: a row for each that is real, with all digits; angles in the unit that is shown.

use super::shown::{View, pose_columns, pose_numbers};
use crate::mechanism::target_answer::{Position, TargetAnswer};

/// The positions of all targets. `solution` counts the positions of a target from 1, as in the table.
pub fn positions(view: &View<'_>, targets: &[TargetAnswer]) -> String {
    let mut text = header(view, targets);
    for (i, target) in targets.iter().enumerate() {
        let listed = target.positions.iter();
        let listed = listed.filter(|p| p.is_real && view.lists(p));
        for (k, position) in listed.enumerate() {
            let mut row = vec![(i + 1).to_string(), (k + 1).to_string()];
            row.extend(cells(view, position));
            text.push_str(&row.join(","));
            text.push('\n');
        }
    }
    text
}

/// Names of the joints that have a value: those of the first position that there is.
fn joints(targets: &[TargetAnswer]) -> Vec<String> {
    let first = targets.iter().flat_map(|t| &t.positions).next();
    let values = first.iter().flat_map(|p| &p.configuration.values);
    values.map(|(name, _)| quoted(name)).collect()
}

fn header(view: &View<'_>, targets: &[TargetAnswer]) -> String {
    let mut names = vec!["target".to_owned(), "solution".to_owned()];
    names.extend(joints(targets));
    names.extend(pose_columns(view).iter().map(|name| (*name).to_owned()));
    names.extend(
        [
            "singular",
            "certified",
            "within_limits",
            "violated",
            "condition",
            "residual",
        ]
        .map(String::from),
    );
    format!("{}\n", names.join(","))
}

fn cells(view: &View<'_>, position: &Position) -> Vec<String> {
    let values = position.configuration.values.iter();
    let mut cells: Vec<String> = values.map(|(_, v)| view.value(v).to_string()).collect();
    match &position.configuration.output {
        Some(pose) => cells.extend(pose_numbers(view, pose).iter().map(f64::to_string)),
        None => cells.extend(pose_columns(view).iter().map(|_| String::new())),
    }
    cells.push(position.is_singular.to_string());
    let said = |known: Option<bool>| known.map_or(String::new(), |is| is.to_string());
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
