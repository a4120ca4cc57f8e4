//! Drive: what happens at given positions of a linkage when one side of it is driven.
//!
//! A branch is what the driver reaches without passing a dead centre, where coupler and driven
//! side are in line and the driver cannot say which way they fold.

use crate::linkage::{Linkage, Side};
use crate::plane::{degrees, turn, unit};
use num_complex::Complex64;

/// The directions that a driver can take, against the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reach {
    /// All of them.
    Round,
    /// Directions on both sides of the one to the other pivot.
    Toward,
    /// Directions on both sides of the opposite one.
    Away,
    /// Two ranges, one on each side of the ground.
    TwoRanges,
}

/// Behaviour of a linkage at given positions when one side drives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// The side of the linkage that is driven.
    pub driver: Side,
    /// The driver can turn all the way round.
    pub turns_round: bool,
    /// All positions are on one branch: the driver takes the linkage through all of them.
    pub one_branch: bool,
    /// The positions, numbered from 0, as they are met: on a branch from end to end, or around
    /// from the first where the driver turns round; else along their circuit; `None` where they
    /// are on two circuits.
    pub order: Option<Vec<usize>>,
    /// The order is the given one, forwards or backwards.
    pub in_order: bool,
    /// Smallest angle between coupler and driven side, from 0 to 90 degrees: on the way
    /// through all positions on a branch, else at the positions.
    pub transmission_degrees: f64,
    /// How far the driver turns to pass all positions, in degrees; 360 where it turns round,
    /// `None` where they are on several branches.
    pub swing_degrees: Option<f64>,
}

impl Drive {
    /// Looks at positions of one linkage: the same pivots and lengths in each.
    ///
    /// # Panics
    /// When there is no position.
    pub fn new(poses: &[Linkage], driver: Side) -> Self {
        let geometry = Geometry::new(&poses[0], driver);
        let directions: Vec<Complex64> = poses.iter().map(|p| geometry.direction(p)).collect();
        let assembly: Vec<f64> = poses.iter().map(|p| p.assembly(driver)).collect();
        // A position at a dead centre belongs to both branches that meet there.
        let one_sign = |signs: &[f64]| !signs.contains(&1.0) || !signs.contains(&-1.0);
        let sides: Vec<f64> = directions.iter().map(|w| sign(w.im)).collect();
        let two = geometry.reach == Reach::TwoRanges;
        let one_branch = one_sign(&assembly) && (!two || one_sign(&sides));
        let circuits: Vec<f64> = poses.iter().map(Linkage::circuit).collect();
        let one_circuit = one_sign(&circuits);
        let along: Vec<f64> = directions.iter().map(|&w| geometry.along(w)).collect();
        let order = one_circuit.then(|| order(&along, &assembly, geometry.reach, one_branch));
        let around = !one_branch || geometry.reach == Reach::Round;
        let in_order = order.as_ref().is_some_and(|order| is_given(order, around));
        Self {
            driver,
            turns_round: geometry.reach == Reach::Round,
            one_branch,
            order,
            in_order,
            transmission_degrees: geometry.transmission(&directions, &along, one_branch),
            swing_degrees: one_branch.then(|| geometry.swing(&directions, &along)),
        }
    }
}

fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// Positions along a branch, or around a circuit from the first position on.
fn order(along: &[f64], assembly: &[f64], reach: Reach, one_branch: bool) -> Vec<usize> {
    // One assembly forwards, the other backwards: so the circuit is closed. No value of `along`
    // is beyond 4.
    let place = |k: usize| match (one_branch, assembly[k] < 0.0) {
        (false, true) => 8.0 - along[k],
        _ => along[k],
    };
    let mut order: Vec<usize> = (0..along.len()).collect();
    order.sort_by(|&j, &k| place(j).total_cmp(&place(k)));
    if !one_branch || reach == Reach::Round {
        let first = order.iter().position(|&k| k == 0).unwrap_or(0);
        order.rotate_left(first);
    }
    order
}

/// Whether an order is 0, 1, 2, ... or the reverse; around a closed curve from 0 on.
fn is_given(order: &[usize], around: bool) -> bool {
    let forwards = order.iter().enumerate().all(|(k, &j)| j == k);
    let n = order.len();
    let backwards = order.iter().enumerate().all(|(k, &j)| match around {
        true => j == (n - k) % n,
        false => j == n - 1 - k,
    });
    forwards || backwards
}

/// Lengths and the ground's direction, as one driver sees them.
struct Geometry {
    driver: Side,
    ground: Complex64,
    /// Ground, driver, coupler, driven side.
    lengths: [f64; 4],
    reach: Reach,
}

impl Geometry {
    fn new(linkage: &Linkage, driver: Side) -> Self {
        let (driver_index, other) = (driver.index(), driver.other().index());
        let l = linkage.lengths();
        let (ground, side, coupler, driven) =
            (l.ground, l.sides[driver_index], l.coupler, l.sides[other]);
        // The driven pivot is at least |ground - side| and at most ground + side from the
        // driver's joint; coupler and driven side reach from |coupler - driven| to their sum.
        let stopped_toward = (ground - side).abs() < (coupler - driven).abs();
        let stopped_away = ground + side > coupler + driven;
        let reach = match (stopped_toward, stopped_away) {
            (false, false) => Reach::Round,
            (false, true) => Reach::Toward,
            (true, false) => Reach::Away,
            (true, true) => Reach::TwoRanges,
        };
        Self {
            driver,
            ground: unit(linkage.pivots[other] - linkage.pivots[driver_index]),
            lengths: [ground, side, coupler, driven],
            reach,
        }
    }

    /// The driver's direction against the ground.
    fn direction(&self, pose: &Linkage) -> Complex64 {
        let driver_index = self.driver.index();
        unit(pose.joints[driver_index] - pose.pivots[driver_index]) * self.ground.conj()
    }

    /// A number from -2 to 4 that grows counterclockwise within each range of directions.
    fn along(&self, direction: Complex64) -> f64 {
        match self.reach {
            Reach::Away => turn(-direction),
            _ => turn(direction),
        }
    }

    /// |cos| of the angle between coupler and driven side, for a direction of the driver with
    /// this cosine against the ground.
    fn flatness(&self, cosine: f64) -> f64 {
        let [ground, side, coupler, driven] = self.lengths;
        let distance = ground * ground + side * side - 2.0 * ground * side * cosine;
        let product = 2.0 * coupler * driven;
        ((coupler * coupler + driven * driven - distance) / product)
            .abs()
            .min(1.0)
    }

    fn transmission(&self, directions: &[Complex64], along: &[f64], one_branch: bool) -> f64 {
        let mut flat = directions
            .iter()
            .map(|w| self.flatness(w.re))
            .fold(0.0, f64::max);
        if one_branch {
            let passes = |low: bool| match self.reach {
                Reach::Round => true,
                Reach::Toward => {
                    low && along.iter().any(|&s| s < 0.0) && along.iter().any(|&s| s > 0.0)
                }
                Reach::Away => {
                    !low && along.iter().any(|&s| s < 0.0) && along.iter().any(|&s| s > 0.0)
                }
                Reach::TwoRanges => false,
            };
            for (low, cosine) in [(true, 1.0), (false, -1.0)] {
                if passes(low) {
                    flat = flat.max(self.flatness(cosine));
                }
            }
        }
        degrees(Complex64::new(flat, (1.0 - flat * flat).max(0.0).sqrt()))
    }

    fn swing(&self, directions: &[Complex64], along: &[f64]) -> f64 {
        if self.reach == Reach::Round {
            return 360.0;
        }
        let by = |k: &&usize, j: &&usize| along[**k].total_cmp(&along[**j]);
        let places: Vec<usize> = (0..along.len()).collect();
        let (Some(&first), Some(&last)) = (places.iter().min_by(by), places.iter().max_by(by))
        else {
            return 0.0;
        };
        let angle = degrees(directions[last] * directions[first].conj());
        if angle < 0.0 { angle + 360.0 } else { angle }
    }
}
