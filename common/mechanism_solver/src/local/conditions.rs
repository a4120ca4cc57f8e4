//! Conditions: the equations that close a mechanism, as chains of turns and shifts, and their power series.

use super::field::{Constant, Field};
use super::series::{Series, SeriesSpace};
use cognate_kinematics::mechanism::Space;

/// A vector of numbers of the file.
pub type Vector = [Constant; 3];

/// One elementary motion, or a constant one.
#[derive(Clone, Debug)]
pub enum Step {
    /// A constant pose: rotation by rows, and position.
    Fixed(Box<([Vector; 3], Vector)>),
    /// A turn about an axis through a point.
    Turn {
        /// Direction of the axis, of any length.
        axis: Vector,
        /// A point of the axis.
        point: Box<Vector>,
        /// Number of the coordinate.
        coordinate: usize,
        /// Whether the angle is taken negative.
        is_reversed: bool,
    },
    /// A shift.
    Shift {
        /// Direction of the shift, of any length.
        axis: Vector,
        /// Number of the coordinate.
        coordinate: usize,
        /// Whether the shift is taken negative.
        is_reversed: bool,
    },
    /// A rotation by three coordinates, those of Cayley, after a constant one.
    Spin {
        /// The rotation at the configuration, by rows.
        at: Box<[Vector; 3]>,
        /// Number of the first coordinate.
        coordinate: usize,
    },
}

/// Where a coordinate stands; the coordinate of the series is the half-tangent of the turn from there, or the shift from there
/// in parts of the size.
#[derive(Clone, Debug)]
pub enum Value {
    /// Cosine and sine.
    Turn([Constant; 2]),
    /// A length.
    Shift(Constant),
    /// One of the coordinates of a [`Step::Spin`], which are 0.
    Spin,
}

/// A point at the end of a chain of steps.
#[derive(Clone, Debug)]
pub struct Place {
    /// The steps, from the ground.
    pub steps: Vec<Step>,
    /// The point in the last frame.
    pub point: Vector,
}

/// The square of a distance that must be.
#[derive(Clone, Debug)]
pub enum Square {
    /// A number.
    Number(Constant),
    /// A number that differs by a coordinate, in parts of the size's square.
    Changed {
        /// The number where the coordinate is 0.
        square: Constant,
        /// Number of the coordinate.
        coordinate: usize,
    },
    /// That of two points.
    Between(Box<[Place; 2]>),
}

/// A coordinate in a slice.
#[derive(Clone, Debug)]
pub struct Weighted {
    /// The weight.
    pub weight: Constant,
    /// The coordinate's value at the configuration.
    pub offset: Constant,
}

/// A condition on the coordinates of an assembly.
#[derive(Clone, Debug)]
pub enum Condition {
    /// The product of these steps is the identity.
    Loop(Vec<Step>),
    /// Two points coincide.
    Meet(Box<[Place; 2]>),
    /// A combination of the coordinates, less their offsets, with these weights.
    Slice(Vec<Weighted>),
    /// The square of the distance of two points.
    Distance(Box<([Place; 2], Square)>),
}

/// A pose of series.
#[derive(Clone, Debug)]
pub struct SeriesPose<E> {
    /// The rotation by rows.
    pub rotation: [[Series<E>; 3]; 3],
    /// The position.
    pub position: [Series<E>; 3],
}

/// Evaluates steps and conditions for coordinates that are series.
pub struct Evaluation<'a, F: Field> {
    /// The space of the series.
    pub space: &'a SeriesSpace<'a, F>,
    /// Where the coordinates stand.
    pub values: &'a [Value],
    /// The coordinates, 0 at the configuration.
    pub coordinates: &'a [Series<F::Element>],
    /// A length of the mechanism: conditions on lengths are divided by it, and shifts are in parts of it.
    pub size: &'a Constant,
}

impl<F: Field> Evaluation<'_, F> {
    fn constant(&self, constant: &Constant) -> Series<F::Element> {
        self.space.constant(self.space.field.constant(constant))
    }

    fn number(&self, n: i64) -> Series<F::Element> {
        self.constant(&Constant::integer(n))
    }

    fn dot(&self, a: [&Series<F::Element>; 3], b: [&Series<F::Element>; 3]) -> Series<F::Element> {
        let product = |k: usize| self.space.multiply(a[k], b[k]);
        let sum = self.space.add(&product(0), &product(1));
        self.space.add(&sum, &product(2))
    }

    fn vector(&self, vector: &Vector) -> [Series<F::Element>; 3] {
        vector.each_ref().map(|c| self.constant(c))
    }

    /// The identity.
    pub fn identity(&self) -> SeriesPose<F::Element> {
        let entry = |i: usize, j: usize| self.number(i64::from(i == j));
        SeriesPose {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
            position: std::array::from_fn(|_| self.number(0)),
        }
    }

    /// The image of a point.
    pub fn image(
        &self,
        pose: &SeriesPose<F::Element>,
        point: &[Series<F::Element>; 3],
    ) -> [Series<F::Element>; 3] {
        std::array::from_fn(|i| {
            let turned = self.dot(pose.rotation[i].each_ref(), point.each_ref());
            self.space.add(&turned, &pose.position[i])
        })
    }

    fn then(
        &self,
        first: &SeriesPose<F::Element>,
        second: &SeriesPose<F::Element>,
    ) -> SeriesPose<F::Element> {
        let entry = |i: usize, j: usize| {
            let column = std::array::from_fn(|k| &second.rotation[k][j]);
            self.dot(first.rotation[i].each_ref(), column)
        };
        SeriesPose {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
            position: self.image(first, &second.position),
        }
    }

    /// The product of steps.
    pub fn pose(&self, steps: &[Step]) -> SeriesPose<F::Element> {
        let mut pose = self.identity();
        for step in steps {
            pose = self.then(&pose, &self.step(step));
        }
        pose
    }

    fn step(&self, step: &Step) -> SeriesPose<F::Element> {
        match step {
            Step::Fixed(pose) => SeriesPose {
                rotation: pose.0.each_ref().map(|row| self.vector(row)),
                position: self.vector(&pose.1),
            },
            Step::Turn {
                axis,
                point,
                coordinate,
                is_reversed,
            } => self.turn(axis, point, *coordinate, *is_reversed),
            Step::Shift {
                axis,
                coordinate,
                is_reversed,
            } => {
                let size = self.space.field.constant(self.size);
                let mut shift = self.space.scale(&self.coordinates[*coordinate], size);
                if let Value::Shift(at) = &self.values[*coordinate] {
                    shift = self.space.add(&shift, &self.constant(at));
                }
                let length = self.space.field.constant(&Constant::length(axis));
                let mut over = self.space.field.inverse(length);
                if *is_reversed {
                    over = self.space.field.subtract(self.space.field.zero(), over);
                }
                let shift = self.space.scale(&shift, over);
                let along = |c: &Constant| {
                    let factor = self.space.field.constant(c);
                    self.space.scale(&shift, factor)
                };
                SeriesPose {
                    position: axis.each_ref().map(along),
                    ..self.identity()
                }
            }
            Step::Spin { at, coordinate } => self.spin(at, *coordinate),
        }
    }

    /// I + s K + (1 - c) K^2, where K x is the product of the axis's direction and x.
    fn turn(
        &self,
        axis: &Vector,
        point: &Vector,
        coordinate: usize,
        is_reversed: bool,
    ) -> SeriesPose<F::Element> {
        let (space, field) = (self.space, self.space.field);
        let t = &self.coordinates[coordinate];
        let square = space.multiply(t, t);
        let one = self.number(1);
        let over = space.inverse(&space.add(&one, &square));
        let cosine = space.multiply(&space.subtract(&one, &square), &over);
        let twice = space.add(t, t);
        let sine = space.multiply(&twice, &over);
        let (mut c, mut s) = (cosine.clone(), sine.clone());
        if let Value::Turn(at) = &self.values[coordinate] {
            let [ca, sa] = at.each_ref().map(|x| field.constant(x));
            c = space.subtract(&space.scale(&cosine, ca), &space.scale(&sine, sa));
            s = space.add(&space.scale(&cosine, sa), &space.scale(&sine, ca));
        }
        if is_reversed {
            s = space.subtract(&self.number(0), &s);
        }
        let over = field.inverse(field.constant(&Constant::length(axis)));
        let unit = axis
            .each_ref()
            .map(|c| field.multiply(field.constant(c), over));
        let [x, y, z] = unit;
        let minus = |a: F::Element| field.subtract(field.zero(), a);
        let cross = [
            [field.zero(), minus(z), y],
            [z, field.zero(), minus(x)],
            [minus(y), x, field.zero()],
        ];
        let versine = space.subtract(&one, &c);
        let rotation: [[Series<F::Element>; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let twice = (0..3).fold(field.zero(), |sum, k| {
                    field.add(sum, field.multiply(cross[i][k], cross[k][j]))
                });
                let odd = space.scale(&s, cross[i][j]);
                let even = space.scale(&versine, twice);
                let sum = space.add(&odd, &even);
                space.add(&sum, &self.number(i64::from(i == j)))
            })
        });
        let point = self.vector(point);
        let position = std::array::from_fn(|i| {
            let turned = self.dot(rotation[i].each_ref(), point.each_ref());
            space.subtract(&point[i], &turned)
        });
        SeriesPose { rotation, position }
    }

    /// The rotation of the quaternion (1, w), after a constant one.
    fn spin(&self, at: &[Vector; 3], coordinate: usize) -> SeriesPose<F::Element> {
        let space = self.space;
        let w: [&Series<F::Element>; 3] =
            std::array::from_fn(|k| &self.coordinates[coordinate + k]);
        let one = self.number(1);
        let square = self.dot(w, w);
        let over = space.inverse(&space.add(&one, &square));
        let diagonal = space.subtract(&one, &square);
        let entry = |i: usize, j: usize| {
            let mut sum = space.multiply(w[i], w[j]);
            if i != j {
                let k = 3 - i - j;
                sum = match (3 + j - i) % 3 {
                    1 => space.subtract(&sum, w[k]),
                    _ => space.add(&sum, w[k]),
                };
            }
            let mut sum = space.add(&sum, &sum);
            if i == j {
                sum = space.add(&sum, &diagonal);
            }
            space.multiply(&sum, &over)
        };
        let turned = SeriesPose {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
            position: std::array::from_fn(|_| self.number(0)),
        };
        let first = SeriesPose {
            rotation: at.each_ref().map(|row| self.vector(row)),
            position: std::array::from_fn(|_| self.number(0)),
        };
        self.then(&first, &turned)
    }

    /// A place.
    pub fn place(&self, place: &Place) -> [Series<F::Element>; 3] {
        let pose = self.pose(&place.steps);
        self.image(&pose, &self.vector(&place.point))
    }

    fn square_between(&self, places: &[Place; 2]) -> Series<F::Element> {
        let [a, b] = places.each_ref().map(|place| self.place(place));
        let apart: [_; 3] = std::array::from_fn(|k| self.space.subtract(&a[k], &b[k]));
        self.dot(apart.each_ref(), apart.each_ref())
    }

    fn square(&self, square: &Square) -> Series<F::Element> {
        match square {
            Square::Number(square) => self.constant(square),
            Square::Changed { square, coordinate } => {
                let size = self.space.field.constant(self.size);
                let change = self.space.scale(&self.coordinates[*coordinate], size);
                let change = self.space.scale(&change, size);
                self.space.add(&self.constant(square), &change)
            }
            Square::Between(places) => self.square_between(places),
        }
    }

    /// Series that vanish if the condition holds, as many as the condition takes freedoms in this space.
    pub fn residuals(&self, condition: &Condition, within: Space) -> Vec<Series<F::Element>> {
        let space = self.space;
        let axes = if within == Space::Planar { 2 } else { 3 };
        let over = space.field.inverse(space.field.constant(self.size));
        let lengths = |vector: [Series<F::Element>; 3]| {
            let parts = vector.into_iter().take(axes);
            parts.map(|x| space.scale(&x, over)).collect::<Vec<_>>()
        };
        match condition {
            Condition::Loop(steps) => {
                let pose = self.pose(steps);
                let odd =
                    |i: usize, j: usize| space.subtract(&pose.rotation[i][j], &pose.rotation[j][i]);
                let mut list = match within {
                    Space::Planar => vec![odd(1, 0)],
                    _ => vec![odd(2, 1), odd(0, 2), odd(1, 0)],
                };
                if within != Space::Spherical {
                    list.extend(lengths(pose.position));
                }
                list
            }
            Condition::Meet(places) => {
                let [a, b] = places.each_ref().map(|place| self.place(place));
                lengths(std::array::from_fn(|k| space.subtract(&a[k], &b[k])))
            }
            Condition::Slice(list) => {
                let mut sum = self.number(0);
                for (coordinate, weighted) in self.coordinates.iter().zip(list) {
                    let apart = space.subtract(coordinate, &self.constant(&weighted.offset));
                    let weight = space.field.constant(&weighted.weight);
                    sum = space.add(&sum, &space.scale(&apart, weight));
                }
                vec![sum]
            }
            Condition::Distance(parts) => {
                let square = self.square_between(&parts.0);
                let gap = space.subtract(&square, &self.square(&parts.1));
                vec![space.scale(&space.scale(&gap, over), over)]
            }
        }
    }

    /// The entries of the rotation of a loop that are 1 on its diagonal where it closes; it may be turned by half a turn
    /// where only its odd parts are 0.
    pub fn traces(&self, condition: &Condition) -> Option<F::Element> {
        let Condition::Loop(steps) = condition else {
            return None;
        };
        let pose = self.pose(steps);
        let field = self.space.field;
        Some((0..3).fold(field.zero(), |sum, i| {
            field.add(sum, pose.rotation[i][i][0])
        }))
    }
}
