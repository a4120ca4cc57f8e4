//! Chains with fewer free joints than a pose has freedoms: joints are added until there are six, and have to stay at 0.

use crate::mechanism::chain::{Axis, Chain, JointValue};
use crate::mechanism::pose::Pose;
use cognate_numeric::random::{Purpose, RandomStream};

/// Freedoms of a pose.
pub const FREEDOMS: usize = 6;
/// Number of the random stream of added axes.
const ADDED: u64 = 0x6164_6465;

/// The arm of six free joints that an open chain is. Joints that are held are parts of its links. Where fewer than six are
/// free, others are added behind the tool, with axes drawn at random: the arm is general, and its postures in which the
/// added joints stay at 0 are those of the chain. `None` where the axes give no rows.
pub fn arm_of(chain: &Chain, held: &[Option<f64>]) -> Option<Chain> {
    if held.len() == FREEDOMS && held.iter().all(Option::is_none) {
        return Some(chain.clone());
    }
    let (mut axes, tool) = chain.free_axes(held);
    let mut random = RandomStream::new(0, Purpose::Probe, ADDED);
    let mut vector = || -> [f64; 3] { std::array::from_fn(|_| 2.0 * random.uniform() - 1.0) };
    let size = chain.size();
    while axes.len() < FREEDOMS {
        let offset = vector();
        axes.push(Axis {
            name: format!("added {}", axes.len() + 1),
            is_angle: true,
            point: std::array::from_fn(|i| tool.position[i].re + 0.3 * size * offset[i]),
            direction: vector(),
        });
    }
    Chain::of_axes(&axes, tool)
}

/// How many joints of an arm were added to a chain with these held joints.
pub fn added_to(arm: &Chain, held: &[Option<f64>]) -> usize {
    let free = held.iter().filter(|held| held.is_none()).count();
    arm.joints.len().saturating_sub(free)
}

/// The chain alone: the last so many joints stay at 0 as parts of the tool.
pub fn without_added(arm: &Chain, added: usize) -> Chain {
    let (joints, last) = arm.joints.split_at(arm.joints.len().saturating_sub(added));
    let behind = last
        .iter()
        .fold(Pose::IDENTITY, |frame, joint| joint.along_row(&frame));
    Chain {
        joints: joints.to_vec(),
        tool: behind.then(&arm.tool),
        ..arm.clone()
    }
}

/// The name of the family of an arm with these free joints of its own.
pub fn family_name(letters: &str) -> String {
    match FREEDOMS.saturating_sub(letters.len()) {
        0 => letters.into(),
        1 => format!("{letters} and 1 added joint that stays at 0"),
        added => format!("{letters} and {added} added joints that stay at 0"),
    }
}

/// Joints that were added stay at 0 within this: a pose of 16 digits is reached to as many.
const AT_REST: f64 = 1e-9;

/// What a solution is called in which added joints move.
pub const OUT_OF_REACH: &str = "out of the chain's reach";

/// Whether the last so many values, those of added joints, are 0.
pub fn at_rest(values: &[JointValue], added: usize) -> bool {
    let last = &values[values.len().saturating_sub(added)..];
    last.iter().all(|value| match value {
        JointValue::Turn(c, s) => c.re > 0.0 && s.norm_sqr() <= AT_REST * AT_REST,
        JointValue::Shift(d) => d.norm_sqr() <= AT_REST * AT_REST,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Body, ReadOptions, read};

    #[test]
    fn added_joints_at_rest_leave_the_chain_as_it_is() {
        let table = b"# angles: deg\ntype,theta,d,a,alpha\nR,0,0.4,0.225,0\nR,0,0,0.275,180\nP,0,0,0,0\nR,0,0.05,0,0\n";
        let scara =
            read("scara.csv", table, &ReadOptions::default()).expect("a table of this test");
        let Body::Chain(chain) = &scara.body else {
            panic!("a table is a chain");
        };
        let arm = arm_of(chain, &[None; 4]).expect("axes with rows");
        assert_eq!(
            (arm.joints.len(), added_to(&arm, &[None; 4])),
            (FREEDOMS, 2)
        );
        let short = without_added(&arm, 2);
        let joints = arm.joints.iter().zip([0.3, -0.7, 0.1, 1.1, 0.0, 0.0]);
        let mut values: Vec<JointValue> = joints
            .map(|(joint, x)| JointValue::of_real(x, joint.is_angle))
            .collect();
        assert!(at_rest(&values, 2));
        let tool = chain.tool_pose(&values[..4]);
        assert!(arm.tool_pose(&values).distance(&tool, 1.0) < 1e-14);
        assert!(short.tool_pose(&values[..4]).distance(&tool, 1.0) < 1e-14);
        values[5] = JointValue::of_real(1e-6, true);
        assert!(!at_rest(&values, 2));
        values[5] = JointValue::of_real(std::f64::consts::PI, true);
        assert!(!at_rest(&values, 2));
    }
}
