//! Which two joints of an arm are left out of its equations: three apart in the arm's loop, they follow linearly from the others.
//!
//! The equations have the solutions of the arm whose one half is mirrored in a plane through both axes, too. Where the axes lie in
//! one plane in every posture, each posture is such a solution at the same time, and all solutions are singular.

use crate::mechanism::chain::{Axis, Chain};
use crate::mechanism::pose::{cross, dot, unit};
use cognate_numeric::random::{Purpose, RandomStream};
use std::f64::consts::PI;

/// Number of the random stream of postures.
const POSTURES: u64 = 0x6c65_6674;
/// Postures in which axes are looked at.
const TRIES: usize = 4;
/// Axes lie in one plane where their distance, times the sine of their angle, is below this part of the arm's size.
const IN_ONE_PLANE: f64 = 1e-9;
/// The pairs, by the place of the first joint; the first pair has the equations of the family that is solved already.
const PAIRS: [usize; 3] = [2, 1, 0];

/// The first joint of the pair to leave out of an arm of six joints: both turn, and their axes are not in one plane in every
/// posture, where there is such a pair. `None` where no pair turns.
pub fn first_left_out(arm: &Chain) -> Option<usize> {
    let turns = |k: usize| arm.joints.get(k).is_some_and(|joint| joint.is_angle);
    let pairs = PAIRS.into_iter().filter(|k| turns(*k) && turns(k + 3));
    let regular = pairs.clone().find(|k| !are_in_one_plane(arm, *k));
    regular.or_else(|| pairs.clone().next())
}

/// Whether the axes of a joint and of the third after it are in one plane in every posture.
fn are_in_one_plane(arm: &Chain, first: usize) -> bool {
    let mut random = RandomStream::new(0, Purpose::Probe, POSTURES);
    let size = arm.size();
    (0..TRIES).all(|_| {
        let joints = arm.joints.iter();
        let values: Vec<f64> = joints
            .map(|joint| {
                let x = 2.0 * random.uniform() - 1.0;
                x * if joint.is_angle { PI } else { size }
            })
            .collect();
        let (axes, _) = arm.axes(&values);
        let moment = axes.get(first).zip(axes.get(first + 3));
        moment.is_some_and(|(one, other)| moment_of(one, other).abs() < IN_ONE_PLANE * size)
    })
}

/// The distance of two axes times the sine of their angle.
fn moment_of(one: &Axis, other: &Axis) -> f64 {
    let (Some(z), Some(toward)) = (unit(one.direction), unit(other.direction)) else {
        return 0.0;
    };
    let between = std::array::from_fn(|i| other.point[i] - one.point[i]);
    dot(between, cross(z, toward))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Body, ReadOptions, read};

    fn first_of(table: &str) -> Option<usize> {
        let text = format!("# angles: deg\n# convention: standard\ntype,theta,d,a,alpha\n{table}");
        let options = ReadOptions::default();
        let arm = read("arm.csv", text.as_bytes(), &options).expect("a table of this test");
        match &arm.body {
            Body::Chain(chain) => first_left_out(chain),
            _ => panic!("a table is a chain"),
        }
    }

    /// Axes 1 and 4 of a KR 6 meet always, and so do axes 3 and 6 of the same arm from its hand to its base.
    #[test]
    fn axes_that_always_meet_stay_in_the_equations() {
        let arm = "R,0,0.4,0.025,-90\nR,0,0,0.455,0\nR,0,0,0.035,-90\nR,0,0.42,0,90\nR,0,0,0,-90\nR,0,0.08,0,0\n";
        assert_eq!(first_of(arm), Some(2));
        let from_hand = "R,0,0.2,0,-90\nR,0,0,0,90\nR,0,0.42,0.035,-90\nR,0,0,0.455,0\nR,0,0,0.025,-90\nR,0,0.1,0,0\n";
        assert_eq!(first_of(from_hand), Some(1));
    }

    #[test]
    fn joints_that_shift_stay_in_the_equations() {
        let stanford = "R,0,0.412,0,-90\nR,0,0.154,0,90\nP,0,0.3,0,0\nR,0,0,0,-90\nR,0,0,0,90\nR,0,0.263,0,0\n";
        assert_eq!(first_of(stanford), Some(1));
    }
}
