//! How joints of a linkage move: elementary turns and shifts between frames, and the frames themselves.

use super::formulation::half_tangent;
use crate::mechanism::chain::JointValue;
use crate::mechanism::pose::{Pose, frame};
use crate::mechanism::{Joint, JointKind, Linkage, Side, Vector};
use num_complex::Complex64;

/// A vector of doubles.
pub fn real(v: &Vector) -> [f64; 3] {
    [v[0].to_f64(), v[1].to_f64(), v[2].to_f64()]
}

/// A joint as turns about z and shifts along z: before each a constant pose, and one after all.
#[derive(Clone, Debug, PartialEq)]
pub struct Elements {
    /// The constant pose before the element, and whether it turns.
    pub parts: Vec<(Pose, bool)>,
    /// The constant pose after all.
    pub after: Pose,
}

/// The frame of a joint in one of its links: z along the axis.
pub fn side_frame(side: &Side, kind: JointKind) -> Option<Pose> {
    let x = match kind {
        JointKind::U => None,
        _ => side.second.as_ref().map(real),
    };
    frame(real(&side.point), real(&side.axis), x)
}

/// The elements of a joint from its first link to its second; `None` for a ball, and where frames do not exist.
pub fn elements(joint: &Joint, at_home: bool) -> Option<Elements> {
    let first = side_frame(&joint.sides[0], joint.kind)?;
    let second = side_frame(&joint.sides[1], joint.kind)?;
    let along = |axis: [f64; 3]| frame([0.0; 3], axis, None);
    let parts = match joint.kind {
        JointKind::S => return None,
        JointKind::R => vec![(first, true)],
        JointKind::P => vec![(first, false)],
        JointKind::C => vec![(first, true), (Pose::IDENTITY, false)],
        JointKind::E => {
            let (x, y) = (along([1.0, 0.0, 0.0])?, along([0.0, 1.0, 0.0])?);
            let back = y.inverse();
            vec![
                (first.then(&x), false),
                (x.inverse().then(&y), false),
                (back, true),
            ]
        }
        JointKind::U if at_home => {
            let axis = joint.sides[0].second.as_ref().map(real)?;
            let other = frame(real(&joint.sides[0].point), axis, None)?;
            let parts = vec![(first, true), (first.inverse().then(&other), true)];
            return Some(Elements {
                parts,
                after: other.inverse(),
            });
        }
        JointKind::U => return None,
    };
    Some(Elements {
        parts,
        after: second.inverse(),
    })
}

impl Elements {
    /// The pose of the second link in the first for these values.
    pub fn pose(&self, values: &[JointValue]) -> Pose {
        let mut pose = Pose::IDENTITY;
        for ((before, _), value) in self.parts.iter().zip(values) {
            pose = value.moved(&pose.then(before));
        }
        pose.then(&self.after)
    }

    /// The inverse pose in elements: from the second link to the first, values negated.
    pub fn reversed(&self) -> Self {
        let mut parts = Vec::new();
        let mut before = self.after.inverse();
        for (pose, turns) in self.parts.iter().rev() {
            parts.push((before, *turns));
            before = pose.inverse();
        }
        Self {
            parts,
            after: before,
        }
    }
}

/// A joint of a spanning tree, as it leads away from the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// The joint.
    pub joint: usize,
    /// The link that is nearer to the ground, and the other.
    pub links: [usize; 2],
    /// Whether the joint's own first link is the farther one.
    pub is_reversed: bool,
}

/// A tree of joints from the ground to all links that joints but balls reach, without the links `left_out`;
/// driven joints are taken first, then by the number of joints from the ground.
pub fn spanning_tree(linkage: &Linkage, driven: &[usize], left_out: &[usize]) -> Vec<Branch> {
    let mut depth: Vec<Option<usize>> = vec![None; linkage.links.len()];
    depth[linkage.ground] = Some(0);
    let mut tree: Vec<Branch> = Vec::new();
    loop {
        let mut best: Option<(usize, Branch)> = None;
        for (j, joint) in linkage.joints.iter().enumerate() {
            if joint.kind == JointKind::S {
                continue;
            }
            for (from, to) in [(0, 1), (1, 0)] {
                let links = [joint.links[from], joint.links[to]];
                let (Some(near), None) = (depth[links[0]], depth[links[1]]) else {
                    continue;
                };
                if left_out.contains(&links[1]) {
                    continue;
                }
                let cost = near + usize::from(!driven.contains(&j));
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    let branch = Branch {
                        joint: j,
                        links,
                        is_reversed: from == 1,
                    };
                    best = Some((cost, branch));
                }
            }
        }
        let Some((cost, branch)) = best else {
            return tree;
        };
        depth[branch.links[1]] = Some(cost);
        tree.push(branch);
    }
}

/// A length of a linkage: the largest coordinate of a joint.
pub fn size(linkage: &Linkage) -> f64 {
    let sides = linkage.joints.iter().flat_map(|j| &j.sides);
    let size = sides
        .flat_map(|s| real(&s.point))
        .fold(0.0f64, |m, c| m.max(c.abs()));
    if size > 0.0 { size } else { 1.0 }
}

/// Parameters of the inputs of a linkage, joints by name: the half-tangent of a turn, the length of a shift.
pub fn input_parameters(linkage: &Linkage, inputs: &[String], values: &[f64]) -> Vec<Complex64> {
    let joint = |name: &String| linkage.joints.iter().find(|j| j.name == *name);
    let pairs = inputs.iter().zip(values);
    pairs
        .flat_map(|(name, x)| match joint(name).map(|j| j.kind) {
            Some(JointKind::R) => half_tangent(*x).to_vec(),
            _ => vec![(*x).into()],
        })
        .collect()
}
