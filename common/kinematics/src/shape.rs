//! Shapes of a mechanism's bodies, to be drawn: bodies have none of their own, so that a link is the rods and faces that
//! join the points of its joints.

use crate::compile::Configuration;
use crate::mechanism::chain::Chain;
use crate::mechanism::exact::Number;
use crate::mechanism::pose::{Pose, cross, frame, unit};
use crate::mechanism::{
    Body, Framework, JointKind, LegKind, Linkage, Mechanism, PLATFORM, Platform, Space, Vector,
    link_name,
};
use num_complex::Complex64;

/// A point or a direction.
type Point = [f64; 3];

const ORIGIN: Point = [0.0; 3];
const UP: Point = [0.0, 0.0, 1.0];
/// Pieces of an arc between two axes on the sphere.
const ARC: usize = 8;

/// A body in its own coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyShape {
    /// Name of the body, as positions have it.
    pub name: String,
    /// Rods.
    pub segments: Vec<[Point; 2]>,
    /// Triangles.
    pub faces: Vec<[Point; 3]>,
}

/// A joint as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMark {
    /// Type of the joint.
    pub kind: JointKind,
    /// The body in which it sits, by number.
    pub body: usize,
    /// Centre of the joint, in coordinates of the body.
    pub point: Point,
    /// Direction of the joint's axis, in coordinates of the body.
    pub axis: Point,
    /// The other body, and the centre there; `None` where the joint is drawn in one body only.
    other: Option<(usize, Point)>,
}

/// How a crank or a slider of a leg stands by its joint's value.
#[derive(Clone, Debug, PartialEq)]
enum DrivenBody {
    /// Centre, axis and the direction at angle 0.
    Crank(Pose),
    /// The place at 0 and the direction.
    Slider(Point, Point),
}

/// Everything that is drawn of a mechanism.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// The bodies; the first stands still.
    pub bodies: Vec<BodyShape>,
    /// Rods between points of two bodies, whose length may change: struts, slides, links between two balls.
    pub rods: Vec<[(usize, Point); 2]>,
    /// The joints.
    pub joints: Vec<JointMark>,
    /// Bodies that stand by a joint's value alone: their number, the joint's name, and how.
    driven: Vec<(usize, String, DrivenBody)>,
    /// Whether centres are directions from the origin.
    spherical: bool,
}

impl Shape {
    /// The shape of a mechanism.
    pub fn of(mechanism: &Mechanism) -> Self {
        match &mechanism.body {
            Body::Chain(chain) => Self::of_chain(chain),
            Body::Linkage(linkage) => Self::of_linkage(linkage, mechanism),
            Body::Platform(platform) => Self::of_platform(platform),
            Body::Framework(framework) => Self::of_framework(framework),
        }
    }

    /// Where the bodies are in a position, in their order; `None` for one of which the position says nothing.
    pub fn poses(&self, position: &Configuration) -> Vec<Option<Pose>> {
        let named = |name: &str| position.bodies.iter().find(|(n, _)| **n == *name);
        let of_name = |(i, body): (usize, &BodyShape)| match named(&body.name) {
            Some((_, pose)) => Some(*pose),
            None => (i == 0).then_some(Pose::IDENTITY),
        };
        let mut poses: Vec<Option<Pose>> = self.bodies.iter().enumerate().map(of_name).collect();
        for (body, joint, way) in &self.driven {
            let value = position.values.iter().find(|(n, _)| **n == **joint);
            poses[*body] = value.map(|(_, value)| match (way, value) {
                (DrivenBody::Crank(zero), value) => value.moved(zero),
                (DrivenBody::Slider(origin, along), value) => {
                    let s = value.real();
                    let [x, y, z] = std::array::from_fn(|k| origin[k] + s * along[k]);
                    Pose::shift(x, y, z)
                }
            });
        }
        for body in 0..poses.len() {
            if poses[body].is_none() {
                poses[body] = self.between_neighbours(body, &poses);
            }
        }
        poses
    }

    /// A body of which positions say nothing, as a link between two balls or on the sphere: by two of its joints. The spin
    /// between balls may be any.
    fn between_neighbours(&self, body: usize, poses: &[Option<Pose>]) -> Option<Pose> {
        let mut neighbour_points = self.joints.iter().filter_map(|joint| {
            let sides = [(joint.body, joint.point), joint.other?];
            let body_side = sides.iter().position(|side| side.0 == body)?;
            let (neighbour, there) = sides[1 - body_side];
            let seen = poses[neighbour]?.point(there.map(Complex64::from));
            Some((sides[body_side].1, real(seen)))
        });
        let ((a, a_seen), (b, b_seen)) = (neighbour_points.next()?, neighbour_points.next()?);
        let along = |a: Point, b: Point| match self.spherical {
            true => frame(ORIGIN, a, Some(b)),
            false => frame(a, std::array::from_fn(|k| b[k] - a[k]), None),
        };
        Some(along(a_seen, b_seen)?.then(&along(a, b)?.inverse()))
    }

    fn body(&mut self, name: impl Into<String>) -> usize {
        self.bodies.push(BodyShape {
            name: name.into(),
            segments: Vec::new(),
            faces: Vec::new(),
        });
        self.bodies.len() - 1
    }

    fn mark(&mut self, kind: JointKind, body: usize, point: Point, axis: Point) {
        let mark = JointMark {
            kind,
            body,
            point,
            axis,
            other: None,
        };
        self.joints.push(mark);
    }

    /// Rows as offset and common normal, joints at the frames before them.
    fn of_chain(chain: &Chain) -> Self {
        let mut shape = Self::default();
        let mut before = shape.body("base");
        let base = real(chain.base.position);
        shape.bodies[before].segments.push([ORIGIN, base]);
        let mut place = (base, real(chain.base.column(2)));
        for (k, joint) in chain.joints.iter().enumerate() {
            let kind = if joint.is_angle {
                JointKind::R
            } else {
                JointKind::P
            };
            shape.mark(kind, before, place.0, place.1);
            let link = shape.body(link_name(k + 1));
            // In the frame after the row: where the common normal begins, and where the offset begins.
            let [c, s] = joint.alpha.direction;
            let foot = [-joint.a, 0.0, 0.0];
            let start = [-joint.a, -s * joint.d, -c * joint.d];
            if joint.is_angle {
                shape.bodies[link].segments.push([start, foot]);
            } else {
                shape.rods.push([(before, place.0), (link, foot)]);
            }
            shape.bodies[link].segments.push([foot, ORIGIN]);
            (before, place) = (link, (ORIGIN, UP));
        }
        let tool = real(chain.tool.position);
        shape.bodies[before].segments.push([ORIGIN, tool]);
        shape
    }

    /// A link by the points of its joints; on the sphere by arcs between their axes.
    fn of_linkage(linkage: &Linkage, mechanism: &Mechanism) -> Self {
        let space = mechanism.space;
        let mut shape = Self {
            spherical: space == Space::Spherical,
            ..Self::default()
        };
        // The ground comes first.
        let mut order: Vec<usize> = (0..linkage.links.len()).collect();
        order.sort_by_key(|l| (*l != linkage.ground, *l));
        let number = |link: usize| order.iter().position(|l| *l == link).unwrap_or(0);
        for link in &order {
            shape.body(&linkage.links[*link]);
        }
        let mut points = vec![Vec::new(); order.len()];
        for joint in &linkage.joints {
            let [place, other] = [0, 1].map(|side| {
                let axis = numbers(&joint.sides[side].axis);
                let point = match space {
                    Space::Spherical => unit(axis).unwrap_or(UP),
                    _ => numbers(&joint.sides[side].point),
                };
                (number(joint.links[side]), point, axis)
            });
            for (body, point, _) in [place, other] {
                points[body].push(point);
            }
            shape.joints.push(JointMark {
                kind: joint.kind,
                body: place.0,
                point: place.1,
                axis: place.2,
                other: Some((other.0, other.1)),
            });
            // Two bodies that slide on each other are joined by a line.
            if matches!(joint.kind, JointKind::P | JointKind::C | JointKind::E) {
                shape.rods.push([(place.0, place.1), (other.0, other.1)]);
            }
        }
        // The point that is asked for belongs to its link.
        if let Some(output) = &mechanism.output
            && let Some(link) = linkage.links.iter().position(|l| *l == output.link)
            && let Some(point) = &output.point
        {
            points[number(link)].push(numbers(point));
        }
        for (body, points) in shape.bodies.iter_mut().zip(&points) {
            match space {
                Space::Spherical => body.segments = arcs(points),
                _ => (body.segments, body.faces) = spanned(points),
            }
        }
        shape
    }

    /// Base and platform by the points of the legs, and the legs.
    fn of_platform(platform: &Platform) -> Self {
        let mut shape = Self::default();
        let ground = shape.body("base");
        let moving = shape.body(PLATFORM);
        let (mut below, mut above) = (Vec::new(), Vec::new());
        for leg in &platform.legs {
            let to = numbers(&leg.to);
            above.push(to);
            let (foot, head) = match &leg.kind {
                LegKind::Strut { from, .. } => {
                    let from = numbers(from);
                    shape.mark(JointKind::S, ground, from, UP);
                    (from, (ground, from))
                }
                LegKind::Crank {
                    center,
                    axis,
                    zero,
                    length,
                    ..
                } => shape.crank(&leg.name, [center, axis, &**zero], length),
                LegKind::Slider {
                    origin, direction, ..
                } => {
                    let (origin, along) = (numbers(origin), numbers(direction));
                    let along = unit(along).unwrap_or(UP);
                    let body = shape.body(format!("slider of {}", leg.name));
                    let way = DrivenBody::Slider(origin, along);
                    shape.driven.push((body, leg.name.clone(), way));
                    shape.rods.push([(ground, origin), (body, ORIGIN)]);
                    shape.mark(JointKind::P, ground, origin, along);
                    shape.mark(JointKind::S, body, ORIGIN, UP);
                    (origin, (body, ORIGIN))
                }
            };
            below.push(foot);
            shape.rods.push([head, (moving, to)]);
            shape.mark(JointKind::S, moving, to, UP);
        }
        for (body, points) in [(ground, below), (moving, above)] {
            (shape.bodies[body].segments, shape.bodies[body].faces) = spanned(&points);
        }
        shape
    }

    /// A crank in the base: its centre, and its tip as a point of its body.
    fn crank(
        &mut self,
        leg: &str,
        [center, axis, zero]: [&Vector; 3],
        length: &Number,
    ) -> (Point, (usize, Point)) {
        let (center, axis) = (numbers(center), unit(numbers(axis)).unwrap_or(UP));
        let x = unit(numbers(zero)).unwrap_or([1.0, 0.0, 0.0]);
        let y = cross(axis, x);
        let rotation = std::array::from_fn(|k| [x[k], y[k], axis[k]]);
        let body = self.body(format!("crank of {leg}"));
        let way = DrivenBody::Crank(Pose::real(rotation, center));
        self.driven.push((body, leg.to_owned(), way));
        let tip = [length.to_f64(), 0.0, 0.0];
        self.bodies[body].segments.push([ORIGIN, tip]);
        self.mark(JointKind::R, 0, center, axis);
        self.mark(JointKind::S, body, tip, UP);
        (center, (body, tip))
    }

    /// Points, and bars between them.
    fn of_framework(framework: &Framework) -> Self {
        let mut shape = Self::default();
        for name in &framework.points {
            let body = shape.body(name);
            shape.mark(JointKind::R, body, ORIGIN, UP);
        }
        let bars = framework.bars.iter();
        shape.rods = bars.map(|bar| bar.between.map(|p| (p, ORIGIN))).collect();
        shape
    }
}

/// The real part, which is all that is drawn.
fn real(v: [Complex64; 3]) -> Point {
    v.map(|c| c.re)
}

fn numbers(v: &Vector) -> Point {
    std::array::from_fn(|k| v[k].to_f64())
}

/// Rods and faces over points: two are joined by a rod, more by a fan of triangles with its rim.
fn spanned(points: &[Point]) -> (Vec<[Point; 2]>, Vec<[Point; 3]>) {
    let mut corners: Vec<Point> = Vec::new();
    for point in points {
        if !corners.contains(point) {
            corners.push(*point);
        }
    }
    match corners.as_slice() {
        [] | [_] => (Vec::new(), Vec::new()),
        [a, b] => (vec![[*a, *b]], Vec::new()),
        polygon => {
            let next = |k: usize| polygon[(k + 1) % polygon.len()];
            let rim = (0..polygon.len()).map(|k| [polygon[k], next(k)]).collect();
            let fan = (1..polygon.len() - 1).map(|k| [polygon[0], polygon[k], next(k)]);
            (rim, fan.collect())
        }
    }
}

/// Arcs of great circles between each unit vector and the next.
fn arcs(points: &[Point]) -> Vec<[Point; 2]> {
    let pairs = points.iter().zip(points.iter().skip(1));
    let mut pieces: Vec<[Point; 2]> = pairs.flat_map(|(a, b)| arc(*a, *b)).collect();
    if let [first, _, .., last] = points {
        pieces.extend(arc(*last, *first));
    }
    pieces
}

fn arc(a: Point, b: Point) -> Vec<[Point; 2]> {
    let at = |k: usize| {
        let t = k as f64 / ARC as f64;
        unit(std::array::from_fn(|i| (1.0 - t) * a[i] + t * b[i])).unwrap_or(a)
    };
    (0..ARC).map(|k| [at(k), at(k + 1)]).collect()
}
