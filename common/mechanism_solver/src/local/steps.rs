//! Steps of chains: their parts from numbers of a file, and a chain backwards.

use super::conditions::{Step, Vector};
use super::field::Constant;
use cognate_kinematics::mechanism::Vector as Numbers;
use cognate_kinematics::mechanism::pose::Pose;

pub(super) fn vector(numbers: &Numbers) -> Vector {
    numbers.each_ref().map(Constant::of)
}

pub(super) fn basis(k: usize) -> Vector {
    std::array::from_fn(|i| Constant::integer(i64::from(i == k)))
}

/// A double that stands for a number of which the exact value is not kept, but for 0, 1 and -1.
pub(super) fn near(x: f64) -> Constant {
    match [0.0, 1.0, -1.0].contains(&x) {
        true => Constant::integer(x as i64),
        false => Constant::rounded(x),
    }
}

pub(super) fn fixed(pose: &Pose) -> Step {
    let rows = pose.rotation.map(|row| row.map(|c| near(c.re)));
    Step::Fixed(Box::new((rows, pose.position.map(|c| near(c.re)))))
}

pub(super) fn about_z(coordinate: usize, turns: bool) -> Step {
    let axis = basis(2);
    if turns {
        let point = Box::new(basis(0).map(|_| Constant::integer(0)));
        Step::Turn {
            axis,
            point,
            coordinate,
            is_reversed: false,
        }
    } else {
        Step::Shift {
            axis,
            coordinate,
            is_reversed: false,
        }
    }
}

/// The steps backwards, from the end to the beginning.
pub(super) fn reversed(steps: &[Step]) -> Vec<Step> {
    let back = |step: &Step| match step.clone() {
        Step::Turn {
            axis,
            point,
            coordinate,
            is_reversed,
        } => Step::Turn {
            axis,
            point,
            coordinate,
            is_reversed: !is_reversed,
        },
        Step::Shift {
            axis,
            coordinate,
            is_reversed,
        } => Step::Shift {
            axis,
            coordinate,
            is_reversed: !is_reversed,
        },
        Step::Fixed(parts) => {
            let rotation = parts
                .0
                .each_ref()
                .map(|row| row.each_ref().map(|c| c.double));
            let position = parts.1.each_ref().map(|c| c.double);
            fixed(&Pose::real(rotation, position).inverse())
        }
        spin @ Step::Spin { .. } => spin,
    };
    steps.iter().rev().map(back).collect()
}
