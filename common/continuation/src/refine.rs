//! Refiner: Newton's method at the end of a path, one path at a time, with residual, condition number and accuracy.

use crate::chart::norm;
use crate::endgames::cauchy::generic_form;
use crate::homotopies::Homotopy;
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::condition::condition_number;
use cognate_numeric::linear_algebra::lu::eliminate;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::precision::{DOUBLE, unit_roundoff};
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter};
use num_complex::Complex64;

/// The largest condition number that doubles tell: larger ones are found with the digits of the arithmetic.
const CONDITION_BY_DOUBLES: f64 = 1e13;

/// Newton's method has converged where a relative correction is at most this; with more digits than doubles have,
/// [`QUADRATIC`] or [`AT_REST`] must hold, too.
const CONVERGED: f64 = 1e-8;
/// A relative correction is at most this part of the one before.
const QUADRATIC: f64 = 1e-3;
/// A relative correction is at most this: beside a multiple point, or another solution, corrections are small and
/// shrink slowly.
const AT_REST: f64 = 1e-15;

/// Points with the same moduli at which equations are evaluated: at one of them terms may nearly cancel.
const ROTATIONS: usize = 3;

/// Result of Newton's method at an endpoint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Report {
    /// Largest |H_i|.
    pub residual: f64,
    /// Condition number of the Jacobian.
    pub condition: f64,
    /// Estimated relative error: the last correction, and where the condition number exceeds 1e13 at least what
    /// rounding makes of it.
    pub accuracy: f64,
    /// Newton's method converged to rounding error.
    pub converged: bool,
}

impl Report {
    pub(crate) fn unknown() -> Self {
        Self {
            residual: f64::INFINITY,
            condition: f64::INFINITY,
            accuracy: f64::INFINITY,
            converged: false,
        }
    }
}

/// Largest modulus in one column.
#[inline(always)]
fn largest<S: Real>(matrix: &Matrix<S>, column: usize) -> f64 {
    let mut largest = 0.0f64;
    for i in 0..matrix.rows() {
        let size = matrix.at(i, column).norm_sqr().lane(0);
        if size > largest || size.is_nan() {
            largest = size;
        }
    }
    largest.sqrt()
}

/// Point where Newton's method begins.
#[derive(Clone, Copy)]
enum Begin<'p> {
    /// The point that is given.
    Given,
    /// The point at this distance from the last point of the run before.
    BesideLast(&'p [Complex64]),
}

/// One run of Newton's method, compiled for the instruction set: it stands apart from the
/// lockstep loop, which would otherwise contain it many times.
struct Newton<'r, 'a, 'p, S: Real> {
    refiner: &'r mut Refiner<'a, S>,
    point: &'p mut [Complex64],
    begin: Begin<'p>,
    t: Complex64,
    target: u64,
    most: u32,
}

impl<S: Real> Job for Newton<'_, '_, '_, S> {
    type Output = Report;
    #[inline(always)]
    fn run(self) -> Report {
        self.refiner
            .iterate(self.point, self.begin, self.t, self.target, self.most)
    }
}

/// Work space for refining one point, in the arithmetic of the tracking context.
pub(crate) struct Refiner<'a, S: Real> {
    homotopy: &'a Homotopy,
    context: S::Context,
    /// A relative correction this small is rounding error.
    finest: f64,
    /// Best accuracy that is claimed: that of points that are rounded to doubles.
    claimed: f64,
    /// Newton steps at most.
    rounds: u32,
    scratch: <Interpreter as Evaluate<S>>::Scratch,
    matrix: Matrix<S>,
    elimination: Matrix<S>,
    x: Vec<Complex<S>>,
    p: Vec<Complex<S>>,
    dp: Vec<Complex<S>>,
}

impl<'a, S: Real> Refiner<'a, S> {
    pub(crate) fn new(homotopy: &'a Homotopy, context: S::Context) -> Self {
        let n = homotopy.dimension();
        let zero = Complex::<S>::zero(context);
        Self {
            homotopy,
            context,
            finest: 2.0 * unit_roundoff(S::bits(context)),
            claimed: f64::EPSILON,
            rounds: 6,
            scratch: Evaluate::<S>::scratch(homotopy.program(), context),
            matrix: Matrix::zeros(context, n, n + 2),
            elimination: Matrix::zeros(context, n, n + 2),
            x: vec![zero.clone(); n],
            p: vec![zero.clone(); homotopy.parameter_count()],
            dp: vec![zero; homotopy.parameter_count()],
        }
    }

    /// Lets the refiner claim all digits of its arithmetic, for the point of [`Refiner::last`].
    pub(crate) fn with_all_digits(self) -> Self {
        Self {
            claimed: self.finest,
            rounds: 2 * self.rounds,
            ..self
        }
    }

    /// Newton steps at t = 0 until they no longer shrink; `point` is replaced where they converge.
    pub(crate) fn refine(&mut self, point: &mut [Complex64], target: u64) -> Report {
        self.newton(
            point,
            Begin::Given,
            Complex64::default(),
            target,
            self.rounds,
        )
    }

    /// Reports on a point as [`Refiner::report`] if it solves each equation at t = 0 as well as its error says: the value is at
    /// most this part of 1 and of the terms, and what the error, relative to the largest coordinate, makes of the derivatives.
    ///
    /// All terms of an equation may be small at a point that is no solution, as x y - 3 x^2 y where y is 1e-12. How large
    /// they are, the values at points with the same moduli and other arguments say.
    pub(crate) fn report_solution(
        &mut self,
        point: &[Complex64],
        target: u64,
        part: f64,
        error: f64,
    ) -> Option<Report> {
        let report = self.report(point, target);
        // Comparisons that a NaN fails, here and below.
        let is_small = report.residual <= part;
        if !is_small {
            return None;
        }
        let n = point.len();
        let size = norm(point).max(1.0);
        let allowed_by_error = |i: usize| {
            let slope: f64 = (0..n).map(|j| self.modulus(i, j)).sum();
            error * slope * size
        };
        let equations: Vec<[f64; 2]> = (0..n)
            .map(|i| [self.modulus(i, n), allowed_by_error(i)])
            .collect();
        let mut terms = vec![0.0f64; n];
        let mut phases = generic_form();
        for _ in 0..ROTATIONS {
            let both = point.iter().zip(&mut phases);
            let rotated: Vec<Complex64> = both.map(|(z, phase)| z * phase).collect();
            self.report(&rotated, target);
            for (i, terms) in terms.iter_mut().enumerate() {
                *terms = (*terms).max(self.modulus(i, n));
            }
        }
        let mut solved = equations.iter().zip(&terms);
        let is_solution =
            solved.all(|([value, by_error], terms)| *value <= part * terms + by_error);
        is_solution.then_some(report)
    }

    fn modulus(&self, i: usize, j: usize) -> f64 {
        self.matrix.at(i, j).norm_sqr().lane(0).sqrt()
    }

    /// Newton steps at t = 0 from the point that is `by` away from [`Self::last`], with the digits of this arithmetic.
    pub(crate) fn refine_beside_last(
        &mut self,
        point: &mut [Complex64],
        by: &[Complex64],
        target: u64,
    ) -> Report {
        let begin = Begin::BesideLast(by);
        self.newton(point, begin, Complex64::default(), target, self.rounds)
    }

    /// The point where the last Newton step led, with the digits of this arithmetic.
    pub(crate) fn last(&self) -> &[Complex<S>] {
        &self.x
    }

    /// Reports residual, condition number and accuracy at a point without moving it.
    pub(crate) fn report(&mut self, point: &[Complex64], target: u64) -> Report {
        let mut copy = point.to_vec();
        self.newton(&mut copy, Begin::Given, Complex64::default(), target, 0)
    }

    /// Condition number of the Jacobian at a point of the path.
    pub(crate) fn condition_at(&mut self, point: &[Complex64], t: Complex64, target: u64) -> f64 {
        let mut copy = point.to_vec();
        self.newton(&mut copy, Begin::Given, t, target, 0).condition
    }

    fn newton<'p>(
        &mut self,
        point: &'p mut [Complex64],
        begin: Begin<'p>,
        t: Complex64,
        target: u64,
        most: u32,
    ) -> Report {
        dispatch_baseline(Newton {
            refiner: self,
            point,
            begin,
            t,
            target,
            most,
        })
    }

    /// Largest |H_i| at the point that was evaluated last, where the homotopy says so scaled to
    /// coordinates of size 1: a point far out in its patch has large values and large errors.
    #[inline(always)]
    fn residual(&self) -> f64 {
        let n = self.x.len();
        let point: Vec<Complex64> = self.x.iter().map(|z| z.lane(0)).collect();
        let scales = self.homotopy.row_scales(&point);
        if scales.is_empty() {
            return largest(&self.matrix, n);
        }
        let sizes = (0..n).map(|i| self.matrix.at(i, n).norm_sqr().lane(0).sqrt() / scales[i]);
        sizes.fold(
            0.0,
            |m, size| if size > m || size.is_nan() { size } else { m },
        )
    }

    #[inline(always)]
    fn iterate(
        &mut self,
        point: &mut [Complex64],
        begin: Begin<'_>,
        t: Complex64,
        target: u64,
        most: u32,
    ) -> Report {
        let n = point.len();
        let context = self.context;
        let native = |z: Complex64| Complex::<S>::from_f64(context, z.re, z.im);
        let (a, b) = self.homotopy.ends(target);
        let a: Vec<_> = a.map(native).collect();
        let b: Vec<_> = b.map(native).collect();
        let t = Complex::from_f64((), t.re, t.im);
        self.homotopy
            .path()
            .at::<S>(context, &t, &a, &b, &mut self.p, &mut self.dp);
        match begin {
            Begin::Given => {
                for (x, z) in self.x.iter_mut().zip(&*point) {
                    *x = native(*z);
                }
            }
            Begin::BesideLast(by) => {
                for (x, z) in self.x.iter_mut().zip(by) {
                    x.add(&native(*z));
                }
            }
        }
        let mut report = Report::unknown();
        let in_doubles = S::bits(context) == DOUBLE;
        let mut last = f64::INFINITY;
        let mut round = 0;
        loop {
            self.homotopy
                .program()
                .jacobian(&self.x, &self.p, &mut self.matrix, &mut self.scratch);
            report.residual = self.residual();
            if round >= most {
                break; // the matrix of the last point stands for the condition number
            }
            self.elimination.clone_from(&self.matrix);
            let mut exchanges = S::Control::from_f64((), 0.0);
            eliminate::<S, 1>(&mut self.elimination, &mut exchanges);
            let correction = largest(&self.elimination, n) / norm(point);
            if !(correction <= 0.5 * last || correction <= 1e-12) {
                break; // not converging, or not a number
            }
            for i in 0..n {
                self.x[i].sub(self.elimination.at(i, n));
            }
            report.accuracy = correction.max(self.claimed);
            let fast = last.is_finite() && correction <= QUADRATIC * last;
            let at_rest = in_doubles || report.converged || fast || correction <= AT_REST;
            report.converged = correction <= CONVERGED && at_rest;
            round += 1;
            if correction > 0.5 * last || correction <= self.finest {
                round = most; // rounding error is reached
            }
            last = correction;
        }
        if report.converged {
            for (z, x) in point.iter_mut().zip(&self.x) {
                *z = x.lane(0);
            }
        }
        let mut rounded = Matrix::zeros((), n, n);
        for i in 0..n {
            for j in 0..n {
                let entry = self.matrix.at(i, j);
                *rounded.at_mut(i, j) = Complex {
                    re: entry.re.lane(0),
                    im: entry.im.lane(0),
                };
            }
        }
        report.condition = condition_number(&rounded);
        if report.condition > CONDITION_BY_DOUBLES {
            report.condition = condition_number(&self.matrix);
            let rounding = report.condition * unit_roundoff(S::bits(context));
            report.accuracy = report.accuracy.max(rounding);
        }
        report
    }
}
