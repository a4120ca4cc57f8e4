//! Arms: the two arms of a five-bar, which meet in the output point.
//!
//! Each arm is a chain of two links. The postures of the five-bar at a point are the pairs of postures of its arms.

use super::planar_chain::PlanarChain;
use super::reached_point::ReachedPoint;
use super::two_links;
use cognate_kinematics::mechanism::{JointKind, Linkage, Mechanism, Vector};

/// The two arms of a five-bar that meet in the output point.
pub struct Arms {
    /// The two chains from the ground to the output point.
    pub chains: [PlanarChain; 2],
    /// Name of the joint in which they meet.
    pub between: String,
}

impl Arms {
    /// The arms of a single loop of five turns; `None` for another linkage.
    pub fn of(
        mechanism: &Mechanism,
        linkage: &Linkage,
        (link, place): (usize, &Vector),
    ) -> Option<Self> {
        let all_turn = linkage.joints.iter().all(|j| j.kind == JointKind::R);
        if linkage.links.len() != 5 || linkage.joints.len() != 5 || !all_turn {
            return None;
        }
        let is_there = |v: &Vector| (0..2).all(|k| v[k].value == place[k].value);
        let mut joints = linkage.joints.iter().enumerate();
        let (number, joint) = joints
            .find(|(_, joint)| joint.links.contains(&link) && is_there(&joint.sides[0].point))?;
        let arm = |end: usize| PlanarChain::toward(mechanism, linkage, (end, place), Some(number));
        let chains = [arm(joint.links[0])?, arm(joint.links[1])?];
        chains
            .iter()
            .all(|chain| chain.turns.len() == 2)
            .then(|| Self {
                chains,
                between: joint.name.clone(),
            })
    }

    /// Reachability of a point for the five-bar if the joint between the rods has no limits; `None` if a link has no
    /// length.
    pub fn reached(&self, point: [f64; 2]) -> Option<ReachedPoint> {
        let [one, other] = &self.chains;
        let [one, other] = [
            two_links::reached(one, point)?,
            two_links::reached(other, point)?,
        ];
        let is_out = |arm: &ReachedPoint| arm.reachable == Some(false);
        if is_out(&one) || is_out(&other) {
            return Some(ReachedPoint::counted(0, 0));
        }
        for arm in [&one, &other] {
            if let Some(doubt) = &arm.doubt {
                return Some(ReachedPoint::in_doubt(doubt.clone()));
            }
        }
        let both = |a: Option<bool>, b: Option<bool>| Some(a? && b?);
        let product = |a: Option<u64>, b: Option<u64>| match (a, b) {
            (Some(0), _) | (_, Some(0)) => Some(0),
            _ => Some(a? * b?),
        };
        let reachable_within_limits =
            both(one.reachable_within_limits, other.reachable_within_limits);
        Some(ReachedPoint {
            reachable: Some(true),
            reachable_within_limits,
            postures: product(one.postures, other.postures),
            within_limits: product(one.within_limits, other.within_limits),
            ..ReachedPoint::default()
        })
    }
}
