//! Nanoseconds per path of one `linearize` ([J | H | H_t]), by system and width.
//!
//! `cargo bench -p cognate-systems --bench evaluation`; with `-- --schedules` for
//! several ways to form runs, with `-- --operations` for the instructions. The best
//! of 400 short rounds counts, so a loaded machine disturbs little. Columns: window
//! and longest run of the schedule; instructions, real operations, temporaries, runs
//! and scratch space of the program for lanes; ns a path for `f64`, `Lanes<1>` (whose
//! numbers fill a cache line each), `Lanes<8>`, `Lanes<16>`; Gflop/s at W = 16;
//! milliseconds to compile.
//!
//! # Figures
//!
//! One core of a shared Zen 4 EPYC at about 3.5 GHz with AVX-512, other work on it;
//! they repeat to about 5 %.
//!
//! | system | instructions | flops | f64 | W = 8 | W = 16 | Gflop/s |
//! |---|---|---|---|---|---|---|
//! | nine points, 8 x 8, 16 parameters | 328 | 3264 | 740 | 171 | 138 | 23.6 |
//! | platform: 6 leg quadrics, Study, patch | 106 | 1802 | 593 | 94 | 81 | 22.4 |
//! | platform as p F + q G | 144 | 2218 | 735 | 119 | 99 | 22.5 |
//! | katsura-10 | 191 | 872 | 421 | 91 | 62 | 14.0 |
//! | cyclic-7 | 107 | 1082 | 314 | 58 | 46 | 23.4 |
//! | noon-10 | 157 | 854 | 393 | 70 | 55 | 15.5 |
//!
//! Effect of runs of equal operations (nine points; every run costs a jump that is often mispredicted; a longer window
//! keeps more values alive):
//!
//! | window / longest run | runs | temporaries | f64 | W = 8 | W = 16 |
//! |---|---|---|---|---|---|
//! | 1 / 1: one dispatch for each instruction | 328 | 23 | 1845 | 284 | 189 |
//! | 16 / 16 | 161 | 29 | 1298 | 237 | 156 |
//! | 64 / 16 | 80 | 44 | 958 | 181 | 144-150 |
//! | 96 / 16 (lanes) | 64 | 62 | 921 | 171 | 138 |
//! | 128 / 16 | 68 | 78 | 915 | 177 | 141 |
//! | 1000 / 64 (about that for `f64`) | 21 | 148 | 730 | 162 | 146 |
//!
//! Effect of one instruction for a whole sum. With at most two terms in an instruction, and constants filled into all
//! lanes, the platform takes 495 instructions, 60 KiB of scratch space and 123-142 ns at W = 16, instead of 106, 14 KiB
//! and 81 ns; cyclic-7 takes 54-59 ns instead of 46; nine points, katsura and noon do not change.
//!
//! Limits of speed at W = 16: reading operands and writing results through the first-level cache (eight loads and four
//! stores of 64 bytes take 2.7 ns here, eight fused multiply-adds 2.2), and the size of this cache, 32 KiB: an 8 x 10
//! result alone has 20. Fewer multiplications that cost more reads do not pay.

mod mechanisms;

use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter};
use cognate_systems::named;
use cognate_systems::straight_line_program::schedule::Scheduling;
use mechanisms::{Plain, nine_points, platform, straight_line};
use std::time::Instant;

struct Evaluations<'a, R: Real> {
    interpreter: &'a Interpreter,
    x: Vec<Complex<R>>,
    p: Vec<Complex<R>>,
    dp: Vec<Complex<R>>,
    out: &'a mut Matrix<R>,
    scratch: &'a mut <Interpreter as Evaluate<R>>::Scratch,
    count: usize,
}

impl<R: Real<Context = ()>> Job for Evaluations<'_, R> {
    type Output = ();
    #[inline(always)]
    fn run(mut self) {
        for _ in 0..self.count {
            self.interpreter
                .linearize(&self.x, &self.p, &self.dp, self.out, self.scratch);
            // The next point depends on this one, so that no call can be dropped.
            let change = self.out.entries[0].clone();
            self.x[0].re.mul_add(&change.re, &R::from_f64((), 1e-30));
        }
    }
}

fn measure<R: Real<Context = ()>>(interpreter: &Interpreter) -> f64 {
    let shape = interpreter.shape();
    let mut stream = RandomStream::new(2, Purpose::Test, 0);
    let mut point = |count: usize| -> Vec<Complex<R>> {
        (0..count)
            .map(|_| {
                let mut z = Complex::zero(());
                for lane in 0..R::WIDTH {
                    z.set_lane(lane, stream.disc());
                }
                z
            })
            .collect()
    };
    let (x, p, dp) = (
        point(shape.variables),
        point(shape.parameters),
        point(shape.parameters),
    );
    let mut out = Matrix::zeros((), shape.equations, shape.variables + 2);
    let mut scratch = interpreter.scratch(());
    let count = (4_000_000 / interpreter.flops() / R::WIDTH).max(1);
    let mut best = f64::INFINITY;
    for _ in 0..400 {
        let job = Evaluations {
            interpreter,
            x: x.clone(),
            p: p.clone(),
            dp: dp.clone(),
            out: &mut out,
            scratch: &mut scratch,
            count,
        };
        let start = Instant::now();
        dispatch(job);
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e9 / (count * R::WIDTH) as f64
}

fn main() {
    println!("instruction set: {}", InstructionSet::detect().name());
    println!(
        "{:<12} {:>7} {:>5} {:>6} {:>5} {:>5} {:>6} | {:>8} {:>8} {:>8} {:>8} | {:>8} {:>8}",
        "system",
        "window",
        "instr",
        "flops",
        "slots",
        "runs",
        "KiB/16",
        "f64",
        "W=1",
        "W=8",
        "W=16",
        "Gflop/s",
        "ms"
    );
    let from_named = |n: named::Named| Plain {
        variables: n.system.variable_count(),
        parameters: n.system.parameters.len(),
        expressions: n.system.expressions,
        equations: n.system.equations,
    };
    let systems = [
        ("nine-point", nine_points()),
        ("platform", platform()),
        ("platform, t", straight_line(platform())),
        ("katsura-10", from_named(named::katsura(10))),
        ("cyclic-7", from_named(named::cyclic(7))),
        ("noon-10", from_named(named::noon(10))),
    ];
    let asked = |flag: &str| std::env::args().any(|a| a == flag);
    let schedules = if asked("--schedules") {
        let pairs = [
            (1, 1),
            (16, 16),
            (32, 16),
            (48, 16),
            (64, 4),
            (64, 8),
            (64, 16),
            (96, 16),
            (128, 16),
            (256, 16),
            (1000, 64),
        ];
        pairs
            .map(|(window, longest_run)| Scheduling {
                window,
                longest_run,
            })
            .into()
    } else {
        vec![Scheduling::default()]
    };
    for (name, plain) in &systems {
        for &scheduling in &schedules {
            line(name, plain, scheduling, asked("--operations"));
        }
    }
}

fn line(name: &str, plain: &Plain, scheduling: Scheduling, operations: bool) {
    let start = Instant::now();
    let interpreter = Interpreter::compile_with(
        &plain.expressions,
        &plain.equations,
        plain.variables,
        plain.parameters,
        scheduling,
    );
    let compiling = start.elapsed().as_secs_f64() * 1e3;
    let program = interpreter.linearize_program();
    let times = [
        measure::<f64>(&interpreter),
        measure::<Lanes<1>>(&interpreter),
        measure::<Lanes<8>>(&interpreter),
        measure::<Lanes<16>>(&interpreter),
    ];
    println!(
        "{:<12} {:>4}/{:<2} {:>5} {:>6} {:>5} {:>5} {:>6.1} | {:>8.1} {:>8.1} {:>8.1} {:>8.1} | {:>8.2} {:>8.1}",
        name,
        scheduling.window,
        scheduling.longest_run,
        program.instruction_count(),
        program.flops(),
        program.temporaries(),
        program.runs().len(),
        interpreter.scratch_bytes::<Lanes<16>>() as f64 / 1024.0,
        times[0],
        times[1],
        times[2],
        times[3],
        interpreter.flops() as f64 / times[3],
        compiling,
    );
    if operations {
        let mut counts = std::collections::BTreeMap::new();
        for run in program.runs() {
            let entry = counts.entry(run.operation).or_insert((0, 0));
            *entry = (entry.0 + run.length, entry.1 + 1);
        }
        for (operation, (instructions, runs)) in counts {
            println!("    {instructions:>4} in {runs:>3} runs: {operation:?}");
        }
    }
}
