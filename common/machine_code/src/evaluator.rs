//! Evaluator: a compiled system, as machine code where that can be run, else interpreted.
//!
//! Both give the same bits, so that it does not matter to any result which one it is. Code is
//! made for 8 and 16 lanes, for each program when it is first used.

use crate::encoder::VectorSet;
use crate::executable::{Arrays, Executable, as_lanes, as_lanes_mut, vector_set};
use crate::lower::{Constants, lower};
use crate::registers::assemble;
use cognate_numeric::lanes::Lanes;
use cognate_numeric::lanes::dispatch::{InstructionSet, Job, dispatch_baseline};
use cognate_numeric::linear_algebra::matrix::Matrix;
use cognate_numeric::scalar::{Complex, Real};
use cognate_systems::evaluation::{Evaluate, Interpreter, Program, Shape};
use std::sync::{Arc, OnceLock};

/// Systems with more real operations than this are interpreted. Code of about five bytes for each
/// is used once and comes from ever further away: 10,000 operations are 1.7 times as fast as
/// interpreted, 50,000 as fast.
const MOST_FLOPS: usize = 50_000;

/// A compiled system. Cloning shares the code.
#[derive(Clone, Debug)]
pub struct Evaluator {
    interpreter: Interpreter,
    code: Option<Arc<Code>>,
}

#[derive(Debug)]
struct Code {
    set: VectorSet,
    eight: Programs<8>,
    sixteen: Programs<16>,
}

/// Code for one width, made when it is first used; `None` within where this was refused.
#[derive(Debug, Default)]
struct Programs<const W: usize>([OnceLock<Option<Executable<W>>>; 3]);

impl<const W: usize> Programs<W> {
    /// The code of a program.
    #[inline(always)]
    fn get(
        &self,
        program: Program,
        interpreter: &Interpreter,
        set: VectorSet,
    ) -> Option<&Executable<W>> {
        let cell = &self.0[program as usize];
        match cell.get() {
            Some(code) => code.as_ref(),
            None => Self::make(cell, program, interpreter, set),
        }
    }

    #[cold]
    fn make<'a>(
        cell: &'a OnceLock<Option<Executable<W>>>,
        program: Program,
        interpreter: &Interpreter,
        set: VectorSet,
    ) -> Option<&'a Executable<W>> {
        cell.get_or_init(|| {
            let [full, single] = interpreter.constants();
            let constants = Constants { full, single };
            let routine = lower(&interpreter.assignments(program), &constants);
            let assembled = assemble(&routine, set, W);
            Executable::new(assembled, routine.constants, set)
        })
        .as_ref()
    }
}

/// Work space of an [`Evaluator`].
#[derive(Debug)]
pub struct Scratch<R: Real> {
    interpreter: <Interpreter as Evaluate<R>>::Scratch,
    spills: Vec<Lanes<8>>,
}

impl Evaluator {
    /// Machine code for this instruction set, if this machine has it and allows code to be made;
    /// else it interprets.
    pub fn new(interpreter: Interpreter, instruction_set: InstructionSet) -> Self {
        let flops = |program| -> usize {
            let assignments = interpreter.assignments(program);
            assignments.iter().map(|a| a.operation.flops()).sum()
        };
        let code = vector_set(instruction_set)
            .filter(|_| flops(Program::Linearize) <= MOST_FLOPS)
            .map(|set| {
                Arc::new(Code {
                    set,
                    eight: Programs::default(),
                    sixteen: Programs::default(),
                })
            });
        Self { interpreter, code }
    }

    /// The interpreter of the same program.
    pub fn interpreter(&self) -> &Interpreter {
        &self.interpreter
    }

    /// Bytes of machine code of a program for 8 lanes, which is made if need be; `None` where it
    /// is interpreted.
    pub fn code_bytes(&self, program: Program) -> Option<usize> {
        let code = self.code.as_ref()?;
        let executable = code.eight.get(program, &self.interpreter, code.set)?;
        Some(executable.len())
    }

    /// Interprets the program, in a function of its own: what is inlined into a function of many loops takes the
    /// optimiser time that grows with the square of its size (`tests/benches/build.md`).
    #[inline(always)]
    fn interpret<R: Real>(
        &self,
        program: Program,
        inputs: [&[Complex<R>]; 3],
        out: &mut Matrix<R>,
        scratch: &mut <Interpreter as Evaluate<R>>::Scratch,
    ) {
        dispatch_baseline(Interpreted {
            interpreter: &self.interpreter,
            program,
            inputs,
            out,
            scratch,
        });
    }

    /// Runs the machine code, if there is code for numbers of type `R`; returns whether it did.
    #[inline(always)]
    fn run<R: Real>(
        &self,
        program: Program,
        inputs: [&[Complex<R>]; 3],
        out: &mut [Complex<R>],
        s: &mut Scratch<R>,
    ) -> bool {
        self.run_at::<8, R>(|code| &code.eight, program, inputs, out, s)
            || self.run_at::<16, R>(|code| &code.sixteen, program, inputs, out, s)
    }

    #[inline(always)]
    fn run_at<const W: usize, R: Real>(
        &self,
        programs: impl Fn(&Code) -> &Programs<W>,
        program: Program,
        [x, p, dp]: [&[Complex<R>]; 3],
        out: &mut [Complex<R>],
        s: &mut Scratch<R>,
    ) -> bool {
        if let Some(code) = &self.code
            && let (Some(x), Some(p), Some(dp), Some(out)) =
                (as_lanes(x), as_lanes(p), as_lanes(dp), as_lanes_mut(out))
            && let Some(executable) = programs(code).get(program, &self.interpreter, code.set)
        {
            if s.spills.len() < executable.spills {
                grow(&mut s.spills, executable.spills);
            }
            let spills = &mut s.spills;
            executable.call(Arrays {
                x,
                p,
                dp,
                out,
                spills,
            });
            return true;
        }
        false
    }
}

/// The interpreter's derivatives at one point of each lane.
struct Interpreted<'a, R: Real> {
    interpreter: &'a Interpreter,
    /// [`Program::Linearize`] or [`Program::Jacobian`].
    program: Program,
    /// Point, parameters, and how these change.
    inputs: [&'a [Complex<R>]; 3],
    out: &'a mut Matrix<R>,
    scratch: &'a mut <Interpreter as Evaluate<R>>::Scratch,
}

impl<R: Real> Job for Interpreted<'_, R> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let [x, p, dp] = self.inputs;
        if self.program == Program::Linearize {
            self.interpreter.linearize(x, p, dp, self.out, self.scratch);
        } else {
            self.interpreter.jacobian(x, p, self.out, self.scratch);
        }
    }
}

/// Makes room for a program that is used for the first time.
#[cold]
fn grow(spills: &mut Vec<Lanes<8>>, length: usize) {
    spills.resize(length, Lanes([0.0; 8]));
}

impl<R: Real> Evaluate<R> for Evaluator {
    type Scratch = Scratch<R>;

    fn shape(&self) -> Shape {
        self.interpreter.shape()
    }

    fn scratch(&self, context: R::Context) -> Scratch<R> {
        Scratch {
            interpreter: self.interpreter.scratch(context),
            spills: Vec::new(),
        }
    }

    #[inline(always)]
    fn linearize(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        dp: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Scratch<R>,
    ) {
        assert_sizes(self.interpreter.shape(), [x, p, dp], out);
        if !self.run(Program::Linearize, [x, p, dp], &mut out.entries, s) {
            let program = Program::Linearize;
            self.interpret(program, [x, p, dp], out, &mut s.interpreter);
        }
    }

    #[inline(always)]
    fn jacobian(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut Matrix<R>,
        s: &mut Scratch<R>,
    ) {
        assert_sizes(self.interpreter.shape(), [x, p, p], out);
        if !self.run(Program::Jacobian, [x, p, &[]], &mut out.entries, s) {
            let program = Program::Jacobian;
            self.interpret(program, [x, p, &[]], out, &mut s.interpreter);
        }
    }

    #[inline(always)]
    fn value(
        &self,
        x: &[Complex<R>],
        p: &[Complex<R>],
        out: &mut [Complex<R>],
        s: &mut Scratch<R>,
    ) {
        if !self.run(Program::Value, [x, p, &[]], out, s) {
            self.interpreter.value(x, p, out, &mut s.interpreter);
        }
    }
}

#[inline(always)]
fn assert_sizes<R: Real>(shape: Shape, [x, p, dp]: [&[Complex<R>]; 3], out: &Matrix<R>) {
    assert!(
        x.len() == shape.variables && p.len() == shape.parameters && dp.len() == shape.parameters,
        "an input has the length of its shape"
    );
    assert!(
        out.rows() == shape.equations && out.columns() == shape.variables + 2,
        "[J | H | H_t] has a row for each equation and two columns more than variables"
    );
}
