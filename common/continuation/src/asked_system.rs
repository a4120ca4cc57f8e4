//! AskedSystem: the equations that are asked, all of them, at the end of the paths.
//!
//! Where a system has more equations than unknowns, combinations of them are
//! tracked; here an endpoint is held against the equations themselves. The
//! coordinates are those of the chart that the paths are tracked in.

use crate::chart::{Chart, exact, norm};
use crate::homotopies::HomotopyKind;
use crate::homotopies::prepare::normalize;
use crate::local_dimension::series::{Constants, Monomials, Series};
use crate::path_result::{AskedFit, PathResult};
use crate::tracker::outcome::PathOutcome;
use cognate_numeric::lanes::dispatch::{Job, dispatch_baseline};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::svd::Svd;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, DoubleDouble, Real};

use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::polynomial::Degrees;
use cognate_systems::system::System;
use cognate_systems::transform::homogenize;
use num_complex::Complex64;

/// The equations in the chart, each scaled to about 1.
#[derive(Debug)]
pub struct AskedSystem {
    expressions: Expressions,
    equations: Vec<NodeId>,
    program: Interpreter,
    chart: Chart,
    /// Values of the program's parameters at each target.
    targets: Vec<Vec<Complex64>>,
    /// Work space with all constants, of which each evaluation takes a copy: rounding a fraction takes longer
    /// than evaluating a small system.
    doubles: Scratch<f64>,
    double_doubles: Scratch<DoubleDouble<f64>>,
    constants: Constants,
}

/// Values and derivatives at one point.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// Values of the equations F.
    pub values: Vec<Complex64>,
    /// Columns of the Jacobian.
    pub columns: Vec<Vec<Complex64>>,
}

/// One evaluation, compiled for the instruction set.
struct Linearize<'a, R: Real> {
    program: &'a Interpreter,
    x: &'a [Complex<R>],
    p: &'a [Complex<R>],
    matrix: &'a mut Matrix<R>,
    scratch: Scratch<R>,
}

impl<R: Real<Context = ()>> Job for Linearize<'_, R> {
    type Output = ();
    #[inline(always)]
    fn run(mut self) {
        let dp = vec![Complex::zero(()); self.p.len()];
        self.program
            .linearize(self.x, self.p, &dp, self.matrix, &mut self.scratch);
    }
}

impl AskedSystem {
    /// The equations of a checked system at the end of this homotopy. `degrees` are the system's
    /// own; the lengths of all parameter values fit it.
    pub(crate) fn new(
        system: &System,
        degrees: &Degrees,
        kind: &HomotopyKind,
        chart: Chart,
        seed: u64,
    ) -> Self {
        let mut out = Expressions::new();
        let coordinates = chart.nodes(&mut out);
        assert!(
            !matches!(kind, HomotopyKind::Sections { .. }),
            "sections are prepared as a parameter homotopy of the curve"
        );
        let (parameters, targets): (Vec<NodeId>, _) = match kind {
            HomotopyKind::Parameter { targets, .. } => {
                let count = system.parameters.len() as u32;
                let parameters = (0..count).map(|k| out.parameter(k)).collect();
                (parameters, targets.clone())
            }
            one => {
                let values = one.end_parameters(0, system.path_variable);
                let values = values.unwrap_or_default();
                let parameters = values.iter().map(|&z| exact(&mut out, z)).collect();
                (parameters, vec![Vec::new()])
            }
        };
        let mut equations = homogenize(system, degrees, &mut out, &coordinates, &parameters);
        let mut probe = RandomStream::new(seed, Purpose::Probe, 1);
        let dimension = chart.dimension();
        normalize(&mut out, &mut equations, dimension, &targets[0], &mut probe);
        let program = Interpreter::compile(&out, &equations, dimension, targets[0].len());
        Self {
            doubles: Evaluate::<f64>::scratch(&program, ()),
            double_doubles: Evaluate::<DoubleDouble<f64>>::scratch(&program, ()),
            constants: Constants::of(&out, &equations),
            program,
            expressions: out,
            equations,
            chart,
            targets,
        }
    }

    /// F and its Jacobian at a point of the chart.
    pub fn linearize(&self, point: &[Complex64], target: u64) -> Linearization {
        let native = |z: &Complex64| Complex { re: z.re, im: z.im };
        let x: Vec<_> = point.iter().map(native).collect();
        let p: Vec<_> = self.targets[target as usize].iter().map(native).collect();
        let (rows, n) = (self.program.shape().equations, point.len());
        let mut matrix = Matrix::zeros((), rows, n + 2);
        dispatch_baseline(Linearize {
            program: &self.program,
            x: &x,
            p: &p,
            matrix: &mut matrix,
            scratch: self.doubles.clone(),
        });
        let column = |j: usize| -> Vec<Complex64> {
            let entry = |i: usize| Complex64::new(matrix.at(i, j).re, matrix.at(i, j).im);
            (0..rows).map(entry).collect()
        };
        Linearization {
            values: column(n),
            columns: (0..n).map(column).collect(),
        }
    }

    /// Computes F and its Jacobian at a point of the chart in double-doubles, so that small values keep their digits.
    pub(crate) fn linearize_precisely(
        &self,
        point: &[Complex<DoubleDouble<f64>>],
        target: u64,
    ) -> Linearization {
        let parameters = self.targets[target as usize].iter();
        let p: Vec<_> = parameters.map(in_double_doubles).collect();
        let (rows, n) = (self.program.shape().equations, point.len());
        let mut matrix = Matrix::zeros((), rows, n + 2);
        dispatch_baseline(Linearize {
            program: &self.program,
            x: point,
            p: &p,
            matrix: &mut matrix,
            scratch: self.double_doubles.clone(),
        });
        let column = |j: usize| -> Vec<Complex64> {
            let entry = |i: usize| {
                let z: &Complex<DoubleDouble<f64>> = matrix.at(i, j);
                Complex64::new(z.re.control(), z.im.control())
            };
            (0..rows).map(entry).collect()
        };
        Linearization {
            values: column(n),
            columns: (0..n).map(column).collect(),
        }
    }

    /// The chart of the points.
    pub fn chart(&self) -> &Chart {
        &self.chart
    }

    /// Estimates the size of the derivative of the Jacobian, from differences in random directions. `columns` are the
    /// Jacobian at the point.
    pub fn curvature(&self, point: &[Complex64], target: u64, columns: &[Vec<Complex64>]) -> f64 {
        const DIRECTIONS: u64 = 2;
        const STEP: f64 = 1e-4;
        let mut largest = 0.0f64;
        for k in 0..DIRECTIONS {
            let mut random = RandomStream::new(k, Purpose::Probe, 2);
            let length = STEP * norm(point);
            let moved: Vec<_> = point.iter().map(|z| z + random.unit() * length).collect();
            let there = self.linearize(&moved, target).columns;
            let pairs = there.iter().flatten().zip(columns.iter().flatten());
            let change: f64 = pairs.map(|(a, b)| (a - b).norm_sqr()).sum();
            largest = largest.max(change.sqrt() / length);
        }
        largest
    }

    /// The equations as power series, where the coordinates have these series.
    pub fn expand(
        &self,
        monomials: &Monomials,
        coordinates: &[Series],
        target: u64,
    ) -> Option<Vec<Series>> {
        let parameters = self.targets.get(usize::try_from(target).ok()?)?;
        let (expressions, constants) = (&self.expressions, &self.constants);
        monomials.expand(
            expressions,
            constants,
            &self.equations,
            coordinates,
            parameters,
        )
    }

    /// Computes how well the endpoint of a path solves all equations; `None` for a failed path.
    pub fn fit(&self, result: &PathResult, target: u64) -> Option<AskedFit> {
        if matches!(result.outcome, PathOutcome::Failed(_)) {
            return None;
        }
        let point = self.chart.point(result.endpoint.to_double())?;
        let precise: Vec<_> = point.iter().map(in_double_doubles).collect();
        // Near a singular point a step by values in doubles is as long as their rounding errors make it.
        let Linearization { values, columns } = self.linearize_precisely(&precise, target);
        let svd = Svd::of(columns);
        // A direction in which nothing changes says nothing about how far the solution is.
        let largest = svd.values.first().copied().unwrap_or(0.0);
        let rank = svd.values.iter().filter(|&&s| s > 1e-14 * largest).count();
        let step = svd.least_squares(&values, rank);
        // The size of a vector with a NaN entry is infinite.
        let size = |z: &[Complex64]| {
            let largest = z.iter().map(|z| z.norm_sqr()).fold(0.0, |m: f64, s| {
                if s.is_nan() { f64::INFINITY } else { m.max(s) }
            });
            largest.sqrt()
        };
        Some(AskedFit {
            residual: size(&values),
            correction: size(&step) / norm(&point),
        })
    }
}

fn in_double_doubles(z: &Complex64) -> Complex<DoubleDouble<f64>> {
    Complex {
        re: DoubleDouble::<f64>::from_f64((), z.re),
        im: DoubleDouble::<f64>::from_f64((), z.im),
    }
}
