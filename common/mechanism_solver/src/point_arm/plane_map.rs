//! The map from the second and third joint of an arm to the plane in which the first joint moves nothing.
//!
//! Where the first joint turns, the coordinates of that plane are the square of the point's distance from a point of the axis,
//! and the height along the axis: with them cusps and folds are where they are with the distance from the axis. Where it
//! shifts, they are the coordinates across the shift. Lengths are in parts of the arm's size.

use super::joint_polynomial::{JointPolynomial, Turns, place};
use cognate_kinematics::mechanism::chain::{Axis, Chain};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_kinematics::mechanism::{Body, JointKind, Linkage, Mechanism, Space};

/// A point in a frame, by polynomials.
type Point = [JointPolynomial; 3];

/// An arm of three joints, as the map of its second and third joint.
pub struct PlaneMap {
    /// Whether the second and third joint turn.
    pub turns: Turns,
    /// Whether the first joint turns.
    pub first_turns: bool,
    /// The two coordinates.
    pub coordinates: [JointPolynomial; 2],
    /// Derivatives of the coordinates: of each coordinate by each joint.
    pub jacobian: [[JointPolynomial; 2]; 2],
    /// The determinant of the derivatives: 0 where the arm is singular.
    pub determinant: JointPolynomial,
    /// The point in the frame of the second joint, by the third.
    pub point_at_second: Point,
    /// The frame of the second joint in that of the first.
    pub second_frame: Pose,
    /// Unit of length.
    pub size: f64,
}

impl PlaneMap {
    /// The map of an arm of three joints in space; `None` for other mechanisms.
    pub fn of(mechanism: &Mechanism) -> Option<Self> {
        let is_point = mechanism.output.as_ref().is_none_or(|o| o.point.is_some());
        if mechanism.space != Space::Spatial || !is_point {
            return None;
        }
        match &mechanism.body {
            Body::Chain(chain) if !chain.closed => Self::of_chain(chain),
            Body::Linkage(linkage) => Self::of_chain(&chain(linkage, mechanism)?),
            _ => None,
        }
    }

    /// The map of a chain of three joints.
    pub fn of_chain(chain: &Chain) -> Option<Self> {
        let [first, second, third] = chain.joints.as_slice() else {
            return None;
        };
        let size = chain.size();
        let turns = [second.is_angle, third.is_angle];
        let unit = |pose: Pose| Pose {
            position: pose.position.map(|x| x / size),
            ..pose
        };
        let tool = unit(chain.tool).position.map(|x| x.re);
        let tool = tool.map(|x| JointPolynomial::constant(turns, x));
        let at_third = moved(&unit(third.after()), &tool);
        let point_at_second = moved(&unit(second.after()), &joined(turns, 1, &at_third));
        let second_frame = unit(first.after());
        let point = moved(&second_frame, &joined(turns, 0, &point_at_second));
        let [x, y, z] = &point;
        let coordinates = match first.is_angle {
            true => [x.times(x).plus(&y.times(y)).plus(&z.times(z)), z.clone()],
            false => [x.clone(), y.clone()],
        };
        let coordinates = coordinates.map(|f| f.rounded(1.0));
        let jacobian = coordinates
            .each_ref()
            .map(|f| [f.derivative(0), f.derivative(1)]);
        let [[a, b], [c, d]] = &jacobian;
        let sizes = a.bound() * d.bound() + b.bound() * c.bound();
        let determinant = a.times(d).minus(&b.times(c)).rounded(sizes);
        Some(Self {
            turns,
            first_turns: first.is_angle,
            coordinates,
            jacobian,
            determinant,
            point_at_second: point_at_second.map(|f| f.rounded(1.0)),
            second_frame,
            size,
        })
    }

    /// The coordinates in the plane, at cosines and sines of the joints.
    pub fn value(&self, at: &[f64; 4]) -> [f64; 2] {
        self.coordinates.each_ref().map(|f| f.value(at))
    }

    /// Distance from the first axis and height along it, in units of the mechanism; the coordinates across a first shift.
    pub fn shown(&self, value: [f64; 2]) -> [f64; 2] {
        let [a, b] = value;
        match self.first_turns {
            true => [(a - b * b).max(0.0).sqrt() * self.size, b * self.size],
            false => [a * self.size, b * self.size],
        }
    }

    /// Cosines and sines at these values of the joints.
    pub fn place(&self, values: [f64; 2]) -> [f64; 4] {
        place(self.turns, values)
    }
}

/// The image of a point under a constant displacement.
fn moved(pose: &Pose, point: &Point) -> Point {
    std::array::from_fn(|i| {
        let turns = point[i].scaled(0.0);
        let sum = (0..3).fold(turns, |sum, k| {
            sum.plus(&point[k].scaled(pose.rotation[i][k].re))
        });
        let shift = sum.constant_like(pose.position[i].re);
        sum.plus(&shift)
    })
}

/// The image of a point under a joint, 0 for the second and 1 for the third.
fn joined(turns: Turns, joint: usize, point: &Point) -> Point {
    let [x, y, z] = point;
    let sine = JointPolynomial::sine(turns, joint);
    if !turns[joint] {
        return [x.clone(), y.clone(), z.plus(&sine)];
    }
    let cosine = JointPolynomial::cosine(turns, joint);
    [
        cosine.times(x).minus(&sine.times(y)),
        sine.times(x).plus(&cosine.times(y)),
        z.clone(),
    ]
}

/// The rows of a linkage of three turns and shifts in series from the ground to the point of its output.
fn chain(linkage: &Linkage, mechanism: &Mechanism) -> Option<Chain> {
    let output = mechanism.output.as_ref()?;
    let tool = output.point.as_ref()?.each_ref().map(|x| x.to_f64());
    if !linkage.at_home || linkage.joints.len() != 3 || linkage.links.len() != 4 {
        return None;
    }
    let (mut link, mut left) = (linkage.ground, vec![0, 1, 2]);
    let mut axes = Vec::new();
    while !left.is_empty() {
        let mut here = (0..left.len()).filter(|k| linkage.joints[left[*k]].links.contains(&link));
        let (next, other) = (here.next()?, here.next());
        if other.is_some() {
            return None;
        }
        let joint = &linkage.joints[left.swap_remove(next)];
        if !matches!(joint.kind, JointKind::R | JointKind::P) {
            return None;
        }
        let side = &joint.sides[0];
        axes.push(Axis {
            name: joint.name.clone(),
            is_angle: joint.kind == JointKind::R,
            point: side.point.each_ref().map(|x| x.to_f64()),
            direction: side.axis.each_ref().map(|x| x.to_f64()),
        });
        link = joint.links[usize::from(joint.links[0] == link)];
    }
    if linkage.links.get(link) != Some(&output.link) {
        return None;
    }
    let [x, y, z] = tool;
    Chain::of_axes(&axes, Pose::shift(x, y, z))
}
