//! The loop that an arm of six free joints makes with a pose, by the cosine and sine of every joint.
//!
//! Formulations in fewer unknowns have poses at which they are singular and the arm is not: where two axes are parallel,
//! solutions that are no postures meet those that are. These equations are singular only where the arm itself is: their
//! solutions are the postures, and the rank of their derivatives is that of the joints' screws.

use super::text::{self, Equations, TextPose, dot};
use crate::mechanism::chain::{Chain, ChainJoint, JointValue};
use crate::mechanism::pose::Pose;
use num_complex::Complex64;

/// Joints before the place where the loop is cut: as many as behind it, so that equations have the least degree.
const BEFORE: usize = 3;

/// An arm of six free joints and the equations of its loop.
#[derive(Clone, Debug)]
pub struct Closure {
    arm: Chain,
    /// Lengths in the equations are parts of this.
    size: f64,
    equations: Equations,
}

impl Closure {
    /// The loop of an arm; `None` for one that has not six joints.
    pub fn of(arm: &Chain) -> Option<Self> {
        if arm.joints.len() != 6 || arm.closed {
            return None;
        }
        let size = arm.size();
        Some(Self {
            arm: arm.clone(),
            size,
            equations: equations(arm, size),
        })
    }

    /// The arm.
    pub fn arm(&self) -> &Chain {
        &self.arm
    }

    /// The equations; their parameters are a pose.
    pub fn equations(&self) -> &Equations {
        &self.equations
    }

    /// The parameters at a pose of the tool, which may be complex: a quaternion of the frame behind the last joint, and
    /// its position in parts of the arm's size.
    pub fn parameters(&self, pose: &Pose) -> Vec<Complex64> {
        let inner = self.arm.base.inverse().then(pose);
        let inner = inner.then(&self.arm.tool.inverse());
        let mut values = inner.any_quaternion().to_vec();
        values.extend(inner.position.map(|x| x / self.size));
        values
    }

    /// The unknowns at these values of the joints.
    pub fn point(&self, values: &[JointValue]) -> Vec<Complex64> {
        let mut point = Vec::new();
        for value in values {
            match *value {
                JointValue::Turn(c, s) => point.extend([c, s]),
                JointValue::Shift(d) => point.push(d / self.size),
            }
        }
        point
    }

    /// The values of the joints at a point of the equations.
    pub fn values(&self, point: &[Complex64]) -> Vec<JointValue> {
        let mut numbers = point.iter().copied();
        let mut next = || numbers.next().unwrap_or_default();
        let joints = self.arm.joints.iter();
        joints
            .map(|joint| match joint.is_angle {
                true => JointValue::Turn(next(), next()),
                false => JointValue::Shift(next() * self.size),
            })
            .collect()
    }
}

/// M_1 M_2 M_3 = G (M_4 M_5 M_6)^-1, with G the pose behind the last joint and M_k joint k with its link: the positions are
/// equal, and L R' is symmetric for the rotations L and R. Where L = R and L moves by a rotation vector w, its antisymmetric
/// part is w: as many equations as a rotation has freedoms, and regular for every pair of equal rotations. L R' is symmetric
/// for half turns, too; but a path of postures leads to a posture.
fn equations(arm: &Chain, size: f64) -> Equations {
    let mut equations = Equations {
        parameters: text::pose_parameters(),
        ..Equations::default()
    };
    let mut circles = Vec::new();
    let mut unknowns = Vec::new();
    let moved: Vec<TextPose> = arm
        .joints
        .iter()
        .enumerate()
        .map(|(k, joint)| {
            let number = k + 1;
            if !joint.is_angle {
                unknowns.push(format!("d{number}"));
                return TextPose::shift(["0".into(), "0".into(), format!("d{number}")]);
            }
            let (c, s) = (format!("c{number}"), format!("s{number}"));
            circles.push(format!("{c}^2+{s}^2-1"));
            let turn = TextPose::about_z(&c, &s);
            unknowns.extend([c, s]);
            turn
        })
        .collect();
    let after = |joint: &ChainJoint| in_parts(&joint.after(), size);
    let mut first = TextPose::constant(&Pose::IDENTITY);
    for k in 0..BEFORE {
        let joint = TextPose::constant(&after(&arm.joints[k]));
        let turned = first.then(&moved[k], &format!("m{}", k + 1), &mut equations);
        first = turned.then(&joint, &format!("l{}", k + 1), &mut equations);
    }
    let square = equations.define("square".into(), text::QUATERNION_SQUARE.into());
    let mut last = TextPose::of_parameters(&square);
    for k in (BEFORE..arm.joints.len()).rev() {
        let back = TextPose::constant(&after(&arm.joints[k]).inverse());
        let before = last.then(&back, &format!("k{}", k + 1), &mut equations);
        last = before.then(&inverse(&moved[k]), &format!("n{}", k + 1), &mut equations);
    }
    for i in 0..3 {
        let shifted = text::minus(&first.position[i], &last.position[i]);
        equations.equations.push(shifted);
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let product = |a: usize, b: usize| dot(&first.rotation[a], &last.rotation[b]);
        let turned = text::minus(&product(j, k), &product(k, j));
        equations.equations.push(turned);
    }
    equations.equations.extend(circles);
    equations.groups = vec![unknowns];
    equations
}

/// A pose with its position in parts of a length.
fn in_parts(pose: &Pose, size: f64) -> Pose {
    Pose {
        position: pose.position.map(|x| x / size),
        ..*pose
    }
}

/// The inverse of a turn about z, or of a shift along z.
fn inverse(moved: &TextPose) -> TextPose {
    let rotation = std::array::from_fn(|i| moved.column(i));
    let position = moved.position.clone().map(|x| text::minus("0", &x));
    TextPose { rotation, position }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::exact::Angle;
    use cognate_numeric::rational::ComplexRational;
    use cognate_systems::expression::exact;

    fn arm() -> Chain {
        let joint = |k: usize, is_angle| ChainJoint {
            name: format!("q{k}"),
            is_angle,
            a: 0.3 - 0.1 * k as f64,
            alpha: Angle::of_degrees(40.0 * k as f64 - 90.0),
            d: 0.2 * k as f64,
            theta: Angle::of_degrees(25.0),
        };
        Chain {
            joints: (0..6).map(|k| joint(k, k != 2)).collect(),
            base: Pose::shift(0.1, 0.2, 0.3),
            tool: Pose::of_roll_pitch_yaw([0.1, 0.2, 0.3].map(Angle::of_radians)),
            closed: false,
            first_normal: None,
        }
    }

    /// The loop of every posture closes, and joint values come back.
    #[test]
    fn the_loop_of_a_posture_closes() {
        let arm = arm();
        let closure = Closure::of(&arm).expect("six joints");
        let system = closure.equations().system("arm").expect("a system");
        assert_eq!((system.variables.len(), system.equation_count()), (11, 11));
        let rational = |z: &Complex64| ComplexRational::from_doubles(*z).expect("a number");
        for k in 0..5 {
            let joints = arm.joints.iter().enumerate();
            let values: Vec<JointValue> = joints
                .map(|(i, joint)| {
                    JointValue::of_real(0.7 * k as f64 - 0.4 * i as f64, joint.is_angle)
                })
                .collect();
            let point = closure.point(&values);
            for (value, back) in values.iter().zip(closure.values(&point)) {
                assert!((value.real() - back.real()).abs() < 1e-15);
            }
            let parameters = closure.parameters(&arm.tool_pose(&values));
            let numbers = |list: &[Complex64]| list.iter().map(rational).collect::<Vec<_>>();
            let residuals = exact::values(
                &system.expressions,
                &system.equations,
                &numbers(&point),
                &numbers(&parameters),
            );
            for residual in residuals {
                let residual = residual.expect("a rational number").re.to_f64();
                assert!(residual.abs() < 1e-14, "{k}: {residual}");
            }
        }
    }
}
