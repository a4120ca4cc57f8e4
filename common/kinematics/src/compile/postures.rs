//! Postures of chains: frames for joint values, with their names, and the turn that closes a chain.

use super::formulation::{Configuration, Lifted};
use super::six_joint_arm::SixJointArm;
use crate::mechanism::chain::{Chain, JointValue};
use crate::mechanism::pose::{Pose, Vector3};
use crate::mechanism::{Mechanism, link_name};
use num_complex::Complex64;
use std::sync::Arc;

/// A chain whose positions are asked for, with the names that all of them share.
pub struct Postures {
    /// The chain.
    pub chain: Chain,
    joints: Vec<Arc<str>>,
    links: Vec<Arc<str>>,
    /// The output of a loop: the place of the link, and a point of it. `None` if the output is the tool.
    output: Option<(usize, Pose)>,
}

impl Postures {
    /// Names joints as the chain of a mechanism does, and links by their numbers.
    pub fn of(mechanism: &Mechanism, chain: Chain) -> Self {
        let joints = chain.joints.iter();
        let links: Vec<Arc<str>> = (1..=chain.joints.len())
            .map(|i| link_name(i).into())
            .collect();
        let of_loop = mechanism.output.as_ref().filter(|_| chain.closed);
        let output = of_loop.and_then(|output| {
            let link = links.iter().position(|link| **link == *output.link)?;
            let point = output.point.as_ref();
            let place = |i: usize| point.map_or(0.0, |point| point[i].to_f64());
            Some((link, Pose::shift(place(0), place(1), place(2))))
        });
        Self {
            joints: joints.map(|joint| joint.name.as_str().into()).collect(),
            links,
            output,
            chain,
        }
    }

    /// Values of all joints from those that are held and those of the others, in their order.
    pub fn with_held(&self, held: &[Option<f64>], free: &[JointValue]) -> Vec<JointValue> {
        let mut free = free.iter().copied();
        let joints = held.iter().zip(&self.chain.joints);
        joints
            .map(|(value, joint)| match value {
                Some(x) => JointValue::of_real(*x, joint.is_angle),
                None => free
                    .next()
                    .unwrap_or(JointValue::Shift(Complex64::default())),
            })
            .collect()
    }

    /// The posture of an arm with these values of its joints; how far its tool is from a pose is its residual, divided by a growth.
    pub fn of_arm(
        &self,
        arm: &SixJointArm,
        held: &[Option<f64>],
        values: &[JointValue],
        (pose, growth): (&Pose, f64),
    ) -> Configuration {
        let size = self.chain.size();
        self.position(self.with_held(held, values), |tool| {
            arm.gap(values, tool, pose, size) / growth
        })
    }

    /// Meaning of a solution with these values of an arm's joints: a posture as [`Self::of_arm`] gives it, or the
    /// reason why it is not a posture.
    pub fn lifted(
        &self,
        arm: &SixJointArm,
        held: &[Option<f64>],
        values: &[JointValue],
        toward: (&Pose, f64),
    ) -> Lifted {
        match arm.refused(values) {
            Some(reason) => Lifted::Degenerate(reason),
            None => Lifted::Position(Box::new(self.of_arm(arm, held, values, toward))),
        }
    }

    /// The position for these values, with its frames; `residual` says how far its tool is from where it should be.
    pub fn position(
        &self,
        values: Vec<JointValue>,
        residual: impl FnOnce(&Pose) -> f64,
    ) -> Configuration {
        let frames = self.chain.frames(&values);
        let output = frames.last().copied().unwrap_or(self.chain.base);
        let of_link = |(link, point): &(usize, Pose)| frames[*link].then(point);
        Configuration {
            residual: residual(&output),
            output: Some(self.output.as_ref().map_or(output, of_link)),
            bodies: self.links.iter().cloned().zip(frames).collect(),
            values: self.joints.iter().cloned().zip(values).collect(),
        }
    }
}

/// Cosine and sine of the turn about z that takes two vectors to two others, by least squares of their first two
/// coordinates. `None` where both are along z.
pub fn turn_between(
    (i, h): (Vector3, Vector3),
    (y, w): (Vector3, Vector3),
) -> Option<(Complex64, Complex64)> {
    // c, s with R (i, h) = (y, w) in the first two coordinates.
    let (mut cc, mut ss, mut over) = (
        Complex64::default(),
        Complex64::default(),
        Complex64::default(),
    );
    let mut size = 0.0;
    for (from, to) in [(i, y), (h, w)] {
        cc += from[0] * to[0] + from[1] * to[1];
        ss += from[0] * to[1] - from[1] * to[0];
        over += from[0] * from[0] + from[1] * from[1];
        size += from[0].norm_sqr() + from[1].norm_sqr();
    }
    if size < 1e-20 {
        return None;
    }
    // Isotropic: the sum of squares vanishes; then the determinant of the two pairs decides.
    if over.norm_sqr() < 1e-16 * size * size {
        let determinant = i[0] * h[1] - i[1] * h[0];
        if determinant.norm_sqr() < 1e-16 * size * size {
            return None;
        }
        let c = (y[0] * h[1] - i[1] * w[0]) / determinant;
        let s = (i[0] * w[0] - h[0] * y[0]) / -determinant;
        return Some((c, s));
    }
    Some((cc / over, ss / over))
}
