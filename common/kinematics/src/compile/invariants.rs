//! Chains of six joints with shifts among them, or with axes 3 and 6 in one plane: what a turn about one axis leaves unchanged.
//!
//! Of a loop J1 C1 ... J6 C6 = 1 in which joints 3 and 6 turn, axis 6 is a line that both ways lead to; the turn of joint 3
//! leaves four numbers of it: the heights of its direction and point, the point's square and their product. With the
//! circles that is as many equations as joints 1, 2, 4, 5 have unknowns. For six turns these are the eight quadrics of
//! `six_revolute`.

use super::formulation::{ArmFormulation, Configuration, Family, Formulation, Lifted, Target};
use super::left_out;
use super::pose_parameters;
use super::postures::{Postures, turn_between};
use super::six_joint_arm::SixJointArm;
use super::text::{self, Equations, TextPose, dot, sum, times};
use super::three_turns;
use crate::mechanism::chain::{Chain, ChainJoint, JointValue};
use crate::mechanism::exact::Angle;
use crate::mechanism::pose::{Pose, Vector3};
use crate::mechanism::{Mechanism, MechanismError};
use crate::plane::modulus;
use num_complex::Complex64;

/// Places in the loop of the joints that stay in the equations.
const SOLVED: [usize; 4] = [0, 1, 3, 4];

/// The formulation of the inverse question of an open chain of six joints, with `arm` what `chain` is when the joints in
/// `held` are parts of their links.
pub fn compile(
    mechanism: &Mechanism,
    chain: &Chain,
    held: Vec<Option<f64>>,
    arm: SixJointArm,
) -> Result<Box<dyn Formulation>, MechanismError> {
    let Some(third) = left_out::first_left_out(&arm.arm) else {
        return three_turns::compile(mechanism, chain, held, arm);
    };
    let has_turns_only = arm.arm.joints.iter().all(|joint| joint.is_angle);
    let (expected, source) = match has_turns_only {
        true => (Some(16), "Raghavan and Roth 1993"),
        false => (None, "not known"),
    };
    // The loop begins two joints before the one that is the third.
    let order: [usize; 6] = std::array::from_fn(|k| (third + 4 + k) % 6);
    let mut shifted = Shifted {
        postures: Postures::of(mechanism, chain.clone()),
        held,
        order,
        family: Family {
            name: match has_turns_only && arm.is_chain() {
                true => "6R".into(),
                false => arm.family_name(),
            },
            expected,
            source,
            representation: "what a turn leaves of a line: four joints, the other two follow linearly",
        },
        arm,
        equations: Equations::default(),
    };
    shifted.write();
    Ok(Box::new(shifted))
}

/// Pose from a joint to the end of its row in the equations. The theta of a turn is a part of its unknowns, so that
/// links with right angles have short numbers.
fn behind(joint: &ChainJoint) -> Pose {
    match joint.is_angle {
        true => joint.link(),
        false => joint.after(),
    }
}

/// A turn with an angle added, or taken away where the sign is -1; a shift as it is.
fn turned(value: &JointValue, angle: &Angle, sign: f64) -> JointValue {
    let [c, s] = angle.direction;
    match *value {
        JointValue::Turn(x, y) => JointValue::Turn(x * c - y * s * sign, y * c + x * s * sign),
        shift => shift,
    }
}

struct Shifted {
    postures: Postures,
    held: Vec<Option<f64>>,
    /// The arm of six joints that are free.
    arm: SixJointArm,
    /// The arm's joints in the order of the loop.
    order: [usize; 6],
    family: Family,
    equations: Equations,
}

/// A line's direction and point, the point's square, and the product of both, as expressions.
struct Line {
    direction: [String; 3],
    point: [String; 3],
    square: String,
    product: String,
}

impl Line {
    /// Through a joint: forward by its value, or back.
    fn through_joint(
        &mut self,
        name: &str,
        turns: bool,
        back: bool,
        stage: &str,
        equations: &mut Equations,
    ) {
        if turns {
            let (c, s) = (format!("c{name}"), format!("s{name}"));
            let (ahead, aside) = if back { ("(-1)", "1") } else { ("1", "(-1)") };
            for (vector, letter) in [(&mut self.direction, "z"), (&mut self.point, "p")] {
                let [x, y, z] = vector.clone();
                let first = sum(&[times(&c, &x), times(aside, &times(&s, &y))]);
                let second = sum(&[times(&c, &y), times(ahead, &times(&s, &x))]);
                *vector = [
                    equations.define(format!("{letter}{stage}x"), first),
                    equations.define(format!("{letter}{stage}y"), second),
                    z,
                ];
            }
            return;
        }
        let d = format!("d{name}");
        let sign = if back { "(-2)" } else { "2" };
        let height = self.point[2].clone();
        self.square = sum(&[
            self.square.clone(),
            times(sign, &times(&d, &height)),
            format!("{d}^2"),
        ]);
        let along = times(&d, &self.direction[2]);
        self.product = if back {
            text::minus(&self.product, &along)
        } else {
            sum(&[self.product.clone(), along])
        };
        self.point[2] = if back {
            text::minus(&height, &d)
        } else {
            sum(&[height, d])
        };
    }

    /// Through a constant pose: forward.
    fn forward(&mut self, pose: &TextPose, stage: &str, equations: &mut Equations) {
        let name = |vector: [String; 3], letter: &str, equations: &mut Equations| {
            let mut k = 0;
            vector.map(|e| {
                k += 1;
                equations.define(format!("{letter}{stage}_{k}"), e)
            })
        };
        let turned = name(pose.direction(&self.point), "r", equations);
        let shift = dot(&pose.position, &turned);
        self.square = sum(&[
            self.square.clone(),
            times("2", &shift),
            dot(&pose.position, &pose.position),
        ]);
        self.direction = name(pose.direction(&self.direction), "z", equations);
        self.product = sum(&[self.product.clone(), dot(&pose.position, &self.direction)]);
        let point = std::array::from_fn(|i| sum(&[turned[i].clone(), pose.position[i].clone()]));
        self.point = name(point, "p", equations);
    }

    /// Through a constant pose: back.
    fn back(&mut self, pose: &TextPose, stage: &str, equations: &mut Equations) {
        let transposed =
            |v: &[String; 3]| -> [String; 3] { std::array::from_fn(|i| dot(&pose.column(i), v)) };
        let shift = dot(&pose.position, &self.point);
        self.square = sum(&[
            self.square.clone(),
            times("(-2)", &shift),
            dot(&pose.position, &pose.position),
        ]);
        let along = dot(&pose.position, &self.direction);
        self.product = text::minus(&self.product, &along);
        let away = std::array::from_fn(|i| text::minus(&self.point[i], &pose.position[i]));
        let (point, direction) = (transposed(&away), transposed(&self.direction));
        let mut named = |vector: [String; 3], letter: &str| {
            let mut k = 0;
            vector.map(|e| {
                k += 1;
                equations.define(format!("{letter}{stage}_{k}"), e)
            })
        };
        self.point = named(point, "p");
        self.direction = named(direction, "z");
    }
}

impl Shifted {
    fn write(&mut self) {
        let mut equations = Equations {
            parameters: text::pose_parameters(),
            ..Equations::default()
        };
        let constants: Vec<TextPose> = (0..6)
            .map(|k| self.constant_text(k, &mut equations))
            .collect();
        let name = |k: usize| format!("{}", self.order[k] + 1);
        let turns = |k: usize| self.arm.arm.joints[self.order[k]].is_angle;
        // Axis 6 seen from the beginning: the last constant pose taken back from the z-axis.
        let mut left = Line {
            direction: ["0", "0", "1"].map(String::from),
            point: ["0", "0", "0"].map(String::from),
            square: "0".into(),
            product: "0".into(),
        };
        left.back(&constants[5], "a", &mut equations);
        for (k, stage) in [(0, "b"), (1, "c")] {
            left.through_joint(&name(k), turns(k), true, stage, &mut equations);
            left.back(&constants[k], &format!("{stage}{stage}"), &mut equations);
        }
        let mut right = Line {
            direction: ["0", "0", "1"].map(String::from),
            point: ["0", "0", "0"].map(String::from),
            square: "0".into(),
            product: "0".into(),
        };
        for (k, stage) in [(4, "e"), (3, "f")] {
            right.forward(&constants[k], &format!("{stage}{stage}"), &mut equations);
            right.through_joint(&name(k), turns(k), false, stage, &mut equations);
        }
        right.forward(&constants[2], "g", &mut equations);
        equations.equations = vec![
            text::minus(&left.direction[2], &right.direction[2]),
            text::minus(&left.point[2], &right.point[2]),
            text::minus(&left.square, &right.square),
            text::minus(&left.product, &right.product),
        ];
        let mut groups = [Vec::new(), Vec::new()];
        for (place, k) in SOLVED.into_iter().enumerate() {
            let group = &mut groups[[0, 1, 0, 1][place]];
            if turns(k) {
                let (c, s) = (format!("c{}", name(k)), format!("s{}", name(k)));
                equations.equations.push(format!("{c}^2+{s}^2-1"));
                group.extend([c, s]);
            } else {
                group.push(format!("d{}", name(k)));
            }
        }
        equations.groups = groups.to_vec();
        self.equations = equations;
    }

    /// The constant pose after a joint of the loop, as text; after the arm's last joint the target comes back.
    fn constant_text(&self, k: usize, equations: &mut Equations) -> TextPose {
        let joint = self.order[k];
        let after = TextPose::constant(&behind(&self.arm.arm.joints[joint]));
        if joint != 5 {
            return after;
        }
        let target = TextPose::of_parameters(&format!("({})", text::QUATERNION_SQUARE));
        after.then(&target, "x", equations)
    }

    /// The pose that comes back: base, target and tool of the arm, inverted.
    fn coming_back(&self, pose: &Pose) -> Pose {
        let arm = &self.arm.arm;
        let inner = arm.base.inverse().then(pose);
        inner.then(&arm.tool.inverse()).inverse()
    }

    /// Values of the arm's six joints at a solution, and by how much joint 6 is no turn.
    fn values(&self, back: &Pose, point: &[Complex64]) -> Option<(Vec<JointValue>, f64)> {
        let names = self.equations.variables();
        let get = |name: String| {
            names
                .iter()
                .position(|n| *n == name)
                .map_or(Complex64::default(), |i| point[i])
        };
        let value = |k: usize| {
            let joint = self.order[k];
            if self.arm.arm.joints[joint].is_angle {
                JointValue::Turn(
                    get(format!("c{}", joint + 1)),
                    get(format!("s{}", joint + 1)),
                )
            } else {
                JointValue::Shift(get(format!("d{}", joint + 1)))
            }
        };
        let constant = |k: usize| {
            let joint = self.order[k];
            let after = behind(&self.arm.arm.joints[joint]);
            if joint == 5 { after.then(back) } else { after }
        };
        let left = value(0)
            .pose()
            .then(&constant(0))
            .then(&value(1).pose())
            .then(&constant(1));
        let right = constant(2)
            .then(&value(3).pose())
            .then(&constant(3))
            .then(&value(4).pose())
            .then(&constant(4));
        let last = constant(5).inverse();
        let seen = left.inverse();
        let (y, w): (Vector3, Vector3) =
            (seen.direction(last.column(2)), seen.point(last.position));
        let (c, s) = turn_between((right.column(2), right.position), (y, w))?;
        let third = JointValue::Turn(c, s);
        let sixth = left.then(&third.pose()).then(&right).inverse().then(&last);
        let turn = JointValue::Turn(sixth.rotation[0][0], sixth.rotation[1][0]);
        let size = self.arm.arm.size();
        let entries = last.rotation.iter().flatten().chain(point.iter());
        let growth = entries.map(|z| modulus(*z)).fold(1.0, f64::max);
        let mut gap = sixth.distance(&turn.pose(), size) / growth;
        for k in SOLVED {
            if let JointValue::Turn(c, s) = value(k) {
                gap = gap.max(modulus(c * c + s * s - 1.0) / (1.0 + c.norm_sqr() + s.norm_sqr()));
            }
        }
        let mut values = vec![third; 6];
        for k in 0..6 {
            values[self.order[k]] = match k {
                2 => third,
                5 => turn,
                k => value(k),
            };
        }
        // Turns in the equations begin where theta is 0.
        for (value, joint) in values.iter_mut().zip(&self.arm.arm.joints) {
            *value = turned(value, &joint.theta, -1.0);
        }
        Some((values, gap))
    }
}

impl Formulation for Shifted {
    fn family(&self) -> &Family {
        &self.family
    }

    fn inputs(&self) -> &[String] {
        &[]
    }

    fn equations(&self) -> Option<&Equations> {
        Some(&self.equations)
    }

    fn parameters(&self, target: &Target) -> Result<Vec<Complex64>, String> {
        let back = self.coming_back(target.pose()?);
        Ok(pose_parameters::of_pose(&back))
    }

    fn homogeneous_parameters(&self) -> Option<Vec<Vec<usize>>> {
        Some(pose_parameters::homogeneous())
    }

    fn generic(&self, draw: &mut dyn FnMut() -> Complex64) -> Option<Vec<Complex64>> {
        Some(pose_parameters::general(self.arm.arm.size(), draw))
    }

    fn lift(
        &self,
        target: Option<&Target>,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Lifted {
        let Some(back) = pose_parameters::pose(parameters) else {
            return Lifted::Degenerate("no pose");
        };
        let Some((free, gap)) = self.values(&back, point) else {
            return Lifted::Moving("a joint");
        };
        let Some(Target::Pose(pose)) = target else {
            return Lifted::Position(Box::new(Configuration::of_member(gap)));
        };
        if let Some(reason) = self.arm.refused(&free) {
            return Lifted::Degenerate(reason);
        }
        // Rows keep theta and d, so that values of the arm are those of the file.
        let growth = point.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
        let posture = self
            .postures
            .of_arm(&self.arm, &self.held, &free, (pose, growth));
        Lifted::Position(Box::new(Configuration {
            residual: posture.residual.max(gap),
            ..posture
        }))
    }

    fn arm(&self) -> Option<&dyn ArmFormulation> {
        Some(self)
    }
}

impl ArmFormulation for Shifted {
    fn six_joint_arm(&self) -> &SixJointArm {
        &self.arm
    }

    fn posture(
        &self,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Option<(Pose, Vec<JointValue>)> {
        let back = pose_parameters::pose(parameters)?;
        let (values, _) = self.values(&back, point)?;
        let behind_base = back.inverse().then(&self.arm.arm.tool);
        Some((self.arm.arm.base.then(&behind_base), values))
    }

    fn point(&self, values: &[JointValue]) -> Option<Vec<Complex64>> {
        let unknown = |name: String| {
            let joint = name.get(1..)?.parse::<usize>().ok()?.checked_sub(1)?;
            let theta = &self.arm.arm.joints.get(joint)?.theta;
            match (turned(values.get(joint)?, theta, 1.0), name.get(..1)?) {
                (JointValue::Turn(c, _), "c") => Some(c),
                (JointValue::Turn(_, s), "s") => Some(s),
                (JointValue::Shift(d), "d") => Some(d),
                _ => None,
            }
        };
        self.equations
            .variables()
            .into_iter()
            .map(unknown)
            .collect()
    }

    fn position(&self, values: &[JointValue], pose: &Pose) -> Configuration {
        self.postures
            .of_arm(&self.arm, &self.held, values, (pose, 1.0))
    }
}
