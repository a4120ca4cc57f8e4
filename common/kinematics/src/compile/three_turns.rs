//! Arms of three turns and three shifts, such as gantries with a wrist: the turns alone make the rotation, by an equation for the
//! second of them (B. Paden 1985, his second and third subproblems); the other two and the shifts follow linearly.

use super::formulation::{ArmFormulation, Configuration, Family, Formulation, Lifted, Target};
use super::pose_parameters;
use super::postures::{Postures, turn_between};
use super::six_joint_arm::SixJointArm;
use super::text::{self, Equations, TextPose};
use crate::mechanism::chain::{Chain, JointValue};
use crate::mechanism::exact::double_expression;
use crate::mechanism::pose::{Pose, Vector3};
use crate::mechanism::{Mechanism, MechanismError};
use crate::plane::modulus;
use num_complex::Complex64;

/// How many joints turn, and how many shift.
const THREE: usize = 3;

/// The formulation of the inverse question of an arm of three turns and three shifts, with `chain` the file's.
pub fn compile(
    mechanism: &Mechanism,
    chain: &Chain,
    held: Vec<Option<f64>>,
    arm: SixJointArm,
) -> Result<Box<dyn Formulation>, MechanismError> {
    let joints = arm.arm.joints.iter();
    let turns: Vec<usize> = joints
        .enumerate()
        .filter(|(_, joint)| joint.is_angle)
        .map(|(k, _)| k)
        .collect();
    let Ok(turns) = <[usize; THREE]>::try_from(turns) else {
        return Err(mechanism.error(
            "it has fewer than three turns: not every rotation of the tool is reached; ask for less with --task",
        ));
    };
    let mut formulation = ThreeTurns {
        postures: Postures::of(mechanism, chain.clone()),
        held,
        family: Family {
            name: arm.family_name(),
            expected: Some(2),
            source: "Paden 1985",
            representation: "cosine and sine of the second turn; the other joints follow linearly",
        },
        constants: Vec::new(),
        turns,
        arm,
        equations: Equations::default(),
    };
    formulation.constants = formulation.constant_rotations();
    formulation.equations = formulation.written();
    Ok(Box::new(formulation))
}

struct ThreeTurns {
    postures: Postures,
    held: Vec<Option<f64>>,
    arm: SixJointArm,
    /// Places of the joints that turn.
    turns: [usize; THREE],
    /// Rotations before the first turn, between the turns, and behind the last.
    constants: Vec<Pose>,
    family: Family,
    equations: Equations,
}

impl ThreeTurns {
    /// The rotation of the tool is C0 Rz(q1) C1 Rz(q2) C2 Rz(q3) C3.
    fn constant_rotations(&self) -> Vec<Pose> {
        let only_rotation = |pose: Pose| Pose {
            position: Vector3::default(),
            ..pose
        };
        let mut constants = Vec::new();
        let mut frame = only_rotation(self.arm.arm.base);
        for (k, joint) in self.arm.arm.joints.iter().enumerate() {
            if self.turns.contains(&k) {
                constants.push(frame);
                frame = Pose::IDENTITY;
            }
            frame = only_rotation(joint.along_row(&frame));
        }
        constants.push(only_rotation(frame.then(&self.arm.arm.tool)));
        constants
    }

    /// The entry of the third row and column of Rz(q1) C1 Rz(q2) C2 Rz(q3), which q2 alone makes, as factors of its cosine, of its
    /// sine, and of 1.
    fn factors(&self) -> [f64; 3] {
        let [x, y, z] = self.constants[1].rotation[2].map(|c| c.re);
        let [u, v, w] = self.constants[2].column(2).map(|c| c.re);
        [x * u + y * v, y * u - x * v, z * w]
    }

    fn written(&self) -> Equations {
        let [cosine, sine, constant] = self.factors().map(double_expression);
        let target = TextPose::of_parameters(&format!("({})", text::QUATERNION_SQUARE));
        let entry = &target.rotation[2][2];
        Equations {
            groups: vec![vec!["c2".into(), "s2".into()]],
            parameters: text::pose_parameters(),
            equations: vec![
                format!("({cosine})*c2+({sine})*s2+({constant})-{entry}"),
                "c2^2+s2^2-1".into(),
            ],
            ..Equations::default()
        }
    }

    /// C0' R C3', the rotation that the three turns and the links between them make, with the tool's position.
    fn between(&self, pose: &Pose) -> Pose {
        let turned = self.constants[0].inverse().then(pose);
        Pose {
            position: pose.position,
            ..turned.then(&self.constants[3].inverse())
        }
    }

    /// The pose that [`Self::between`] comes from.
    fn around(&self, between: &Pose) -> Pose {
        let turned = self.constants[0].then(between);
        Pose {
            position: between.position,
            ..turned.then(&self.constants[3])
        }
    }

    /// Values of the arm's joints at a solution for these parameters, and the pose that they are for; `None` where a turn or a shift
    /// is open.
    fn values(
        &self,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Option<(Vec<JointValue>, Pose)> {
        let rotation = pose_parameters::pose(parameters)?;
        let second = JointValue::Turn(*point.first()?, *point.get(1)?);
        let middle = self.constants[1]
            .then(&second.pose())
            .then(&self.constants[2]);
        // Rz(q1) turns the middle's z to that of the rotation; Rz(q3) is what is left, seen from the other side.
        let zero = Vector3::default();
        let (c, s) = turn_between((middle.column(2), zero), (rotation.column(2), zero))?;
        let row = |pose: &Pose| pose.rotation[2];
        let (x, y) = turn_between((row(&middle), zero), (row(&rotation), zero))?;
        let turns = [JointValue::Turn(c, s), second, JointValue::Turn(x, -y)];
        let pose = self.around(&rotation);
        let mut turns = turns.into_iter();
        let shift = JointValue::Shift(Complex64::default());
        let joints = self.arm.arm.joints.iter();
        let mut values: Vec<JointValue> = joints
            .map(|joint| match joint.is_angle {
                true => turns.next().unwrap_or(shift),
                false => shift,
            })
            .collect();
        let shifts = self.shifts(&values, &pose)?;
        let places = (0..values.len()).filter(|k| !self.turns.contains(k));
        let places: Vec<usize> = places.collect();
        for (place, shift) in places.into_iter().zip(shifts) {
            values[place] = JointValue::Shift(shift);
        }
        Some((values, pose))
    }

    /// Distance of the tool from a pose, in units of the arm's size.
    fn gap(&self, values: &[JointValue], pose: &Pose) -> f64 {
        let arm = &self.arm.arm;
        arm.tool_pose(values).distance(pose, arm.size())
    }

    /// The shifts that bring the tool to a position, where the turns have these values and the shifts are 0; by Cramer's rule.
    fn shifts(&self, values: &[JointValue], pose: &Pose) -> Option<Vector3> {
        let mut frame = self.arm.arm.base;
        let mut columns = Vec::new();
        for (joint, value) in self.arm.arm.joints.iter().zip(values) {
            if !joint.is_angle {
                columns.push(frame.column(2));
            }
            frame = joint.along_row(&value.moved(&frame));
        }
        let tool = frame.then(&self.arm.arm.tool);
        let columns = <[Vector3; THREE]>::try_from(columns).ok()?;
        let missing: Vector3 = std::array::from_fn(|i| pose.position[i] - tool.position[i]);
        let volume = determinant(&columns);
        if modulus(volume) <= f64::EPSILON {
            return None;
        }
        Some(std::array::from_fn(|k| {
            let mut replaced = columns;
            replaced[k] = missing;
            determinant(&replaced) / volume
        }))
    }
}

fn determinant([a, b, c]: &[Vector3; THREE]) -> Complex64 {
    let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
    a[0] * minor(1, 2) - a[1] * minor(0, 2) + a[2] * minor(0, 1)
}

impl Formulation for ThreeTurns {
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
        Ok(pose_parameters::of_pose(&self.between(target.pose()?)))
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
        let Some((values, pose)) = self.values(parameters, point) else {
            return Lifted::Moving("a joint");
        };
        let growth = point.iter().map(|z| z.norm_sqr()).fold(1.0, f64::max);
        let Some(Target::Pose(asked)) = target else {
            return Lifted::Position(Box::new(Configuration::of_member(
                self.gap(&values, &pose) / growth,
            )));
        };
        self.postures
            .lifted(&self.arm, &self.held, &values, (asked, growth))
    }

    fn arm(&self) -> Option<&dyn ArmFormulation> {
        Some(self)
    }
}

impl ArmFormulation for ThreeTurns {
    fn six_joint_arm(&self) -> &SixJointArm {
        &self.arm
    }

    fn posture(
        &self,
        parameters: &[Complex64],
        point: &[Complex64],
    ) -> Option<(Pose, Vec<JointValue>)> {
        let (values, pose) = self.values(parameters, point)?;
        Some((pose, values))
    }

    fn position(&self, values: &[JointValue], pose: &Pose) -> Configuration {
        self.postures
            .of_arm(&self.arm, &self.held, values, (pose, 1.0))
    }
}
