//! Elbows of two links between two points: where two circles meet.

use cognate_kinematics::plane::{common_chord, modulus};
use num_complex::Complex64;

/// Where the joint between two links is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elbows {
    /// The points are too far apart or too near for the links.
    None,
    /// The links lie on one line, up to the distance that counts as none, or fold onto each other between equal points.
    Border,
    /// To the left of the way from one point to the other, and to its right.
    Two([Complex64; 2]),
}

/// The elbows of links of these lengths from one point to the other; distances below `none` are none.
pub fn elbows(from: Complex64, to: Complex64, [first, second]: [f64; 2], none: f64) -> Elbows {
    let way = to - from;
    let apart = modulus(way);
    let (sum, difference) = (first + second, (first - second).abs());
    if apart > sum + none || apart < difference - none {
        return Elbows::None;
    }
    if apart > sum - none || apart < difference + none {
        return Elbows::Border;
    }
    let toward = way / apart;
    let [along, aside] = common_chord(apart, [first, second]);
    Elbows::Two([aside, -aside].map(|aside| from + toward * Complex64::new(along, aside)))
}
