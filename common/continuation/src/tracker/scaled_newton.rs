//! Scaled Newton: whether an end of a path whose Jacobian is nearly singular is a regular solution with coordinates of
//! very different sizes.
//!
//! A solution with coordinates from 1e-11 to 1e11 has a condition number of 1e20 and more, of which nothing remains once
//! coordinates and equations are measured in their own units. A multiple point stays singular in all units: there, and on
//! sets of solutions, corrections do not become small relative to every coordinate.

use crate::homotopies::Homotopy;
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::condition::condition_number;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, DoubleDouble, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter};
use num_complex::Complex64;

type Number = Complex<DoubleDouble<f64>>;

/// Newton steps at most.
const ROUNDS: u32 = 8;
/// A first correction is at most this part of each coordinate.
const NEAR: f64 = 0.03;
/// Each correction after the first is at most this part of the one before.
const CONTRACTION: f64 = 0.1;
/// Newton's method stops when a correction is this small.
const SETTLED: f64 = 1e-22;
/// Condition numbers of Jacobians in their own units, at most.
const REGULAR: f64 = 1e10;

/// The regular solution in the affine chart of `homotopy` near this point of it; `None` where there is none, or a
/// coordinate is 0.
pub(super) fn regular_nearby(
    homotopy: &Homotopy,
    point: &[Complex64],
    target: u64,
) -> Option<Vec<Complex64>> {
    let newton = ScaledNewton {
        homotopy,
        x: point
            .iter()
            .map(|z| Complex::from_f64((), z.re, z.im))
            .collect(),
        target,
    };
    dispatch_baseline(newton)
}

struct ScaledNewton<'a> {
    homotopy: &'a Homotopy,
    x: Vec<Number>,
    target: u64,
}

impl Job for ScaledNewton<'_> {
    type Output = Option<Vec<Complex64>>;
    #[inline(always)]
    fn run(mut self) -> Self::Output {
        let n = self.x.len();
        let (a, b) = self.homotopy.ends(self.target);
        let native = |z: Complex64| Number::from_f64((), z.re, z.im);
        let a: Vec<_> = a.map(native).collect();
        let b: Vec<_> = b.map(native).collect();
        let mut p = vec![Number::zero(()); self.homotopy.parameter_count()];
        let mut dp = p.clone();
        let end = Complex::from_f64((), 0.0, 0.0);
        self.homotopy.path().at((), &end, &a, &b, &mut p, &mut dp);
        let program: &Interpreter = self.homotopy.program();
        let mut scratch = Evaluate::<DoubleDouble<f64>>::scratch(program, ());
        let mut matrix = Matrix::zeros((), n, n + 2);
        let mut before = NEAR / CONTRACTION;
        for _ in 0..ROUNDS {
            program.jacobian(&self.x, &p, &mut matrix, &mut scratch);
            let sizes: Vec<f64> = self.x.iter().map(|z| power_of_two(size(z))).collect();
            if !in_own_units(&mut matrix, &sizes) {
                return None;
            }
            let condition = condition_number(&rounded(&matrix));
            let mut exchanges = 0.0;
            eliminate::<DoubleDouble<f64>, 1>(&mut matrix, &mut exchanges);
            let mut largest = 0.0f64;
            for (i, (x, unit)) in self.x.iter_mut().zip(&sizes).enumerate() {
                let mut step = *matrix.at(i, n);
                largest = match size(&step) {
                    here if here > largest || here.is_nan() => here,
                    _ => largest,
                };
                step.scale(&DoubleDouble::from_f64((), *unit));
                x.sub(&step);
            }
            if !(condition <= REGULAR && largest <= CONTRACTION * before) {
                return None;
            }
            if largest <= SETTLED {
                return Some(self.x.iter().map(|z| z.lane(0)).collect());
            }
            before = largest;
        }
        None
    }
}

/// The larger of the real and the imaginary part.
#[inline(always)]
fn size(z: &Number) -> f64 {
    let z = z.lane(0);
    z.re.abs().max(z.im.abs())
}

/// The power of two at or below a positive number; 0 of 0, and of what is too small.
fn power_of_two(size: f64) -> f64 {
    f64::from_bits(size.to_bits() & (0x7ff << 52))
}

/// Multiplies the columns of [J | H] by these units, and the rows by what makes their largest entry of J about 1; false
/// where a column or row is 0.
#[inline(always)]
fn in_own_units(matrix: &mut Matrix<DoubleDouble<f64>>, units: &[f64]) -> bool {
    let n = units.len();
    for i in 0..n {
        let mut largest = 0.0f64;
        for (j, unit) in units.iter().enumerate() {
            matrix
                .at_mut(i, j)
                .scale(&DoubleDouble::from_f64((), *unit));
            largest = largest.max(size(matrix.at(i, j)));
        }
        let row = 1.0 / power_of_two(largest);
        if !row.is_finite() || row == 0.0 {
            return false;
        }
        for j in 0..=n {
            matrix.at_mut(i, j).scale(&DoubleDouble::from_f64((), row));
        }
    }
    units.iter().all(|unit| *unit > 0.0 && unit.is_finite())
}

/// The square part, in doubles.
#[inline(always)]
fn rounded(matrix: &Matrix<DoubleDouble<f64>>) -> Matrix<f64> {
    let n = matrix.rows();
    let mut square = Matrix::zeros((), n, n);
    for i in 0..n {
        for j in 0..n {
            let z = matrix.at(i, j).lane(0);
            *square.at_mut(i, j) = Complex { re: z.re, im: z.im };
        }
    }
    square
}
