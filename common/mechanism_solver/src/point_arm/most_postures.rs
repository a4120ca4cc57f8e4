//! The largest number of real postures of an arm of three joints that places a point.
//!
//! At the place of a position one root of the polynomial of postures is that position, and one is its partner, because real roots
//! come in pairs. The other two are real at some position where an arm has four postures; else they are complex at all of them, and
//! keep a distance from the real line.

use super::joint_polynomial::place;
use super::plane_map::PlaneMap;
use super::posture_polynomial::{Elimination, PosturePolynomial, eliminated};
use cognate_kinematics::mechanism::Mechanism;
use std::f64::consts::TAU;

/// Positions in each of the two turns.
const POSITIONS: u32 = 192;
/// Imaginary parts of roots below this are none.
const REAL: f64 = 1e-9;
/// Distance of real roots that are surely different.
const APART: f64 = 1e-3;
/// Least distance of the complex roots from the real line, as a multiple of the largest difference between neighbouring
/// positions.
const MARGIN: f64 = 4.0;

/// The largest number of postures.
#[derive(Clone, Debug, PartialEq)]
pub struct MostPostures {
    /// Real postures of the second and third joint at most, whatever the limits; off the first axis each has one value of the first
    /// joint. `None` in doubt.
    pub postures: Option<u64>,
    /// Reason for a doubt; `None` if nothing is in doubt.
    pub doubt: Option<String>,
}

impl MostPostures {
    fn of(postures: u64) -> Self {
        Self {
            postures: Some(postures),
            doubt: None,
        }
    }

    fn in_doubt(doubt: &str) -> Self {
        Self {
            postures: None,
            doubt: Some(doubt.into()),
        }
    }
}

/// The largest number of postures of an arm of three joints; `None` for other mechanisms.
pub fn most_postures(mechanism: &Mechanism) -> Option<MostPostures> {
    let map = PlaneMap::of(mechanism)?;
    if map.determinant.is_zero() {
        return Some(MostPostures::in_doubt(
            "all positions are singular: points have infinitely many postures",
        ));
    }
    if map.determinant.is_constant() {
        return Some(MostPostures::of(1));
    }
    if map.turns != [true, true] {
        return Some(MostPostures::in_doubt(
            "the largest number of postures is not decided in this version for a second or third joint that shifts",
        ));
    }
    Some(match eliminated(&map) {
        // Next to the least or largest value of the coordinate that the third joint has alone, two values of it make each value of
        // the coordinate, and with each of them the second joint makes each value of the other in two ways.
        Elimination::ThirdJointAlone => MostPostures::of(4),
        Elimination::Doubtful => MostPostures::in_doubt(
            "the first two axes are nearly parallel or nearly meet: the largest number of postures is not clear",
        ),
        Elimination::Polynomial(polynomial) => by_positions(&map, &polynomial),
    })
}

/// How the other two roots stand at a position.
#[derive(Clone, Copy)]
enum OtherRoots {
    /// Real, and all four are different.
    Real,
    /// Complex, at this distance from the real line.
    Complex(f64),
}

fn by_positions(map: &PlaneMap, polynomial: &PosturePolynomial) -> MostPostures {
    let unclear =
        MostPostures::in_doubt("whether the arm has four postures somewhere is not clear");
    let side = TAU / f64::from(POSITIONS);
    let mut distances = Vec::new();
    for row in 0..POSITIONS {
        for column in 0..POSITIONS {
            let turns = [column, row].map(|k| side * (f64::from(k) + 0.5));
            let at = place(map.turns, turns);
            match other_roots(polynomial, map.value(&at)) {
                Some(OtherRoots::Real) => return MostPostures::of(4),
                Some(OtherRoots::Complex(distance)) => distances.push(distance),
                None => return unclear,
            }
        }
    }
    let count = POSITIONS as usize;
    let at = |column: usize, row: usize| distances[(row % count) * count + column % count];
    let differences = (0..count * count).map(|k| {
        let (column, row) = (k % count, k / count);
        let here = at(column, row);
        let beside = [at(column + 1, row), at(column, row + 1)];
        beside
            .map(|x| (x - here).abs())
            .into_iter()
            .fold(0.0, f64::max)
    });
    // Each position must keep its distance up to its neighbours.
    let is_clear = differences
        .enumerate()
        .all(|(k, difference)| distances[k] > MARGIN * difference);
    match is_clear {
        true => MostPostures::of(2),
        false => unclear,
    }
}

/// The two roots that are neither the position nor its partner; `None` where roots are not reached.
fn other_roots(polynomial: &PosturePolynomial, place: [f64; 2]) -> Option<OtherRoots> {
    let mut roots = polynomial.roots(place)?;
    let height = |z: num_complex::Complex64| z.im.abs() / (1.0 + z.norm_sqr());
    roots.sort_by(|a, b| height(*a).total_cmp(&height(*b)));
    let distance = height(roots[2]);
    if distance > REAL {
        return Some(OtherRoots::Complex(distance));
    }
    let is_apart = (0..4).all(|j| {
        (0..j).all(|k| {
            let size = 1.0 + roots[j].norm_sqr().max(roots[k].norm_sqr());
            (roots[j] - roots[k]).norm_sqr() > APART * APART * size
        })
    });
    // Four real roots of which two are nearly one: it is a neighbour that tells.
    Some(match is_apart {
        true => OtherRoots::Real,
        false => OtherRoots::Complex(0.0),
    })
}
