//! RealArm: a chain at real values of its joints. How its tool moves with them, where it is singular, and the nearest
//! values at which the tool has a pose.
//!
//! Lengths are parts of the chain's size, angles radians: a tool's velocity is a vector of six such numbers, and a column of
//! the derivative is the screw of a joint.

use crate::mechanism::chain::{Chain, JointValue};
use crate::mechanism::exact::radians;
use crate::mechanism::pose::{Pose, cross};
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use num_complex::Complex64;

/// Steps of Levenberg's and Marquardt's method at most: at a fold each halves the distance.
const MOST_STEPS: usize = 80;
/// Steps one after another that bring nothing nearer, after which it ends.
const MOST_REFUSALS: usize = 8;
/// First damping, in parts of the gap.
const FIRST_DAMPING: f64 = 0.1;
/// Least damping, the square of a singular value: along screws that depend by more than rounding nothing is moved.
const LEAST_DAMPING: f64 = 1e-20;
/// Damping from which it grows after a refusal at least, in parts of the gap.
const REFUSED_DAMPING: f64 = 1e-9;
/// Factor by which damping grows after a step that was refused, and shrinks after one that was not.
const DAMPING_FACTOR: f64 = 10.0;
/// Longest step of a joint, in radians or parts of the size.
const LONGEST_STEP: f64 = 0.5;
/// Values from which the nearest to a pose is looked for.
const SEARCHES: usize = 32;
/// Number of their random stream.
const NEAREST: u64 = 0x6e65_6172;
/// Least singular value, in parts of the largest, from which on the sign of a determinant is not that of rounding.
const SIGN_IS_ROUNDING: f64 = 1e-10;
/// Screws count as orthogonal up to this; the number of sweeps is limited.
const ORTHOGONAL: f64 = 1e-13;
const MOST_SWEEPS: usize = 30;

/// Rotation and position of a velocity or of a gap.
type Twist = [f64; 6];

/// A chain at real values of its joints.
pub struct RealArm<'a> {
    chain: &'a Chain,
    size: f64,
}

/// Values to which an arm was brought.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// Values of the joints, real ones.
    pub values: Vec<JointValue>,
    /// The largest part of the difference between the tool and its pose: radians, or parts of the size.
    pub gap: f64,
}

/// How an arm's tool moves with its joints.
#[derive(Clone, Debug)]
pub struct Freedom {
    /// Singular values of the joints' screws, descending.
    pub singular_values: Vec<f64>,
    /// Velocities of the joints, each of length 1, in the same order.
    pub velocities: Vec<Vec<f64>>,
}

impl Freedom {
    /// The quotient of the largest and the least singular value: the arm's condition number.
    pub fn condition(&self) -> f64 {
        let (first, last) = (self.singular_values.first(), self.singular_values.last());
        match (first, last) {
            (Some(first), Some(last)) if *last > 0.0 => first / last,
            _ => f64::INFINITY,
        }
    }

    /// Velocities of the joints that leave the tool at rest, where singular values below this part of the largest are 0.
    pub fn at_rest(&self, border: f64) -> &[Vec<f64>] {
        let largest = self.singular_values.first().copied().unwrap_or(0.0);
        let values = self.singular_values.iter();
        let rank = values.take_while(|value| **value > border * largest);
        &self.velocities[rank.count()..]
    }
}

/// How far a posture of an arm with six joints is from a singular one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regularity {
    /// Sign of the determinant of the joints' screws, 1 or -1; 0 where rounding may have turned it.
    pub sign: i8,
    /// Least singular value of the joints' screws.
    pub least_singular_value: f64,
}

impl<'a> RealArm<'a> {
    /// An arm with the joints of this chain.
    pub fn of(chain: &'a Chain) -> Self {
        let size = chain.size();
        Self { chain, size }
    }

    /// The real values next to complex ones: angles are those of the real parts of cosine and sine.
    pub fn real_values(values: &[JointValue]) -> Vec<JointValue> {
        let real = |value: &JointValue| match *value {
            JointValue::Shift(d) => JointValue::Shift(d.re.into()),
            JointValue::Turn(c, s) => turn(c.re, s.re),
        };
        values.iter().map(real).collect()
    }

    /// Values after a step: radians, and parts of the size.
    pub fn after_step(&self, values: &[JointValue], step: &[f64]) -> Vec<JointValue> {
        let pairs = values.iter().zip(step);
        pairs
            .map(|(value, step)| match *value {
                JointValue::Shift(d) => JointValue::Shift((d.re + step * self.size).into()),
                JointValue::Turn(c, s) => {
                    // By tan(step/2) up to its third power: the direction stays exact, and small steps are.
                    let t = step / 2.0 * (1.0 + step * step / 12.0);
                    let (ahead, aside) = (1.0 - t * t, 2.0 * t);
                    turn(c.re * ahead - s.re * aside, s.re * ahead + c.re * aside)
                }
            })
            .collect()
    }

    /// Differences of values, from the first to the second: radians in (-pi, pi], and parts of the size.
    pub fn differences(&self, from: &[JointValue], to: &[JointValue]) -> Vec<f64> {
        let pairs = from.iter().zip(to);
        pairs
            .map(|pair| match pair {
                (JointValue::Turn(c, s), JointValue::Turn(x, y)) => {
                    let (c, s, x, y) = (c.re, s.re, x.re, y.re);
                    radians(Complex64::new(c * x + s * y, c * y - s * x))
                }
                (from, to) => (to.real() - from.real()) / self.size,
            })
            .collect()
    }

    /// The largest difference of values.
    pub fn distance(&self, from: &[JointValue], to: &[JointValue]) -> f64 {
        let differences = self.differences(from, to);
        differences.iter().fold(0.0, |most, x| x.abs().max(most))
    }

    /// The screws of the joints, and the tool's pose.
    fn screws(&self, values: &[JointValue]) -> (Vec<Twist>, Pose) {
        let mut frame = self.chain.base;
        let mut axes = Vec::with_capacity(values.len());
        for (joint, value) in self.chain.joints.iter().zip(values) {
            let real = |v: [Complex64; 3]| v.map(|x| x.re);
            axes.push((joint.is_angle, real(frame.position), real(frame.column(2))));
            frame = joint.along_row(&value.moved(&frame));
        }
        let tool = frame.then(&self.chain.tool);
        let screw = |(turns, point, [x, y, z]): (bool, [f64; 3], [f64; 3])| {
            if !turns {
                return [0.0, 0.0, 0.0, x, y, z];
            }
            let arm = std::array::from_fn(|i| (tool.position[i].re - point[i]) / self.size);
            let [u, v, w] = cross([x, y, z], arm);
            [x, y, z, u, v, w]
        };
        (axes.into_iter().map(screw).collect(), tool)
    }

    /// The twist from a tool to a pose: twice the vector of the turn's quaternion, and the difference of positions.
    fn gap(&self, tool: &Pose, target: &Pose) -> Twist {
        let between = Pose {
            rotation: target.then(&tool.inverse()).rotation,
            ..Pose::IDENTITY
        };
        let [_, x, y, z] = between.quaternion();
        let shift = |i: usize| (target.position[i].re - tool.position[i].re) / self.size;
        [2.0 * x, 2.0 * y, 2.0 * z, shift(0), shift(1), shift(2)]
    }

    /// How the tool moves with the joints.
    pub fn freedom(&self, values: &[JointValue]) -> Freedom {
        let (screws, _) = self.screws(values);
        let svd = decomposed(&screws);
        let real = |column: &Vec<Complex64>| column.iter().map(|x| x.re).collect();
        Freedom {
            velocities: svd.domain.iter().map(real).collect(),
            singular_values: svd.values,
        }
    }

    /// The condition number of the first `joints` joints, as [`Freedom::condition`] gives it, in a tenth of the time.
    pub fn condition(&self, values: &[JointValue], joints: usize) -> f64 {
        let (mut screws, _) = self.screws(values);
        screws.truncate(joints);
        condition_of_screws(screws)
    }

    /// The sign and the least singular value of the screws; `None` for another number of joints than six.
    pub fn regularity(&self, values: &[JointValue]) -> Option<Regularity> {
        let (mut screws, _) = self.screws(values);
        let matrix = <[Twist; 6]>::try_from(&screws[..]).ok()?;
        let (least, most) = squares_of_singular_values(&mut screws);
        let is_clear = least > (SIGN_IS_ROUNDING * SIGN_IS_ROUNDING) * most;
        Some(Regularity {
            sign: if is_clear {
                determinant_sign(matrix)
            } else {
                0
            },
            least_singular_value: least.sqrt(),
        })
    }

    /// The largest part of the difference between the tool and a pose.
    pub fn gap_at(&self, values: &[JointValue], target: &Pose) -> f64 {
        let (_, tool) = self.screws(values);
        largest(&self.gap(&tool, target))
    }

    /// The nearest to a pose that the tool is brought to from values at random, always the same ones.
    pub fn nearest(&self, target: &Pose) -> Reached {
        let mut random = RandomStream::new(0, Purpose::Probe, NEAREST);
        let searches =
            (0..SEARCHES).map(|_| self.toward(target, &self.random_values(|| random.uniform())));
        let nearer = |best: Option<Reached>, other: Reached| match best {
            Some(best) if best.gap <= other.gap => Some(best),
            _ => Some(other),
        };
        let nothing = Reached {
            values: Vec::new(),
            gap: f64::INFINITY,
        };
        searches.fold(None, nearer).unwrap_or(nothing)
    }

    /// Values of the joints by numbers from 0 to 1: any angle, and shifts of at most the arm's size.
    pub fn random_values(&self, mut draw: impl FnMut() -> f64) -> Vec<JointValue> {
        let joints = self.chain.joints.iter();
        joints
            .map(|joint| {
                let x = 2.0 * draw() - 1.0;
                match joint.is_angle {
                    true => JointValue::of_real(std::f64::consts::PI * x, true),
                    false => JointValue::of_real(self.size * x, false),
                }
            })
            .collect()
    }

    /// Brings the tool to a pose from these values, as near as it comes (K. Levenberg 1944, D. Marquardt 1963; damped in
    /// proportion to the gap, which converges quadratically where the arm is regular).
    pub fn toward(&self, target: &Pose, from: &[JointValue]) -> Reached {
        let mut values = Self::real_values(from);
        let (mut screws, tool) = self.screws(&values);
        let mut gap = self.gap(&tool, target);
        let (mut damping, mut refusals) = (FIRST_DAMPING, 0);
        for _ in 0..MOST_STEPS {
            let length = square(&gap).sqrt();
            if length == 0.0 || refusals > MOST_REFUSALS {
                break;
            }
            let damping_here = (damping * length).max(LEAST_DAMPING);
            let step = damped_step(&decomposed(&screws), &gap, damping_here);
            let next = self.after_step(&values, &step);
            let (next_screws, tool) = self.screws(&next);
            let next_gap = self.gap(&tool, target);
            if square(&next_gap) < square(&gap) {
                (values, screws, gap) = (next, next_screws, next_gap);
                (damping, refusals) = (damping / DAMPING_FACTOR, 0);
            } else {
                (damping, refusals) = (damping.max(REFUSED_DAMPING) * DAMPING_FACTOR, refusals + 1);
            }
        }
        Reached {
            values,
            gap: largest(&gap),
        }
    }
}

/// The condition number of joints with these screws, rotation first, about one point.
pub fn condition_of_screws(mut screws: Vec<[f64; 6]>) -> f64 {
    let (least, most) = squares_of_singular_values(&mut screws);
    if least > 0.0 {
        (most / least).sqrt()
    } else {
        f64::INFINITY
    }
}

/// The least and the largest square of a singular value of these screws, which are turned into orthogonal ones.
fn squares_of_singular_values(screws: &mut [Twist]) -> (f64, f64) {
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for k in 1..screws.len() {
            let (before, rest) = screws.split_at_mut(k);
            for other in before {
                turned |= make_orthogonal(other, &mut rest[0]);
            }
        }
        if !turned {
            break;
        }
    }
    let squares = screws.iter().map(|screw| square(screw));
    squares.fold((f64::INFINITY, 0.0f64), |(least, most), x| {
        (least.min(x), most.max(x))
    })
}

/// The sign of the determinant of six screws, by elimination with the largest pivot of each column.
fn determinant_sign(mut rows: [Twist; 6]) -> i8 {
    let mut sign = 1;
    for k in 0..6 {
        let pivot = (k..6).fold(k, |best, row| {
            if rows[row][k].abs() > rows[best][k].abs() {
                row
            } else {
                best
            }
        });
        if rows[pivot][k] == 0.0 {
            return 0;
        }
        if pivot != k {
            rows.swap(pivot, k);
            sign = -sign;
        }
        if rows[k][k] < 0.0 {
            sign = -sign;
        }
        for row in k + 1..6 {
            let factor = rows[row][k] / rows[k][k];
            for column in k..6 {
                rows[row][column] -= factor * rows[k][column];
            }
        }
    }
    sign
}

/// Turns two vectors into orthogonal ones of the same plane (one-sided Jacobi rotation); whether they were not.
fn make_orthogonal(a: &mut Twist, b: &mut Twist) -> bool {
    let product: f64 = a.iter().zip(b.iter()).map(|(x, y)| x * y).sum();
    let (left, right) = (square(a), square(b));
    if product.abs() <= ORTHOGONAL * (left * right).sqrt() {
        return false;
    }
    let zeta = (right - left) / (2.0 * product);
    let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    for (x, y) in a.iter_mut().zip(b.iter_mut()) {
        (*x, *y) = (c * (*x - t * *y), c * (t * *x + *y));
    }
    true
}

/// The step that makes the gap least where steps are weighed by the damping.
fn damped_step(svd: &Svd, gap: &Twist, damping: f64) -> Vec<f64> {
    let mut step = vec![0.0; svd.domain.len()];
    for ((value, image), velocity) in svd.values.iter().zip(&svd.images).zip(&svd.domain) {
        let along: f64 = image.iter().zip(gap).map(|(u, b)| u.re * b).sum();
        let weight = value * value + damping;
        if weight > 0.0 {
            for (step, v) in step.iter_mut().zip(velocity) {
                *step += along / weight * v.re;
            }
        }
    }
    let most = largest(&step);
    if most > LONGEST_STEP {
        step.iter_mut().for_each(|x| *x *= LONGEST_STEP / most);
    }
    step
}

fn decomposed(screws: &[Twist]) -> Svd {
    let column = |screw: &Twist| screw.map(Complex64::from).to_vec();
    Svd::of(screws.iter().map(column).collect())
}

fn square(numbers: &[f64]) -> f64 {
    numbers.iter().map(|x| x * x).sum()
}

fn largest(numbers: &[f64]) -> f64 {
    // A value that is not a number counts as the largest, so that the gap stays open.
    let worst = |most: f64, x: &f64| {
        if x.abs() >= most || x.is_nan() {
            x.abs()
        } else {
            most
        }
    };
    let most = numbers.iter().fold(0.0, worst);
    if most.is_nan() { f64::INFINITY } else { most }
}

/// A turn in this direction of the plane.
fn turn(c: f64, s: f64) -> JointValue {
    let length = (c * c + s * s).sqrt();
    if length > 0.0 && length.is_finite() {
        JointValue::Turn((c / length).into(), (s / length).into())
    } else {
        JointValue::Turn(1.0.into(), 0.0.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Body, ReadOptions, read};

    /// A PUMA 560 of the textbooks (B. Armstrong, O. Khatib and J. Burdick 1986), in metres.
    fn puma() -> Chain {
        let table = b"# convention: standard\ntheta,d,a,alpha\n0,0,0,90\n0,0,0.4318,0\n0,0.15,0.0203,-90\n0,0.4318,0,90\n\
            0,0,0,-90\n0,0,0,0\n";
        let arm = read("puma.csv", table, &ReadOptions::default()).expect("a table of this test");
        match arm.body {
            Body::Chain(chain) => *chain,
            _ => panic!("a table is a chain"),
        }
    }

    fn turns(degrees: [f64; 6]) -> Vec<JointValue> {
        let turn = |x: f64| JointValue::of_real(x.to_radians(), true);
        degrees.map(turn).to_vec()
    }

    #[test]
    fn screws_are_the_derivatives_of_the_tool() {
        let chain = puma();
        let arm = RealArm::of(&chain);
        let values = turns([10.0, -40.0, 70.0, 25.0, -35.0, 80.0]);
        let (screws, tool) = arm.screws(&values);
        for (k, screw) in screws.iter().enumerate() {
            let step: Vec<f64> = (0..6).map(|i| if i == k { 1e-6 } else { 0.0 }).collect();
            let moved = chain.tool_pose(&arm.after_step(&values, &step));
            for (expected, seen) in screw.iter().zip(arm.gap(&tool, &moved)) {
                assert!((expected - seen / 1e-6).abs() < 1e-5, "joint {k}");
            }
        }
    }

    #[test]
    fn a_regular_posture_is_reached_to_its_digits() {
        let chain = puma();
        let arm = RealArm::of(&chain);
        let values = turns([10.0, -40.0, 70.0, 25.0, -35.0, 80.0]);
        let near = turns([12.0, -42.0, 69.0, 23.0, -33.0, 81.0]);
        let reached = arm.toward(&chain.tool_pose(&values), &near);
        assert!(reached.gap < 1e-15, "{}", reached.gap);
        assert!(arm.distance(&reached.values, &values) < 1e-14);
        let condition = arm.freedom(&values).condition();
        assert!(condition < 100.0);
        assert!((arm.condition(&values, 6) / condition - 1.0).abs() < 1e-12);
    }

    /// The sign changes where the wrist turns over, and nowhere between; there the least singular value is 0.
    #[test]
    fn the_sign_changes_across_a_singular_posture() {
        let chain = puma();
        let arm = RealArm::of(&chain);
        let at = |wrist: f64| {
            let values = turns([10.0, -40.0, 70.0, 25.0, wrist, 80.0]);
            let freedom = arm.freedom(&values);
            let regularity = arm.regularity(&values).expect("six joints");
            let least = freedom.singular_values[5];
            assert!((regularity.least_singular_value - least).abs() < 1e-12);
            regularity.sign
        };
        assert_eq!(at(0.0), 0);
        assert_eq!(at(35.0), at(0.01));
        assert_eq!(at(-35.0), -at(35.0));
        assert_eq!(at(35.0).abs(), 1);
        assert_eq!(determinant_sign([[0.0; 6]; 6]), 0);
    }

    /// Elbow stretched, wrist aligned, both: the screws of the joints depend; where the wrist is aligned, those of joints 4
    /// and 6.
    #[test]
    fn singular_postures_are_seen_and_reached() {
        let chain = puma();
        let arm = RealArm::of(&chain);
        let stretched = 90.0 + (0.0203f64 / 0.4318).atan().to_degrees();
        for (posture, at_rest) in [
            ([10.0, -40.0, 70.0, 25.0, 0.0, 80.0], 1),
            ([10.0, -40.0, stretched, 25.0, -35.0, 80.0], 1),
            ([10.0, -40.0, stretched, 25.0, 0.0, 80.0], 1),
        ] {
            let values = turns(posture);
            let freedom = arm.freedom(&values);
            assert_eq!(freedom.at_rest(1e-9).len(), at_rest, "{freedom:?}");
            let near: Vec<f64> = posture.iter().map(|x| x + 0.5).collect();
            let near = turns(near.try_into().expect("six"));
            let reached = arm.toward(&chain.tool_pose(&values), &near);
            assert!(reached.gap < 1e-12, "{posture:?}: {:e}", reached.gap);
        }
        let wrist = arm.freedom(&turns([10.0, -40.0, 70.0, 25.0, 0.0, 80.0]));
        let velocity = &wrist.at_rest(1e-9)[0];
        assert!(velocity[..3].iter().all(|x| x.abs() < 1e-12) && velocity[4].abs() < 1e-12);
        assert!((velocity[3] + velocity[5]).abs() < 1e-12);
    }
}
