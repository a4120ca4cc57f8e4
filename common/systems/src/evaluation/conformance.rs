//! The suite that every evaluator passes: `evaluator_conformance!(module, compile)`.
//!
//! Values and derivatives against exact rational arithmetic and against
//! differences at many bits; then bit for bit: against the reference, between
//! widths, and between instruction sets.

use super::{Evaluate, Reference};
use crate::expression::{Expressions, Function, Node, NodeId, differentiate::below};
use crate::named;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch_on};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::directed::Directed;
use cognate_numeric::scalar::{Complex, Interval, MultiplePrecision, Real};

/// A system to check evaluators on.
pub struct Case {
    /// Name of the case, for messages.
    pub name: String,
    /// Expressions of the case's system.
    pub expressions: Expressions,
    /// Equations of the case's system, as nodes of the expressions.
    pub equations: Vec<NodeId>,
    /// Number of variables.
    pub variables: usize,
    /// Number of parameters.
    pub parameters: usize,
}

/// Function that makes an evaluator from expressions, equations, and the numbers of variables and parameters.
pub type Compile<E> = fn(&Expressions, &[NodeId], usize, usize) -> E;

impl Case {
    fn compile<E>(&self, compile: Compile<E>) -> E {
        compile(
            &self.expressions,
            &self.equations,
            self.variables,
            self.parameters,
        )
    }

    fn is_rational(&self) -> bool {
        below(&self.expressions, &self.equations)
            .into_iter()
            .all(|id| {
                !matches!(
                    self.expressions.node(id),
                    Node::Root(..) | Node::Function(..)
                )
            })
    }
}

/// Classical systems, corner cases, and random graphs with every kind of node.
pub fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = [
        ("katsura-4", named::katsura(4)),
        ("cyclic-6", named::cyclic(6)),
        ("noon-4", named::noon(4)),
        ("eco-6", named::eco(6)),
        ("reimer-5", named::reimer(5)),
        ("caprasse", named::caprasse()),
        ("griewank-osborne", named::griewank_osborne()),
    ]
    .into_iter()
    .map(|(name, named)| Case {
        name: name.into(),
        variables: named.system.variable_count(),
        parameters: 0,
        expressions: named.system.expressions,
        equations: named.system.equations,
    })
    .collect();
    cases.push(corners());
    cases.push(constants());
    for seed in 0..24 {
        cases.push(random_graph(seed));
    }
    cases
}

/// Outputs that are inputs, constants, each other's negatives, or 0.
fn corners() -> Case {
    let mut e = Expressions::new();
    let (x, y, p) = (e.variable(0), e.variable(1), e.parameter(0));
    let q = e.parameter(1);
    let minus_x = e.negate(x);
    let sum = e.add(x, y);
    let minus_sum = e.insert(Node::Negate(sum));
    let product = e.multiply(x, y);
    let minus_product = e.negate(product);
    let half = e.constant(ComplexRational::real(Rational::from((-1, 2))));
    let scaled = e.multiply(half, x);
    let i = e.constant(ComplexRational::i());
    let turned = e.multiply(i, y);
    let quotient = e.divide(x, p);
    let squared = e.power(p, 2);
    let other = e.divide(squared, q);
    let other = e.multiply(other, y);
    let power = e.power(x, 11);
    let next = e.power(x, 12);
    let cancelled = e.insert(Node::Subtract(product, product));
    let doubled = e.insert(Node::Add(product, product));
    let five = e.integer(5);
    let difference = e.subtract(squared, product);
    let deep = (0..3000).fold(x, |deep, _| {
        let shifted = e.add(deep, y);
        e.multiply(half, shifted)
    });
    Case {
        name: "corners".into(),
        equations: vec![
            x,
            x,
            minus_x,
            sum,
            minus_sum,
            product,
            minus_product,
            scaled,
            turned,
            quotient,
            other,
            power,
            next,
            cancelled,
            doubled,
            five,
            p,
            difference,
            deep,
        ],
        expressions: e,
        variables: 2,
        parameters: 2,
    }
}

/// Roots and elementary functions of constants.
fn constants() -> Case {
    let mut e = Expressions::new();
    let (x, y) = (e.variable(0), e.variable(1));
    let (two, three, zero) = (e.integer(2), e.integer(3), e.integer(0));
    let root = e.root(three, Rational::from((1, 2)));
    let cube_root = e.root(two, Rational::from((-2, 3)));
    let pi = e.function(Function::Pi, zero);
    let half_pi = e.divide(pi, two);
    let sine = e.function(Function::Sine, half_pi);
    let exponential = e.function(Function::Exponential, root);
    let logarithm = e.function(Function::Logarithm, pi);
    let tangent = e.function(Function::Tangent, root);
    let square_root = e.function(Function::SquareRoot, pi);
    let cosine = e.function(Function::Cosine, two);
    let mut sum = e.multiply(root, x);
    for constant in [
        cube_root,
        sine,
        exponential,
        logarithm,
        tangent,
        square_root,
        cosine,
    ] {
        let term = e.multiply(constant, y);
        let product = e.multiply(sum, x);
        sum = e.add(product, term);
    }
    let ratio = e.divide(x, root);
    Case {
        name: "constants".into(),
        equations: vec![sum, ratio],
        expressions: e,
        variables: 2,
        parameters: 0,
    }
}

/// A random graph in three variables and three parameters.
fn random_graph(seed: u64) -> Case {
    let mut stream = RandomStream::new(seed, Purpose::Test, 7);
    let mut e = Expressions::new();
    let mut nodes: Vec<NodeId> = (0..3).map(|v| e.variable(v)).collect();
    let parameters: Vec<NodeId> = (0..3).map(|p| e.parameter(p)).collect();
    nodes.extend(&parameters);
    for _ in 0..4 {
        let part = |s: &mut RandomStream| Rational::from((s.below(17) as i64 - 8, 4));
        let re = part(&mut stream);
        let im = if stream.below(2) == 0 {
            Rational::new()
        } else {
            part(&mut stream)
        };
        nodes.push(e.constant(ComplexRational::new(re, im)));
    }
    // Degrees stay small, so that values do.
    let mut degree: Vec<u32> = nodes.iter().map(|_| 1).collect();
    let count = 20 + stream.below(60) as usize;
    while nodes.len() < count {
        let mut pick = || stream.below(nodes.len() as u64) as usize;
        let (i, j) = (pick(), pick());
        let (a, b) = (nodes[i], nodes[j]);
        let (node, d) = match stream.below(9) {
            0 | 1 => (e.add(a, b), degree[i].max(degree[j])),
            2 | 3 => (e.subtract(a, b), degree[i].max(degree[j])),
            4 | 5 => (e.multiply(a, b), degree[i] + degree[j]),
            6 => (e.negate(a), degree[i]),
            7 => {
                let exponent = 2 + stream.below(3) as u32;
                (e.power(a, exponent), degree[i] * exponent)
            }
            _ => {
                let p = parameters[stream.below(3) as usize];
                (e.divide(a, p), degree[i] + 1)
            }
        };
        if d <= 12 {
            nodes.push(node);
            degree.push(d);
        }
    }
    Case {
        name: format!("random graph {seed}"),
        equations: nodes[nodes.len() - 6..].to_vec(),
        expressions: e,
        variables: 3,
        parameters: 3,
    }
}

/// A point with a few bits in every coordinate, none of them 0.
fn rational_point(count: usize, stream: &mut RandomStream) -> Vec<ComplexRational> {
    let mut part = || Rational::from((2 * stream.below(40) as i64 - 39, 32));
    (0..count)
        .map(|_| ComplexRational::new(part(), part()))
        .collect()
}

/// Exact value and derivative of each equation along one direction.
fn exact_along(
    case: &Case,
    point: [&[ComplexRational]; 2],
    direction: [&[ComplexRational]; 2],
) -> Vec<(ComplexRational, ComplexRational)> {
    type Dual = (ComplexRational, ComplexRational);
    let mut duals: std::collections::HashMap<NodeId, Dual> = std::collections::HashMap::new();
    for id in below(&case.expressions, &case.equations) {
        let product = |a: &Dual, b: &Dual| -> Dual {
            let slope = a.0.multiply(&b.1).add(&a.1.multiply(&b.0));
            (a.0.multiply(&b.0), slope)
        };
        let dual = match case.expressions.node(id) {
            Node::Constant(c) => (c.clone(), ComplexRational::default()),
            Node::Variable(v) => {
                let v = *v as usize;
                (point[0][v].clone(), direction[0][v].clone())
            }
            Node::Parameter(p) => {
                let p = *p as usize;
                (point[1][p].clone(), direction[1][p].clone())
            }
            Node::Add(a, b) => (duals[a].0.add(&duals[b].0), duals[a].1.add(&duals[b].1)),
            Node::Subtract(a, b) => (
                duals[a].0.subtract(&duals[b].0),
                duals[a].1.subtract(&duals[b].1),
            ),
            Node::Negate(a) => (duals[a].0.negate(), duals[a].1.negate()),
            Node::Multiply(a, b) => product(&duals[a], &duals[b]),
            Node::Power(a, exponent) => {
                let mut power = duals[a].clone();
                for _ in 1..*exponent {
                    power = product(&power, &duals[a]);
                }
                power
            }
            Node::Divide(a, b) => {
                let (a, b) = (&duals[a], &duals[b]);
                let value = a.0.divide(&b.0).expect("no parameter of a case is 0");
                let numerator = a.1.subtract(&value.multiply(&b.1));
                let slope = numerator.divide(&b.0).expect("no parameter of a case is 0");
                (value, slope)
            }
            Node::Root(..) | Node::Function(..) => unreachable!("the case is rational"),
        };
        duals.insert(id, dual);
    }
    case.equations.iter().map(|id| duals[id].clone()).collect()
}

fn round<R: Real>(context: R::Context, point: &[ComplexRational]) -> Vec<Complex<R>> {
    point
        .iter()
        .map(|z| Complex::from_rational(context, z))
        .collect()
}

fn assert_close(
    name: &str,
    what: &str,
    computed: &Complex<MultiplePrecision>,
    expected: &Complex<MultiplePrecision>,
    bits: i32,
) {
    let mut difference = computed.clone();
    difference.sub(expected);
    let (error, size) = (difference.norm_sqr().0, expected.norm_sqr().0);
    let bound = rug::Float::with_val(64, 1 + size) >> (2 * bits);
    assert!(
        error <= bound,
        "{name}: {what} is off: {computed:?} instead of {expected:?}"
    );
}

/// Values and all derivatives against exact rational arithmetic.
///
/// # Panics
/// When they differ by more than rounding at 300 bits explains.
pub fn check_exactly<E: Evaluate<MultiplePrecision>>(compile: Compile<E>) {
    const BITS: u32 = 300;
    for case in cases().into_iter().filter(Case::is_rational) {
        let evaluator = case.compile(compile);
        let mut scratch = evaluator.scratch(BITS);
        let (n, m, rows) = (case.variables, case.parameters, case.equations.len());
        let mut stream = RandomStream::new(11, Purpose::Test, 0);
        let x = rational_point(n, &mut stream);
        let p = rational_point(m, &mut stream);
        let dp = rational_point(m, &mut stream);
        let (xr, pr, dpr) = (round(BITS, &x), round(BITS, &p), round(BITS, &dp));
        let mut out = Matrix::zeros(BITS, rows, n + 2);
        evaluator.linearize(&xr, &pr, &dpr, &mut out, &mut scratch);
        // [J | H] alone is the same, and leaves the last column as it is.
        let mut alone = Matrix::zeros(BITS, rows, n + 2);
        evaluator.jacobian(&xr, &pr, &mut alone, &mut scratch);
        for row in 0..rows {
            for column in 0..=n {
                assert_eq!(alone.at(row, column), out.at(row, column), "{}", case.name);
            }
            assert_eq!(alone.at(row, n + 1), &Complex::zero(BITS), "{}", case.name);
        }
        let mut values = vec![Complex::zero(BITS); rows];
        evaluator.value(&xr, &pr, &mut values, &mut scratch);
        let still = |count| vec![ComplexRational::default(); count];
        let check = |column: usize, exact: &ComplexRational, row: usize| {
            let expected = Complex::from_rational(BITS, exact);
            let what = format!("entry ({row}, {column})");
            assert_close(&case.name, &what, out.at(row, column), &expected, 220);
        };
        for v in 0..n {
            let mut direction = still(n);
            direction[v] = ComplexRational::real(1);
            let along = exact_along(&case, [&x, &p], [&direction, &still(m)]);
            for (row, (_, slope)) in along.iter().enumerate() {
                check(v, slope, row);
            }
        }
        let along = exact_along(&case, [&x, &p], [&still(n), &dp]);
        for (row, (value, slope)) in along.iter().enumerate() {
            check(n, value, row);
            check(n + 1, slope, row);
            let expected = Complex::from_rational(BITS, value);
            assert_close(&case.name, "value", &values[row], &expected, 220);
        }
    }
}

/// Values and derivatives over boxes: the exact ones, at points of the boxes, lie within.
///
/// # Panics
/// When an exact value or derivative is outside of its enclosure, or nothing is enclosed.
pub fn check_enclosures<R: Directed, E: Evaluate<Interval<R>>>(
    compile: Compile<E>,
    context: R::Context,
) {
    for case in cases().into_iter().filter(Case::is_rational) {
        let evaluator = case.compile(compile);
        let mut scratch = evaluator.scratch(context);
        let (n, m, rows) = (case.variables, case.parameters, case.equations.len());
        let mut stream = RandomStream::new(13, Purpose::Test, 0);
        let centre = rational_point(n, &mut stream);
        let p = rational_point(m, &mut stream);
        let dp = rational_point(m, &mut stream);
        for width in [Rational::new(), Rational::from((1, 1u64 << 40))] {
            let mut side = || {
                let step = Rational::from((i64::try_from(stream.below(5)).unwrap_or(0) - 2, 2));
                step * &width
            };
            let x: Vec<ComplexRational> = centre
                .iter()
                .map(|z| z.add(&ComplexRational::new(side(), side())))
                .collect();
            let around = |part: &Rational| {
                let (lower, upper) = (part.clone() - &width, part.clone() + &width);
                Interval::<R>::between(context, &lower, &upper)
            };
            let boxes: Vec<Complex<Interval<R>>> = centre
                .iter()
                .map(|z| Complex {
                    re: around(&z.re),
                    im: around(&z.im),
                })
                .collect();
            let (ps, dps) = (round(context, &p), round(context, &dp));
            let mut out = Matrix::zeros(context, rows, n + 2);
            evaluator.linearize(&boxes, &ps, &dps, &mut out, &mut scratch);
            let mut values = vec![Complex::zero(context); rows];
            evaluator.value(&boxes, &ps, &mut values, &mut scratch);
            let inside = |what: &str, enclosure: &Complex<Interval<R>>, exact: &ComplexRational| {
                assert!(
                    enclosure.re.contains(&exact.re) && enclosure.im.contains(&exact.im),
                    "{}: {what} {exact:?} is not in {enclosure:?}",
                    case.name
                );
            };
            let still = |count| vec![ComplexRational::default(); count];
            for v in 0..n {
                let mut direction = still(n);
                direction[v] = ComplexRational::real(1);
                let along = exact_along(&case, [&x, &p], [&direction, &still(m)]);
                for (row, (_, slope)) in along.iter().enumerate() {
                    inside("derivative", out.at(row, v), slope);
                }
            }
            let along = exact_along(&case, [&x, &p], [&still(n), &dp]);
            for (row, (value, slope)) in along.iter().enumerate() {
                inside("value", out.at(row, n), value);
                inside("value by its own program", &values[row], value);
                inside("derivative along the parameters", out.at(row, n + 1), slope);
            }
        }
    }
}

/// All derivatives against central differences of the values at 600 bits.
///
/// # Panics
/// When they differ by more than the differences' own error.
pub fn check_by_differences<E: Evaluate<MultiplePrecision>>(compile: Compile<E>) {
    const BITS: u32 = 600;
    for case in cases() {
        let evaluator = case.compile(compile);
        let mut scratch = evaluator.scratch(BITS);
        let (n, m, rows) = (case.variables, case.parameters, case.equations.len());
        let mut stream = RandomStream::new(12, Purpose::Test, 0);
        let x = round(BITS, &rational_point(n, &mut stream));
        let p = round(BITS, &rational_point(m, &mut stream));
        let dp = round(BITS, &rational_point(m, &mut stream));
        let mut out = Matrix::zeros(BITS, rows, n + 2);
        evaluator.linearize(&x, &p, &dp, &mut out, &mut scratch);
        let step = MultiplePrecision(rug::Float::with_val(BITS, 1) >> 150u32);
        let moved = |from: &[Complex<MultiplePrecision>],
                     by: &[Complex<MultiplePrecision>],
                     backwards: bool| {
            let mut to = from.to_vec();
            for (to, by) in to.iter_mut().zip(by) {
                let mut by = by.clone();
                by.scale(&step);
                if backwards {
                    by.neg();
                }
                to.add(&by);
            }
            to
        };
        for column in (0..n).chain([n + 1]) {
            let mut dx = vec![Complex::zero(BITS); n];
            let mut change = vec![Complex::zero(BITS); m];
            if column < n {
                dx[column] = Complex::from_f64(BITS, 1.0, 0.0);
            } else {
                change.clone_from(&dp);
            }
            let mut ends = [false, true].map(|backwards| {
                let mut values = vec![Complex::zero(BITS); rows];
                let (x, p) = (moved(&x, &dx, backwards), moved(&p, &change, backwards));
                evaluator.value(&x, &p, &mut values, &mut scratch);
                values
            });
            let [forwards, backwards] = &mut ends;
            for (row, (slope, back)) in forwards.iter_mut().zip(backwards).enumerate() {
                slope.sub(back);
                slope.re.div(&step);
                slope.im.div(&step);
                slope.scale(&MultiplePrecision::from_f64(BITS, 0.5));
                let what = format!("derivative ({row}, {column})");
                assert_close(&case.name, &what, out.at(row, column), slope, 120);
            }
        }
    }
}

/// A random point in every lane.
fn lane_point<R: Real>(context: R::Context, count: usize, index: u64) -> Vec<Complex<R>> {
    (0..count)
        .map(|coordinate| {
            let mut z = Complex::zero(context);
            for lane in 0..R::WIDTH {
                let key = index * 1000 + coordinate as u64;
                let mut stream = RandomStream::new(lane as u64, Purpose::Test, key);
                z.set_lane(lane, stream.disc());
            }
            z
        })
        .collect()
}

/// Same number, or both not a number: in every lane, at full precision.
fn same<R: Real>(a: &R, b: &R) -> bool {
    let (below, above) = (a.less_equal(b), b.less_equal(a));
    (0..R::WIDTH).all(|lane| {
        use cognate_numeric::scalar::Mask;
        let bits = (a.lane(lane).to_bits(), b.lane(lane).to_bits());
        bits.0 == bits.1 && (a.lane(lane).is_nan() || (below.lane(lane) && above.lane(lane)))
    })
}

fn assert_same<R: Real>(name: &str, a: &[Complex<R>], b: &[Complex<R>]) {
    assert_eq!(a.len(), b.len());
    for (entry, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(
            same(&a.re, &b.re) && same(&a.im, &b.im),
            "{name}: entry {entry} is {a:?}, but the reference says {b:?}"
        );
    }
}

/// An evaluator at one point. Each of its calls is a job of its own: the compiler takes several times as long for all of
/// them in one function.
struct Calls<'a, R: Real, E: Evaluate<R>> {
    evaluator: &'a E,
    scratch: &'a mut E::Scratch,
    x: Vec<Complex<R>>,
    p: Vec<Complex<R>>,
    dp: Vec<Complex<R>>,
}

struct Linearize<'c, 'a, R: Real, E: Evaluate<R>>(&'c mut Calls<'a, R, E>, &'c mut Matrix<R>);

impl<R: Real, E: Evaluate<R>> Job for Linearize<'_, '_, R, E> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(calls, out) = self;
        calls
            .evaluator
            .linearize(&calls.x, &calls.p, &calls.dp, out, calls.scratch);
    }
}

struct JacobianAlone<'c, 'a, R: Real, E: Evaluate<R>>(&'c mut Calls<'a, R, E>, &'c mut Matrix<R>);

impl<R: Real, E: Evaluate<R>> Job for JacobianAlone<'_, '_, R, E> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(calls, out) = self;
        calls
            .evaluator
            .jacobian(&calls.x, &calls.p, out, calls.scratch);
    }
}

struct ValueAlone<'c, 'a, R: Real, E: Evaluate<R>>(&'c mut Calls<'a, R, E>, &'c mut [Complex<R>]);

impl<R: Real, E: Evaluate<R>> Job for ValueAlone<'_, '_, R, E> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(calls, out) = self;
        calls
            .evaluator
            .value(&calls.x, &calls.p, out, calls.scratch);
    }
}

/// [J | H | H_t], and then H and [J | H] as calls of their own give them, on one instruction set.
fn both<R: Real, E: Evaluate<R>>(
    case: &Case,
    evaluator: &E,
    context: R::Context,
    set: InstructionSet,
) -> (Vec<Complex<R>>, Vec<Complex<R>>) {
    let (n, m, rows) = (case.variables, case.parameters, case.equations.len());
    let mut scratch = evaluator.scratch(context);
    let mut out = Matrix::zeros(context, rows, n + 2);
    let mut alone = Matrix::zeros(context, rows, n + 2);
    let mut values = vec![Complex::zero(context); rows];
    // The first point must leave no trace in what the second one gives.
    for index in [1, 2] {
        let mut calls = Calls {
            evaluator,
            scratch: &mut scratch,
            x: lane_point::<R>(context, n, 3 * index),
            p: lane_point::<R>(context, m, 3 * index + 1),
            dp: lane_point::<R>(context, m, 3 * index + 2),
        };
        dispatch_on(set, Linearize(&mut calls, &mut out));
        dispatch_on(set, JacobianAlone(&mut calls, &mut alone));
        dispatch_on(set, ValueAlone(&mut calls, &mut values));
    }
    values.extend(alone.entries);
    (out.entries, values)
}

/// The naive reference, bit for bit.
///
/// # Panics
/// When a bit of a value or derivative differs.
pub fn check_against_reference<R: Real, E: Evaluate<R>>(compile: Compile<E>, context: R::Context) {
    for case in cases() {
        let evaluator = case.compile(compile);
        let reference = case.compile(Reference::compile as Compile<Reference>);
        let set = InstructionSet::detect();
        let computed = both::<R, E>(&case, &evaluator, context, set);
        let expected = both::<R, Reference>(&case, &reference, context, InstructionSet::Software);
        assert_same(&case.name, &computed.0, &expected.0);
        assert_same(&case.name, &computed.1, &expected.1);
    }
}

/// Every lane on every instruction set gives the bits of `Lanes<16>` on plain code.
///
/// # Panics
/// When a bit of a value or derivative differs.
pub fn check_width<R, E>(compile: Compile<E>)
where
    R: Real<Context = ()>,
    E: Evaluate<R> + Evaluate<Lanes<16>>,
{
    let bits = |z: num_complex::Complex64| (z.re.to_bits(), z.im.to_bits());
    for case in cases() {
        let evaluator = case.compile(compile);
        let plain = both::<Lanes<16>, E>(&case, &evaluator, (), InstructionSet::Software);
        for set in [
            InstructionSet::Avx512,
            InstructionSet::Avx2,
            InstructionSet::Neon,
            InstructionSet::Software,
        ] {
            let lanes = both::<R, E>(&case, &evaluator, (), set);
            for (a, b) in [(&lanes.0, &plain.0), (&lanes.1, &plain.1)] {
                for (entry, (a, b)) in a.iter().zip(b).enumerate() {
                    for lane in 0..R::WIDTH {
                        assert_eq!(
                            bits(a.lane(lane)),
                            bits(b.lane(lane)),
                            "{}: entry {entry}, lane {lane} of {} on {}",
                            case.name,
                            R::WIDTH,
                            set.name()
                        );
                    }
                }
            }
        }
    }
}

/// Runs the conformance suite of evaluators: a module of tests for what
/// `compile(&Expressions, &[NodeId], variables, parameters)` makes.
#[macro_export]
macro_rules! evaluator_conformance {
    ($module:ident, $compile:expr) => {
        mod $module {
            use cognate_numeric::lanes::Lanes;
            use cognate_numeric::scalar::{DoubleDouble, MultiplePrecision};
            use $crate::evaluation::conformance as suite;

            #[test]
            fn agrees_with_exact_arithmetic() {
                suite::check_exactly($compile);
            }
            #[test]
            fn intervals_enclose_exact_arithmetic() {
                suite::check_enclosures::<f64, _>($compile, ());
                suite::check_enclosures::<MultiplePrecision, _>($compile, 128);
            }
            #[test]
            fn derivatives_agree_with_differences() {
                suite::check_by_differences($compile);
            }
            #[test]
            fn agrees_with_the_reference_bit_for_bit() {
                suite::check_against_reference::<f64, _>($compile, ());
                suite::check_against_reference::<Lanes<8>, _>($compile, ());
                suite::check_against_reference::<DoubleDouble<f64>, _>($compile, ());
                suite::check_against_reference::<MultiplePrecision, _>($compile, 113);
            }
            #[test]
            fn all_widths_give_the_same_bits() {
                suite::check_width::<f64, _>($compile);
                suite::check_width::<Lanes<1>, _>($compile);
                suite::check_width::<Lanes<8>, _>($compile);
                suite::check_width::<Lanes<16>, _>($compile);
            }
        }
    };
}

#[cfg(test)]
mod tests {
    crate::evaluator_conformance!(interpreter, crate::evaluation::Interpreter::compile);
    crate::evaluator_conformance!(reference, crate::evaluation::Reference::compile);
}
