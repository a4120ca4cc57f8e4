//! Path with timing: every four-bar linkage whose coupler point passes five given points while its
//! crank turns by given angles (Roth and Freudenstein 1963; Wampler and Sommese 2011, section 4).
//!
//! The crank z and the arm c from its joint to the coupler point, both in the first position, make
//! one dyad: with d_j the way of the point and t_j the turn of the crank, c's turn
//! (c + d_j - z (t_j - 1)) / c has length 1, in isotropic coordinates
//! `(c + d - z s)(C + D - Z S) = c C` with s = t - 1: bilinear in (z, c), (Z, C). A dyad gives the
//! turns of the coupler, so five poses, of which it is one dyad (Burmester) and three others are left.

use crate::body_guidance::{PoseFault, Poses};
use crate::four_unknowns::bilinear_system;
use crate::plane::{modulus, real_place, unit};
use cognate_systems::system::System;
use num_complex::Complex64;

/// Drivers for generic points and angles; each has three partners.
pub const DRIVERS: u64 = 4;

/// Dyads nearer than this, relative to their size and that of the points, are the driver itself.
const SAME: f64 = 1e-6;

/// Largest coordinate of a driver, relative to the size of the points. The directions of the crank are rounded, so that
/// their products with their conjugates are 1 up to rounding only: a solution at infinity becomes one of 1e13 and more.
const LARGEST: f64 = 1e9;

/// Five points of a path, each with the angle of the crank, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedPoints {
    /// The crank's directions stand where a body's turns do: they obey the same rules.
    given: Poses,
}

/// A crank and its coupler: what one real solution is.
#[derive(Clone, Debug, PartialEq)]
pub struct Driver {
    /// Pivot, and joint in the first position.
    pub dyad: [Complex64; 2],
    /// The coupler's poses.
    pub poses: Poses,
}

/// The system: unknowns z, Z, c, C, parameters d1, D1, t1, T1, ..., d4, D4, t4, T4.
pub fn system() -> System {
    let parameters = ["d", "D", "t", "T"];
    bilinear_system(
        ["z", "Z", "c", "C"],
        [[0, 2], [1, 3]],
        "point",
        parameters,
        |e, [z, zz, c, cc], [d, dd, t, tt]| {
            let one = e.integer(1);
            let (s, ss) = (e.subtract(t, one), e.subtract(tt, one));
            let (zs, zzss) = (e.multiply(z, s), e.multiply(zz, ss));
            let (way, way_too) = (e.subtract(d, zs), e.subtract(dd, zzss));
            // (c + w)(C + W) - c C = c W + w C + w W.
            let terms = [
                e.multiply(c, way_too),
                e.multiply(way, cc),
                e.multiply(way, way_too),
            ];
            terms[1..]
                .iter()
                .fold(terms[0], |sum, &term| e.add(sum, term))
        },
    )
}

impl TimedPoints {
    /// Checks and scales; the crank's directions are taken as unit vectors.
    pub fn new(points: [Complex64; 5], cranks: [Complex64; 5]) -> Result<Self, PoseFault> {
        let given = Poses::new(points, cranks)?;
        Ok(Self { given })
    }

    /// The points.
    pub fn points(&self) -> &[Complex64; 5] {
        self.given.places()
    }

    /// The crank's directions, as unit vectors.
    pub fn cranks(&self) -> &[Complex64; 5] {
        self.given.turns()
    }

    /// The parameters of the system.
    pub fn parameters(&self) -> Vec<Complex64> {
        let [first, turn] = [self.points()[0], self.cranks()[0]];
        let given = self.points().iter().zip(self.cranks()).skip(1);
        given
            .flat_map(|(point, crank)| {
                let d = (point - first) / self.given.scale();
                let t = unit(crank * turn.conj());
                [d, d.conj(), t, t.conj()]
            })
            .collect()
    }

    /// Whether a solution is a driver: one that rounding brought from infinity is none.
    pub fn is_finite(&self, solution: &[Complex64; 4]) -> bool {
        solution.iter().all(|z| modulus(*z) <= LARGEST)
    }

    /// A real solution's crank and the poses of its coupler.
    ///
    /// # Errors
    /// When the coupler does not move or turn: then any dyad of a whole family is a partner.
    pub fn driver(&self, solution: &[Complex64; 4]) -> Result<Driver, PoseFault> {
        let [z, zz, c, cc] = *solution;
        let (z, c) = (real_place(z, zz), real_place(c, cc));
        let (first, scale) = (self.points()[0], self.given.scale());
        let turn = |k: usize| {
            let d = (self.points()[k] - first) / scale;
            let t = unit(self.cranks()[k] * self.cranks()[0].conj());
            unit((c + d - z * (t - 1.0)) * c.conj())
        };
        Ok(Driver {
            dyad: [first - (z + c) * scale, first - c * scale],
            poses: Poses::new(*self.points(), std::array::from_fn(turn))?,
        })
    }
}

impl Driver {
    /// Of the dyads that guide the coupler those that are not the driver itself.
    pub fn partners(&self, dyads: &[[Complex64; 2]]) -> Vec<[Complex64; 2]> {
        let size = modulus(self.dyad[0] - self.dyad[1]).max(self.poses.scale());
        let apart = |dyad: &[Complex64; 2]| {
            let ends = dyad.iter().zip(&self.dyad);
            ends.map(|(z, w)| modulus(z - w)).fold(0.0, f64::max) / size
        };
        dyads
            .iter()
            .filter(|dyad| apart(dyad) > SAME)
            .copied()
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linkage::Side;
    use crate::test_linkages::{at_points, random_linkage, residual};

    #[test]
    fn either_side_of_a_linkage_drives_it_through_its_points() {
        for seed in 0..50 {
            let linkage = random_linkage(seed);
            let at = at_points(&linkage, seed, 5);
            let points: [Complex64; 5] = std::array::from_fn(|k| at[k].point);
            for side in [0, 1] {
                let crank = |k: usize| at[k].joints[side] - at[k].pivots[side];
                let given = TimedPoints::new(points, std::array::from_fn(crank)).expect("points");
                let scale = given.given.scale();
                let z = crank(0) / scale;
                let c = (at[0].point - at[0].joints[side]) / scale;
                let solution = [z, z.conj(), c, c.conj()];
                let left = residual(&system(), &solution, &given.parameters());
                assert!(left < 1e-10, "seed {seed}: {left:e}");
                assert!(given.is_finite(&solution));
                let driver = given.driver(&solution).expect("it moves");
                let dyad = |k: usize| [linkage.pivots[k], linkage.joints[k]];
                let off = |one: [Complex64; 2], two: [Complex64; 2]| {
                    modulus(one[0] - two[0]).max(modulus(one[1] - two[1]))
                };
                assert!(off(driver.dyad, dyad(side)) < 1e-9, "seed {seed}");
                // The coupler's poses are guided by both of its dyads; one is the driver.
                let both = [dyad(0), dyad(1)];
                assert_eq!(driver.partners(&both), [dyad(1 - side)], "seed {seed}");
                let made = driver.poses.linkage([0, 1], both, Some(Side::A));
                assert!(made.error < 1e-9, "seed {seed}: {:e}", made.error);
                for (position, expected) in made.positions.iter().zip(&at) {
                    assert!(off(position.joints, expected.joints) < 1e-9, "seed {seed}");
                }
            }
        }
    }
}
