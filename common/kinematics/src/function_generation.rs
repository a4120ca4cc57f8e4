//! Function generation: every four-bar linkage whose two sides turn together through five given
//! pairs of angles (Freudenstein 1954; Wampler and Sommese 2011, section 4).
//!
//! The pivots are 0 and 1, z and w the sides in the first position; turned by t_j and s_j the
//! coupler 1 + w s_j - z t_j keeps its length, in isotropic coordinates
//! `w (s-1) + W (S-1) - z (t-1) - Z (T-1) - w Z (s T - 1) - z W (t S - 1) = 0`: bilinear in (z, w),
//! (Z, W). The root 0 is no linkage.

use crate::design::Design;
use crate::four_unknowns::bilinear_system;
use crate::linkage::{Linkage, Side};
use crate::plane::{modulus, real_place, unit};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Linkages for generic angles, in units of the ground; one more root is 0.
pub const LINKAGES: u64 = 3;

/// Turns nearer to each other than this are one.
const COINCIDENT: f64 = 1e-10;
/// Sides shorter than this, in units of the ground, are the root 0.
const NO_LINKAGE: f64 = 1e-8;

/// Five pairs of angles, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct AnglePairs {
    pairs: [[Complex64; 2]; 5],
}

/// Why five pairs of angles cannot be used; numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AngleFault {
    /// A number is infinite or not a number.
    #[error("pair {} is not finite", .0 + 1)]
    NotFinite(usize),
    /// Two of them are one.
    #[error("pairs {} and {} are the same; expected five different ones", .0 + 1, .1 + 1)]
    Same(usize, usize),
    /// One side does not turn, or both turn alike.
    #[error("{0}: a whole family of linkages does that")]
    Trivial(&'static str),
}

/// The system: unknowns z, Z, w, W, parameters t1, T1, s1, S1, ..., t4, T4, s4, S4.
pub fn system() -> System {
    let parameters = ["t", "T", "s", "S"];
    bilinear_system(
        ["z", "Z", "w", "W"],
        [[0, 2], [1, 3]],
        "pair",
        parameters,
        |e, [z, zz, w, ww], [t, tt, s, ss]| {
            let one = e.integer(1);
            let (stt, tss) = (e.multiply(s, tt), e.multiply(t, ss));
            let (wzz, zww) = (e.multiply(w, zz), e.multiply(z, ww));
            let turned = [s, ss, t, tt, stt, tss].map(|turn| e.subtract(turn, one));
            let [a, b, c, d, f, g] = [w, ww, z, zz, wzz, zww];
            let mut terms = [a, b, c, d, f, g].into_iter().zip(turned);
            let mut product = || {
                let (factor, turn) = terms.next().expect("six terms");
                e.multiply(factor, turn)
            };
            let [plus, plus_too] = [product(), product()];
            let less = [product(), product(), product(), product()];
            let sum = e.add(plus, plus_too);
            less.iter().fold(sum, |sum, &term| e.subtract(sum, term))
        },
    )
}

impl AnglePairs {
    /// Checks: input and output directions, taken as unit vectors.
    pub fn new(pairs: [[Complex64; 2]; 5]) -> Result<Self, AngleFault> {
        let finite = |z: &Complex64| z.re.is_finite() && z.im.is_finite();
        if let Some(k) = (0..5).find(|&k| !pairs[k].iter().all(finite)) {
            return Err(AngleFault::NotFinite(k));
        }
        let pairs = pairs.map(|pair| pair.map(unit));
        let same = |z: Complex64, w: Complex64| modulus(z - w) <= COINCIDENT;
        for j in 0..5 {
            for k in j + 1..5 {
                if (0..2).all(|side| same(pairs[j][side], pairs[k][side])) {
                    return Err(AngleFault::Same(j, k));
                }
            }
        }
        let from_first = |k: usize, side: usize| pairs[k][side] * pairs[0][side].conj();
        let one = Complex64::new(1.0, 0.0);
        for (side, fault) in [
            (0, "the input does not turn"),
            (1, "the output does not turn"),
        ] {
            if (1..5).all(|k| same(from_first(k, side), one)) {
                return Err(AngleFault::Trivial(fault));
            }
        }
        if (1..5).all(|k| same(from_first(k, 0), from_first(k, 1))) {
            return Err(AngleFault::Trivial("input and output turn alike"));
        }
        Ok(Self { pairs })
    }

    /// Input and output, as unit vectors.
    pub fn pairs(&self) -> &[[Complex64; 2]; 5] {
        &self.pairs
    }

    /// How far both sides have turned since the first position.
    fn turned(&self, k: usize) -> [Complex64; 2] {
        [0, 1].map(|side| unit(self.pairs[k][side] * self.pairs[0][side].conj()))
    }

    /// The parameters of the system.
    pub fn parameters(&self) -> Vec<Complex64> {
        let turned = (1..5).map(|k| self.turned(k));
        turned
            .flat_map(|[t, s]| [t, t.conj(), s, s.conj()])
            .collect()
    }

    /// A real solution as a linkage in its five positions, side A the input; `None` for the root 0.
    /// The coupler point is the middle of the coupler.
    pub fn linkage(&self, solution: &[Complex64; 4]) -> Option<Design> {
        let [z, zz, w, ww] = *solution;
        let (z, w) = (real_place(z, zz), real_place(w, ww));
        if modulus(z) < NO_LINKAGE && modulus(w) < NO_LINKAGE {
            return None;
        }
        let pivots = [Complex64::default(), Complex64::new(1.0, 0.0)];
        let positions = (0..5).map(|k| {
            let [t, s] = self.turned(k);
            let joints = [pivots[0] + z * t, pivots[1] + w * s];
            Linkage {
                pivots,
                joints,
                point: (joints[0] + joints[1]) / 2.0,
            }
        });
        Some(Design::new([0, 1], positions.collect(), 1.0, Some(Side::A)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_linkages::{at_points, random_linkage, residual};

    #[test]
    fn a_linkage_solves_the_angles_of_its_sides() {
        for seed in 0..50 {
            let linkage = random_linkage(seed);
            let at = at_points(&linkage, seed, 5);
            let ground = linkage.pivots[1] - linkage.pivots[0];
            let side = |k: usize, side: usize| at[k].joints[side] - at[k].pivots[side];
            let pairs = std::array::from_fn(|k| [side(k, 0), side(k, 1)]);
            let pairs = AnglePairs::new(pairs).expect("five pairs");
            let (z, w) = (side(0, 0) / ground, side(0, 1) / ground);
            let solution = [z, z.conj(), w, w.conj()];
            let left = residual(&system(), &solution, &pairs.parameters());
            assert!(left < 1e-9, "seed {seed}: {left:e}");
            let made = pairs.linkage(&solution).expect("a linkage");
            assert!(made.error < 1e-9, "seed {seed}: {:e}", made.error);
            for (position, expected) in made.positions.iter().zip(&at) {
                for k in [0, 1] {
                    let placed = linkage.pivots[0] + position.joints[k] * ground;
                    assert!(modulus(placed - expected.joints[k]) < 1e-9, "seed {seed}");
                }
            }
        }
        let zero = [Complex64::default(); 4];
        let turns = std::array::from_fn(|k| {
            [
                Complex64::new(1.0, k as f64),
                Complex64::new(1.0, -(k as f64)),
            ]
        });
        let pairs = AnglePairs::new(turns).expect("five pairs");
        assert!(residual(&system(), &zero, &pairs.parameters()) == 0.0);
        assert_eq!(pairs.linkage(&zero), None);
    }

    #[test]
    fn bad_pairs_are_named() {
        let at = |k: usize| Complex64::new(1.0, k as f64);
        let pairs: [[Complex64; 2]; 5] = std::array::from_fn(|k| [at(k), at(2 * k)]);
        assert!(AnglePairs::new(pairs).is_ok());
        let still = pairs.map(|[input, _]| [input, at(3)]);
        let fault = AngleFault::Trivial("the output does not turn");
        assert_eq!(AnglePairs::new(still), Err(fault));
        let alike = pairs.map(|[input, _]| [input, input * at(1)]);
        let fault = AngleFault::Trivial("input and output turn alike");
        assert_eq!(AnglePairs::new(alike), Err(fault));
        let mut wrong = pairs;
        wrong[4] = pairs[1].map(|z| z * 3.0);
        assert_eq!(AnglePairs::new(wrong), Err(AngleFault::Same(1, 4)));
        wrong[2][1].re = f64::NAN;
        assert_eq!(AnglePairs::new(wrong), Err(AngleFault::NotFinite(2)));
    }
}
