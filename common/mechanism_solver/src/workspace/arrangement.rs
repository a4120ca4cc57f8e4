//! Arrangement: circles that cut each other into arcs, with places beside each arc.
//!
//! Every region of the plane that the circles leave has an arc of one of them on its border, so that the places on both sides
//! of all arcs are in all regions.

use super::circle::{Arc, Circle, TOUCHING};
use num_complex::Complex64;

/// Arcs below this extent, in degrees, are taken for points: meets of three circles in one point differ by rounding, and among
/// thousands of arcs some are short by chance. An arc so short changes the area by 1e-6 of the drawing's at most.
const SHORTEST: f64 = 1e-4;
/// Places along an arc of which the clearest are asked for, in parts of its extent.
const PLACES: [f64; 7] = [0.5, 0.382, 0.618, 0.236, 0.764, 0.146, 0.854];
/// The part of the way to the next circle that a place beside an arc is off it.
const ASIDE: f64 = 0.4;

/// Circles, each once, and the arcs between their meets.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrangement {
    /// The circles.
    pub circles: Vec<Circle>,
    /// The circle that stands for each of the given ones.
    pub places: Vec<usize>,
    /// The arcs.
    pub arcs: Vec<CutArc>,
}

/// An arc between two meets.
#[derive(Clone, Debug, PartialEq)]
pub struct CutArc {
    /// Number of the circle.
    pub circle: usize,
    /// The part of the circle.
    pub arc: Arc,
    /// Places beside the arc, the clearest first.
    pub beside: Vec<Beside>,
}

/// A place on either side of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// How far both are from the arc, at most two thirds of their distance to other circles.
    pub clearance: f64,
    /// The place inside of the circle, and the one outside.
    pub sides: [Complex64; 2],
}

impl Arrangement {
    /// The arrangement of circles in a drawing of this size.
    pub fn of(given: &[Circle], size: f64) -> Self {
        let touching = TOUCHING * size;
        let mut circles: Vec<Circle> = Vec::new();
        let mut places = Vec::new();
        for circle in given {
            let place = circles
                .iter()
                .position(|other| other.is_same(circle, touching));
            places.push(place.unwrap_or_else(|| {
                circles.push(*circle);
                circles.len() - 1
            }));
        }
        let mut arcs = Vec::new();
        for (number, circle) in circles.iter().enumerate() {
            let others = || {
                let others = circles
                    .iter()
                    .enumerate()
                    .filter(move |(k, _)| *k != number);
                others.map(|(_, other)| other)
            };
            let meets = others().flat_map(|other| circle.meets(other, touching));
            arcs.extend(cut(meets.collect()).into_iter().map(|arc| CutArc {
                circle: number,
                beside: beside(circle, &arc, others),
                arc,
            }));
        }
        Self {
            circles,
            places,
            arcs,
        }
    }
}

/// The arcs between these directions, in degrees.
fn cut(mut meets: Vec<f64>) -> Vec<Arc> {
    meets.sort_by(f64::total_cmp);
    meets.dedup_by(|next, last| *next - *last < SHORTEST);
    let Some(first) = meets.first().copied() else {
        return vec![Arc {
            start: 0.0,
            extent: 360.0,
        }];
    };
    if meets.len() > 1 && first + 360.0 - meets[meets.len() - 1] < SHORTEST {
        meets.pop();
    }
    let ends = meets.iter().skip(1).copied().chain([first + 360.0]);
    let arcs = std::iter::zip(&meets, ends).map(|(start, end)| Arc {
        start: *start,
        extent: end - start,
    });
    arcs.collect()
}

/// Places beside an arc, the clearest first.
fn beside<'a, Others: Iterator<Item = &'a Circle>>(
    circle: &Circle,
    arc: &Arc,
    others: impl Fn() -> Others,
) -> Vec<Beside> {
    let place = |part: f64| {
        let point = circle.point(arc.start + part * arc.extent);
        let gaps = others().map(|other| other.beyond(point).abs());
        let clearance = ASIDE * gaps.fold(circle.radius, f64::min);
        let outward = (point - circle.center) / circle.radius;
        Beside {
            clearance,
            sides: [-clearance, clearance].map(|way| point + outward * way),
        }
    };
    let mut places = PLACES.map(place).to_vec();
    places.sort_by(|a, b| b.clearance.total_cmp(&a.clearance));
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(x: f64, radius: f64) -> Circle {
        Circle {
            center: Complex64::new(x, 0.0),
            radius,
        }
    }

    #[test]
    fn equal_circles_are_one() {
        let circles = [circle(0.0, 2.0), circle(0.0, 1.0), circle(1e-15, 2.0)];
        let arrangement = Arrangement::of(&circles, 2.0);
        assert_eq!(arrangement.places, [0, 1, 0]);
        assert_eq!(arrangement.arcs.len(), 2);
    }

    #[test]
    fn two_circles_that_meet_have_four_arcs_and_touching_ones_two() {
        assert_eq!(
            Arrangement::of(&[circle(0.0, 1.0), circle(1.5, 1.0)], 2.5)
                .arcs
                .len(),
            4
        );
        let touching = Arrangement::of(&[circle(0.0, 1.0), circle(0.7, 0.3)], 1.0);
        assert_eq!(touching.arcs.len(), 2);
        assert!(touching.arcs.iter().all(|arc| arc.arc.extent == 360.0));
    }

    /// Places beside an arc are in the two regions that it parts: no other circle is between them.
    #[test]
    fn places_beside_an_arc_are_parted_by_it_alone() {
        let circles = [
            circle(0.0, 1.0),
            circle(1.2, 0.9),
            circle(0.4, 0.35),
            circle(0.5, 1.1),
        ];
        let arrangement = Arrangement::of(&circles, 2.0);
        assert!(arrangement.arcs.len() > 8);
        for arc in &arrangement.arcs {
            for beside in &arc.beside {
                for (number, circle) in circles.iter().enumerate() {
                    let [inside, outside] = beside.sides.map(|place| circle.beyond(place) < 0.0);
                    assert_eq!(inside != outside, number == arc.circle);
                }
            }
        }
    }
}
