//! Tables of Denavit and Hartenberg as CSV with a header `type,theta,d,a,alpha`, and `name` if wanted.

use crate::mechanism::chain::{Chain, ChainJoint};
use crate::mechanism::document::{Document, MechanismError};
use crate::mechanism::exact::{Angle, Number, read_angle};
use crate::mechanism::pose::Pose;
use crate::mechanism::read_options::ReadOptions;
use crate::mechanism::{Body, MOST_PARTS, Mechanism, Space, noted};

const COLUMNS: [&str; 6] = ["type", "theta", "d", "a", "alpha", "name"];

/// Whether a line is the header of such a table.
pub fn is_header(line: &str) -> bool {
    let names: Vec<&str> = line.split(',').map(str::trim).collect();
    names.contains(&"alpha") && names.contains(&"type")
}

/// Reads a table, rows in the standard order Rz(theta) Tz(d) Tx(a) Rx(alpha); angles in degrees, or with
/// their unit: `pi/2`, `1.2 rad`.
pub fn read(document: &Document<'_>, options: &ReadOptions) -> Result<Mechanism, MechanismError> {
    let mut lines = document
        .text
        .split_inclusive('\n')
        .scan(0usize, |at, line| {
            let start = *at;
            *at += line.len();
            Some((start, line.trim()))
        });
    let (_, header) = lines.find(|(_, line)| !line.is_empty()).unwrap_or((0, ""));
    let names: Vec<&str> = header
        .trim_start_matches('\u{feff}')
        .split(',')
        .map(str::trim)
        .collect();
    for (i, name) in names.iter().enumerate() {
        if !COLUMNS.contains(name) || names[..i].contains(name) {
            let message = format!(
                "column \"{name}\": expected each of {} at most once",
                COLUMNS.join(", ")
            );
            return Err(document.error(0, "", message));
        }
    }
    let mut joints: Vec<ChainJoint> = Vec::new();
    let mut snapped = Vec::new();
    for (at, line) in lines.filter(|(_, line)| !line.is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != names.len() || joints.len() >= MOST_PARTS {
            let message = format!(
                "expected {} values in one of at most {MOST_PARTS} rows",
                names.len()
            );
            return Err(document.error(at, "", message));
        }
        let row = joints.len() + 1;
        let cell = |name: &str| names.iter().position(|n| *n == name).map(|i| cells[i]);
        let length = |name: &str| {
            let text = cell(name).unwrap_or("0");
            let number = Number::read(text)
                .map(|n| n.to_f64())
                .filter(|x| x.is_finite());
            number.ok_or_else(|| {
                document.error(at, name, format!("expected a length, found \"{text}\""))
            })
        };
        let mut angle = |name: &str| -> Result<Angle, MechanismError> {
            let text = cell(name).unwrap_or("0");
            let read = read_angle(text, true, !options.no_snap);
            let read = read.ok_or_else(|| {
                document.error(at, name, format!("expected an angle, found \"{text}\""))
            })?;
            Ok(noted(read, &format!("row {row} {name}"), &mut snapped))
        };
        let kind = cell("type").unwrap_or("R");
        let is_angle = match kind {
            "R" => true,
            "P" => false,
            other => {
                let message = format!("expected R or P, found \"{other}\"");
                return Err(document.error(at, "type", message));
            }
        };
        let name = cell("name").map_or_else(|| format!("q{row}"), str::to_owned);
        if joints.iter().any(|j| j.name == name) {
            return Err(document.error(
                at,
                "name",
                format!("the name \"{name}\" stands for two joints"),
            ));
        }
        joints.push(ChainJoint {
            name,
            is_angle,
            a: length("a")?,
            alpha: angle("alpha")?,
            d: length("d")?,
            theta: angle("theta")?,
        });
    }
    if joints.is_empty() {
        return Err(document.error(document.text.len(), "", "expected at least one row"));
    }
    Ok(Mechanism {
        file: document.file.to_owned(),
        name: document.file.to_owned(),
        space: Space::Spatial,
        degrees: true,
        body: Body::Chain(Box::new(Chain {
            joints,
            base: Pose::IDENTITY,
            tool: Pose::IDENTITY,
            closed: false,
        })),
        inputs: Vec::new(),
        output: None,
        limits: Vec::new(),
        snapped,
        warnings: Vec::new(),
    })
}
