//! Reach: whether a planar chain of turns reaches a point within the limits of its joints.
//!
//! The postures that make a point form a set without a number where the chain has more than two joints. It is enough to look
//! at finitely many of them.
//!
//! Let F be the set of postures of the free joints that make the point, and B the postures that are within limits: a closed
//! interval for each limited joint, a whole turn for the others. Suppose that F meets B. Both are closed and B is compact, so
//! that the turn q of one limited joint takes its minimum on the part of F in B, in a posture x. Either some limited joint is at
//! the end of its interval in x: then x is among the postures of the chain in which that joint is held there, which has one
//! joint less. Or no limited joint is at an end: then postures of F near x are in B, and q has a local minimum on F in x. If the
//! velocities of the point that the other free joints give spanned the plane, they could be chosen to make up for any change of
//! q, and q would have no minimum. So these velocities lie on one line. Each is at right angles to the way from its joint to the
//! point: the other free joints and the point are on one line. There are finitely many postures in which this is so, for each
//! choice of the directions of the links on that line. When only two joints are free, all postures are looked at. By induction
//! F meets B if and only if one of these finitely many postures is in B.
//!
//! Joints at the ends of a link without length, which joints at limits can leave, count as one joint with the sum of their turns.
//! Where the point is at the first free joint the whole chain can be turned about it: that joint may be held anywhere.

use super::collinear::{extent, signs, signs_from_first};
use super::elbows::{Elbows, elbows};
use super::planar_chain::{BORDER, HeldChain, PlanarChain};
use crate::postures::is_within;
use cognate_kinematics::mechanism::exact::radians;
use cognate_kinematics::plane::modulus;
use num_complex::Complex64;

/// Most joints of a chain with limits of which the reach is searched: the number of postures grows as 4^n.
pub const MOST_JOINTS: usize = 4;

/// Where a point is for a chain without limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ring {
    /// Between the inner and the outer circle.
    Inside,
    /// On one of the circles, up to rounding.
    Border,
    /// The point is too far or too near.
    Outside,
}

/// Where a point at this distance from the base is for links of these lengths.
pub fn ring(lengths: &[f64], distance: f64) -> Ring {
    let sum: f64 = lengths.iter().sum();
    let largest = lengths.iter().copied().fold(0.0, f64::max);
    let inner = (2.0 * largest - sum).max(0.0);
    let near = |radius: f64| (distance - radius).abs() <= BORDER * sum;
    if near(sum) || (inner > 0.0 && near(inner)) {
        Ring::Border
    } else if distance < sum && distance > inner {
        Ring::Inside
    } else {
        Ring::Outside
    }
}

/// Verdict by the postures that were looked at; the larger one of two stands for both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// No posture is within limits.
    Beyond,
    /// A posture may be within limits.
    Doubtful,
    /// A posture is within limits.
    Within,
}

/// Whether a chain makes a point within limits; `None` where that is in doubt.
pub fn reaches(chain: &PlanarChain, point: Complex64) -> Option<bool> {
    let search = Search {
        point,
        none: BORDER * chain.size(),
    };
    match search.verdict(&chain.free(), 0) {
        Verdict::Within => Some(true),
        Verdict::Beyond => Some(false),
        Verdict::Doubtful => None,
    }
}

/// A search for a posture within limits.
struct Search {
    point: Complex64,
    /// Distances below this are none.
    none: f64,
}

impl Search {
    /// Whether a posture of a held chain is within the limits of its free joints. Of these, joints before `first` are not held
    /// in turn: chains in which they are have been searched already.
    fn verdict(&self, held: &HeldChain, first: usize) -> Verdict {
        let distance = modulus(self.point - held.base);
        let lengths = held.lengths();
        if let Some(place) = lengths.iter().position(|length| *length <= self.none)
            && lengths.len() > 1
        {
            return self.verdict(&held.without_link(place), 0);
        }
        let range = |place: &usize| held.ranges[*place];
        let limited: Vec<usize> = (0..held.free.len())
            .filter(|k| range(k).is_some())
            .collect();
        match (ring(&lengths, distance), limited.first()) {
            (Ring::Outside, _) => return Verdict::Beyond,
            (Ring::Border, _) => return Verdict::Doubtful,
            (Ring::Inside, None) => return Verdict::Within,
            (Ring::Inside, Some(_)) => {}
        }
        if held.free.len() == 2 {
            return self.of_two_links(held, &lengths);
        }
        if distance <= self.none {
            let anywhere = range(&0).map_or(0.0, |[low, _]| low);
            return self.verdict(&held.held(0, anywhere), first);
        }
        let mut verdict = self.critical(held, &lengths, limited[0]);
        for place in limited
            .into_iter()
            .filter(|place| held.free[*place] >= first)
        {
            for end in range(&place).into_iter().flatten() {
                if verdict == Verdict::Within {
                    return verdict;
                }
                let next = held.free[place] + 1;
                verdict = verdict.max(self.verdict(&held.held(place, end), next));
            }
        }
        verdict
    }

    /// The postures of a chain with two free joints.
    fn of_two_links(&self, held: &HeldChain, lengths: &[f64]) -> Verdict {
        let pair = [lengths[0], lengths[1]];
        self.of_elbows(elbows(held.base, self.point, pair, self.none), |elbow| {
            let ways = [elbow - held.base, self.point - elbow];
            self.is_within(held, &ways)
        })
    }

    /// The postures in which all free joints but one are on a line with the point.
    fn critical(&self, held: &HeldChain, lengths: &[f64], place: usize) -> Verdict {
        let count = lengths.len();
        let mut verdict = Verdict::Beyond;
        if place == 0 {
            for signs in signs_from_first(count - 1) {
                let reach = extent(&lengths[1..], &signs);
                let pair = [lengths[0], reach.abs()];
                let elbows = elbows(held.base, self.point, pair, self.none);
                verdict = verdict.max(self.of_elbows(elbows, |elbow| {
                    let line = (self.point - elbow) / reach;
                    let first = std::iter::once(elbow - held.base);
                    let ways: Vec<_> = first.chain(signs.iter().map(|sign| line * sign)).collect();
                    self.is_within(held, &ways)
                }));
            }
            return verdict;
        }
        let way = self.point - held.base;
        let line = way / modulus(way);
        for signs in signs(count - 2) {
            let (before, after) = signs.split_at(place - 1);
            let from = held.base + line * extent(lengths, before);
            let to = self.point - line * extent(&lengths[place + 1..], after);
            let elbows = elbows(from, to, [lengths[place - 1], lengths[place]], self.none);
            verdict = verdict.max(self.of_elbows(elbows, |elbow| {
                let along =
                    |signs: &[f64]| signs.iter().map(|sign| line * sign).collect::<Vec<_>>();
                let bent = vec![elbow - from, to - elbow];
                self.is_within(held, &[along(before), bent, along(after)].concat())
            }));
        }
        verdict
    }

    fn of_elbows(&self, elbows: Elbows, is_within: impl Fn(Complex64) -> bool) -> Verdict {
        match elbows {
            Elbows::None => Verdict::Beyond,
            Elbows::Border => Verdict::Doubtful,
            Elbows::Two(both) => match both.into_iter().any(is_within) {
                true => Verdict::Within,
                false => Verdict::Beyond,
            },
        }
    }

    fn is_within(&self, held: &HeldChain, ways: &[Complex64]) -> bool {
        let beyond = violations(held, ways);
        beyond.is_empty()
    }
}

/// Free joints that are beyond their limits where the links of a held chain go these ways.
pub fn violations(held: &HeldChain, ways: &[Complex64]) -> Vec<usize> {
    let turned = |k: usize| ways[k] * held.links[k].conj();
    let is_beyond = |k: &usize| {
        let inner = match k.checked_sub(1) {
            Some(inner) => turned(inner),
            None => Complex64::new(1.0, 0.0),
        };
        let range = held.ranges[*k];
        range.is_some_and(|range| !is_within(range, radians(turned(*k) * inner.conj()), true))
    };
    let places = (0..ways.len()).filter(is_beyond);
    places.map(|k| held.free[k]).collect()
}
