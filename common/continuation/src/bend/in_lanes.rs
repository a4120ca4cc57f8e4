//! Eight witness points at a time: their digits and bends in lanes of double-doubles.
//!
//! For points from which a correction or two lead to all digits, of as many equations as unknowns, with a matrix that doubles solve
//! with. Any other gets no answer here and is looked at by itself ([`SlicedEquations::refine`]). Which points these are depends on
//! each alone, as does each answer.

use super::{
    AS_SMALL, BESIDE, Bend, CONVERGED, CORRECTIONS, Moving, Number, ROUNDING, ROUNDING_OF_DOUBLES,
    RefinedPoint, SlicedEquations, WELL_CONDITIONED,
};
use cognate_numeric::lanes::called::{DoubleDoubleLanes, WIDTH};
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::lanes::{LaneMask, Lanes};
use cognate_numeric::linear_algebra::inverse::invert;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Mask, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use num_complex::Complex64;

/// Most corrections of a point.
const MOST_ROUNDS: usize = 6;
/// Most of a correction, relative to the point: from there the Jacobian where they began brings it to all digits in these
/// rounds.
const NEAR: f64 = 1e-6;

/// Work space for the witness points of these equations, whose parameters move in this direction; none where points are
/// looked at by themselves.
pub(super) fn bends_in_lanes<'a>(
    equations: &'a SlicedEquations,
    direction: &[Complex64],
) -> Option<BendsInLanes<'a>> {
    let moving = equations.moving.as_ref()?;
    let square = equations.rows() == equations.variables && equations.slices.is_empty();
    square.then(|| BendsInLanes::new(equations, moving, direction))
}

type Wide = DoubleDoubleLanes;
type Doubles = Lanes<WIDTH>;
type Lane = LaneMask<WIDTH>;

/// The bends of witness points, some at a time, with their work space.
pub(super) struct BendsInLanes<'a> {
    equations: &'a Interpreter,
    moving: &'a Interpreter,
    scratch: Scratch<Wide>,
    scratch_of_moving: Scratch<Wide>,
    parameters: Vec<Complex<Wide>>,
    direction: Vec<Complex<Wide>>,
    x: Vec<Complex<Wide>>,
    values: Vec<Complex<Wide>>,
    /// [J | values | how these change with the parameters].
    matrix: Matrix<Wide>,
    /// [J | values | -] at a point slightly beside each witness point.
    beside: Matrix<Wide>,
    /// Sizes of the rows of `beside`.
    sizes_beside: Vec<Doubles>,
    /// [the matrix with its rows scaled | its inverse] in doubles.
    inverse: Matrix<Doubles>,
}

/// Results of the correction of the witness points, lane by lane.
struct Refined {
    /// Lanes that have an answer.
    good: Lane,
    last: Doubles,
    moved: Doubles,
    residual: Doubles,
    condition: Doubles,
}

/// Velocity and acceleration of the points, lane by lane.
struct Moved {
    velocity: Vec<Complex<Wide>>,
    acceleration: Vec<Complex<Wide>>,
    error: Doubles,
}

fn splat(value: f64) -> Doubles {
    Real::from_f64((), value)
}

impl<'a> BendsInLanes<'a> {
    fn new(sliced: &'a SlicedEquations, moving: &'a Moving, direction: &[Complex64]) -> Self {
        let n = sliced.variables;
        let (equations, moving) = (&sliced.equations, &moving.equations);
        let zero = Complex::zero(());
        let constant = |z: &Number| {
            let mut value = Complex::zero(());
            let [re, im] = [z.re, z.im].map(|part| part.parts());
            for k in [1, 0] {
                value.add(&Complex::from_f64((), re[k], im[k]));
            }
            value
        };
        Self {
            equations,
            moving,
            scratch: Evaluate::<Wide>::scratch(equations, ()),
            scratch_of_moving: Evaluate::<Wide>::scratch(moving, ()),
            parameters: sliced.parameters.iter().map(constant).collect(),
            direction: direction
                .iter()
                .map(|z| Complex::from_f64((), z.re, z.im))
                .collect(),
            x: vec![zero; n],
            values: vec![zero; n],
            matrix: Matrix::zeros((), n, n + 2),
            beside: Matrix::zeros((), n, n + 2),
            sizes_beside: vec![splat(1.0); n],
            inverse: Matrix::zeros((), n, 2 * n),
        }
    }
}

impl BendsInLanes<'_> {
    /// The bends of these points, as many as there are lanes at most; `None` where a point is to be looked at by itself.
    pub(super) fn bends(&mut self, points: &[Vec<Complex64>]) -> Vec<Option<(RefinedPoint, Bend)>> {
        // Lanes without a point of their own have the last one.
        for lane in 0..WIDTH {
            let point = &points[lane.min(points.len() - 1)];
            for (x, &z) in self.x.iter_mut().zip(point) {
                x.set_lane(lane, z);
            }
        }
        let (refined, moved) = dispatch_baseline(Bending(self));
        let numbers = |numbers: &[Complex<Wide>], lane: usize| -> Vec<Number> {
            numbers.iter().map(|z| z.single(lane)).collect()
        };
        let answer = |lane: usize| {
            refined.good.lane(lane).then(|| {
                let point = RefinedPoint {
                    point: numbers(&self.x, lane),
                    correction: refined.last.lane(lane),
                    moved: refined.moved.lane(lane),
                    residual: refined.residual.lane(lane),
                    condition: refined.condition.lane(lane),
                };
                let bend = Bend {
                    velocity: numbers(&moved.velocity, lane),
                    acceleration: numbers(&moved.acceleration, lane),
                    error: moved.error.lane(lane),
                };
                (point, bend)
            })
        };
        (0..points.len()).map(answer).collect()
    }
}

/// The points of all lanes.
struct Bending<'r, 'a>(&'r mut BendsInLanes<'a>);

impl Job for Bending<'_, '_> {
    type Output = (Refined, Moved);
    #[inline(always)]
    fn run(self) -> Self::Output {
        let mut refined = self.0.refine();
        let moved = self.0.bend(&mut refined);
        (refined, moved)
    }
}

/// Euclidean length of the vectors.
#[inline(always)]
fn length(values: impl Iterator<Item = Complex<Doubles>>) -> Doubles {
    let mut sum = splat(0.0);
    for z in values {
        sum.add(&z.norm_sqr());
    }
    sum.sqrt();
    sum
}

/// Length of the vectors, or 1, whichever is larger.
#[inline(always)]
fn at_least_one(x: &[Complex<Wide>]) -> Doubles {
    let mut size = length(x.iter().map(Complex::control));
    size.max(&splat(1.0));
    size
}

/// `y = A^-1 b` in doubles, where the inverse stands in the last columns.
#[inline(always)]
fn times_inverse(inverse: &Matrix<Doubles>, b: &[Complex<Wide>], row: usize) -> Complex<Doubles> {
    let n = b.len();
    let mut sum = Complex::zero(());
    for (j, b) in b.iter().enumerate() {
        sum.mul_add(inverse.at(row, n + j), &b.control());
    }
    sum
}

impl BendsInLanes<'_> {
    /// Values and derivatives at the points, and the inverse of the Jacobian with its rows scaled; its condition number
    /// in Frobenius norms, and the sizes of the rows.
    #[inline(always)]
    fn linearize(&mut self, first: bool) -> (Doubles, Vec<Doubles>) {
        let n = self.x.len();
        let (p, q) = (&self.parameters, &self.direction);
        let scratch = &mut self.scratch;
        self.equations
            .linearize(&self.x, p, q, &mut self.matrix, scratch);
        let size =
            |matrix: &Matrix<Wide>, i: usize| length((0..n).map(|j| matrix.at(i, j).control()));
        let mut sizes = Vec::with_capacity(n);
        let mut small = Lane::splat(false);
        for i in 0..n {
            let here = size(&self.matrix, i);
            small = small.or(here.less(&splat(1.0)));
            sizes.push(here);
        }
        // The scales of small rows are taken beside the point, as `SlicedEquations::sizes_beside` has it.
        if first && small.any() {
            let mut step = at_least_one(&self.x);
            step.mul(&splat(BESIDE / (n as f64).sqrt()));
            let mut turn = Complex64::new(0.6, 0.8);
            let mut moved = self.x.clone();
            for x in &mut moved {
                let mut by = Complex::from_f64((), turn.re, turn.im);
                by.scale(&step);
                x.add(&Complex::from_control((), &by));
                turn *= Complex64::new(0.6, 0.8);
            }
            self.equations
                .jacobian(&moved, p, &mut self.beside, scratch);
            for (i, beside) in self.sizes_beside.iter_mut().enumerate() {
                *beside = size(&self.beside, i);
                // A point without small rows has none because of those that share the lanes.
                beside.select(small.not(), &splat(1.0));
            }
        } else if first {
            self.sizes_beside.fill(splat(1.0));
        }
        let mut of_matrix = splat(0.0);
        let mut weights = Vec::with_capacity(n);
        for (i, (at, beside)) in sizes.iter().zip(&self.sizes_beside).enumerate() {
            let weight = weight(at, beside);
            for j in 0..n {
                let mut entry = self.matrix.at(i, j).control();
                entry.scale(&weight);
                of_matrix.add(&entry.norm_sqr());
                self.inverse.at_mut(i, j).set(&entry);
            }
            weights.push(weight);
        }
        invert(&mut self.inverse);
        let mut of_inverse = splat(0.0);
        for i in 0..n {
            for (j, weight) in weights.iter().enumerate() {
                let entry = self.inverse.at_mut(i, n + j);
                of_inverse.add(&entry.norm_sqr());
                entry.scale(weight);
            }
        }
        of_matrix.sqrt();
        of_inverse.sqrt();
        of_matrix.mul(&of_inverse);
        (of_matrix, sizes)
    }

    /// Newton's method with the Jacobian where it began.
    #[inline(always)]
    fn refine(&mut self) -> Refined {
        let n = self.x.len();
        let (condition, _) = self.linearize(true);
        let mut good = condition.less(&splat(WELL_CONDITIONED));
        let (mut last, mut moved) = (splat(f64::INFINITY), splat(0.0));
        let mut settled = Lane::splat(false);
        for i in 0..n {
            self.values[i].set(self.matrix.at(i, n));
        }
        for round in 0..MOST_ROUNDS {
            if round > 0 {
                let (x, p) = (&self.x, &self.parameters);
                self.equations
                    .value(x, p, &mut self.values, &mut self.scratch);
            }
            let mut correction = splat(0.0);
            let size = at_least_one(&self.x);
            for (i, x) in self.x.iter_mut().enumerate() {
                let mut step = times_inverse(&self.inverse, &self.values, i);
                // Points that are settled stay where they are.
                step.select(settled, &Complex::zero(()));
                correction.add(&step.norm_sqr());
                x.sub(&Complex::from_control((), &step));
            }
            correction.sqrt();
            correction.div(&size);
            moved.add(&correction);
            // A point that was not near is looked at by itself.
            good = good.and(correction.less_equal(&splat(NEAR)));
            let mut half = last;
            half.mul(&splat(0.5));
            let rests = half.less_equal(&correction).and(last.less(&splat(1e-25)));
            let converged_lanes = correction.less_equal(&splat(CONVERGED)).or(rests);
            last.select(settled.not(), &correction);
            settled = settled.or(converged_lanes);
            if !good.and(settled.not()).any() {
                break;
            }
        }
        Refined {
            good: good.and(settled),
            last,
            moved,
            residual: splat(0.0),
            condition,
        }
    }

    /// y with J y = `right`, and an estimate of its error.
    #[inline(always)]
    fn solve(
        &mut self,
        right: &[Complex<Wide>],
        condition: &Doubles,
    ) -> (Vec<Complex<Wide>>, Doubles) {
        let n = right.len();
        let mut first = Vec::with_capacity(n);
        for i in 0..n {
            first.push(times_inverse(&self.inverse, right, i));
        }
        let mut y = Vec::with_capacity(n);
        for z in &first {
            y.push(Complex::from_control((), z));
        }
        let size = length(first.iter().copied());
        let mut last = size;
        let mut error = size;
        let mut settled = Lane::splat(false);
        let mut least_part = *condition;
        least_part.mul(&splat(ROUNDING_OF_DOUBLES));
        let mut enough = size;
        enough.mul(condition);
        enough.mul(&splat(ROUNDING));
        for _ in 0..CORRECTIONS {
            for (i, rest) in self.values.iter_mut().enumerate() {
                rest.set(&right[i]);
                for (j, y) in y.iter().enumerate() {
                    rest.mul_sub(self.matrix.at(i, j), y);
                }
            }
            let mut step_size = splat(0.0);
            for (i, y) in y.iter_mut().enumerate() {
                let mut step = times_inverse(&self.inverse, &self.values, i);
                step.select(settled, &Complex::zero(()));
                step_size.add(&step.norm_sqr());
                y.add(&Complex::from_control((), &step));
            }
            step_size.sqrt();
            // Each correction leaves of the error the part that it should, or that the last one did.
            let mut part = step_size;
            part.div(&last);
            part.max(&least_part);
            part.min(&splat(1.0));
            let mut left = step_size;
            left.mul(&part);
            error.select(settled.not(), &left);
            last.select(settled.not(), &step_size);
            settled = settled.or(error.less_equal(&enough));
            if !settled.not().any() {
                break;
            }
        }
        (y, error)
    }

    /// How the points move; and the largest of their equations, of which nothing was known yet.
    #[inline(always)]
    fn bend(&mut self, refined: &mut Refined) -> Moved {
        let n = self.x.len();
        let (condition, sizes) = self.linearize(false);
        refined.good = refined.good.and(condition.less(&splat(WELL_CONDITIONED)));
        let size = at_least_one(&self.x);
        for (i, of_row) in sizes.iter().enumerate() {
            let mut value = self.matrix.at(i, n).control().norm_sqr();
            value.sqrt();
            let mut distance = value;
            distance.div(of_row);
            distance.div(&size);
            value.min(&distance);
            let nothing = value.less_equal(&splat(f64::INFINITY)).not();
            value.select(nothing, &splat(f64::INFINITY));
            refined.residual.max(&value);
        }
        let mut right = Vec::with_capacity(n);
        for i in 0..n {
            let mut value = *self.matrix.at(i, n + 1);
            value.neg();
            right.push(value);
        }
        let (velocity, _) = self.solve(&right, &condition);
        let (p, q) = (&self.parameters, &self.direction);
        let inputs = [&self.x[..], &velocity, p, q].concat();
        let mut derivatives = vec![Complex::zero(()); 2 * n];
        let scratch = &mut self.scratch_of_moving;
        self.moving.value(&[], &inputs, &mut derivatives, scratch);
        let (_, second) = derivatives.split_at(n);
        for (right, second) in right.iter_mut().zip(second) {
            right.set(second);
            right.neg();
        }
        let (acceleration, mut error) = self.solve(&right, &condition);
        let mut size = length(acceleration.iter().map(Complex::control));
        size.add(&length(velocity.iter().map(Complex::control)));
        let mut noise = refined.last;
        noise.add(&splat(ROUNDING));
        noise.mul(&refined.condition);
        noise.mul(&size);
        error.add(&noise);
        Moved {
            velocity,
            acceleration,
            error,
        }
    }
}

/// Computes the scale factor of a row from the sizes `at` and `beside`, which it has at the point and beside it.
#[inline(always)]
fn weight(at: &Doubles, beside: &Doubles) -> Doubles {
    let one = splat(1.0);
    let mut scale = *at;
    scale.max(&one);
    let mut least = *beside;
    least.mul(&splat(AS_SMALL));
    let as_small = at.less(&one).and(beside.less(&one)).and(least.less(at));
    let mut larger = *at;
    larger.max(beside);
    larger.max(&splat(f64::MIN_POSITIVE));
    scale.select(as_small, &larger);
    let mut weight = one;
    weight.div(&scale);
    weight
}

#[cfg(test)]
mod tests {
    use super::super::{exactly, length, rounded};
    use super::*;
    use cognate_systems::transform::slice;

    /// Points near (1 or -1, 2) on a slice of this curve, each as it is found in lanes and by itself.
    fn check(f: &str, fall_back: &[bool]) {
        let text = format!("CONFIG\nEND;\nINPUT\nvariable_group x, y; function f;f = {f};\nEND;\n");
        let system = cognate_systems::formats::read("test", text.as_bytes());
        let system = slice(&system.unwrap().system, 1, 2);
        let number = |re: f64, im: f64| Complex64::new(re, im);
        let slice = [number(-2.0, 0.0), number(0.0, 0.0), number(1.0, 0.0)];
        let direction = [number(0.6, 0.8), number(0.3, -0.1), number(0.2, 0.5)];
        let equations = SlicedEquations::at_parameters(&system, &slice);
        let mut lanes = bends_in_lanes(&equations, &direction).unwrap();
        let far = |k: usize| if fall_back[k] { 1e-3 } else { 1e-10 };
        let points: Vec<Vec<Complex64>> = (0..fall_back.len())
            .map(|k| {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                let by = far(k) * (k + 1) as f64;
                vec![number(sign + by, by), number(2.0, -by)]
            })
            .collect();
        let together: Vec<_> = points.chunks(WIDTH).flat_map(|p| lanes.bends(p)).collect();
        for (k, (lane_bend, point)) in together.iter().zip(&points).enumerate() {
            assert_eq!(lane_bend.is_none(), fall_back[k], "{f} {k}");
            // The result of a point does not depend on the other points in the lanes.
            let by_itself = lanes.bends(std::slice::from_ref(point)).remove(0);
            assert_eq!(lane_bend, &by_itself);
            let Some((refined, bend)) = lane_bend else {
                continue;
            };
            let start: Vec<Number> = point.iter().copied().map(exactly).collect();
            let expected = equations.refine(&start).unwrap();
            let slow = equations.bend(&expected, &direction);
            let same = |a: &[Number], b: &[Number]| {
                let difference = a.iter().zip(b).map(|(a, b)| {
                    let mut a = *a;
                    a.sub(b);
                    rounded(&a)
                });
                length(&difference.collect::<Vec<_>>())
            };
            assert!(same(&refined.point, &expected.point) < 1e-27);
            assert!(same(&bend.velocity, &slow.velocity) < 1e-26, "{f}");
            assert!(same(&bend.acceleration, &slow.acceleration) < 1e-24, "{f}");
            assert!(
                refined.correction < 1e-24 && refined.residual < 1e-26,
                "{refined:?}"
            );
            assert!(bend.error < 1e-22, "{}", bend.error);
            let ratio = refined.condition / expected.condition;
            assert!((0.999..1.001).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn lanes_find_what_points_by_themselves_have() {
        let near = [false; 11];
        check("x^2 - 1 + (y - 2)*(x + y + y^3)", &near);
        // Small beside the points as well: the rows are scaled.
        check(
            "(x^2 - 1 + (y - 2)*(x + 3*y))*(x - 3 + y/1000)/100000",
            &near,
        );
    }

    /// A row that is larger than 1 where the corrections begin and smaller where they end, beside a point at which it is
    /// small from the start.
    #[test]
    fn rows_that_become_small_are_the_same_beside_small_ones() {
        let unit = 13.0f64.sqrt();
        for margin in [1e-9, 1e-8, 3e-8] {
            let scale = (1.0 - margin) / unit;
            let text = format!(
                "CONFIG\nEND;\nINPUT\nvariable_group x, y; function f;f = {scale:e}*(x^2 - 1 + (y - 2)*(x + y));\nEND;\n"
            );
            let system = cognate_systems::formats::read("test", text.as_bytes());
            let system = slice(&system.unwrap().system, 1, 2);
            let number = |re: f64| Complex64::new(re, 0.0);
            let direction = [number(0.6), number(0.3), number(0.2)];
            let slice = [number(-2.0), number(0.0), number(1.0)];
            let equations = SlicedEquations::at_parameters(&system, &slice);
            let mut lanes = bends_in_lanes(&equations, &direction).unwrap();
            let points = [
                vec![number(1.0 + 3e-7), number(2.0)],
                vec![number(-1.0), number(2.0)],
            ];
            let together = lanes.bends(&points);
            assert!(together.iter().all(Option::is_some));
            for (lane_bend, point) in together.iter().zip(&points) {
                assert_eq!(lane_bend, &lanes.bends(std::slice::from_ref(point))[0]);
            }
        }
    }

    #[test]
    fn points_that_are_not_near_are_looked_at_by_themselves() {
        let mut far = [false; 9];
        (far[2], far[8]) = (true, true);
        check("x^2 - 1 + (y - 2)*(x + y)", &far);
        // Two points there are one.
        check("(x^2 - 1)^2 + (y - 2)*(y - 2)", &[true; 3]);
    }
}
