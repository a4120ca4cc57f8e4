//! Parts that all bodies of a mechanism's file have: angles, vectors, poses, lists.

use super::document::{Entry, MechanismError};
use super::exact::{Angle, Number};
use super::pose::{Pose, ReadPose};
use super::{MOST_PARTS, Snapped, Space, Vector, noted};
use num_complex::Complex64;

/// Facts about the file that the readers of bodies need, and notes that they make.
pub(crate) struct Context {
    pub space: Space,
    pub degrees: bool,
    /// Whether the file names the unit of its angles.
    pub unit_is_named: bool,
    pub snap: bool,
    pub snapped: Vec<Snapped>,
}

impl Context {
    /// An angle, its snapping noted.
    pub fn angle(&mut self, entry: &Entry<'_>) -> Result<Angle, MechanismError> {
        if !self.unit_is_named && entry.looks_like_radians() {
            return Err(entry.error(
                "a right angle in radians, and the file does not name the unit of its angles, which is degrees then: \
                 add \"angles\": \"rad\", or \"angles\": \"deg\" where degrees are meant",
            ));
        }
        let read = entry.angle(self.degrees, self.snap)?;
        Ok(noted(read, &entry.path, &mut self.snapped))
    }

    /// A point or direction: three numbers, in the plane two.
    pub fn vector(&self, entry: &Entry<'_>, what: &str) -> Result<Vector, MechanismError> {
        if self.space == Space::Planar {
            let [x, y] = entry.numbers::<2>(&format!("{what}: two numbers"))?;
            return Ok([x, y, Number::integer(0)]);
        }
        entry.numbers::<3>(&format!("{what}: three numbers"))
    }

    /// A direction, which is not 0.
    pub fn direction(&self, entry: &Entry<'_>, what: &str) -> Result<Vector, MechanismError> {
        let vector = self.vector(entry, what)?;
        if vector.iter().all(|c| c.value == 0) {
            return Err(entry.error(format!("{what} has length 0; expected a direction")));
        }
        Ok(vector)
    }
}

/// A pose: position with rotation, quaternion or rpy; in the plane position (or x, y) with angle.
pub(crate) fn pose(
    entry: &Entry<'_>,
    degrees: bool,
    space: Space,
) -> Result<ReadPose, MechanismError> {
    let fields = entry.fields("a pose: an object with position and rotation, quaternion or rpy")?;
    if space == Space::Planar {
        let position = fields
            .required("position", "two coordinates")?
            .doubles::<2>("two numbers")?;
        let angle = match fields.optional("angle") {
            Some(angle) => angle.angle(degrees, false)?.angle,
            None => Angle::ZERO,
        };
        fields.finish()?;
        let [c, s] = angle.direction.map(Complex64::from);
        return Ok(ReadPose::exact(Pose {
            position: [position[0].into(), position[1].into(), Complex64::default()],
            ..Pose::about_z(c, s)
        }));
    }
    let position = match fields.optional("position") {
        Some(position) => position.doubles::<3>("three numbers")?,
        None => [0.0; 3],
    };
    let position = position.map(Complex64::from);
    let ways: Vec<Entry<'_>> = ["rotation", "quaternion", "rpy"]
        .iter()
        .filter_map(|n| fields.optional(n))
        .collect();
    if ways.len() > 1 {
        return Err(fields.error("expected one of rotation, quaternion and rpy"));
    }
    let pose = match ways.first() {
        None => ReadPose::exact(Pose {
            position,
            ..Pose::IDENTITY
        }),
        Some(way) if way.path.ends_with("rotation") => {
            let rows = way.items("three rows")?;
            let rows: Result<Vec<[f64; 3]>, _> = rows
                .iter()
                .map(|r| r.doubles::<3>("three numbers"))
                .collect();
            let rows: [[f64; 3]; 3] = rows?
                .try_into()
                .map_err(|_| way.error("expected three rows of three numbers"))?;
            ReadPose::of_rows(rows, position).map_err(|message| way.error(message))?
        }
        Some(way) if way.path.ends_with("quaternion") => {
            let q = way.doubles::<4>("four numbers [w, x, y, z]")?;
            ReadPose::of_quaternion(q, position).map_err(|message| way.error(message))?
        }
        Some(way) => {
            let items = way.items("three angles")?;
            let angles: Result<Vec<Angle>, _> = items
                .iter()
                .map(|a| Ok(a.angle(degrees, false)?.angle))
                .collect();
            let angles: [Angle; 3] = angles?
                .try_into()
                .map_err(|_| way.error("expected roll, pitch and yaw"))?;
            ReadPose::exact(Pose {
                position,
                ..Pose::of_roll_pitch_yaw(angles)
            })
        }
    };
    fields.finish()?;
    Ok(pose)
}

/// The items of a list, as many as a mechanism may have.
pub(crate) fn parts<'a>(entry: &Entry<'a>, what: &str) -> Result<Vec<Entry<'a>>, MechanismError> {
    let items = entry.items(what)?;
    if items.len() > MOST_PARTS {
        return Err(entry.error(format!(
            "{} parts; at most {MOST_PARTS} are read",
            items.len()
        )));
    }
    Ok(items)
}
