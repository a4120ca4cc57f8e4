//! Body guidance: every four-bar linkage that takes a body through five given poses (Burmester
//! 1888: at most four dyads, six linkages).
//!
//! A dyad is a fixed pivot and a joint on the body that stays as far from it. With the first pose
//! as the frame, a the pivot and b the joint, pose j given by its place d_j and its turn f_j:
//! |d_j + f_j b - a| = |b - a|, in isotropic coordinates
//! `d D + d F B + D f b - d A - D a + b A (1 - f) + a B (1 - F) = 0`: bilinear in (a, A), (b, B).

use crate::design::{Design, ranked};
use crate::four_unknowns::bilinear_system;
use crate::linkage::{Linkage, Side};
use crate::plane::{modulus, real_place, scale, unit};
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Solutions for generic poses; two more paths of the two-homogeneous start end at infinity.
pub const DYADS: u64 = 4;

/// Places or turns nearer to each other than this, relative to the extent, are one.
const COINCIDENT: f64 = 1e-10;

/// Five poses of a body, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Poses {
    places: [Complex64; 5],
    turns: [Complex64; 5],
    /// Divisor of the places in the system: a power of 2.
    scale: f64,
}

/// Why five poses cannot be used; numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PoseFault {
    /// A number is infinite or not a number.
    #[error("pose {} is not finite", .0 + 1)]
    NotFinite(usize),
    /// Two of them are one.
    #[error(
        "poses {} and {} are the same; expected five different ones: four are passed by a curve \
         of dyads, not by a list", .0 + 1, .1 + 1
    )]
    Same(usize, usize),
    /// All turns are equal, or all places.
    #[error("the poses do not {0}: any dyad of a whole family guides the body")]
    Trivial(&'static str),
    /// Differences of the places overflow or vanish in double precision.
    #[error("the places' extent is {0:e}; expected a number from 1e-290 to 1e290")]
    Extent(f64),
}

/// The equation of one pose: of a dyad with pivot a and joint b, for the place d and the turn f.
fn equation(
    e: &mut Expressions,
    [a, aa, b, bb]: [NodeId; 4],
    [d, dd, f, ff]: [NodeId; 4],
) -> NodeId {
    let one = e.integer(1);
    let (ba, ab) = (e.multiply(b, aa), e.multiply(a, bb));
    let (rest, rest_too) = (e.subtract(one, f), e.subtract(one, ff));
    let (dff, ddf) = (e.multiply(d, ff), e.multiply(dd, f));
    let terms = [
        e.multiply(d, dd),
        e.multiply(dff, bb),
        e.multiply(ddf, b),
        e.multiply(ba, rest),
        e.multiply(ab, rest_too),
    ];
    let less = [e.multiply(d, aa), e.multiply(dd, a)];
    let sum = terms[1..].iter().fold(terms[0], |sum, &t| e.add(sum, t));
    less.iter().fold(sum, |sum, &t| e.subtract(sum, t))
}

/// The system: unknowns a, A, b, B, parameters d1, D1, f1, F1, ..., d4, D4, f4, F4.
pub fn system() -> System {
    let (unknowns, parameters) = (["a", "A", "b", "B"], ["d", "D", "f", "F"]);
    let groups = [[0, 1], [2, 3]];
    bilinear_system(unknowns, groups, "pose", parameters, equation)
}

impl Poses {
    /// Checks and scales; turns are taken as unit vectors.
    pub fn new(places: [Complex64; 5], turns: [Complex64; 5]) -> Result<Self, PoseFault> {
        let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
        if let Some(k) = (0..5).find(|&k| !finite(&places[k]) || !finite(&turns[k])) {
            return Err(PoseFault::NotFinite(k));
        }
        let turns = turns.map(unit);
        let extent = places
            .iter()
            .map(|&p| modulus(p - places[0]))
            .fold(0.0, f64::max);
        let turned = turns
            .iter()
            .map(|&t| modulus(t - turns[0]))
            .fold(0.0, f64::max);
        if turned <= COINCIDENT {
            return Err(PoseFault::Trivial("turn"));
        }
        if extent == 0.0 {
            return Err(PoseFault::Trivial("move"));
        }
        for j in 0..5 {
            for k in j + 1..5 {
                let apart = modulus(places[j] - places[k]) > COINCIDENT * extent;
                if !apart && modulus(turns[j] - turns[k]) <= COINCIDENT {
                    return Err(PoseFault::Same(j, k));
                }
            }
        }
        let scale = scale(extent).ok_or(PoseFault::Extent(extent))?;
        Ok(Self {
            places,
            turns,
            scale,
        })
    }

    /// Where the body's origin is.
    pub fn places(&self) -> &[Complex64; 5] {
        &self.places
    }

    /// How the body is turned, as unit vectors.
    pub fn turns(&self) -> &[Complex64; 5] {
        &self.turns
    }

    /// Divisor of the places in the system: a power of 2, about the extent of the places.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The parameters of the system.
    pub fn parameters(&self) -> Vec<Complex64> {
        let back = self.turns[0].conj();
        let poses = self.places.iter().zip(&self.turns).skip(1);
        poses
            .flat_map(|(place, turn)| {
                let d = (place - self.places[0]) / self.scale * back;
                let f = unit(turn * back);
                [d, d.conj(), f, f.conj()]
            })
            .collect()
    }

    /// A real dyad's pivot and joint: in the plane, the joint where it is in the first pose.
    pub fn dyad(&self, solution: &[Complex64; 4]) -> [Complex64; 2] {
        let [a, aa, b, bb] = *solution;
        [real_place(a, aa), real_place(b, bb)]
            .map(|z| self.places[0] + z * self.turns[0] * self.scale)
    }

    /// Every pair of dyads as a linkage, best first.
    pub fn linkages(&self, dyads: &[[Complex64; 2]]) -> Vec<Design> {
        let pairs =
            (0..dyads.len()).flat_map(|one| (one + 1..dyads.len()).map(move |two| [one, two]));
        let made = pairs.map(|[one, two]| self.linkage([one, two], [dyads[one], dyads[two]], None));
        ranked(made.collect())
    }

    /// The linkage of two dyads, which have these places in a list, driven from a side or from the better.
    pub fn linkage(
        &self,
        which: [usize; 2],
        dyads: [[Complex64; 2]; 2],
        driver: Option<Side>,
    ) -> Design {
        let positions = linkage_through(self.places.iter().zip(&self.turns), dyads);
        Design::new(which, positions, self.scale, driver)
    }
}

/// The positions of the linkage of two dyads, given in the first pose, in these places and turns of its coupler.
///
/// # Panics
/// When there is no pose.
pub fn linkage_through<'a>(
    poses: impl Iterator<Item = (&'a Complex64, &'a Complex64)> + Clone,
    dyads: [[Complex64; 2]; 2],
) -> Vec<Linkage> {
    let (first_place, first_turn) = poses.clone().next().expect("a pose");
    let position = |(&place, turn): (&Complex64, &Complex64)| {
        let turned = turn * first_turn.conj();
        Linkage {
            pivots: dyads.map(|[pivot, _]| pivot),
            joints: dyads.map(|[_, joint]| place + (joint - first_place) * turned),
            point: place,
        }
    };
    poses.map(position).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_linkages::{at_points, random_linkage, residual};

    #[test]
    fn the_dyads_of_a_linkage_solve_its_poses() {
        let system = system();
        for seed in 0..50 {
            let linkage = random_linkage(seed);
            let at = at_points(&linkage, seed, 5);
            let places: Vec<Complex64> = at.iter().map(|pose| pose.point).collect();
            let first = linkage.joints[1] - linkage.joints[0];
            let turns: Vec<Complex64> = at
                .iter()
                .map(|pose| (pose.joints[1] - pose.joints[0]) / first)
                .collect();
            let poses = Poses::new(places.try_into().expect("5"), turns.try_into().expect("5"));
            let poses = poses.expect("five poses");
            let dyads = [0, 1].map(|k| {
                let z = |w: Complex64| (w - linkage.point) / poses.scale;
                let (a, b) = (z(linkage.pivots[k]), z(linkage.joints[k]));
                let solution = [a, a.conj(), b, b.conj()];
                let left = residual(&system, &solution, &poses.parameters());
                assert!(left < 1e-10, "seed {seed}: {left:e}");
                poses.dyad(&solution)
            });
            let made = poses.linkages(&dyads);
            assert_eq!(made.len(), 1);
            assert!(made[0].error < 1e-10, "seed {seed}: {:e}", made[0].error);
            for (position, pose) in made[0].positions.iter().zip(&at) {
                assert!((0..2).all(|k| modulus(position.joints[k] - pose.joints[k]) < 1e-9));
            }
        }
    }

    #[test]
    fn bad_poses_are_named() {
        let places: [Complex64; 5] = std::array::from_fn(|k| Complex64::new(k as f64, 1.0));
        let turns: [Complex64; 5] = std::array::from_fn(|k| Complex64::new(1.0, k as f64));
        assert!(Poses::new(places, turns).is_ok());
        let straight = [Complex64::new(2.0, 0.0); 5];
        assert_eq!(
            Poses::new(places, straight),
            Err(PoseFault::Trivial("turn"))
        );
        assert_eq!(
            Poses::new([places[0]; 5], turns),
            Err(PoseFault::Trivial("move"))
        );
        let (mut same, mut turned) = (places, turns);
        (same[4], turned[4]) = (places[1], turns[1] * 3.0);
        assert_eq!(Poses::new(same, turned), Err(PoseFault::Same(1, 4)));
        same[2].re = f64::INFINITY;
        assert_eq!(Poses::new(same, turned), Err(PoseFault::NotFinite(2)));
    }
}
