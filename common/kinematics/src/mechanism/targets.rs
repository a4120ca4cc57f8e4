//! Poses and inputs from files: JSON, or CSV with a header.

use super::document::{Document, Entry, MechanismError};
use super::exact::{Angle, Number, read_angle};
use super::pose::{Pose, ROTATION_ERROR};
use super::read_parts::pose;
use super::{Mechanism, Space};
use num_complex::Complex64;

/// Most targets of one file.
pub const MOST_TARGETS: usize = 1_000_000;
/// Largest table of targets, in bytes: rows are read one by one.
const MOST_TABLE_BYTES: usize = 512 << 20;

/// Reads poses: JSON, one or a list; or CSV with a header `x,y,z,qw,qx,qy,qz`, `x,y,z,roll,pitch,yaw` or, in the
/// plane, `x,y,angle`.
pub fn poses(
    file: &str,
    content: &[u8],
    mechanism: &Mechanism,
    degrees: bool,
) -> Result<Vec<Pose>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    if !is_json(&document) {
        return each_row(&document, |row| {
            pose_of_row(&document, row, mechanism.space, degrees)
        });
    }
    let document = Document::new(file, content)?;
    let tree = document.json_tree()?;
    listed(&Entry {
        document,
        tree: &tree,
        path: String::new(),
    })?
    .iter()
    .map(|entry| pose(entry, degrees, mechanism.space))
    .collect()
}

/// Reads values of the inputs `names`, each with whether it is an angle: JSON objects of values by name, or CSV
/// with the names as header. In radians or lengths.
pub fn inputs(
    file: &str,
    content: &[u8],
    names: &[(String, bool)],
    degrees: bool,
) -> Result<Vec<Vec<f64>>, MechanismError> {
    let document = Document::within(MOST_TABLE_BYTES, file, content)?;
    if !is_json(&document) {
        return each_row(&document, |row| {
            inputs_of_row(&document, row, names, degrees)
        });
    }
    let document = Document::new(file, content)?;
    let tree = document.json_tree()?;
    let mut found = Vec::new();
    for entry in listed(&Entry {
        document,
        tree: &tree,
        path: String::new(),
    })? {
        found.push(inputs_of_entry(&entry, names, degrees)?);
    }
    Ok(found)
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

/// A pose as typed: seven numbers x y z qw qx qy qz, in the plane three: x y angle.
pub fn typed_pose(
    text: &str,
    mechanism: &Mechanism,
    degrees: bool,
) -> Result<Pose, MechanismError> {
    let words: Vec<&str> = text.split([' ', ',']).filter(|w| !w.is_empty()).collect();
    let header: &[&str] = match mechanism.space {
        Space::Planar => &["x", "y", "angle"],
        _ => &["x", "y", "z", "qw", "qx", "qy", "qz"],
    };
    let document = Document {
        file: "--pose",
        text,
    };
    if words.len() != header.len() {
        let message = format!(
            "expected {} numbers ({}), found {}",
            header.len(),
            header.join(" "),
            words.len()
        );
        return Err(MechanismError::of_file("--pose", message));
    }
    let cells = header.iter().zip(&words).map(|(name, word)| (*name, *word));
    let row = Row {
        at: 0,
        cells: cells.collect(),
    };
    pose_of_row(&document, &row, mechanism.space, degrees)
}

fn is_json(document: &Document<'_>) -> bool {
    document.text.trim_start().starts_with(['{', '['])
}

fn listed<'a>(entry: &Entry<'a>) -> Result<Vec<Entry<'a>>, MechanismError> {
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
struct Row<'a> {
    at: usize,
    cells: Vec<(&'a str, &'a str)>,
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
                "expected {} values ({}), found {}",
                header.len(),
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

fn pose_of_row(
    document: &Document<'_>,
    row: &Row<'_>,
    space: Space,
    degrees: bool,
) -> Result<Pose, MechanismError> {
    let number = |name: &str| row.number(document, name);
    if space == Space::Planar {
        row.only(document, &["x", "y", "angle"])?;
        let [c, s] = row
            .angle(document, "angle", degrees)?
            .direction
            .map(Complex64::from);
        return Ok(Pose {
            position: [
                number("x")?.into(),
                number("y")?.into(),
                Complex64::default(),
            ],
            ..Pose::about_z(c, s)
        });
    }
    let position = [number("x")?, number("y")?, number("z")?].map(Complex64::from);
    if row.cells.iter().any(|(n, _)| *n == "qw") {
        row.only(document, &["x", "y", "z", "qw", "qx", "qy", "qz"])?;
        let q = [number("qw")?, number("qx")?, number("qy")?, number("qz")?];
        let square: f64 = q.iter().map(|c| c * c).sum();
        if (square - 1.0).abs() > ROTATION_ERROR {
            let message = format!("expected a quaternion of length 1, its square is {square}");
            return Err(document.error(row.at, "qw", message));
        }
        let pose = Pose::of_quaternion(q.map(Complex64::from), position);
        return pose
            .ok_or_else(|| document.error(row.at, "qw", "expected a quaternion of length 1"));
    }
    row.only(document, &["x", "y", "z", "roll", "pitch", "yaw"])?;
    let angle = |name: &str| row.angle(document, name, degrees);
    Ok(Pose {
        position,
        ..Pose::of_roll_pitch_yaw([angle("roll")?, angle("pitch")?, angle("yaw")?])
    })
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
