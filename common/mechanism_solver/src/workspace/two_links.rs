//! Points of two links in series: both elbows in closed form; whether there are any is decided by exact numbers.

use super::elbows::{Elbows, elbows};
use super::planar_chain::{BORDER, PlanarChain, squared_distance};
use super::reach::violations;
use super::reached_point::ReachedPoint;
use cognate_kinematics::mechanism::exact::Number;
use cognate_kinematics::plane::{common_chord, modulus};
use cognate_numeric::rational::Rational;
use num_complex::Complex64;
use std::cmp::Ordering;

/// Reachability of a point for a chain of two links; `None` for another chain, and if a link has no length.
pub fn reached(chain: &PlanarChain, point: [f64; 2]) -> Option<ReachedPoint> {
    let free = chain.free();
    let lengths: [f64; 2] = free.lengths().try_into().ok()?;
    let none = BORDER * chain.size();
    if lengths.iter().any(|length| *length <= none) {
        return None;
    }
    let tip = Complex64::new(point[0], point[1]);
    let is_within = |ways: [Complex64; 2]| violations(&free, &ways).is_empty();
    let bent = |elbow: Complex64| [elbow - chain.base, tip - elbow];
    Some(
        match (
            elbows(chain.base, tip, lengths, none),
            stretch(chain, point),
        ) {
            (_, Stretch::AtBase) => {
                // Folded, and turned anywhere: the turn of the second joint is the same in all postures.
                let fold = chain.links[0];
                let is_folded_within = !violations(&free, &[fold, -fold]).contains(&1);
                match chain.turns[0].range {
                    Some([low, high]) if low == high && is_folded_within => ReachedPoint {
                        within_limits: Some(1),
                        ..ReachedPoint::uncounted(true)
                    },
                    _ => ReachedPoint::uncounted(is_folded_within),
                }
            }
            (_, Stretch::OnLine) => {
                let way = tip - chain.base;
                let distance = modulus(way);
                let [along, _] = common_chord(distance, lengths);
                let elbow = chain.base + way * (along / distance);
                ReachedPoint::counted(1, u64::from(is_within(bent(elbow))))
            }
            (Elbows::None, _) => ReachedPoint::counted(0, 0),
            (Elbows::Border, _) => {
                ReachedPoint::in_doubt("in doubt: the point is at the border of the reach".into())
            }
            (Elbows::Two(both), _) => {
                let within = both.into_iter().filter(|elbow| is_within(bent(*elbow)));
                ReachedPoint::counted(2, within.count() as u64)
            }
        },
    )
}

/// How the links lie where they make a point, by exact numbers.
enum Stretch {
    /// The point is that of the first joint, and the links are equal.
    AtBase,
    /// The links are on one line.
    OnLine,
    /// The links make a triangle or do not reach, or the numbers are not exact.
    Other,
}

/// For squared lengths a, b and the squared distance d the links are on one line where (d - a - b)^2 = 4 a b.
fn stretch(chain: &PlanarChain, point: [f64; 2]) -> Stretch {
    let point = point.map(as_written);
    let [first, second, distance] = [
        chain.square(0, 1),
        chain.square(1, 2),
        squared_distance(&chain.places[0], &point),
    ];
    let (Some(first), Some(second), Some(distance)) = (first, second, distance) else {
        return Stretch::Other;
    };
    let difference = Rational::from(&distance - &first) - &second;
    let product = Rational::from(&first * &second) * 4;
    match (difference.clone() * difference).cmp(&product) {
        Ordering::Equal if distance == 0 => Stretch::AtBase,
        Ordering::Equal => Stretch::OnLine,
        _ => Stretch::Other,
    }
}

/// The shortest decimal that is read as this double: the number that was written, up to 15 digits.
fn as_written(x: f64) -> Number {
    Number::read(&format!("{x:?}")).unwrap_or_else(|| Number::of_double(x))
}
