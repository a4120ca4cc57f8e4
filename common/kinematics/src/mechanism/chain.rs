//! Chains of joints by Denavit-Hartenberg rows: frames along the chain, and rows from the axes of joints.

use super::exact::Angle;
use super::pose::{Pose, cross, dot, frame, unit};
use crate::plane;
use num_complex::Complex64;

/// Directions are parallel below this sine of their angle.
const PARALLEL: f64 = 1e-12;
/// Lengths below this part of the chain's are 0, and cosines below it.
const ROUNDING: f64 = 1e-13;

/// A row of the table: Rz(q + theta) Tz(d) Tx(a) Rx(alpha), or with a shift q instead Rz(theta) Tz(d + q) ...
#[derive(Clone, Debug, PartialEq)]
pub struct ChainJoint {
    /// The joint's name.
    pub name: String,
    /// Whether it turns; else it shifts.
    pub is_angle: bool,
    /// Length of the common normal to the next axis.
    pub a: f64,
    /// Angle from this axis to the next about the normal.
    pub alpha: Angle,
    /// Offset along the axis; of a shift, where it begins.
    pub d: f64,
    /// Angle about the axis; of a turn, where it begins.
    pub theta: Angle,
}

/// A chain of joints between a base and a tool; closed, its tool is its base.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The rows.
    pub joints: Vec<ChainJoint>,
    /// The frame of the first row in the base.
    pub base: Pose,
    /// The tool in the last frame.
    pub tool: Pose,
    /// The last link is the first.
    pub closed: bool,
    /// Length and twist before the first joint, where the file has rows in the modified convention; `base` contains them.
    pub first_normal: Option<(f64, Angle)>,
}

/// The value of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointValue {
    /// Cosine and sine of a turn.
    Turn(Complex64, Complex64),
    /// A shift.
    Shift(Complex64),
}

impl JointValue {
    /// The value of a real joint: an angle in radians, or a length.
    pub fn of_real(x: f64, is_angle: bool) -> Self {
        if is_angle {
            let [c, s] = Angle::of_radians(x).direction;
            Self::Turn(c.into(), s.into())
        } else {
            Self::Shift(x.into())
        }
    }

    /// The real value: radians in (-pi, pi], or a length.
    pub fn real(&self) -> f64 {
        match self {
            Self::Turn(c, s) => super::exact::radians(Complex64::new(c.re, s.re)),
            Self::Shift(z) => z.re,
        }
    }

    /// The real value of an angle in degrees, in (-180, 180], or a length.
    pub fn real_in_degrees(&self) -> f64 {
        match self {
            Self::Turn(c, s) => plane::degrees(Complex64::new(c.re, s.re)),
            Self::Shift(z) => z.re,
        }
    }

    /// A number that grows with [`Self::real`] and takes no arc tangent: positions are put in order by it.
    pub fn rank(&self) -> f64 {
        match self {
            Self::Turn(c, s) => {
                let height = s.re / (c.re.abs() + s.re.abs());
                if c.re >= 0.0 {
                    height
                } else if s.re >= 0.0 {
                    2.0 - height
                } else {
                    -2.0 - height
                }
            }
            Self::Shift(z) => z.re,
        }
    }

    /// The largest imaginary part.
    pub fn imaginary(&self) -> f64 {
        match self {
            Self::Turn(c, s) => c.im.abs().max(s.im.abs()),
            Self::Shift(z) => z.im.abs(),
        }
    }

    /// A frame, moved by the joint along or about its z.
    pub fn moved(&self, frame: &Pose) -> Pose {
        match *self {
            Self::Turn(c, s) => frame.turned(c, s),
            Self::Shift(z) => frame.then(&Pose::shift(0.0, 0.0, z)),
        }
    }

    /// The pose that the joint makes along or about z.
    pub fn pose(&self) -> Pose {
        match *self {
            Self::Turn(c, s) => Pose::about_z(c, s),
            Self::Shift(z) => Pose::shift(0.0, 0.0, z),
        }
    }
}

impl ChainJoint {
    /// The link after the joint: Tz(d) Tx(a) Rx(alpha).
    pub fn link(&self) -> Pose {
        let [c, s] = self.alpha.direction.map(Complex64::from);
        let turn = Pose::about_x(c, s);
        let position = [self.a.into(), Complex64::default(), self.d.into()];
        Pose { position, ..turn }
    }

    /// The frame at the end of the link, from the one at its beginning.
    pub fn along_link(&self, frame: &Pose) -> Pose {
        frame.along_link(self.a, self.alpha.direction, self.d)
    }

    /// Pose from the joint to the end of the joint's row: Rz(theta) Tz(d) Tx(a) Rx(alpha).
    pub fn after(&self) -> Pose {
        self.along_row(&Pose::IDENTITY)
    }

    /// The frame at the end of the row, from the one after the joint.
    pub fn along_row(&self, frame: &Pose) -> Pose {
        let [c, s] = self.theta.direction.map(Complex64::from);
        self.along_link(&frame.turned(c, s))
    }
}

/// The frame behind a common normal of this length and twist, from the one before it.
pub(crate) fn normal(a: f64, alpha: &Angle) -> Pose {
    let [c, s] = alpha.direction.map(Complex64::from);
    Pose::about_x(c, s).then(&Pose::shift(a, 0.0, 0.0))
}

impl Chain {
    /// The frame after every joint, and the tool's, for these values.
    pub fn frames(&self, values: &[JointValue]) -> Vec<Pose> {
        let mut frames = Vec::with_capacity(values.len() + 1);
        let mut row_frame = self.base;
        for (joint, value) in self.joints.iter().zip(values) {
            row_frame = joint.along_row(&value.moved(&row_frame));
            frames.push(row_frame);
        }
        frames.push(row_frame.then(&self.tool));
        frames
    }

    /// The tool's pose for these values.
    pub fn tool_pose(&self, values: &[JointValue]) -> Pose {
        let frames = self.frames(values);
        frames.last().copied().unwrap_or(self.base)
    }

    /// A length of the chain: the sum of its rows, at least that of base and tool; 1 where all are 0.
    pub fn size(&self) -> f64 {
        let mut size: f64 = self.joints.iter().map(|j| j.a.abs() + j.d.abs()).sum();
        for pose in [&self.base, &self.tool] {
            size += pose.position.iter().map(|c| c.re.abs()).sum::<f64>();
        }
        if size > 0.0 { size } else { 1.0 }
    }

    /// Axes of the joints, as a point and a direction, where the joints have these values; and the tool there.
    pub fn axes(&self, values: &[f64]) -> (Vec<Axis>, Pose) {
        let mut row_frame = self.base;
        let mut axes = Vec::new();
        for (joint, value) in self.joints.iter().zip(values) {
            let real = |v: [Complex64; 3]| v.map(|c| c.re);
            axes.push(Axis {
                name: joint.name.clone(),
                is_angle: joint.is_angle,
                point: real(row_frame.position),
                direction: real(row_frame.column(2)),
            });
            let value = JointValue::of_real(*value, joint.is_angle);
            row_frame = joint.along_row(&value.moved(&row_frame));
        }
        (axes, row_frame.then(&self.tool))
    }

    /// Axes of the joints that are not held, where these are 0 and the held ones have their values; and the tool there.
    pub fn free_axes(&self, held: &[Option<f64>]) -> (Vec<Axis>, Pose) {
        let values: Vec<f64> = held.iter().map(|v| v.unwrap_or(0.0)).collect();
        let (axes, tool) = self.axes(&values);
        let free = axes.into_iter().zip(held).filter(|(_, v)| v.is_none());
        (free.map(|(axis, _)| axis).collect(), tool)
    }

    /// The chain with joints held at values; `held` names one for each joint that is.
    pub fn with_held(&self, held: &[Option<f64>]) -> Option<Self> {
        let (free, tool) = self.free_axes(held);
        let mut chain = Self::of_axes(&free, tool)?;
        chain.closed = self.closed;
        Some(chain)
    }

    /// Rows for joints with these axes, given where all values are 0 and the tool is at `tool`.
    ///
    /// The lines of the axes decide the rows (J. Denavit and R. S. Hartenberg 1955): common normals give a and
    /// alpha, their feet d and theta. `None` where a direction is 0.
    pub fn of_axes(axes: &[Axis], tool: Pose) -> Option<Self> {
        let first = axes.first()?;
        let mut row_frame = frame(first.point, first.direction, None)?;
        let base = row_frame;
        let size = axes
            .iter()
            .map(|a| a.point.iter().map(|c| c.abs()).sum::<f64>())
            .fold(1e-300, f64::max);
        let rounded = |x: f64| if x.abs() <= ROUNDING * size { 0.0 } else { x };
        let mut joints = Vec::new();
        for (i, axis) in axes.iter().enumerate() {
            let Some(next) = axes.get(i + 1) else {
                joints.push(ChainJoint {
                    name: axis.name.clone(),
                    is_angle: axis.is_angle,
                    a: 0.0,
                    alpha: Angle::ZERO,
                    d: 0.0,
                    theta: Angle::ZERO,
                });
                break;
            };
            let origin = row_frame.position.map(|c| c.re);
            let x = row_frame.column(0).map(|c| c.re);
            let z = unit(axis.direction)?;
            let toward = unit(next.direction)?;
            let (normal, foot, far) = common_normal(origin, x, z, next, toward, size);
            let joint = ChainJoint {
                name: axis.name.clone(),
                is_angle: axis.is_angle,
                a: rounded(dot(std::array::from_fn(|k| far[k] - foot[k]), normal)),
                alpha: tidy_angle(dot(z, toward), dot(cross(z, toward), normal)),
                d: rounded(dot(std::array::from_fn(|k| foot[k] - origin[k]), z)),
                theta: tidy_angle(dot(x, normal), dot(z, cross(x, normal))),
            };
            row_frame = joint.along_row(&row_frame);
            joints.push(joint);
        }
        Some(Self {
            joints,
            base,
            tool: row_frame.inverse().then(&tool),
            closed: false,
            first_normal: None,
        })
    }
}

/// The axis of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The joint's name.
    pub name: String,
    /// Whether it turns about the axis; else it shifts along it.
    pub is_angle: bool,
    /// A point of the axis.
    pub point: [f64; 3],
    /// Direction of the axis, of any length.
    pub direction: [f64; 3],
}

/// Direction of the common normal of the line through `origin` along z and the next one, and its two feet.
fn common_normal(
    origin: [f64; 3],
    x: [f64; 3],
    z: [f64; 3],
    next: &Axis,
    toward: [f64; 3],
    size: f64,
) -> ([f64; 3], [f64; 3], [f64; 3]) {
    // A shift has a direction only: its line may pass through the origin here.
    let point = if next.is_angle { next.point } else { origin };
    let between: [f64; 3] = std::array::from_fn(|k| point[k] - origin[k]);
    let across = cross(z, toward);
    let square = dot(across, across);
    if square <= PARALLEL * PARALLEL {
        let along = dot(between, z);
        let offset: [f64; 3] = std::array::from_fn(|k| between[k] - along * z[k]);
        let far = std::array::from_fn(|k| origin[k] + offset[k]);
        return match unit(offset) {
            Some(normal) if dot(offset, offset).sqrt() > ROUNDING * size => (normal, origin, far),
            _ => (x, origin, origin),
        };
    }
    let length = square.sqrt();
    let normal = across.map(|c| c / length);
    // Feet of the common normal: origin + s z and point + t toward.
    let s = dot(cross(between, toward), across) / square;
    let t = dot(cross(between, z), across) / square;
    let foot = std::array::from_fn(|k| origin[k] + s * z[k]);
    let far = std::array::from_fn(|k| point[k] + t * toward[k]);
    (normal, foot, far)
}

/// An angle by cosine and sine, with multiples of 90 degrees exact up to rounding.
fn tidy_angle(c: f64, s: f64) -> Angle {
    if s.abs() <= ROUNDING {
        return Angle::quarters(if c < 0.0 { 2 } else { 0 });
    }
    if c.abs() <= ROUNDING {
        return Angle::quarters(if s < 0.0 { -1 } else { 1 });
    }
    Angle::of_direction(Complex64::new(c, s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rank_of_a_turn_grows_with_its_angle() {
        let turns: Vec<JointValue> = (-179..=180)
            .map(|degrees| JointValue::of_real(f64::from(degrees).to_radians(), true))
            .collect();
        for pair in turns.windows(2) {
            assert!(pair[0].real() < pair[1].real() && pair[0].rank() < pair[1].rank());
        }
        let shift = JointValue::of_real(-0.25, false);
        assert_eq!(shift.rank(), shift.real());
    }

    #[test]
    fn a_frame_goes_along_a_row_as_the_product_says() {
        let chain = chain();
        for joint in &chain.joints {
            let along = joint.along_row(&chain.tool);
            let [c, s] = joint.theta.direction.map(Complex64::from);
            let product = chain.tool.then(&Pose::about_z(c, s)).then(&joint.link());
            assert!(along.distance(&product, 1.0) < 1e-15);
        }
    }

    fn chain() -> Chain {
        let joint = |name: &str, is_angle, a, alpha, d| ChainJoint {
            name: name.into(),
            is_angle,
            a,
            alpha: Angle::of_degrees(alpha),
            d,
            theta: Angle::of_degrees(20.0),
        };
        Chain {
            joints: vec![
                joint("a", true, 0.3, 90.0, 0.2),
                joint("b", true, 0.5, 0.0, 0.1),
                joint("c", false, 0.1, -35.0, 0.4),
                joint("d", true, 0.0, 180.0, -0.3),
                joint("e", true, 0.2, 70.0, 0.3),
            ],
            base: Pose::shift(0.1, 0.2, 0.3),
            tool: Pose::of_roll_pitch_yaw([0.1, 0.2, 0.3].map(Angle::of_radians)),
            closed: false,
            first_normal: None,
        }
    }

    /// Rows that are made of axes give the same tool for the same values, although the frames of the rows differ.
    #[test]
    fn rows_of_axes_move_the_tool_as_the_axes_do() {
        let chain = chain();
        let (axes, tool) = chain.axes(&[0.0; 5]);
        let chain_of_axes = Chain::of_axes(&axes, tool).unwrap();
        for k in 0..5 {
            let values: Vec<JointValue> = (0..5)
                .map(|i| 0.4 * f64::from(k) - 0.3 * f64::from(i))
                .zip(&chain.joints)
                .map(|(x, j)| JointValue::of_real(x, j.is_angle))
                .collect();
            let (a, b) = (chain.tool_pose(&values), chain_of_axes.tool_pose(&values));
            assert!(a.distance(&b, 1.0) < 1e-14, "{k}: {}", a.distance(&b, 1.0));
        }
    }

    #[test]
    fn a_held_joint_is_a_part_of_its_link() {
        let chain = chain();
        let held = [None, Some(0.7), None, None, Some(-0.2)];
        let shorter = chain.with_held(&held).unwrap();
        assert_eq!(shorter.joints.len(), 3);
        let values = |list: &[f64], chain: &Chain| -> Vec<JointValue> {
            let pairs = list.iter().zip(&chain.joints);
            pairs
                .map(|(x, j)| JointValue::of_real(*x, j.is_angle))
                .collect()
        };
        let whole = chain.tool_pose(&values(&[0.3, 0.7, -0.4, 1.1, -0.2], &chain));
        let part = shorter.tool_pose(&values(&[0.3, -0.4, 1.1], &shorter));
        assert!(whole.distance(&part, 1.0) < 1e-14);
    }
}
