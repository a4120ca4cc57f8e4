//! Bends: how witness points move when their slice moves, to the second order, in double-doubles.
//!
//! Along a slice A x + b + s v = 0 a witness point is a path x(s). The sum of x''(0) over the points of
//! a component is 0, over a proper part of them it is not, with probability 1: a trace test without a
//! path (Brake, Hauenstein, Liddell: Decomposing solution sets of polynomial systems using derivatives,
//! ICMS 2016). Both derivatives are linear equations with the Jacobian at the point. They are solved in doubles by
//! reflections, and corrected; where the matrix is not known to be well-conditioned, by its singular values.

mod in_lanes;
pub mod stage;

use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::orthogonal::Orthogonal;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::scalar::{Complex, DoubleDouble, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use cognate_systems::system::System;
use cognate_systems::transform::along_line;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A number of about 32 digits.
pub type Number = Complex<DoubleDouble<f64>>;

/// Most corrections of a linear solution: each brings about as many digits as a double has, less those of
/// the condition number.
const CORRECTIONS: usize = 3;
/// Rounding error of a solution in double-doubles, relative to it, where the condition number is 1; and of one in doubles.
const ROUNDING: f64 = 1e-31;
const ROUNDING_OF_DOUBLES: f64 = 1e-16;
/// A bound of the condition number below which reflections solve with a matrix; above, singular values tell.
const WELL_CONDITIONED: f64 = 1e6;
/// Most corrections of a point by Newton's method.
const MOST_ROUNDS: usize = 12;
/// A correction this small, relative to the point, is rounding error.
const CONVERGED: f64 = 1e-29;
/// Above this correction the Jacobian is taken again.
const NEAR: f64 = 1e-9;
/// How far beside a point the scales of small rows are taken, relative to the point: there the row of a multiple zero
/// is not small, and that of a product whose other factors are small is as small as at the point.
const BESIDE: f64 = 1e-3;
/// A row may be that of a multiple zero if its size at the point is less than this part of its size beside the point.
const AS_SMALL: f64 = 1e-3;

/// Equations that are regular at their witness points, with the slice that these lie on.
#[derive(Debug)]
pub struct SlicedEquations {
    equations: Interpreter,
    variables: usize,
    /// A row each: the constant, then coefficients of the first variables.
    slices: Vec<Vec<Complex64>>,
    /// Values of the parameters.
    parameters: Vec<Number>,
    /// Work space with the constants rounded, which is copied: rounding them takes longer than an evaluation.
    doubled: Scratch<Double>,
    moving: Option<Moving>,
}

/// First and second derivatives of the equations along a line: where it begins and leads are its parameters.
#[derive(Debug)]
struct Moving {
    equations: Interpreter,
    doubled: Scratch<Double>,
}

type Double = DoubleDouble<f64>;
type Space = Scratch<Double>;

/// Values and derivatives at a point, compiled for the instruction set.
struct Linearize<'a> {
    equations: &'a Interpreter,
    x: &'a [Number],
    parameters: &'a [Number],
    matrix: &'a mut Matrix<Double>,
    scratch: &'a mut Space,
}

impl Job for Linearize<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (x, p) = (self.x, self.parameters);
        self.equations.jacobian(x, p, self.matrix, self.scratch);
    }
}

/// Evaluation of the equations without derivatives.
struct Values<'a> {
    equations: &'a Interpreter,
    x: &'a [Number],
    parameters: &'a [Number],
    values: &'a mut [Number],
    scratch: &'a mut Space,
}

impl Job for Values<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (x, p) = (self.x, self.parameters);
        self.equations.value(x, p, self.values, self.scratch);
    }
}

/// Computes the residual of a linear system: subtracts the matrix times y from the right-hand side `rest`.
struct Rest<'a> {
    matrix: &'a Matrix<Double>,
    y: &'a [Number],
    rest: &'a mut [Number],
}

impl Job for Rest<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (i, rest) in self.rest.iter_mut().enumerate() {
            for (j, y) in self.y.iter().enumerate() {
                rest.mul_sub(self.matrix.at(i, j), y);
            }
        }
    }
}

/// A witness point with all its digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefinedPoint {
    /// Values of the variables at the point.
    pub point: Vec<Number>,
    /// The last correction, relative to the point or to 1, whichever is larger.
    pub correction: f64,
    /// Distance by which all corrections moved the point, in the same unit.
    pub moved: f64,
    /// The largest equation there, in its size or as a part of what a change of the point by its size makes of
    /// it.
    pub residual: f64,
    /// Largest singular value of the Jacobian over the least.
    pub condition: f64,
}

/// Velocity and acceleration of a witness point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bend {
    /// x'.
    pub velocity: Vec<Number>,
    /// x''.
    pub acceleration: Vec<Number>,
    /// Estimated error of x''.
    pub error: f64,
}

/// A matrix that is solved with.
enum Decomposed {
    Reflections(Orthogonal),
    SingularValues(Svd),
}

/// The Jacobian and values, and the Jacobian decomposed with each row scaled.
struct Linearized {
    matrix: Matrix<Double>,
    /// Euclidean length of each row.
    sizes: Vec<f64>,
    weights: Vec<f64>,
    decomposed: Decomposed,
}

impl Linearized {
    /// A row is scaled to at most 1; one that is as small beside the point by its size there.
    fn new(matrix: Matrix<Double>, sizes: Vec<f64>, variables: usize, beside: &[f64]) -> Self {
        let weights = weights(&sizes, beside);
        let rows = matrix.rows();
        if rows >= variables {
            let columns = scaled_columns(&matrix, &weights, variables);
            let reflections = Orthogonal::of(columns, rows, variables);
            if reflections.condition < WELL_CONDITIONED {
                return Self {
                    matrix,
                    sizes,
                    weights,
                    decomposed: Decomposed::Reflections(reflections),
                };
            }
        }
        let svd = singular_values(&matrix, &weights, variables);
        Self {
            matrix,
            sizes,
            weights,
            decomposed: Decomposed::SingularValues(svd),
        }
    }

    /// Condition number of the matrix: largest singular value over the least. A well-conditioned matrix gets an upper
    /// bound, at most as many times larger as there are columns.
    fn condition(&self) -> Option<f64> {
        match &self.decomposed {
            Decomposed::Reflections(reflections) => Some(reflections.condition),
            Decomposed::SingularValues(svd) => Some(svd.values.first()? / svd.values.last()?),
        }
    }

    /// The shortest y for which J y is nearest to these values, as far as doubles tell.
    fn solve(&self, values: &[Complex64]) -> Vec<Complex64> {
        let pairs = values.iter().zip(&self.weights);
        let weighted: Vec<Complex64> = pairs.map(|(z, w)| z * w).collect();
        match &self.decomposed {
            Decomposed::Reflections(reflections) => reflections.least_squares(&weighted),
            Decomposed::SingularValues(svd) => svd.least_squares(&weighted, svd.values.len()),
        }
    }
}

/// Computes the scale factor of each row from its sizes at a point and beside it.
fn weights(sizes: &[f64], beside: &[f64]) -> Vec<f64> {
    let scale = |(i, &size): (usize, &f64)| match beside.get(i) {
        Some(&beside) if beside < 1.0 && size < 1.0 && size > AS_SMALL * beside => {
            size.max(beside).max(f64::MIN_POSITIVE)
        }
        _ => size.max(1.0),
    };
    let sizes = sizes.iter().enumerate();
    sizes.map(|row| 1.0 / scale(row)).collect()
}

/// The matrix in doubles, column after column, each row times its weight.
fn scaled_columns(matrix: &Matrix<Double>, weights: &[f64], variables: usize) -> Vec<Complex64> {
    let mut entries = Vec::with_capacity(weights.len() * variables);
    for j in 0..variables {
        let rows = weights.iter().enumerate();
        entries.extend(rows.map(|(i, weight)| rounded(matrix.at(i, j)) * weight));
    }
    entries
}

fn singular_values(matrix: &Matrix<Double>, weights: &[f64], variables: usize) -> Svd {
    let entries = scaled_columns(matrix, weights, variables);
    let rows = weights.len();
    let column = |j: usize| entries[j * rows..(j + 1) * rows].to_vec();
    Svd::of((0..variables).map(column).collect())
}

/// Euclidean length of each row of a Jacobian.
fn row_sizes(matrix: &Matrix<Double>, variables: usize) -> Vec<f64> {
    let rows = 0..matrix.rows();
    rows.map(|i| {
        let entries = (0..variables).map(|j| rounded(matrix.at(i, j)));
        let largest = entries
            .clone()
            .fold(0.0f64, |m, z| m.max(z.re.abs()).max(z.im.abs()));
        if largest == 0.0 || !largest.is_finite() {
            return largest;
        }
        let parts = entries.map(|z| (z / largest).norm_sqr());
        parts.sum::<f64>().sqrt() * largest
    })
    .collect()
}

/// The number as a double.
pub fn rounded(z: &Number) -> Complex64 {
    Complex64::new(z.re.control(), z.im.control())
}

/// The double as it is.
pub fn exactly(z: Complex64) -> Number {
    Number::from_f64((), z.re, z.im)
}

fn zeros(count: usize) -> Vec<Number> {
    vec![Number::zero(()); count]
}

fn doubles(numbers: &[Number]) -> Vec<Complex64> {
    doubles_of(numbers)
}

/// The numbers as doubles.
pub fn doubles_of(numbers: &[Number]) -> Vec<Complex64> {
    numbers.iter().map(rounded).collect()
}

/// Euclidean length of a vector.
pub fn length(values: &[Complex64]) -> f64 {
    values.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt()
}

impl SlicedEquations {
    /// The equations of a system without parameters, and these slices in its first variables.
    pub fn new(system: &System, slices: Vec<Vec<Complex64>>) -> Self {
        let variables = system.variable_count();
        let (e, equations) = (&system.expressions, &system.equations);
        let equations = Interpreter::compile(e, equations, variables, 0);
        Self {
            doubled: equations.scratch(()),
            moving: None,
            equations,
            variables,
            slices,
            parameters: Vec::new(),
        }
    }

    /// The equations of a system at these values of its parameters, with no slices but those that are among
    /// them. Where they move is known of these alone.
    pub fn at_parameters(system: &System, values: &[Complex64]) -> Self {
        let variables = system.variable_count();
        let (e, equations) = (&system.expressions, &system.equations);
        let equations = Interpreter::compile(e, equations, variables, values.len());
        let (e, derivatives) = along_line(system);
        let moving = Interpreter::of_values(&e, &derivatives, 2 * (variables + values.len()));
        Self {
            doubled: equations.scratch(()),
            moving: Some(Moving {
                doubled: moving.scratch(()),
                equations: moving,
            }),
            equations,
            variables,
            slices: Vec::new(),
            parameters: values.iter().map(|&z| exactly(z)).collect(),
        }
    }

    /// Puts these slices in the place of its own.
    pub fn set_slices(&mut self, slices: Vec<Vec<Complex64>>) {
        self.slices = slices;
    }

    fn rows(&self) -> usize {
        Evaluate::<f64>::shape(&self.equations).equations
    }

    fn linearize(&self, x: &[Number], scratch: &mut Space) -> Matrix<Double> {
        let (rows, n) = (self.rows(), self.variables);
        let mut matrix = Matrix::zeros((), rows, n + 2);
        dispatch_baseline(Linearize {
            equations: &self.equations,
            x,
            parameters: &self.parameters,
            matrix: &mut matrix,
            scratch,
        });
        let mut linearization = Matrix::zeros((), rows + self.slices.len(), n + 1);
        for i in 0..rows {
            for j in 0..=n {
                linearization.at_mut(i, j).set(matrix.at(i, j));
            }
        }
        for (i, slice) in self.slices.iter().enumerate() {
            for (j, &c) in slice[1..].iter().enumerate() {
                linearization.at_mut(rows + i, j).set(&exactly(c));
            }
            let value = slice_at(slice, x);
            linearization.at_mut(rows + i, n).set(&value);
        }
        linearization
    }

    /// The values at a point, of equations and slices.
    fn values_at(&self, x: &[Number], scratch: &mut Space) -> Vec<Number> {
        let mut values = zeros(self.rows());
        dispatch_baseline(Values {
            equations: &self.equations,
            x,
            parameters: &self.parameters,
            values: &mut values,
            scratch,
        });
        values.extend(self.slices.iter().map(|slice| slice_at(slice, x)));
        values
    }

    fn decompose(&self, x: &[Number], beside: &[f64], scratch: &mut Space) -> Linearized {
        let matrix = self.linearize(x, scratch);
        let sizes = row_sizes(&matrix, self.variables);
        Linearized::new(matrix, sizes, self.variables, beside)
    }

    /// The Jacobian at a point with its rows scaled by their sizes beside the point, and these sizes.
    fn decompose_first(&self, x: &[Number], scratch: &mut Space) -> (Linearized, Vec<f64>) {
        let matrix = self.linearize(x, scratch);
        let sizes = row_sizes(&matrix, self.variables);
        let beside = self.sizes_beside(x, &sizes, scratch);
        let made = Linearized::new(matrix, sizes, self.variables, &beside);
        (made, beside)
    }

    /// Sizes of the rows a little beside a point, at which they have these, in a direction in which no
    /// coordinate is special; none where no row is small at the point.
    fn sizes_beside(&self, x: &[Number], at: &[f64], scratch: &mut Space) -> Vec<f64> {
        if at.iter().all(|&size| size >= 1.0) {
            return Vec::new();
        }
        let step = BESIDE * length(&doubles(x)).max(1.0) / (self.variables as f64).sqrt();
        let mut moved = x.to_vec();
        let mut turn = Complex64::new(0.6, 0.8);
        for x in &mut moved {
            x.add(&exactly(turn * step));
            // Powers of (3 + 4i)/5, which is no root of unity.
            turn *= Complex64::new(0.6, 0.8);
        }
        row_sizes(&self.linearize(&moved, scratch), self.variables)
    }

    /// The values and the derivatives by the variables from `first` on, in columns.
    pub fn linear_part(&self, x: &[Number], first: usize) -> (Vec<Complex64>, Vec<Vec<Complex64>>) {
        let matrix = self.linearize(x, &mut self.doubled.clone());
        let column = |j: usize| -> Vec<Complex64> {
            let rows = 0..self.rows();
            rows.map(|i| rounded(matrix.at(i, j))).collect()
        };
        let columns = (first..self.variables).map(column).collect();
        (column(self.variables), columns)
    }

    /// Singular values of the Jacobian of the equations alone at a point, descending; each row scaled to at
    /// most 1.
    pub fn singular_values(&self, x: &[Number]) -> Vec<f64> {
        let linearization = self.linearize(x, &mut self.doubled.clone());
        let sizes = row_sizes(&linearization, self.variables);
        let weights = weights(&sizes[..self.rows()], &[]);
        singular_values(&linearization, &weights, self.variables).values
    }

    /// Computes for each equation its size, and its size as a part of the change that it makes when the point moves by
    /// its own size: about the distance to a zero of the equation.
    pub fn residuals(&self, x: &[Number]) -> Vec<(f64, f64)> {
        let matrix = self.linearize(x, &mut self.doubled.clone());
        let lengths = (0..self.rows()).map(|i| {
            let row: Vec<Complex64> = (0..self.variables)
                .map(|j| rounded(matrix.at(i, j)))
                .collect();
            length(&row)
        });
        let values = (0..self.rows()).map(|i| rounded(matrix.at(i, self.variables)));
        parts_of(x, values, lengths).collect()
    }

    /// The largest equation at a point, as a part of what a change of the point by its size makes of it. `at`: the
    /// Jacobian there, as far as the point was known.
    fn relative_residual(&self, x: &[Number], at: &Linearized, scratch: &mut Space) -> f64 {
        let parts: Vec<(f64, f64)> = match at.decomposed {
            // No row is 0 by rounding error.
            Decomposed::Reflections(_) => {
                let values = self.values_at(x, scratch);
                let values = values[..self.rows()].iter().map(rounded);
                parts_of(x, values, at.sizes.iter().copied()).collect()
            }
            Decomposed::SingularValues(_) => self.residuals(x),
        };
        let parts = parts.into_iter();
        let parts = parts.map(|(value, distance)| value.min(distance));
        parts.fold(
            0.0,
            |m: f64, r| if r.is_nan() { f64::INFINITY } else { m.max(r) },
        )
    }

    /// The values beside a Jacobian.
    fn values(&self, at: &Matrix<Double>) -> Vec<Complex64> {
        let rows = 0..at.rows();
        rows.map(|i| rounded(at.at(i, self.variables))).collect()
    }

    /// Newton's method (of Gauss, where there are more equations than variables) from near a witness point;
    /// `None` where it leaves or does not settle.
    pub fn refine(&self, start: &[Number]) -> Option<RefinedPoint> {
        let mut x = start.to_vec();
        let mut scratch = self.doubled.clone();
        let (mut at, beside) = self.decompose_first(&x, &mut scratch);
        let (mut last, mut moved) = (f64::INFINITY, 0.0);
        for round in 0..MOST_ROUNDS {
            if round > 0 && last > NEAR {
                at = self.decompose(&x, &beside, &mut scratch);
            }
            // Where the Jacobian was taken the values are known.
            let values = match last > NEAR {
                true => self.values(&at.matrix),
                false => doubles(&self.values_at(&x, &mut scratch)),
            };
            let step = at.solve(&values);
            let size = length(&doubles(&x)).max(1.0);
            let correction = length(&step) / size;
            if !correction.is_finite() || correction > 1.0 {
                return None;
            }
            for (x, &step) in x.iter_mut().zip(&step) {
                x.sub(&exactly(step));
            }
            moved += correction;
            let settled = correction <= CONVERGED || (correction >= 0.5 * last && last < 1e-25);
            last = correction;
            if settled {
                break;
            }
        }
        let condition = at.condition()?;
        Some(RefinedPoint {
            residual: self.relative_residual(&x, &at, &mut scratch),
            point: x,
            correction: last,
            moved,
            condition,
        })
    }

    /// y with J y = `right`, in double-doubles, and an estimate of its error.
    fn solve(&self, at: &Linearized, right: &[Number]) -> (Vec<Number>, f64) {
        let condition = at.condition().unwrap_or(f64::INFINITY);
        let first = at.solve(&doubles(right));
        let (size, mut last) = (length(&first), length(&first));
        let mut y: Vec<Number> = first.into_iter().map(exactly).collect();
        let mut error = last;
        for _ in 0..CORRECTIONS {
            let mut rest = right.to_vec();
            dispatch_baseline(Rest {
                matrix: &at.matrix,
                y: &y,
                rest: &mut rest,
            });
            let step = at.solve(&doubles(&rest));
            for (y, &step) in y.iter_mut().zip(&step) {
                y.add(&exactly(step));
            }
            // Each correction leaves of the error the part that it should, or that the last one did.
            let before = std::mem::replace(&mut last, length(&step));
            let part = (last / before).max(condition * ROUNDING_OF_DOUBLES);
            error = last * if part < 1.0 { part } else { 1.0 };
            if error <= condition * ROUNDING * size {
                break;
            }
        }
        (y, error)
    }

    /// The first and the second derivative in s of the equations along x + s u, where the parameters change
    /// by s q.
    fn derivatives(&self, x: &[Number], u: &[Number], q: &[Number]) -> Vec<[Number; 2]> {
        let moving = self.moving.as_ref();
        let moving = moving.expect("where points move is asked of equations with parameters");
        let rows = self.rows();
        let mut values = zeros(2 * rows);
        dispatch_baseline(Values {
            equations: &moving.equations,
            x: &[],
            parameters: &[x, u, &self.parameters, q].concat(),
            values: &mut values,
            scratch: &mut moving.doubled.clone(),
        });
        let (first, second) = values.split_at(rows);
        let pairs = first.iter().zip(second);
        pairs.map(|(first, second)| [*first, *second]).collect()
    }

    /// Computes velocity and acceleration of a witness point when the parameters, all of them, move in this direction.
    pub fn bend(&self, refined: &RefinedPoint, direction: &[Complex64]) -> Bend {
        let x = &refined.point;
        let (at, _) = self.decompose_first(x, &mut self.doubled.clone());
        let moved: Vec<Number> = direction.iter().map(|&v| exactly(v)).collect();
        let mut right = zeros(self.rows());
        let still = zeros(self.variables);
        let values = self.derivatives(x, &still, &moved);
        for (right, [first, _]) in right.iter_mut().zip(&values) {
            right.sub(first);
        }
        let (velocity, _) = self.solve(&at, &right);
        let mut right = zeros(self.rows());
        let curved = self.derivatives(x, &velocity, &moved);
        for (right, [_, second]) in right.iter_mut().zip(&curved) {
            right.sub(second);
        }
        let (acceleration, last) = self.solve(&at, &right);
        let size = length(&doubles(&acceleration)) + length(&doubles(&velocity));
        let error = last + refined.condition * (refined.correction + ROUNDING) * size;
        Bend {
            velocity,
            acceleration,
            error,
        }
    }
}

/// The value of a slice at a point.
fn slice_at(slice: &[Complex64], x: &[Number]) -> Number {
    let mut value = exactly(slice[0]);
    for (&c, x) in slice[1..].iter().zip(x) {
        value.mul_add(&exactly(c), x);
    }
    value
}

/// The size of each value, and the same as a part of what a change of the point by its size makes of it, where the
/// derivatives have these lengths.
fn parts_of(
    x: &[Number],
    values: impl Iterator<Item = Complex64>,
    lengths: impl Iterator<Item = f64>,
) -> impl Iterator<Item = (f64, f64)> {
    let size = length(&doubles(x)).max(1.0);
    values.zip(lengths).map(move |(value, length)| {
        let value = value.norm_sqr().sqrt();
        (value, value / (length * size))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parabola() -> System {
        let text = b"CONFIG\nEND;\nINPUT\nvariable_group x, y; function f;\
                     f = y - x^2;\nEND;\n";
        cognate_systems::formats::read("test", text).unwrap().system
    }

    #[test]
    fn the_points_of_a_parabola_bend_by_opposite_amounts() {
        // y = 2 + s: x = +-sqrt(2 + s), x'' = -+ 1/4 (2 + s)^(-3/2).
        let number = |re: f64| Complex64::new(re, 0.0);
        let slice = vec![number(-2.0), number(0.0), number(1.0)];
        let system = cognate_systems::transform::slice(&parabola(), 1, 2);
        let equations = SlicedEquations::at_parameters(&system, &slice);
        let mut sum = Number::zero(());
        for sign in [1.0, -1.0] {
            let near = [number(sign * 1.4), number(2.0)].map(exactly);
            let refined = equations.refine(&near).unwrap();
            assert!(refined.correction < 1e-28 && refined.residual < 1e-28);
            let zero = number(0.0);
            let bend = equations.bend(&refined, &[number(-1.0), zero, zero]);
            let x = rounded(&bend.acceleration[0]);
            let exact = -sign * 0.25 / (2.0 * 2.0f64.sqrt());
            assert!(
                (x.re - exact).abs() < 1e-15 && bend.error < 1e-25,
                "{bend:?}"
            );
            sum.add(&bend.acceleration[0]);
        }
        assert!(rounded(&sum).norm_sqr().sqrt() < 1e-28);
    }

    #[test]
    fn small_factors_beside_a_point_make_it_no_multiple_one() {
        // On the line x = 1 the other factors are small together; (x - 1)^2 is 0 twice.
        let slice = vec![
            Complex64::new(-0.5, 0.0),
            Complex64::new(0.1, 0.2),
            Complex64::new(1.0, 0.0),
        ];
        let near = [Complex64::new(1.0 + 1e-9, 0.0), Complex64::new(0.4, -0.2)].map(exactly);
        let condition = |f: &str| {
            let text =
                format!("CONFIG\nEND;\nINPUT\nvariable_group x, y; function f;f = {f};\nEND;\n");
            let system = cognate_systems::formats::read("test", text.as_bytes());
            let equations = SlicedEquations::new(&system.unwrap().system, vec![slice.clone()]);
            let refined = equations.refine(&near).unwrap();
            (refined.condition, refined.correction)
        };
        let small: Vec<String> = (1..=40)
            .map(|k| format!("*(x - 1 - y/{})", 100 + k))
            .collect();
        let (simple, last) = condition(&format!("(x - 1){}", small.concat()));
        assert!(simple < 1e6 && last < 1e-25, "{simple:e} {last:e}");
        let (double, last) = condition("(x - 1)^2");
        assert!(double > 1e8 && last > 1e-22, "{double:e} {last:e}");
    }
}
