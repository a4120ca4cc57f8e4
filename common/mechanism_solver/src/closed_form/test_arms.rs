//! Arms and turns for the tests of decompositions.

use super::six_turns::{Link, SixTurns};
use super::turn::{Turn, Turns};
use cognate_kinematics::mechanism::pose::Pose;
use cognate_numeric::random::{Purpose, RandomStream};

/// A link by length, twist in degrees, and offset.
pub fn link(length: f64, twist: f64, offset: f64) -> Link {
    let [c, s] = cognate_kinematics::mechanism::exact::Angle::of_degrees(twist).direction;
    Link {
        length,
        twist: [c, s],
        offset,
    }
}

/// Real turns at random.
pub fn turns(random: &mut RandomStream) -> Turns {
    std::array::from_fn(|_| {
        let z = random.unit();
        Turn {
            c: z.re.into(),
            s: z.im.into(),
        }
    })
}

/// Checks that a decomposition finds the turns by which a hand was made, for most hands, and that whatever it finds makes
/// the hand.
pub fn check(
    arm: &SixTurns,
    decomposition: impl Fn(&SixTurns, &Pose) -> Option<Vec<Turns>>,
    count: usize,
) {
    let mut random = RandomStream::new(1, Purpose::Test, 74);
    let mut refused = 0;
    for _ in 0..200 {
        let made_by = turns(&mut random);
        let hand = arm.hand(&made_by);
        let Some(postures) = decomposition(arm, &hand) else {
            refused += 1;
            continue;
        };
        assert_eq!(postures.len(), count);
        let apart = |posture: &Turns| {
            let pairs = posture.iter().zip(&made_by);
            let squares = pairs.map(|(a, b)| (a.c - b.c).norm_sqr() + (a.s - b.s).norm_sqr());
            squares.fold(0.0, f64::max).sqrt()
        };
        let nearest = postures.iter().map(apart).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-7, "{nearest:e}");
        for posture in &postures {
            let growth: f64 = posture.iter().map(|turn| 2.0 * turn.size()).product();
            let gap = arm.hand(posture).distance(&hand, 1.0);
            assert!(gap < 1e-9 * growth, "{gap:e} {growth:e}");
        }
    }
    assert!(refused < 4, "{refused}");
}
