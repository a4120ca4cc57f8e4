//! Samples of a path: the targets that are given, and others between them.

use cognate_kinematics::compile::Target;
use cognate_kinematics::mechanism::pose::Pose;
use num_complex::Complex64;

/// Poses that are farther apart than this many radians get samples between them.
const FARTHEST_TURN: f64 = 0.1;
/// Poses with places or lengths that differ by more than this get samples between them, in parts of the mechanism's
/// size.
const FARTHEST_SHIFT: f64 = 0.01;

/// A target of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Where it is: 0 at the first target that was given, 1 at the second, and so on.
    pub at: f64,
    /// The target.
    pub target: Target,
}

/// The path through these targets. `wanted`: how many samples there are in all, at least; without it as many as keep
/// neighbours near. `size`: a length of the mechanism. `angles`: which inputs are angles.
pub fn samples(
    targets: &[Target],
    wanted: Option<usize>,
    size: f64,
    angles: &[bool],
) -> Vec<Sample> {
    let Some(first) = targets.first() else {
        return Vec::new();
    };
    let mut path_samples = vec![Sample {
        at: 0.0,
        target: first.clone(),
    }];
    let pieces = targets.len().saturating_sub(1).max(1);
    for (k, pair) in targets.windows(2).enumerate() {
        let steps = match wanted {
            Some(wanted) => wanted.saturating_sub(1).div_ceil(pieces).max(1),
            None => steps(&pair[0], &pair[1], size, angles),
        };
        for i in 1..=steps {
            let part = i as f64 / steps as f64;
            path_samples.push(Sample {
                at: k as f64 + part,
                target: if i == steps {
                    pair[1].clone()
                } else {
                    between(&pair[0], &pair[1], part)
                },
            });
        }
    }
    path_samples
}

/// How many steps keep neighbours near.
fn steps(from: &Target, to: &Target, size: f64, angles: &[bool]) -> usize {
    let parts = match (from, to) {
        (Target::Pose(a), Target::Pose(b)) => {
            let (e, f) = (a.quaternion(), nearer(a.quaternion(), b.quaternion()));
            let square = |x: f64| x * x;
            // The chord of unit quaternions is about half of the turn.
            let turn = 2.0 * (0..4).map(|i| square(f[i] - e[i])).sum::<f64>().sqrt();
            let shift = (0..3).map(|i| square(b.position[i].re - a.position[i].re));
            let shift = shift.sum::<f64>().sqrt();
            (turn / FARTHEST_TURN).max(shift / (FARTHEST_SHIFT * size))
        }
        (Target::Inputs(a), Target::Inputs(b)) => a
            .iter()
            .zip(b)
            .enumerate()
            .map(|(i, (x, y))| match angles.get(i) {
                Some(true) => (y - x).abs() / FARTHEST_TURN,
                _ => (y - x).abs() / (FARTHEST_SHIFT * size),
            })
            .fold(0.0, f64::max),
        _ => 0.0,
    };
    // A path of a million samples is longer than any that is read.
    parts.ceil().clamp(1.0, 1e6) as usize
}

/// The quaternion of the same turn on the side of `e`.
fn nearer(e: [f64; 4], f: [f64; 4]) -> [f64; 4] {
    let along: f64 = (0..4).map(|i| e[i] * f[i]).sum();
    if along < 0.0 { f.map(|x| -x) } else { f }
}

/// A target between two: quaternions and places on straight lines, and so the values of inputs.
fn between(from: &Target, to: &Target, part: f64) -> Target {
    let mix = |x: f64, y: f64| x + (y - x) * part;
    match (from, to) {
        (Target::Pose(a), Target::Pose(b)) => {
            let (e, f) = (a.quaternion(), nearer(a.quaternion(), b.quaternion()));
            let turned: [f64; 4] = std::array::from_fn(|i| mix(e[i], f[i]));
            let place =
                std::array::from_fn(|i| Complex64::from(mix(a.position[i].re, b.position[i].re)));
            let pose = Pose::of_quaternion(turned.map(Complex64::from), place);
            Target::Pose(pose.unwrap_or(*b))
        }
        (Target::Inputs(a), Target::Inputs(b)) => {
            Target::Inputs(a.iter().zip(b).map(|(x, y)| mix(*x, *y)).collect())
        }
        _ => to.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_near_and_what_is_given_is_there() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let turned = [half, half, 0.0, 0.0].map(|x| Complex64::from(-x));
        let poses = [
            Pose::IDENTITY,
            Pose::of_quaternion(turned, [0.0, 0.5, 0.0].map(Complex64::from)).unwrap(),
            Pose::shift(0.0, 0.0, 0.001),
        ]
        .map(Target::Pose);
        let path_samples = samples(&poses, None, 1.0, &[]);
        for (k, pose) in poses.iter().enumerate() {
            let at = path_samples.iter().find(|s| s.at == k as f64).unwrap();
            assert_eq!(at.target, *pose);
        }
        for pair in path_samples.windows(2) {
            let (Target::Pose(a), Target::Pose(b)) = (&pair[0].target, &pair[1].target) else {
                panic!("they are poses");
            };
            assert!(a.distance(b, 1.0) < 0.11 && pair[0].at < pair[1].at);
        }
        assert_eq!(samples(&poses, Some(101), 1.0, &[]).len(), 101);
        assert_eq!(samples(&poses, Some(1), 1.0, &[]).len(), 3);
    }

    #[test]
    fn inputs_go_straight() {
        let inputs = [vec![0.0, 1.0], vec![1.0, 1.0]].map(Target::Inputs);
        let path_samples = samples(&inputs, Some(5), 1.0, &[true, false]);
        assert_eq!(path_samples[1].target, Target::Inputs(vec![0.25, 1.0]));
        assert_eq!(samples(&inputs, None, 1.0, &[true, false]).len(), 11);
        assert_eq!(samples(&inputs, None, 1.0, &[false, false]).len(), 101);
        assert!(samples(&[], None, 1.0, &[]).is_empty());
    }
}
