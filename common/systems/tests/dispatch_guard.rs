//! The dispatch guard: sixteen paths in lanes cost at most 1/2.5 of sixteen paths one by one.
//!
//! When a function between `dispatch` and the arithmetic is not inlined, it is
//! compiled without the instruction set, and all is 17 to 20 times slower,
//! silently. Both widths are measured in this one run, in turns, and the best
//! of many counts, so a loaded machine does not change the ratio much.

#[path = "../benches/mechanisms/mod.rs"]
mod mechanisms;

use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::random::{Purpose, RandomStream};
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Scratch};
use std::time::Instant;

struct Paths<R: Real> {
    interpreter: Interpreter,
    x: Vec<Complex<R>>,
    p: Vec<Complex<R>>,
    out: Matrix<R>,
    scratch: Scratch<R>,
}

struct Round<'a, R: Real>(&'a mut Paths<R>, usize);

impl<R: Real> Job for Round<'_, R> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let paths = self.0;
        for _ in 0..self.1 {
            paths.interpreter.linearize(
                &paths.x,
                &paths.p,
                &paths.p,
                &mut paths.out,
                &mut paths.scratch,
            );
        }
    }
}

impl<R: Real<Context = ()>> Paths<R> {
    fn new(interpreter: &Interpreter) -> Self {
        let shape = interpreter.shape();
        let mut stream = RandomStream::new(5, Purpose::Test, 0);
        let mut point = |count: usize| -> Vec<Complex<R>> {
            let mut points = vec![Complex::zero(()); count];
            for z in &mut points {
                for lane in 0..R::WIDTH {
                    z.set_lane(lane, stream.disc());
                }
            }
            points
        };
        Self {
            x: point(shape.variables),
            p: point(shape.parameters),
            out: Matrix::zeros((), shape.equations, shape.variables + 2),
            scratch: interpreter.scratch(()),
            interpreter: interpreter.clone(),
        }
    }

    /// Seconds per path, once.
    fn seconds(&mut self, count: usize) -> f64 {
        let start = Instant::now();
        dispatch(Round(self, count));
        start.elapsed().as_secs_f64() / (count * R::WIDTH) as f64
    }
}

#[test]
fn sixteen_lanes_are_at_least_two_and_a_half_times_faster() {
    // The verdict of this test is a ratio of times, which a loaded machine may change: `tests/run.sh long` runs it.
    if std::env::var_os("COGNATE_LONG").is_none() {
        eprintln!("not measured: COGNATE_LONG is not set");
        return;
    }
    if cfg!(debug_assertions) || InstructionSet::detect() == InstructionSet::Software {
        eprintln!("not measured: needs a release build and fused multiply-add");
        return;
    }
    for (name, plain) in [
        ("nine points", mechanisms::nine_points()),
        (
            "platform",
            mechanisms::straight_line(mechanisms::platform()),
        ),
    ] {
        check(name, &plain);
    }
}

fn check(name: &str, plain: &mechanisms::Plain) {
    let interpreter = Interpreter::compile(
        &plain.expressions,
        &plain.equations,
        plain.variables,
        plain.parameters,
    );
    let mut single = Paths::<f64>::new(&interpreter);
    let mut lanes = Paths::<Lanes<16>>::new(&interpreter);
    let (mut one, mut sixteen) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..200 {
        one = one.min(single.seconds(400));
        sixteen = sixteen.min(lanes.seconds(100));
    }
    let ratio = one / sixteen;
    eprintln!(
        "{name}: W = 1: {:.0} ns a path, W = 16: {:.0} ns, {ratio:.1} times faster",
        one * 1e9,
        sixteen * 1e9
    );
    assert!(
        ratio >= 2.5,
        "{name}: W = 16 is only {ratio:.2} times faster than W = 1: is everything below `dispatch` inlined?"
    );
}
