//! Task: which part of a pose is asked for, where a chain has fewer joints than a pose has freedoms.

use super::document::{Entry, MechanismError};
use super::exact::Angle;
use super::pose::{Pose, ReadPose, frame};
use num_complex::Complex64;

/// The part of a tool's pose that is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Task {
    /// Position and rotation: 6 numbers.
    #[default]
    Pose,
    /// The tool's origin: 3 numbers.
    Position,
    /// The tool's origin and the direction of its z axis: 5 numbers.
    Pointing,
    /// The tool's origin and its yaw, the angle about the base's z to which its x axis points: 4 numbers.
    XyzYaw,
    /// The tool's x and y and its yaw: 3 numbers.
    Planar,
}

/// A rotation with no angle that machines have, for tools whose rotation is not asked for.
const ANY_ROTATION: [f64; 4] = [0.55, 0.31, -0.47, 0.62];

/// A yaw is not known where the tool's x axis is within this sine of the base's z: a double posture is no nearer to one
/// without a yaw.
pub const LEAST_ACROSS: f64 = 1e-6;

/// All tasks with their names.
const NAMES: [(Task, &str); 5] = [
    (Task::Pose, "pose"),
    (Task::Position, "position"),
    (Task::Pointing, "pointing"),
    (Task::XyzYaw, "xyz-yaw"),
    (Task::Planar, "planar"),
];

impl Task {
    /// Tasks that give less than a pose.
    pub const PARTS: [Self; 4] = [Self::Pointing, Self::XyzYaw, Self::Position, Self::Planar];

    /// The name that people type.
    pub fn name(self) -> &'static str {
        let named = NAMES.iter().find(|(task, _)| *task == self);
        named.map_or("", |(_, name)| name)
    }

    /// The task of this name.
    pub fn of_name(name: &str) -> Option<Self> {
        let named = NAMES.iter().find(|(_, other)| *other == name);
        named.map(|(task, _)| *task)
    }

    /// How many numbers of a pose it gives.
    pub fn freedoms(self) -> usize {
        match self {
            Self::Pose => 6,
            Self::Pointing => 5,
            Self::XyzYaw => 4,
            Self::Position | Self::Planar => 3,
        }
    }

    /// Names of the numbers that are typed for it, in this order; none for a pose, which may be typed in many ways.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Pose => &[],
            Self::Position => &["x", "y", "z"],
            Self::Pointing => &["x", "y", "z", "dx", "dy", "dz"],
            Self::XyzYaw => &["x", "y", "z", "yaw"],
            Self::Planar => &["x", "y", "angle"],
        }
    }

    /// Whether the last of [`Self::columns`] is an angle.
    pub fn has_angle(self) -> bool {
        matches!(self, Self::XyzYaw | Self::Planar)
    }

    /// A pose with these numbers, in the order of [`Self::columns`] without the angle, and this yaw.
    pub fn pose_of(self, numbers: &[f64], yaw: Angle) -> Result<Pose, String> {
        let number = |k: usize| numbers.get(k).copied().unwrap_or_default();
        let position = [number(0), number(1), number(2)];
        if self == Self::Pointing {
            let direction = [number(3), number(4), number(5)];
            let pose = frame(position, direction, None);
            return pose.ok_or_else(|| "the direction has length 0".into());
        }
        let [c, s] = yaw.direction.map(Complex64::from);
        Ok(Pose {
            position: position.map(Complex64::from),
            ..Pose::about_z(c, s)
        })
    }

    /// A pose with the same part asked for, and a rest that is as [`Self::columns`] leave it: the rotation is any where it is not
    /// asked for. An error where the pose has no yaw.
    pub fn completed(self, pose: &Pose) -> Result<Pose, String> {
        let with_yaw = |position| {
            let [x, y] = [pose.rotation[0][0], pose.rotation[1][0]];
            let length = (x * x + y * y).re.sqrt();
            if length <= LEAST_ACROSS {
                return Err("the tool's x axis is along the base's z: it has no yaw");
            }
            let turn = Pose::about_z(x / length, y / length);
            Ok(Pose { position, ..turn })
        };
        let [x, y, _] = pose.position;
        Ok(match self {
            Self::Pose | Self::Pointing => *pose,
            Self::Position => {
                let any = Pose::of_quaternion(ANY_ROTATION.map(Complex64::from), pose.position);
                any.unwrap_or(*pose)
            }
            Self::XyzYaw => with_yaw(pose.position)?,
            Self::Planar => with_yaw([x, y, Complex64::default()])?,
        })
    }

    /// A pose from an object with `position` and, by the task, `direction`, `yaw` or `angle`; `None` where none of the last three
    /// is there, and for tasks that have none.
    pub(crate) fn pose_of_entry(
        self,
        entry: &Entry<'_>,
        degrees: bool,
    ) -> Result<Option<ReadPose>, MechanismError> {
        let last = match self {
            Self::Pose | Self::Position => return Ok(None),
            Self::Pointing => "direction",
            Self::XyzYaw => "yaw",
            Self::Planar => "angle",
        };
        let fields = entry.fields("a pose: an object with position")?;
        let Some(rest) = fields.optional(last) else {
            return Ok(None);
        };
        let position = fields.required("position", "the tool's origin")?;
        let mut numbers = match self {
            Self::Planar => position.doubles::<2>("two numbers")?.to_vec(),
            _ => position.doubles::<3>("three numbers")?.to_vec(),
        };
        let mut yaw = Angle::ZERO;
        match self {
            Self::Pointing => numbers.extend(rest.doubles::<3>("three numbers")?),
            _ => yaw = rest.angle(degrees, false)?.angle,
        }
        fields.finish()?;
        let pose = self.pose_of(&numbers, yaw);
        let pose = pose.map_err(|message| rest.error(message))?;
        Ok(Some(ReadPose::exact(pose)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_has_a_name_and_keeps_what_it_asks_for() {
        let (numbers, yaw) = ([0.3, -0.2, 0.5, 0.4, 0.1, -0.7], Angle::of_degrees(35.0));
        for (task, name) in NAMES {
            assert_eq!((Task::of_name(name), task.name()), (Some(task), name));
            let numbers = match task {
                Task::Planar => &numbers[..2],
                _ => &numbers[..],
            };
            let pose = task.pose_of(numbers, yaw).expect("numbers of this test");
            let completed = task.completed(&pose).expect("it has a yaw");
            assert_eq!(pose.position, completed.position, "{name}");
            if [Task::Pose, Task::Pointing].contains(&task) {
                assert_eq!(pose, completed);
            }
            if [Task::XyzYaw, Task::Planar].contains(&task) {
                assert!(pose.distance(&completed, 1.0) < 1e-15, "{name}");
            }
        }
        assert_eq!(Task::of_name("orientation"), None);
        assert!(Task::Pointing.pose_of(&[0.0; 6], Angle::ZERO).is_err());
        let upright = Pose::of_roll_pitch_yaw([0.0, -90.0, 0.0].map(Angle::of_degrees));
        assert!(Task::XyzYaw.completed(&upright).is_err());
    }
}
