//! Bends: how witness points move when their slice moves, to the second order, in double-doubles.
//!
//! Along a slice A x + b + s v = 0 a witness point is a path x(s). The sum of x''(0) over the points of
//! a component is 0, over a proper part of them it is not, with probability 1: a trace test without a
//! path (Brake, Hauenstein, Liddell: Decomposing solution sets of polynomial systems using derivatives,
//! ICMS 2016). Both derivatives are linear equations with the Jacobian at the point.

pub mod stage;

use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::scalar::{Complex, DoubleDouble, Jet, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use cognate_systems::system::System;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// A number of about 32 digits.
pub type Number = Complex<DoubleDouble<f64>>;

/// Corrections of a linear solution: each brings about as many digits as a double has, less those of
/// the condition number.
const CORRECTIONS: usize = 4;
/// Most corrections of a point by Newton's method.
const MOST_ROUNDS: usize = 12;
/// A correction this small, relative to the point, is rounding error.
const CONVERGED: f64 = 1e-29;
/// Above this correction the Jacobian is taken again.
const NEAR: f64 = 1e-9;
/// How far beside a point the scales of small rows are taken, relative to the point: there the row of a multiple zero
/// is not small, and that of a product whose other factors are small is as small as at the point.
const BESIDE: f64 = 1e-3;
/// A row that is smaller at the point than this part of what it is beside the point may be that of a multiple zero.
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
    /// Work spaces with the constants rounded, which are copied: rounding them takes longer than an evaluation.
    doubled: Scratch<DoubleDouble<f64>>,
    series: OnceLock<Scratch<Series>>,
}

/// A number with its derivatives along a line.
type Series = Jet<DoubleDouble<f64>>;

/// A witness point with all its digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefinedPoint {
    /// The point.
    pub point: Vec<Number>,
    /// The last correction, relative to the point or to 1, whichever is larger.
    pub correction: f64,
    /// How far all corrections moved it, in the same unit.
    pub moved: f64,
    /// The largest equation there, in its size or as a part of what a change of the point by its size makes of
    /// it.
    pub residual: f64,
    /// Largest singular value of the Jacobian over the least.
    pub condition: f64,
}

/// How a witness point moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bend {
    /// x'.
    pub velocity: Vec<Number>,
    /// x''.
    pub acceleration: Vec<Number>,
    /// Estimated error of x''.
    pub error: f64,
}

/// The Jacobian and values, and singular values of the Jacobian with each row scaled.
struct Linearized {
    matrix: Matrix<DoubleDouble<f64>>,
    weights: Vec<f64>,
    svd: Svd,
}

impl Linearized {
    /// A row is scaled to at most 1; one that is as small beside the point by its size there.
    fn new(matrix: Matrix<DoubleDouble<f64>>, variables: usize, beside: &[f64]) -> Self {
        let sizes = row_sizes(&matrix, variables).into_iter().enumerate();
        let scale = |(i, size): (usize, f64)| match beside.get(i) {
            Some(&beside) if beside < 1.0 && size < 1.0 && size > AS_SMALL * beside => {
                size.max(beside).max(f64::MIN_POSITIVE)
            }
            _ => size.max(1.0),
        };
        let weights: Vec<f64> = sizes.map(|row| 1.0 / scale(row)).collect();
        let column = |j: usize| -> Vec<Complex64> {
            let rows = weights.iter().enumerate();
            rows.map(|(i, weight)| rounded(matrix.at(i, j)) * weight)
                .collect()
        };
        let svd = Svd::of((0..variables).map(column).collect());
        Self {
            matrix,
            weights,
            svd,
        }
    }

    /// The shortest y for which J y is nearest to these values, as far as doubles tell.
    fn solve(&self, values: &[Complex64]) -> Vec<Complex64> {
        let pairs = values.iter().zip(&self.weights);
        let weighted: Vec<Complex64> = pairs.map(|(z, w)| z * w).collect();
        self.svd.least_squares(&weighted, self.svd.values.len())
    }
}

/// Euclidean length of each row of a Jacobian.
fn row_sizes(matrix: &Matrix<DoubleDouble<f64>>, variables: usize) -> Vec<f64> {
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

/// Euclidean length.
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
            series: OnceLock::new(),
            equations,
            variables,
            slices,
            parameters: Vec::new(),
        }
    }

    /// The equations of a system at these values of its parameters, with no slices but those that are among
    /// them.
    pub fn at_parameters(system: &System, values: &[Complex64]) -> Self {
        let variables = system.variable_count();
        let (e, equations) = (&system.expressions, &system.equations);
        let equations = Interpreter::compile(e, equations, variables, values.len());
        Self {
            doubled: equations.scratch(()),
            series: OnceLock::new(),
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

    fn linearize(&self, x: &[Number]) -> Matrix<DoubleDouble<f64>> {
        let (rows, n) = (self.rows(), self.variables);
        let mut matrix = Matrix::zeros((), rows, n + 2);
        let mut scratch = self.doubled.clone();
        self.equations
            .jacobian(x, &self.parameters, &mut matrix, &mut scratch);
        let mut all = Matrix::zeros((), rows + self.slices.len(), n + 1);
        for i in 0..rows {
            for j in 0..=n {
                all.at_mut(i, j).set(matrix.at(i, j));
            }
        }
        for (i, slice) in self.slices.iter().enumerate() {
            let mut value = exactly(slice[0]);
            for (j, &c) in slice[1..].iter().enumerate() {
                value.mul_add(&exactly(c), &x[j]);
                all.at_mut(rows + i, j).set(&exactly(c));
            }
            all.at_mut(rows + i, n).set(&value);
        }
        all
    }

    fn decompose(&self, x: &[Number], beside: &[f64]) -> Linearized {
        Linearized::new(self.linearize(x), self.variables, beside)
    }

    /// The Jacobian at a point with its rows scaled by their sizes beside the point, and these sizes.
    fn decompose_first(&self, x: &[Number]) -> (Linearized, Vec<f64>) {
        let matrix = self.linearize(x);
        let beside = self.sizes_beside(x, &matrix);
        (Linearized::new(matrix, self.variables, &beside), beside)
    }

    /// Sizes of the rows a little beside a point, at which the Jacobian is this one, in a direction in which no
    /// coordinate is special; none where no row is small at the point.
    fn sizes_beside(&self, x: &[Number], at: &Matrix<DoubleDouble<f64>>) -> Vec<f64> {
        let small = row_sizes(at, self.variables);
        if small.iter().all(|&size| size >= 1.0) {
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
        row_sizes(&self.linearize(&moved), self.variables)
    }

    /// The values and the derivatives by the variables from `first` on, in columns.
    pub fn linear_part(&self, x: &[Number], first: usize) -> (Vec<Complex64>, Vec<Vec<Complex64>>) {
        let matrix = self.linearize(x);
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
        let all = self.linearize(x);
        let mut own = Matrix::zeros((), self.rows(), self.variables);
        for i in 0..self.rows() {
            for j in 0..self.variables {
                own.at_mut(i, j).set(all.at(i, j));
            }
        }
        Linearized::new(own, self.variables, &[]).svd.values
    }

    /// For each equation its size, and the same as a part of what a change of the point by its size makes of
    /// it: about the distance to where it is 0.
    pub fn residuals(&self, x: &[Number]) -> Vec<(f64, f64)> {
        let matrix = self.linearize(x);
        let size = length(&doubles(x)).max(1.0);
        let of = |i: usize| {
            let row: Vec<Complex64> = (0..self.variables)
                .map(|j| rounded(matrix.at(i, j)))
                .collect();
            let value = rounded(matrix.at(i, self.variables)).norm_sqr().sqrt();
            (value, value / (length(&row) * size))
        };
        (0..self.rows()).map(of).collect()
    }

    /// The largest equation at a point, as a part of what a change of the point by its size makes of it.
    fn relative_residual(&self, x: &[Number]) -> f64 {
        let parts = self.residuals(x).into_iter();
        let parts = parts.map(|(value, distance)| value.min(distance));
        parts.fold(
            0.0,
            |m: f64, r| if r.is_nan() { f64::INFINITY } else { m.max(r) },
        )
    }

    /// The values beside a Jacobian.
    fn values(&self, at: &Matrix<DoubleDouble<f64>>) -> Vec<Complex64> {
        let rows = 0..at.rows();
        rows.map(|i| rounded(at.at(i, self.variables))).collect()
    }

    /// Newton's method (of Gauss, where there are more equations than variables) from near a witness point;
    /// `None` where it leaves or does not settle.
    pub fn refine(&self, start: &[Number]) -> Option<RefinedPoint> {
        let mut x = start.to_vec();
        let (mut at, beside) = self.decompose_first(&x);
        let (mut last, mut moved) = (f64::INFINITY, 0.0);
        for round in 0..MOST_ROUNDS {
            if round > 0 && last > NEAR {
                at = self.decompose(&x, &beside);
            }
            // Where the Jacobian was taken the values are known.
            let values = match last > NEAR {
                true => self.values(&at.matrix),
                false => self.values(&self.linearize(&x)),
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
        let values = &at.svd.values;
        let condition = values.first()? / values.last()?;
        Some(RefinedPoint {
            residual: self.relative_residual(&x),
            point: x,
            correction: last,
            moved,
            condition,
        })
    }

    /// y with J y = `right`, in double-doubles, and the last correction.
    fn solve(&self, at: &Linearized, right: &[Number]) -> (Vec<Number>, f64) {
        let mut y = zeros(self.variables);
        let mut last = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let mut rest = right.to_vec();
            for (i, rest) in rest.iter_mut().enumerate() {
                for (j, y) in y.iter().enumerate() {
                    rest.mul_sub(at.matrix.at(i, j), y);
                }
            }
            let step = at.solve(&doubles(&rest));
            for (y, &step) in y.iter_mut().zip(&step) {
                y.add(&exactly(step));
            }
            last = length(&step);
        }
        (y, last)
    }

    /// The first and the second derivative in s of the equations along x + s u, where the parameters change
    /// by s q.
    fn derivatives(&self, x: &[Number], u: &[Number], q: &[Number]) -> Vec<[Number; 2]> {
        let zero = || DoubleDouble::from_f64((), 0.0);
        let series = |c0: &DoubleDouble<f64>, c1: &DoubleDouble<f64>| -> Series {
            Jet([*c0, *c1, zero(), zero(), zero()])
        };
        let along = |x: &[Number], u: &[Number]| -> Vec<Complex<Series>> {
            let pairs = x.iter().zip(u);
            pairs
                .map(|(x, u)| Complex {
                    re: series(&x.re, &u.re),
                    im: series(&x.im, &u.im),
                })
                .collect()
        };
        let (x, parameters) = (along(x, u), along(&self.parameters, q));
        let mut values = vec![Complex::<Series>::zero(()); self.rows()];
        let made = || Evaluate::<Series>::scratch(&self.equations, ());
        let mut scratch = self.series.get_or_init(made).clone();
        self.equations
            .value(&x, &parameters, &mut values, &mut scratch);
        let both = |z: &Complex<Series>| {
            let coefficient = |k: usize| Complex {
                re: z.re.0[k],
                im: z.im.0[k],
            };
            let mut second = coefficient(2);
            second.add(&coefficient(2));
            [coefficient(1), second]
        };
        values.iter().map(both).collect()
    }

    /// How a witness point moves when the constants of the slices move in this direction; with
    /// [`Self::at_parameters`] the parameters, all of them.
    pub fn bend(&self, refined: &RefinedPoint, direction: &[Complex64]) -> Bend {
        let (at, _) = self.decompose_first(&refined.point);
        let (rows, x) = (self.rows(), &refined.point);
        let mut right = zeros(rows + self.slices.len());
        let moved: Vec<Number> = direction.iter().map(|&v| exactly(v)).collect();
        let moved_parameters = &moved[..self.parameters.len()];
        if moved_parameters.is_empty() {
            for (right, v) in right[rows..].iter_mut().zip(&moved) {
                right.sub(v);
            }
        } else {
            let still = zeros(self.variables);
            let values = self.derivatives(x, &still, moved_parameters);
            for (right, [first, _]) in right.iter_mut().zip(&values) {
                right.sub(first);
            }
        }
        let (velocity, _) = self.solve(&at, &right);
        let mut right = zeros(rows + self.slices.len());
        let curved = self.derivatives(x, &velocity, moved_parameters);
        for (right, [_, second]) in right.iter_mut().zip(&curved) {
            right.sub(second);
        }
        let (acceleration, last) = self.solve(&at, &right);
        let size = length(&doubles(&acceleration)) + length(&doubles(&velocity));
        let error = last + refined.condition * (refined.correction + 1e-31) * size;
        Bend {
            velocity,
            acceleration,
            error,
        }
    }
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
        let equations = SlicedEquations::new(&parabola(), vec![slice]);
        let mut sum = Number::zero(());
        for sign in [1.0, -1.0] {
            let near = [number(sign * 1.4), number(2.0)].map(exactly);
            let refined = equations.refine(&near).unwrap();
            assert!(refined.correction < 1e-28 && refined.residual < 1e-28);
            let bend = equations.bend(&refined, &[number(-1.0)]);
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

    #[test]
    fn parameters_move_points_as_constants_of_slices_do() {
        let number = |re: f64| Complex64::new(re, 0.0);
        let slice = [number(-2.0), number(0.3), number(1.0)];
        let by_slice = SlicedEquations::new(&parabola(), vec![slice.to_vec()]);
        let system = cognate_systems::transform::slice(&parabola(), 1, 2);
        let by_parameters = SlicedEquations::at_parameters(&system, &slice);
        let near = [number(1.3), number(1.6)].map(exactly);
        let point = by_slice.refine(&near).unwrap();
        let direction = Complex64::new(0.6, 0.8);
        let expected = by_slice.bend(&point, &[direction]);
        let still = number(0.0);
        let found = by_parameters.bend(&point, &[direction, still, still]);
        for (a, b) in [
            (&expected.velocity, &found.velocity),
            (&expected.acceleration, &found.acceleration),
        ] {
            for (a, b) in a.iter().zip(b) {
                assert!((rounded(a) - rounded(b)).norm_sqr() < 1e-56, "{a:?} {b:?}");
            }
        }
    }
}
