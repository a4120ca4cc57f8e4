//! Poses and inputs from files: JSON, or CSV with a header.

use super::document::{Document, Entry, MechanismError};
use super::pose::ReadPose;
use super::read_parts::pose;
use super::table_comments;
pub use super::target_row::{MOST_TARGETS, PoseForm, value};
use super::target_row::{Row, inputs_of_row, is_comment, is_json, pose_of_row};
use super::typed_numbers::inputs_without_names;
use super::typed_pose::poses_without_names;
use cognate_numeric::counted::counted;

/// Largest table of targets, in bytes: rows are read one by one.
const MOST_TABLE_BYTES: usize = 512 << 20;

/// Reads poses: JSON, one or a list; or CSV with a header `x,y,z,qw,qx,qy,qz`, `x,y,z,roll,pitch,yaw` or, in the
/// plane, `x,y,angle`; for a task also with its columns ([`Task::columns`]); or numbers without names, as poses are typed
/// ([`super::typed_pose`]).
pub fn poses(file: &str, content: &[u8], form: PoseForm) -> Result<Vec<ReadPose>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    let form = PoseForm {
        degrees: table_comments::degrees(&document)?.unwrap_or(form.degrees),
        ..form
    };
    if let Some(poses) = poses_without_names(&document, form) {
        return poses;
    }
    each_target(
        &document,
        |row| pose_of_row(&document, row, form),
        |entry| pose_of_entry(entry, form),
    )
}

/// Targets from a file, which is a table or JSON of one target or a list.
fn each_target<T>(
    document: &Document<'_>,
    of_row: impl Fn(&Row<'_>) -> Result<T, MechanismError>,
    of_entry: impl Fn(&Entry<'_>) -> Result<T, MechanismError>,
) -> Result<Vec<T>, MechanismError> {
    if !is_json(document) {
        return each_row(document, of_row);
    }
    let document = document.within_limit()?;
    let tree = document.json_tree()?;
    let entries = listed(&Entry {
        document,
        tree: &tree,
        path: String::new(),
    })?;
    entries.iter().map(of_entry).collect()
}

/// Reads points: JSON, `{"position": [..]}` or a list of numbers, one or a list of these; or CSV with a header `x,y,z`. Each
/// is of three numbers or in the plane of two; the third is 0 then.
pub fn points(
    file: &str,
    content: &[u8],
    is_planar: bool,
) -> Result<Vec<[f64; 3]>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    each_target(
        &document,
        |row| point_of_row(&document, row, is_planar),
        |entry| point_of_entry(entry, is_planar),
    )
}

fn point_of_entry(entry: &Entry<'_>, is_planar: bool) -> Result<[f64; 3], MechanismError> {
    let position = if entry.is_list() {
        entry.clone()
    } else {
        let fields = entry.fields("a point: an object with position, or a list of numbers")?;
        let position = fields.required("position", "the place of the output")?;
        fields.finish()?;
        position
    };
    if is_planar {
        let [x, y] = position.doubles::<2>("two numbers")?;
        return Ok([x, y, 0.0]);
    }
    position.doubles::<3>("three numbers")
}

fn point_of_row(
    document: &Document<'_>,
    row: &Row<'_>,
    is_planar: bool,
) -> Result<[f64; 3], MechanismError> {
    let names = if is_planar {
        &["x", "y"][..]
    } else {
        &["x", "y", "z"]
    };
    row.only(document, names)?;
    let mut point = [0.0; 3];
    for (value, name) in point.iter_mut().zip(names) {
        *value = row.number(document, name)?;
    }
    Ok(point)
}

/// Reads pairs of angles of crank and rocker: JSON, a list of lists of two angles; or CSV with a header `crank,rocker`.
/// Cosine and sine of each.
pub fn angle_pairs(
    file: &str,
    content: &[u8],
    degrees: bool,
) -> Result<Vec<[[f64; 2]; 2]>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    let degrees = table_comments::degrees(&document)?.unwrap_or(degrees);
    each_target(
        &document,
        |row| {
            row.only(&document, &["crank", "rocker"])?;
            let [crank, rocker] =
                ["crank", "rocker"].map(|name| row.angle(&document, name, degrees));
            Ok([crank?.direction, rocker?.direction])
        },
        |entry| {
            let expected = "two angles: of the crank and of the rocker";
            let [crank, rocker] = &entry.items(expected)?[..] else {
                return Err(entry.error(format!("expected {expected}")));
            };
            let [crank, rocker] = [crank, rocker].map(|entry| entry.angle(degrees, false));
            Ok([crank?.angle.direction, rocker?.angle.direction])
        },
    )
}

/// A pose, or the part of it that a task gives.
pub(super) fn pose_of_entry(entry: &Entry<'_>, form: PoseForm) -> Result<ReadPose, MechanismError> {
    match form.task.pose_of_entry(entry, form.degrees)? {
        Some(pose) => Ok(pose),
        None => pose(entry, form.degrees, form.space),
    }
}

/// Reads values of the inputs `names`, each with whether it is an angle: JSON objects of values by name, CSV with the names
/// as header, or numbers alone, a line for all inputs in this order. In radians or lengths.
pub fn inputs(
    file: &str,
    content: &[u8],
    names: &[(String, bool)],
    degrees: bool,
) -> Result<Vec<Vec<f64>>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    let degrees = table_comments::degrees(&document)?.unwrap_or(degrees);
    if let Some(inputs) = inputs_without_names(&document, names, degrees) {
        return inputs;
    }
    each_target(
        &document,
        |row| inputs_of_row(&document, row, names, degrees),
        |entry| inputs_of_entry(entry, names, degrees),
    )
}

/// Values of the inputs `names` from an object.
pub(super) fn inputs_of_entry(
    entry: &Entry<'_>,
    names: &[(String, bool)],
    degrees: bool,
) -> Result<Vec<f64>, MechanismError> {
    let fields = entry.fields("an object of values by the names of inputs")?;
    let mut values = Vec::new();
    for (name, is_angle) in names {
        let value = fields.required(name, "the value of this input")?;
        values.push(if *is_angle {
            value.angle(degrees, false)?.angle.radians
        } else {
            value.double()?
        });
    }
    fields.finish()?;
    Ok(values)
}

pub(super) fn listed<'a>(entry: &Entry<'a>) -> Result<Vec<Entry<'a>>, MechanismError> {
    if entry.is_object() {
        return Ok(vec![entry.clone()]);
    }
    let items = entry.items("an object, or a list of them")?;
    if items.is_empty() || items.len() > MOST_TARGETS {
        return Err(entry.error(format!(
            "expected between 1 and {MOST_TARGETS} targets, found {}",
            items.len()
        )));
    }
    Ok(items)
}

/// Results of `read` for every row below the header.
fn each_row<T>(
    document: &Document<'_>,
    read: impl Fn(&Row<'_>) -> Result<T, MechanismError>,
) -> Result<Vec<T>, MechanismError> {
    let mut at = 0;
    let is_blank = |line: &str| line.trim().is_empty() || is_comment(line);
    let heading = document.text.lines().find(|line| !is_blank(line));
    let separator = if heading.is_some_and(|line| line.contains(';')) {
        ';'
    } else {
        ','
    };
    let mut header: Vec<&str> = Vec::new();
    let mut rows = Vec::new();
    for line in document.text.split_inclusive('\n') {
        let start = at;
        at += line.len();
        let line = line.trim();
        if is_blank(line) {
            continue;
        }
        let cells: Vec<&str> = line.split(separator).map(str::trim).collect();
        if header.is_empty() {
            header = cells;
            continue;
        }
        if cells.len() != header.len() {
            let message = format!(
                "expected {} ({}), found {}",
                counted(header.len(), "value"),
                header.join(","),
                cells.len()
            );
            return Err(document.error(start, "", message));
        }
        if rows.len() >= MOST_TARGETS {
            return Err(document.error(start, "", format!("more than {MOST_TARGETS} targets")));
        }
        rows.push(read(&Row {
            at: start,
            cells: header.iter().copied().zip(cells).collect(),
        })?);
    }
    if rows.is_empty() {
        return Err(document.error(at, "", "expected a header and at least one row"));
    }
    Ok(rows)
}
