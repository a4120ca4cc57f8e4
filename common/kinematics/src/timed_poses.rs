//! Body guidance with timing: the four-bar linkages that take a body through three given poses while the crank turns by
//! given angles.
//!
//! With the first pose as the frame, d_j the place and f_j the turn of pose j, t_j the turn of the crank, a crank with pivot a
//! and joint b has b' = d_j + f_j b = a + t_j (b - a): two poses after the first are two linear equations
//! `a (t_j - 1) + b (f_j - t_j) = -d_j` (Sandor and Erdman: Advanced Mechanism Design, 1984, section 3.2). A driven link
//! with a chosen pivot p has |d_j + f_j b - p| = |b - p|, two real linear equations for its joint b.

use crate::body_guidance::{PoseFault, linkage_through};
use crate::design::Design;
use crate::linkage::Side;
use crate::plane::{cross, modulus, scale, unit};
use num_complex::Complex64;

/// Determinants below this, in units of their terms, are 0: nothing or a whole family solves the equations.
const ZERO: f64 = 1e-10;
/// Places or turns nearer to each other than this, relative to the extent, are one.
const COINCIDENT: f64 = 1e-10;

/// Three poses of a body with the direction of the crank at each.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedPoses {
    places: [Complex64; 3],
    turns: [Complex64; 3],
    cranks: [Complex64; 3],
    /// Unit of lengths: a power of 2.
    scale: f64,
}

/// Why there is no crank or no driven link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TimedPoseFault {
    /// The equations of the crank have no solution or a family of them.
    #[error("no crank or a whole family of cranks turns by these angles")]
    Crank,
    /// The crank has length 0.
    #[error("the body turns about one point: the crank has length 0")]
    NoLength,
    /// The equations of the driven link have no solution or a family of them.
    #[error("no driven link or a whole family of them has this pivot")]
    Pivot,
    /// The driven link would be the crank, or end where the crank ends.
    #[error(
        "the driven link of this pivot is the crank itself, or has or leaves a link of length 0"
    )]
    Degenerate,
}

impl TimedPoses {
    /// Checks; turns and directions of the crank are taken as unit vectors.
    ///
    /// # Errors
    /// Where a number is not finite, two poses are one, or nothing turns or moves.
    pub fn new(
        places: [Complex64; 3],
        turns: [Complex64; 3],
        cranks: [Complex64; 3],
    ) -> Result<Self, PoseFault> {
        let is_finite = |z: Complex64| z.re.is_finite() && z.im.is_finite();
        let numbers = |k: usize| [places[k], turns[k], cranks[k]];
        if let Some(k) = (0..3).find(|&k| !numbers(k).into_iter().all(is_finite)) {
            return Err(PoseFault::NotFinite(k));
        }
        let (turns, cranks) = (turns.map(unit), cranks.map(unit));
        let apart = |points: &[Complex64; 3], j: usize, k: usize| modulus(points[j] - points[k]);
        let pairs = [(0, 1), (0, 2), (1, 2)];
        let widest = |points: &[Complex64; 3]| {
            let distances = pairs.map(|(j, k)| apart(points, j, k));
            distances.into_iter().fold(0.0, f64::max)
        };
        let extent = widest(&places);
        if extent == 0.0 {
            return Err(PoseFault::Trivial("move"));
        }
        if widest(&cranks) <= COINCIDENT {
            return Err(PoseFault::Trivial("turn their crank"));
        }
        let is_one = |&&(j, k): &&(usize, usize)| {
            apart(&places, j, k) <= COINCIDENT * extent && apart(&turns, j, k) <= COINCIDENT
        };
        if let Some(&(j, k)) = pairs.iter().find(is_one) {
            return Err(PoseFault::Same(j, k));
        }
        let scale = scale(extent).ok_or(PoseFault::Extent(extent))?;
        Ok(Self {
            places,
            turns,
            cranks,
            scale,
        })
    }

    /// Where the body's origin is.
    pub fn places(&self) -> &[Complex64; 3] {
        &self.places
    }

    /// How the body is turned, as unit vectors.
    pub fn turns(&self) -> &[Complex64; 3] {
        &self.turns
    }

    /// The crank's directions, as unit vectors.
    pub fn cranks(&self) -> &[Complex64; 3] {
        &self.cranks
    }

    /// Place, turn of the body and turn of the crank, from the first pose.
    fn displacement(&self, k: usize) -> [Complex64; 3] {
        let back = self.turns[0].conj();
        [
            (self.places[k] - self.places[0]) / self.scale * back,
            unit(self.turns[k] * back),
            unit(self.cranks[k] * self.cranks[0].conj()),
        ]
    }

    fn outside(&self, z: Complex64) -> Complex64 {
        self.places[0] + z * self.turns[0] * self.scale
    }

    /// The crank's pivot and joint, in the first pose.
    ///
    /// # Errors
    /// Where it is not determined.
    pub fn crank(&self) -> Result<[Complex64; 2], TimedPoseFault> {
        let row = |k: usize| {
            let [d, f, t] = self.displacement(k);
            [t - 1.0, f - t, -d]
        };
        let [[a, b, c], [p, q, r]] = [row(1), row(2)];
        let determinant = a * q - b * p;
        let terms = modulus(a) * modulus(q) + modulus(b) * modulus(p);
        if modulus(determinant) <= ZERO * terms.max(ZERO) {
            return Err(TimedPoseFault::Crank);
        }
        let ends = [(c * q - b * r) / determinant, (a * r - c * p) / determinant];
        if is_one(ends[0], ends[1]) {
            return Err(TimedPoseFault::NoLength);
        }
        Ok(ends.map(|z| self.outside(z)))
    }

    /// The driven link with this pivot: pivot and joint in the first pose.
    ///
    /// # Errors
    /// Where it is not determined.
    pub fn driven(&self, pivot: Complex64) -> Result<[Complex64; 2], TimedPoseFault> {
        let inside = (pivot - self.places[0]) / self.scale * self.turns[0].conj();
        // Re(u b) = w.
        let row = |k: usize| {
            let [d, f, _] = self.displacement(k);
            let u = d.conj() * f + inside.conj() * (1.0 - f);
            (u, (d * inside.conj()).re - d.norm_sqr() / 2.0)
        };
        let [(u, w), (v, x)] = [row(1), row(2)];
        let determinant = cross(u, v);
        if determinant.abs() <= ZERO * (modulus(u) * modulus(v)).max(ZERO) {
            return Err(TimedPoseFault::Pivot);
        }
        // Re(u b) = u.re b.re - u.im b.im.
        let joint = Complex64::new(
            (w * v.im - u.im * x) / determinant,
            (w * v.re - u.re * x) / determinant,
        );
        let ends = [pivot, self.outside(joint)];
        let crank = self.crank()?;
        let coincide = |a: Complex64, b: Complex64| is_one(a / self.scale, b / self.scale);
        let pairs = [(ends[0], ends[1]), (ends[0], crank[0]), (ends[1], crank[1])];
        match pairs.into_iter().any(|(a, b)| coincide(a, b)) {
            true => Err(TimedPoseFault::Degenerate),
            false => Ok(ends),
        }
    }

    /// The linkage of the crank and a driven link, which have these places in a list.
    pub fn linkage(&self, which: [usize; 2], dyads: [[Complex64; 2]; 2]) -> Design {
        let poses = self.places.iter().zip(&self.turns);
        let positions = linkage_through(poses, dyads);
        Design::new(which, positions, self.scale, Some(Side::A))
    }
}

/// Whether two points, in units of the extent, are one by what rounding leaves.
fn is_one(a: Complex64, b: Complex64) -> bool {
    modulus(a - b) <= COINCIDENT * (1.0 + modulus(a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_linkages::{at_points, random_linkage};

    #[test]
    fn the_links_of_a_linkage_pass_its_timed_poses() {
        for seed in 0..200 {
            let linkage = random_linkage(seed);
            let positions = at_points(&linkage, seed, 3);
            let first = linkage.joints[1] - linkage.joints[0];
            let places: Vec<Complex64> = positions.iter().map(|p| p.point).collect();
            let turn = |p: &crate::linkage::Linkage| (p.joints[1] - p.joints[0]) / first;
            let turns: Vec<Complex64> = positions.iter().map(turn).collect();
            let crank = |p: &crate::linkage::Linkage| p.joints[0] - p.pivots[0];
            let cranks: Vec<Complex64> = positions.iter().map(crank).collect();
            let array = |list: Vec<Complex64>| <[Complex64; 3]>::try_from(list).expect("3");
            let poses = TimedPoses::new(array(places), array(turns), array(cranks));
            let poses = poses.expect("three poses");
            let dyads = [
                poses.crank().expect("a crank"),
                poses.driven(linkage.pivots[1]).expect("a driven link"),
            ];
            for (dyad, k) in dyads.iter().zip(0..) {
                let away = [dyad[0] - linkage.pivots[k], dyad[1] - linkage.joints[k]];
                let size = 1.0 + modulus(dyad[1]);
                assert!(
                    away.iter().all(|z| modulus(*z) < 1e-7 * size),
                    "seed {seed}: {dyad:?} for {linkage:?}"
                );
            }
            let made = poses.linkage([0, 1], dyads);
            assert!(made.error < 1e-7, "seed {seed}: {:e}", made.error);
        }
    }

    #[test]
    fn timed_poses_without_a_crank_are_named() {
        let places = [0.0, 1.0, 2.0].map(|x| Complex64::new(x, x * x));
        let turns = [0.0, 0.3, 0.7].map(|x| Complex64::new(1.0, x));
        let same = TimedPoses::new(places, turns, turns).expect("poses");
        // A body that turns with its crank stands still to it: no joint between them moves.
        assert_eq!(same.crank(), Err(TimedPoseFault::Crank));
        let still = TimedPoses::new(places, turns, [turns[0]; 3]);
        assert_eq!(still, Err(PoseFault::Trivial("turn their crank")));
        // A body that turns about one point.
        let about = turns.map(|turn| unit(turn) * Complex64::new(0.5, 1.0));
        let cranks = [0.0, 0.5, 1.1].map(|x| Complex64::new(1.0, x));
        let turning = TimedPoses::new(about, turns, cranks).expect("poses");
        assert_eq!(turning.crank(), Err(TimedPoseFault::NoLength));
        let poses = TimedPoses::new(places, turns, cranks).expect("poses");
        let [pivot, _] = poses.crank().expect("a crank");
        assert_eq!(poses.driven(pivot), Err(TimedPoseFault::Degenerate));
        let [a, b, _] = places;
        let [f, g, _] = turns;
        let twice = TimedPoses::new([a, b, b], [f, g, g], turns);
        assert_eq!(twice, Err(PoseFault::Same(1, 2)));
    }
}
