//! SixTurns: an arm of six turning joints between its first and its last axis, R1 L1 R2 ... L5 R6, lengths in parts of its
//! size. Every file comes down to it: tables, URDF, and joints by their axes.

use super::turn::{Turn, Turns};
use cognate_kinematics::mechanism::chain::{Chain, ChainJoint, JointValue};
use cognate_kinematics::mechanism::pose::{Pose, Vector3};
use num_complex::Complex64;

/// Lengths below this part of an arm's size are 0, and sines below it: products of a file's decimals are rounded to far less.
const ROUNDING: f64 = 1e-11;

/// Whether a length is 0 up to rounding.
pub fn is_no_length(length: f64) -> bool {
    length.abs() <= ROUNDING
}

/// Whether the axes at both ends of a link are parallel up to rounding.
pub fn is_parallel(link: &Link) -> bool {
    link.twist[1].abs() <= ROUNDING
}

/// A link: Tz(offset) Tx(length) Rx(twist), from one axis to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Distance of the two axes.
    pub length: f64,
    /// Cosine and sine of the angle from one axis to the next.
    pub twist: [f64; 2],
    /// Distance of the common normals along the first axis.
    pub offset: f64,
}

impl Link {
    fn of(joint: &ChainJoint, size: f64) -> Self {
        Self {
            length: joint.a / size,
            twist: joint.alpha.direction,
            offset: joint.d / size,
        }
    }

    /// A direction at the end of the link, in the frame at its beginning.
    pub fn direction(&self, [x, y, z]: Vector3) -> Vector3 {
        let [c, s] = self.twist;
        [x, y * c - z * s, y * s + z * c]
    }

    /// A point at the end of the link, in the frame at its beginning.
    pub fn point(&self, point: Vector3) -> Vector3 {
        let [x, y, z] = self.direction(point);
        [x + self.length, y, z + self.offset]
    }

    /// The frame at the end of the link, from the one at its beginning.
    pub fn after(&self, frame: &Pose) -> Pose {
        frame.along_link(self.length, self.twist, self.offset)
    }
}

/// The links between the axes of six turning joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SixTurns {
    /// The links, from that behind joint 1 to that before joint 6.
    pub links: [Link; 5],
}

impl SixTurns {
    /// The frame of the hand at these turns.
    #[cfg(test)]
    pub fn hand(&self, turns: &Turns) -> Pose {
        self.frame(Pose::IDENTITY, 0, turns)
    }

    /// The frame behind some of the joints with their links, from the one before them; `first` is the place of the first.
    pub fn frame(&self, from: Pose, first: usize, turns: &[Turn]) -> Pose {
        let joints = (first..).zip(turns);
        joints.fold(from, |frame, (place, turn)| {
            let turned = frame.turned(turn.c, turn.s);
            self.links
                .get(place)
                .map_or(turned, |link| link.after(&turned))
        })
    }

    /// The arm from its hand to its base, with turns the other way around; the first offset, which lies before all axes, is
    /// left out. The link (Tz(d) Tx(a) Rx(alpha))^-1 is Tx(-a) Rx(-alpha) Tz(-d), whose shift belongs to the next link.
    pub fn mirrored(&self) -> Self {
        let links = &self.links;
        Self {
            links: std::array::from_fn(|k| {
                let link = &links[4 - k];
                let [c, s] = link.twist;
                Link {
                    length: -link.length,
                    twist: [c, -s],
                    offset: links.get(5 - k).map_or(0.0, |next| -next.offset),
                }
            }),
        }
    }

    /// The hand of the mirrored arm where that of this one is `hand`.
    pub fn mirrored_hand(&self, hand: &Pose) -> Pose {
        hand.inverse()
            .then(&Pose::shift(0.0, 0.0, self.links[0].offset))
    }
}

/// The turns of an arm from those of the mirrored one, and back.
pub fn mirrored_turns(turns: &Turns) -> Turns {
    std::array::from_fn(|k| turns[5 - k].inverse())
}

/// A chain of six turning joints as its inner part, and what lies before and behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct InnerArm {
    /// The joints and the links between them.
    pub arm: SixTurns,
    /// Takes back the base.
    before: Pose,
    /// Takes back the last link and the tool.
    behind: Pose,
    /// The tool in the hand's frame.
    pub tool: [f64; 3],
    /// Cosine and sine at which each joint begins.
    starts: [[f64; 2]; 6],
    /// The length that is 1.
    size: f64,
}

impl InnerArm {
    /// Of a chain; `None` for one that is closed or has other joints than six turning ones.
    pub fn of(chain: &Chain) -> Option<Self> {
        let joints: &[ChainJoint; 6] = chain.joints[..].try_into().ok()?;
        if chain.closed || joints.iter().any(|joint| !joint.is_angle) {
            return None;
        }
        let size = chain.size();
        let behind = joints[5].link().then(&chain.tool);
        Some(Self {
            arm: SixTurns {
                links: std::array::from_fn(|k| Link::of(&joints[k], size)),
            },
            before: chain.base.inverse(),
            behind: behind.inverse(),
            tool: behind.position.map(|x| x.re / size),
            starts: std::array::from_fn(|k| joints[k].theta.direction),
            size,
        })
    }

    /// The hand where the tool has a pose.
    pub fn hand(&self, pose: &Pose) -> Pose {
        let hand = self.before.then(pose).then(&self.behind);
        Pose {
            position: hand.position.map(|x| x / self.size),
            ..hand
        }
    }

    /// The values of the chain's joints at these turns.
    pub fn values(&self, turns: &Turns) -> Vec<JointValue> {
        let pairs = turns.iter().zip(&self.starts);
        pairs
            .map(|(turn, start)| {
                let [c, s] = start.map(Complex64::from);
                let value = turn.then(&Turn { c, s: -s });
                JointValue::Turn(value.c, value.s)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_arms::{link, turns};
    use super::*;
    use cognate_numeric::random::{Purpose, RandomStream};

    #[test]
    fn the_mirrored_arm_has_the_inverse_hand() {
        let mut random = RandomStream::new(2, Purpose::Test, 74);
        let arm = SixTurns {
            links: [
                link(0.1, 70.0, 0.4),
                link(-0.3, 20.0, 0.1),
                link(0.2, -90.0, 0.3),
                link(0.0, 90.0, -0.2),
                link(0.1, 180.0, 0.5),
            ],
        };
        for _ in 0..20 {
            let turns = turns(&mut random);
            let hand = arm.mirrored_hand(&arm.hand(&turns));
            let mirrored = arm.mirrored().hand(&mirrored_turns(&turns));
            assert!(hand.distance(&mirrored, 1.0) < 1e-14);
            assert_eq!(mirrored_turns(&mirrored_turns(&turns)), turns);
        }
    }
}
