//! Spherical four-bars: two chains of hinges whose axes meet in one point, and how they pass the poses of their coupler.

use super::{Part, SpatialDyad, SpatialPoses, Vector, angle, minus};
use crate::assessment::Grade;
use crate::mechanism::pose::{cross, dot};
use crate::plane::degrees;
use num_complex::Complex64;

/// Arcs shorter than this, in radians, are no links.
const SHORTEST: f64 = 1e-9;
/// Error of a cosine at the end of an interval.
const COSINE_ERROR: f64 = 1e-9;

/// A spherical four-bar linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalFourBar {
    /// The chains by their places in a list: the first one drives.
    pub dyads: [usize; 2],
    /// How the first chain drives it through the poses.
    pub grade: Grade,
    /// The type by the hinges that turn all the way round.
    pub kind: &'static str,
    /// Arcs of ground, driver, coupler and driven link, in degrees.
    pub arcs: [f64; 4],
}

impl SphericalFourBar {
    /// Better ones first: the grade, then whether the driver turns round.
    fn rank(&self) -> (Grade, bool) {
        let turns_round = ["crank-rocker", "double-crank"].contains(&self.kind);
        (self.grade, !turns_round)
    }
}

/// Every pair of chains as a linkage, driven from the side that serves better; best first.
pub fn linkages(poses: &SpatialPoses, dyads: &[SpatialDyad]) -> Vec<SphericalFourBar> {
    let pairs = (0..dyads.len()).flat_map(|one| (one + 1..dyads.len()).map(move |two| [one, two]));
    let better = |[one, two]: [usize; 2]| {
        let ways = [[one, two], [two, one]];
        let driven = ways.map(|way| linkage(poses, way, way.map(|k| &dyads[k])));
        let [first, second] = driven;
        match (first, second) {
            (Some(first), Some(second)) if second.rank() < first.rank() => Some(second),
            (first, _) => first,
        }
    };
    let mut linkages: Vec<SphericalFourBar> = pairs.filter_map(better).collect();
    linkages.sort_by_key(SphericalFourBar::rank);
    linkages
}

/// Cosine and sine of an arc.
#[derive(Clone, Copy)]
struct Arc([f64; 2]);

impl Arc {
    fn of(a: Vector, b: Vector) -> Self {
        let normal = cross(a, b);
        Self([dot(a, b), dot(normal, normal).sqrt()])
    }
}

/// Cosines of the angle between two neighbouring links at which the other two links meet.
#[derive(Clone, Copy)]
struct Range {
    least: f64,
    most: f64,
}

impl Range {
    /// By the law of cosines: the arc opposite the angle is that of the triangle with the other two links.
    fn new([c1, s1]: [f64; 2], [c2, s2]: [f64; 2], [c3, s3]: [f64; 2], [c4, s4]: [f64; 2]) -> Self {
        let cosine = |opposite: f64| (opposite - c1 * c2) / (s1 * s2);
        Self {
            least: cosine(c3 * c4 - s3 * s4),
            most: cosine(c3 * c4 + s3 * s4),
        }
    }

    fn is_full(self) -> bool {
        self.ends_are_free() == [true, true]
    }

    /// Whether the linkage folds flat at the angle 0 or 180 degrees: an end of the range is there.
    fn has_change_point(self) -> bool {
        (self.least + 1.0).abs() <= COSINE_ERROR || (self.most - 1.0).abs() <= COSINE_ERROR
    }

    /// Whether the straight angle is within, and the angle 0.
    fn ends_are_free(self) -> [bool; 2] {
        [
            self.least <= COSINE_ERROR - 1.0,
            self.most >= 1.0 - COSINE_ERROR,
        ]
    }
}

pub(super) fn linkage(
    poses: &SpatialPoses,
    which: [usize; 2],
    dyads: [&SpatialDyad; 2],
) -> Option<SphericalFourBar> {
    let axes = |dyad: &SpatialDyad| match (dyad.fixed, dyad.moving) {
        (Part::Direction(fixed), Part::Direction(moving)) => Some([fixed, moving]),
        _ => None,
    };
    let ([a, b], [other, far]) = (axes(dyads[0])?, axes(dyads[1])?);
    let around = [[a, other], [a, b], [b, far], [far, other]];
    let [ground, driver, coupler, driven] = around.map(|[x, y]| Arc::of(x, y));
    if [ground, driver, coupler, driven]
        .iter()
        .any(|arc| arc.0[1] < SHORTEST)
    {
        return None;
    }
    let range = Range::new(ground.0, driver.0, coupler.0, driven.0);
    let other_range = Range::new(ground.0, driven.0, coupler.0, driver.0);
    let of_coupler = Range::new(driver.0, coupler.0, driven.0, ground.0);
    let folds = [range, other_range, of_coupler].map(Range::has_change_point);
    let kind = match (range.is_full(), other_range.is_full()) {
        _ if folds.contains(&true) => "change-point",
        (true, true) => "double-crank",
        (true, false) => "crank-rocker",
        (false, true) => "rocker-crank",
        (false, false) if of_coupler.is_full() => "double-rocker",
        (false, false) => "triple-rocker",
    };
    let across = |x: Vector| minus(x, a.map(|c| c * dot(a, x)));
    let zero = across(other);
    let positions = poses.directions(b).zip(poses.directions(far));
    let position = |(near, far): (Vector, Vector)| {
        let turned = across(near);
        Position {
            input: Complex64::new(dot(zero, turned), dot(a, cross(zero, turned))),
            side: dot(cross(near, far), other) > 0.0,
        }
    };
    let positions: Vec<Position> = positions.map(position).collect();
    Some(SphericalFourBar {
        dyads: which,
        grade: grade(&positions, range),
        kind,
        arcs: around.map(|[x, y]| angle(x, y)),
    })
}

/// A position of a linkage.
struct Position {
    /// The direction of the driver from the ground link.
    input: Complex64,
    /// The side of the arc from the driver's end to the other pivot on which the coupler's other end is.
    side: bool,
}

/// How the driver takes the linkage through these positions: they are on one branch where they have one side and lie in one
/// interval of the input; where an interval has ends, its two sides are one circuit.
fn grade(positions: &[Position], range: Range) -> Grade {
    let [through_straight, through_zero] = range.ends_are_free();
    let interval = |position: &Position| {
        // Without the angles 0 and 180 degrees there are two intervals, one on each side.
        !through_straight && !through_zero && position.input.im > 0.0
    };
    let same = |value: &dyn Fn(&Position) -> bool| {
        let mut values = positions.iter().map(value);
        let first = values.next();
        values.all(|other| Some(other) == first)
    };
    let (one_side, one_interval) = (same(&|p| p.side), same(&interval));
    match (one_interval, one_side) {
        (true, true) if is_in_order(positions, range) => Grade::InOrder,
        (true, true) => Grade::OneBranch,
        (true, false) if !range.is_full() => Grade::OneCircuit,
        _ => Grade::TwoCircuits,
    }
}

/// Whether the input turns one way from each position to the next, once round at most.
fn is_in_order(positions: &[Position], range: Range) -> bool {
    let [through_straight, through_zero] = range.ends_are_free();
    let first = positions[0].input;
    let angle = |position: &Position| {
        let turned = match (through_straight, through_zero) {
            // The circle is cut at the first position.
            (true, true) => position.input * first.conj(),
            // The interval about 180 degrees is cut at 0.
            (true, false) => return degrees(-position.input),
            _ => return degrees(position.input),
        };
        let angle = degrees(turned);
        if angle < 0.0 { angle + 360.0 } else { angle }
    };
    let angles: Vec<f64> = positions.iter().map(angle).collect();
    let rises = angles.windows(2).all(|pair| pair[0] < pair[1]);
    // Falling, the first position of a full turn is its end.
    let falling = match range.is_full() {
        true => &angles[1..],
        false => &angles[..],
    };
    rises || falling.windows(2).all(|pair| pair[0] > pair[1])
}
