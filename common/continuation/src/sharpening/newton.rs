//! Newton's method in MPFR on equations that may be more than their unknowns, until a point has
//! its digits; sizes are powers of two, since a double holds none below 10^-308.

use super::Unsharpened;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::RandomStream;
use cognate_numeric::scalar::{Complex, MultiplePrecision, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use num_complex::Complex64;

/// A number with many digits.
pub(super) type Number = Complex<MultiplePrecision>;

/// Farthest that Newton's method may move a point, relative to its largest coordinate, as a power of 2.
const FARTHEST: i64 = -16;
/// From this round on every correction has clearly more digits than the one before.
const PATIENCE: usize = 5;
/// More rounds than any convergence of the second order needs.
const MOST_ROUNDS: usize = 40;

/// e with |z| about 2^e; `None` for 0.
pub(super) fn exponent(z: &Number) -> Option<i64> {
    let parts = [z.re.0.get_exp(), z.im.0.get_exp()];
    parts.into_iter().flatten().max().map(i64::from)
}

/// The largest of their exponents, of numbers that are finite; 0 counts as little as can be.
fn largest<'a>(numbers: impl IntoIterator<Item = &'a Number>) -> Option<i64> {
    numbers.into_iter().try_fold(i64::MIN / 4, |largest, z| {
        let finite = z.re.0.is_finite() && z.im.0.is_finite();
        finite.then(|| exponent(z).map_or(largest, |e| e.max(largest)))
    })
}

/// Point to which Newton's method converged.
pub(super) struct Converged {
    pub point: Vec<Number>,
    /// e with 2^e the last correction relative to each coordinate.
    pub correction: i64,
}

/// Equations, compiled, at one value of their parameters.
pub(super) struct Newton<'a> {
    program: &'a Interpreter,
    scratch: Scratch<MultiplePrecision>,
    parameters: Vec<Number>,
    /// The variables that are moved.
    unknowns: &'a [usize],
    /// Number of variables of the point itself; multipliers come after them.
    own: usize,
    bits: u32,
    /// [J | F | free], a row for each equation.
    matrix: Matrix<MultiplePrecision>,
}

impl<'a> Newton<'a> {
    pub fn new(
        program: &'a Interpreter,
        parameters: &[Complex64],
        unknowns: &'a [usize],
        solution_coordinates: usize,
        bits: u32,
    ) -> Self {
        let shape = Evaluate::<MultiplePrecision>::shape(program);
        let exact = |z: &Complex64| Complex::from_f64(bits, z.re, z.im);
        Self {
            scratch: program.scratch(bits),
            parameters: parameters.iter().map(exact).collect(),
            matrix: Matrix::zeros(bits, shape.equations, shape.variables + 2),
            program,
            unknowns,
            own: solution_coordinates,
            bits,
        }
    }

    /// The Jacobian by the unknowns, in columns.
    pub fn jacobian(&mut self, x: &[Number]) -> Vec<Vec<Number>> {
        self.evaluate(x);
        let rows = 0..self.matrix.rows();
        let column = |&v: &usize| rows.clone().map(|i| self.matrix.at(i, v).clone()).collect();
        self.unknowns.iter().map(column).collect()
    }

    /// The Jacobian by the unknowns, in columns, and the values of the equations.
    pub fn linearization(&mut self, x: &[Number]) -> (Vec<Vec<Number>>, Vec<Number>) {
        let columns = self.jacobian(x);
        let at = self.matrix.columns() - 2;
        let rows = 0..self.matrix.rows();
        let values = rows.map(|i| self.matrix.at(i, at).clone()).collect();
        (columns, values)
    }

    fn evaluate(&mut self, x: &[Number]) {
        let (matrix, scratch) = (&mut self.matrix, &mut self.scratch);
        self.program.jacobian(x, &self.parameters, matrix, scratch);
    }

    /// Goes from a point to the solution beside it, with each coordinate to `digits` bits of its own; a coordinate that
    /// is smaller by more than that gets twice as many bits of the largest coordinate.
    pub fn converge(&mut self, start: &[Number], digits: i64) -> Result<Converged, Unsharpened> {
        let mut x = start.to_vec();
        let solution_coordinates = self.own;
        let solution_size =
            |x: &[Number]| largest(&x[..solution_coordinates]).ok_or(Unsharpened::DamagedPoint);
        let size = solution_size(&x)?.max(0);
        let mut last = 0;
        for round in 0..MOST_ROUNDS {
            let (columns, values) = self.linearization(&x);
            let delta = least_squares(self.bits, &columns, &values);
            let delta = delta.ok_or(Unsharpened::NotRegular)?;
            let mut correction = i64::MIN / 2;
            for (delta, &v) in delta.iter().zip(self.unknowns) {
                let Some(moved) = exponent(delta) else {
                    continue;
                };
                let magnitude = exponent(&x[v]).unwrap_or(i64::MIN / 4).max(size - digits);
                correction = correction.max(moved - magnitude);
                x[v].sub(delta);
            }
            let mut moved = x[..self.own].to_vec();
            for (x, start) in moved.iter_mut().zip(start) {
                x.sub(start);
            }
            if solution_size(&moved)? > size + FARTHEST {
                return Err(Unsharpened::NewtonLeaves);
            }
            if correction <= -digits {
                let residual = self.relative_residual(&x).ok_or(Unsharpened::NotRegular)?;
                // A least-squares point is no solution.
                let solves = residual <= 16 - digits;
                return solves
                    .then_some(Converged {
                        point: x,
                        correction,
                    })
                    .ok_or(Unsharpened::NotRegular);
            }
            if round >= PATIENCE && correction > last + last / 4 {
                return Err(Unsharpened::NotRegular);
            }
            last = correction;
        }
        Err(Unsharpened::NotRegular)
    }

    /// Whether Newton's method comes back to a solution from beside it. From beside one of a curve of
    /// solutions it does not, however well it converges.
    pub fn is_alone(
        &mut self,
        solution: &[Number],
        digits: i64,
        random: &mut RandomStream,
    ) -> Result<bool, Unsharpened> {
        let mut beside = solution.to_vec();
        let size = largest(&solution[..self.own]).map_or(0, |size| size.max(0));
        let away = i32::try_from(size - digits / 4 * 3).map_err(|_| Unsharpened::DamagedPoint)?;
        for &v in self.unknowns {
            let z = random.unit();
            let mut by = Number::from_f64(self.bits, z.re, z.im);
            by.re.0 <<= away;
            by.im.0 <<= away;
            beside[v].add(&by);
        }
        let mut back = self.converge(&beside, digits)?.point;
        for (z, solution) in back.iter_mut().zip(solution) {
            z.sub(solution);
        }
        let apart = largest(&back[..self.own]).ok_or(Unsharpened::NotRegular)?;
        Ok(apart <= size - digits + 4)
    }

    /// The largest |F_i| as a part of the largest |J_ij| |x_j|, as a power of two.
    pub fn relative_residual(&mut self, x: &[Number]) -> Option<i64> {
        let columns = self.jacobian(x);
        let at = self.matrix.columns() - 2;
        let values = largest((0..self.matrix.rows()).map(|i| self.matrix.at(i, at)))?;
        let slope = largest(columns.iter().flatten())?;
        let size = largest(self.unknowns.iter().map(|&v| &x[v]))?.max(0);
        Some(values - slope - size)
    }
}

/// The x for which A x is nearest to b, by the normal equations where A is not square: digits are
/// cheap here. `None` where something is not finite.
pub(super) fn least_squares(
    bits: u32,
    columns: &[Vec<Number>],
    b: &[Number],
) -> Option<Vec<Number>> {
    let n = columns.len();
    let mut work = Matrix::<MultiplePrecision>::zeros(bits, n, n + 1);
    if b.len() == n {
        for i in 0..n {
            for (j, column) in columns.iter().enumerate() {
                work.at_mut(i, j).set(&column[i]);
            }
            work.at_mut(i, n).set(&b[i]);
        }
    } else {
        for i in 0..n {
            let conjugates: Vec<Number> = columns[i].iter().map(conjugate).collect();
            for j in 0..=n {
                let column = columns.get(j).map_or(b, Vec::as_slice);
                let entry = work.at_mut(i, j);
                for (a, b) in conjugates.iter().zip(column) {
                    entry.mul_add(a, b);
                }
            }
        }
    }
    eliminate::<MultiplePrecision, 1>(&mut work, &mut 0.0);
    let solution: Vec<Number> = (0..n).map(|i| work.at(i, n).clone()).collect();
    largest(&solution).map(|_| solution)
}

fn conjugate(z: &Number) -> Number {
    let mut conjugate = z.clone();
    conjugate.im.neg();
    conjugate
}
