//! Arms of which axes 2, 3 and 4 are parallel: what happens along these axes gives joints 1, 5 and 6, and what happens across them
//! is a planar arm of three turns.

use super::circle::{Linear, Quadratic};
use super::six_turns::{Link, SixTurns, is_no_length, is_parallel};
use super::turn::{NEAR_FOLD, Turn, Turns};
use super::two_circles::{Meeting, TwoCircles};
use cognate_kinematics::mechanism::pose::Pose;

/// Whether axes 2, 3 and 4 are parallel, no two of them one, and the axes beside them are not.
pub fn fits(arm: &SixTurns) -> bool {
    let [first, second, third, fourth, _] = &arm.links;
    let is_planar = |link: &Link| is_parallel(link) && !is_no_length(link.length);
    !is_parallel(first) && is_planar(second) && is_planar(third) && !is_parallel(fourth)
}

/// The postures of the arm where its hand has this frame; `None` near a fold or a set of postures.
pub fn postures(arm: &SixTurns, hand: &Pose) -> Option<Vec<Turns>> {
    let mut postures = Vec::with_capacity(8);
    for Meeting { turn, vector } in along(arm, hand).meetings()? {
        let [s, c] = vector;
        let fifth = Turn { c, s };
        let behind_first = arm.links[0].after(&Pose::IDENTITY.turned(turn.c, turn.s));
        let seen = behind_first.inverse().then(hand);
        let sixth = last(arm, fifth, &seen)?;
        // The pose behind joint 4, and from there on.
        let rest = arm.links[3].after(&Pose::IDENTITY);
        let rest = arm.frame(rest, 4, &[fifth, sixth]);
        for [second, third, fourth] in planar(arm, &seen.then(&rest.inverse()))? {
            postures.push([turn, second, third, fourth, fifth, sixth]);
        }
    }
    Some(postures)
}

/// The sign of axis 4 along axis 2.
fn sign(arm: &SixTurns) -> f64 {
    (arm.links[1].twist[0] * arm.links[2].twist[0]).signum()
}

/// Joint 1 as the turn, and the sine and cosine of joint 5 as the vector: heights along axis 2 of the hand's place and of axis 6
/// are the same from both ends.
fn along(arm: &SixTurns, hand: &Pose) -> TwoCircles {
    let [first, second, third, fourth, fifth] = &arm.links;
    let sign = sign(arm);
    let ([a1, b1], [a4, b4], [a5, b5]) = (first.twist, fourth.twist, fifth.twist);
    let between = second.offset + second.twist[0].signum() * third.offset;
    // The height along axis 2 of a vector that joint 1 turns back and the first link follows.
    let height = |x: f64, y: f64, z: f64| Linear {
        one: a1 * z,
        c: -b1 * y,
        s: b1 * x,
    };
    let [x, y, z] = hand.position.map(|x| x.re);
    let of_place = height(x, y, z - first.offset);
    let there = between + sign * (a4 * fifth.offset + fourth.offset);
    let [x, y, z] = hand.column(2).map(|x| x.re);
    let of_axis = height(x, y, z);
    TwoCircles {
        first: (
            sign * b4 * fifth.length,
            of_place.plus(&Linear::constant(-there)),
        ),
        second: (
            -sign * b4 * b5,
            of_axis.plus(&Linear::constant(-sign * a4 * a5)),
        ),
        square: Quadratic {
            linear: Linear::constant(1.0),
            ..Quadratic::default()
        },
    }
}

/// Joint 6: it turns the direction of axis 2, as it is seen before joint 6, to where the hand sees it.
fn last(arm: &SixTurns, fifth: Turn, seen: &Pose) -> Option<Turn> {
    let frame = arm.links[3].after(&Pose::IDENTITY);
    let row = arm.frame(frame, 4, &[fifth]).rotation[2];
    let sign = sign(arm);
    let [x, y, _] = seen.rotation[2];
    let turn = Turn::between([row[0] * sign, row[1] * sign], [x, y])?;
    // Rows are turned back where columns are turned.
    Some(turn.inverse())
}

/// Joints 2, 3 and 4 from the pose behind joint 4, in the plane across their axes.
fn planar(arm: &SixTurns, pose: &Pose) -> Option<[[Turn; 3]; 2]> {
    let [_, second, third, _, _] = &arm.links;
    let place = [pose.position[0], pose.position[1]];
    let square = place[0] * place[0] + place[1] * place[1];
    if square.norm_sqr() <= NEAR_FOLD * NEAR_FOLD {
        return None;
    }
    let (a, b) = (second.length, third.length);
    let sides = Turn::of_cosine((square - a * a - b * b) / (2.0 * a * b))?;
    let [of_third, of_fourth] = [second.twist[0].signum(), sign(arm)];
    let whole = Turn {
        c: pose.rotation[0][0],
        s: pose.rotation[1][0],
    };
    let signed = |turn: Turn, sign: f64| Turn {
        s: turn.s * sign,
        ..turn
    };
    let ways = sides.map(|elbow| {
        // The elbow as it is seen along axis 2.
        let [x, y] = elbow.of([b.into(), 0.0.into()]);
        let shoulder = Turn::between([x + a, y], place)?;
        let rest = shoulder.then(&elbow).inverse().then(&whole);
        Some([shoulder, signed(elbow, of_third), signed(rest, of_fourth)])
    });
    Some([ways[0]?, ways[1]?])
}

#[cfg(test)]
mod tests {
    use super::super::test_arms::{check, link};
    use super::*;

    /// A UR, one whose axis 6 does not meet axis 5, and one with axes in opposite directions.
    #[test]
    fn postures_by_parallel_axes_make_the_hand() {
        for links in [
            [
                link(0.0, 90.0, 0.16),
                link(-0.42, 0.0, 0.0),
                link(-0.39, 0.0, 0.0),
                link(0.0, 90.0, 0.13),
                link(0.0, -90.0, 0.1),
            ],
            [
                link(0.1, 80.0, 0.16),
                link(0.42, 0.0, 0.05),
                link(0.39, 0.0, -0.1),
                link(0.08, 75.0, 0.13),
                link(0.12, -65.0, 0.1),
            ],
            [
                link(0.1, 80.0, 0.16),
                link(0.42, 180.0, 0.05),
                link(-0.39, 0.0, 0.1),
                link(0.08, 75.0, 0.13),
                link(0.0, -65.0, 0.1),
            ],
            [
                link(-0.1, 60.0, 0.16),
                link(0.42, 180.0, 0.05),
                link(0.39, 180.0, 0.1),
                link(0.08, -75.0, 0.13),
                link(0.1, 65.0, 0.1),
            ],
            [
                link(-0.1, 60.0, 0.16),
                link(0.42, 0.0, 0.05),
                link(0.39, 180.0, 0.1),
                link(0.08, -75.0, 0.13),
                link(0.2, 0.0, 0.1),
            ],
        ] {
            let arm = SixTurns { links };
            assert!(fits(&arm));
            check(&arm, postures, 8);
        }
    }
}
