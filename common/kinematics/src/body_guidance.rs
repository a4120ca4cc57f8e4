//! Body guidance: every four-bar linkage that takes a body through five given poses (Burmester
//! 1888: at most four dyads, six linkages).
//!
//! A dyad is a fixed pivot and a joint on the body that stays as far from it. With the first pose
//! as the frame, a the pivot and b the joint, pose j given by its place d_j and its turn f_j:
//! |d_j + f_j b - a| = |b - a|, in isotropic coordinates
//! `d D + d F B + D f b - d A - D a + b A (1 - f) + a B (1 - F) = 0`: bilinear in (a, A), (b, B).

use crate::assessment::Assessment;
use crate::linkage::Linkage;
use crate::plane::{modulus, unit};
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::system::{System, VariableGroup};
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
    /// What places are divided by: a power of 2.
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

/// The system: unknowns a, A, b, B, parameters d1, D1, f1, F1, ..., d4, D4, f4, F4.
pub fn system() -> System {
    let mut e = Expressions::new();
    let v: Vec<NodeId> = (0..4).map(|k| e.variable(k)).collect();
    let [a, aa, b, bb] = v[..] else {
        unreachable!("four variables")
    };
    let one = e.integer(1);
    let (ba, ab) = (e.multiply(b, aa), e.multiply(a, bb));
    let equations = (0..4)
        .map(|j| {
            let [d, dd, f, ff] = [0, 1, 2, 3].map(|k| e.parameter(4 * j + k));
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
        })
        .collect();
    let group = |variables: [usize; 2]| VariableGroup {
        variables: variables.to_vec(),
        homogeneous: false,
    };
    let system = System {
        expressions: e,
        variables: ["a", "A", "b", "B"].map(str::to_owned).to_vec(),
        parameters: (1..=4)
            .flat_map(|j| ["d", "D", "f", "F"].map(|s| format!("{s}{j}")))
            .collect(),
        groups: vec![group([0, 1]), group([2, 3])],
        equations,
        equation_names: (1..=4).map(|j| format!("pose{}", j + 1)).collect(),
        conjugates: vec![(0, 1), (2, 3)],
        ..System::default()
    };
    if let Err(error) = system.check() {
        panic!("the system of a dyad is a system: {error}");
    }
    system
}

/// A linkage of two dyads that guides the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    /// The dyads that it is made of, by their places in the list.
    pub dyads: [usize; 2],
    /// Its positions; the coupler point is the body's origin.
    pub poses: Vec<Linkage>,
    /// The largest error of a side's length in any of them, relative to the places' extent.
    pub error: f64,
    /// What it is worth.
    pub assessment: Assessment,
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
        if !(1e-290..=1e290).contains(&extent) {
            return Err(PoseFault::Extent(extent));
        }
        let scale = f64::from_bits(extent.to_bits() & (0x7ff << 52));
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
        let real = |z: Complex64, conjugate: Complex64| (z + conjugate.conj()) / 2.0;
        let [a, aa, b, bb] = *solution;
        [real(a, aa), real(b, bb)].map(|z| self.places[0] + z * self.turns[0] * self.scale)
    }

    /// Every pair of dyads as a linkage, best first.
    pub fn guides(&self, dyads: &[[Complex64; 2]]) -> Vec<Guide> {
        let mut guides = Vec::new();
        for one in 0..dyads.len() {
            for two in one + 1..dyads.len() {
                guides.push(self.guide([one, two], [dyads[one], dyads[two]]));
            }
        }
        guides.sort_by(|one, two| {
            let (one, two) = (&one.assessment, &two.assessment);
            let grades = one.grade.cmp(&two.grade);
            grades.then(two.quality().total_cmp(&one.quality()))
        });
        guides
    }

    fn guide(&self, which: [usize; 2], dyads: [[Complex64; 2]; 2]) -> Guide {
        let pivots = dyads.map(|[pivot, _]| pivot);
        let poses: Vec<Linkage> = self
            .places
            .iter()
            .zip(&self.turns)
            .map(|(&place, turn)| {
                let turned = turn * self.turns[0].conj();
                Linkage {
                    pivots,
                    joints: dyads.map(|[_, joint]| place + (joint - self.places[0]) * turned),
                    point: place,
                }
            })
            .collect();
        let sides = poses[0].lengths().sides;
        let off = |pose: &Linkage| {
            let now = pose.lengths().sides;
            (now[0] - sides[0]).abs().max((now[1] - sides[1]).abs())
        };
        let error = poses.iter().map(off).fold(0.0, f64::max) / self.scale;
        Guide {
            dyads: which,
            error,
            assessment: Assessment::new(&poses),
            poses,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_linkages::{at_points, random_linkage};
    use cognate_numeric::scalar::Complex;
    use cognate_systems::evaluation::{Evaluate, Interpreter};

    #[test]
    fn the_dyads_of_a_linkage_solve_its_poses() {
        let system = system();
        let program = Interpreter::compile(&system.expressions, &system.equations, 4, 16);
        let mut scratch = Evaluate::<f64>::scratch(&program, ());
        let native = |values: &[Complex64]| -> Vec<Complex<f64>> {
            let values = values.iter();
            values.map(|z| Complex { re: z.re, im: z.im }).collect()
        };
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
                let mut out = vec![Complex { re: 0.0, im: 0.0 }; 4];
                program.value(
                    &native(&solution),
                    &native(&poses.parameters()),
                    &mut out,
                    &mut scratch,
                );
                for value in out {
                    assert!(value.norm_sqr() < 1e-20, "seed {seed}: {value:?}");
                }
                poses.dyad(&solution)
            });
            let guides = poses.guides(&dyads);
            assert_eq!(guides.len(), 1);
            assert!(
                guides[0].error < 1e-10,
                "seed {seed}: {:e}",
                guides[0].error
            );
            for (made, pose) in guides[0].poses.iter().zip(&at) {
                assert!((0..2).all(|k| modulus(made.joints[k] - pose.joints[k]) < 1e-9));
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
