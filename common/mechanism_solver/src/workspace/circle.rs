//! Circle: a circle in the plane, where it meets another one, and its arcs.

use cognate_kinematics::plane::{common_chord, cross, degrees, direction, modulus};
use num_complex::Complex64;

/// Circles whose distances differ from touching by less than this touch, and circles that are nearer than this are one; in parts
/// of the size of the drawing. Rounding of sums of lengths is at 1e-16; a lens so thin has an area below 1e-13.
pub const TOUCHING: f64 = 1e-9;

/// A circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// The centre.
    pub center: Complex64,
    /// The radius, a length.
    pub radius: f64,
}

/// A part of a circle, counterclockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Direction of its begin from the centre, in degrees.
    pub start: f64,
    /// Extent of the arc in degrees, positive; 360 for the whole circle.
    pub extent: f64,
}

impl Circle {
    /// The point in this direction from the centre, in degrees.
    pub fn point(&self, degrees: f64) -> Complex64 {
        self.center + direction(degrees) * self.radius
    }

    /// How far a point is from the circle; positive outside of it.
    pub fn beyond(&self, point: Complex64) -> f64 {
        modulus(point - self.center) - self.radius
    }

    /// Whether it is the same circle up to a distance.
    pub fn is_same(&self, other: &Self, distance: f64) -> bool {
        modulus(self.center - other.center) < distance
            && (self.radius - other.radius).abs() < distance
    }

    /// Directions from the centre, in degrees, in which another circle meets it; one where they touch up to a distance.
    pub fn meets(&self, other: &Self, distance: f64) -> Vec<f64> {
        let way = other.center - self.center;
        let apart = modulus(way);
        let [sum, difference] = [
            self.radius + other.radius,
            (self.radius - other.radius).abs(),
        ];
        let is_concentric = apart < distance;
        if is_concentric || apart > sum + distance || apart < difference - distance {
            return Vec::new();
        }
        let toward = way / apart;
        if apart > sum - distance {
            return vec![degrees(toward)];
        }
        if apart < difference + distance {
            let sign = if self.radius > other.radius {
                1.0
            } else {
                -1.0
            };
            return vec![degrees(toward * sign)];
        }
        let [along, aside] = common_chord(apart, [self.radius, other.radius]);
        [aside, -aside]
            .map(|aside| degrees(toward * Complex64::new(along, aside)))
            .to_vec()
    }

    /// The part of twice the area to the left of an arc that belongs to the arc: the integral of x dy - y dx along it.
    pub fn swept(&self, arc: &Arc) -> f64 {
        let [start, end] = self.ends(arc);
        let turned = arc.extent * (std::f64::consts::PI / 180.0);
        self.radius * self.radius * turned + cross(self.center, end - start)
    }

    /// Both ends of an arc.
    pub fn ends(&self, arc: &Arc) -> [Complex64; 2] {
        [arc.start, arc.start + arc.extent].map(|degrees| self.point(degrees))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(x: f64, y: f64, radius: f64) -> Circle {
        Circle {
            center: Complex64::new(x, y),
            radius,
        }
    }

    #[test]
    fn circles_meet_where_both_distances_are_radii() {
        let (one, other) = (circle(0.3, -0.2, 1.5), circle(1.1, 0.9, 0.8));
        let meets = one.meets(&other, 1e-9);
        assert_eq!(meets.len(), 2);
        for degrees in meets {
            assert!(other.beyond(one.point(degrees)).abs() < 1e-14);
        }
    }

    #[test]
    fn circles_that_touch_meet_once() {
        let outer = circle(0.0, 0.0, 5.3);
        for inside in [circle(1.8, 2.4, 2.3), circle(-3.0, -4.0, 0.3)] {
            let meets = outer.meets(&inside, 1e-9);
            assert_eq!(meets.len(), 1);
            let toward = inside.center / modulus(inside.center);
            assert!(modulus(outer.point(meets[0]) / outer.radius - toward) < 1e-12);
            assert_eq!(inside.meets(&outer, 1e-9).len(), 1);
        }
        assert!(outer.meets(&circle(0.0, 0.0, 2.0), 1e-9).is_empty());
        assert!(outer.meets(&circle(9.0, 0.0, 2.0), 1e-9).is_empty());
    }

    #[test]
    fn a_whole_circle_sweeps_twice_its_area() {
        let whole = Arc {
            start: 17.0,
            extent: 360.0,
        };
        let swept = circle(3.0, -2.0, 0.5).swept(&whole);
        assert!((swept - 2.0 * std::f64::consts::PI * 0.25).abs() < 1e-12);
    }
}
