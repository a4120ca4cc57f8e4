//! The bits of machine code are those of the interpreter: the suite of all evaluators, and random
//! programs that need more registers than there are.

use cognate_machine_code::Evaluator;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::InstructionSet;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::rational::{ComplexRational, Rational};
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::conformance::{check_against_reference, check_width};
use cognate_systems::evaluation::{Evaluate, Interpreter, Program};
use cognate_systems::expression::{Expressions, NodeId};

fn compile_for(
    set: InstructionSet,
    expressions: &Expressions,
    equations: &[NodeId],
    variables: usize,
    parameters: usize,
) -> Evaluator {
    let interpreter = Interpreter::compile(expressions, equations, variables, parameters);
    Evaluator::new(interpreter, set)
}

fn best(e: &Expressions, equations: &[NodeId], n: usize, m: usize) -> Evaluator {
    compile_for(InstructionSet::detect(), e, equations, n, m)
}

fn avx2(e: &Expressions, equations: &[NodeId], n: usize, m: usize) -> Evaluator {
    compile_for(InstructionSet::Avx2, e, equations, n, m)
}

/// Runs the suite for lanes only; other numbers are interpreted, and the interpreter's own tests check them.
#[test]
fn the_suite_of_evaluators_passes() {
    for compile in [best, avx2] {
        check_against_reference::<Lanes<8>, _>(compile, ());
        check_width::<Lanes<8>, _>(compile);
        check_width::<Lanes<16>, _>(compile);
    }
}

/// Sizes of a random system: variables, parameters, equations, operations.
type Sizes = (u32, u32, usize, usize);

/// Few operations below each other, many values that are needed again much later.
fn random_system(
    seed: u64,
    (variables, parameters, equations, operations): Sizes,
) -> (Expressions, Vec<NodeId>) {
    let mut stream = RandomStream::new(seed, Purpose::Test, 21);
    let mut e = Expressions::new();
    let mut nodes: Vec<NodeId> = (0..variables).map(|v| e.variable(v)).collect();
    let inputs: Vec<NodeId> = (0..parameters).map(|p| e.parameter(p)).collect();
    nodes.extend(&inputs);
    for k in 0..6 {
        let (re, im) = (
            stream.below(15) as i64 - 7,
            (k % 2) * (stream.below(9) as i64 - 4),
        );
        nodes.push(e.constant(ComplexRational::new(
            Rational::from((re, 1)),
            Rational::from((im, 1)),
        )));
    }
    let mut degree = vec![1; nodes.len()];
    while nodes.len() < operations {
        let (i, j) = (
            stream.below(nodes.len() as u64) as usize,
            stream.below(nodes.len() as u64) as usize,
        );
        let (a, b) = (nodes[i], nodes[j]);
        let (node, d) = match stream.below(10) {
            0..=2 => (e.add(a, b), degree[i].max(degree[j])),
            3 | 4 => (e.subtract(a, b), degree[i].max(degree[j])),
            5..=7 => (e.multiply(a, b), degree[i] + degree[j]),
            8 => (e.power(a, 2), 2 * degree[i]),
            _ => {
                let p = inputs[stream.below(inputs.len() as u64) as usize];
                (e.divide(a, p), degree[i] + 1)
            }
        };
        if d <= 5 {
            nodes.push(node);
            degree.push(d);
        }
    }
    let mut wanted = Vec::new();
    for _ in 0..equations {
        // Sums of many terms, with either sign first.
        let mut pick = || nodes[stream.below(nodes.len() as u64) as usize];
        let mut sum = e.multiply(pick(), pick());
        if wanted.len() % 2 == 1 {
            sum = e.negate(sum);
        }
        for k in 0..8 {
            let term = e.multiply(pick(), pick());
            sum = if k % 3 == 1 {
                e.subtract(sum, term)
            } else {
                e.add(sum, term)
            };
        }
        wanted.push(sum);
    }
    (e, wanted)
}

/// All results at a point. Not dispatched: machine code needs none, the interpreter gives the same
/// bits without, and here it need not be fast.
fn all_outputs<R: Real<Context = ()>, E: Evaluate<R>>(
    evaluator: &E,
    [x, p, dp]: &[Vec<Complex<R>>; 3],
) -> Vec<Complex<R>> {
    let shape = evaluator.shape();
    let mut scratch = evaluator.scratch(());
    let mut out = Matrix::zeros((), shape.equations, shape.variables + 2);
    evaluator.linearize(x, p, dp, &mut out, &mut scratch);
    let mut outputs = out.entries.clone();
    // The last column is to stay as it is.
    for entry in &mut out.entries {
        entry.re = R::from_f64((), 7.0);
    }
    evaluator.jacobian(x, p, &mut out, &mut scratch);
    outputs.extend(out.entries);
    let mut values = vec![Complex::zero(()); shape.equations];
    evaluator.value(x, p, &mut values, &mut scratch);
    outputs.extend(values);
    outputs
}

/// Bits of every lane; one pattern for everything that is not a number.
fn bits<R: Real>(numbers: &[Complex<R>]) -> Vec<u64> {
    numbers
        .iter()
        .flat_map(|z| (0..R::WIDTH).flat_map(|lane| [z.re.lane(lane), z.im.lane(lane)]))
        .map(|x| {
            if x.is_nan() {
                f64::NAN.to_bits()
            } else {
                x.to_bits()
            }
        })
        .collect()
}

fn compare<R: Real<Context = ()>>(interpreter: &Interpreter, seed: u64) {
    let shape = interpreter.shape();
    let mut stream = RandomStream::new(seed, Purpose::Test, 22);
    let mut numbers = |count: usize| -> Vec<Complex<R>> {
        let mut number = || {
            let mut z = Complex::zero(());
            for lane in 0..R::WIDTH {
                z.set_lane(lane, stream.disc());
            }
            z
        };
        (0..count).map(|_| number()).collect()
    };
    let mut point = [
        numbers(shape.variables),
        numbers(shape.parameters),
        numbers(shape.parameters),
    ];
    // Zeros of both signs: a change of sign at the wrong place shows here.
    point[0][0].re.set_lane(1, 0.0);
    point[0][0].im.set_lane(2, -0.0);
    point[0][1] = point[0][0].clone();
    let expected = bits(&all_outputs(interpreter, &point));
    for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
        let evaluator = Evaluator::new(interpreter.clone(), set);
        let compiled = bits(&all_outputs(&evaluator, &point));
        assert!(
            expected == compiled,
            "seed {seed}, {} at width {}",
            set.name(),
            R::WIDTH
        );
    }
}

#[test]
fn random_programs_agree_with_the_interpreter_bit_for_bit() {
    for seed in 0..40 {
        let sizes = match seed % 4 {
            0 => (2, 1, 2, 12),
            1 => (5, 3, 5, 60),
            2 => (9, 20, 9, 200),
            _ => (14, 6, 14, 400),
        };
        let (e, equations) = random_system(seed, sizes);
        let interpreter = Interpreter::compile(&e, &equations, sizes.0 as usize, sizes.1 as usize);
        compare::<Lanes<8>>(&interpreter, seed);
        compare::<Lanes<16>>(&interpreter, seed);
    }
}

#[test]
fn there_is_code_where_the_machine_has_the_instructions() {
    let (e, equations) = random_system(1, (5, 3, 5, 60));
    let linux = cfg!(all(target_arch = "x86_64", target_os = "linux"));
    let best = InstructionSet::detect();
    for set in [
        InstructionSet::Avx512,
        InstructionSet::Avx2,
        InstructionSet::Software,
    ] {
        let has = match set {
            InstructionSet::Avx512 => best == set,
            InstructionSet::Avx2 => best == set || best == InstructionSet::Avx512,
            _ => false,
        };
        let evaluator = compile_for(set, &e, &equations, 5, 3);
        for program in [Program::Linearize, Program::Jacobian, Program::Value] {
            let bytes = evaluator.code_bytes(program);
            assert_eq!(
                bytes.is_some_and(|bytes| bytes > 100),
                linux && has,
                "{}",
                set.name()
            );
        }
    }
}
