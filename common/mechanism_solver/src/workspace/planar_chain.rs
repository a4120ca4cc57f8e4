//! PlanarChain: turns in series from the ground to a point, in the plane.

use cognate_kinematics::mechanism::exact::{Angle, Number};
use cognate_kinematics::mechanism::{Joint, JointKind, Linkage, Mechanism, Vector};
use cognate_kinematics::plane::modulus;
use cognate_numeric::rational::Rational;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Distances below this are none, in parts of the sum of the lengths.
pub const BORDER: f64 = 1e-12;

/// A joint of the chain that turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// The joint's name.
    pub name: String,
    /// Least and largest turn of the outer link against the inner one, in radians from home; `None` where every turn is within
    /// limits.
    pub range: Option<[f64; 2]>,
}

/// A chain of turns at home.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarChain {
    /// The place of the first joint, which is joined to the ground.
    pub base: Complex64,
    /// The joints from the ground on.
    pub turns: Vec<Turn>,
    /// Vectors from each joint to the next one, and from the last one to the point, at home.
    pub links: Vec<Complex64>,
    /// Places of the joints and of the point at home, as they are written.
    pub places: Vec<[Number; 2]>,
}

/// A chain of which some joints are held.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldChain {
    /// The place of the first joint that is free.
    pub base: Complex64,
    /// Numbers of the joints that are free, from the ground on.
    pub free: Vec<usize>,
    /// Least and largest turn of each free joint; `None` where every turn is within limits.
    pub ranges: Vec<Option<[f64; 2]>>,
    /// Vectors from each free joint to the next one, and from the last one to the point, where no free joint has
    /// turned.
    pub links: Vec<Complex64>,
}

impl PlanarChain {
    /// The chain of turns from the ground to a point of a link, over all joints of an open chain; `None` where there is none.
    pub fn open(
        mechanism: &Mechanism,
        linkage: &Linkage,
        link: usize,
        place: &Vector,
    ) -> Option<Self> {
        let is_tree = linkage.joints.len() + 1 == linkage.links.len();
        let chain = is_tree.then(|| Self::toward(mechanism, linkage, (link, place), None))??;
        (chain.turns.len() == linkage.joints.len()).then_some(chain)
    }

    /// The chain of turns from the ground to a point of a link, which does not pass one of the joints; `None` where there is
    /// none, or where more than one leads on.
    pub fn toward(
        mechanism: &Mechanism,
        linkage: &Linkage,
        (link, place): (usize, &Vector),
        without: Option<usize>,
    ) -> Option<Self> {
        if !linkage.at_home {
            return None;
        }
        let plane = |v: &Vector| [v[0].clone(), v[1].clone()];
        let mut passed: Vec<usize> = without.into_iter().collect();
        let (mut places, mut turns, mut at) = (vec![plane(place)], Vec::new(), link);
        while at != linkage.ground {
            let joints = linkage.joints.iter().enumerate();
            let mut onward =
                joints.filter(|(j, joint)| !passed.contains(j) && joint.links.contains(&at));
            let (Some((j, joint)), None) = (onward.next(), onward.next()) else {
                return None;
            };
            if joint.kind != JointKind::R {
                return None;
            }
            passed.push(j);
            places.push(plane(&joint.sides[0].point));
            turns.push(Turn {
                name: joint.name.clone(),
                range: range(mechanism, joint, at),
            });
            at = joint.links[usize::from(joint.links[0] == at)];
        }
        places.reverse();
        turns.reverse();
        let points: Vec<Complex64> = places.iter().map(complex).collect();
        Some(Self {
            base: points[0],
            links: points.windows(2).map(|pair| pair[1] - pair[0]).collect(),
            turns,
            places,
        })
    }

    /// The chain with all joints free.
    pub fn free(&self) -> HeldChain {
        HeldChain {
            base: self.base,
            free: (0..self.turns.len()).collect(),
            ranges: self.turns.iter().map(|turn| turn.range).collect(),
            links: self.links.clone(),
        }
    }

    /// The sum of the lengths.
    pub fn size(&self) -> f64 {
        self.links.iter().map(|link| modulus(*link)).sum()
    }

    /// Whether some turn is not within limits.
    pub fn has_limits(&self) -> bool {
        self.turns.iter().any(|turn| turn.range.is_some())
    }

    /// Squared distance of two places, exactly; `None` where one is written as an irrational number.
    pub fn square(&self, one: usize, other: usize) -> Option<Rational> {
        squared_distance(&self.places[one], &self.places[other])
    }
}

impl HeldChain {
    /// The chain with one more joint held, at this turn in radians; `place` counts among the free joints.
    pub fn held(&self, place: usize, radians: f64) -> Self {
        let [re, im] = Angle::of_radians(radians).direction;
        let turned = Complex64::new(re, im);
        let mut chain = self.clone();
        for link in &mut chain.links[place..] {
            *link *= turned;
        }
        let link = chain.links.remove(place);
        chain.free.remove(place);
        chain.ranges.remove(place);
        match place.checked_sub(1) {
            Some(before) => chain.links[before] += link,
            None => chain.base += link,
        }
        chain
    }

    /// The chain without a link that has no length. The joints at its ends are in one place and turn together: their sum is
    /// what turns the next link. Behind the last link there is none, and its joint turns nothing.
    pub fn without_link(&self, place: usize) -> Self {
        let mut chain = self.clone();
        chain.links.remove(place);
        chain.free.remove(place);
        let inner = chain.ranges.remove(place);
        if let Some(outer) = chain.ranges.get_mut(place) {
            let sum = match (inner, *outer) {
                (Some([a, b]), Some([c, d])) => Some([a + c, b + d]),
                _ => None,
            };
            *outer = sum.filter(|[low, high]| high - low < 2.0 * PI);
        }
        chain
    }

    /// Lengths of the links.
    pub fn lengths(&self) -> Vec<f64> {
        self.links.iter().map(|link| modulus(*link)).collect()
    }
}

/// Squared distance of two places, exactly; `None` where one is written as an irrational number.
pub fn squared_distance(one: &[Number; 2], other: &[Number; 2]) -> Option<Rational> {
    let is_exact = one.iter().chain(other).all(|x| x.exact);
    let square = |k: usize| {
        let apart = Rational::from(&one[k].value - &other[k].value);
        Rational::from(&apart * &apart)
    };
    is_exact.then(|| square(0) + square(1))
}

/// The turns of an outer link against the inner one that are within limits; `None` where all are.
fn range(mechanism: &Mechanism, joint: &Joint, outer: usize) -> Option<[f64; 2]> {
    let [low, high] = mechanism.limits_of(&joint.name)?;
    // Values of joints are turns of the second link against the first.
    let range = match joint.links[1] == outer {
        true => [low, high],
        false => [-high, -low],
    };
    (high - low < 2.0 * PI).then_some(range)
}

fn complex(place: &[Number; 2]) -> Complex64 {
    Complex64::new(place[0].to_f64(), place[1].to_f64())
}
