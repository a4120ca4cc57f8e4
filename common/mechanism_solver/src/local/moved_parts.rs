//! Parts of an assembly that a number of the file moves: steps that the number's coordinate puts into chains, about joints and
//! at the ends of bars.
//!
//! The coordinate is the shift or turn that a change of the number makes. Both differ by a change of one variable, which
//! leaves dimensions as they are.

use super::conditions::{Step, Vector};
use super::field::Constant;
use super::steps::{about_z, basis, reversed, vector};
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::mechanism::file_number::{ChainPlace, Moves};
use cognate_kinematics::mechanism::{Framework, Joint, JointKind};

/// The coordinate that is a number of the file.
pub const NUMBER: usize = 0;

/// The shift along an axis by the number's coordinate.
pub(super) fn number_shift(axis: usize) -> Step {
    Step::Shift {
        axis: basis(axis),
        coordinate: NUMBER,
        is_reversed: false,
    }
}

fn number_turn(axis: Vector, point: Vector) -> Step {
    Step::Turn {
        axis,
        point: Box::new(point),
        coordinate: NUMBER,
        is_reversed: false,
    }
}

fn negative(x: &Constant) -> Constant {
    let mut negative = x.clone();
    negative.double = -x.double;
    if let Some(surd) = &mut negative.exact {
        surd.coefficient = -surd.coefficient.clone();
    }
    negative
}

/// The axis about which a direction turns where one of its components changes; `None` where only its length changes.
fn turning_axis(direction: &Vector, component: usize) -> Option<Vector> {
    let [next, last] = [(component + 1) % 3, (component + 2) % 3];
    let mut axis = basis(component).map(|_| Constant::integer(0));
    axis[next] = direction[last].clone();
    axis[last] = negative(&direction[next]);
    let is_zero = axis.iter().all(|x| x.double == 0.0);
    (!is_zero).then_some(axis)
}

/// Steps about an axis or a frame that `motion` has moved: the motion, the steps, the motion back.
fn about(motion: &Step, steps: Vec<Step>) -> Vec<Step> {
    let mut moved = vec![motion.clone()];
    moved.extend(steps);
    moved.extend(reversed(std::slice::from_ref(motion)));
    moved
}

/// Parts that a number of the file moves, if a number is a coordinate.
#[derive(Clone, Debug)]
pub struct MovedParts(pub Option<Moves>);

impl MovedParts {
    /// Steps that the number adds at a place of a chain.
    pub(super) fn chain(&self, at: ChainPlace) -> Vec<Step> {
        match &self.0 {
            Some(Moves::Chain { place, turns, axis }) if *place == at => {
                let step = match (turns, axis) {
                    (false, axis) => number_shift(*axis),
                    (true, 2) => about_z(NUMBER, true),
                    (true, axis) => {
                        number_turn(basis(*axis), basis(0).map(|_| Constant::integer(0)))
                    }
                };
                vec![step]
            }
            _ => Vec::new(),
        }
    }

    /// The steps of a joint, with what the number moves of it.
    pub(super) fn joint(&self, j: usize, joint: &Joint, mut steps: Vec<Step>) -> Vec<Step> {
        let (side, motion, is_second) = match &self.0 {
            Some(Moves::Point {
                joint: number,
                side,
                axis,
            }) if *number == j => (*side, number_shift(*axis), false),
            Some(Moves::Direction {
                joint: number,
                side,
                is_second,
                axis,
            }) if *number == j => {
                let place = &joint.sides[side.unwrap_or(0)];
                let direction = match (is_second, &place.second) {
                    (true, Some(second)) => second,
                    _ => &place.axis,
                };
                let Some(turning) = turning_axis(&vector(direction), *axis) else {
                    return steps;
                };
                let motion = number_turn(turning, vector(&place.point));
                (*side, motion, *is_second)
            }
            _ => return steps,
        };
        match side {
            None if joint.kind == JointKind::U && matches!(motion, Step::Turn { .. }) => {
                // The first step turns about the first axis, the second one about the second.
                let second = steps.split_off(1);
                let first = steps;
                let moved = |steps: Vec<Step>, is_moved: bool| match is_moved {
                    true => about(&motion, steps),
                    false => steps,
                };
                let mut both = moved(first, !is_second);
                both.extend(moved(second, is_second));
                both
            }
            None => about(&motion, steps),
            Some(0) => {
                steps.insert(0, motion);
                steps
            }
            Some(_) => {
                steps.extend(reversed(&[motion]));
                steps
            }
        }
    }

    /// The shift of a ball in one of its links.
    pub(super) fn ball(&self, j: usize, link_side: usize) -> Option<Step> {
        match &self.0 {
            Some(Moves::Point { joint, side, axis })
                if *joint == j && side.is_none_or(|side| side == link_side) =>
            {
                Some(number_shift(*axis))
            }
            _ => None,
        }
    }

    /// The shift of an end of a leg in the base, or in the platform.
    pub(super) fn leg_end(&self, leg: usize, is_moving: bool) -> Vec<Step> {
        match &self.0 {
            Some(Moves::BasePoint { legs, axis }) if !is_moving && legs.contains(&leg) => {
                vec![number_shift(*axis)]
            }
            Some(Moves::MovingPoint { legs, axis }) if is_moving && legs.contains(&leg) => {
                vec![number_shift(*axis)]
            }
            _ => Vec::new(),
        }
    }

    /// The axis along which a point that stands still is shifted so that the fixed bar's length changes. That the bar also turns
    /// moves the whole framework, which changes no distance.
    pub(super) fn fixed_point_axis(
        &self,
        framework: &Framework,
        points: &[[Number; 2]],
        point: usize,
    ) -> Option<usize> {
        let Some(Moves::Bar(bar)) = self.0 else {
            return None;
        };
        let bar = framework.bars.get(bar)?;
        if !framework.is_fixed(bar) || point != framework.fixed[1] {
            return None;
        }
        let [first, second] = framework.fixed.map(|k| points.get(k));
        let (first, second) = first.zip(second)?;
        let apart = [0, 1].map(|k| (second[k].to_f64() - first[k].to_f64()).abs());
        Some(usize::from(apart[1] > apart[0]))
    }
}
