//! Arms of which axes 4, 5 and 6 meet in a point, the wrist's centre: three turns bring it to its place, then three turn the hand
//! (D. L. Pieper 1968).

use super::circle::{Linear, Quadratic};
use super::six_turns::{Link, SixTurns, is_no_length, is_parallel};
use super::turn::{Turn, Turns};
use super::two_circles::TwoCircles;
use cognate_kinematics::mechanism::pose::{Pose, Vector3};

/// Whether the last three axes meet in one point and no two of them are one.
pub fn fits(arm: &SixTurns) -> bool {
    let [_, _, _, fourth, fifth] = &arm.links;
    let meet = [fourth.length, fifth.length, fifth.offset];
    meet.into_iter().all(is_no_length) && !is_parallel(fourth) && !is_parallel(fifth)
}

/// The postures of the arm where its hand has this frame; `None` near a fold or a set of postures.
pub fn postures(arm: &SixTurns, hand: &Pose) -> Option<Vec<Turns>> {
    let [first, second, third, fourth, _] = &arm.links;
    let centre = third.point([0.0.into(), 0.0.into(), fourth.offset.into()]);
    let mut postures = Vec::with_capacity(8);
    let place = match is_parallel(second) {
        true => place_by_parallel_axes,
        false => place_by_distance,
    };
    for arm_turns in place(first, second, centre.map(|x| x.re), hand.position)? {
        let forearm = arm.frame(Pose::IDENTITY, 0, &arm_turns);
        for wrist_turns in wrist(arm, &forearm, hand)? {
            let [a, b, c] = arm_turns;
            let [d, e, f] = wrist_turns;
            postures.push([a, b, c, d, e, f]);
        }
    }
    Some(postures)
}

/// The turns of joints 1, 2 and 3 that bring a point to its place: R1 L1 R2 L2 R3 centre = place.
///
/// The square of the distance to axis 1's first point and the height along axis 1 do not depend on joint 1. Both are linear in
/// the cosine and sine of joint 3 and in the place u behind joint 2, whose height and square are functions of joint 3, too.
fn place_by_distance(
    first: &Link,
    second: &Link,
    [x, y, z]: [f64; 3],
    place: Vector3,
) -> Option<[[Turn; 3]; 4]> {
    // R3 centre, and g = L2 R3 centre.
    let turned_x = Linear {
        one: 0.0,
        c: x,
        s: -y,
    };
    let turned_y = Linear {
        one: 0.0,
        c: y,
        s: x,
    };
    let [c, s] = second.twist;
    let g_x = turned_x.plus(&Linear::constant(second.length));
    let g_y = turned_y.times(c).plus(&Linear::constant(-s * z));
    let above = turned_y.times(s).plus(&Linear::constant(c * z));
    let g_z = above.plus(&Linear::constant(second.offset));
    let (a, d) = (second.length, second.offset);
    let constant = x * x + y * y + z * z + a * a + d * d;
    let g_square = turned_x.times(2.0 * a).plus(&above.times(2.0 * d));
    let g_square = g_square.plus(&Linear::constant(constant));
    // u = R2 g: 2 a1 u_x = |p|^2 - a1^2 - |g|^2, sin u_y = p_z - cos g_z, with p taken from the foot of the first normal.
    let height = place[2].re - first.offset;
    let [c, s] = first.twist;
    let p_square = place[0].re * place[0].re + place[1].re * place[1].re + height * height;
    let reach = p_square - first.length * first.length;
    let circles = TwoCircles {
        first: (
            2.0 * first.length,
            Linear::constant(reach).plus(&g_square.times(-1.0)),
        ),
        second: (s, Linear::constant(height).plus(&g_z.times(-c))),
        square: Quadratic {
            linear: g_square,
            ..Quadratic::default()
        }
        .plus(-1.0, &g_z.square()),
    };
    let mut turns = [[Turn::NONE; 3]; 4];
    for (turns, meeting) in turns.iter_mut().zip(circles.meetings()?) {
        let third = meeting.turn;
        let g = [g_x.at(&third), g_y.at(&third)];
        let behind_second = Turn::between(g, meeting.vector)?;
        let [u_x, u_y] = meeting.vector;
        let [x, y, _] = first.point([u_x, u_y, g_z.at(&third)]);
        let before = Turn::between([x, y], [place[0], place[1]])?;
        *turns = [before, behind_second, third];
    }
    Some(turns)
}

/// Turns of the first three joints if axes 2 and 3 are parallel: the height along them gives joint 1, and a triangle
/// joint 3.
fn place_by_parallel_axes(
    first: &Link,
    second: &Link,
    [x, y, z]: [f64; 3],
    place: Vector3,
) -> Option<[[Turn; 3]; 4]> {
    let (length, beside) = (second.length, (x * x + y * y).sqrt());
    if is_no_length(length) || is_no_length(beside) {
        return None;
    }
    let [c, s] = first.twist;
    let height = second.twist[0].signum() * z + second.offset;
    let [p_x, p_y, p_z] = place.map(|x| x.re);
    let along = Linear {
        one: c * (p_z - first.offset) - height,
        c: -s * p_y,
        s: s * p_x,
    };
    let start = Turn {
        c: (x / beside).into(),
        s: (y / beside).into(),
    };
    let ways = along.zeros()?.map(|before| {
        let [x, y] = before.inverse().of([place[0], place[1]]);
        let z = place[2] - first.offset;
        let u = [x - first.length, y * c + z * s];
        let square = u[0] * u[0] + u[1] * u[1];
        let cosine = (square - length * length - beside * beside) / (2.0 * length * beside);
        let elbows = Turn::of_cosine(cosine)?.map(|elbow| {
            let [g_x, g_y] = elbow.of([beside.into(), 0.0.into()]);
            let g = [g_x + length, g_y * second.twist[0].signum()];
            let third = elbow.then(&start.inverse());
            Some([before, Turn::between(g, u)?, third])
        });
        Some([elbows[0]?, elbows[1]?])
    });
    let ([a, b], [c, d]) = (ways[0]?, ways[1]?);
    Some([a, b, c, d])
}

/// The two ways to turn the hand by joints 4, 5 and 6, from the frame of axis 4 before its joint.
fn wrist(arm: &SixTurns, forearm: &Pose, hand: &Pose) -> Option<[[Turn; 3]; 2]> {
    let [_, _, _, fourth, fifth] = &arm.links;
    let axis = back(forearm, hand.column(2));
    // Axis 6 behind joint 5 is (s5 b, -c5 b, a): its height along axis 4 gives c5.
    let ([a4, b4], [a5, b5]) = (fourth.twist, fifth.twist);
    let cosine = (a4 * a5 - axis[2]) / (b4 * b5);
    let ways = Turn::of_cosine(cosine)?.map(|turn5| {
        let seen = fourth.direction([turn5.s * b5, -turn5.c * b5, a5.into()]);
        let turn4 = Turn::between([seen[0], seen[1]], [axis[0], axis[1]])?;
        let frame = arm.frame(*forearm, 3, &[turn4, turn5]);
        let [c, s, _] = back(&frame, hand.column(0));
        Some([turn4, turn5, Turn { c, s }])
    });
    Some([ways[0]?, ways[1]?])
}

/// A direction as it is seen in a frame.
fn back(frame: &Pose, direction: Vector3) -> Vector3 {
    std::array::from_fn(|j| (0..3).map(|i| frame.rotation[i][j] * direction[i]).sum())
}

#[cfg(test)]
mod tests {
    use super::super::test_arms::{check, link};
    use super::*;

    /// PUMA, KR, one with a shoulder of crossing axes, and one whose position part is general.
    #[test]
    fn postures_by_a_spherical_wrist_make_the_hand() {
        for links in [
            [
                link(0.0, 90.0, 0.0),
                link(0.4, 0.0, 0.0),
                link(0.02, -90.0, 0.15),
                link(0.0, 90.0, 0.4),
                link(0.0, -90.0, 0.0),
            ],
            [
                link(0.025, -90.0, 0.4),
                link(0.455, 0.0, 0.0),
                link(0.035, -90.0, 0.0),
                link(0.0, 90.0, 0.42),
                link(0.0, -90.0, 0.0),
            ],
            [
                link(0.3, 0.0, 0.1),
                link(0.25, 40.0, 0.1),
                link(0.1, 90.0, 0.0),
                link(0.0, 60.0, 0.3),
                link(0.0, 70.0, 0.0),
            ],
            [
                link(0.2, 60.0, 0.1),
                link(0.35, 70.0, -0.2),
                link(0.1, 80.0, 0.15),
                link(0.0, 100.0, 0.3),
                link(0.0, -75.0, 0.0),
            ],
        ] {
            let arm = SixTurns { links };
            assert!(fits(&arm));
            check(&arm, postures, 8);
        }
    }

    #[test]
    fn an_aligned_wrist_is_refused() {
        let arm = SixTurns {
            links: [
                link(0.0, 90.0, 0.0),
                link(0.4, 0.0, 0.0),
                link(0.02, -90.0, 0.15),
                link(0.0, 90.0, 0.4),
                link(0.0, -90.0, 0.0),
            ],
        };
        let turn = |c: f64, s: f64| Turn {
            c: c.into(),
            s: s.into(),
        };
        let turns = [
            turn(0.6, 0.8),
            turn(0.8, 0.6),
            turn(0.0, 1.0),
            turn(0.6, -0.8),
            turn(1.0, 0.0),
            turn(0.8, -0.6),
        ];
        assert_eq!(postures(&arm, &arm.hand(&turns)), None);
    }
}
