//! Regions: what the output reaches on both sides of every arc of an arrangement, and far from all of them.

use super::arrangement::{Arrangement, Beside};
use super::circle::{Arc, Circle};
use super::reached_point::ReachedPoint;
use cognate_kinematics::plane::modulus;
use num_complex::Complex64;

/// Places beside an arc that are asked for where the clearest is in doubt.
const TRIALS: usize = 3;
/// Places nearer than this to a curve are not asked for, in parts of the drawing's size: limits are met up to 1e-9.
const CLEAREST: f64 = 1e-8;
/// Ends of a boundary's arcs meet up to this, in parts of the drawing's size: arcs that are taken for points are shorter.
const GAP: f64 = 2e-5;

/// Answers for a place in every region.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    arrangement: Arrangement,
    /// Reachability beside each arc: inside of its circle, and outside.
    sides: Vec<[ReachedPoint; 2]>,
    /// Outside of all circles.
    far: ReachedPoint,
    size: f64,
    within_limits: bool,
}

/// The area of the points that are reached.
#[derive(Clone, Debug, PartialEq)]
pub enum Area {
    /// In squares of the length of the file.
    Finite(f64),
    /// Points at any distance are reached.
    Infinite,
    /// The area is in doubt, for this reason.
    Doubtful(String),
}

impl Regions {
    /// Asks for a place in every region that the circles leave, in a drawing of this size.
    pub fn ask<E>(
        circles: &[Circle],
        size: f64,
        within_limits: bool,
        ask: impl Fn(&[Complex64]) -> Result<Vec<ReachedPoint>, E>,
    ) -> Result<Self, E> {
        let arrangement = Arrangement::of(circles, size);
        let unasked =
            || ReachedPoint::in_doubt("in doubt: curves are too near to each other".into());
        let mut sides: Vec<[ReachedPoint; 2]> = arrangement
            .arcs
            .iter()
            .map(|_| [unasked(), unasked()])
            .collect();
        for trial in 0..TRIALS {
            let mut places = Vec::new();
            let mut points = Vec::new();
            for (number, arc) in arrangement.arcs.iter().enumerate() {
                let clear = |beside: &&Beside| beside.clearance > CLEAREST * size;
                let Some(beside) = arc.beside.get(trial).filter(clear) else {
                    continue;
                };
                for side in 0..2 {
                    if sides[number][side].doubts(within_limits).next().is_some() {
                        places.push([number, side]);
                        points.push(beside.sides[side]);
                    }
                }
            }
            for ([number, side], answer) in std::iter::zip(places, ask(&points)?) {
                sides[number][side] = answer;
            }
        }
        let answers = ask(&[far(circles, size)])?;
        Ok(Self {
            arrangement,
            sides,
            far: answers.into_iter().next().unwrap_or_else(unasked),
            size,
            within_limits,
        })
    }

    /// Arcs of the circle that stands for a given one, which bound the points that are reached; `None` where it is in
    /// doubt whether an arc does.
    pub fn bounding_arcs(&self, given: usize) -> Option<Vec<Arc>> {
        let circle = self.arrangement.places[given];
        let arcs = self.arrangement.arcs.iter().zip(&self.sides);
        let arcs = arcs.filter(|(arc, _)| arc.circle == circle);
        let senses: Vec<(Arc, Option<f64>)> = arcs
            .map(|(arc, pair)| (arc.arc, self.sense(pair)))
            .collect();
        let is_in_doubt = senses.iter().any(|(_, sense)| sense.is_none());
        let bounding = senses
            .into_iter()
            .filter(|(_, sense)| sense.is_some_and(|sense| sense != 0.0));
        let bounding: Vec<Arc> = bounding.map(|(arc, _)| arc).collect();
        (!bounding.is_empty() || !is_in_doubt).then_some(bounding)
    }

    /// 1 for an arc that is reached from inside of its circle alone, -1 from outside alone, 0 for an arc that does not bound.
    fn sense(&self, pair: &[ReachedPoint; 2]) -> Option<f64> {
        let [inside, outside] = pair
            .each_ref()
            .map(|side| side.is_reachable(self.within_limits));
        Some(f64::from(u8::from(inside?)) - f64::from(u8::from(outside?)))
    }

    /// The area of the points that are reached, by Green's theorem over the arcs that bound it.
    pub fn area(&self) -> Area {
        let in_doubt =
            |answer: &ReachedPoint| answer.doubts(self.within_limits).next().map(str::to_owned);
        match self.far.is_reachable(self.within_limits) {
            None => return Area::Doubtful(in_doubt(&self.far).unwrap_or_default()),
            Some(true) => return Area::Infinite,
            Some(false) => {}
        }
        let (mut twice, mut gap, mut doubtful) = (0.0, Complex64::default(), Vec::new());
        for (arc, pair) in self.arrangement.arcs.iter().zip(&self.sides) {
            let Some(sense) = self.sense(pair) else {
                doubtful.extend(pair.iter().filter_map(in_doubt));
                continue;
            };
            let circle = &self.arrangement.circles[arc.circle];
            let [start, end] = circle.ends(&arc.arc);
            twice += sense * circle.swept(&arc.arc);
            gap += (end - start) * sense;
        }
        if let Some(first) = doubtful.first() {
            return Area::Doubtful(format!(
                "{} of {} places beside curves are in doubt: {first}",
                doubtful.len(),
                2 * self.sides.len(),
            ));
        }
        // Ends of arcs cancel in pairs only where the boundary is made of closed curves.
        if modulus(gap) > GAP * self.size {
            return Area::Doubtful("in doubt: the arcs of the boundary do not close".into());
        }
        Area::Finite(twice / 2.0)
    }

    /// The largest number of postures of a region, whatever the limits; an error says why there is none.
    pub fn most_postures(&self) -> Result<u64, String> {
        let answers = || self.sides.iter().flatten().chain([&self.far]);
        let is_infinite =
            |answer: &ReachedPoint| answer.reachable == Some(true) && answer.postures.is_none();
        if answers().any(is_infinite) {
            return Err("infinitely many postures make a point".into());
        }
        if let Some(doubt) = answers().find_map(|answer| answer.doubt.clone()) {
            return Err(doubt);
        }
        let most = answers().map(|answer| answer.postures.unwrap_or(0));
        Ok(most.max().unwrap_or(0))
    }
}

/// A place outside of all circles.
fn far(circles: &[Circle], size: f64) -> Complex64 {
    let center = circles
        .first()
        .map_or(Complex64::default(), |circle| circle.center);
    // In no direction of symmetry.
    center + Complex64::new(1.9, 0.83) * size
}
