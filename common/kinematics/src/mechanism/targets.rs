//! Poses and inputs from files: JSON, or CSV with a header.

use super::Space;
use super::document::{Document, Entry, MechanismError};
use super::exact::{Angle, Number, read_angle};
use super::pose::{Pose, ReadPose};
use super::read_parts::pose;
use super::task::Task;
use super::typed_numbers::inputs_without_names;
use super::typed_pose::poses_without_names;
use cognate_numeric::counted::counted;
use num_complex::Complex64;

/// Most targets of one file.
pub const MOST_TARGETS: usize = 1_000_000;
/// Largest table of targets, in bytes: rows are read one by one.
const MOST_TABLE_BYTES: usize = 512 << 20;

/// How poses are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoseForm {
    /// Where they are.
    pub space: Space,
    /// The part of them that is given.
    pub task: Task,
    /// Whether angles without a unit are degrees; else radians.
    pub degrees: bool,
}

impl PoseForm {
    /// Whole poses.
    pub fn whole(space: Space, degrees: bool) -> Self {
        Self {
            space,
            task: Task::Pose,
            degrees,
        }
    }
}

/// Reads poses: JSON, one or a list; or CSV with a header `x,y,z,qw,qx,qy,qz`, `x,y,z,roll,pitch,yaw` or, in the
/// plane, `x,y,angle`; for a task also with its columns ([`Task::columns`]); or numbers without names, as poses are typed
/// ([`super::typed_pose`]).
pub fn poses(file: &str, content: &[u8], form: PoseForm) -> Result<Vec<ReadPose>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    if let Some(poses) = poses_without_names(&document, form) {
        return poses;
    }
    each_target(
        (file, content),
        |document, row| pose_of_row(document, row, form),
        |entry| pose_of_entry(entry, form),
    )
}

/// Targets from a file, which is a table or JSON of one target or a list.
fn each_target<T>(
    (file, content): (&str, &[u8]),
    of_row: impl Fn(&Document<'_>, &Row<'_>) -> Result<T, MechanismError>,
    of_entry: impl Fn(&Entry<'_>) -> Result<T, MechanismError>,
) -> Result<Vec<T>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    if !is_json(&document) {
        return each_row(&document, |row| of_row(&document, row));
    }
    let document = Document::new(file, content)?;
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
    each_target(
        (file, content),
        |document, row| point_of_row(document, row, is_planar),
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
    each_target(
        (file, content),
        |document, row| {
            row.only(document, &["crank", "rocker"])?;
            let [crank, rocker] =
                ["crank", "rocker"].map(|name| row.angle(document, name, degrees));
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
    if let Some(inputs) = inputs_without_names(&document, names, degrees) {
        return inputs;
    }
    each_target(
        (file, content),
        |document, row| inputs_of_row(document, row, names, degrees),
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

/// One value of a joint, as typed.
pub fn value(text: &str, is_angle: bool, degrees: bool) -> Option<f64> {
    let value = if is_angle {
        read_angle(text, degrees, false)?.angle.radians
    } else {
        Number::read(text)?.to_f64()
    };
    value.is_finite().then_some(value)
}

pub(super) fn is_json(document: &Document<'_>) -> bool {
    document.text.trim_start().starts_with(['{', '['])
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

/// A row of a table: where it begins in the text, and its cells with the names of their columns.
pub(super) struct Row<'a> {
    pub at: usize,
    pub cells: Vec<(&'a str, &'a str)>,
}

/// What `read` makes of every row below the header.
fn each_row<T>(
    document: &Document<'_>,
    read: impl Fn(&Row<'_>) -> Result<T, MechanismError>,
) -> Result<Vec<T>, MechanismError> {
    let mut at = 0;
    let mut header: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    for line in document.text.split_inclusive('\n') {
        let start = at;
        at += line.len();
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
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
        if found.len() >= MOST_TARGETS {
            return Err(document.error(start, "", format!("more than {MOST_TARGETS} targets")));
        }
        found.push(read(&Row {
            at: start,
            cells: header.iter().copied().zip(cells).collect(),
        })?);
    }
    if found.is_empty() {
        return Err(document.error(at, "", "expected a header and at least one row"));
    }
    Ok(found)
}

impl Row<'_> {
    fn cell<'r>(&'r self, document: &Document<'_>, name: &str) -> Result<&'r str, MechanismError> {
        let found = self.cells.iter().find(|(n, _)| *n == name);
        found.map(|(_, text)| *text).ok_or_else(|| {
            let names: Vec<&str> = self.cells.iter().map(|(n, _)| *n).collect();
            document.error(
                0,
                "",
                format!("no column \"{name}\"; there are {}", names.join(",")),
            )
        })
    }

    fn number(&self, document: &Document<'_>, name: &str) -> Result<f64, MechanismError> {
        let text = self.cell(document, name)?;
        value(text, false, false).ok_or_else(|| {
            document.error(
                self.at,
                name,
                format!("expected a number, found \"{text}\""),
            )
        })
    }

    fn angle(
        &self,
        document: &Document<'_>,
        name: &str,
        degrees: bool,
    ) -> Result<Angle, MechanismError> {
        let text = self.cell(document, name)?;
        let read = read_angle(text, degrees, false);
        let read = read.ok_or_else(|| {
            document.error(
                self.at,
                name,
                format!("expected an angle, found \"{text}\""),
            )
        })?;
        Ok(read.angle)
    }

    fn only(&self, document: &Document<'_>, names: &[&str]) -> Result<(), MechanismError> {
        match self.cells.iter().find(|(n, _)| !names.contains(n)) {
            Some((name, _)) => {
                let message = format!("unknown column \"{name}\"; expected {}", names.join(","));
                Err(document.error(0, "", message))
            }
            None => Ok(()),
        }
    }
}

pub(super) fn pose_of_row(
    document: &Document<'_>,
    row: &Row<'_>,
    form: PoseForm,
) -> Result<ReadPose, MechanismError> {
    let number = |name: &str| row.number(document, name);
    let task = match form.space {
        Space::Planar => Task::Planar,
        _ => form.task,
    };
    let columns = task.columns();
    let has = |name: &str| row.cells.iter().any(|(n, _)| *n == name);
    // A full pose may be given for a task, too.
    if !columns.is_empty() && (form.space == Space::Planar || !has("qw") && !has("roll")) {
        row.only(document, columns)?;
        let (numbers, yaw) = match columns.split_last() {
            Some((last, others)) if task.has_angle() => {
                (others, row.angle(document, last, form.degrees)?)
            }
            _ => (columns, Angle::ZERO),
        };
        let numbers: Result<Vec<f64>, _> = numbers.iter().map(|name| number(name)).collect();
        let pose = task.pose_of(&numbers?, yaw);
        let pose = pose.map_err(|message| document.error(row.at, "", message))?;
        return Ok(ReadPose::exact(pose));
    }
    let degrees = form.degrees;
    let position = [number("x")?, number("y")?, number("z")?].map(Complex64::from);
    if row.cells.iter().any(|(n, _)| *n == "qw") {
        row.only(document, &["x", "y", "z", "qw", "qx", "qy", "qz"])?;
        let q = [number("qw")?, number("qx")?, number("qy")?, number("qz")?];
        let pose = ReadPose::of_quaternion(q, position);
        return pose.map_err(|message| document.error(row.at, "qw", message));
    }
    row.only(document, &["x", "y", "z", "roll", "pitch", "yaw"])?;
    let angle = |name: &str| row.angle(document, name, degrees);
    Ok(ReadPose::exact(Pose {
        position,
        ..Pose::of_roll_pitch_yaw([angle("roll")?, angle("pitch")?, angle("yaw")?])
    }))
}

fn inputs_of_row(
    document: &Document<'_>,
    row: &Row<'_>,
    names: &[(String, bool)],
    degrees: bool,
) -> Result<Vec<f64>, MechanismError> {
    let known: Vec<&str> = names.iter().map(|(n, _)| n.as_str()).collect();
    row.only(document, &known)?;
    let mut values = Vec::new();
    for (name, is_angle) in names {
        values.push(if *is_angle {
            row.angle(document, name, degrees)?.radians
        } else {
            row.number(document, name)?
        });
    }
    Ok(values)
}
