//! Bends: how witness points move when their slice moves, to the second order, in double-doubles.
//!
//! Along a slice A x + b + s v = 0 a witness point is a path x(s). The sum of x''(0) over the points of
//! a component is 0, over a proper part of them it is not, with probability 1: a trace test without a
//! path (Brake, Hauenstein, Liddell: Decomposing solution sets of polynomial systems using derivatives,
//! ICMS 2016). Both derivatives are linear equations with the Jacobian at the point.

use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::scalar::{Complex, DoubleDouble, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::expression::differentiate::directional;
use cognate_systems::expression::{Node, NodeId};
use cognate_systems::system::System;
use num_complex::Complex64;

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

/// Equations that are regular at their witness points, with the slice that these lie on.
#[derive(Debug)]
pub struct SlicedEquations {
    equations: Interpreter,
    /// Second derivative in the direction of the variables that come after the first ones, twice.
    second: Interpreter,
    variables: usize,
    /// A row each: the constant, then coefficients of the first variables.
    slices: Vec<Vec<Complex64>>,
}

/// A witness point with all its digits.
#[derive(Clone, Debug)]
pub struct RefinedPoint {
    /// The point.
    pub point: Vec<Number>,
    /// The last correction, relative to the point.
    pub correction: f64,
    /// How far all corrections moved it, relative to the point.
    pub moved: f64,
    /// What the equations are there at most.
    pub residual: f64,
    /// Largest singular value of the Jacobian over the least.
    pub condition: f64,
}

/// How a witness point moves.
#[derive(Clone, Debug)]
pub struct Bend {
    /// x'.
    pub velocity: Vec<Number>,
    /// x''.
    pub acceleration: Vec<Number>,
    /// Estimated error of x''.
    pub error: f64,
}

/// Jacobian and values.
struct Linearized {
    matrix: Matrix<DoubleDouble<f64>>,
    svd: Svd,
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
        let mut e = system.expressions.clone();
        let along = |e: &mut cognate_systems::expression::Expressions, node: &Node| match node {
            Node::Variable(v) => Some(e.variable(*v + variables as u32)),
            _ => None,
        };
        let mut derive = |roots: &[NodeId]| -> Vec<NodeId> {
            let found = directional(&mut e, roots, &mut |e, node| match node {
                Node::Variable(v) if (*v as usize) < variables => along(e, node),
                _ => None,
            });
            let zero = e.integer(0);
            found.into_iter().map(|d| d.unwrap_or(zero)).collect()
        };
        let first = derive(&system.equations);
        let second = derive(&first);
        Self {
            equations: Interpreter::compile(&e, &system.equations, variables, 0),
            second: Interpreter::compile(&e, &second, 2 * variables, 0),
            variables,
            slices,
        }
    }

    fn rows(&self) -> usize {
        Evaluate::<f64>::shape(&self.equations).equations
    }

    fn linearize(&self, x: &[Number]) -> Matrix<DoubleDouble<f64>> {
        let (rows, n) = (self.rows(), self.variables);
        let mut matrix = Matrix::zeros((), rows, n + 2);
        let mut scratch = Evaluate::<DoubleDouble<f64>>::scratch(&self.equations, ());
        self.equations.jacobian(x, &[], &mut matrix, &mut scratch);
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

    fn decompose(&self, x: &[Number]) -> Linearized {
        let matrix = self.linearize(x);
        let column = |j: usize| -> Vec<Complex64> {
            let rows = 0..matrix.rows();
            rows.map(|i| rounded(matrix.at(i, j))).collect()
        };
        let svd = Svd::of((0..self.variables).map(column).collect());
        Linearized { matrix, svd }
    }

    /// Values of the equations alone at a point.
    pub fn values(&self, x: &[Number]) -> Vec<Complex64> {
        let mut values = zeros(self.rows());
        let mut scratch = Evaluate::<DoubleDouble<f64>>::scratch(&self.equations, ());
        self.equations.value(x, &[], &mut values, &mut scratch);
        doubles(&values)
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

    /// Singular values of the Jacobian of the equations alone at a point, descending.
    pub fn singular_values(&self, x: &[Number]) -> Vec<f64> {
        Svd::of(self.linear_part(x, 0).1).values
    }

    /// Newton's method (of Gauss, where there are more equations than variables) from near a witness point;
    /// `None` where it leaves or does not settle.
    pub fn refine(&self, start: &[Number]) -> Option<RefinedPoint> {
        let mut x = start.to_vec();
        let mut at = self.decompose(&x);
        let (mut last, mut moved) = (f64::INFINITY, 0.0);
        for round in 0..MOST_ROUNDS {
            if round > 0 && last > NEAR {
                at = self.decompose(&x);
            }
            let now = self.linearize(&x);
            let values: Vec<Complex64> = (0..now.rows())
                .map(|i| rounded(now.at(i, self.variables)))
                .collect();
            let step = at.svd.least_squares(&values, self.variables);
            let size = length(&doubles(&x)).max(f64::MIN_POSITIVE);
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
            residual: length(&self.values(&x)),
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
            let step = at.svd.least_squares(&doubles(&rest), self.variables);
            for (y, &step) in y.iter_mut().zip(&step) {
                y.add(&exactly(step));
            }
            last = length(&step);
        }
        (y, last)
    }

    /// How a witness point moves when the constants of the slices move in this direction.
    pub fn bend(&self, refined: &RefinedPoint, direction: &[Complex64]) -> Bend {
        let at = self.decompose(&refined.point);
        let rows = self.rows();
        let mut right = zeros(rows + self.slices.len());
        for (right, &v) in right[rows..].iter_mut().zip(direction) {
            right.sub(&exactly(v));
        }
        let (velocity, _) = self.solve(&at, &right);
        let mut point = refined.point.clone();
        point.extend(velocity.iter().cloned());
        let mut curved = zeros(rows);
        let mut scratch = Evaluate::<DoubleDouble<f64>>::scratch(&self.second, ());
        self.second.value(&point, &[], &mut curved, &mut scratch);
        let mut right = zeros(rows + self.slices.len());
        for (right, curved) in right.iter_mut().zip(&curved) {
            right.sub(curved);
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
            let near = [number(sign * 1.4142), number(2.0)].map(exactly);
            let refined = equations.refine(&near).unwrap();
            assert!(refined.correction < 1e-28 && refined.residual < 1e-28);
            let bend = equations.bend(&refined, &[number(-1.0)]);
            let x = rounded(&bend.acceleration[0]);
            let exact = -sign * 0.25 / (2.0 * 2.0f64.sqrt());
            assert!((x.re - exact).abs() < 1e-15 && bend.error < 1e-25, "{bend:?}");
            sum.add(&bend.acceleration[0]);
        }
        assert!(rounded(&sum).norm_sqr().sqrt() < 1e-28);
    }
}
