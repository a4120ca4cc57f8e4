//! Spatial dyads: every chain of two or three joints between the ground and a body that takes the body through given poses.
//!
//! With the first pose as the frame, pose j moves a point x of the body to x + M x + d, where M is its rotation less the
//! identity. Each kind of chain keeps one or more quantities equal in all poses. In the first four kinds the equations are linear
//! in the unknowns of the ground and in those of the body, so that the two-homogeneous number of solutions is also the number for
//! general poses (Bottema and Roth: Theoretical Kinematics, 1979; Innocenti 1995 for 20). The numbers of the last two are those of
//! Su, McCarthy and Watson (2004); v is M b + d, the displacement of b.
//!
//! | chain | keeps equal | equation of a pose | unknowns | poses | solutions |
//! |---|---|---|---|---|---|
//! | SS | distance of points a, b | d.d/2 + d.(b + M b) - d.a - a.(M b) = 0 | a, b | 7 | 20 |
//! | PPS | distance of a plane with normal n, and b | n.(M b + d) = 0 | n in P^2, b | 6 | 10 |
//! | RR on a sphere | angle of directions a, b | a.(M b) = 0 | a, b in P^2 | 5 | 6 |
//! | CC | angle and distance of two lines | the same, then six linear ones | directions, moments | 5 | 6 |
//! | CS | distance of a line (point a, direction n) and b | (d.d + 2 d.(b + M b) - 2 a.v) n.n - (n.v) n.(2 b + v) = 0, a.n = 0 | n in P^2, a, b | 8 | 804 |
//! | RPS | b is on a hyperboloid of revolution | d.d + 2 d.(b + M b) - e.v - (m.v) m.(2 b + v) = 0 | e, m, b | 10 | 1024 pairs of m, -m |

mod lines;
pub mod spherical;
#[cfg(test)]
mod tests;

use crate::mechanism::pose::{Pose, cross, dot, unit};
use crate::plane::{degrees, scale};
use cognate_numeric::linear_algebra::least_squares::least_squares;
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::system::{System, VariableGroup};
use num_complex::Complex64;

/// Rotations and places nearer to each other than this, relative to the extent of the places, are one.
const COINCIDENT: f64 = 1e-10;

/// Rotations that are about one direction up to this part of the largest change, or a point that stays up to this part of the
/// extent, are so by what is typed: six digits.
const TYPED: f64 = 1e-5;

/// Relative difference of two roots, at most, that rounding makes of a double one.
const HALF_OF_THE_DIGITS: f64 = 1e-6;

/// A vector or a point in space.
pub type Vector = [f64; 3];

/// Kind of a chain; the first joint is on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Chain {
    /// Two balls: a point of the body stays on a sphere.
    BallBall,
    /// Two sliders and a ball: a point of the body stays in a plane.
    PlaneBall,
    /// Two hinges whose axes meet in the centre of a sphere; only the rotations of the poses count.
    SphericalHinges,
    /// Two cylinder joints: a line of the body keeps its angle and its distance to a line of the ground.
    Cylinders,
    /// A cylinder joint and a ball: a point of the body stays on a circular cylinder.
    CylinderBall,
    /// A hinge, a slider and a ball: a point of the body stays on a hyperboloid of revolution of one sheet, whose rulings are the
    /// places of the slider.
    HingeSliderBall,
}

impl Chain {
    /// Number of poses that leave finitely many chains.
    pub fn poses(self) -> usize {
        match self {
            Self::BallBall => 7,
            Self::PlaneBall => 6,
            Self::SphericalHinges | Self::Cylinders => 5,
            Self::CylinderBall => 8,
            Self::HingeSliderBall => 10,
        }
    }

    /// Number of complex chains for general poses.
    pub fn most(self) -> u64 {
        match self {
            Self::BallBall => 20,
            Self::PlaneBall => 10,
            Self::SphericalHinges | Self::Cylinders => 6,
            Self::CylinderBall => 804,
            Self::HingeSliderBall => 1024,
        }
    }

    /// Number of unknowns of the system.
    pub fn unknowns(self) -> usize {
        3 * self.groups().len()
    }

    /// The unknowns in threes: their letter, and whether they are a direction. The last three are those of the body.
    fn groups(self) -> &'static [(&'static str, bool)] {
        match self {
            Self::BallBall => &[("a", false), ("b", false)],
            Self::PlaneBall => &[("n", true), ("b", false)],
            Self::SphericalHinges | Self::Cylinders => &[("a", true), ("b", true)],
            Self::CylinderBall => &[("n", true), ("a", false), ("b", false)],
            Self::HingeSliderBall => &[("e", false), ("m", false), ("b", false)],
        }
    }

    /// Whether rotations alone determine the directions of its joints.
    fn has_directions_only(self) -> bool {
        matches!(self, Self::SphericalHinges | Self::Cylinders)
    }
}

/// The part of a joint that a chain determines, in the first pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// The centre of a ball.
    Point(Vector),
    /// The direction of an axis through the centre of the sphere, of length 1.
    Direction(Vector),
    /// A line: the point of it that is nearest to the origin, and its direction of length 1.
    Line(Vector, Vector),
    /// A plane: the point of it that is nearest to the origin, and its normal of length 1.
    Plane(Vector, Vector),
    /// A hyperboloid of revolution of one sheet: centre, direction of the axis of length 1, and the tangent of the angle of
    /// its rulings and the axis.
    Hyperboloid(Vector, Vector, f64),
}

/// Meaning of a real solution of the system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// A chain.
    Chain(SpatialDyad),
    /// A point on a surface that no chain of the kind makes: an ellipsoid of revolution, or a hyperboloid of two sheets.
    OtherSurface,
    /// A chain that another solution is with the opposite sign of a direction.
    Repeated,
    /// A direction is 0, or the line of a cylinder joint is not determined.
    Undetermined,
}

/// A real chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialDyad {
    /// The part on the ground.
    pub fixed: Part,
    /// The part on the body, where it is in the first pose.
    pub moving: Part,
    /// Distance of the two; `None` on a sphere, and for a point in a plane. Of a hyperboloid that of its axis and its rulings.
    pub distance: Option<f64>,
    /// Angle of the two in degrees; `None` for balls. Of a hyperboloid that of its axis and its rulings.
    pub angle: Option<f64>,
    /// The largest change of distance and angle over the poses, relative to the extent and in radians.
    pub error: f64,
}

/// Why poses cannot be used; numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpatialPoseFault {
    /// Another number of them is needed.
    #[error("expected {expected} poses, found {given}")]
    Count {
        /// Number that is needed.
        expected: usize,
        /// Number of poses.
        given: usize,
    },
    /// Two of them are one.
    #[error("poses {} and {} are the same; expected different ones", .0 + 1, .1 + 1)]
    Same(usize, usize),
    /// Two rotations are equal, where chains are determined by rotations.
    #[error("poses {} and {} have the same rotation; expected five different ones: chains of a whole family pass these", .0 + 1, .1 + 1)]
    SameRotation(usize, usize),
    /// All rotations are about one direction.
    #[error(
        "all rotations are about one direction: chains of a whole family pass the poses, or none"
    )]
    OneAxis,
    /// A point of the body stays where it is.
    #[error("a point of the body does not move: it is the ball of a whole family of chains")]
    FixedPoint,
    /// Differences of the places overflow or vanish in double precision.
    #[error("the places' extent is {0:e}; expected a number from 1e-290 to 1e290")]
    Extent(f64),
}

/// A displacement from the first pose.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Displacement {
    /// The rotation.
    rotation: [Vector; 3],
    /// The rotation less the identity.
    change: [Vector; 3],
    /// Displacement of the first pose's origin, divided by the scale.
    shift: Vector,
}

impl Displacement {
    fn direction(&self, x: Vector) -> Vector {
        self.rotation.map(|row| dot(row, x))
    }

    fn point(&self, x: Vector) -> Vector {
        plus(self.direction(x), self.shift)
    }
}

/// Poses of a body in space for a kind of chain, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct SpatialPoses {
    chain: Chain,
    /// Displacements from the first pose to all of them, itself included.
    displacements: Vec<Displacement>,
    /// The place of the first pose.
    origin: Vector,
    /// Divisor of lengths: a power of 2.
    scale: f64,
}

fn plus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] + b[k])
}

fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Angle of two vectors, in degrees.
fn angle(a: Vector, b: Vector) -> f64 {
    degrees(Complex64::new(dot(a, b), length(cross(a, b))))
}

impl SpatialPoses {
    /// Checks and scales.
    ///
    /// # Errors
    /// Where there are more or fewer poses than the chain needs, two are one, or they are passed by whole families of chains:
    /// with rotations about one direction, two equal ones where only rotations count, or a point that stays.
    pub fn new(chain: Chain, poses: &[Pose]) -> Result<Self, SpatialPoseFault> {
        let (expected, given) = (chain.poses(), poses.len());
        if given != expected {
            return Err(SpatialPoseFault::Count { expected, given });
        }
        let moves = chain != Chain::SphericalHinges;
        let place = |pose: &Pose| pose.position.map(|z| z.re);
        let origin = place(&poses[0]);
        let apart = |pose: &Pose| length(minus(place(pose), origin));
        let extent = poses.iter().map(apart).fold(0.0, f64::max);
        let scale = match moves && extent > 0.0 {
            true => scale(extent).ok_or(SpatialPoseFault::Extent(extent))?,
            false => 1.0,
        };
        let shift =
            |pose: &Pose| minus(place(pose), origin).map(|x| if moves { x / scale } else { 0.0 });
        let rotations = rotations(poses).into_iter();
        let displacements = rotations.zip(poses).map(|(rotation, pose)| {
            let mut change = rotation;
            (0..3).for_each(|k| change[k][k] -= 1.0);
            Displacement {
                rotation,
                change,
                shift: shift(pose),
            }
        });
        let poses = Self {
            chain,
            displacements: displacements.collect(),
            origin,
            scale,
        };
        poses.check()?;
        Ok(poses)
    }

    /// Refuses poses that are passed by whole families of chains.
    fn check(&self) -> Result<(), SpatialPoseFault> {
        let counts_rotations = self.chain.has_directions_only();
        for (k, later) in self.displacements.iter().enumerate() {
            for (j, earlier) in self.displacements[..k].iter().enumerate() {
                let turns_alike = earlier.rotation == later.rotation;
                if turns_alike && counts_rotations {
                    return Err(SpatialPoseFault::SameRotation(j, k));
                }
                if turns_alike && is_near(&earlier.shift, &later.shift) {
                    return Err(SpatialPoseFault::Same(j, k));
                }
            }
        }
        if self.have_one_axis() {
            return Err(SpatialPoseFault::OneAxis);
        }
        match !counts_rotations && self.have_a_fixed_point() {
            true => Err(SpatialPoseFault::FixedPoint),
            false => Ok(()),
        }
    }

    /// Whether all rotations leave one direction.
    fn have_one_axis(&self) -> bool {
        // At right angles to the axis of a rotation are the rows of its change.
        let rows: Vec<Vector> = self.displacements.iter().flat_map(|d| d.change).collect();
        let longest = |rows: &mut dyn Iterator<Item = Vector>| {
            rows.max_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)))
        };
        let first = longest(&mut rows.iter().copied()).unwrap_or_default();
        let normal = longest(&mut rows.iter().map(|row| cross(first, *row)));
        let tiny = TYPED * length(first);
        normal.and_then(unit).is_none_or(|axis| {
            let mut along = rows.iter().map(|row| dot(*row, axis).abs());
            along.all(|along| along <= tiny)
        })
    }

    /// Whether a point of the body is in one place in all poses.
    fn have_a_fixed_point(&self) -> bool {
        let moved = &self.displacements[1..];
        let column = |k: usize| {
            let rows = moved.iter().flat_map(|d| d.change);
            rows.map(|row| Complex64::from(row[k])).collect()
        };
        let columns: Vec<Vec<Complex64>> = (0..3).map(column).collect();
        let shifts = moved.iter().flat_map(|d| d.shift);
        let right: Vec<Complex64> = shifts.map(|x| Complex64::from(-x)).collect();
        let Some(point) = least_squares(&columns, &right) else {
            return false;
        };
        let point = [0, 1, 2].map(|k| point[k].re);
        let size = 1.0 + length(point);
        let moves = |d: &Displacement| length(minus(d.point(point), point)) > TYPED * size;
        !moved.iter().any(moves)
    }

    /// The kind of chain.
    pub fn chain(&self) -> Chain {
        self.chain
    }

    /// The system of the chain: three unknowns for each of its points and directions; a direction is a homogeneous group. For two
    /// cylinder joints that of their directions.
    ///
    /// # Panics
    /// When that makes no system.
    pub fn system(&self) -> System {
        let mut e = Expressions::new();
        let groups = self.chain.groups();
        let moved = &self.displacements[1..];
        let mut equations: Vec<NodeId> = moved.iter().map(|d| self.equation(&mut e, d)).collect();
        let mut equation_names: Vec<String> = (2..=self.chain.poses())
            .map(|j| format!("pose{j}"))
            .collect();
        if self.chain == Chain::CylinderBall {
            let [direction, point] = [0, 1].map(|group| variables(&mut e, group));
            equations.push(product(&mut e, direction, point));
            equation_names.push("nearest point".into());
        }
        let group = |(k, (_, homogeneous)): (usize, &(&str, bool))| VariableGroup {
            variables: (3 * k..3 * k + 3).collect(),
            homogeneous: *homogeneous,
        };
        let names = groups
            .iter()
            .flat_map(|(letter, _)| (1..=3).map(move |k| format!("{letter}{k}")));
        let system = System {
            expressions: e,
            variables: names.collect(),
            groups: groups.iter().enumerate().map(group).collect(),
            equation_names,
            equations,
            ..System::default()
        };
        if let Err(error) = system.check() {
            panic!("the system of a chain is a system: {error}");
        }
        system
    }

    fn equation(&self, e: &mut Expressions, displacement: &Displacement) -> NodeId {
        let Displacement {
            change,
            shift,
            rotation,
        } = *displacement;
        let last = self.chain.groups().len() as u32 - 1;
        let (first, body) = (variables(e, 0), variables(e, last));
        let turned = change.map(|row| combination(e, row, body));
        if self.chain.has_directions_only() {
            return product(e, first, turned);
        }
        let mut moved = turned;
        for (node, shift) in moved.iter_mut().zip(shift) {
            let shift = number(e, shift);
            *node = e.add(*node, shift);
        }
        if self.chain == Chain::PlaneBall {
            return product(e, first, moved);
        }
        // Half of the change of |b|^2.
        let square = number(e, dot(shift, shift) / 2.0);
        let back: Vector = std::array::from_fn(|k| (0..3).map(|i| shift[i] * rotation[i][k]).sum());
        let along = combination(e, back, body);
        let half = e.add(square, along);
        let two = e.integer(2);
        let group = match self.chain {
            Chain::CylinderBall => variables(e, 1),
            _ => first,
        };
        let of_group = product(e, group, moved);
        if self.chain == Chain::BallBall {
            return e.subtract(half, of_group);
        }
        let (normal, linear) = match self.chain {
            Chain::CylinderBall => {
                let change = e.subtract(half, of_group);
                let length = product(e, first, first);
                let change = e.multiply(change, length);
                (first, e.multiply(two, change))
            }
            _ => {
                let change = e.multiply(two, half);
                (variables(e, 1), e.subtract(change, of_group))
            }
        };
        let (along_moved, along_body) = (product(e, normal, moved), product(e, normal, body));
        let twice = e.multiply(two, along_body);
        let sum = e.add(twice, along_moved);
        let squares = e.multiply(along_moved, sum);
        e.subtract(linear, squares)
    }

    /// The meaning of a real solution of the system, in the order of its unknowns.
    pub fn read(&self, solution: &[Complex64]) -> Reading {
        let part = |(k, (_, is_direction)): (usize, &(&str, bool))| {
            let values = solution.get(3 * k..3 * k + 3)?;
            let values = [values[0], values[1], values[2]];
            match is_direction {
                true => unit(real_direction(values)?),
                false => Some(values.map(|z| z.re)),
            }
        };
        let parts: Option<Vec<Vector>> = self.chain.groups().iter().enumerate().map(part).collect();
        let Some(parts) = parts else {
            return Reading::Undetermined;
        };
        let (a, b) = (parts[0], parts[parts.len() - 1]);
        let point = |x: Vector| Part::Point(self.outside(x));
        let (fixed, moving) = match self.chain {
            Chain::BallBall => (point(a), point(b)),
            Chain::PlaneBall => {
                let nearest = a.map(|c| c * dot(a, self.outside(b)));
                (Part::Plane(nearest, a), point(b))
            }
            Chain::SphericalHinges => (Part::Direction(a), Part::Direction(b)),
            Chain::Cylinders => {
                let Some([first, second]) = lines::lines(&self.displacements[1..], a, b) else {
                    return Reading::Undetermined;
                };
                (self.line(first), self.line(second))
            }
            Chain::CylinderBall => (self.line([parts[1], a]), point(b)),
            Chain::HingeSliderBall => {
                if largest_is_negative(parts[1]) {
                    return Reading::Repeated;
                }
                let Some(surface) = self.hyperboloid(a, parts[1], b) else {
                    return Reading::OtherSurface;
                };
                (surface, point(b))
            }
        };
        Reading::Chain(self.measured(fixed, moving))
    }

    /// The hyperboloid of revolution |x|^2 - e.x - (m.x)^2 = constant through a point; `None` where the surface is another.
    fn hyperboloid(&self, e: Vector, m: Vector, through: Vector) -> Option<Part> {
        let slope = dot(m, m) - 1.0;
        let axis = unit(m)?;
        // The gradient 2 x - e - 2 m (m.x) is 0 in the centre.
        let along = dot(m, e) / -slope;
        let centre: Vector = std::array::from_fn(|k| (e[k] + m[k] * along) / 2.0);
        let away = minus(through, centre);
        let height = dot(axis, away);
        let waist = dot(away, away) - (1.0 + slope) * height * height;
        let is_one_sheet = slope > 0.0 && waist > 0.0 && centre.iter().all(|c| c.is_finite());
        is_one_sheet.then(|| Part::Hyperboloid(self.outside(centre), axis, slope.sqrt()))
    }

    /// A point of the system in the user's unit and frame.
    fn outside(&self, x: Vector) -> Vector {
        std::array::from_fn(|k| self.origin[k] + x[k] * self.scale)
    }

    fn line(&self, [point, direction]: [Vector; 2]) -> Part {
        let through = self.outside(point);
        let along = dot(direction, through);
        Part::Line(minus(through, direction.map(|c| c * along)), direction)
    }

    /// The chain of these parts, with what it keeps equal.
    fn measured(&self, fixed: Part, moving: Part) -> SpatialDyad {
        let at = |d: &Displacement| measure(fixed, self.moved(moving, d));
        let first = measure(fixed, moving);
        let changes = self.displacements.iter().map(|d| {
            let (distance, angle) = at(d);
            let change = |new: Option<f64>, old: Option<f64>, unit: f64| match (new, old) {
                (Some(new), Some(old)) => (new - old).abs() / unit,
                _ => 0.0,
            };
            let by_distance = change(distance, first.0, self.scale);
            by_distance.max(change(angle, first.1, 180.0 / std::f64::consts::PI))
        });
        SpatialDyad {
            fixed,
            moving,
            distance: first
                .0
                .map(f64::abs)
                .filter(|_| self.chain != Chain::PlaneBall),
            angle: first.1,
            error: changes.fold(0.0, f64::max),
        }
    }

    /// A part of the body in another pose.
    fn moved(&self, part: Part, displacement: &Displacement) -> Part {
        let point = |x: Vector| {
            let inside = std::array::from_fn(|k| (x[k] - self.origin[k]) / self.scale);
            self.outside(displacement.point(inside))
        };
        match part {
            Part::Point(x) => Part::Point(point(x)),
            Part::Direction(u) => Part::Direction(displacement.direction(u)),
            Part::Line(x, u) => Part::Line(point(x), displacement.direction(u)),
            Part::Plane(x, u) => Part::Plane(point(x), displacement.direction(u)),
            Part::Hyperboloid(x, u, slope) => {
                Part::Hyperboloid(point(x), displacement.direction(u), slope)
            }
        }
    }

    /// Whether two chains are equal up to half of the digits of a double: a double root that rounding splits.
    pub fn may_be_one(&self, one: &SpatialDyad, other: &SpatialDyad) -> bool {
        let points = |a: Vector, b: Vector| {
            let size = self.scale.max(length(minus(a, self.origin)));
            length(minus(a, b)) <= HALF_OF_THE_DIGITS * size
        };
        let directions = |u: Vector, v: Vector| length(cross(u, v)) <= HALF_OF_THE_DIGITS;
        let parts = |a: Part, b: Part| match (a, b) {
            (Part::Point(a), Part::Point(b)) => points(a, b),
            (Part::Direction(u), Part::Direction(v)) => directions(u, v),
            (Part::Line(a, u), Part::Line(b, v))
            | (Part::Plane(a, u), Part::Plane(b, v))
            | (Part::Hyperboloid(a, u, _), Part::Hyperboloid(b, v, _)) => {
                points(a, b) && directions(u, v)
            }
            _ => false,
        };
        parts(one.fixed, other.fixed) && parts(one.moving, other.moving)
    }

    /// The direction of the body's axis in each pose.
    pub(crate) fn directions(&self, direction: Vector) -> impl Iterator<Item = Vector> + '_ {
        let displacements = self.displacements.iter();
        displacements.map(move |d| d.direction(direction))
    }
}

/// Distance and angle of two parts, where they have them; the distance of a plane and of lines has a sign.
fn measure(fixed: Part, moving: Part) -> (Option<f64>, Option<f64>) {
    match (fixed, moving) {
        (Part::Point(a), Part::Point(b)) => (Some(length(minus(b, a))), None),
        (Part::Plane(p, n), Part::Point(b)) => (Some(dot(n, minus(b, p))), None),
        (Part::Line(p, u), Part::Line(q, v)) => {
            let normal = unit(cross(u, v));
            let distance = normal.map(|n| dot(n, minus(q, p)));
            (distance, Some(angle(u, v)))
        }
        (Part::Direction(u), Part::Direction(v)) => (None, Some(angle(u, v))),
        (Part::Line(p, u), Part::Point(b)) => (Some(length(cross(u, minus(b, p)))), None),
        (Part::Hyperboloid(p, u, slope), Part::Point(b)) => {
            let away = minus(b, p);
            let (radius, height) = (length(cross(u, away)), slope * dot(u, away));
            let waist = (radius - height) * (radius + height);
            let rulings = degrees(Complex64::new(1.0, slope));
            (Some(waist.max(0.0).sqrt()), Some(rulings))
        }
        _ => (None, None),
    }
}

/// Whether the largest coordinate is negative.
fn largest_is_negative(vector: Vector) -> bool {
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    vector.into_iter().fold(0.0, larger) < 0.0
}

/// The real direction that these homogeneous coordinates stand for; `None` where they are 0.
fn real_direction(values: [Complex64; 3]) -> Option<Vector> {
    let largest = values
        .into_iter()
        .max_by(|z, w| z.norm_sqr().total_cmp(&w.norm_sqr()))?;
    (largest.norm_sqr() > 0.0).then(|| values.map(|z| (z / largest).re))
}

fn is_near(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= COINCIDENT)
}

/// Rotations from the first pose. One that is another up to rounding is the same.
fn rotations(poses: &[Pose]) -> Vec<[Vector; 3]> {
    let real = |pose: &Pose| pose.rotation.map(|row| row.map(|z| z.re));
    let first = real(&poses[0]);
    let mut rotations: Vec<[Vector; 3]> = vec![[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
    for pose in &poses[1..] {
        // The product with the transpose of the first rotation.
        let rotation: [Vector; 3] = real(pose).map(|row| first.map(|other| dot(row, other)));
        let is_same = |other: &&[Vector; 3]| is_near(other.as_flattened(), rotation.as_flattened());
        let same = rotations.iter().find(is_same).copied();
        rotations.push(same.unwrap_or(rotation));
    }
    rotations
}

fn number(e: &mut Expressions, value: f64) -> NodeId {
    let exact = Rational::from_f64(value).unwrap_or_default();
    e.constant(ComplexRational::real(exact))
}

/// Three unknowns of the system, by the place of their group.
fn variables(e: &mut Expressions, group: u32) -> [NodeId; 3] {
    [0, 1, 2].map(|k| e.variable(3 * group + k))
}

/// The sum of the products of nodes.
fn product(e: &mut Expressions, a: [NodeId; 3], b: [NodeId; 3]) -> NodeId {
    let products = [0, 1, 2].map(|k| e.multiply(a[k], b[k]));
    let sum = e.add(products[0], products[1]);
    e.add(sum, products[2])
}

/// The sum of the nodes times these numbers.
fn combination(e: &mut Expressions, numbers: Vector, nodes: [NodeId; 3]) -> NodeId {
    let mut sum = e.integer(0);
    for (value, node) in numbers.into_iter().zip(nodes) {
        let factor = number(e, value);
        let term = e.multiply(factor, node);
        sum = e.add(sum, term);
    }
    sum
}
