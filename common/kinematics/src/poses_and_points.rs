//! Poses and points mixed: every four-bar linkage that takes a body through some poses, and a point of
//! it through some places where its turn is free (Alt-Burmester problems: Tong, Murray, Myszka 2013;
//! Brake, Hauenstein, Murray, Myszka, Wampler 2016).
//!
//! M poses and N points leave finitely many where 2 M + N = 10: five poses and nine points are the
//! problems of Burmester and of Alt, and between them are 4 and 2, 3 and 4, 2 and 6. Each point gives an
//! equation of the nine-point problem, each pose beyond the first one for either dyad. With `n = aX` and
//! so on as unknowns of their own these are linear in a dyad, those of degree 2 in either: 128, 1536 and
//! 20,480 start points of two groups, of each two of which one is followed, since the dyads can be
//! exchanged.

use crate::design::Design;
use crate::linkage::Linkage;
use crate::nine_point::realization::{made_real, rotation};
use crate::plane::{modulus, scale, unit};
use cognate_systems::formats;
use cognate_systems::system::System;
use num_complex::Complex64;
use std::fmt::Write as _;

/// Places or turns nearer to each other than this, relative to the extent, are one.
const COINCIDENT: f64 = 1e-10;
/// The sets on which the other paths end: no linkages.
const DEGENERATE: &str = r#""x = y = 0": {"equations": ["x", "y"]},
    "X = Y = 0": {"equations": ["X", "Y"]},
    "x = y = a = b": {"equations": ["x - y", "x - a", "x - b"]},
    "X = Y = A = B": {"equations": ["X - Y", "X - A", "X - B"]},
    "equal dyads": {"equations": ["x - y", "X - Y", "a - b", "A - B"]},
    "x = a, y = b, X = Y, A = B": {"equations": ["x - a", "y - b", "X - Y", "A - B"]},
    "X = A, Y = B, x = y, a = b": {"equations": ["X - A", "Y - B", "x - y", "a - b"]}"#;

/// A solution: x, X, a, A, n, N, y, Y, b, B, m, M, in the scale of its [`PosesAndPoints`].
pub type Solution = [Complex64; 12];

/// How many of each: those between Burmester's problem and Alt's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mixture {
    /// 2, 3 or 4.
    poses: usize,
}

impl Mixture {
    /// All mixtures.
    pub const ALL: [Self; 3] = [Self { poses: 4 }, Self { poses: 3 }, Self { poses: 2 }];

    /// The mixture of this number of poses and points; `None` if it is not supported.
    pub fn new(poses: usize, points: usize) -> Option<Self> {
        let mixture = Self { poses };
        ((2..=4).contains(&poses) && points == mixture.points()).then_some(mixture)
    }

    /// Number of given poses.
    pub fn poses(self) -> usize {
        self.poses
    }

    /// Number of given points.
    pub fn points(self) -> usize {
        10 - 2 * self.poses
    }

    /// Four-bar linkages for generic poses and points, half of the solutions (Brake and others 2016,
    /// table 1: 60, 402, 2224).
    pub fn linkages(self) -> u64 {
        match self.poses {
            2 => 1112,
            3 => 201,
            _ => 30,
        }
    }

    /// The system: unknowns as in [`Solution`], x, a and y, b as in the nine-point problem, and
    /// n = a X, N = A x, m = b Y, M = B y; parameters d, D for each point, then d, D, f, F for each
    /// pose but the first, which is the frame.
    pub fn system(self) -> System {
        let points = self.points();
        let (mut parameters, mut definitions) = (vec![], vec![]);
        let mut equations: Vec<String> = ["n - a*X", "N - A*x", "m - b*Y", "M - B*y"]
            .map(str::to_owned)
            .to_vec();
        for j in 1..=points {
            parameters.extend([format!("d{j}"), format!("D{j}")]);
            for (dyad, [x, xx, a, aa, n, nn]) in [
                ("a", ["x", "X", "a", "A", "n", "N"]),
                ("b", ["y", "Y", "b", "B", "m", "M"]),
            ] {
                definitions.extend([
                    (format!("alpha{dyad}{j}"), format!("D{j}*{x} - {nn}")),
                    (format!("beta{dyad}{j}"), format!("d{j}*{xx} - {n}")),
                    (
                        format!("kappa{dyad}{j}"),
                        format!("D{j}*({x} - {a}) + d{j}*({xx} - {aa}) + d{j}*D{j}"),
                    ),
                ]);
            }
            // Cramer's rule for the turn, see `named::nine_point`.
            definitions.extend([
                (
                    format!("G{j}"),
                    format!("betaa{j}*kappab{j} - betab{j}*kappaa{j}"),
                ),
                (
                    format!("H{j}"),
                    format!("alphab{j}*kappaa{j} - alphaa{j}*kappab{j}"),
                ),
                (
                    format!("K{j}"),
                    format!("alphaa{j}*betab{j} - alphab{j}*betaa{j}"),
                ),
            ]);
            equations.push(format!("G{j}*H{j} + (G{j} + H{j})*K{j}"));
        }
        for j in points + 1..points + self.poses {
            parameters.extend(["d", "D", "f", "F"].map(|s| format!("{s}{j}")));
            for [x, xx, a, aa, n, nn] in [
                ["x", "X", "a", "A", "n", "N"],
                ["y", "Y", "b", "B", "m", "M"],
            ] {
                equations.push(format!(
                    "d{j}*D{j} + d{j}*F{j}*{xx} + D{j}*f{j}*{x} - d{j}*{aa} - D{j}*{a} \
                     + {nn}*(1 - f{j}) + {n}*(1 - F{j})"
                ));
            }
        }
        let listed = |items: &[String]| {
            let items = items.iter().map(|item| format!("\"{item}\""));
            items.collect::<Vec<_>>().join(", ")
        };
        let mut defined = String::new();
        for (name, expression) in &definitions {
            let comma = if defined.is_empty() { "" } else { ", " };
            let _ = write!(defined, "{comma}\"{name}\": \"{expression}\"");
        }
        let text = format!(
            r#"{{
  "variables": ["x", "X", "a", "A", "n", "N", "y", "Y", "b", "B", "m", "M"],
  "groups": [["x", "X", "a", "A", "n", "N"], ["y", "Y", "b", "B", "m", "M"]],
  "parameters": [{}],
  "definitions": {{{defined}}},
  "equations": [{}],
  "conjugates": [["x", "X"], ["a", "A"], ["n", "N"], ["y", "Y"], ["b", "B"], ["m", "M"]],
  "degenerate": {{{DEGENERATE}}},
  "symmetry": [{{"permutation": {{"x": "y", "y": "x", "a": "b", "b": "a", "n": "m", "m": "n",
                                 "X": "Y", "Y": "X", "A": "B", "B": "A", "N": "M", "M": "N"}}}}]
}}"#,
            listed(&parameters),
            listed(&equations)
        );
        match formats::read("poses and points", text.as_bytes()) {
            Ok(file) => file.system,
            Err(error) => panic!("poses and points make a system: {error}"),
        }
    }
}

/// One solution of each pair of a solution and its exchange.
pub fn one_of_each_pair(solutions: &[Solution]) -> Vec<Solution> {
    let key = |z: &Complex64| (z.re, z.im);
    let first = |p: &&Solution| key(&p[0]) < key(&p[6]);
    solutions.iter().filter(first).copied().collect()
}

/// Poses and points, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct PosesAndPoints {
    mixture: Mixture,
    places: Vec<Complex64>,
    /// Unit vectors; none at a point.
    turns: Vec<Option<Complex64>>,
    scale: f64,
}

/// Why poses and points cannot be used; numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MixtureFault {
    /// A number is infinite or not a number.
    #[error("position {} is not finite", .0 + 1)]
    NotFinite(usize),
    /// The number of poses or points is wrong.
    #[error(
        "expected 2, 3 or 4 poses with 6, 4 or 2 points, found {poses} and {points}; five poses are \
         a problem of body guidance, nine points one of their own"
    )]
    Count {
        /// Poses that were given.
        poses: usize,
        /// Points that were given.
        points: usize,
    },
    /// Two of them are one.
    #[error("positions {} and {} are the same", .0 + 1, .1 + 1)]
    Same(usize, usize),
    /// Differences of the places overflow or vanish in double precision.
    #[error("the places' extent is {0:e}; expected a number from 1e-290 to 1e290")]
    Extent(f64),
}

impl PosesAndPoints {
    /// Checks and scales; turns are taken as unit vectors, and points have none.
    pub fn new(positions: &[(Complex64, Option<Complex64>)]) -> Result<Self, MixtureFault> {
        let finite = |z: Complex64| z.re.is_finite() && z.im.is_finite();
        let is_finite = |(place, turn): &(Complex64, Option<Complex64>)| {
            finite(*place) && turn.is_none_or(finite)
        };
        if let Some(k) = positions.iter().position(|p| !is_finite(p)) {
            return Err(MixtureFault::NotFinite(k));
        }
        let poses = positions.iter().filter(|(_, turn)| turn.is_some()).count();
        let points = positions.len() - poses;
        let mixture = Mixture::new(poses, points).ok_or(MixtureFault::Count { poses, points })?;
        let places: Vec<Complex64> = positions.iter().map(|(place, _)| *place).collect();
        let turns: Vec<_> = positions.iter().map(|(_, turn)| turn.map(unit)).collect();
        let away = places.iter().map(|&p| modulus(p - places[0]));
        let extent = away.fold(0.0, f64::max);
        let scale = scale(extent).ok_or(MixtureFault::Extent(extent))?;
        for j in 0..places.len() {
            for k in j + 1..places.len() {
                let together = modulus(places[j] - places[k]) <= COINCIDENT * extent;
                let alike = match (turns[j], turns[k]) {
                    (Some(one), Some(two)) => modulus(one - two) <= COINCIDENT,
                    (None, None) => true,
                    _ => false,
                };
                if together && alike {
                    return Err(MixtureFault::Same(j, k));
                }
            }
        }
        Ok(Self {
            mixture,
            places,
            turns,
            scale,
        })
    }

    /// Numbers of given poses and points.
    pub fn mixture(&self) -> Mixture {
        self.mixture
    }

    /// Places of the given poses and points.
    pub fn places(&self) -> &[Complex64] {
        &self.places
    }

    /// How the body is turned, as unit vectors; none at a point.
    pub fn turns(&self) -> &[Option<Complex64>] {
        &self.turns
    }

    /// The first pose: its place among the positions, and its turn.
    fn frame(&self) -> (usize, Complex64) {
        let first = self
            .turns
            .iter()
            .enumerate()
            .find_map(|(k, t)| t.map(|t| (k, t)));
        first.expect("there are two poses at least")
    }

    /// The parameters of the system.
    pub fn parameters(&self) -> Vec<Complex64> {
        let (frame, turn) = self.frame();
        let way = |k: usize| {
            let d = (self.places[k] - self.places[frame]) / self.scale;
            [d, d.conj()]
        };
        let indices = 0..self.places.len();
        let mut parameters = Vec::with_capacity(16);
        for k in indices.clone().filter(|&k| self.turns[k].is_none()) {
            parameters.extend(way(k));
        }
        for k in indices.filter(|&k| k != frame) {
            if let Some(other) = self.turns[k] {
                let f = unit(other * turn.conj());
                parameters.extend(way(k));
                parameters.extend([f, f.conj()]);
            }
        }
        parameters
    }

    /// A real solution as a linkage in all positions; `None` where it is none: both joints are one.
    pub fn linkage(&self, solution: &Solution) -> Option<Design> {
        let [x, xx, a, aa, _, _, y, yy, b, bb, _, _] = *solution;
        let unknowns = made_real(&[x, xx, a, aa, y, yy, b, bb]);
        let [x, _, a, _, y, _, b, _] = unknowns.map(|z| z * self.scale);
        if modulus(x - y) <= COINCIDENT * self.scale {
            return None;
        }
        let (frame, turn) = self.frame();
        let origin = self.places[frame];
        let first = Linkage {
            pivots: [origin + a, origin + b],
            joints: [origin + x, origin + y],
            point: origin,
        };
        let positions = self
            .places
            .iter()
            .zip(&self.turns)
            .map(|(&place, place_turn)| {
                let turned = match place_turn {
                    Some(place_turn) => place_turn * turn.conj(),
                    None => rotation(&first, place),
                };
                Linkage {
                    joints: [place + x * turned, place + y * turned],
                    point: place,
                    ..first
                }
            });
        Some(Design::new([0, 1], positions.collect(), self.scale, None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_linkages::{at_points, random_linkage, residual};

    #[test]
    fn a_linkage_solves_its_poses_and_points() {
        for mixture in Mixture::ALL {
            let system = mixture.system();
            assert_eq!((system.equations.len(), system.parameters.len()), (12, 16));
            for seed in 0..30 {
                let linkage = random_linkage(seed);
                let count = mixture.poses() + mixture.points();
                let at = at_points(&linkage, seed, count);
                let coupler = |pose: &Linkage| pose.joints[1] - pose.joints[0];
                // Poses and points take turns, and the first of all is a point.
                let is_pose = |k: usize| k % 2 == 1 && k < 2 * mixture.poses();
                let mut left = mixture.poses();
                let positions: Vec<_> = at
                    .iter()
                    .enumerate()
                    .map(|(k, pose)| {
                        let rest = count - k;
                        let turned = left > 0 && (is_pose(k) || rest <= left);
                        left -= usize::from(turned);
                        (pose.point, turned.then(|| coupler(pose)))
                    })
                    .collect();
                let given = PosesAndPoints::new(&positions).expect("a mixture");
                assert_eq!(given.mixture(), mixture);
                let (frame, _) = given.frame();
                let z = |w: Complex64| (w - at[frame].point) / given.scale;
                let parts = [
                    at[frame].joints[0],
                    linkage.pivots[0],
                    at[frame].joints[1],
                    linkage.pivots[1],
                ];
                let [x, a, y, b] = parts.map(z);
                let dyad = |x: Complex64, a: Complex64| {
                    let n = a * x.conj();
                    [x, x.conj(), a, a.conj(), n, n.conj()]
                };
                let solution = [dyad(x, a), dyad(y, b)].concat();
                let off = residual(&system, &solution, &given.parameters());
                // Each equation has degree 4 in the unknowns.
                let size = solution.iter().map(|&z| modulus(z)).fold(1.0, f64::max);
                let allowed = 1e-11 * size * size * size * size;
                assert!(
                    off < allowed,
                    "{mixture:?}, seed {seed}: {off:e} above {allowed:e}"
                );
                let solution: Solution = solution.try_into().expect("eight");
                let made = given.linkage(&solution).expect("a linkage");
                assert!(
                    made.error < 1e-7,
                    "{mixture:?}, seed {seed}: {:e}",
                    made.error
                );
            }
        }
    }

    #[test]
    fn bad_mixtures_are_named() {
        let at = |k: usize| Complex64::new(k as f64, (k * k) as f64);
        let turn = |k: usize| Some(Complex64::new(1.0, k as f64));
        let mixed = |poses: usize, points: usize| -> Vec<_> {
            let poses = (0..poses).map(|k| (at(k), turn(k)));
            poses
                .chain((0..points).map(|k| (at(k + 9), None)))
                .collect()
        };
        for mixture in Mixture::ALL {
            assert!(PosesAndPoints::new(&mixed(mixture.poses(), mixture.points())).is_ok());
        }
        for (poses, points) in [(5, 0), (1, 8), (0, 9), (2, 5), (3, 5)] {
            let fault = MixtureFault::Count { poses, points };
            assert_eq!(PosesAndPoints::new(&mixed(poses, points)), Err(fault));
        }
        let mut same = mixed(2, 6);
        same[7] = same[4];
        assert_eq!(PosesAndPoints::new(&same), Err(MixtureFault::Same(4, 7)));
        // A point where a pose is asks for more.
        same[7].0 = same[1].0;
        assert!(PosesAndPoints::new(&same).is_ok());
        same[3].0.re = f64::NAN;
        assert_eq!(PosesAndPoints::new(&same), Err(MixtureFault::NotFinite(3)));
    }
}
