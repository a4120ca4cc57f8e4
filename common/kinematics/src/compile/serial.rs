//! Chains: six turns by eight quadrics in the joints 1, 2, 4 and 5; forward by multiplying out.
//!
//! Held joints become parts of their links, so that a redundant arm or a loop with driven joints is an arm of six.

use super::formulation::{
    ArmFormulation, CLOSES, Configuration, Family, Formulation, KnownMember, Lifted, Problem,
    Question, Target, turn_of,
};
use super::postures::{Postures, turn_between};
use super::six_joint_arm::{FREEDOMS, SixJointArm};
use super::text::Equations;
use crate::compile::{invariants, left_out, six_revolute};
use crate::mechanism::chain::{Chain, ChainJoint, JointValue};
use crate::mechanism::exact::Angle;
use crate::mechanism::pose::{Pose, Vector3};
use crate::mechanism::task::Task;
use crate::mechanism::{Mechanism, MechanismError};
use crate::plane::modulus;
use cognate_numeric::counted::counted;
use num_complex::Complex64;
use std::borrow::Cow;
use std::ops::Range;

/// The formulation of a chain's question.
pub fn compile(
    mechanism: &Mechanism,
    chain: &Chain,
    question: &Question,
    inputs: Vec<String>,
) -> Result<Box<dyn Formulation>, MechanismError> {
    if !chain.closed && question.problem == Problem::Forward {
        return Ok(Box::new(Open::new(mechanism, chain, question)?));
    }
    if chain.closed && question.problem == Problem::Inverse {
        return Err(mechanism
            .error("a loop has no free end: ask forward, with as many inputs as it has freedoms"));
    }
    if !chain.closed && question.problem == Problem::Motion {
        return Err(mechanism.error("an open chain moves freely; ask inverse or forward"));
    }
    let place = |name: &String| chain.joints.iter().position(|j| j.name == *name);
    let mut locked = vec![None; chain.joints.len()];
    for (name, value) in &question.locks {
        if let Some(i) = place(name) {
            locked[i] = Some(*value);
        }
    }
    let mut driven = Vec::new();
    for name in &inputs {
        match place(name) {
            Some(i) if locked[i].is_none() => driven.push(i),
            _ => return Err(mechanism.error(format!("{name} is locked and an input"))),
        }
    }
    let held = locked.iter().flatten().count() + driven.len();
    let free = chain.joints.len() - held;
    let turns = (0..chain.joints.len())
        .filter(|i| locked[*i].is_none() && !driven.contains(i))
        .all(|i| chain.joints[i].is_angle);
    refuse(mechanism, chain, question.task, free, turns)?;
    let arm = match chain.closed {
        // Which joints are free, the targets say.
        true => SixJointArm {
            arm: chain.clone(),
            task: Task::Pose,
            at_rest: 0,
        },
        false => {
            let arm = SixJointArm::of(chain, &locked, question.task);
            let arm = arm.ok_or_else(|| mechanism.error("its axes give no rows"))?;
            refuse_idle(mechanism, &arm)?;
            arm
        }
    };
    let has_shifts = arm.arm.joints.iter().any(|joint| !joint.is_angle);
    if !chain.closed && (has_shifts || left_out::first_left_out(&arm.arm) != Some(THIRD)) {
        return invariants::compile(mechanism, chain, locked, arm);
    }
    let name = match free {
        _ if chain.closed => "6R loop".into(),
        FREEDOMS => "6R".into(),
        _ => arm.family_name(),
    };
    Ok(Box::new(SixRevolute {
        postures: Postures::of(mechanism, chain.clone()),
        arm,
        locked,
        driven,
        inputs,
        equations: six_revolute::equations(),
        family: Family {
            name,
            expected: Some(16),
            source: "Raghavan and Roth 1993",
            representation: "8 quadrics in cosines and sines of joints 1, 2, 4, 5; joints 3 and 6 follow linearly",
        },
    }))
}

/// Errors of chains with more or fewer freedoms than a pose has, or with shifts.
fn refuse(
    mechanism: &Mechanism,
    chain: &Chain,
    task: Task,
    free: usize,
    turns: bool,
) -> Result<(), MechanismError> {
    let count = chain.joints.len();
    let freedoms = task.freedoms();
    if free > freedoms && !chain.closed {
        let example = &chain.joints[(count - 1) / 3].name;
        let given = match task {
            Task::Pose => "a pose of 6 freedoms".into(),
            task => format!("the task {} of {freedoms} freedoms", task.name()),
        };
        return Err(mechanism.error(format!(
            "{count} joints for {given}: the arm is redundant, {} too many, its postures for a pose form curves; \
             {} (--lock {example}=0.3)",
            free - freedoms,
            match free == freedoms + 1 {
                true => format!("try values of one (--sweep {example}), or lock it"),
                false => "lock joints".to_owned(),
            },
        )));
    }
    if free > 6 {
        return Err(mechanism.error(format!(
            "a loop of {count} joints needs {}, {} given; name them with --input",
            counted(count - 6, "input"),
            match count - free {
                1 => "1 is".to_owned(),
                n => format!("{n} are"),
            }
        )));
    }
    if free == 0 && !chain.closed {
        return Err(mechanism.error("no joint of it is free"));
    }
    if free < 6 && chain.closed {
        return Err(mechanism.error(format!(
            "a loop with {free} free joints closes only for special dimensions; where it does it moves, which is asked by motion"
        )));
    }
    if !turns && chain.closed {
        return Err(mechanism.error(
            "not in this version: loops of rows with P joints; say it by links and joints",
        ));
    }
    Ok(())
}

/// An error where the last joint moves nothing that a task gives: it turns the tool about the z axis that is to point.
fn refuse_idle(mechanism: &Mechanism, arm: &SixJointArm) -> Result<(), MechanismError> {
    let chain_joints = arm.joints_of_chain();
    let Some(last) = chain_joints
        .checked_sub(1)
        .filter(|_| arm.task == Task::Pointing)
    else {
        return Ok(());
    };
    let joint = &arm.arm.joints[last];
    if joint.is_angle && joint.a == 0.0 && joint.alpha == Angle::ZERO {
        return Err(mechanism.error(format!(
            "{name} turns the tool about its z axis, which pointing leaves free: hold it (--lock {name}=0)",
            name = joint.name
        )));
    }
    Ok(())
}

/// An open chain, forward.
struct Open {
    postures: Postures,
    inputs: Vec<String>,
    /// Number of the joint of each input.
    joints: Vec<usize>,
    /// Values of all joints, those of inputs being 0.
    locked: Vec<f64>,
    family: Family,
}

impl Open {
    fn new(
        mechanism: &Mechanism,
        chain: &Chain,
        question: &Question,
    ) -> Result<Self, MechanismError> {
        let lock = |name: &String| {
            let mut locks = question.locks.iter();
            locks.find(|(locked, _)| locked == name).map(|lock| lock.1)
        };
        let names: Vec<String> = chain.joints.iter().map(|j| j.name.clone()).collect();
        let free: Vec<String> = names
            .iter()
            .filter(|n| lock(n).is_none())
            .cloned()
            .collect();
        let inputs = question.inputs.as_ref().unwrap_or(&free).clone();
        if let Some(missing) = free.iter().find(|name| !inputs.contains(name)) {
            return Err(mechanism.error(format!(
                "all joints of an open chain are its inputs; {missing} is missing among them"
            )));
        }
        if let Some(held) = inputs.iter().find(|name| lock(name).is_some()) {
            return Err(mechanism.error(format!("{held} is locked and an input")));
        }
        let place = |input: &String| names.iter().position(|name| name == input);
        let joints = inputs.iter().filter_map(place).collect();
        let locked = names.iter().map(|name| lock(name).unwrap_or(0.0)).collect();
        let letters: Vec<&str> = chain
            .joints
            .iter()
            .map(|j| if j.is_angle { "R" } else { "P" })
            .collect();
        Ok(Self {
            postures: Postures::of(mechanism, chain.clone()),
            inputs,
            joints,
            locked,
            family: Family {
                name: letters.concat(),
                expected: Some(1),
                source: "rows multiplied out",
                representation: "none: closed form",
            },
        })
    }
}

impl Formulation for Open {
    fn family(&self) -> &Family {
        &self.family
    }
    fn inputs(&self) -> &[String] {
        &self.inputs
    }
    fn equations(&self) -> Option<&Equations> {
        None
    }
    fn parameters(&self, _: &Target) -> Result<Vec<Complex64>, String> {
        Ok(Vec::new())
    }
    fn generic(&self, _: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        None
    }
    fn lift(&self, _: Option<&Target>, _: &[Complex64], _: &[Complex64]) -> Lifted {
        Lifted::Degenerate("no equations")
    }
    fn direct(&self, target: &Target) -> Vec<Configuration> {
        let Target::Inputs(values) = target else {
            return Vec::new();
        };
        let mut reals = self.locked.clone();
        for (value, &joint) in values.iter().zip(&self.joints) {
            reals[joint] = *value;
        }
        let joints = self.postures.chain.joints.iter().zip(reals);
        let values = joints.map(|(joint, x)| JointValue::of_real(x, joint.is_angle));
        vec![self.postures.position(values.collect(), |_| 0.0)]
    }
}

/// Six free turns for a pose.
struct SixRevolute {
    postures: Postures,
    /// The arm, which is the same at all targets; of a loop, the rows.
    arm: SixJointArm,
    /// Joints that are held for all targets.
    locked: Vec<Option<f64>>,
    /// Joints that a target gives.
    driven: Vec<usize>,
    inputs: Vec<String>,
    equations: Equations,
    family: Family,
}

impl SixRevolute {
    /// The arm of six turns at a target, and the pose of its tool.
    fn arm_at(&self, target: &Target) -> Result<(Cow<'_, Chain>, Pose), String> {
        let pose = match target {
            Target::Pose(pose) => *pose,
            Target::Inputs(_) => Pose::IDENTITY,
        };
        if !self.arm.arm.closed {
            return Ok((Cow::Borrowed(&self.arm.arm), pose));
        }
        let held = self.held(Some(target));
        if held.iter().all(Option::is_none) {
            return Ok((Cow::Borrowed(&self.postures.chain), pose));
        }
        let arm = self.postures.chain.with_held(&held);
        Ok((Cow::Owned(arm.ok_or("its axes give no rows")?), pose))
    }

    /// Values of the joints that are held at a target.
    fn held(&self, target: Option<&Target>) -> Vec<Option<f64>> {
        let mut held = self.locked.clone();
        if let Some(Target::Inputs(values)) = target {
            for (i, value) in self.driven.iter().zip(values) {
                held[*i] = Some(*value);
            }
        }
        held
    }
}

impl Formulation for SixRevolute {
    fn family(&self) -> &Family {
        &self.family
    }

    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn equations(&self) -> Option<&Equations> {
        Some(&self.equations)
    }

    fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String> {
        let (arm, pose) = self.arm_at(target)?;
        // R1 A1 ... A5 R6 is the pose without base, first offset, last link and tool.
        let last = behind_last(&arm);
        let inner = before_first(&arm)
            .inverse()
            .then(&pose)
            .then(&last.inverse());
        let size = arm.size();
        let scaled = |x: Complex64| x / size;
        let mut values = arm_parameters(&arm, size);
        values.extend(stereographic(inner.column(2).map(|c| c.re)));
        values.extend(inner.position.map(scaled));
        Ok(values)
    }

    fn own_parameters(&self) -> usize {
        match self.arm.arm.closed {
            true => 0,
            false => PARAMETERS_OF_ARM,
        }
    }

    fn homogeneous_parameters(&self) -> Option<Vec<Vec<usize>>> {
        // The rows of a loop with driven joints are made for each target, and may leap.
        let direction = PARAMETERS_OF_ARM..PARAMETERS_OF_ARM + 3;
        (self.own_parameters() > 0).then(|| vec![direction.collect()])
    }

    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        if self.own_parameters() == 0 {
            return None;
        }
        let (arm, _) = self.arm_at(&Target::Pose(Pose::IDENTITY)).ok()?;
        let mut values = arm_parameters(&arm, arm.size());
        // A direction not far from real ones, and a point within reach.
        values.extend((0..3).map(|_| draw()));
        values.extend((0..3).map(|_| draw() * 0.4));
        Some(values)
    }

    fn known_member(&self) -> Option<KnownMember> {
        six_revolute::known_member()
    }

    fn lift(
        &self,
        target: Option<&Target>,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Lifted {
        let Some((turns, gap, growth)) = solved_turns(parameters, point) else {
            return Lifted::Moving("joint 3");
        };
        let Some(target) = target else {
            let member = Configuration::of_member(gap / growth);
            return Lifted::Position(Box::new(member));
        };
        self.in_the_file(target, turns, growth)
    }

    fn arm(&self) -> Option<&dyn ArmFormulation> {
        // A loop, and one with driven joints, is another arm at each target.
        (!self.arm.arm.closed).then_some(self)
    }
}

impl SixRevolute {
    /// The position by the file's joints, and how well its own product meets the target.
    fn in_the_file(&self, target: &Target, mut turns: Turns, growth: f64) -> Lifted {
        let Ok((arm, pose)) = self.arm_at(target) else {
            return Lifted::Degenerate("its axes give no rows");
        };
        let free = free_values(&arm, &pose, &mut turns);
        let held = self.held(Some(target));
        self.postures
            .lifted(&self.arm, &held, &free, (&pose, growth))
    }
}

/// Values of the six joints from the turns of the first five: the last value is the rest of the pose, by the x axis,
/// about which the last link turns.
fn free_values(arm: &Chain, pose: &Pose, turns: &mut Turns) -> Vec<JointValue> {
    let mut first = arm.base;
    for ((c, s), joint) in turns.iter().zip(&arm.joints).take(5) {
        first = joint.along_link(&first.turned(*c, *s));
    }
    let x_axis = first
        .inverse()
        .direction(pose.direction(arm.tool.rotation[0]));
    turns[5] = (x_axis[0], x_axis[1]);
    let joints = turns.iter().zip(&arm.joints);
    joints
        .map(|((c, s), joint)| {
            // q = turn - theta.
            let [ct, st] = joint.theta.direction;
            JointValue::Turn(c * ct + s * st, s * ct - c * st)
        })
        .collect()
}

impl ArmFormulation for SixRevolute {
    fn six_joint_arm(&self) -> &SixJointArm {
        &self.arm
    }

    fn posture(
        &self,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Option<(Pose, Vec<JointValue>)> {
        let arm = &self.arm.arm;
        let (mut turns, _, _) = solved_turns(parameters, point)?;
        // Equations know the axis of joint 6 only: this is one of the poses that have it.
        let [u, v, w] = [20, 21, 22].map(|i| parameters[i]);
        let size = arm.size();
        let position = [23, 24, 25].map(|i| parameters[i] * size);
        let inner = Pose::of_quaternion([w, -v, u, Complex64::default()], position)?;
        let pose = before_first(arm).then(&inner).then(&behind_last(arm));
        let values = free_values(arm, &pose, &mut turns);
        Some((pose, values))
    }

    fn point(&self, values: &[JointValue]) -> Option<Vec<Complex64>> {
        let mut point = vec![Complex64::default(); six_revolute::VARIABLES.len()];
        for (k, cosine, sine) in SOLVED {
            let (JointValue::Turn(c, s), joint) = (values.get(k)?, self.arm.arm.joints.get(k)?)
            else {
                return None;
            };
            // The turn is q + theta.
            let [ct, st] = joint.theta.direction;
            for (name, x) in [(cosine, c * ct - s * st), (sine, s * ct + c * st)] {
                let place = six_revolute::VARIABLES.iter().position(|v| *v == name)?;
                point[place] = x;
            }
        }
        Some(point)
    }

    fn position(&self, values: &[JointValue], pose: &Pose) -> Configuration {
        self.postures
            .of_arm(&self.arm, &self.locked, values, (pose, 1.0))
    }
}

/// The frame in which the equations begin: base and first offset.
fn before_first(arm: &Chain) -> Pose {
    arm.base.then(&Pose::shift(0.0, 0.0, arm.joints[0].d))
}

/// The tool in the frame in which the equations end: last link and tool.
fn behind_last(arm: &Chain) -> Pose {
    common_normal(&arm.joints[5]).then(&arm.tool)
}

/// The place of the first of the two joints that follow linearly.
const THIRD: usize = 2;
/// Joints whose cosines and sines the equations have.
const SOLVED: [(usize, &str, &str); 4] = [
    (0, "c1", "s1"),
    (1, "c2", "s2"),
    (3, "c4", "s4"),
    (4, "c5", "s5"),
];

/// Cosine and sine of six turns, of which the last is not known.
type Turns = [(Complex64, Complex64); 6];

/// The turns of a solution of the family's equations, their gap, and how large numbers grow along the chain; `None` where
/// joint 3 may turn freely.
fn solved_turns(parameters: &[Complex64], point: &[Complex64]) -> Option<(Turns, f64, f64)> {
    let at = |name: &str| {
        let place = six_revolute::VARIABLES.iter().position(|v| *v == name);
        place.map_or(Complex64::default(), |i| point[i])
    };
    let mut turns = Turns::default();
    for (k, cosine, sine) in SOLVED {
        turns[k] = (at(cosine), at(sine));
    }
    let member = Member::of(parameters);
    let first = member.along(0..2, &Pose::IDENTITY, &turns);
    turns[2] = member.third_turn(&first, &turns)?;
    let last = member.along(2..5, &first, &turns);
    let (gap, growth) = member.gap(&last, &turns);
    Some((turns, gap, growth))
}

/// Whether a solution of the family's equations is a position: the equations have mirrored solutions besides.
pub fn is_position(parameters: &[Complex64], point: &[Complex64]) -> bool {
    solved_turns(parameters, point).is_some_and(|(_, gap, growth)| gap / growth < CLOSES)
}

/// The common normal of a row: Tx(a) Rx(alpha).
fn common_normal(joint: &ChainJoint) -> Pose {
    let [c, s] = joint.alpha.direction.map(Complex64::from);
    Pose::shift(joint.a, 0.0, 0.0).then(&Pose::about_x(c, s))
}

/// Half-tangents of five twists as two numbers each, five lengths, five offsets.
const PARAMETERS_OF_ARM: usize = 20;

/// Parameters that belong to the arm, lengths in units of `size`.
fn arm_parameters(arm: &Chain, size: f64) -> Vec<Complex64> {
    let rows = &arm.joints[..5];
    let real = |x: f64| Complex64::new(x, 0.0);
    let mut values: Vec<Complex64> = rows.iter().map(|j| real(j.alpha.half[1])).collect();
    values.extend(rows.iter().map(|j| real(j.alpha.half[0])));
    values.extend(rows.iter().map(|j| real(j.a / size)));
    // Offsets along the axis after each link.
    values.extend(arm.joints[1..].iter().take(5).map(|j| real(j.d / size)));
    values
}

/// Three numbers (u, v, w), up to a factor, of a direction (2uw, 2vw, w^2-u^2-v^2)/(u^2+v^2+w^2).
fn stereographic([x, y, z]: [f64; 3]) -> [Complex64; 3] {
    let w = ((1.0 + z) / 2.0).max(0.0).sqrt();
    let across = (x * x + y * y).sqrt();
    let flat = ((1.0 - z) / 2.0).max(0.0).sqrt();
    let numbers = if across > 0.0 {
        [flat * x / across, flat * y / across, w]
    } else {
        [flat, 0.0, w]
    };
    numbers.map(Complex64::from)
}

/// A link of the family: A = Tx(a) Rx(alpha) Tz(d).
struct Link {
    length: Complex64,
    /// Cosine and sine of the twist.
    twist: (Complex64, Complex64),
    offset: Complex64,
}

impl Link {
    /// The frame at its end, from the one at its beginning.
    fn after(&self, frame: &Pose) -> Pose {
        let (c, s) = self.twist;
        let rotation = frame
            .rotation
            .map(|[x, y, z]| [x, y * c + z * s, z * c - y * s]);
        let shift = |i: usize| frame.rotation[i][0] * self.length + rotation[i][2] * self.offset;
        Pose {
            position: std::array::from_fn(|i| frame.position[i] + shift(i)),
            rotation,
        }
    }
}

/// A member of the family: R1 A1 R2 ... A5 R6.
struct Member {
    /// A_1 .. A_5.
    links: [Link; 5],
    /// Direction of axis 6 and a point of it.
    axis: (Vector3, Vector3),
}

impl Member {
    fn of(parameters: &[Complex64]) -> Self {
        let links = std::array::from_fn(|k| Link {
            length: parameters[10 + k],
            twist: turn_of(parameters[k], parameters[5 + k]),
            offset: parameters[15 + k],
        });
        let [u, v, w] = [20, 21, 22].map(|i| parameters[i]);
        let over = u * u + v * v + w * w;
        let direction = [
            u * w * 2.0 / over,
            v * w * 2.0 / over,
            (w * w - u * u - v * v) / over,
        ];
        Self {
            links,
            axis: (direction, [23, 24, 25].map(|i| parameters[i])),
        }
    }

    /// The frame after some joints and their links, from the one before them.
    fn along(&self, joints: Range<usize>, from: &Pose, turns: &Turns) -> Pose {
        joints.fold(*from, |frame, k| {
            self.links[k].after(&frame.turned(turns[k].0, turns[k].1))
        })
    }

    /// Joint 3 from the frame before it and the joints after it: it turns what the last joints make to what the first
    /// leave, in the plane across its axis; by least squares of direction and place. `None` where both are along the
    /// axis.
    fn third_turn(&self, first: &Pose, turns: &Turns) -> Option<(Complex64, Complex64)> {
        let back = first.inverse();
        let axis = (back.direction(self.axis.0), back.point(self.axis.1));
        let after_joint = self.links[2].after(&Pose::IDENTITY);
        let last = self.along(3..5, &after_joint, turns);
        turn_between((last.column(2), last.position), axis)
    }

    /// The gap of axis 6, which is that of the last frame, and of the circles; and how large numbers grow along the
    /// chain.
    fn gap(&self, last: &Pose, turns: &Turns) -> (f64, f64) {
        let (mut gap, mut growth) = (0.0f64, 1.0f64);
        for k in 0..3 {
            gap = gap.max(modulus(last.rotation[k][2] - self.axis.0[k]));
            gap = gap.max(modulus(last.position[k] - self.axis.1[k]));
        }
        for (c, s) in &turns[..5] {
            growth *= (modulus(*c) + modulus(*s)).max(1.0);
            gap = gap.max(modulus(c * c + s * s - 1.0) / (1.0 + c.norm_sqr() + s.norm_sqr()));
        }
        (gap, growth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Body, ReadOptions, read};

    /// Inputs in any order, and joints that are locked: the frames are those of the rows.
    #[test]
    fn an_open_chain_forward_takes_all_joints_that_are_free() {
        let table = b"theta,d,a,alpha\n0,0.4,0.1,90\n0,0,0.5,-90\n30,0.2,0,0\n";
        let arm = read("arm.csv", table, &ReadOptions::default()).expect("a table of this test");
        let Body::Chain(chain) = &arm.body else {
            panic!("a table is a chain");
        };
        let question = |inputs: &[&str], locks: &[(&str, f64)]| Question {
            inputs: (!inputs.is_empty()).then(|| inputs.iter().map(|n| n.to_string()).collect()),
            locks: locks.iter().map(|(n, x)| (n.to_string(), *x)).collect(),
            ..Question::of(Problem::Forward)
        };
        let pose = |question: &Question, values: &[f64]| {
            let formulation = super::super::compile(&arm, question)?;
            let target = Target::Inputs(values.to_vec());
            Ok::<_, MechanismError>(formulation.direct(&target)[0].output)
        };
        let turns = [0.3, -0.7, 1.1].map(|x| JointValue::of_real(x, true));
        let expected = Some(chain.tool_pose(&turns));
        for (question, values) in [
            (question(&[], &[]), vec![0.3, -0.7, 1.1]),
            (question(&["q3", "q1", "q2"], &[]), vec![1.1, 0.3, -0.7]),
            (question(&[], &[("q2", -0.7)]), vec![0.3, 1.1]),
            (question(&["q3", "q1"], &[("q2", -0.7)]), vec![1.1, 0.3]),
        ] {
            assert_eq!(pose(&question, &values), Ok(expected), "{question:?}");
        }
        let missing = pose(&question(&["q3", "q1"], &[]), &[0.0, 0.0]).unwrap_err();
        assert!(missing.to_string().contains("q2 is missing"), "{missing}");
        let both = pose(&question(&["q1", "q2", "q3"], &[("q2", 0.0)]), &[0.0; 3]).unwrap_err();
        assert!(
            both.to_string().contains("q2 is locked and an input"),
            "{both}"
        );
    }
}
