//! The coupler curve as points, circuit by circuit, for drawings.

use crate::linkage::Linkage;
use crate::plane::{arc, cross, modulus, unit};
use num_complex::Complex64;

/// Points of a circuit's half; a power of 2, as [`arc`] wants it.
const HALF: usize = 512;

/// One circuit of a coupler curve: a closed line.
#[derive(Clone, Debug, PartialEq)]
pub struct Circuit {
    /// Points of the circuit, the last one near the first.
    pub points: Vec<Complex64>,
}

/// All circuits of a linkage's coupler curve.
///
/// The link on side A is taken through its directions; where it cannot turn round, they are
/// denser at its dead centres, where the rest moves fast.
pub fn circuits(linkage: &Linkage) -> Vec<Circuit> {
    let l = linkage.lengths();
    let (ground, side, coupler, driven) = (l.ground, l.sides[0], l.coupler, l.sides[1]);
    let toward = (ground - side).abs() < (coupler - driven).abs();
    let away = ground + side > coupler + driven;
    // The direction, against the ground, at which the rest spans this distance.
    let at = |distance: f64| {
        let cosine = (ground * ground + side * side - distance * distance) / (2.0 * ground * side);
        let cosine = cosine.clamp(-1.0, 1.0);
        Complex64::new(cosine, (1.0 - cosine * cosine).max(0.0).sqrt())
    };
    let (near, far) = (at((coupler - driven).abs()), at(coupler + driven));
    let one = Complex64::new(1.0, 0.0);
    let ranges = match (toward, away) {
        (false, false) => {
            let half = arc(one, -one, HALF + 1);
            let back = half.iter().map(|z| -z);
            let round: Vec<Complex64> = half.iter().copied().chain(back.skip(1)).collect();
            return [1.0, -1.0]
                .map(|sign| Circuit {
                    points: round.iter().map(|&w| point(linkage, w, sign)).collect(),
                })
                .into();
        }
        (true, true) => vec![(near, far), (far.conj(), near.conj())],
        (true, false) => vec![(near, near.conj())],
        (false, true) => vec![(far.conj(), far)],
    };
    let closed = |(low, high): (Complex64, Complex64)| {
        let fine = arc(low, high, 8 * HALF + 1);
        // 3 t^2 - 2 t^3: slow at both ends.
        let place = |k: usize| {
            let t = k as f64 / HALF as f64;
            (t * t * (3.0 - 2.0 * t) * (8 * HALF) as f64).round() as usize
        };
        let there = (0..=HALF).map(|k| point(linkage, fine[place(k)], 1.0));
        let back = (0..=HALF)
            .rev()
            .map(|k| point(linkage, fine[place(k)], -1.0));
        Circuit {
            points: there.chain(back).collect(),
        }
    };
    ranges.into_iter().map(closed).collect()
}

/// The coupler point where side A points there, against the ground; `sign` as in
/// [`Linkage::assembly`].
fn point(linkage: &Linkage, direction: Complex64, sign: f64) -> Complex64 {
    let l = linkage.lengths();
    let ground = unit(linkage.pivots[1] - linkage.pivots[0]);
    let joint = linkage.pivots[0] + ground * direction * l.sides[0];
    let way = linkage.pivots[1] - joint;
    let distance = modulus(way);
    let along =
        (distance * distance + l.coupler * l.coupler - l.sides[1] * l.sides[1]) / (2.0 * distance);
    let across = (l.coupler * l.coupler - along * along).max(0.0).sqrt();
    let other = joint + way / distance * Complex64::new(along, sign * across);
    debug_assert!(cross(joint - other, linkage.pivots[1] - other) * sign >= -1e-9 * distance);
    let shape = (linkage.point - linkage.joints[0]) / (linkage.joints[1] - linkage.joints[0]);
    joint + (other - joint) * shape
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_linkages::{at_points, random_linkage};

    #[test]
    fn curves_are_closed_and_pass_every_position() {
        for seed in 0..100 {
            let linkage = random_linkage(seed);
            let circuits = circuits(&linkage);
            assert_eq!(
                circuits.len(),
                linkage.lengths().mobility().circuits(),
                "seed {seed}"
            );
            let mut longest = 0.0f64;
            for circuit in &circuits {
                let points = &circuit.points;
                let steps = points.windows(2).map(|w| modulus(w[1] - w[0]));
                longest = steps.fold(longest, f64::max);
                let gap = modulus(points[0] - points[points.len() - 1]);
                assert!(gap < 1e-5, "seed {seed}: {gap:e}");
            }
            for pose in at_points(&linkage, seed, 9) {
                let gaps = circuits.iter().flat_map(|c| &c.points);
                let gap = gaps
                    .map(|p| modulus(p - pose.point))
                    .fold(f64::INFINITY, f64::min);
                assert!(gap <= longest, "seed {seed}: {gap:e}, {longest:e}");
            }
        }
    }
}
