//! From a system and a kind of homotopy to the program that the tracker runs.
//!
//! Homogenise into the random patches, scale each equation by a power of two,
//! join the start system, put the rows into the order in which elimination
//! wants them, compile. All of it is a pure function of system, kind and seed.

use super::regeneration::Level;
use super::toric_path::ToricPath;
use super::{HomotopyKind, ParameterPath};
use crate::chart::{Chart, exact};
use crate::start_systems::linear_product::LinearProduct;
use crate::start_systems::multihomogeneous::Multihomogeneous;
use crate::start_systems::polyhedral::generic::{GenericSystem, ToricStart};
use crate::start_systems::total_degree::TotalDegree;
use cognate_machine_code::elimination::MOST_ROWS;
use cognate_machine_code::{Elimination, Evaluator};
use cognate_numeric::lanes::dispatch::InstructionSet;
use cognate_numeric::linear_algebra::lu::{flops, pivot_order};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::linear_algebra::sparse::{SparseElimination, sparse_order};
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, values};
use cognate_systems::expression::{Expressions, NodeId};
use cognate_systems::polynomial::Degrees;
use cognate_systems::system::System;
use cognate_systems::transform::homogenize;
use num_complex::Complex64;
use std::sync::Arc;
use std::vec::IntoIter;

/// What [`crate::stage`] sees to.
const SECTIONS: &str = "sections are prepared as a parameter homotopy of the curve";

/// The start system of a straight-line homotopy.
#[derive(Clone, Debug)]
pub(crate) enum StartSystem {
    TotalDegree(TotalDegree),
    Multihomogeneous(Multihomogeneous),
    LinearProduct(Arc<LinearProduct>),
    Toric(Arc<ToricStart>),
    Generic(GenericSystem),
}

/// A homotopy ready to be tracked: every one is a program F(z; p(t)).
#[derive(Debug)]
pub struct Homotopy {
    program: Interpreter,
    evaluator: Evaluator,
    elimination: Elimination,
    chart: Chart,
    path: ParameterPath,
    /// Parameters of the program at t = 1.
    start: Vec<Complex64>,
    /// Parameters of the program at t = 0, for each target.
    targets: Vec<Vec<Complex64>>,
    /// Where paths begin in mixed cells: a target is the path itself.
    toric: Option<Arc<ToricStart>>,
    /// Degree of each row of the program in each group; none where residuals are taken as they
    /// are, wherever in its patch a point lies.
    row_degrees: Vec<Vec<u32>>,
}

/// The power of two that brings `size` between 1/2 and 1.
fn power_of_two_scale(size: f64) -> i32 {
    let (mut exponent, mut size) = (0, size);
    while size > 1.0 && exponent > -1000 {
        size *= 0.5;
        exponent -= 1;
    }
    while size <= 0.5 && size > 0.0 && exponent < 1000 {
        size *= 2.0;
        exponent += 1;
    }
    exponent
}

/// The powers of two that bring the values of each equation at random points to about 1.
fn scales(
    out: &Expressions,
    equations: &[NodeId],
    dimension: usize,
    parameters: &[Complex64],
    stream: &mut RandomStream,
) -> Vec<i32> {
    const PROBES: usize = 4;
    let mut sizes = vec![0.0f64; equations.len()];
    for _ in 0..PROBES {
        let x: Vec<_> = (0..dimension).map(|_| stream.unit()).collect();
        for (size, value) in sizes.iter_mut().zip(values(out, equations, &x, parameters)) {
            Real::max(size, &value.norm_sqr().sqrt());
        }
    }
    sizes.into_iter().map(power_of_two_scale).collect()
}

/// Multiplies each equation by a power of two.
fn scale(out: &mut Expressions, equations: &mut [NodeId], exponents: &[i32]) {
    for (equation, &exponent) in equations.iter_mut().zip(exponents) {
        let scale = Rational::from(1) << exponent;
        let scale = out.constant(ComplexRational::real(scale));
        *equation = out.multiply(scale, *equation);
    }
}

/// Scales each equation by a power of two, so that its values at points of the patch are about 1.
pub(crate) fn normalize(
    out: &mut Expressions,
    equations: &mut [NodeId],
    dimension: usize,
    parameters: &[Complex64],
    stream: &mut RandomStream,
) {
    let exponents = scales(out, equations, dimension, parameters, stream);
    scale(out, equations, &exponents);
}

/// Scales of a system and of the start equations: in whatever chart a homotopy goes on, it is the
/// same with the scales of one chart only.
fn scales_of_both(
    system: &System,
    degrees: &Degrees,
    parameters: &[Complex64],
    start: impl FnOnce(&mut Expressions, &[Vec<NodeId>]) -> Vec<NodeId>,
    chart: &Chart,
    stream: &mut RandomStream,
) -> [Vec<i32>; 2] {
    let mut out = Expressions::new();
    let coordinates = chart.nodes(&mut out);
    let values: Vec<NodeId> = parameters.iter().map(|&z| exact(&mut out, z)).collect();
    let asked = homogenize(system, degrees, &mut out, &coordinates, &values);
    let start = start(&mut out, &coordinates);
    [asked, start].map(|equations| scales(&out, &equations, chart.dimension(), &[], stream))
}

/// `base^exponent` by multiplication: the same bits everywhere.
fn power(base: f64, exponent: u32) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}

/// A random unit complex number at least 30 degrees off the real axis.
///
/// Any generic one serves. Singularities of systems with real coefficients crowd near the real
/// axis, and a path that keeps away from them takes fewer steps (measured on noon-5: 25 steps
/// a path against 139).
fn generic_unit(seed: u64, purpose: Purpose) -> Complex64 {
    let mut stream = RandomStream::new(seed, purpose, 0);
    loop {
        let z = stream.unit();
        if z.im.abs() >= 0.5 {
            return z;
        }
    }
}

/// A random unit complex number between 20 and 60 degrees off the real axis, either side.
///
/// Wide enough to pass by the singularities between real parameters, and not longer than needed:
/// between generic nine-point parameters such arcs took 10 % fewer steps than half-circles.
///
/// With s = 1 - t, 1 - phi(t) is phi(s) of [`super::ParameterPath`] with 1 / gamma, the conjugate: that is
/// the arc of [`way_back`].
fn detour(seed: u64) -> Complex64 {
    let back = way_back(seed);
    let mut stream = RandomStream::new(seed.min(back), Purpose::Detour, 0);
    let tangent_of_half = 0.18 + 0.4 * stream.uniform();
    let square = tangent_of_half * tangent_of_half;
    let side = if stream.bits() & 1 == 0 { 2.0 } else { -2.0 };
    let side = if seed > back { -side } else { side };
    Complex64::new(1.0 - square, side * tangent_of_half) / (1.0 + square)
}

/// The seed of a parameter homotopy that goes the same path of parameters back: with start and target
/// exchanged, it ends where the homotopy with this seed began. Applied twice it is the seed again.
pub fn way_back(seed: u64) -> u64 {
    !seed
}

/// Smallest number of rows that is eliminated by lists; below, code for all entries is faster.
const LEAST_SPARSE: usize = MOST_ROWS + 1;
/// Lists serve where they save at least this part of the operations.
const SAVED: f64 = 0.4;

/// The program with its rows in the order that elimination prefers for matrices like these,
/// the elimination, and the order.
fn arrange(
    program: &Interpreter,
    samples: &[Matrix<f64>],
    instructions: InstructionSet,
) -> (Interpreter, Elimination, Vec<usize>) {
    let n = program.shape().variables;
    if n >= LEAST_SPARSE {
        let pattern = program.pattern();
        let order = sparse_order(&pattern, samples);
        let rows: Vec<_> = order.rows.iter().map(|&i| pattern[i].clone()).collect();
        let sparse = SparseElimination::new(&rows, &order.columns);
        if sparse.flops() as f64 <= (1.0 - SAVED) * flops(n as u64, 2) as f64 {
            let program = program.with_row_order(&order.rows);
            return (program, Elimination::sparse(n, sparse), order.rows);
        }
    }
    let order = pivot_order(samples);
    (
        program.with_row_order(&order),
        Elimination::new(n, instructions),
        order,
    )
}

impl StartSystem {
    /// The start equations of a straight-line homotopy over the chart's homogeneous coordinates.
    fn equations(
        &self,
        system: &System,
        degrees: &Degrees,
        out: &mut Expressions,
        coordinates: &[Vec<NodeId>],
    ) -> Vec<NodeId> {
        match self {
            Self::Generic(s) => s.constant_equations(system, &degrees.by_group, out, coordinates),
            Self::TotalDegree(s) => s.equations(out, &coordinates[0]),
            Self::Multihomogeneous(s) => s.equations(out, coordinates),
            Self::LinearProduct(s) => s.equations(out, &coordinates[0]),
            Self::Toric(_) => panic!("a straight-line homotopy has a start system"),
        }
    }
}

impl Homotopy {
    /// Makes the program. The system has been checked, is square, and the
    /// lengths of all parameter values fit it. `first_chart`: that of the first attempt, to whose
    /// scales all others keep. `begins`: points of the chart where paths begin,
    /// as a sample; none where start points are made from a start system.
    pub(crate) fn new(
        system: &System,
        degrees: &Degrees,
        kind: &HomotopyKind,
        start_system: Option<&StartSystem>,
        chart: Chart,
        first_chart: &Chart,
        begins: &[Vec<Complex64>],
        seed: u64,
    ) -> Self {
        let mut out = Expressions::new();
        let coordinates = chart.nodes(&mut out);
        let count = system.parameters.len();
        let parameter_nodes: Vec<NodeId> = match kind {
            HomotopyKind::StraightLine { parameters }
            | HomotopyKind::Generic { parameters }
            | HomotopyKind::MoveSlice { parameters, .. }
            | HomotopyKind::ProductToEquation { parameters, .. } => {
                parameters.iter().map(|&z| exact(&mut out, z)).collect()
            }
            HomotopyKind::Toric => Vec::new(),
            HomotopyKind::Parameter { .. } => (0..count).map(|k| out.parameter(k as u32)).collect(),
            HomotopyKind::Sections { .. } => panic!("{SECTIONS}"),
            HomotopyKind::PathVariable { parameters } => (0..count)
                .map(|k| {
                    if system.path_variable == Some(k) {
                        out.parameter(0)
                    } else {
                        exact(&mut out, parameters[k])
                    }
                })
                .collect(),
        };
        let toric = match (kind, start_system) {
            (HomotopyKind::Toric, Some(StartSystem::Toric(toric))) => Some(Arc::clone(toric)),
            _ => None,
        };
        let mut equations = match &toric {
            Some(toric) => {
                let mut number = 0..;
                let parameter = |out: &mut Expressions| out.parameter(number.next().unwrap_or(0));
                let generic = toric.generic();
                generic.equations(system, &degrees.by_group, &mut out, &coordinates, parameter)
            }
            None => homogenize(system, degrees, &mut out, &coordinates, &parameter_nodes),
        };
        let dimension = chart.dimension();
        let mut probe = RandomStream::new(seed, Purpose::Probe, 0);
        let one = Complex64::new(1.0, 0.0);
        let zero = Complex64::default();
        let at_start: Vec<Complex64> = match kind {
            HomotopyKind::StraightLine { .. }
            | HomotopyKind::Generic { .. }
            | HomotopyKind::MoveSlice { .. }
            | HomotopyKind::ProductToEquation { .. } => Vec::new(),
            HomotopyKind::Toric => toric
                .iter()
                .flat_map(|toric| toric.generic().coefficients())
                .collect(),
            HomotopyKind::Parameter { start, .. } => start.clone(),
            HomotopyKind::Sections { .. } => panic!("{SECTIONS}"),
            HomotopyKind::PathVariable { .. } => vec![one],
        };
        let level = Level::of(kind, seed);
        // Where two systems are joined, all charts must join them alike.
        let mut beside = RandomStream::new(seed, Purpose::Probe, 1);
        let shared_scales = match (kind, start_system) {
            (
                HomotopyKind::StraightLine { parameters } | HomotopyKind::Generic { parameters },
                Some(start),
            ) => {
                let stream = match kind {
                    HomotopyKind::StraightLine { .. } => &mut probe,
                    _ => &mut beside,
                };
                let both = scales_of_both(
                    system,
                    degrees,
                    parameters,
                    |out, coordinates| start.equations(system, degrees, out, coordinates),
                    first_chart,
                    stream,
                );
                Some(match start {
                    StartSystem::Multihomogeneous(start) => both.map(|exponents| {
                        let exchanged = |i: usize| start.exchanged().map_or(i, |to| to[i]);
                        (0..exponents.len())
                            .map(|i| exponents[i.min(exchanged(i))])
                            .collect()
                    }),
                    _ => both,
                })
            }
            (HomotopyKind::ProductToEquation { parameters, .. }, _) => level.map(|level| {
                let degree = degrees.total[level.next()];
                let product = |out: &mut Expressions, coordinates: &[Vec<NodeId>]| {
                    vec![level.product(out, &coordinates[0], degree)]
                };
                scales_of_both(
                    system,
                    degrees,
                    parameters,
                    product,
                    first_chart,
                    &mut beside,
                )
            }),
            _ => None,
        };
        match &shared_scales {
            Some([asked, _]) => scale(&mut out, &mut equations, asked),
            None => normalize(&mut out, &mut equations, dimension, &at_start, &mut probe),
        }

        let (arc, start, targets) = match kind {
            HomotopyKind::StraightLine { .. } | HomotopyKind::Generic { .. } => {
                let start_system = start_system.expect("a straight-line homotopy has a start");
                let mut starts = start_system.equations(system, degrees, &mut out, &coordinates);
                if let Some([_, start]) = &shared_scales {
                    scale(&mut out, &mut starts, start);
                }
                let (of_target, of_start) = (out.parameter(0), out.parameter(1));
                for (equation, start) in equations.iter_mut().zip(starts) {
                    let f = out.multiply(of_target, *equation);
                    let g = out.multiply(of_start, start);
                    *equation = out.add(f, g);
                }
                let gamma = match (kind, start_system) {
                    (HomotopyKind::Generic { parameters }, StartSystem::Generic(generic)) => {
                        generic.gamma(system, parameters, seed)
                    }
                    _ => generic_unit(seed, Purpose::Gamma),
                };
                if matches!(kind, HomotopyKind::Generic { .. }) {
                    // Both together as this chart would have them.
                    normalize(
                        &mut out,
                        &mut equations,
                        dimension,
                        &[one, gamma],
                        &mut probe,
                    );
                }
                (None, vec![zero, gamma], vec![vec![one, zero]])
            }
            HomotopyKind::Parameter { start, targets } => {
                let gamma = detour(seed);
                (Some(gamma), start.clone(), targets.clone())
            }
            HomotopyKind::Sections { .. } => panic!("{SECTIONS}"),
            HomotopyKind::PathVariable { .. } => (None, vec![one], vec![vec![zero]]),
            HomotopyKind::Toric => (None, at_start.clone(), vec![at_start.clone()]),
            HomotopyKind::MoveSlice { .. } => {
                let level = level.expect("it is a level");
                let moving = Level::moving_form(&mut out, &coordinates[0]);
                equations = level.rows(&mut out, &coordinates[0], &equations, moving);
                let (slice, forms) = level.ends();
                (None, slice, forms)
            }
            HomotopyKind::ProductToEquation { .. } => {
                let level = level.expect("it is a level");
                let degree = degrees.total[level.next()];
                let mut start = [level.product(&mut out, &coordinates[0], degree)];
                if let Some([_, exponent]) = &shared_scales {
                    scale(&mut out, &mut start, exponent);
                }
                let (of_target, of_start) = (out.parameter(0), out.parameter(1));
                let f = out.multiply(of_target, equations[level.next()]);
                let g = out.multiply(of_start, start[0]);
                let moving = out.add(f, g);
                equations = level.rows(&mut out, &coordinates[0], &equations, moving);
                let gamma = generic_unit(seed, Purpose::Gamma);
                (None, vec![zero, gamma], vec![vec![one, zero]])
            }
        };

        // The order in which elimination meets the rows: from points where the paths begin, or
        // half-way at random points.
        let native = |z: Complex64| Complex { re: z.re, im: z.im };
        let program = Interpreter::compile(&out, &equations, dimension, start.len());
        let mut scratch = Evaluate::<f64>::scratch(&program, ());
        let mut samples = Vec::new();
        let mut sample = |x: &[Complex64], p: &[Complex<f64>]| {
            let x: Vec<_> = x.iter().map(|&z| native(z)).collect();
            let mut matrix = Matrix::zeros((), dimension, dimension + 2);
            program.jacobian(&x, p, &mut matrix, &mut scratch);
            samples.push(matrix);
        };
        if begins.is_empty() {
            let p: Vec<_> = start
                .iter()
                .zip(&targets[0])
                .map(|(s, t)| native((s + t) * 0.5))
                .collect();
            for _ in 0..4 {
                let x: Vec<_> = (0..dimension).map(|_| probe.unit()).collect();
                sample(&x, &p);
            }
        } else {
            let p: Vec<_> = start.iter().map(|&z| native(z)).collect();
            for x in begins {
                sample(x, &p);
            }
        }
        let instructions = InstructionSet::detect();
        let (program, elimination, order) = arrange(&program, &samples, instructions);
        let of_rows = match (kind, level) {
            (HomotopyKind::Toric | HomotopyKind::Generic { .. }, _) => degrees.by_group.clone(),
            (_, Some(level)) => level.row_degrees(&degrees.by_group),
            _ => Vec::new(),
        };
        let row_degrees = match of_rows.is_empty() {
            true => Vec::new(),
            false => order.iter().map(|&i| of_rows[i].clone()).collect(),
        };
        Self {
            evaluator: Evaluator::new(program.clone(), instructions),
            elimination,
            program,
            chart,
            path: ParameterPath {
                arc,
                toric: toric.as_ref().map(|toric| ToricPath {
                    exponent: toric.time_exponent(),
                }),
            },
            toric,
            row_degrees,
            start,
            targets,
        }
    }

    /// The same program, as machine code where this machine allows it.
    pub fn evaluator(&self) -> &Evaluator {
        &self.evaluator
    }

    /// Elimination of matrices [J | H | H_t] of this homotopy.
    pub fn elimination(&self) -> &Elimination {
        &self.elimination
    }

    /// The program of H and its derivatives.
    pub fn program(&self) -> &Interpreter {
        &self.program
    }

    /// How the program's parameters move with t.
    pub fn path(&self) -> &ParameterPath {
        &self.path
    }

    /// The chart that the paths are tracked in.
    pub fn chart(&self) -> &Chart {
        &self.chart
    }

    /// Number of coordinates.
    pub fn dimension(&self) -> usize {
        self.chart.dimension()
    }

    /// Number of parameters of the program.
    pub fn parameter_count(&self) -> usize {
        self.start.len()
    }

    /// `a` and `b` of p(t) = a + phi(t) b on the way to this target; of a toric homotopy
    /// coefficients and weights, and the target is the path itself, in its cell.
    pub(crate) fn ends(&self, target: u64) -> (IntoIter<Complex64>, IntoIter<Complex64>) {
        if let Some(toric) = &self.toric {
            let weights = toric.weights(target).into_iter();
            let weights: Vec<_> = weights.map(|w| Complex64::new(w, 0.0)).collect();
            return (self.start.clone().into_iter(), weights.into_iter());
        }
        let target = &self.targets[target as usize];
        let way: Vec<_> = self.start.iter().zip(target).map(|(s, t)| s - t).collect();
        (target.clone().into_iter(), way.into_iter())
    }

    /// How much larger each row can be at this point than where the largest coordinate of every
    /// group is 1; none where that is not asked.
    pub(crate) fn row_scales(&self, point: &[Complex64]) -> Vec<f64> {
        if self.row_degrees.is_empty() {
            return Vec::new();
        }
        let coordinates = self.chart.homogeneous(point);
        let mut begin = 0;
        let sizes: Vec<f64> = (0..self.chart.group_count())
            .map(|g| {
                let end = begin + self.chart.group_size(g);
                let group = &coordinates[begin..end];
                begin = end;
                let largest = group.iter().fold(1.0f64, |m, z| m.max(z.norm_sqr()));
                largest.sqrt()
            })
            .collect();
        let scale = |degrees: &Vec<u32>| {
            let powers = sizes.iter().zip(degrees);
            powers.fold(1.0, |product, (size, &degree)| {
                product * power(*size, degree)
            })
        };
        self.row_degrees.iter().map(scale).collect()
    }

    /// Values of the homogenising coordinates at a point of the chart, of one lane: formed with
    /// all digits of the point, since they are small where they matter.
    pub(crate) fn homogenizing<R: Real>(
        &self,
        context: R::Context,
        point: &[Complex<R>],
    ) -> Vec<Complex<R>> {
        self.chart.homogenizing_values(context, point)
    }

    /// Normalised homogeneous coordinates of a point of the chart.
    pub(crate) fn endpoint(&self, point: &[Complex64]) -> Vec<Complex64> {
        let mut coordinates = self.chart.homogeneous(point);
        self.chart.normalize(&mut coordinates);
        coordinates
    }

    /// The same of a point with more digits, from which those of the homogenising coordinates come.
    pub(crate) fn precise_endpoint<S: Real>(
        &self,
        context: S::Context,
        point: &[Complex<S>],
    ) -> Vec<Complex64> {
        let rounded: Vec<Complex64> = point.iter().map(|z| z.lane(0)).collect();
        let mut coordinates = self.chart.homogeneous(&rounded);
        let precise = self.homogenizing(context, point);
        for (place, y0) in self.chart.homogenizing().into_iter().zip(precise) {
            coordinates[place] = y0.lane(0);
        }
        self.chart.normalize(&mut coordinates);
        coordinates
    }

    /// The smallest homogenising coordinate of normalised homogeneous coordinates; infinity where there is none.
    pub(crate) fn smallest_homogenizing(&self, coordinates: &[Complex64]) -> f64 {
        let places = self.chart.homogenizing().into_iter();
        let sizes = places.map(|place| size(coordinates[place]));
        sizes.fold(f64::INFINITY, f64::min)
    }

    /// Sets homogenising coordinates that are at most `least` to `value`, in normalised homogeneous coordinates.
    pub(crate) fn set_homogenizing(&self, coordinates: &mut [Complex64], least: f64, value: f64) {
        for place in self.chart.homogenizing() {
            if size(coordinates[place]) <= least {
                coordinates[place] = Complex64::new(value, 0.0);
            }
        }
    }
}

/// The larger of the real and the imaginary part: of numbers whose squares are none of a double's, too.
fn size(z: Complex64) -> f64 {
    z.re.abs().max(z.im.abs())
}
