//! From a system and a kind of homotopy to the program that the tracker runs.
//!
//! Homogenise into the random patches, scale each equation by a power of two,
//! join the start system, put the rows into the order in which elimination
//! wants them, compile. All of it is a pure function of system, kind and seed.

use super::moved_values::moved;
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

/// Message of the panic where a homotopy of sections is compiled directly; [`crate::stage`] compiles these.
const SECTIONS: &str = "sections are prepared as a parameter homotopy of the curve";

/// Makes a program of expressions and equations, with these numbers of variables and parameters.
pub(crate) type Compile = fn(&Expressions, &[NodeId], usize, usize) -> Interpreter;

/// The start system of a straight-line homotopy.
#[derive(Clone, Debug)]
pub(crate) enum StartSystem {
    TotalDegree(TotalDegree),
    Multihomogeneous(Multihomogeneous),
    LinearProduct(Arc<LinearProduct>),
    Toric(Arc<ToricStart>),
    Generic(GenericSystem),
}

/// A homotopy ready to be tracked: every one is a program F(z; p(t)). Cloning shares the machine code.
#[derive(Clone, Debug)]
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
    /// Whether targets are nothing but numbers beside the program: it is made from where paths begin.
    targets_are_free: bool,
    /// Mixed cells where paths begin: a target is the path itself.
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
/// between generic nine-point parameters these arcs took 10 % fewer steps than half-circles.
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

    /// The start of a toric homotopy, where it is one.
    fn toric(&self) -> Option<Arc<ToricStart>> {
        match self {
            Self::Toric(toric) => Some(Arc::clone(toric)),
            Self::Generic(_)
            | Self::TotalDegree(_)
            | Self::Multihomogeneous(_)
            | Self::LinearProduct(_) => None,
        }
    }
}

/// A homotopy that is being made.
struct Build<'a> {
    system: &'a System,
    degrees: &'a Degrees,
    kind: &'a HomotopyKind,
    start_system: Option<&'a StartSystem>,
    first_chart: &'a Chart,
    seed: u64,
    level: Option<Level<'a>>,
    /// Number of coordinates of the chart.
    dimension: usize,
    out: Expressions,
    /// The chart's homogeneous coordinates, group by group.
    coordinates: Vec<Vec<NodeId>>,
    /// The points of this chart at which rows are scaled and put into order.
    probe: RandomStream,
}

/// Parameters of the program at the start and at the targets of the homotopy.
struct Ends {
    /// Detour of an arc between start and target parameters; `None` where the homotopy does not follow an arc.
    arc: Option<Complex64>,
    start: Vec<Complex64>,
    /// Parameters at each target.
    targets: Vec<Vec<Complex64>>,
}

const ZERO: Complex64 = Complex64::new(0.0, 0.0);
const ONE: Complex64 = Complex64::new(1.0, 0.0);

impl<'a> Build<'a> {
    fn new(
        system: &'a System,
        degrees: &'a Degrees,
        kind: &'a HomotopyKind,
        start_system: Option<&'a StartSystem>,
        chart: &Chart,
        first_chart: &'a Chart,
        seed: u64,
    ) -> Self {
        assert!(!matches!(kind, HomotopyKind::Sections { .. }), "{SECTIONS}");
        let mut out = Expressions::new();
        let coordinates = chart.nodes(&mut out);
        Self {
            system,
            degrees,
            kind,
            start_system,
            first_chart,
            seed,
            level: Level::of(kind, seed),
            dimension: chart.dimension(),
            out,
            coordinates,
            probe: RandomStream::new(seed, Purpose::Probe, 0),
        }
    }

    /// The parameters of the system as nodes: numbers, or parameters of the program.
    fn parameters(&mut self) -> Vec<NodeId> {
        let (out, count) = (&mut self.out, self.system.parameters.len());
        match self.kind {
            HomotopyKind::StraightLine { parameters }
            | HomotopyKind::Generic { parameters }
            | HomotopyKind::MoveSlice { parameters, .. }
            | HomotopyKind::ProductToEquation { parameters, .. } => {
                parameters.iter().map(|&z| exact(out, z)).collect()
            }
            HomotopyKind::Toric => Vec::new(),
            HomotopyKind::Parameter { .. } => (0..count).map(|k| out.parameter(k as u32)).collect(),
            HomotopyKind::Sections { .. } => panic!("{SECTIONS}"),
            HomotopyKind::PathVariable { parameters } => (0..count)
                .map(|k| match self.system.path_variable == Some(k) {
                    true => out.parameter(0),
                    false => exact(out, parameters[k]),
                })
                .collect(),
        }
    }

    /// The equations that are asked, or those of a generic system with their coefficients as parameters.
    fn asked(&mut self, toric: Option<&ToricStart>) -> Vec<NodeId> {
        let parameters = self.parameters();
        let (out, coordinates) = (&mut self.out, &self.coordinates);
        match toric {
            Some(toric) => {
                let mut number = 0..;
                let parameter = |out: &mut Expressions| out.parameter(number.next().unwrap_or(0));
                let (generic, degrees) = (toric.generic(), &self.degrees.by_group);
                generic.equations(self.system, degrees, out, coordinates, parameter)
            }
            None => homogenize(self.system, self.degrees, out, coordinates, &parameters),
        }
    }

    /// Parameters of the asked equations at t = 1.
    fn parameters_at_start(&self, toric: Option<&ToricStart>) -> Vec<Complex64> {
        match self.kind {
            HomotopyKind::StraightLine { .. }
            | HomotopyKind::Generic { .. }
            | HomotopyKind::MoveSlice { .. }
            | HomotopyKind::ProductToEquation { .. } => Vec::new(),
            HomotopyKind::Toric => toric
                .into_iter()
                .flat_map(|toric| toric.generic().coefficients())
                .collect(),
            HomotopyKind::Parameter { start, .. } => start.clone(),
            HomotopyKind::Sections { .. } => panic!("{SECTIONS}"),
            HomotopyKind::PathVariable { .. } => vec![ONE],
        }
    }

    /// Exponents of the scales of both systems, where two are joined: all charts must join them alike.
    fn shared_scales(&mut self) -> Option<[Vec<i32>; 2]> {
        let (system, degrees) = (self.system, self.degrees);
        let mut beside = RandomStream::new(self.seed, Purpose::Probe, 1);
        match self.kind {
            HomotopyKind::StraightLine { parameters } | HomotopyKind::Generic { parameters } => {
                let start = self.start_system?;
                let stream = match self.kind.begins_at_the_generic_system() {
                    true => &mut beside,
                    false => &mut self.probe,
                };
                let equations = |out: &mut Expressions, coordinates: &[Vec<NodeId>]| {
                    start.equations(system, degrees, out, coordinates)
                };
                let chart = self.first_chart;
                let both = scales_of_both(system, degrees, parameters, equations, chart, stream);
                Some(match start {
                    StartSystem::Multihomogeneous(start) => both.map(|exponents| {
                        let exchanged = |i: usize| start.exchanged().map_or(i, |to| to[i]);
                        (0..exponents.len())
                            .map(|i| exponents[i.min(exchanged(i))])
                            .collect()
                    }),
                    StartSystem::TotalDegree(_)
                    | StartSystem::LinearProduct(_)
                    | StartSystem::Toric(_)
                    | StartSystem::Generic(_) => both,
                })
            }
            HomotopyKind::ProductToEquation { parameters, .. } => self.level.map(|level| {
                let degree = degrees.total[level.next()];
                let product = |out: &mut Expressions, coordinates: &[Vec<NodeId>]| {
                    vec![level.product(out, &coordinates[0], degree)]
                };
                let (chart, stream) = (self.first_chart, &mut beside);
                scales_of_both(system, degrees, parameters, product, chart, stream)
            }),
            HomotopyKind::Parameter { .. }
            | HomotopyKind::PathVariable { .. }
            | HomotopyKind::Toric
            | HomotopyKind::MoveSlice { .. }
            | HomotopyKind::Sections { .. } => None,
        }
    }

    /// The rows of the program, and how its parameters move. `of_start`: exponents of the scales of what is
    /// joined to the asked equations.
    fn joined(
        &mut self,
        asked: Vec<NodeId>,
        at_start: Vec<Complex64>,
        of_start: Option<&[i32]>,
    ) -> (Vec<NodeId>, Ends) {
        let ends = |start, targets| Ends {
            arc: None,
            start,
            targets,
        };
        match self.kind {
            HomotopyKind::StraightLine { .. } | HomotopyKind::Generic { .. } => {
                self.straight_line(asked, of_start)
            }
            HomotopyKind::Parameter { start, targets } => {
                let arc = Some(detour(self.seed));
                let (start, targets) = (start.clone(), targets.clone());
                (
                    asked,
                    Ends {
                        arc,
                        start,
                        targets,
                    },
                )
            }
            HomotopyKind::Sections { .. } => panic!("{SECTIONS}"),
            HomotopyKind::PathVariable { .. } => (asked, ends(vec![ONE], vec![vec![ZERO]])),
            HomotopyKind::Toric => (asked, ends(at_start.clone(), vec![at_start])),
            HomotopyKind::MoveSlice { .. } => {
                let level = self.level.expect("it is a level");
                let moving = Level::moving_form(&mut self.out, &self.coordinates[0]);
                let rows = level.rows(&mut self.out, &self.coordinates[0], &asked, moving);
                let (slice, forms) = level.ends();
                (rows, ends(slice, forms))
            }
            HomotopyKind::ProductToEquation { .. } => self.product_to_equation(&asked, of_start),
        }
    }

    /// `(1-t) F + t gamma G`, equation by equation.
    fn straight_line(
        &mut self,
        mut equations: Vec<NodeId>,
        of_start: Option<&[i32]>,
    ) -> (Vec<NodeId>, Ends) {
        let (out, coordinates) = (&mut self.out, &self.coordinates);
        let start_system = self.start_system;
        let start_system = start_system.expect("a straight-line homotopy has a start");
        let mut starts = start_system.equations(self.system, self.degrees, out, coordinates);
        if let Some(exponents) = of_start {
            scale(out, &mut starts, exponents);
        }
        let parameters = (out.parameter(0), out.parameter(1));
        for (equation, start) in equations.iter_mut().zip(starts) {
            *equation = joined_by(out, parameters, *equation, start);
        }
        let gamma = match start_system {
            StartSystem::Generic(generic) => {
                let parameters = self.kind.end_parameters(0, None).unwrap_or_default();
                generic.gamma(self.system, &parameters, self.seed)
            }
            StartSystem::TotalDegree(_)
            | StartSystem::Multihomogeneous(_)
            | StartSystem::LinearProduct(_)
            | StartSystem::Toric(_) => generic_unit(self.seed, Purpose::Gamma),
        };
        if self.kind.begins_at_the_generic_system() {
            // Both together as this chart would have them.
            let (n, both) = (self.dimension, [ONE, gamma]);
            normalize(out, &mut equations, n, &both, &mut self.probe);
        }
        (equations, Ends::of_straight_line(gamma))
    }

    /// The next equation of a regeneration joined to the product of the level's forms.
    fn product_to_equation(
        &mut self,
        equations: &[NodeId],
        of_start: Option<&[i32]>,
    ) -> (Vec<NodeId>, Ends) {
        let level = self.level.expect("it is a level");
        let (out, coordinates) = (&mut self.out, &self.coordinates[0]);
        let degree = self.degrees.total[level.next()];
        let mut start = [level.product(out, coordinates, degree)];
        if let Some(exponents) = of_start {
            scale(out, &mut start, exponents);
        }
        let parameters = (out.parameter(0), out.parameter(1));
        let moving = joined_by(out, parameters, equations[level.next()], start[0]);
        let rows = level.rows(out, coordinates, equations, moving);
        let gamma = generic_unit(self.seed, Purpose::Gamma);
        (rows, Ends::of_straight_line(gamma))
    }

    /// Matrices that decide in which order elimination meets the rows: from points where the paths begin, or
    /// half-way at random points.
    fn samples(
        &mut self,
        program: &Interpreter,
        ends: &Ends,
        begins: &[Vec<Complex64>],
    ) -> Vec<Matrix<f64>> {
        let n = self.dimension;
        let native = |z: Complex64| Complex { re: z.re, im: z.im };
        let mut scratch = Evaluate::<f64>::scratch(program, ());
        let mut at = |x: &[Complex64], p: &[Complex<f64>]| {
            let x: Vec<_> = x.iter().map(|&z| native(z)).collect();
            let mut matrix = Matrix::zeros((), n, n + 2);
            program.jacobian(&x, p, &mut matrix, &mut scratch);
            matrix
        };
        if begins.is_empty() {
            let pairs = ends.start.iter().zip(&ends.targets[0]);
            let p: Vec<_> = pairs.map(|(s, t)| native((s + t) * 0.5)).collect();
            let mut point = || -> Vec<_> { (0..n).map(|_| self.probe.unit()).collect() };
            (0..4).map(|_| at(&point(), &p)).collect()
        } else {
            let p: Vec<_> = ends.start.iter().map(|&z| native(z)).collect();
            begins.iter().map(|x| at(x, &p)).collect()
        }
    }

    /// Degrees of the rows in this order; none where residuals are taken as they are.
    fn row_degrees(&self, order: &[usize]) -> Vec<Vec<u32>> {
        let group_degrees = &self.degrees.by_group;
        let of_rows = match self.level {
            Some(level) => level.row_degrees(group_degrees),
            None if self.kind.has_the_generic_system() => group_degrees.clone(),
            None => Vec::new(),
        };
        match of_rows.is_empty() {
            true => Vec::new(),
            false => order.iter().map(|&i| of_rows[i].clone()).collect(),
        }
    }
}

impl Ends {
    /// Parameter path of a straight line from gamma G to F.
    fn of_straight_line(gamma: Complex64) -> Self {
        Self {
            arc: None,
            start: vec![ZERO, gamma],
            targets: vec![vec![ONE, ZERO]],
        }
    }
}

/// `p_0 F + p_1 G` with the program's first two parameters.
fn joined_by(
    out: &mut Expressions,
    (of_target, of_start): (NodeId, NodeId),
    target: NodeId,
    start: NodeId,
) -> NodeId {
    let f = out.multiply(of_target, target);
    let g = out.multiply(of_start, start);
    out.add(f, g)
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
        compile: Compile,
    ) -> Self {
        let toric = start_system.and_then(StartSystem::toric);
        let mut build = Build::new(
            system,
            degrees,
            kind,
            start_system,
            &chart,
            first_chart,
            seed,
        );
        let mut equations = build.asked(toric.as_deref());
        let at_start = build.parameters_at_start(toric.as_deref());
        let shared = build.shared_scales();
        let (out, dimension) = (&mut build.out, build.dimension);
        match &shared {
            Some([asked, _]) => scale(out, &mut equations, asked),
            None => normalize(out, &mut equations, dimension, &at_start, &mut build.probe),
        }
        let of_start = shared.map(|[_, of_start]| of_start);
        let (equations, ends) = build.joined(equations, at_start, of_start.as_deref());
        let program = compile(&build.out, &equations, dimension, ends.start.len());
        let samples = build.samples(&program, &ends, begins);
        let instructions = InstructionSet::detect();
        let (program, elimination, order) = arrange(&program, &samples, instructions);
        let row_degrees = build.row_degrees(&order);
        Self {
            evaluator: Evaluator::new(program.clone(), instructions),
            elimination,
            program,
            chart,
            path: ParameterPath {
                arc: ends.arc,
                toric: toric.as_ref().map(|toric| ToricPath {
                    exponent: toric.time_exponent(),
                }),
            },
            toric,
            row_degrees,
            start: ends.start,
            targets: ends.targets,
            targets_are_free: matches!(kind, HomotopyKind::Parameter { .. }) && !begins.is_empty(),
        }
    }

    /// Replaces the targets of this homotopy, with the same result as [`Self::new`]; `None` where the program depends
    /// on the targets.
    pub(crate) fn with_targets(&self, targets: &[Vec<Complex64>]) -> Option<Self> {
        self.targets_are_free.then(|| Self {
            targets: targets.to_vec(),
            ..self.clone()
        })
    }

    /// The homotopy with one target: this one with slightly other values of the parameters ([`moved`]).
    pub(crate) fn with_moved_target(&self, target: u64) -> Self {
        Self {
            program: self.program.clone(),
            evaluator: self.evaluator.clone(),
            elimination: self.elimination.clone(),
            chart: self.chart.clone(),
            path: self.path,
            start: self.start.clone(),
            targets: vec![moved(&self.targets[target as usize])],
            targets_are_free: false,
            toric: self.toric.clone(),
            row_degrees: self.row_degrees.clone(),
        }
    }

    /// The program of this homotopy as an evaluator: machine code where this machine allows it.
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

    /// Path of the program's parameters as a function of t.
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

    /// Ratio by which each row can be larger at this point than where the largest coordinate of every group is 1; empty
    /// where that is not asked.
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

    /// Computes normalised homogeneous coordinates of a point with more digits; only homogenising coordinates use these
    /// digits.
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
