//! Nanoseconds per path of `linearize` and `jacobian`, alone and with the elimination of what they
//! give (`+LU`, 2 and 1 right-hand sides): interpreted and looped, and as machine code.
//!
//! `cargo bench -p cognate-machine-code --bench evaluation [-- SYSTEM]`. All columns of a line are
//! measured in turns within one run, the best of 300 short rounds counts. `int.` is the interpreter
//! at W = 8 and 16, `code` AVX-512 and `AVX2` AVX2 code at these widths; the ratio is the best of
//! the interpreter to the best of the code. KiB and ms: the code's size and the time to make it (of
//! `+LU` the elimination's). The points are random and no row order is preferred, so that many
//! lanes exchange rows.
//!
//! # Figures
//!
//! One core of a shared Zen 4 EPYC at about 3.5 GHz with AVX-512, other work on it (its bound by
//! fused multiply-adds is about 57 Gflop/s):
//!
//! | system | program | flops | int. 8 | int. 16 | code 8 | code 16 | AVX2 8 | ratio | Gflop/s | KiB | ms |
//! |---|---|---|---|---|---|---|---|---|---|---|---|
//! | nine points | linearize | 3264 | 169 | 142 | 60.1 | 60.3 | 71.9 | 2.36 | 54.3 | 15.8 | 0.2 |
//! | | jacobian | 2720 | 142 | 111 | 51.4 | 52.6 | 63.5 | 2.16 | 52.9 | 13.7 | 0.3 |
//! | | linearize+LU | 5592 | 262 | 197 | 110 | 109 | 158 | 1.80 | 51.2 | 13.4 | 0.3 |
//! | | jacobian+LU | 4552 | 231 | 155 | 94.6 | 96.6 | 136 | 1.63 | 48.1 | | |
//! | platform | linearize | 1802 | 106 | 73.6 | 39.4 | 39.5 | 55.1 | 1.87 | 45.8 | 10.3 | 0.3 |
//! | | linearize+LU | 4130 | 196 | 127 | 86.5 | 87.0 | 128 | 1.46 | 47.8 | 13.4 | 0.3 |
//! | katsura-10 | linearize | 872 | 78 | 62.8 | 30.5 | 30.5 | 31.1 | 2.06 | 28.6 | 6.7 | 0.2 |
//! | | linearize+LU | 6240 | 303 | 182 | 131 | 138 | 196 | 1.39 | 47.5 | 30.4 | 0.6 |
//! | cyclic-7 | linearize | 1082 | 57.5 | 53.3 | 20.5 | 20.6 | 24.3 | 2.60 | 52.8 | 6.4 | 0.1 |
//! | | linearize+LU | 2734 | 122 | 92.8 | 55.9 | 54.8 | 87.9 | 1.69 | 49.9 | 9.6 | 0.3 |
//! | noon-10 | linearize | 854 | 66.3 | 50.5 | 19.7 | 20.7 | 19.4 | 2.56 | 43.4 | 6.0 | 0.2 |
//! | | linearize+LU | 5024 | 232 | 144 | 100 | 102 | 154 | 1.43 | 50.1 | 23.4 | 0.5 |
//! | cyclic-14 | linearize | 10,000 | 410 | 393 | 234 | 232 | 318 | 1.69 | 43.1 | 70 | 1.0 |
//! | | linearize+LU | 20,262 | 802 | 706 | 427 | 456 | 620 | 1.66 | 47.5 | 60 | 1.0 |
//!
//! Long code comes from ever further away: cyclic-24, 52,660 operations and 393 KiB, 2078 ns
//! instead of 2203, and its elimination (272 KiB) 1197 instead of 1073, which is why there are
//! limits. katsura-10 is bound by writing its 143 entries, of which most are constants.

#[allow(dead_code, reason = "the bench of the interpreter uses more of it")]
#[path = "../../systems/benches/mechanisms/mod.rs"]
mod mechanisms;

use cognate_machine_code::{Elimination, Evaluator};
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch};
use cognate_numeric::linear_algebra::lu;
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Program};
use cognate_systems::named;
use mechanisms::{Plain, nine_points, platform};
use std::time::Instant;

/// Work that follows each evaluation: none, elimination by the loop of `lu`, or elimination by machine code.
#[derive(Clone, Copy)]
enum Then<'a> {
    Nothing,
    Loop,
    Code(&'a Elimination),
}

struct Evaluations<'a, R: Real, E: Evaluate<R>> {
    evaluator: &'a E,
    program: Program,
    then: Then<'a>,
    exchanges: &'a mut R::Control,
    point: &'a mut [Vec<Complex<R>>; 3],
    out: &'a mut Matrix<R>,
    scratch: &'a mut E::Scratch,
    count: usize,
}

impl<R: Real<Context = ()>, E: Evaluate<R>> Job for Evaluations<'_, R, E> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let [x, p, dp] = self.point;
        for _ in 0..self.count {
            match self.program {
                Program::Linearize => self.evaluator.linearize(x, p, dp, self.out, self.scratch),
                _ => self.evaluator.jacobian(x, p, self.out, self.scratch),
            }
            match (self.then, self.program) {
                (Then::Nothing, _) => {}
                (Then::Loop, Program::Linearize) => {
                    lu::eliminate::<R, 2>(self.out, self.exchanges);
                }
                (Then::Loop, _) => lu::eliminate::<R, 1>(self.out, self.exchanges),
                (Then::Code(code), Program::Linearize) => {
                    code.eliminate::<R, 2>(self.out, self.exchanges);
                }
                (Then::Code(code), _) => code.eliminate::<R, 1>(self.out, self.exchanges),
            }
            // The next point depends on this one, so that no call can be dropped.
            let change = self.out.entries[0].clone();
            x[0].re.mul_add(&change.re, &R::from_f64((), 1e-30));
        }
    }
}

/// One way to evaluate, and the best that was seen of it.
struct Way<'a, R: Real<Context = ()>, E: Evaluate<R>> {
    evaluator: &'a E,
    program: Program,
    then: Then<'a>,
    exchanges: R::Control,
    point: [Vec<Complex<R>>; 3],
    out: Matrix<R>,
    scratch: E::Scratch,
    best: f64,
}

trait Round {
    /// Measures once more.
    fn round(&mut self, flops: usize);
    /// ns a path.
    fn best(&self) -> f64;
}

impl<'a, R: Real<Context = ()>, E: Evaluate<R>> Way<'a, R, E> {
    fn new(evaluator: &'a E, program: Program, then: Then<'a>) -> Self {
        let shape = evaluator.shape();
        let mut stream = RandomStream::new(2, Purpose::Test, 0);
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
        Self {
            evaluator,
            program,
            then,
            exchanges: R::Control::from_f64((), 0.0),
            point: [
                numbers(shape.variables),
                numbers(shape.parameters),
                numbers(shape.parameters),
            ],
            out: Matrix::zeros((), shape.equations, shape.variables + 2),
            scratch: evaluator.scratch(()),
            best: f64::INFINITY,
        }
    }
}

impl<R: Real<Context = ()>, E: Evaluate<R>> Round for Way<'_, R, E> {
    fn round(&mut self, flops: usize) {
        let count = (2_000_000 / flops / R::WIDTH).max(1);
        let start = Instant::now();
        dispatch(Evaluations {
            evaluator: self.evaluator,
            program: self.program,
            then: self.then,
            exchanges: &mut self.exchanges,
            point: &mut self.point,
            out: &mut self.out,
            scratch: &mut self.scratch,
            count,
        });
        let each = start.elapsed().as_secs_f64() * 1e9 / (count * R::WIDTH) as f64;
        self.best = self.best.min(each);
    }

    fn best(&self) -> f64 {
        self.best
    }
}

/// A system with everything that a round of it may run: the interpreter, machine code of both widths, eliminations.
struct CompiledSystem<'a> {
    name: &'a str,
    variables: usize,
    square: bool,
    interpreter: Interpreter,
    code: Evaluator,
    narrow: Evaluator,
    eliminate: Elimination,
    eliminate_narrow: Elimination,
}

/// One line of the table: a program, alone or followed by an elimination.
#[derive(Clone, Copy)]
struct Line {
    program: Program,
    eliminated: bool,
}

/// Size of the code of a line, and the time to make it.
struct CodeCost {
    bytes: usize,
    milliseconds: f64,
}

impl<'a> CompiledSystem<'a> {
    fn compile(name: &'a str, plain: &Plain) -> Self {
        let interpreter = Interpreter::compile(
            &plain.expressions,
            &plain.equations,
            plain.variables,
            plain.parameters,
        );
        let [eliminate, eliminate_narrow] = [InstructionSet::Avx512, InstructionSet::Avx2]
            .map(|set| Elimination::new(plain.variables, set));
        Self {
            name,
            variables: plain.variables,
            square: plain.equations.len() == plain.variables,
            code: Evaluator::new(interpreter.clone(), InstructionSet::Avx512),
            narrow: Evaluator::new(interpreter.clone(), InstructionSet::Avx2),
            interpreter,
            eliminate,
            eliminate_narrow,
        }
    }

    /// Both programs alone; of a square system also with the elimination.
    fn lines(&self) -> Vec<Line> {
        let programs = [Program::Linearize, Program::Jacobian];
        let line = |eliminated| {
            programs.map(|program| Line {
                program,
                eliminated,
            })
        };
        let mut lines = line(false).to_vec();
        if self.square {
            lines.extend(line(true));
        }
        lines
    }

    /// Makes the code of a line, which is made when it is first asked for.
    fn code_cost(&self, line: Line) -> CodeCost {
        let start = Instant::now();
        let bytes = if line.eliminated {
            self.eliminate.code_bytes().unwrap_or(0)
        } else {
            self.code.code_bytes(line.program).unwrap_or(0)
        };
        CodeCost {
            bytes,
            milliseconds: start.elapsed().as_secs_f64() * 1e3,
        }
    }

    /// Real operations of one path.
    fn flops(&self, line: Line) -> usize {
        let evaluation: usize = self
            .interpreter
            .assignments(line.program)
            .iter()
            .map(|a| a.operation.flops())
            .sum();
        if !line.eliminated {
            return evaluation;
        }
        let rhs = match line.program {
            Program::Linearize => 2,
            _ => 1,
        };
        evaluation + lu::flops(self.variables as u64, rhs) as usize
    }

    /// The six columns of a line: interpreter, AVX-512 and AVX2 code, each in 8 and 16 lanes.
    fn ways(&self, line: Line) -> Vec<Box<dyn Round + '_>> {
        let [looped, coded, narrowly] = if line.eliminated {
            [
                Then::Loop,
                Then::Code(&self.eliminate),
                Then::Code(&self.eliminate_narrow),
            ]
        } else {
            [Then::Nothing; 3]
        };
        let program = line.program;
        let (interpreter, code, narrow) = (&self.interpreter, &self.code, &self.narrow);
        vec![
            Box::new(Way::<Lanes<8>, _>::new(interpreter, program, looped)),
            Box::new(Way::<Lanes<16>, _>::new(interpreter, program, looped)),
            Box::new(Way::<Lanes<8>, _>::new(code, program, coded)),
            Box::new(Way::<Lanes<16>, _>::new(code, program, coded)),
            Box::new(Way::<Lanes<8>, _>::new(narrow, program, narrowly)),
            Box::new(Way::<Lanes<16>, _>::new(narrow, program, narrowly)),
        ]
    }

    /// Measures a line in turns and prints it.
    fn measure(&self, line: Line) {
        let cost = self.code_cost(line);
        let flops = self.flops(line);
        let mut ways = self.ways(line);
        for _ in 0..300 {
            for way in &mut ways {
                way.round(flops);
            }
        }
        let best: Vec<f64> = ways.iter().map(|way| way.best()).collect();
        let program_name = format!("{:?}", line.program).to_lowercase();
        println!(
            "{:<12} {:<11} {:>6} | {:>8.1} {:>8.1} | {:>8.1} {:>8.1} {:>8.1} {:>8.1} | {:>6.2} {:>8.1} {:>6.1} {:>6.2}",
            self.name,
            if line.eliminated {
                format!("{program_name}+LU")
            } else {
                program_name
            },
            flops,
            best[0],
            best[1],
            best[2],
            best[3],
            best[4],
            best[5],
            best[0].min(best[1]) / best[2].min(best[3]),
            flops as f64 / best[2].min(best[3]),
            cost.bytes as f64 / 1024.0,
            cost.milliseconds,
        );
    }
}

/// The instruction set and the names of the columns.
fn print_heading() {
    println!("instruction set: {}", InstructionSet::detect().name());
    println!(
        "{:<12} {:<11} {:>6} | {:>8} {:>8} | {:>8} {:>8} {:>8} {:>8} | {:>6} {:>8} {:>6} {:>6}",
        "system",
        "program",
        "flops",
        "int. 8",
        "int. 16",
        "code 8",
        "code 16",
        "AVX2 8",
        "AVX2 16",
        "ratio",
        "Gflop/s",
        "KiB",
        "ms"
    );
}

/// The systems of the table, by name.
fn systems() -> Vec<(&'static str, Plain)> {
    let from_named = |n: named::Named| Plain {
        variables: n.system.variable_count(),
        parameters: n.system.parameters.len(),
        expressions: n.system.expressions,
        equations: n.system.equations,
    };
    vec![
        ("nine-point", nine_points()),
        ("platform", platform()),
        ("katsura-10", from_named(named::katsura(10))),
        ("cyclic-7", from_named(named::cyclic(7))),
        ("noon-10", from_named(named::noon(10))),
        ("cyclic-14", from_named(named::cyclic(14))),
        ("cyclic-24", from_named(named::cyclic(24))),
    ]
}

fn main() {
    print_heading();
    let only = std::env::args().nth(1).filter(|a| !a.starts_with("--"));
    for (name, plain) in systems() {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let system = CompiledSystem::compile(name, &plain);
        for line in system.lines() {
            system.measure(line);
        }
    }
}
