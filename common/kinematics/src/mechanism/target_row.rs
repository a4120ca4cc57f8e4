//! Row: one target of a table, with the names of its numbers.

use super::Space;
use super::document::{Document, MechanismError};
use super::exact::{Angle, Number, read_angle};
use super::pose::{Pose, ReadPose};
use super::task::Task;
use num_complex::Complex64;

/// Most targets of one file.
pub const MOST_TARGETS: usize = 1_000_000;

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

/// One value of a joint, as typed.
pub fn value(text: &str, is_angle: bool, degrees: bool) -> Option<f64> {
    let value = if is_angle {
        read_angle(text, degrees, false)?.angle.radians
    } else {
        Number::read(text)?.to_f64()
    };
    value.is_finite().then_some(value)
}

/// Whether a line of a table is a comment. One that names a unit of angles is followed ([`super::table_comments`]).
pub(super) fn is_comment(line: &str) -> bool {
    line.trim_start_matches('\u{feff}')
        .trim_start()
        .starts_with('#')
}

pub(super) fn is_json(document: &Document<'_>) -> bool {
    document.text.trim_start().starts_with(['{', '['])
}

/// A row of a table: where it begins in the text, and its cells with the names of their columns.
pub(super) struct Row<'a> {
    pub at: usize,
    pub cells: Vec<(&'a str, &'a str)>,
}

impl Row<'_> {
    fn cell<'r>(&'r self, document: &Document<'_>, name: &str) -> Result<&'r str, MechanismError> {
        let cell = self.cells.iter().find(|(n, _)| *n == name);
        cell.map(|(_, text)| *text).ok_or_else(|| {
            let names: Vec<&str> = self.cells.iter().map(|(n, _)| *n).collect();
            document.error(
                0,
                "",
                format!("no column \"{name}\"; there are {}", names.join(",")),
            )
        })
    }

    pub fn number(&self, document: &Document<'_>, name: &str) -> Result<f64, MechanismError> {
        let text = self.cell(document, name)?;
        value(text, false, false).ok_or_else(|| {
            document.error(
                self.at,
                name,
                format!("expected a number, found \"{text}\""),
            )
        })
    }

    pub fn angle(
        &self,
        document: &Document<'_>,
        name: &str,
        degrees: bool,
    ) -> Result<Angle, MechanismError> {
        let text = self.cell(document, name)?;
        let read = read_angle(text, degrees, false);
        let read = read.filter(|read| read.angle.radians.is_finite());
        let read = read.ok_or_else(|| {
            document.error(
                self.at,
                name,
                format!("expected an angle, found \"{text}\""),
            )
        })?;
        Ok(read.angle)
    }

    pub fn only(&self, document: &Document<'_>, names: &[&str]) -> Result<(), MechanismError> {
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

/// Values of the inputs `names`, each with whether it is an angle: in radians or lengths.
pub(super) fn inputs_of_row(
    document: &Document<'_>,
    row: &Row<'_>,
    names: &[(String, bool)],
    degrees: bool,
) -> Result<Vec<f64>, MechanismError> {
    let joint_names: Vec<&str> = names.iter().map(|(n, _)| n.as_str()).collect();
    row.only(document, &joint_names)?;
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
