//! SixJointArm: a chain and a task completed to an arm of six free joints, of which every pose has finitely many postures.
//!
//! Joints behind the tool give way in what a task leaves free; others are added until there are six, and have to stay at 0.

use crate::mechanism::chain::{Axis, Chain, ChainJoint, JointValue};
use crate::mechanism::pose::Pose;
use crate::mechanism::task::{LEAST_ACROSS, Task};
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// Freedoms of a pose.
pub const FREEDOMS: usize = 6;
/// Number of the random stream of added axes.
const ADDED: u64 = 0x6164_6465;
/// Joints that were added stay at 0 within this: a pose of 16 digits is reached to as many.
const AT_REST: f64 = 1e-9;

/// Name of a solution in which added joints move.
pub const OUT_OF_REACH: &str = "out of the chain's reach";
/// Name of the second of two solutions with one posture: the three turns about the tool's origin have two values each.
const SECOND_VALUES: &str = "the same posture a second time";
/// Name of a solution whose tool has the yaw turned by 180 degrees.
const OTHER_YAW: &str = "the tool's x axis points the opposite way";
/// Name of a solution whose tool has any yaw.
const NO_YAW: &str = "the tool's x axis is along the base's z: it has no yaw";

/// A chain and a task completed to an arm.
#[derive(Clone, Debug, PartialEq)]
pub struct SixJointArm {
    /// The free joints of the chain, those that give way in what the task leaves free, those that stay at 0. Held joints of the
    /// chain are parts of its links.
    pub arm: Chain,
    /// The part of a pose that is given.
    pub task: Task,
    /// How many of the last joints stay at 0.
    pub at_rest: usize,
}

impl SixJointArm {
    /// The arm for a chain with these held joints; `None` where the axes give no rows.
    pub fn of(chain: &Chain, held: &[Option<f64>], task: Task) -> Option<Self> {
        if held.len() == FREEDOMS && held.iter().all(Option::is_none) && task == Task::Pose {
            return Some(Self {
                arm: chain.clone(),
                task,
                at_rest: 0,
            });
        }
        let (mut axes, tool) = chain.free_axes(held);
        axes.extend(giving_way(task, &tool));
        let at_rest = FREEDOMS.saturating_sub(axes.len());
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
        Some(Self {
            arm: Chain::of_axes(&axes, tool)?,
            task,
            at_rest,
        })
    }

    /// Whether all its joints are the chain's own.
    pub fn is_chain(&self) -> bool {
        self.at_rest == 0 && self.task == Task::Pose
    }

    /// How many of the first joints are the chain's own.
    pub fn joints_of_chain(&self) -> usize {
        let behind = self.at_rest + FREEDOMS - self.task.freedoms();
        self.arm.joints.len().saturating_sub(behind)
    }

    /// The kinds of the chain's own joints: R where one turns, P where it shifts.
    fn letters(&self) -> String {
        let joints = self.arm.joints.iter().take(self.joints_of_chain());
        let letter = |joint: &ChainJoint| if joint.is_angle { 'R' } else { 'P' };
        joints.map(letter).collect()
    }

    /// The arm without the joints that stay at 0: these are parts of the tool.
    pub fn without_joints_at_rest(&self) -> Chain {
        let (joints, last) = self
            .arm
            .joints
            .split_at(self.arm.joints.len() - self.at_rest);
        let behind = last
            .iter()
            .fold(Pose::IDENTITY, |frame, joint| joint.along_row(&frame));
        Chain {
            joints: joints.to_vec(),
            tool: behind.then(&self.arm.tool),
            ..self.arm.clone()
        }
    }

    /// Why a solution with these values of the arm's joints is no posture of the chain, or not a further one; `None` where it is
    /// one.
    pub fn refused(&self, values: &[JointValue]) -> Option<&'static str> {
        if !at_rest(values, self.at_rest) {
            return Some(OUT_OF_REACH);
        }
        let cosine = self.cosine_of_pitch(values)?;
        match self.task {
            Task::Position => (cosine.re < 0.0).then_some(SECOND_VALUES),
            _ => self.without_yaw(values),
        }
    }

    /// Why the tool has not the yaw that is asked for; `None` where it has, or where none is asked for.
    pub fn without_yaw(&self, values: &[JointValue]) -> Option<&'static str> {
        let cosine = self.cosine_of_pitch(values)?;
        match self.task {
            Task::Pose | Task::Pointing | Task::Position => None,
            _ if cosine.norm_sqr() <= LEAST_ACROSS * LEAST_ACROSS => Some(NO_YAW),
            Task::XyzYaw | Task::Planar => (cosine.re < 0.0).then_some(OTHER_YAW),
        }
    }

    /// The cosine of the pitch among the joints that give way, where it is one of them. Yaw, pitch and roll (a, b, c) and
    /// (a + 180, 180 - b, c + 180) are the same rotation: the yaw is that of the tool's x axis where the pitch is below 90
    /// degrees.
    fn cosine_of_pitch(&self, values: &[JointValue]) -> Option<Complex64> {
        match (self.task, values.get(self.joints_of_chain() + PITCH)?) {
            (Task::Pose | Task::Pointing, _) | (_, JointValue::Shift(_)) => None,
            (_, JointValue::Turn(cosine, _)) => Some(*cosine),
        }
    }

    /// Distance of the tool from a pose, behind the joints that give way, in units of `size`; `tool` is the tool of the
    /// chain.
    pub fn gap(&self, values: &[JointValue], tool: &Pose, pose: &Pose, size: f64) -> f64 {
        match self.task {
            Task::Pose => tool.distance(pose, size),
            _ => self.arm.tool_pose(values).distance(pose, size),
        }
    }

    /// The name of its family.
    pub fn family_name(&self) -> String {
        let letters = self.letters();
        let task = match self.task {
            Task::Pose => String::new(),
            task => format!(" for {}", task.name()),
        };
        match self.at_rest {
            0 => format!("{letters}{task}"),
            1 => format!("{letters}{task} and 1 added joint that stays at 0"),
            added => format!("{letters}{task} and {added} added joints that stay at 0"),
        }
    }
}

/// The place of the pitch among these joints, where there is one.
const PITCH: usize = 1;

/// Joints at the tool that move it in what a task leaves free.
fn giving_way(task: Task, tool: &Pose) -> Vec<Axis> {
    let along = |name: &str, is_angle, column: usize| Axis {
        name: name.into(),
        is_angle,
        point: tool.position.map(|x| x.re),
        direction: tool.column(column).map(|x| x.re),
    };
    let roll = || along("roll of the tool", true, 0);
    let pitch = || along("pitch of the tool", true, 1);
    let yaw = || along("yaw of the tool", true, 2);
    match task {
        Task::Pose => Vec::new(),
        Task::Position => vec![yaw(), pitch(), roll()],
        Task::Pointing => vec![along("turn about the tool's z", true, 2)],
        // Behind the turns the frame has the yaw alone, and its z is the base's.
        Task::XyzYaw => vec![roll(), pitch()],
        Task::Planar => vec![roll(), pitch(), along("height of the tool", false, 2)],
    }
}

/// Whether the last `added` values, which belong to added joints, are 0.
fn at_rest(values: &[JointValue], added: usize) -> bool {
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
        let six = SixJointArm::of(chain, &[None; 4], Task::Pose).expect("axes with rows");
        let arm = &six.arm;
        assert_eq!(
            (arm.joints.len(), six.at_rest, six.joints_of_chain()),
            (FREEDOMS, 2, 4)
        );
        let short = six.without_joints_at_rest();
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
